//! The narrow phase in space: where two shapes face each other, and how far apart they are.
//!
//! ```text
//! s(n) = min n.x2 - max n.x1  <=  |x2 - x1|          any direction n, any point of each
//! ```
//! Boxes are clipped along the axis along which they are farthest apart; so are hulls of points, by
//! faces of any number of corners, and both against the triangles of a surface; on a half-space every
//! corner counts. Capsules, cylinders, cones and ellipsoids have a search of their own
//! (`separation.rs`), and so have hulls of very many edges. A ball faces the place of a box, a hull or a triangle
//! that is closest to its centre (`polytope_point.rs`). Balls beside balls and half-spaces, and boxes on
//! half-spaces, are asked of the geometry library, which has closed forms for them. Points that face each other along `n` across
//! `s(n)` are the closest there are, by the inequality. Where the axes of boxes find none such, because a corner is closest to a corner or
//! to an edge, the closest points are asked for: the gap is the distance, and its differential the
//! gap's. Of boxes that overlap the axes say all: the least way out leads through a face of the
//! difference of both.
//!
//! Matching faces of boxes and hulls keep their corners.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::{Cuboid, PackedFeatureId};

use crate::Shape;
use crate::detect::box_axes::farthest;
use crate::detect::box_faces::{Face, share};
use crate::detect::polytope_point::{Nearest, nearest};
use crate::detect::polytopes;
use crate::detect::round_contacts::{self, Body};
use crate::shapes::convert::{from_vector, vector};
use crate::shapes::dimension::{Answer, Facing};
use crate::shapes::polytope::Polytope;
use crate::shapes::shape::WideBox;
use crate::shapes::solid::Solid;

type Manifold = ContactManifold<(), ()>;

/// Room for the answers of the library.
#[derive(Default)]
pub struct Manifolds {
    found: Vec<Manifold>,
    polytopes: polytopes::Room,
    triangle: Option<Polytope>,
    round: round_contacts::Room,
}

/// Two points of boxes face each other along the axis along which they are farthest apart: where the closest of a
/// manifold are farther apart by this part of the larger box, it has lost them.
const LOST: f64 = 5e-13;

/// Distances below this part of the size and the distance are rounding, and have no direction.
const ROUNDING: f64 = 1e-13;

/// Pairs of edges beyond which looking at each costs more than the search for the direction between round
/// solids.
pub(crate) const EDGE_PAIRS: usize = 1 << 16;

