//! Where a ray meets a convex solid, in the axes of the solid.
//!
//! ```text
//! n.(o + t d - a) <= 0  for every face         t between the last entrance and the first exit
//! t <- t + s/(-n.d),   s = min n.x - n.(o + t d)  towards a round solid, until s = 0
//! ```
//! `o` the start of the ray (m), `d` its unit direction. `n a` the normal of a face and one of its points; of a
//! round solid `n` is the unit normal along which it and the place `o + t d` are farthest apart. The solid
//! lies behind the plane at that distance, so no step passes it. Source: van den Bergen 2004.

#[cfg(feature = "3d")]
use nalgebra::Vector3;

/// How far along a ray the last of some planes is entered, and which one; none where it starts behind all of them.
/// No answer where an exit comes first, or where the entrance is farther than `longest`. Each plane by `n.d`
/// and `n.(o - a)`.
pub(crate) fn entrance(
    planes: impl Iterator<Item = [f64; 2]>,
    longest: f64,
) -> Option<(f64, Option<usize>)> {
    let (mut enter, mut face, mut leave) = (0.0, None, longest);
    for (k, [along, height]) in planes.enumerate() {
        if along < 0.0 {
            let t = -height / along;
            if t > enter {
                (enter, face) = (t, Some(k));
            }
        } else if height > 0.0 {
            return None;
        } else if along > 0.0 {
            leave = f64::min(leave, -height / along);
        }
        if enter > leave {
            return None;
        }
    }
    Some((enter, face))
}

/// How far along a ray one may go before what is within a size of the origin is near: there places have the
/// digits that squares of them need.
#[inline]
pub(crate) fn beside(along: f64, size: f64) -> f64 {
    (-along - 2.0 * size).max(0.0)
}

/// Steps towards a round solid; what grazes it takes the most, each about half of the one before.
#[cfg(feature = "3d")]
const STEPS: usize = 200;
/// Distances below this part of the coordinates are rounding.
#[cfg(feature = "3d")]
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far along a ray it meets a round solid, and the normal there.
#[cfg(feature = "3d")]
pub(crate) fn on_round(
    solid: &crate::shapes::solid::Solid,
    start: &Vector3<f64>,
    direction: &Vector3<f64>,
    longest: f64,
) -> Option<(f64, Vector3<f64>)> {
    use crate::detect::separation::{Direction, separate};
    use crate::shapes::convert::vector;
    use crate::shapes::solid::{Placed, Solid};
    use parry3d_f64::math::Pose;
    let [mut own, mut place] = [Placed::default(), Placed::default()];
    solid.place(&Pose::IDENTITY, &mut own);
    let point = Solid::ball(0.0);
    // From beside the solid on, where places have the digits that a normal needs.
    let ahead = beside(start.dot(direction), solid.size);
    let near = start + direction * ahead;
    let mut t = 0.0;
    for _ in 0..STEPS {
        if ahead + t > longest {
            return None;
        }
        let at = near + direction * t;
        point.place(&Pose::from_translation(vector(&at)), &mut place);
        let Direction { gap, normal, .. } = separate([&own, &place], f64::INFINITY)?;
        if gap <= ROUNDING * (solid.size + at.norm()) {
            let t = ahead + t;
            return Some((t, if t > 0.0 { normal } else { -direction }));
        }
        let closing = -normal.dot(direction);
        if closing <= 0.0 {
            return None;
        }
        t += gap / closing;
    }
    None
}
