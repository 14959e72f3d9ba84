//! A step and two of half of it, and how far they are apart: `off` of the table of `error_controlled.rs`.

use stationary_calculus::{Metric, Potential, Vector};
use stationary_constraints::RowLaw;

use super::{ErrorControlled, ErrorControlledReport, SHARE};
use crate::order::flight::{Flies, chord};
use crate::order::ledger::OF_CONTACT;
use crate::order::step_forces::StepForces;
use crate::solve::body_state::speed;
use crate::{ContactError, Dimension, JointRows, Touch, WorldReport};

/// What happens within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Within {
    Smooth,
    /// Slip starts, ends or turns.
    SlipChanges,
    /// A gap closes, something hits, or other surfaces push than before.
    Meets,
}

/// A step that was tried.
pub(super) struct Tried {
    pub(super) off: f64,
    pub(super) within: Within,
    pub(super) settled: bool,
    /// Whether a gap closed, or anything hit and bounced, and the energy that this took, J.
    pub(super) hits: bool,
    pub(super) impacts: bool,
    pub(super) impact_energy: f64,
}

impl<G: Flies, P: Potential> ErrorControlled<G, P> {
    /// One step of `h` and two of half of it, from where the state is.
    pub(super) fn attempt(
        &mut self,
        h: f64,
        joints: &impl JointRows,
        forces: &mut impl StepForces,
        report: &mut ErrorControlledReport,
    ) -> Result<Tried, ContactError> {
        self.whole.clone_from(&self.now);
        self.halves.clone_from(&self.now);
        let jumps = forces.jumps(self.now.t);
        let mut tried = Tried {
            off: 0.0,
            within: if jumps { Within::Meets } else { Within::Smooth },
            settled: true,
            hits: jumps,
            impacts: false,
            impact_energy: 0.0,
        };
        let mut swing = 0.0_f64;
        let slow = SHARE * self.accuracy / self.horizon;
        for k in 0..3 {
            let (of, length) =
                if k == 0 { (&mut self.whole, h) } else { (&mut self.halves, 0.5 * h) };
            forces.prepare(of, length);
            self.start.clone_from(of);
            let mut done = self.world.step_under(of, length, joints, &*forces)?;
            self.world.settle_joints(of, joints, &mut done)?;
            report.world_steps += 1;
            report.solves += work(&done);
            if k == 1 {
                self.middle.clone_from(&self.halves);
            }
            if k > 0 {
                tried.settled &= done.settled;
                tried.impacts |= done.impacts > 0;
                tried.impact_energy += done.impact_energy;
                self.touches[k - 1].clear();
                self.touches[k - 1].extend(self.world.touches().filter(pushes));
            }
            self.find_works(k, &done, forces);
            self.seen[k].look(&self.world, length);
            if k > 0 {
                self.swings.find(&mut self.world, &self.start, forces);
                swing = swing.max(self.swings.off(self.seen[k].margin, length, self.horizon));
            }
            if done.impacts > 0 || self.seen[k].closes(slow * length) {
                tried.within = Within::Meets;
                tried.hits = true;
            }
        }
        // The start belongs to the step as well: what just came to touch is no smooth motion. Before the first step
        // nothing is known.
        let before = if self.begun { &self.last } else { &self.seen[1] };
        if !self.seen.iter().all(|seen| seen.pushes_as(before)) {
            tried.within = Within::Meets;
        } else if tried.within == Within::Smooth
            && (!self.seen.iter().all(|seen| seen.rubs_as(before))
                || self.seen[1].turns_around(&self.seen[2]))
        {
            tried.within = Within::SlipChanges;
        }
        // Where slip turns around in the middle both halves together change nothing, but each does.
        let halves = [[&self.now, &self.middle], [&self.middle, &self.halves]];
        for ([from, to], rates) in halves.into_iter().zip(&mut self.rates) {
            self.difference.copy_from(to.p.view());
            self.difference.add_scaled(-1.0, from.p.view());
            self.world.system().metric().sharp(self.difference.view(), rates.view_mut());
        }
        tried.off = self.seen.iter().map(|seen| seen.early).fold(swing, f64::max);
        let horizon = if tried.within == Within::SlipChanges { self.horizon } else { 0.0 };
        for body in 0..self.world.detector().bodies() {
            if self.world.is_obstacle(body) {
                continue;
            }
            let radius = self.world.detector().reach_of(body);
            let far = |a: &G::Motion, b: &G::Motion| {
                let [apart, angle] = G::apart(a, b);
                apart + radius * angle
            };
            let [whole, halves, middle] =
                [&self.whole.q, &self.halves.q, &self.middle.q].map(|q| G::pose(q, body));
            let between = chord::<G>(&self.now.q, &self.halves.q, body)?.at(0.5);
            let own = |rates: &Vector<Vec<f64>>| {
                speed::<G>(&rates.0[G::FREEDOMS * body..][..G::FREEDOMS], radius)
            };
            let faster = horizon * self.rates.iter().map(own).sum::<f64>();
            tried.off = tried.off.max(far(&whole, &halves)).max(far(&between, &middle)).max(faster);
        }
        Ok(tried)
    }

    /// Writes the works of the world's last step.
    fn find_works(&mut self, k: usize, done: &WorldReport, forces: &impl StepForces) {
        let works = &mut self.works[k];
        works.clear();
        works.extend([-done.friction_energy, -done.impact_energy, done.work, done.lifting_energy]);
        works.push(-done.joint_friction_energy);
        works.push(done.joint_friction_energy - done.joint_energy);
        works.resize(self.acting, 0.0);
        let (rows, impulses) = self.world.joint_rows();
        let equalities = rows.blocks().filter(|(law, _)| *law == RowLaw::Equality);
        works.extend(equalities.filter_map(|(_, block)| impulses.get(block.start)));
        let of_forces = &mut works[OF_CONTACT..self.acting];
        if of_forces.is_empty() {
            return;
        }
        let [before, after] = self.world.velocities();
        self.mean.copy_from(before);
        self.mean.add_scaled(1.0, after);
        self.mean.0.iter_mut().for_each(|v| *v *= 0.5);
        let after = if k == 0 { &self.whole } else { &self.halves };
        forces.add_works([&self.start, after], self.mean.view(), of_forces);
    }
}

fn pushes<G: Dimension>(touch: &Touch<G>) -> bool {
    touch.normal > 0.0 || touch.impact > 0.0
}

fn work(done: &WorldReport) -> usize {
    done.relaxed + done.solved + done.projected + done.impacts
}
