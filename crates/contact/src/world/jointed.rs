//! Islands with joints: the rows of joints and of contacts in one solve.
//!
//! ```text
//! rows of joints, cones of contacts          velocities                       see `rows_solver.rs`
//! J d = 0,   dg d + .. >= 0                  lifting, which keeps joints closed
//! J d = -g,  dg d >= -(what is left of gaps) closing joints after the step
//! J' v = -dg/dt                              velocities where the step ends, as chosen steps want them
//! ```
//! Energy that joints take is paid at the mean of the velocities before and after, as that of contacts.

use stationary_calculus::{Metric, Potential, Space, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
use stationary_integrators::State;

use crate::solve::sweeps::AMPLIFICATION;
use crate::world::islands::has_joints;
use crate::world::lifting::lifted_part;
use crate::world::memory::Memory;
use crate::world::tolerances::ROUNDING;
use crate::{
    ContactError, ContactIn, ContactRows, Dimension, JointRows, RowsSolver, World, WorldReport,
};

/// How often joints are closed after a step, at most: each round squares what is left.
const CLOSINGS: usize = 8;
/// Openings of joints that are rounding, m.
const CLOSED: f64 = 1e-14;
/// Joints that stay open by more than this part of what the step opened contradict each other, or contacts
/// keep them from closing: the step is not settled.
const CLOSED_PART: f64 = 1e-3;

/// How far joints stay open, m or rad, and whether that is closed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closed {
    pub(crate) open: f64,
    pub(crate) done: bool,
}

/// What steps with joints write.
#[derive(Debug, Default)]
pub(crate) struct JointedMemory {
    /// Rows that are solved together, their impulses, the motion that they lead to, and who solves them.
    rows: VelocityRows,
    x: Vec<f64>,
    motion: Vector<Vec<f64>>,
    solver: RowsSolver,
    /// What is left of the gaps of the contacts that are solved with joints.
    left: VelocityRows,
    room: RowRoom,
    /// The bodies that a block of rows names.
    named: Vec<usize>,
}

/// Entries of rows before they are appended.
#[derive(Debug, Default)]
struct RowRoom {
    own: ContactRows,
    entries: Vec<(usize, f64)>,
}

impl<G: Dimension, P: Potential> World<G, P> {
    /// The rows of joints over a step.
    pub(super) fn find_joints(
        &mut self,
        state: &State<Vec<f64>>,
        h: f64,
        from: &impl JointRows,
    ) -> Result<(), ContactError> {
        let Memory { joints, joint_impulses, linked, scales, jointed, .. } = &mut self.memory;
        joints.clear();
        joint_impulses.clear();
        linked.clear();
        jointed.left.clear();
        from.velocity_rows(state.t, &state.q, h, joints)?;
        joints.check(self.mass.dim())?;
        // The movable bodies that each block names, two by two; one past the last stands for what does not move.
        let named = &mut jointed.named;
        for (_, block) in joints.blocks() {
            let bodies = block.flat_map(|row| joints.row(row)).map(|(f, _)| f / G::FREEDOMS);
            named.clear();
            named.extend(bodies.filter(|&body| scales[body].as_ref()[0] > 0.0));
            named.sort_unstable();
            named.dedup();
            match named[..] {
                [body] => linked.push([body, scales.len()]),
                _ => linked.extend(named.windows(2).map(|pair| [pair[0], pair[1]])),
            }
        }
        Ok(())
    }

