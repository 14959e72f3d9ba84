//! The step that was tried is taken, extrapolated where nothing happens in it; what happened is noted.

use stationary_calculus::Potential;

use super::attempt::{Tried, Within};
use super::{ErrorControlled, ErrorControlledReport};
use crate::order::event::{Event, EventKind};
use crate::order::flight::Flies;
use crate::order::pieces::Motion;
use crate::order::pushing::Pushing;
use crate::{ContactError, JointRows};

impl<G: Flies, P: Potential> ErrorControlled<G, P> {
    /// Gives what extrapolation adds to the impulse of two surfaces to where they push hardest at last.
    fn extrapolate_touches(&mut self) {
        let [whole, first, second] = &self.seen;
        let pairs = whole.pairs.iter().zip(&first.pairs).zip(&second.pairs);
        for ((whole, first), second) in pairs {
            let beyond = first.impulse + second.impulse - whole.impulse;
            let of_pair =
                self.touches[1].iter_mut().filter(|t| t.contact.id.colliders == second.colliders);
            if let Some(touch) = of_pair.max_by(|a, b| a.normal.total_cmp(&b.normal)) {
                let along = G::dot(&beyond, &touch.contact.normal);
                touch.normal += along;
                touch.friction = touch.friction + beyond - touch.contact.normal * along;
            }
        }
    }

    /// Takes the step that was tried.
    pub(super) fn accept(
        &mut self,
        (h, end): (f64, f64),
        tried: &Tried,
        joints: &impl JointRows,
        report: &mut ErrorControlledReport,
    ) -> Result<(), ContactError> {
        let smooth = tried.within == Within::Smooth;
        let motion = if tried.hits { Motion::Straight } else { Motion::Even };
        self.pieces.push(&self.now, motion);
        let t = if h == end - self.now.t { end } else { self.now.t + h };
        if smooth {
            self.extrapolate_touches();
        }
        let works = self.works.each_ref().map(Vec::as_slice);
        let touches = self.touches.iter().flatten().copied();
        self.ledger.push((self.now.t, t), [motion == Motion::Even, smooth], works, touches);
        self.now.clone_from(&self.halves);
        self.now.t = t;
        if smooth {
            report.extrapolated += 1;
            for body in 0..self.world.detector().bodies() {
                let ends = [self.whole.q.as_slice(), &self.halves.q];
                G::place_on_chord(ends, body, 2.0, &mut self.now.q)?;
            }
            self.now.p.add_scaled(1.0, self.halves.p.view());
            self.now.p.add_scaled(-1.0, self.whole.p.view());
            // By fourth order in the step: no work to tell.
            report.settled &= self.world.close_joints(&mut self.now, joints)?;
        }
        report.steps += 1;
        report.shortest = report.shortest.min(h);
        report.longest = report.longest.max(h);
        report.off += tried.off;
        report.settled &= tried.settled;
        let mut note = |kind, bodies, energy| {
            self.events.push(Event { time: t, kind, bodies, energy });
        };
        if tried.impacts {
            note(EventKind::Impact, [None; 2], tried.impact_energy);
        }
        let [.., last] = &self.seen;
        let (last, before) = (&last.pairs, &self.last.pairs);
        let among =
            |of: &[Pushing<G>], one: &Pushing<G>| of.iter().any(|x| x.colliders == one.colliders);
        for one in last.iter().filter(|one| !among(before, one)) {
            note(EventKind::ContactStarts, one.bodies, 0.0);
        }
        for one in before.iter().filter(|one| !among(last, one)) {
            note(EventKind::ContactEnds, one.bodies, 0.0);
        }
        std::mem::swap(&mut self.last, &mut self.seen[2]);
        self.begun = true;
        Ok(())
    }
}
