//! The narrow phase in space: where two shapes face each other, and how far apart they are.
//!
//! ```text
//! s(n) = min n.x2 - max n.x1  <=  |x2 - x1|          any direction n, any point of each
//! ```
//! The geometry library answers with separating axes and clipping for boxes, and with
//! Gilbert-Johnson-Keerthi and expanding polytopes for other convex solids. Points that face each
//! other along `n` across `s(n)` are the closest there are, by the inequality. Where the axes of
//! boxes find none such, because a corner is closest to a corner or to an edge, the closest points
//! are asked for: the gap is the distance, and its differential the gap's. Of boxes that overlap
//! the axes say all: the least way out leads through a face of the difference of both.
//!
//! Matching faces of boxes keep their corners; those of other convex solids, off by no more than
//! rounding, may lose one for a step.

use nalgebra::Vector3;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::contact_manifold_pfm_pfm_shapes;
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::{Shape as Geometry, Triangle};

use crate::Shape;
use crate::convert::from_vector;
use crate::dimension::Facing;
use crate::shape::WideBox;

type Manifold = ContactManifold<(), ()>;

/// Room for the answers of the library.
#[derive(Default)]
pub struct Manifolds {
    found: Vec<Manifold>,
    closest: Manifold,
}

/// Gaps wider than this part of a box are distances; below it the directions of closest points are
/// rounding, and the axes of the boxes are good enough.
const WIDE: f64 = 1e-7;
/// Points this part of a box farther apart than they need be are the closest.
const SHORT: f64 = 1e-9;

/// Appends where two shapes face each other; false where there is no query for them.
pub(crate) fn facing(
    shapes: [&Shape; 2],
    relative: &Pose,
    margin: f64,
    room: &mut Manifolds,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> bool {
    let [a, b] = shapes.map(|shape| &**shape.geometry());
    // Where two boxes meet, the second is looked at a little larger.
    let wide = shapes[1].wide().filter(|_| a.as_cuboid().is_some());
    let wider = wide.map_or(b, |wide| &*wide.geometry);
    let Manifolds { found: manifolds, closest } = room;
    manifolds.truncate(1);
    if a.as_composite_shape().is_some() || b.as_composite_shape().is_some() {
        manifolds.clear();
    } else {
        manifolds.resize_with(1, Manifold::default);
        manifolds[0].clear();
        manifolds[0].local_n1 = Vector::ZERO;
    }
    let dispatcher = DefaultQueryDispatcher;
    if dispatcher.contact_manifolds(relative, a, wider, margin, manifolds, &mut None).is_err() {
        return false;
    }
    for manifold in manifolds.iter() {
        if !by_corners(a, wider, relative, manifold) {
            append(manifold, wide, margin, found);
            continue;
        }
        closest.clear();
        closest.local_n1 = Vector::ZERO;
        (closest.subshape1, closest.subshape2) = (manifold.subshape1, manifold.subshape2);
        let triangles = [part(a, manifold.subshape1), part(b, manifold.subshape2)];
        let [a, b] = [(a, &triangles[0]), (b, &triangles[1])].map(|(whole, part)| match part {
            Some(triangle) => triangle as &dyn Geometry,
            None => whole,
        });
        contact_manifold_pfm_pfm_shapes(relative, a, b, None, None, margin, closest);
        append(closest, None, margin, found);
    }
    true
}

fn part(shape: &dyn Geometry, part: u32) -> Option<Triangle> {
    shape.as_trimesh().map(|mesh| mesh.triangle(part))
}

/// Whether axes of boxes were tried and none leads to the closest points, which are apart.
fn by_corners(a: &dyn Geometry, b: &dyn Geometry, relative: &Pose, manifold: &Manifold) -> bool {
    let boxes = [a.as_cuboid(), b.as_cuboid()];
    let sizes = boxes.into_iter().flatten().map(|cuboid| cuboid.half_extents.min_element());
    let triangles = [part(a, manifold.subshape1), part(b, manifold.subshape2)];
    let by_axes = match boxes {
        [Some(_), Some(_)] => true,
        [Some(_), None] => triangles[1].is_some(),
        [None, Some(_)] => triangles[0].is_some(),
        [None, None] => false,
    };
    let (n1, n2) = (manifold.local_n1, manifold.local_n2);
    // Without a direction, the boxes were apart by more than the margin.
    if !by_axes || n1 == Vector::ZERO {
        return false;
    }
    let farthest = |shape: &dyn Geometry, triangle: &Option<Triangle>, n: Vector| match triangle {
        Some(triangle) => triangle.as_support_map().map(|map| map.local_support_point(n)),
        None => shape.as_support_map().map(|map| map.local_support_point(n)),
    };
    let ends = (farthest(a, &triangles[0], n1), farthest(b, &triangles[1], n2));
    let (Some(end1), Some(end2)) = ends else { return false };
    let separation = (relative * end2 - end1).dot(n1);
    let deepest = manifold.points.iter().map(|point| point.dist).fold(f64::INFINITY, f64::min);
    let size = sizes.fold(f64::INFINITY, f64::min);
    separation > WIDE * size && deepest > separation + SHORT * size
}

/// Appends the points of a manifold, of which the second box may be a little too large.
fn append(
    manifold: &Manifold,
    wide: Option<&WideBox>,
    margin: f64,
    found: &mut Vec<Facing<Vector3<f64>>>,
) {
    let narrower = wide.map_or(0.0, |wide| wide.excess(manifold.local_n2));
    let parts = [manifold.subshape1, manifold.subshape2];
    let normal = from_vector(manifold.local_n1);
    let near = manifold.points.iter().filter(|point| point.dist + narrower <= margin);
    found.extend(near.map(|point| Facing {
        parts,
        features: [point.fid1.0, point.fid2.0],
        points: [from_vector(point.local_p1), from_vector(point.local_p2)],
        normal,
        gap: point.dist + narrower,
    }));
}
