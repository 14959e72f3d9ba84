//! Shapes of space: round and flat convex solids, half-spaces and triangle meshes.
//!
//! ```text
//! ball        |x| <= r
//! capsule     |x - (0, 0, t)| <= r for some |t| <= a
//! cylinder    x^2 + y^2 <= r^2,  |z| <= a
//! cone        sqrt(x^2 + y^2) <= r (3/4 - z/l),  z >= -l/4         the origin its centre of mass
//! ellipsoid   (x/a_1)^2 + (y/a_2)^2 + (z/a_3)^2 <= 1
//! box         |x_k| <= a_k,  k = 1, 2, 3
//! convex      the hull of points
//! half-space  n.x <= 0
//! mesh        a surface of triangles, seen from both sides
//! ```
//! Lengths in metres, in the axes of the body that carries the shape. What has no thickness, no
//! direction or a number that is not finite is refused here, so that queries need not look again.

use std::sync::Arc;

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Pose;
use parry3d_f64::shape::{Cuboid, HalfSpace, SharedShape};
use parry3d_f64::transformation::try_convex_hull;
use stationary_mesh::convex_hull;

use crate::ContactError;
use crate::error::{check_finite, check_length};
use crate::shapes::convert::{from_vector, vector};
use crate::shapes::polytope::Polytope;
use crate::shapes::solid::Solid;

/// A shape that queries accept.
#[derive(Clone)]
pub struct Shape {
    geometry: SharedShape,
    wide: Option<WideBox>,
    /// Its flat faces, where it is convex and has nothing else.
    polytope: Option<Arc<Polytope>>,
    /// Itself as the hull of its parts, where it is convex and has an end.
    solid: Option<Arc<Solid>>,
    name: &'static str,
}

