//! How good is the shape of a triangle or a tetrahedron?
//!
//! ```text
//!                  triangle               tetrahedron             best           worst
//! mean ratio       4 sqrt 3 A / sum l^2   12 (3 V)^(2/3) / sum l^2  1          0
//! radius ratio     2 r / R                3 r / R                 1              0
//! aspect ratio     (sqrt 3/2) l_max/h_min sqrt(2/3) l_max/h_min   1              infinity
//! smallest angle   at a corner            dihedral, at an edge    60, 70.5 deg   0
//! largest angle    at a corner            dihedral, at an edge    60, 70.5 deg   180
//! ```
//! `A V` area and volume, `l` edges, `h` altitudes, `r R` the radii of the inscribed and the
//! circumscribed sphere. None depends on size; angles are in radians. The mean ratio of an inverted
//! simplex is negative, its other measures are those of its mirror image. The smallest angle bounds
//! the conditioning of a stiffness matrix, the largest the error of a gradient.
//! Source: Liu and Joe 1994 (mean ratio); Shewchuk, What is a good linear finite element?, 2002.

use std::f64::consts::PI;

use nalgebra::{SVector, Vector3};

use crate::measure::{in_space, measure};
use crate::mesh::Mesh;

/// A number that tells how good the shape of a simplex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Measure against edges; 1 for regular simplices, smooth, negative if inverted.
    MeanRatio,
    /// Radius of the inscribed sphere against the circumscribed; 1 for regular simplices.
    RadiusRatio,
    /// Longest edge against shortest altitude; 1 for regular simplices, large for bad ones.
    AspectRatio,
    /// The smallest angle, at corners of triangles and edges of tetrahedra, radians.
    SmallestAngle,
    /// The largest such angle, radians.
    LargestAngle,
}

impl Quality {
    /// This measure for a triangle (`K` = 3) or a tetrahedron (`K` = 4).
    pub fn of<const D: usize, const K: usize>(self, corners: &[SVector<f64, D>; K]) -> f64 {
        const { assert!(K == 3 || K == 4, "quality is for triangles and tetrahedra") };
        let seen: [Vector3<f64>; K] = corners.map(|corner| in_space(&(corner - corners[0])));
        let reach = seen.iter().map(|corner| corner.amax()).fold(0.0, f64::max);
        if reach > 0.0 && reach.is_finite() && !(TINY..HUGE).contains(&reach) {
            return self.of(&corners.map(|corner| (corner - corners[0]) / reach));
        }
        let size = measure(corners);
        let (edges, content) = (edge_lengths(&seen), size.abs());
        let longest = edges.iter().copied().fold(0.0, f64::max);
        if content == 0.0 && !matches!(self, Quality::SmallestAngle | Quality::LargestAngle) {
            return if self == Quality::AspectRatio { f64::INFINITY } else { 0.0 };
        }
        match (self, K) {
            (Quality::MeanRatio, 3) => 4.0 * 3.0_f64.sqrt() * size / squares(&edges),
            (Quality::MeanRatio, _) => {
                12.0 * (3.0 * content).cbrt().powi(2).copysign(size) / squares(&edges)
            }
            (Quality::RadiusRatio, 3) => {
                let perimeter: f64 = edges.iter().sum();
                16.0 * (content / perimeter) * (content / edges.iter().product::<f64>())
            }
            (Quality::RadiusRatio, _) => {
                let inscribed = 3.0 * content / face_areas(&seen).iter().sum::<f64>();
                3.0 * inscribed / circumradius(&seen, content)
            }
            (Quality::AspectRatio, 3) => 3.0_f64.sqrt() / 4.0 * longest * longest / content,
            (Quality::AspectRatio, _) => {
                let largest = face_areas(&seen).into_iter().fold(0.0, f64::max);
                (2.0_f64 / 3.0).sqrt() * longest * largest / (3.0 * content)
            }
            (Quality::SmallestAngle, _) => angles(&seen).into_iter().fold(PI, f64::min),
            (Quality::LargestAngle, _) => angles(&seen).into_iter().fold(0.0, f64::max),
        }
    }
}

/// Simplices that are smaller or larger have volumes and products that leave the range of numbers.
const TINY: f64 = 1e-36;
const HUGE: f64 = 1e36;

