//! The normal impulses of a small island without friction, exactly: by active sets.
//!
//! ```text
//! min 1/2 |v - v_f|^2 in the metric M,   dg v + bias >= 0,   beta = 0                  (11.5.1)
//! ```
//! What has just come to stand, and what has no friction, is solved by this at once, to rounding,
//! where sweeps would pass momentum on from contact to contact. The cost grows with the cube of the
//! contacts that push, so that larger islands are left to the sweeps. See [`crate::project`].

use stationary_calculus::{Vector, array};

use crate::impact::Lifting;
use crate::impact::projection::Projector;
use crate::solve::sweeps::{Island, Sweeps};
use crate::{ContactError, ContactIn, ContactRows, Dimension, Impact, InverseMass};

/// Islands of more contacts are left to the sweeps.
const CONTACTS: usize = 300;

/// Bodies before any impulse of this step, and the points at which they touch.
#[derive(Clone, Copy)]
pub struct FreeMotion<'a, G: Dimension> {
    pub(crate) points: &'a [ContactIn<G>],
    pub(crate) q: &'a [f64],
    pub(crate) v: &'a [f64],
    pub(crate) mass: &'a InverseMass,
    /// How much of each gap is left, over the step, m/s.
    pub(crate) bias: &'a [f64],
}

impl<G: Dimension> FreeMotion<'_, G> {
    /// Replaces the impulses of an island, whose contacts have these numbers, by those of the
    /// projection; says whether it did.
    pub(crate) fn project<const F: usize, const D: usize>(
        &self,
        members: &[usize],
        island: Island<F, D>,
        x: &mut [[f64; D]],
        sweeps: &mut Sweeps<F, D>,
        room: &mut Room,
    ) -> Result<bool, ContactError> {
        if members.len() > CONTACTS {
            return Ok(false);
        }
        let Room { impact, lifting, all, bias, guess, projector } = room;
        let fill = |rows: &mut ContactRows| {
            members.iter().for_each(|&i| self.points[i].push_row(self.q, rows));
        };
        impact.refill(self.mass, lifting, fill)?;
        all.clear();
        all.extend(0..members.len());
        bias.clear();
        bias.extend(members.iter().map(|&i| self.bias[i]));
        guess.clear();
        guess.extend(x.iter().map(|x| x[0]));
        if projector.project(impact, all, bias, guess, Vector(self.v)).is_err() {
            return Ok(false);
        }
        for ((contact, x), &push) in island.contacts.iter().zip(x).zip(&projector.impulses) {
            let mut to = [0.0; D];
            to[0] = push;
            contact.push(&array(|k| to[k] - x[k]), &mut sweeps.w);
            *x = to;
        }
        Ok(true)
    }
}

/// Room for one island after another.
#[derive(Debug)]
pub(crate) struct Room {
    impact: Impact,
    lifting: Lifting,
    all: Vec<usize>,
    bias: Vec<f64>,
    guess: Vec<f64>,
    projector: Projector,
}

impl Default for Room {
    fn default() -> Self {
        Room {
            impact: Impact::empty(),
            lifting: Lifting::default(),
            all: Vec::new(),
            bias: Vec::new(),
            guess: Vec::new(),
            projector: Projector::default(),
        }
    }
}