impl std::fmt::Debug for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shape").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Shape {
    /// A ball of this radius.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless the radius is positive and finite.
    pub fn ball(radius: f64) -> Result<Self, ContactError> {
        check_length("ball", "radius", radius)?;
        Ok(Self::round(Solid::ball(radius), "ball"))
    }

    /// All points within a radius of the segment from (0, 0, -a) to (0, 0, a), `a` the half length.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless both are positive and finite.
    pub fn capsule(half_length: f64, radius: f64) -> Result<Self, ContactError> {
        check_length("capsule", "half length", half_length)?;
        check_length("capsule", "radius", radius)?;
        Ok(Self::round(Solid::capsule(half_length, radius), "capsule"))
    }

    /// A cylinder about z, its ends at z = -a and z = a, `a` the half length.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless both are positive and finite.
    pub fn cylinder(half_length: f64, radius: f64) -> Result<Self, ContactError> {
        check_length("cylinder", "half length", half_length)?;
        check_length("cylinder", "radius", radius)?;
        Ok(Self::round(Solid::cylinder(half_length, radius), "cylinder"))
    }

    /// A cone about z with its centre of mass at the origin: the apex at three quarters of its height,
    /// the base, of this radius, a quarter below.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless both are positive and finite.
    pub fn cone(height: f64, radius: f64) -> Result<Self, ContactError> {
        check_length("cone", "height", height)?;
        check_length("cone", "radius", radius)?;
        Ok(Self::round(Solid::cone(height, radius), "cone"))
    }

    /// An ellipsoid of these half axes.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless the half axes are positive and finite.
    pub fn ellipsoid(half_axes: [f64; 3]) -> Result<Self, ContactError> {
        half_axes.into_iter().try_for_each(|a| check_length("ellipsoid", "half axis", a))?;
        Ok(Self::round(Solid::ellipsoid(half_axes), "ellipsoid"))
    }

    /// What is round; the geometry library, which is asked nothing of it, sees a ball that holds it.
    fn round(solid: Solid, name: &'static str) -> Self {
        let geometry = SharedShape::ball(solid.size);
        Shape { geometry, wide: None, polytope: None, solid: Some(Arc::new(solid)), name }
    }

    fn flat(geometry: SharedShape, polytope: Option<Polytope>, name: &'static str) -> Self {
        let solid = polytope.as_ref().map(Solid::polytope).map(Arc::new);
        Shape { geometry, wide: None, polytope: polytope.map(Arc::new), solid, name }
    }

    /// A box of these half sizes.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless the half sizes are positive and finite.
    pub fn cuboid(half: [f64; 3]) -> Result<Self, ContactError> {
        half.into_iter().try_for_each(|a| check_length("box", "half size", a))?;
        let geometry = SharedShape::cuboid(half[0], half[1], half[2]);
        let flat = Self::flat(geometry, Polytope::cuboid(half), "box");
        Ok(Shape { wide: Some(WideBox::of(half)), ..flat })
    }

    /// The convex hull of these points.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a point that is not finite; [`ContactError::Flat`] for
    /// points in one plane, or so near to it that no hull is found.
    pub fn convex(points: &[Vector3<f64>]) -> Result<Self, ContactError> {
        let shape = "convex solid";
        points.iter().try_for_each(|p| check_finite("a point of a convex solid", p.as_slice()))?;
        if !spans_space(points) {
            return Err(ContactError::Flat { shape });
        }
        let own = convex_hull(points).and_then(|triangles| {
            // Corners alone.
            let mut used: Vec<usize> = triangles.iter().flatten().copied().collect();
            used.sort_unstable();
            used.dedup();
            let number = |k: &usize| used.binary_search(k).unwrap_or(0);
            let triangles: Vec<_> =
                triangles.iter().map(|t| [0, 1, 2].map(|i| number(&t[i]))).collect();
            Polytope::new(used.iter().map(|&k| points[k]).collect(), &triangles)
        });
        let points: Vec<_> = points.iter().map(vector).collect();
        let geometry = SharedShape::convex_hull(&points).ok_or(ContactError::Flat { shape })?;
        let polytope = own.or_else(|| {
            let (corners, triangles) = try_convex_hull(&points).ok()?;
            let triangles: Vec<_> = triangles.iter().map(|t| t.map(|k| k as usize)).collect();
            Polytope::new(corners.into_iter().map(from_vector).collect(), &triangles)
        });
        // Without faces of its own it would be asked of the library, whose contacts are other ones.
        let polytope = polytope.ok_or(ContactError::Flat { shape })?;
        Ok(Self::flat(geometry, Some(polytope), shape))
    }

    /// The half-space on the side of the origin away from this normal, whose length does not
    /// matter.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`]; [`ContactError::Length`] where the square of its length is zero
    /// or leaves the range of numbers.
    pub fn half_space(normal: Vector3<f64>) -> Result<Self, ContactError> {
        check_finite("the normal of a half-space", normal.as_slice())?;
        check_length("half-space", "normal", normal.norm())?;
        let normal = vector(&normal.normalize());
        let geometry = SharedShape::new(HalfSpace::new(normal));
        Ok(Self::flat(geometry, None, "half-space"))
    }

    /// A surface of triangles.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a vertex that is not finite; [`ContactError::NoSuchVertex`];
    /// [`ContactError::Flat`] for a triangle without area, and without any triangle.
    pub fn mesh(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<Self, ContactError> {
        let shape = "mesh";
        vertices.iter().try_for_each(|v| check_finite("a vertex of a mesh", v.as_slice()))?;
        for (triangle, corners) in triangles.iter().enumerate() {
            let mut places = [Vector3::zeros(); 3];
            for (place, &vertex) in places.iter_mut().zip(corners) {
                let vertex = vertex as usize;
                let vertices_there = vertices.len();
                *place = *vertices.get(vertex).ok_or(ContactError::NoSuchVertex {
                    triangle,
                    vertex,
                    vertices: vertices_there,
                })?;
            }
            let [a, b, c] = places;
            if (b - a).cross(&(c - a)).norm() <= COPLANAR * (b - a).norm() * (c - a).norm() {
                return Err(ContactError::Flat { shape });
            }
        }
        let points = vertices.iter().map(vector).collect();
        let geometry = SharedShape::trimesh(points, triangles.to_vec())
            .map_err(|_| ContactError::Flat { shape })?;
        Ok(Self::flat(geometry, None, shape))
    }

    /// What it is, in a word.
    pub fn name(&self) -> &'static str {
        self.name
    }

    pub(crate) fn geometry(&self) -> &SharedShape {
        &self.geometry
    }

    pub(crate) fn wide(&self) -> Option<&WideBox> {
        self.wide.as_ref()
    }

    pub(crate) fn polytope(&self) -> Option<&Polytope> {
        self.polytope.as_deref()
    }

    /// Itself as the hull of its parts, where it is convex and has an end.
    pub(crate) fn solid(&self) -> Option<&Solid> {
        self.solid.as_deref()
    }

    /// Itself, where it is round and not a ball.
    pub(crate) fn curved(&self) -> Option<&Solid> {
        self.solid().filter(|_| self.polytope.is_none() && self.name != "ball")
    }

    /// Its radius, where it is a ball.
    pub(crate) fn ball_radius(&self) -> Option<f64> {
        self.solid().filter(|_| self.name == "ball").map(|solid| solid.rounding)
    }

    /// A box of the world that holds it.
    pub(crate) fn aabb(&self, pose: &Pose) -> Aabb {
        let hull = self.solid().filter(|_| self.geometry.as_convex_polyhedron().is_some());
        let Some(solid) = self.curved().or(hull) else { return self.geometry.compute_aabb(pose) };
        let reach =
            |n: Vector3<f64>| solid.reach(&from_vector(pose.rotation.inverse() * vector(&n)));
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let high = Vector3::from(axes.map(reach));
        let low = Vector3::from(axes.map(|n| -reach(-n)));
        Aabb::new(pose.translation + vector(&low), pose.translation + vector(&high))
    }

    pub(crate) fn plane(&self) -> Option<Vector3<f64>> {
        self.geometry.as_halfspace().map(|half| from_vector(half.normal))
    }
}

