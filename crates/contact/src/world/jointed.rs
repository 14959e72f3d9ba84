//! Islands with joints: the rows of joints and of contacts in one solve.
//!
//! ```text
//! rows of joints, cones of contacts          velocities                       see `solve_rows`
//! J d = 0,   dg d + .. >= 0                  lifting, which keeps joints closed
//! J d = -g,  dg d >= -(what is left of gaps) closing joints after the step
//! ```
//! Energy that joints take is paid at the mean of the velocities before and after, as that of contacts.

use stationary_calculus::{Potential, Space, Vector};
use stationary_constraints::{RowLaw, VelocityRows};

use crate::solve::sweeps::AMPLIFICATION;
use crate::world::{Memory, lifted_part};
use crate::{
    ContactError, ContactIn, ContactRows, Dimension, JointRows, World, WorldReport, solve_rows,
};

/// How often joints are closed after a step, at most: each round squares what is left.
const CLOSINGS: usize = 8;
/// Openings of joints that are rounding, m.
const CLOSED: f64 = 1e-14;

/// The movable bodies that each block of rows names, two by two; the body numbered `bodies` stands for
/// what does not move.
pub(crate) fn links(
    rows: &VelocityRows,
    freedoms: usize,
    bodies: usize,
    moves: impl Fn(usize) -> bool,
) -> Vec<[usize; 2]> {
    let mut links = Vec::new();
    for (_, block) in rows.blocks() {
        let named = block.flat_map(|row| rows.row(row)).map(|(freedom, _)| freedom / freedoms);
        let mut named: Vec<usize> = named.filter(|&body| moves(body)).collect();
        named.sort_unstable();
        named.dedup();
        match named[..] {
            [] => {}
            [body] => links.push([body, bodies]),
            _ => links.extend(named.windows(2).map(|pair| [pair[0], pair[1]])),
        }
    }
    links
}

impl<G: Dimension, P: Potential> World<G, P> {
    /// Solves the joints, and with them the contacts of these numbers.
    pub(crate) fn rest_jointed(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        members: &[usize],
        finest: f64,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Memory { joints, v, before, bias, impulses, .. } = &mut self.memory;
        let mut rows = joints.clone();
        let mut x = vec![0.0; rows.rows()];
        for &i in members {
            push_cone(&contacts[i], q, -bias[i], &mut rows)?;
            let directions = G::directions(&contacts[i].normal);
            x.extend(directions.as_ref().iter().map(|along| G::dot(&impulses[i], along)));
        }
        let enough = AMPLIFICATION * finest;
        let done = solve_rows(&rows, &mut &self.mass, enough, &mut x, v.view_mut())?;
        report.islands += done.islands;
        report.solved += done.solved;
        report.settled &= done.settled;
        report.residual = report.residual.max(done.residual);
        report.coulomb = report.coulomb.max(done.friction_residual);
        let (held, pushed) = x.split_at(joints.rows());
        for (row, x) in held.iter().enumerate() {
            let rate = joints.row(row).map(|(f, value)| value * (v.0[f] + before.0[f]));
            report.joint_energy -= 0.5 * x * rate.sum::<f64>();
        }
        let mut pushed = pushed.iter();
        for &i in members {
            let directions = G::directions(&contacts[i].normal);
            let along = directions.as_ref().iter().zip(&mut pushed);
            impulses[i] = along.fold(G::Vector::default(), |sum, (along, &x)| sum + *along * x);
        }
        Ok(())
    }

    /// Lifts what overlaps among the contacts of these numbers with joints kept, and remembers what is
    /// left of their gaps.
    pub(crate) fn lift_jointed(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        members: &[usize],
        settled: f64,
        h: f64,
    ) -> Result<(), ContactError> {
        let Memory { joints, left, lift_bias, lift, .. } = &mut self.memory;
        left.clear();
        let mut rows = VelocityRows::default();
        for (law, block) in joints.blocks().filter(|(law, _)| *law == RowLaw::Equality) {
            let entries: Vec<_> = block.flat_map(|row| joints.row(row)).collect();
            rows.push(law, &[(&entries, 0.0)])?;
        }
        let mut overlaps = false;
        for &i in members {
            let mut normal = ContactRows::new();
            contacts[i].push_row(q, &mut normal);
            let entries: Vec<_> = normal.row(0).collect();
            rows.push(RowLaw::Limit, &[(&entries, -lift_bias[i])])?;
            overlaps |= contacts[i].gap < 0.0 && lift_bias[i] < -settled;
            let gap = if contacts[i].gap < 0.0 { 0.0 } else { (h * lift_bias[i]).max(0.0) };
            left.push(RowLaw::Limit, &[(&entries, -gap)])?;
        }
        if overlaps {
            let mut motion = Vector(vec![0.0; lift.0.len()]);
            let mut x = vec![0.0; rows.rows()];
            solve_rows(&rows, &mut &self.mass, settled, &mut x, motion.view_mut())?;
            let part = lifted_part(&self.detector, 0..self.detector.bodies(), &motion.0, h);
            self.memory.lift.add_scaled(part, motion.view());
        }
        Ok(())
    }

    /// Closes the joints of the state that is written, by moving bodies.
    pub(crate) fn close(&mut self, joints: &impl JointRows) -> Result<(), ContactError> {
        let next = &mut self.memory.next;
        let mut last = f64::INFINITY;
        for _ in 0..CLOSINGS {
            let mut rows = self.memory.left.clone();
            let contacts = rows.rows();
            joints.position_rows(next.t, &next.q, &mut rows)?;
            let mut motion = Vector(vec![0.0; self.mass.dim()]);
            rows.check(self.mass.dim())?;
            let open = (contacts..rows.rows()).map(|row| rows.lack(row, motion.view()).abs());
            let open = open.fold(0.0, f64::max);
            if open <= CLOSED || open >= last {
                break;
            }
            last = open;
            let mut x = vec![0.0; rows.rows()];
            solve_rows(&rows, &mut &self.mass, CLOSED, &mut x, motion.view_mut())?;
            self.system.space().advance(&mut next.q, 1.0, motion.view());
        }
        Ok(())
    }
}

/// Appends the cone of a contact, whose normal asks for a velocity.
pub(crate) fn push_cone<G: Dimension>(
    contact: &ContactIn<G>,
    q: &[f64],
    asked: f64,
    rows: &mut VelocityRows,
) -> Result<(), ContactError> {
    let mut own = ContactRows::new();
    contact.push_row(q, &mut own);
    contact.push_tangents(q, &mut own);
    let entries: Vec<Vec<_>> = (0..own.len()).map(|row| own.row(row).collect()).collect();
    let block: Vec<(&[(usize, f64)], f64)> = entries
        .iter()
        .zip([asked, 0.0, 0.0])
        .map(|(entries, asked)| (&entries[..], asked))
        .collect();
    Ok(rows.push(RowLaw::Cone(contact.friction), &block)?)
}
