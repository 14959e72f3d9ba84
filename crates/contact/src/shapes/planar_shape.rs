//! Shapes of the plane: discs, capsules, boxes, polygons and half-planes.
//!
//! ```text
//! disc        |x| <= r
//! capsule     |x - (t, 0)| <= r for some |t| <= a
//! box         |x_k| <= a_k,  k = 1, 2
//! polygon     an outline that neither crosses nor touches itself, convex or not
//! half-plane  n.x <= 0
//! ```
//! Lengths in metres, in the axes of the body that carries the shape. A polygon that is not convex
//! is held as convex pieces, cut along diagonals between its corners: distances to it are exact,
//! and so is a shallow overlap; one deeper than a piece is wide sees the cuts. What has no area, no
//! direction or a number that is not finite is refused here, so that queries need not look again.

use nalgebra::Vector2;
use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::shape::{ConvexPolygon, HalfSpace, SharedShape, TriMesh};
use parry2d_f64::transformation::hertel_mehlhorn;
use stationary_mesh::Polygon;

use crate::ContactError;
use crate::error::{check_finite, check_length};
use crate::shapes::outline::Outline;
use crate::shapes::planar_convert::{from_vector, vector};

/// A shape of the plane that queries accept.
#[derive(Clone)]
pub struct PlanarShape {
    geometry: SharedShape,
    /// The convex pieces of what has corners, counterclockwise.
    pieces: Vec<ConvexPolygon>,
    /// The outlines of the pieces; of a capsule its segment, of a disc its centre.
    cores: Vec<Outline>,
    /// How far the shape reaches beyond its outlines, m.
    rounding: f64,
    name: &'static str,
}

impl std::fmt::Debug for PlanarShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PlanarShape").field("name", &self.name).finish_non_exhaustive()
    }
}

impl PlanarShape {
    /// A disc of this radius.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless the radius is positive and finite.
    pub fn disc(radius: f64) -> Result<Self, ContactError> {
        check_length("disc", "radius", radius)?;
        Ok(Self::round(SharedShape::ball(radius), Outline::point(), radius, "disc"))
    }

    /// All points within a radius of the segment from (-a, 0) to (a, 0), `a` the half length.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless both are positive and finite.
    pub fn capsule(half_length: f64, radius: f64) -> Result<Self, ContactError> {
        check_length("capsule", "half length", half_length)?;
        check_length("capsule", "radius", radius)?;
        let geometry = SharedShape::capsule_x(half_length, radius);
        Ok(Self::round(geometry, Outline::segment(half_length), radius, "capsule"))
    }

    fn round(geometry: SharedShape, core: Outline, radius: f64, name: &'static str) -> Self {
        let (pieces, cores) = (Vec::new(), vec![core]);
        PlanarShape { geometry, pieces, cores, rounding: radius, name }
    }

    fn with_corners(geometry: SharedShape, pieces: Vec<ConvexPolygon>, name: &'static str) -> Self {
        let cores = pieces.iter().map(Outline::of).collect();
        PlanarShape { geometry, pieces, cores, rounding: 0.0, name }
    }

    /// A box of these half sizes.
    ///
    /// # Errors
    /// [`ContactError::Length`] unless the half sizes are positive and finite;
    /// [`ContactError::Flat`] where their product leaves the range of numbers.
    pub fn cuboid(half: [f64; 2]) -> Result<Self, ContactError> {
        half.into_iter().try_for_each(|a| check_length("box", "half size", a))?;
        let [a, b] = half;
        let corners = [[a, b], [-a, b], [-a, -b], [a, -b]].map(|[x, y]| Vector::new(x, y));
        let piece = convex(corners.to_vec()).ok_or(ContactError::Flat { shape: "box" })?;
        Ok(Self::with_corners(SharedShape::cuboid(a, b), vec![piece], "box"))
    }

    /// The polygon with these corners, in either order.
    ///
    /// # Errors
    /// [`ContactError::Outline`] where the outline crosses or touches itself, has too few corners
    /// or one that is no place, and [`ContactError::Flat`] where it encloses nothing.
    pub fn polygon(corners: &[Vector2<f64>]) -> Result<Self, ContactError> {
        let polygon = Polygon::new(vec![corners.to_vec()])?;
        let flat = ContactError::Flat { shape: "polygon" };
        let corners: Vec<Vector> = polygon.outlines()[0].iter().map(vector).collect();
        let pieces = match convex(corners.clone()) {
            Some(whole) => vec![whole],
            None => cut(corners).ok_or(flat.clone())?,
        };
        let area = |piece: &ConvexPolygon| {
            let places: Vec<_> = piece.points().iter().map(|&p| from_vector(p)).collect();
            Polygon::new(vec![places]).map_or(f64::NAN, |piece| piece.moments().measure)
        };
        let whole = polygon.moments().measure;
        let covered: f64 = pieces.iter().map(area).sum();
        // What is lost by cutting is no polygon that queries could trust.
        if !(whole > 0.0 && (covered - whole).abs() <= CUT * whole) {
            return Err(flat);
        }
        let shared = |piece: &ConvexPolygon| SharedShape::new(piece.clone());
        let geometry = match &pieces[..] {
            [whole] => shared(whole),
            pieces => SharedShape::compound(
                pieces.iter().map(|piece| (Pose::IDENTITY, shared(piece))).collect(),
            ),
        };
        Ok(Self::with_corners(geometry, pieces, "polygon"))
    }

