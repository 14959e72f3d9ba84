//! What rests: the impulses of the last step, asked whether they meet the conditions of this one,
//! before anything else is made of its contacts.
//!
//! ```text
//! v = v_f + M^-1 sum J^T x,   u = J v                with the impulses x that are guessed
//! |x_t| <= mu x_n,   |u_n + bias| <= s,   |u_t| <= s        where x pushes, and rubs
//! u_n + bias >= -s                                          elsewhere
//! |J (v - v_0)| <= s/16                              nothing changes either
//! ```
//! `v_f` velocities before any impulse of this step, `v_0` those at its start (m/s, rad/s), `x`
//! impulses (N s), `s` what counts as settled (m/s). All in world axes, from forces and torques of
//! whole bodies: no tangents, no rows. The conditions are sufficient: what is off from them bounds
//! what is off from the normal conditions and from Coulomb's law, for projections bring nothing
//! farther apart. Without the last one an error of the impulses, too small to be noticed in one
//! step, would come back with the other sign for ever. What is kept though the impulses would change it
//! is part of the residual that is reported: at most twice the fastest point's change, of two bodies
//! against each other.

use crate::solve::body_state::BodyState;
use crate::{ContactIn, Dimension};

/// The part of what counts as settled by which velocities may change in what rests.
pub(crate) const CHANGE: f64 = 1.0 / 16.0;
/// Friction, relative to what pushes, that is rounding.
const ROUNDING: f64 = 1e-12;

/// Bodies with impulses that are guessed.
#[derive(Debug)]
pub(crate) struct Resting<G: Dimension> {
    moved: Vec<Moved<G>>,
}

impl<G: Dimension> Default for Resting<G> {
    fn default() -> Self {
        Resting { moved: Vec::new() }
    }
}

/// The sums of a body's impulses, and the velocity that it has with them.
#[derive(Clone, Copy, Debug)]
struct Moved<G: Dimension> {
    force: G::Vector,
    torque: G::Spin,
    centre: G::Vector,
    /// The radius of a ball about it that holds the body's shapes, m.
    reach: f64,
    /// One over its mass, 1/kg; zero where nothing moves it.
    lightness: f64,
    /// Of its centre and of its turning, world axes; and how they differ from the step's start.
    velocity: (G::Vector, G::Spin),
    change: (G::Vector, G::Spin),
    /// The velocities with the impulses and at the step's start, as they are stored.
    after: G::Velocity,
    before: G::Velocity,
}

/// One island's contacts, and what is asked of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guessed<'a, G: Dimension> {
    pub(crate) points: &'a [ContactIn<G>],
    /// Impulses on the second bodies, world axes, N s.
    pub(crate) impulses: &'a [G::Vector],
    /// How much of each gap is left, over the step, m/s.
    pub(crate) bias: &'a [f64],
}

