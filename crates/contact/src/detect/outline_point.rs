//! Where a convex outline in the plane is closest to a point.
//!
//! ```text
//! s_k = n_k.(x - a_k)              height of the point x above side k, which leaves corner a_k
//! inside: the side of the largest s_k;   outside: the least distance from any side, its ends included
//! ```
//! Metres. A segment has two sides and no inside, a point has no side at all.

use parry2d_f64::math::Vector;

use crate::shapes::outline::Outline;

/// The place of an outline that is closest to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) place: Vector,
    /// Out of the outline, of length 1.
    pub(crate) normal: Vector,
    /// Of the point from the place along the normal; negative inside, m.
    pub(crate) distance: f64,
    pub(crate) on: Feature,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Feature {
    Side(usize),
    Corner(usize),
}

/// The place of an outline that is closest to a point; lengths below `rounding` have no direction.
pub(crate) fn nearest(outline: &Outline, point: Vector, rounding: f64) -> Nearest {
    let (points, normals) = (outline.points(), outline.normals());
    let on_side = |side: usize| {
        let (normal, distance) = (normals[side], normals[side].dot(point - points[side]));
        Nearest { place: point - normal * distance, normal, distance, on: Feature::Side(side) }
    };
    let at_corner = |corner: usize| {
        let (place, way) = (points[corner], point - points[corner]);
        let (distance, on) = (way.length(), Feature::Corner(corner));
        // At its centre any direction is as good.
        let normal = if distance > 0.0 { way / distance } else { Vector::Y };
        Nearest { place, normal, distance, on }
    };
    let mut sides = (0..normals.len()).map(on_side);
    let Some(first) = sides.next() else { return at_corner(0) };
    let highest =
        sides.fold(first, |best, side| if side.distance > best.distance { side } else { best });
    if normals.len() > 2 && highest.distance < 0.0 {
        return highest;
    }
    let mut best: Option<Nearest> = None;
    for side in 0..normals.len() {
        let beside = on_side(side);
        if beside.distance < -rounding {
            continue;
        }
        let ends = [side, (side + 1) % points.len()];
        let [from, to] = ends.map(|end| points[end]);
        let (along, way) = (to - from, point - from);
        let along_way = way.dot(along);
        let here = if along_way <= 0.0 {
            at_corner(ends[0])
        } else if along_way >= along.length_squared() {
            at_corner(ends[1])
        } else {
            beside
        };
        if best.is_none_or(|best| here.distance < best.distance) {
            best = Some(here);
        }
    }
    match best {
        // The way to a corner that is so near is rounding.
        Some(near) if near.distance > rounding || matches!(near.on, Feature::Side(_)) => near,
        _ => highest,
    }
}
