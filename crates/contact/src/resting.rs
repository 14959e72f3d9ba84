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
//! step, would come back with the other sign for ever.

use nalgebra::Vector3;

use crate::ContactPoint;
use crate::rigid_contact::{Placed, Six};

/// The part of what counts as settled by which velocities may change in what rests.
const CHANGE: f64 = 1.0 / 16.0;
/// Friction, relative to what pushes, that is rounding.
const ROUNDING: f64 = 1e-12;

/// Bodies with impulses that are guessed.
#[derive(Debug, Default)]
pub(crate) struct Resting {
    moved: Vec<Moved>,
}

/// The sums of a body's impulses, and the velocity that it has with them.
#[derive(Clone, Copy, Debug)]
struct Moved {
    force: Vector3<f64>,
    torque: Vector3<f64>,
    centre: Vector3<f64>,
    /// The radius of a ball about it that holds the body's shapes, m.
    reach: f64,
    /// Of its centre and of its turning, world axes; and how they differ from the step's start.
    velocity: [Vector3<f64>; 2],
    change: [Vector3<f64>; 2],
    /// The velocities with the impulses and at the step's start, as they are stored.
    after: Six,
    before: Six,
}

/// One island's contacts, and what is asked of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guessed<'a> {
    pub(crate) points: &'a [ContactPoint],
    /// Impulses on the second bodies, world axes, N s.
    pub(crate) pushes: &'a [Vector3<f64>],
    /// How much of each gap is left, over the step, m/s.
    pub(crate) bias: &'a [f64],
}

impl Resting {
    /// Gives bodies, whose velocities grew by `kick` in this step, the impulses that are guessed.
    pub(crate) fn start(
        &mut self,
        placed: &[Placed],
        reach: impl Fn(usize) -> f64,
        kick: &[f64],
        guessed: Guessed,
    ) {
        let zero = Vector3::zeros();
        let still = |(body, placed): (usize, &Placed)| Moved {
            reach: reach(body),
            force: zero,
            torque: zero,
            centre: placed.centre,
            velocity: [zero; 2],
            change: [zero; 2],
            after: placed.velocity,
            before: placed.velocity,
        };
        self.moved.clear();
        self.moved.extend(placed.iter().enumerate().map(still));
        for (point, push) in guessed.points.iter().zip(guessed.pushes) {
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(body) = point.bodies[side] {
                    let moved = &mut self.moved[body];
                    let force = push * sign;
                    moved.force += force;
                    moved.torque += (point.points[side] - moved.centre).cross(&force);
                }
            }
        }
        for ((moved, placed), kick) in self.moved.iter_mut().zip(placed).zip(kick.chunks_exact(6)) {
            moved.go(placed, kick);
        }
    }

    /// How far at most an island is off from the normal conditions and from Coulomb's law, m/s;
    /// none where it does not rest.
    pub(crate) fn off(&self, island: &[usize], guessed: Guessed, settled: f64) -> Option<[f64; 2]> {
        let mut worst = [0.0_f64; 2];
        for &i in island {
            let (point, push) = (&guessed.points[i], &guessed.pushes[i]);
            let [rate, change] = self.rates(point);
            let normal = rate.dot(&point.normal);
            let pushed = push.dot(&point.normal);
            let left = normal + guessed.bias[i];
            if pushed <= 0.0 {
                if left < -settled || *push != Vector3::zeros() {
                    return None;
                }
                worst[0] = worst[0].max(-left);
                continue;
            }
            let across = push - point.normal * pushed;
            let rubs = |along: f64| if point.friction > 0.0 { along } else { 0.0 };
            let off = [left.abs(), rubs((rate - point.normal * normal).norm())];
            let changes = change.dot(&point.normal).abs().max(rubs(change.norm()));
            let reach = (point.friction + ROUNDING) * pushed;
            let rests = off.iter().all(|off| *off <= settled) && changes <= CHANGE * settled;
            if !rests || across.norm_squared() > reach * reach {
                return None;
            }
            worst = [worst[0].max(off[0]), worst[1].max(off[1])];
        }
        Some(worst)
    }

    /// Whether nothing of a body changes.
    #[inline]
    pub(crate) fn stands(&self, body: usize, settled: f64) -> bool {
        let Moved { change: [v, w], reach, .. } = self.moved[body];
        v.norm() + reach * w.norm() <= CHANGE * settled
    }

    /// The velocity of a body at the step's start, as it is stored.
    #[inline]
    pub(crate) fn before(&self, body: usize) -> &Six {
        &self.moved[body].before
    }

    /// The velocity of a body with the impulses that are guessed, as it is stored.
    #[inline]
    pub(crate) fn after(&self, body: usize) -> &Six {
        &self.moved[body].after
    }

    /// How fast the second point leaves the first, and how much faster than at the step's start.
    #[inline]
    fn rates(&self, point: &ContactPoint) -> [Vector3<f64>; 2] {
        let mut rates = [Vector3::zeros(); 2];
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(body) = point.bodies[side] {
                let moved = &self.moved[body];
                let arm = point.points[side] - moved.centre;
                for (rate, [v, w]) in rates.iter_mut().zip([moved.velocity, moved.change]) {
                    *rate += (v + w.cross(&arm)) * sign;
                }
            }
        }
        rates
    }
}

impl Moved {
    #[inline]
    fn go(&mut self, placed: &Placed, kick: &[f64]) {
        let torque = placed.rotation.tr_mul(&self.torque);
        let wrench = [self.force.x, self.force.y, self.force.z, torque.x, torque.y, torque.z];
        let pushed: Six = std::array::from_fn(|f| placed.scale[f] * placed.scale[f] * wrench[f]);
        self.before = std::array::from_fn(|f| placed.velocity[f] - kick[f]);
        self.after = std::array::from_fn(|f| placed.velocity[f] + pushed[f]);
        let halves = |six: &Six| {
            let [a, b, c, d, e, f] = *six;
            [Vector3::new(a, b, c), placed.rotation * Vector3::new(d, e, f)]
        };
        self.velocity = halves(&self.after);
        self.change = halves(&std::array::from_fn(|f| kick[f] + pushed[f]));
    }
}
