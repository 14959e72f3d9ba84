//! Islands with joints: the rows of joints and of contacts in one solve.
//!
//! ```text
//! rows of joints, cones of contacts          velocities                       see `rows_solver.rs`
//! J d = 0,   dg d + .. >= 0                  lifting, which keeps joints closed
//! J d = -g,  dg d >= -(what is left of gaps) closing joints after the step
//! J' v = -dg/dt                              velocities where the step ends, as chosen steps want them
//! ```
//! Rows of turns are measured at the end of an arm (`end_of_arm.rs`). Energy that joints take is paid at the mean of the velocities before and after, as that of contacts.

use stationary_calculus::{Metric, Potential, Space, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
use stationary_integrators::State;

use crate::solve::sweeps::AMPLIFICATION;
use crate::world::end_of_arm;
use crate::world::islands::has_joints;
use crate::world::lifting::lifted_part;
use crate::world::memory::Memory;
use crate::world::tolerances::ROUNDING;
use crate::{
    ContactError, ContactIn, ContactRows, Dimension, JointRows, RowsSolver, World, WorldReport,
};

/// How often joints are closed after a step, at most: each round squares what is left.
const CLOSINGS: usize = 8;
/// Openings of joints that are rounding, in parts of the arm or of the farthest place.
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
    /// The arm at the end of which what turns is measured, m, and the rows of joints over a step as measured there.
    pub(super) arm: f64,
    pub(super) measured: VelocityRows,
    /// Rows that are solved together, their impulses, the motion that they lead to, and who solves them.
    rows: VelocityRows,
    x: Vec<f64>,
    motion: Vector<Vec<f64>>,
    solver: RowsSolver,
    /// What is left of the gaps of the contacts that are solved with joints.
    left: VelocityRows,
    /// What joints ask for that are open, m or rad.
    open: VelocityRows,
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
        let JointedMemory { arm, measured, named, .. } = jointed;
        *arm = end_of_arm::arm(joints, &self.detector);
        measured.clear();
        end_of_arm::append::<G>(joints, *arm, measured);
        // The movable bodies that each block names, two by two; one past the last stands for what does not move.
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
        let JointedMemory { arm, measured, rows, room, x, solver, .. } = jointed;
        rows.clear();
        rows.extend(measured);
        x.clear();
        x.resize(rows.rows(), 0.0);
        for &i in &*with_joints {
            push_cone(&contacts[i], q, -bias[i], room, rows)?;
            let directions = G::directions(&contacts[i].normal);
            x.extend(directions.as_ref().iter().map(|along| G::dot(&impulses[i], along)));
        }
        let fastest =
            measured.blocks().map(|(law, block)| match measured.lack(block.start, v.view()) {
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
        for (law, block) in measured.blocks() {
            for row in block {
                let rate = measured.row(row).map(|(f, value)| value * (v.0[f] + before.0[f]));
                let taken = -0.5 * held[row] * rate.sum::<f64>();
                report.joint_energy += taken;
                if matches!(law, RowLaw::Bounded(_)) {
                    report.joint_friction_energy += taken;
                }
            }
        }
        joint_impulses.clear();
        let natural = |(row, x)| x * end_of_arm::measure::<G>(joints, row, *arm);
        joint_impulses.extend(held.iter().enumerate().map(natural));
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
        let Memory { lift_bias, lift, v, islands, with_joints, jointed, .. } = &mut self.memory;
        let JointedMemory { measured, rows, left, room, x, motion, solver, .. } = jointed;
        let RowRoom { own, entries } = room;
        left.clear();
        rows.clear();
        for (law, block) in measured.blocks() {
            let row = block.start;
            // What the step's velocity has left of a limit.
            let asked = match law {
                RowLaw::Equality => 0.0,
                RowLaw::Limit => -measured.lack(row, v.view()).max(0.0),
                RowLaw::Bounded(_) | RowLaw::Cone(_) => continue,
            };
            entries.clear();
            entries.extend(measured.row(row));
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
        let (mut all, mut measured) = (VelocityRows::default(), VelocityRows::default());
        // Of a speed that jumps at its end a step has the one before.
        from.velocity_rows(state.t.next_down(), &state.q, 1.0, &mut all)?;
        all.check(self.mass.dim())?;
        let arm = self.memory.jointed.arm;
        end_of_arm::append::<G>(&all, arm, &mut measured);
        let (mut rows, mut places) = (VelocityRows::default(), Vec::new());
        for (law, block) in measured.blocks().filter(|(law, _)| *law == RowLaw::Equality) {
            let entries: Vec<_> = measured.row(block.start).collect();
            rows.push(law, &[(&entries, measured.asked(block.start))])?;
            places.push(block.start);
        }
        if places.is_empty() {
            return Ok(());
        }
        let Memory { start: v, joint_impulses, jointed, .. } = &mut self.memory;
        self.system.metric().sharp(state.p.view(), v.view_mut());
        let rate = |row: usize, v: &[f64]| rows.row(row).map(|(f, x)| x * v[f]).sum::<f64>();
        let before: Vec<f64> = (0..places.len()).map(|row| rate(row, &v.0)).collect();
        let largest = (0..places.len()).fold(0.0, |largest: f64, row| {
            let parts = rows.row(row).map(|(f, x)| (x * v.0[f]).abs());
            largest.max(parts.sum::<f64>() + rows.asked(row).abs())
        });
        let mut x = vec![0.0; places.len()];
        let enough = ROUNDING * largest;
        let done = jointed.solver.solve(&rows, &mut &self.mass, enough, &mut x, v.view_mut())?;
        report.settled &= done.settled;
        for ((row, &place), (x, before)) in places.iter().enumerate().zip(x.iter().zip(before)) {
            report.joint_energy -= 0.5 * x * (before + rate(row, &v.0));
            if let Some(impulse) = joint_impulses.get_mut(place) {
                *impulse += x * end_of_arm::measure::<G>(&all, place, arm);
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
        let JointedMemory { arm, rows, left, open, x, motion, solver, .. } = jointed;
        let (mut first, mut last) = (0.0, f64::INFINITY);
        for round in 0..=CLOSINGS {
            open.clear();
            joints.position_rows(next.t, &next.q, open)?;
            open.check(self.mass.dim())?;
            rows.clear();
            end_of_arm::append::<G>(open, *arm, rows);
            let off = opening(rows);
            if round == 0 {
                first = off;
            }
            let rounding = CLOSED * end_of_arm::farthest::<G>(open, &next.q).max(*arm);
            if off <= rounding || off >= last || round == CLOSINGS {
                let done = off <= rounding.max(CLOSED_PART * first);
                return Ok(Closed { open: opening(open), done });
            }
            last = off;
            rows.extend(left);
            motion.0.clear();
            motion.0.resize(self.mass.dim(), 0.0);
            x.clear();
            x.resize(rows.rows(), 0.0);
            solver.solve(rows, &mut &self.mass, rounding, x, motion.view_mut())?;
            self.system.space().advance(&mut next.q, 1.0, motion.view());
        }
        Ok(Closed { open: opening(open), done: false })
    }
}

/// How far rows are from what they ask of a motion, while nothing has moved.
fn opening(rows: &VelocityRows) -> f64 {
    let open = rows.blocks().map(|(law, block)| match law {
        RowLaw::Limit => rows.asked(block.start),
        _ => rows.asked(block.start).abs(),
    });
    open.fold(0.0, f64::max)
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