    /// Solves the joints, and with them the contacts that answer to them.
    pub(crate) fn rest_jointed(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        finest: f64,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Memory {
            joints, joint_impulses, v, before, bias, impulses, with_joints, jointed, ..
        } = &mut self.memory;
        let JointedMemory { rows, room, x, solver, .. } = jointed;
        rows.clear();
        rows.extend(joints);
        x.clear();
        x.resize(rows.rows(), 0.0);
        for &i in &*with_joints {
            push_cone(&contacts[i], q, -bias[i], room, rows)?;
            let directions = G::directions(&contacts[i].normal);
            x.extend(directions.as_ref().iter().map(|along| G::dot(&impulses[i], along)));
        }
        // Rows of turns have rates that bodies' speeds say nothing of.
        let fastest =
            joints.blocks().map(|(law, block)| match joints.lack(block.start, v.view()) {
                lack if law == RowLaw::Limit => (-lack).max(0.0),
                lack => lack.abs(),
            });
        let enough = (AMPLIFICATION * finest).max(ROUNDING * fastest.fold(0.0, f64::max));
        let done = solver.solve(rows, &mut &self.mass, enough, x, v.view_mut())?;
        report.islands += done.islands;
        report.solved += done.solved;
        report.settled &= done.settled;
        report.residual = report.residual.max(done.residual);
        report.coulomb = report.coulomb.max(done.friction_residual);
        let (held, pushed) = x.split_at(joints.rows());
        for (law, block) in joints.blocks() {
            for row in block {
                let rate = joints.row(row).map(|(f, value)| value * (v.0[f] + before.0[f]));
                let taken = -0.5 * held[row] * rate.sum::<f64>();
                report.joint_energy += taken;
                if matches!(law, RowLaw::Bounded(_)) {
                    report.joint_friction_energy += taken;
                }
            }
        }
        joint_impulses.clear();
        joint_impulses.extend(held);
        let mut pushed = pushed.iter();
        for &i in &*with_joints {
            let directions = G::directions(&contacts[i].normal);
            let along = directions.as_ref().iter().zip(&mut pushed);
            impulses[i] = along.fold(G::Vector::default(), |sum, (along, &x)| sum + *along * x);
        }
        Ok(())
    }

    /// Lifts what overlaps among the contacts that answer to joints with these kept, and remembers what is
    /// left of their gaps.
    pub(crate) fn lift_jointed(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        settled: f64,
        h: f64,
    ) -> Result<(), ContactError> {
        let Memory { joints, lift_bias, lift, v, islands, with_joints, jointed, .. } =
            &mut self.memory;
        let JointedMemory { rows, left, room, x, motion, solver, .. } = jointed;
        let RowRoom { own, entries } = room;
        left.clear();
        rows.clear();
        for (law, block) in joints.blocks() {
            let row = block.start;
            // What the step's velocity has left of a limit.
            let asked = match law {
                RowLaw::Equality => 0.0,
                RowLaw::Limit => -joints.lack(row, v.view()).max(0.0),
                RowLaw::Bounded(_) | RowLaw::Cone(_) => continue,
            };
            entries.clear();
            entries.extend(joints.row(row));
            rows.push(law, &[(entries, asked)])?;
        }
        let mut overlaps = false;
        for &i in &*with_joints {
            own.clear();
            contacts[i].push_row(q, own);
            entries.clear();
            entries.extend(own.row(0));
            rows.push(RowLaw::Limit, &[(entries, -lift_bias[i])])?;
            overlaps |= contacts[i].gap < 0.0 && lift_bias[i] < -settled;
            let gap = if contacts[i].gap < 0.0 { 0.0 } else { (h * lift_bias[i]).max(0.0) };
            left.push(RowLaw::Limit, &[(entries, -gap)])?;
        }
        if overlaps {
            motion.0.clear();
            motion.0.resize(lift.0.len(), 0.0);
            x.clear();
            x.resize(rows.rows(), 0.0);
            solver.solve(rows, &mut &self.mass, settled, x, motion.view_mut())?;
            let f = G::FREEDOMS;
            for (members, bodies) in islands.iter() {
                if !has_joints(members, contacts.len()) {
                    continue;
                }
                let part = lifted_part(&self.detector, bodies.iter().copied(), &motion.0, h);
                for &body in bodies {
                    let own = lift.0[f * body..][..f].iter_mut().zip(&motion.0[f * body..]);
                    own.for_each(|(lift, motion)| *lift += part * motion);
                }
            }
        }
        Ok(())
    }