/// Appends where two shapes face each other.
pub(crate) fn facing(
    shapes: [&Shape; 2],
    relative: &Pose,
    margin: f64,
    room: &mut Manifolds,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> Answer {
    let both = shapes.map(|shape| &**shape.geometry());
    let Manifolds { found: manifolds, polytopes: space, triangle, round } = room;
    if [0, 1].into_iter().any(|side| ball_facing(shapes, side, relative, margin, triangle, found)) {
        return Answer::Now;
    }
    // The library answers, with gaps that are wrong.
    if both.iter().all(|shape| shape.as_trimesh().is_some()) {
        return Answer::None;
    }
    let edges = |shape: &Shape| match (shape.polytope(), shape.geometry().as_trimesh()) {
        (Some(solid), _) => solid.edges.len(),
        (None, Some(_)) => 3,
        (None, None) => 0,
    };
    let many = edges(shapes[0]) * edges(shapes[1]) > EDGE_PAIRS;
    if many || shapes.iter().any(|shape| shape.curved().is_some()) {
        return round_facing(shapes, relative, margin, round, triangle, found);
    }
    if let (Some(first), Some(wide)) = (both[0].as_cuboid(), shapes[1].wide()) {
        match clip(first, wide, relative, margin, found) {
            Clipped::Apart => return Answer::Now,
            Clipped::Faces(answer) => return answer,
            // Below, of their corners and edges.
            Clipped::Corners => {}
        }
    }
    if let [Some(first), Some(second)] = shapes.map(Shape::polytope) {
        polytopes::facing([first, second], relative, margin, space, found);
        return Answer::Now;
    }
    if let Some(side) = both.iter().position(|shape| shape.as_trimesh().is_some())
        && let (Some(mesh), Some(solid)) = (both[side].as_trimesh(), shapes[1 - side].polytope())
    {
        // The solid's box as the mesh sees it.
        let place = if side == 0 { *relative } else { relative.inverse() };
        let near = shapes[1 - side].aabb(&place).loosened(margin);
        let triangle = triangle.get_or_insert_with(Polytope::triangle);
        for part in mesh.bvh().intersect_aabb(&near) {
            let corners = mesh.triangle(part);
            triangle.set_triangle([corners.a, corners.b, corners.c].map(from_vector));
            let first = found.len();
            let pair = if side == 0 { [&*triangle, solid] } else { [solid, &*triangle] };
            polytopes::facing(pair, relative, margin, space, found);
            found[first..].iter_mut().for_each(|facing| facing.parts[side] = part);
        }
        return Answer::Now;
    }
    if let Some(answer) = on_plane(shapes, relative, margin, found) {
        return answer;
    }
    manifolds.truncate(1);
    if both.iter().any(|shape| shape.as_composite_shape().is_some()) {
        manifolds.clear();
    } else {
        manifolds.resize_with(1, Manifold::default);
        manifolds[0].clear();
        manifolds[0].local_n1 = Vector::ZERO;
    }
    let dispatcher = DefaultQueryDispatcher;
    let [a, b] = both;
    if dispatcher.contact_manifolds(relative, a, b, margin, manifolds, &mut None).is_err() {
        return Answer::None;
    }
    manifolds.iter().for_each(|manifold| append(manifold, margin, found));
    let solid =
        |k: usize| both[k].as_cuboid().is_some() || both[k].as_convex_polyhedron().is_some();
    let plane = |&k: &usize| shapes[k].plane().is_some() && solid(1 - k);
    [0, 1].iter().find(|k| plane(k)).map_or(Answer::Now, |&k| Answer::Plane(k))
}

/// Appends where a ball, the shape `side`, faces a solid with flat faces or the triangles of a surface; says
/// whether it is one, and the other shape such.
fn ball_facing(
    shapes: [&Shape; 2],
    side: usize,
    relative: &Pose,
    margin: f64,
    triangle: &mut Option<Polytope>,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> bool {
    let (Some(radius), other) = (shapes[side].ball_radius(), shapes[1 - side]) else {
        return false;
    };
    // The ball as the other one sees it.
    let place = if side == 0 { relative.inverse() } else { *relative };
    let centre = from_vector(place.translation);
    let mut append = |solid: &Polytope, part: u32| {
        let rounding = ROUNDING * (solid.size + centre.norm());
        let Nearest { place: on_solid, normal, distance, feature } =
            nearest(solid, &centre, rounding);
        let gap = distance - radius;
        if gap > margin {
            return;
        }
        // Out of the ball, in its own axes.
        let towards = from_vector(place.rotation.inverse() * vector(&-normal));
        let (mut parts, mut features) = ([0, part], [PackedFeatureId::face(0).0, feature]);
        let mut points = [towards * radius, on_solid];
        parts.swap(0, side);
        features.swap(0, side);
        points.swap(0, side);
        let normal = if side == 0 { towards } else { normal };
        found.push(Facing { parts, features, points, normal, gap });
    };
    match (other.polytope(), other.geometry().as_trimesh()) {
        (Some(solid), _) => append(solid, 0),
        (None, Some(mesh)) => {
            let reach = Vector::splat(radius + margin);
            let near = Aabb::new(place.translation - reach, place.translation + reach);
            let triangle = triangle.get_or_insert_with(Polytope::triangle);
            for part in mesh.bvh().intersect_aabb(&near) {
                let corners = mesh.triangle(part);
                triangle.set_triangle([corners.a, corners.b, corners.c].map(from_vector));
                append(triangle, part);
            }
        }
        (None, None) => return false,
    }
    true
}

/// Finds where two convex parts with flat faces face each other, however far apart; says whether they are
/// such parts, and few enough of their edges.
pub(crate) fn facing_polytopes(
    shapes: [&Shape; 2],
    parts: [u32; 2],
    relative: &Pose,
    room: &mut Manifolds,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> bool {
    found.clear();
    let Manifolds { polytopes: space, triangle, .. } = room;
    let mesh = shapes.iter().position(|shape| shape.geometry().as_trimesh().is_some());
    let pair = match (shapes.map(Shape::polytope), mesh) {
        ([Some(first), Some(second)], _) => [first, second],
        ([None, Some(solid)] | [Some(solid), None], Some(side)) => {
            let Some(mesh) = shapes[side].geometry().as_trimesh() else { return false };
            let corners = mesh.triangle(parts[side]);
            let triangle = triangle.get_or_insert_with(Polytope::triangle);
            triangle.set_triangle([corners.a, corners.b, corners.c].map(from_vector));
            if side == 0 { [&*triangle, solid] } else { [solid, &*triangle] }
        }
        _ => return false,
    };
    if pair[0].edges.len() * pair[1].edges.len() > EDGE_PAIRS {
        return false;
    }
    polytopes::facing(pair, relative, f64::INFINITY, space, found);
    true
}

/// Appends where a round solid and another shape face each other.
fn round_facing(
    shapes: [&Shape; 2],
    relative: &Pose,
    margin: f64,
    room: &mut round_contacts::Room,
    triangle: &mut Option<Polytope>,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> Answer {
    let bodies =
        shapes.map(|shape| Some(Body { solid: shape.solid()?, polytope: shape.polytope() }));
    if let [Some(first), Some(second)] = bodies {
        round_contacts::facing([first, second], relative, margin, room, found);
        return Answer::Now;
    }
    let side = usize::from(bodies[0].is_some());
    let Some(body) = bodies[1 - side] else { return Answer::None };
    // The solid as the other one sees it.
    let place = if side == 0 { *relative } else { relative.inverse() };
    if let Some(normal) = shapes[side].plane() {
        let mut say = |name: u32, on_solid: Vector3<f64>, gap: f64| {
            if gap > margin {
                return;
            }
            let on_plane = from_vector(place * vector(&on_solid)) - normal * gap;
            let seen = from_vector(place.rotation.inverse() * vector(&-normal));
            let (mut features, mut points) = ([0, name], [on_plane, on_solid]);
            features.swap(0, side);
            points.swap(0, side);
            let normal = if side == 0 { normal } else { seen };
            found.push(Facing { parts: [0, 0], features, points, normal, gap });
        };
        round_contacts::facing_plane(body, &place, &normal, room, &mut say);
        return Answer::Now;
    }
    let Some(mesh) = shapes[side].geometry().as_trimesh() else { return Answer::None };
    let near = shapes[1 - side].aabb(&place).loosened(margin);
    let triangle = triangle.get_or_insert_with(Polytope::triangle);
    for part in mesh.bvh().intersect_aabb(&near) {
        let corners = mesh.triangle(part);
        triangle.set_triangle([corners.a, corners.b, corners.c].map(from_vector));
        let solid = Solid::polytope(triangle);
        let flat = Body { solid: &solid, polytope: Some(&*triangle) };
        let first = found.len();
        let pair = if side == 0 { [flat, body] } else { [body, flat] };
        round_contacts::facing(pair, relative, margin, room, found);
        found[first..].iter_mut().for_each(|facing| facing.parts[side] = part);
    }
    Answer::Now
}

/// Appends every corner of a convex solid that is near to a half-space; none of other shapes.
fn on_plane(
    shapes: [&Shape; 2],
    relative: &Pose,
    margin: f64,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> Option<Answer> {
    let side = shapes.iter().position(|shape| shape.plane().is_some())?;
    let (normal, solid) = (shapes[side].plane()?, shapes[1 - side].polytope()?);
    // The library keeps every corner of a box.
    if shapes[1 - side].wide().is_some() {
        return None;
    }
    // The solid as the half-space sees it.
    let place = if side == 0 { *relative } else { relative.inverse() };
    polytopes::facing_plane(solid, &place, &normal, margin, |corner, on_solid, on_plane, gap| {
        let facing = match side {
            0 => Facing {
                parts: [0, 0],
                features: [0, corner],
                points: [on_plane, on_solid],
                normal,
                gap,
            },
            _ => Facing {
                parts: [0, 0],
                features: [corner, 0],
                points: [on_solid, on_plane],
                normal: from_vector(relative.rotation * -vector(&normal)),
                gap,
            },
        };
        found.push(facing);
    });
    Some(Answer::Plane(side))
}

/// What clipping the faces of two boxes against each other found.
enum Clipped {
    /// They are farther apart than the margin.
    Apart,
    /// The closest points are among those of the faces.
    Faces(Answer),
    /// The closest points are corners, or on edges, that do not face each other.
    Corners,
}

/// Appends the corners of what the faces of two boxes share that look along the axis along which they are farthest
/// apart; the second box reaches farther than the shape.
fn clip(
    first: &Cuboid,
    wide: &WideBox,
    relative: &Pose,
    margin: f64,
    found: &mut Vec<Facing<Vector3<f64>>>,
) -> Clipped {
    let halves = [first.half_extents, wide.cuboid.half_extents];
    let axes = [Vector::X, Vector::Y, Vector::Z].map(|axis| relative.rotation * axis);
    let Some(axis) = farthest(halves, &axes, relative.translation, margin) else {
        return Clipped::Apart;
    };
    let n1 = axis.normal;
    let seen = |direction: Vector| Vector::from_array(axes.map(|axis| axis.dot(direction)));
    let n2 = seen(-n1);
    let faces = [
        Face::of(halves[0], &[Vector::X, Vector::Y, Vector::Z], Vector::ZERO, n1, n1),
        Face::of(halves[1], &axes, relative.translation, n2, n1),
    ];
    let (before, mut deepest) = (found.len(), f64::INFINITY);
    let (normal, narrower) = (from_vector(n1), wide.excess(n2));
    share(faces.each_ref(), n1, |features, [on_first, on_second], gap| {
        deepest = deepest.min(gap);
        if gap + narrower <= margin {
            let on_second = seen(on_second - relative.translation);
            let points = [from_vector(on_first), from_vector(on_second)];
            found.push(Facing { parts: [0; 2], features, points, normal, gap: gap + narrower });
        }
    });
    if deepest > axis.separation + LOST * halves[0].max(halves[1]).max_element() {
        found.truncate(before);
        return Clipped::Corners;
    }
    Clipped::Faces(axis.face.map_or(Answer::Now, Answer::Plane))
}

/// Appends the points of a manifold.
fn append(manifold: &Manifold, margin: f64, found: &mut Vec<Facing<Vector3<f64>>>) {
    let parts = [manifold.subshape1, manifold.subshape2];
    let normal = from_vector(manifold.local_n1);
    let near = manifold.points.iter().filter(|point| point.dist <= margin);
    found.extend(near.map(|point| Facing {
        parts,
        features: [point.fid1.0, point.fid2.0],
        points: [from_vector(point.local_p1), from_vector(point.local_p2)],
        normal,
        gap: point.dist,
    }));
}
