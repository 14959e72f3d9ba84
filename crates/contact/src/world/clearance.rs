//! Pairs that pass each other with clearance: proved apart all the way, and so without contact.
//!
//! ```text
//! d(t + dt) >= d(t) - L dt,   L = max(0, -n.(v2 - v1)) + r1 |w1| + r2 |w2|
//! ```
//! `d` the distance of two convex shapes (m) and `n` from the one to the other where they are closest,
//! `v w` velocities of their bodies (m/s, rad/s), `r` the radii of balls about the bodies' centres that
//! hold them: along `n` alone they stay that far apart (conservative advancement). For other shapes
//! `|v2 - v1|` takes the place of the first term. A gap that is linear over the step takes what flies
//! past for what hits; where bodies move far in a step, the distances on the way decide. What comes
//! nearer than a small part of the bodies, and what is not decided at the bound, meets. Source: notes
//! 11.1; Mirtich 1996.

use stationary_rigid::LieGroup;

use crate::{ColliderIn, Dimension};

/// Distances looked at before two bodies count as meeting.
const LOOKS: usize = 100;
/// Distances below this part of the smaller radius are none.
const CLOSE: f64 = 1e-6;

/// A shape, and how its body moves: its velocity as it is stored, and its radius.
pub(crate) struct Mover<'a, G: Dimension> {
    pub(crate) collider: &'a ColliderIn<G>,
    pub(crate) pose: G::Motion,
    pub(crate) velocity: G::Velocity,
    pub(crate) radius: f64,
}

impl<G: Dimension> Mover<'_, G> {
    fn at(&self, time: f64) -> G::Pose {
        G::convert(&G::walked(&self.pose, &self.velocity, time).compose(&self.collider.place))
    }
}

/// Whether two shapes may meet within `h` seconds.
pub(crate) fn may_meet<G: Dimension>(movers: &[Mover<G>; 2], h: f64) -> bool {
    let radius = movers.iter().map(|mover| mover.radius).filter(|&radius| radius > 0.0);
    let close = CLOSE * radius.fold(f64::INFINITY, f64::min);
    let shapes = [&movers[0].collider.shape, &movers[1].collider.shape];
    let (along, turning) = closing(movers);
    let mut time = 0.0;
    for _ in 0..LOOKS {
        let poses = [movers[0].at(time), movers[1].at(time)];
        let Some((apart, convex)) = G::closest(shapes, [&poses[0], &poses[1]]) else {
            return true;
        };
        let distance = G::dot(&apart, &apart).sqrt();
        if distance <= close || distance.is_nan() {
            return true;
        }
        let speed = match convex {
            true => (-G::dot(&apart, &along) / distance).max(0.0),
            false => G::dot(&along, &along).sqrt(),
        };
        time += (distance - 0.5 * close) / (speed + turning);
        if time >= h {
            return false;
        }
    }
    true
}

/// How fast any two points of two bodies approach at most, m/s.
pub(crate) fn closing_speed<G: Dimension>(movers: &[Mover<G>; 2]) -> f64 {
    let (along, turning) = closing(movers);
    G::dot(&along, &along).sqrt() + turning
}

/// How fast the second centre leaves the first, and how fast points turn about both at most.
fn closing<G: Dimension>(movers: &[Mover<G>; 2]) -> (G::Vector, f64) {
    let [a, b] = [0, 1].map(|k| movers[k].velocity.as_ref());
    let mut along = G::Vector::default();
    (0..G::TRANSLATION).for_each(|k| along[k] = b[k] - a[k]);
    let turning = movers.iter().map(|mover| {
        let spin = &mover.velocity.as_ref()[G::TRANSLATION..];
        mover.radius * spin.iter().map(|w| w * w).sum::<f64>().sqrt()
    });
    (along, turning.sum())
}
