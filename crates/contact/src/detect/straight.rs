//! The direction between capsules and solids with flat faces, from their faces, edges and corners one by one.
//!
//! ```text
//! max s(n),    n = +n1, -n2, +-e1 x e2/|e1 x e2|,    or along x2 - x1 of the closest corners and edges
//! ```
//! `e` edges, the core of a capsule among them; `s` the separation of the cores. A search over all directions comes
//! to the same with fewer digits where edges are nearly parallel or a core touches a corner.

use nalgebra::Vector3;

use crate::detect::narrow_phase::EDGE_PAIRS;
use crate::detect::polytope_axes::{Seen, Source, farthest};
use crate::detect::polytope_corners::closest;
use crate::detect::polytopes::crossing;
use crate::detect::round_contacts::Body;
use crate::detect::separation::{Direction, at_faces};
use crate::shapes::polytope::Polytope;
use crate::shapes::solid::{Form, Part, Placed};

type V = Vector3<f64>;

/// Directions that are better by less than this part of the size are as good: those of faces come first.
const TIE: f64 = 1e-14;

/// Room for the corners of solids without a curve but a capsule's, which is around its core.
pub(crate) struct Straight {
    corners: [Vec<V>; 2],
    segment: Polytope,
}

impl Default for Straight {
    fn default() -> Self {
        Straight { corners: [Vec::new(), Vec::new()], segment: Polytope::segment() }
    }
}

impl Straight {
    /// The direction between two capsules or solids with flat faces: of their faces, edges and corners the one
    /// along which they are farthest apart. None for others, and for cores that cross.
    pub(crate) fn direction(
        &mut self,
        bodies: [Body<'_>; 2],
        placed: [&Placed; 2],
    ) -> Option<Direction> {
        let Straight { corners, segment } = self;
        for (corners, solid) in corners.iter_mut().zip(placed) {
            corners.clear();
            for part in &solid.parts {
                let Part::Point(point) = part else { return None };
                corners.push(*point);
            }
        }
        segment.size = placed[0].size.max(placed[1].size);
        let flat = |k: usize| match bodies[k].solid.form {
            Form::Segment => Some(&*segment),
            _ => bodies[k].polytope,
        };
        let (Some(first), Some(second)) = (flat(0), flat(1)) else { return None };
        let seen =
            |k: usize, solid| Seen { solid, corners: &corners[k], normals: &placed[k].faces };
        let [a, b] = [seen(0, first), seen(1, second)];
        if a.solid.edges.len() * b.solid.edges.len() > EDGE_PAIRS {
            return None;
        }
        let size = placed[0].size.max(placed[1].size);
        let rounding = placed[0].rounding + placed[1].rounding;
        let axis = farthest(a, b, TIE * size, f64::INFINITY)?;
        let met = match axis.from {
            Source::Edges(one, other) => {
                crossing([a, b], [one, other], &axis.normal, axis.separation)
            }
            Source::First(_) | Source::Second(_) => None,
        };
        let face = !matches!(axis.from, Source::Edges(..));
        let mut found = (axis.separation, axis.normal, met);
        let mut beside_face = None;
        if axis.separation >= -TIE * size
            && let Some((points, normal, separation)) = closest([a, b])
        {
            let better = separation - axis.separation;
            if better > if met.is_some() || face { TIE } else { -TIE } * size {
                found = (separation, normal, Some(points));
            } else if better > -TIE * size {
                beside_face = Some(normal);
            }
        }
        let (separation, normal, met) = found;
        let gap = separation - rounding;
        let known = separation > f64::NEG_INFINITY;
        let found = Direction { gap, normal, beside_face, met };
        known.then(|| if met.is_some() { found } else { at_faces(placed, found) })
    }
}
