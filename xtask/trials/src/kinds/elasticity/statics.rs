//! Where loaded bodies come to rest: against closed forms, beam theory and the trials' own bodies.
//!
//! ```text
//! patch     the hull held at F X + t            the inside follows
//! pulled    a traction on one face              P_11 = t, P_22 = P_33 = 0: a Newton of the trial's
//! chain     a bar in pieces with loads          each piece bears the sum of what is beyond it
//! beam      L/h from 4 to 300                   Euler, Bernoulli, Timoshenko
//! loaded    random loads and supports           one more Newton step, dense, moves nothing
//! crushed   one face moved through the other    refused
//! ```
//! Sizes of 1e-6 to 1e6 m, Young's moduli of 1 to 1e12 Pa, strains of 1e-9 to 0.15.

mod beam;
mod block;
mod chain;
mod crushed;
mod loaded;
mod patch;
pub(super) mod problem;
mod pulled;
pub(super) mod rest;

use block::in_plane_or_space;
use crushed::Crushed;
use loaded::Loaded;
use patch::Patch;
use pulled::Pulled;

use crate::{Draw, Verdict};

const EPS: f64 = f64::EPSILON;

pub fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0 => in_plane_or_space::<Patch>(draw, 3),
        1 | 2 => in_plane_or_space::<Pulled>(draw, 3),
        3 => chain::chain(draw),
        4 => beam::beam(draw),
        5 | 6 => in_plane_or_space::<Loaded>(draw, 2),
        _ => in_plane_or_space::<Crushed>(draw, 2),
    }
}