/// A box made a little larger on all sides.
///
/// Clipping one face against another of the same size, off by no more than rounding, may lose
/// corners altogether, and a stack that loses a corner for a step jumps. The larger box breaks the tie;
/// what it takes from the gap is known exactly, and is given back.
#[derive(Clone)]
pub(crate) struct WideBox {
    pub(crate) cuboid: Cuboid,
    excess: f64,
}

/// By how much, relative to the smallest half size: far above rounding, far below what is seen.
const WIDENING: f64 = 1e-9;

impl WideBox {
    fn of(half: [f64; 3]) -> Self {
        let excess = WIDENING * half.into_iter().fold(f64::INFINITY, f64::min);
        let [a, b, c] = half.map(|a| a + excess);
        WideBox { cuboid: Cuboid::new(parry3d_f64::math::Vector::new(a, b, c)), excess }
    }

    /// How much farther the larger box reaches along a direction of its own axes.
    pub(crate) fn excess(&self, direction: parry3d_f64::math::Vector) -> f64 {
        self.excess * direction.abs().element_sum()
    }
}

/// A thickness relative to the size below which points lie in a plane: rounding.
const COPLANAR: f64 = 1e-12;

/// Whether points are not all in one plane.
fn spans_space(points: &[Vector3<f64>]) -> bool {
    let Some((first, rest)) = points.split_first() else { return false };
    let farthest = |size: &dyn Fn(&Vector3<f64>) -> f64| {
        rest.iter().map(|p| p - first).max_by(|a, b| size(a).total_cmp(&size(b)))
    };
    let Some(a) = farthest(&|d| d.norm()) else { return false };
    let Some(b) = farthest(&|d| a.cross(d).norm()) else { return false };
    let normal = a.cross(&b);
    let Some(c) = farthest(&|d| normal.dot(d).abs()) else { return false };
    let flat = normal.norm() <= COPLANAR * a.norm_squared();
    !flat && normal.dot(&c).abs() > COPLANAR * normal.norm() * a.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_without_thickness_and_shapes_that_are_not_numbers_are_refused_by_name() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Shape::ball(bad), Err(ContactError::Length { shape: "ball", .. })));
            let flat = Shape::cuboid([1.0, bad, 1.0]);
            assert!(matches!(flat, Err(ContactError::Length { shape: "box", .. })));
            for (name, refused) in [
                ("capsule", [Shape::capsule(bad, 1.0), Shape::capsule(1.0, bad)]),
                ("cylinder", [Shape::cylinder(bad, 1.0), Shape::cylinder(1.0, bad)]),
                ("cone", [Shape::cone(bad, 1.0), Shape::cone(1.0, bad)]),
                (
                    "ellipsoid",
                    [Shape::ellipsoid([bad, 1.0, 1.0]), Shape::ellipsoid([1.0, 1.0, bad])],
                ),
            ] {
                for shape in refused {
                    let Err(ContactError::Length { shape, value, .. }) = shape else {
                        panic!("{name} of {bad} is taken")
                    };
                    assert!(shape == name && value.to_bits() == bad.to_bits());
                }
            }
        }
        let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let mut points: Vec<_> = square.iter().map(|p| Vector3::new(p[0], p[1], 0.3)).collect();
        let flat = ContactError::Flat { shape: "convex solid" };
        assert_eq!(Shape::convex(&points).unwrap_err(), flat);
        assert_eq!(Shape::convex(&points[..1]).unwrap_err(), flat);
        points.push(Vector3::new(0.2, 0.2, 1.0));
        assert!(Shape::convex(&points).is_ok());
        assert!(Shape::half_space(Vector3::zeros()).is_err());
        let corner = Shape::mesh(&points, &[[0, 1, 9]]).unwrap_err();
        assert!(matches!(corner, ContactError::NoSuchVertex { vertex: 9, .. }), "{corner}");
        assert!(matches!(Shape::mesh(&points, &[[0, 0, 1]]), Err(ContactError::Flat { .. })));
        points[0].x = f64::NAN;
        assert!(matches!(Shape::convex(&points), Err(ContactError::NonFinite { .. })));
    }
}