impl<const D: usize, const K: usize> Mesh<D, K> {
    /// This measure for every simplex.
    pub fn quality(&self, measure: Quality) -> Vec<f64> {
        self.simplices().iter().map(|simplex| measure.of(&self.corners(simplex))).collect()
    }
}

fn squares(lengths: &[f64]) -> f64 {
    lengths.iter().map(|l| l * l).sum()
}

fn edge_lengths(corners: &[Vector3<f64>]) -> Vec<f64> {
    let pairs = (0..corners.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    pairs.map(|(i, j)| (corners[j] - corners[i]).norm()).collect()
}

/// The areas of a tetrahedron's faces, each opposite to its corner.
fn face_areas(corners: &[Vector3<f64>]) -> [f64; 4] {
    std::array::from_fn(|k| {
        let [a, b, c] = [1, 2, 3].map(|step| corners[(k + step) % 4]);
        (b - a).cross(&(c - a)).norm() / 2.0
    })
}

/// The radius of the sphere through the corners of a tetrahedron, the first at the origin.
fn circumradius(corners: &[Vector3<f64>], volume: f64) -> f64 {
    let [a, b, c] = [corners[1], corners[2], corners[3]];
    let sum = b.cross(&c) * a.norm_squared()
        + c.cross(&a) * b.norm_squared()
        + a.cross(&b) * c.norm_squared();
    sum.norm() / (12.0 * volume)
}

/// The angles at the corners of a triangle, or at the edges of a tetrahedron.
fn angles(corners: &[Vector3<f64>]) -> Vec<f64> {
    let between = |u: Vector3<f64>, v: Vector3<f64>| u.cross(&v).norm().atan2(u.dot(&v));
    if corners.len() == 3 {
        let at = |k: usize| {
            let from = corners[k];
            between(corners[(k + 1) % 3] - from, corners[(k + 2) % 3] - from)
        };
        return (0..3).map(at).collect();
    }
    // Along an edge the faces look like a corner: the parts of their far corners across the edge.
    let edges =
        [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];
    let dihedral = |[a, b, c, d]: [usize; 4]| {
        let along = (corners[b] - corners[a]).normalize();
        let across = |far: usize| {
            let side = corners[far] - corners[a];
            side - along * along.dot(&side)
        };
        between(across(c), across(d))
    };
    edges.map(dihedral).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector2, Vector3};
    use proptest::prelude::*;

    const ALL: [Quality; 5] = [
        Quality::MeanRatio,
        Quality::RadiusRatio,
        Quality::AspectRatio,
        Quality::SmallestAngle,
        Quality::LargestAngle,
    ];

    fn regular() -> [Vector3<f64>; 4] {
        [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]]
            .map(Vector3::from)
    }

    #[test]
    fn regular_simplices_are_perfect() {
        let triangle = [Vector2::zeros(), Vector2::x(), Vector2::new(0.5, 0.75_f64.sqrt())];
        let dihedral = (1.0_f64 / 3.0).acos();
        for (quality, [flat, solid]) in ALL.into_iter().zip([
            [1.0, 1.0],
            [1.0, 1.0],
            [1.0, 1.0],
            [PI / 3.0, dihedral],
            [PI / 3.0, dihedral],
        ]) {
            assert!((quality.of(&triangle) - flat).abs() < 1e-14, "{quality:?}");
            assert!((quality.of(&regular()) - solid).abs() < 1e-14, "{quality:?}");
        }
    }

    #[test]
    fn a_right_triangle_and_a_corner_of_a_cube_have_known_values() {
        let triangle = [Vector2::zeros(), Vector2::x() * 3.0, Vector2::y() * 4.0];
        assert!((Quality::RadiusRatio.of(&triangle) - 2.0 * 1.0 / 2.5).abs() < 1e-15);
        assert!((Quality::SmallestAngle.of(&triangle) - 0.75_f64.atan()).abs() < 1e-15);
        assert!((Quality::LargestAngle.of(&triangle) - PI / 2.0).abs() < 1e-15);
        let corner = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        // r = 1/(3 + sqrt 3), R = sqrt 3/2
        let ratio = 3.0 / (3.0 + 3.0_f64.sqrt()) / (3.0_f64.sqrt() / 2.0);
        assert!((Quality::RadiusRatio.of(&corner) - ratio).abs() < 1e-15);
        assert!((Quality::SmallestAngle.of(&corner) - 2.0_f64.sqrt().atan()).abs() < 1e-15);
        assert!((Quality::MeanRatio.of(&corner) - 12.0 * 0.25_f64.cbrt() / 9.0).abs() < 1e-15);
    }

    #[test]
    fn slivers_are_bad_by_every_measure_and_each_tells_its_own_story() {
        let sliver = |e: f64| {
            [
                Vector3::new(1.0, 0.0, e),
                Vector3::new(-1.0, 0.0, e),
                Vector3::new(0.0, 1.0, -e),
                Vector3::new(0.0, -1.0, -e),
            ]
        };
        let [flat, flatter] = [sliver(1e-2), sliver(1e-4)];
        for (quality, slope) in [
            (Quality::MeanRatio, 2.0 / 3.0),
            (Quality::RadiusRatio, 1.0),
            (Quality::SmallestAngle, 1.0),
            (Quality::AspectRatio, -1.0),
        ] {
            let measured = (quality.of(&flat) / quality.of(&flatter)).log10() / 2.0;
            assert!((measured - slope).abs() < 0.01, "{quality:?} {measured}");
        }
        assert!(Quality::AspectRatio.of(&flatter) > 1e3);
        assert!(Quality::LargestAngle.of(&flatter) > PI - 1e-3);
    }

    #[test]
    fn an_inverted_simplex_has_a_negative_mean_ratio() {
        let [a, b, c, d] = regular();
        assert!(
            (Quality::MeanRatio.of(&[b, a, c, d]) + Quality::MeanRatio.of(&regular())).abs()
                < 1e-15
        );
    }

    #[test]
    fn simplices_from_the_least_to_the_largest_numbers_have_the_shape_of_the_unit_one() {
        let corner = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let triangle = [corner[0], corner[1], corner[3]];
        for quality in ALL {
            for size in [1e-300, 1e-120, 1e-40, 1e40, 1e120, 1e300] {
                let off = quality.of(&corner.map(|x| x * size)) - quality.of(&corner);
                assert!(off.abs() < 1e-14, "{quality:?} {size:e} {off:e}");
                let off = quality.of(&triangle.map(|x| x * size)) - quality.of(&triangle);
                assert!(off.abs() < 1e-14, "{quality:?} {size:e} {off:e}");
            }
        }
    }

    proptest! {
        #[test]
        fn quality_does_not_notice_size_place_and_attitude(
            n in proptest::array::uniform12(-1.0..1.0_f64),
            axis in proptest::array::uniform3(-3.0..3.0_f64),
        ) {
            let corners: [Vector3<f64>; 4] = std::array::from_fn(|k| {
                Vector3::new(n[3 * k], n[3 * k + 1], n[3 * k + 2])
            });
            prop_assume!(Quality::MeanRatio.of(&corners).abs() > 0.05);
            let turn = Rotation3::new(Vector3::from(axis));
            let moved = corners.map(|c| turn * c * 37.0 + Vector3::new(1.0, -2.0, 3.0));
            for quality in ALL {
                let (here, there) = (quality.of(&corners), quality.of(&moved));
                prop_assert!((here - there).abs() < 1e-11 * here.abs().max(1.0), "{quality:?}");
            }
        }

        #[test]
        fn ratios_stay_between_zero_and_one(n in proptest::array::uniform12(-1.0..1.0_f64)) {
            let corners: [Vector3<f64>; 4] = std::array::from_fn(|k| {
                Vector3::new(n[3 * k], n[3 * k + 1], n[3 * k + 2])
            });
            let [a, b, c, _] = corners;
            for quality in [Quality::MeanRatio, Quality::RadiusRatio] {
                prop_assert!(quality.of(&corners).abs() <= 1.0 + 1e-12);
                prop_assert!(quality.of(&[a, b, c]).abs() <= 1.0 + 1e-12);
            }
            prop_assert!(Quality::AspectRatio.of(&corners) >= 1.0 - 1e-12);
            prop_assert!(Quality::AspectRatio.of(&[a, b, c]) >= 1.0 - 1e-12);
        }
    }
}
