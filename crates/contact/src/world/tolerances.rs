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
/// Tolerance of small islands where none is asked for, relative to the largest velocity increment, so to the
/// weight of what rests: far above rounding, and so small that what stands for hours does not creep.
const SMALL_ISLAND_TOLERANCE: f64 = 1e-8;
/// That of large islands that hardly move, whose work grows with the digits asked for. A small island that takes
/// too much work is left at this one, and the step is then not settled.
const LARGE_ISLAND_TOLERANCE: f64 = 1e-2;
/// What may be left in the moving islands of a pile, relative to the largest velocity increment and to its
/// fastest body: a quarter of what a step's weight changes, and a small part of what it stops. A tenth costs a fifth
/// more for a pile that falls, a thousandth of what engines with a few sweeps leave is met all the same; from a half on
/// what is left gives energy in many a step of a wall, and is settled finer then after all.
const MOVING_TOLERANCE: f64 = 0.25;
const FASTEST_TOLERANCE: f64 = 3e-4;
/// What the last sweep over such an island may change, relative to what may be left: what is left is looked at besides.
pub(super) const CHANGE_IN_PILE: f64 = 0.75;
/// What lifting may leave in a moving island of a pile, relative to what its velocities may: if less, it would take
/// back in each step what they left, at a sixth of what a step costs, and overlaps would be no smaller.
const LIFTED_TOLERANCE: f64 = 3.0;
/// Islands of more contacts are large, and what has more is a pile.
pub(super) const LARGE: usize = 100;

/// Rates off by so many times what rounding leaves of gaps and speeds are met.
const ROUNDINGS: f64 = 9.0;

/// What counts as settled in a step, m/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    /// The change of velocity in small islands and in large ones: such changes leave a residual within the
    /// tolerance.
    pub(super) finest: f64,
    pub(super) enough: f64,
    /// The largest velocity increment.
    gain: f64,
    /// By how much what stands may be off from rest: a part of the velocity increment, however loose the
    /// tolerance, or weight would be lost.
    pub(super) still: f64,
    /// What rounding leaves of gaps and speeds.
    rounding: f64,
}

impl Settled {
    /// The residual within which a moving island of a pile is settled, by its fastest body.
    pub(super) fn moving(&self, fastest: f64) -> f64 {
        self.rounding.max(MOVING_TOLERANCE * self.gain).max(FASTEST_TOLERANCE * fastest)
    }

    /// The approach that lifting leaves in an island of a pile, by its fastest body, m/s.
    pub(super) fn lifted(&self, fastest: f64) -> f64 {
        if fastest > self.gain { LIFTED_TOLERANCE * self.moving(fastest) } else { self.enough }
    }

    /// The residual that a change leaves, within which an island is settled.
    pub(super) fn reached(&self, change: f64) -> f64 {
        if change > self.rounding { AMPLIFICATION * change } else { ROUNDINGS * self.rounding }
    }
}

impl<G: Dimension, P: Potential> World<G, P> {
    pub(super) fn settled(&self, contacts: &[ContactIn<G>], h: f64) -> Settled {
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
        Settled {
            finest: or_asked(SMALL_ISLAND_TOLERANCE),
            enough: or_asked(LARGE_ISLAND_TOLERANCE),
            gain,
            still: within(LARGE_ISLAND_TOLERANCE * gain),
            rounding,
        }
    }
}