    /// Turns the velocities of a state that the last step led to into those that joints ask for there, just before its
    /// time: the step itself asks where it starts. The report and the impulses of the step tell what that took.
    pub(crate) fn settle_joints(
        &mut self,
        state: &mut State<Vec<f64>>,
        from: &impl JointRows,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        if self.memory.joints.rows() == 0 {
            return Ok(());
        }
        let mut all = VelocityRows::default();
        // Of a speed that jumps at its end a step has the one before.
        from.velocity_rows(state.t.next_down(), &state.q, 1.0, &mut all)?;
        all.check(self.mass.dim())?;
        let (mut rows, mut places) = (VelocityRows::default(), Vec::new());
        for (law, block) in all.blocks().filter(|(law, _)| *law == RowLaw::Equality) {
            let entries: Vec<_> = all.row(block.start).collect();
            rows.push(law, &[(&entries, all.asked(block.start))])?;
            places.push(block.start);
        }
        if places.is_empty() {
            return Ok(());
        }
        let Memory { start: v, joint_impulses, jointed, .. } = &mut self.memory;
        self.system.metric().sharp(state.p.view(), v.view_mut());
        let rate = |row: usize, v: &[f64]| rows.row(row).map(|(f, x)| x * v[f]).sum::<f64>();
        let before: Vec<f64> = (0..places.len()).map(|row| rate(row, &v.0)).collect();
        let largest = before.iter().zip(0..).fold(0.0, |largest: f64, (before, row)| {
            largest.max(before.abs()).max(rows.asked(row).abs())
        });
        let mut x = vec![0.0; places.len()];
        let enough = (ROUNDING * largest).max(CLOSED);
        let done = jointed.solver.solve(&rows, &mut &self.mass, enough, &mut x, v.view_mut())?;
        report.settled &= done.settled;
        for ((row, &place), (x, before)) in places.iter().enumerate().zip(x.iter().zip(before)) {
            report.joint_energy -= 0.5 * x * (before + rate(row, &v.0));
            if let Some(impulse) = joint_impulses.get_mut(place) {
                *impulse += x;
            }
        }
        self.system.metric().flat(v.view(), state.p.view_mut());
        Ok(())
    }

    /// Closes the joints of a state near the end of the last step, positions and velocities; whether they close.
    pub(crate) fn close_joints(
        &mut self,
        state: &mut State<Vec<f64>>,
        joints: &impl JointRows,
    ) -> Result<bool, ContactError> {
        if self.memory.joints.rows() == 0 {
            return Ok(true);
        }
        std::mem::swap(&mut self.memory.next, state);
        let closed = self.close(joints);
        std::mem::swap(&mut self.memory.next, state);
        let mut report = WorldReport { settled: closed?.done, ..WorldReport::default() };
        self.settle_joints(state, joints, &mut report)?;
        Ok(report.settled)
    }

    /// Closes the joints of the state that is written, by moving bodies, as far as they let themselves.
    pub(crate) fn close(&mut self, joints: &impl JointRows) -> Result<Closed, ContactError> {
        let Memory { next, jointed, .. } = &mut self.memory;
        let JointedMemory { rows, left, x, motion, solver, .. } = jointed;
        let farthest = next.q.iter().fold(1.0, |most: f64, q| most.max(q.abs()));
        let (mut first, mut last) = (0.0, f64::INFINITY);
        for round in 0..=CLOSINGS {
            rows.clear();
            rows.extend(left);
            let contacts = rows.rows();
            joints.position_rows(next.t, &next.q, rows)?;
            motion.0.clear();
            motion.0.resize(self.mass.dim(), 0.0);
            rows.check(self.mass.dim())?;
            let lacks = rows.blocks().filter(|(_, block)| block.start >= contacts);
            let open =
                lacks.map(|(law, block)| match (law, rows.lack(block.start, motion.view())) {
                    (RowLaw::Limit, lack) => -lack,
                    (_, lack) => lack.abs(),
                });
            let open = open.fold(0.0, f64::max);
            if round == 0 {
                first = open;
            }
            if open <= CLOSED || open >= last || round == CLOSINGS {
                let enough = (CLOSED_PART * first).max(CLOSED * farthest);
                return Ok(Closed { open, done: open <= enough });
            }
            last = open;
            x.clear();
            x.resize(rows.rows(), 0.0);
            solver.solve(rows, &mut &self.mass, CLOSED, x, motion.view_mut())?;
            self.system.space().advance(&mut next.q, 1.0, motion.view());
        }
        Ok(Closed { open: last, done: false })
    }
}

/// Appends the cone of a contact, whose normal asks for a velocity.
fn push_cone<G: Dimension>(
    contact: &ContactIn<G>,
    q: &[f64],
    asked: f64,
    room: &mut RowRoom,
    rows: &mut VelocityRows,
) -> Result<(), ContactError> {
    let RowRoom { own, entries } = room;
    own.clear();
    contact.push_row(q, own);
    contact.push_tangents(q, own);
    entries.clear();
    entries.extend((0..own.len()).flat_map(|row| own.row(row)));
    let (mut block, mut rest) = ([(&[][..], 0.0); 3], &entries[..]);
    for (row, block) in block[..own.len()].iter_mut().enumerate() {
        (block.0, rest) = rest.split_at(own.row(row).count());
    }
    block[0].1 = asked;
    Ok(rows.push(RowLaw::Cone(contact.friction), &block[..own.len()])?)
}
