//! How far contact conditions are met, m/s, where nothing or something is asked for.

use stationary_calculus::Potential;

use crate::solve::body_state::speed;
use crate::solve::sweeps::AMPLIFICATION;
use crate::world::memory::Memory;
use crate::{ContactIn, Dimension, World};

/// Changes of velocities relative to the fastest that are rounding.
pub(super) const ROUNDING: f64 = 1e-12;
/// Gaps relative to the farthest contact point's distance from the origin that are rounding, and so are
/// none: what moves no more rests.
const GAP_ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Velocities whose squares are no normal numbers, m/s: they are none.
const UNDERFLOW: f64 = 1.5e-154;
/// What nearly rests, and is no faster than a step's velocity increment, is settled to this part of
/// what counts as settled, so that it may rest.
pub(super) const REST_TOLERANCE: f64 = 1.0 / 256.0;
/// Tolerances where none is asked for, as parts of the largest velocity increment, so of the weight
/// of what rests: of small islands, and of large ones. A small island that takes too much work is
/// left at the second, and the step is then not settled.
const FINE_TOLERANCE: f64 = 1e-8;
const TOLERANCE: f64 = 1e-2;
/// Islands of more contacts are large.
pub(super) const LARGE: usize = 100;

impl<G: Dimension, P: Potential> World<G, P> {
    /// The change of velocity that counts as settled in small islands and in large ones, m/s: such
    /// changes leave a residual within the tolerance. And that by which what stands may be off from
    /// rest: a part of the velocity increment, however loose the tolerance, or weight would be lost.
    pub(super) fn settled(&self, contacts: &[ContactIn<G>], h: f64) -> [f64; 3] {
        let Memory { v, increment, .. } = &self.memory;
        let fastest = |v: &[f64]| {
            let bodies = v.chunks_exact(G::FREEDOMS).enumerate();
            bodies.map(|(i, v)| speed::<G>(v, self.detector.radius_of(i))).fold(0.0, f64::max)
        };
        let points = contacts.iter().flat_map(|contact| contact.points);
        let farthest = points.fold(0.0_f64, |m, point| m.max(G::dot(&point, &point))).sqrt();
        let rounding = (ROUNDING * fastest(&v.0)).max(GAP_ROUNDING * farthest / h).max(UNDERFLOW);
        let gain = fastest(&increment.0);
        let within = |asked: f64| rounding.max(asked / AMPLIFICATION);
        let or_asked = |part: f64| within(self.tolerance.unwrap_or(part * gain));
        [or_asked(FINE_TOLERANCE), or_asked(TOLERANCE), within(TOLERANCE * gain)]
    }
}