impl<G: Dimension> Resting<G> {
    /// Gives bodies, whose velocities grew by `increment` in this step, the impulses that are guessed.
    pub(crate) fn start(
        &mut self,
        states: &[BodyState<G>],
        reach: impl Fn(usize) -> f64,
        increment: &[f64],
        guessed: Guessed<G>,
    ) {
        let (force, torque) = (G::Vector::default(), G::Spin::default());
        let still = |(body, state): (usize, &BodyState<G>)| Moved {
            reach: reach(body),
            lightness: state.scale.as_ref()[0] * state.scale.as_ref()[0],
            force,
            torque,
            centre: state.centre,
            velocity: (force, torque),
            change: (force, torque),
            after: state.velocity,
            before: state.velocity,
        };
        self.moved.clear();
        self.moved.extend(states.iter().enumerate().map(still));
        for (point, impulse) in guessed.points.iter().zip(guessed.impulses) {
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(body) = point.bodies[side] {
                    let moved = &mut self.moved[body];
                    let force = *impulse * sign;
                    let arm = point.points[side] - moved.centre;
                    moved.force = moved.force + force;
                    moved.torque = moved.torque + G::torque(&arm, &force);
                }
            }
        }
        let increments = increment.chunks_exact(G::FREEDOMS);
        for ((moved, state), increment) in self.moved.iter_mut().zip(states).zip(increments) {
            moved.go(state, increment);
        }
    }

    /// How far at most an island is off from the normal conditions and from Coulomb's law, m/s;
    /// none where it does not rest.
    pub(crate) fn off(
        &self,
        island: &[usize],
        guessed: Guessed<G>,
        settled: f64,
    ) -> Option<[f64; 2]> {
        let length = |v: &G::Vector| G::dot(v, v).sqrt();
        let mut worst = [0.0_f64; 2];
        for &i in island {
            let (point, impulse) = (&guessed.points[i], &guessed.impulses[i]);
            let [rate, change] = self.rates(point);
            let normal = G::dot(&rate, &point.normal);
            let pushed = G::dot(impulse, &point.normal);
            let left = normal + guessed.bias[i];
            if pushed <= 0.0 {
                if left < -settled || *impulse != G::Vector::default() {
                    return None;
                }
                worst[0] = worst[0].max(-left);
                continue;
            }
            let across = *impulse - point.normal * pushed;
            let rubs = |along: f64| if point.friction > 0.0 { along } else { 0.0 };
            let off = [left.abs(), rubs(length(&(rate - point.normal * normal)))];
            let changes = G::dot(&change, &point.normal).abs().max(rubs(length(&change)));
            let reach = (point.friction + ROUNDING) * pushed;
            let rests = off.iter().all(|off| *off <= settled) && changes <= CHANGE * settled;
            if !rests || G::dot(&across, &across) > reach * reach {
                return None;
            }
            worst = [worst[0].max(off[0]), worst[1].max(off[1])];
        }
        Some(worst)
    }

    /// By how much any point of a body changes its velocity at most, m/s.
    #[inline]
    pub(crate) fn change(&self, body: usize) -> f64 {
        let Moved { change: (v, w), reach, .. } = self.moved[body];
        G::dot(&v, &v).sqrt() + reach * G::spin_speed(&w)
    }

    /// The fastest that one impulse of an island would make a body that it pushes, m/s.
    pub(crate) fn fastest_push(&self, island: &[usize], guessed: Guessed<G>) -> f64 {
        let push = |&i: &usize| {
            let impulse = &guessed.impulses[i];
            let bodies = guessed.points[i].bodies.iter().flatten();
            let lightest = bodies.map(|&body| self.moved[body].lightness).fold(0.0, f64::max);
            lightest * G::dot(impulse, impulse).sqrt()
        };
        island.iter().map(push).fold(0.0, f64::max)
    }

    /// The velocity of a body at the step's start, as it is stored.
    #[inline]
    pub(crate) fn before(&self, body: usize) -> &G::Velocity {
        &self.moved[body].before
    }

    /// The velocity of a body with the impulses that are guessed, as it is stored.
    #[inline]
    pub(crate) fn after(&self, body: usize) -> &G::Velocity {
        &self.moved[body].after
    }

    /// How fast the second point leaves the first, and how much faster than at the step's start.
    #[inline]
    fn rates(&self, point: &ContactIn<G>) -> [G::Vector; 2] {
        let mut rates = [G::Vector::default(); 2];
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(body) = point.bodies[side] {
                let moved = &self.moved[body];
                let arm = point.points[side] - moved.centre;
                for (rate, (v, w)) in rates.iter_mut().zip([moved.velocity, moved.change]) {
                    *rate = *rate + (v + G::swing(&w, &arm)) * sign;
                }
            }
        }
        rates
    }
}

impl<G: Dimension> Moved<G> {
    #[inline]
    fn go(&mut self, state: &BodyState<G>, increment: &[f64]) {
        let wrench = G::join(&state.frame, &self.force, &self.torque);
        let mut change = G::Velocity::default();
        for (f, increment) in increment.iter().enumerate() {
            let scale = state.scale.as_ref()[f];
            let pushed = scale * scale * wrench.as_ref()[f];
            self.before.as_mut()[f] -= increment;
            self.after.as_mut()[f] += pushed;
            change.as_mut()[f] = increment + pushed;
        }
        self.velocity = G::split(&state.frame, &self.after);
        self.change = G::split(&state.frame, &change);
    }
}