    /// The half-plane on the side of the origin away from this normal, whose length does not
    /// matter.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`]; [`ContactError::Length`] where the square of its length is zero
    /// or leaves the range of numbers.
    pub fn half_plane(normal: Vector2<f64>) -> Result<Self, ContactError> {
        check_finite("the normal of a half-plane", normal.as_slice())?;
        check_length("half-plane", "normal", normal.norm())?;
        let geometry = SharedShape::new(HalfSpace::new(vector(&normal.normalize())));
        let (pieces, cores) = (Vec::new(), Vec::new());
        Ok(PlanarShape { geometry, pieces, cores, rounding: 0.0, name: "half-plane" })
    }

    /// What it is, in a word.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The corners of its convex pieces, counterclockwise; none of what is round or has no end.
    pub fn pieces(&self) -> impl Iterator<Item = Vec<Vector2<f64>>> + '_ {
        self.pieces.iter().map(|piece| piece.points().iter().map(|&p| from_vector(p)).collect())
    }

    pub(crate) fn convex_pieces(&self) -> &[ConvexPolygon] {
        &self.pieces
    }

    pub(crate) fn cores(&self) -> &[Outline] {
        &self.cores
    }

    pub(crate) fn rounding(&self) -> f64 {
        self.rounding
    }

    pub(crate) fn geometry(&self) -> &SharedShape {
        &self.geometry
    }

    /// A box of the world that holds it.
    pub(crate) fn aabb(&self, pose: &Pose) -> Aabb {
        self.geometry.compute_aabb(pose)
    }

    pub(crate) fn plane(&self) -> Option<Vector2<f64>> {
        self.geometry.as_halfspace().map(|half| from_vector(half.normal))
    }
}

/// The part of the area that pieces may be off by: rounding.
const CUT: f64 = 1e-9;

/// Corners counterclockwise as a convex polygon, if they are one.
fn convex(corners: Vec<Vector>) -> Option<ConvexPolygon> {
    let n = corners.len();
    let edge = |k: usize| corners[(k + 1) % n] - corners[k % n];
    let turns_left = |k: usize| edge(k).perp_dot(edge(k + 1)) > 0.0;
    (n > 2 && (0..n).all(turns_left))
        .then(|| ConvexPolygon::from_convex_polyline_unmodified(corners))
        .flatten()
}

/// Convex pieces of a simple polygon: triangles, joined where they stay convex.
fn cut(corners: Vec<Vector>) -> Option<Vec<ConvexPolygon>> {
    let triangles = TriMesh::from_polygon(corners)?;
    hertel_mehlhorn(triangles.vertices(), triangles.indices())
        .into_iter()
        .map(|piece| convex(without_straight_corners(piece)))
        .collect()
}

/// Corners at which the outline turns.
fn without_straight_corners(corners: Vec<Vector>) -> Vec<Vector> {
    let n = corners.len();
    let turns = |k: &usize| {
        let [a, b, c] = [n - 1, 0, 1].map(|shift| corners[(k + shift) % n]);
        (b - a).perp_dot(c - b) > STRAIGHT * (b - a).length() * (c - b).length()
    };
    (0..n).filter(turns).map(|k| corners[k]).collect()
}

/// The sine of a turn below which a corner of a piece is straight: rounding.
const STRAIGHT: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;

    fn places(corners: &[[f64; 2]]) -> Vec<Vector2<f64>> {
        corners.iter().map(|&[x, y]| Vector2::new(x, y)).collect()
    }

    #[test]
    fn shapes_without_area_and_outlines_that_are_none_are_refused_by_name() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let disc = PlanarShape::disc(bad);
            assert!(matches!(disc, Err(ContactError::Length { shape: "disc", .. })));
            for capsule in [PlanarShape::capsule(bad, 1.0), PlanarShape::capsule(1.0, bad)] {
                assert!(matches!(capsule, Err(ContactError::Length { shape: "capsule", .. })));
            }
            let flat = PlanarShape::cuboid([1.0, bad]);
            assert!(matches!(flat, Err(ContactError::Length { shape: "box", .. })));
        }
        let bow = places(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert!(matches!(PlanarShape::polygon(&bow), Err(ContactError::Outline(_))));
        assert!(matches!(PlanarShape::polygon(&bow[..2]), Err(ContactError::Outline(_))));
        let nowhere = places(&[[0.0, 0.0], [1.0, f64::NAN], [1.0, 0.0]]);
        assert!(matches!(PlanarShape::polygon(&nowhere), Err(ContactError::Outline(_))));
        assert!(PlanarShape::half_plane(Vector2::zeros()).is_err());
    }

    #[test]
    fn a_polygon_that_is_not_convex_is_cut_into_convex_pieces_of_the_same_area() {
        let star: Vec<_> = (0..10)
            .map(|k| {
                let (s, c) = (0.2 + std::f64::consts::PI * f64::from(k) / 5.0).sin_cos();
                Vector2::new(c, s) * if k % 2 == 0 { 1.0 } else { 0.4 }
            })
            .collect();
        let comb = places(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 2.0],
            [4.0, 2.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [3.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ]);
        for mut corners in [star, comb] {
            for _ in 0..2 {
                let shape = PlanarShape::polygon(&corners).unwrap();
                assert!(shape.pieces().count() > 1);
                for piece in shape.pieces() {
                    assert!(convex(piece.iter().map(vector).collect()).is_some());
                }
                corners.reverse();
            }
        }
        let whole = places(&[[0.0, 0.0], [2.0, 0.0], [1.0, 1.0]]);
        assert_eq!(PlanarShape::polygon(&whole).unwrap().pieces().count(), 1);
    }
}
