//! Volume, centre and inertia of a solid within a closed surface, by the divergence theorem.
//!
//! ```text
//! V = 1/6 sum d          V c = 1/24 sum d s          d = a.(b x c),   s = a + b + c
//! C = int x x^T = 1/120 sum d (a a^T + b b^T + c c^T + s s^T),      I = tr(C) 1 - C
//! ```
//! `a b c` the corners of a triangle (m) seen from the middle of the shape, counterclockwise from
//! outside; density in kg/m^3. A surface is refused where an edge has no neighbour or more than
//! one, where neighbours are turned against each other, where it is inside out ([`turned_outward`]
//! repairs that on request), and where it encloses nothing. Whether it cuts through itself is not
//! tested. Source: notes 7.1, 9.4; Eberly 2002.

use std::collections::HashMap;

use nalgebra::{Matrix3, Vector3};

use crate::error::check_finite;
use crate::mass_properties::check_density;
use crate::{RigidError, SpatialMass};

/// The mass properties of the solid within closed triangles, given by the numbers of their
/// vertices.
pub fn surface_mass(
    density: f64,
    vertices: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> Result<SpatialMass, RigidError> {
    check_density(density)?;
    check_closed(vertices, triangles)?;
    let (volume, middle, first, second) = moments(vertices, triangles);
    let extent = vertices.iter().map(|v| (v - middle).amax()).fold(0.0, f64::max);
    if volume.abs() <= FLAT * extent.powi(3) {
        return Err(RigidError::Empty("surface"));
    }
    if volume < 0.0 {
        return Err(RigidError::InsideOut { volume });
    }
    let offset = first / volume;
    let central = second - offset * offset.transpose() * volume;
    let inertia = (Matrix3::identity() * central.trace() - central) * density;
    Ok(SpatialMass { mass: density * volume, centre: middle + offset, inertia })
}

/// Volumes below this part of the extent's cube are rounding.
const FLAT: f64 = 1e-14;

/// The same triangles, counterclockwise from outside.
pub fn turned_outward(
    vertices: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> Result<Vec<[usize; 3]>, RigidError> {
    check_closed(vertices, triangles)?;
    let (volume, ..) = moments(vertices, triangles);
    let turned = |&[a, b, c]: &[usize; 3]| if volume < 0.0 { [a, c, b] } else { [a, b, c] };
    Ok(triangles.iter().map(turned).collect())
}

/// Volume, the middle of the extent, and the first and second moments about it.
fn moments(
    vertices: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> (f64, Vector3<f64>, Vector3<f64>, Matrix3<f64>) {
    let used = || triangles.iter().flatten().map(|&v| &vertices[v]);
    let low = used().fold(Vector3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = used().fold(Vector3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    let middle = if triangles.is_empty() { Vector3::zeros() } else { low + (high - low) * 0.5 };
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for corners in triangles {
        let [a, b, c] = corners.map(|v| vertices[v] - middle);
        let (d, s) = (a.dot(&b.cross(&c)), a + b + c);
        volume += d / 6.0;
        first += s * (d / 24.0);
        let squares = [a, b, c, s].map(|x| x * x.transpose());
        second += squares.iter().sum::<Matrix3<f64>>() * (d / 120.0);
    }
    (volume, middle, first, second)
}

/// An error unless every edge is used once in each direction.
fn check_closed(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Result<(), RigidError> {
    let mut users = HashMap::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            let Some(place) = vertices.get(vertex) else {
                return Err(RigidError::NoSuchVertex {
                    triangle,
                    vertex,
                    vertices: vertices.len(),
                });
            };
            check_finite("a vertex", place.as_slice())?;
        }
        for (from, to) in edges(corners) {
            if users.insert((from, to), triangle).is_some() {
                return Err(RigidError::SharedEdge { triangle, from, to });
            }
        }
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        for (from, to) in edges(corners) {
            if from == to || !users.contains_key(&(to, from)) {
                return Err(RigidError::OpenEdge { triangle, from, to });
            }
        }
    }
    Ok(())
}

fn edges(&[a, b, c]: &[usize; 3]) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, LieGroup, RigidMotion, Rotation};

    /// A box of these sizes with one corner at `corner`.
    fn cuboid(corner: [f64; 3], size: [f64; 3]) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
        let at = |k: usize| Vector3::from_fn(|c, _| corner[c] + size[c] * (k >> c & 1) as f64);
        let vertices = (0..8).map(at).collect();
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
        (vertices, faces.into_iter().flat_map(halves).collect())
    }

    #[test]
    fn a_box_has_its_textbook_inertia() {
        let (vertices, triangles) = cuboid([1.0, -2.0, 0.5], [0.2, 0.4, 0.6]);
        let got = surface_mass(1.0 / 0.048, &vertices, &triangles).unwrap();
        assert!((got.mass - 1.0).abs() < 1e-14);
        assert!((got.centre - Vector3::new(1.1, -1.8, 0.8)).norm() < 1e-14);
        let (body, pose) = got.body().unwrap();
        let textbook = Body::solid_box(1.0, [0.3, 0.2, 0.1]).unwrap();
        assert!((body.moments() - textbook.moments()).amax() < 1e-14, "ascending");
        assert!((pose.translation - got.centre).norm() == 0.0);
    }

    #[test]
    fn a_unit_cube_a_million_metres_away_keeps_nine_digits() {
        let (near, triangles) = cuboid([0.0; 3], [1.0; 3]);
        let (far, _) = cuboid([1e6, -1e6, 1e6], [1.0; 3]);
        let near = surface_mass(1.0, &near, &triangles).unwrap();
        let far = surface_mass(1.0, &far, &triangles).unwrap();
        assert!((near.inertia - far.inertia).amax() < 1e-9 * near.inertia.amax());
        assert!((far.mass - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_moved_shape_has_the_moved_properties_and_pieces_add_up() {
        let (vertices, triangles) = cuboid([0.0; 3], [1.0, 2.0, 3.0]);
        let motion = RigidMotion {
            translation: Vector3::new(0.3, -0.4, 2.0),
            rotation: Rotation::exp(Vector3::new(0.4, 1.0, -2.0)),
        };
        let moved: Vec<_> = vertices.iter().map(|v| motion.apply(v)).collect();
        let whole = surface_mass(2.0, &vertices, &triangles).unwrap();
        let got = surface_mass(2.0, &moved, &triangles).unwrap();
        let expected = whole.moved(&motion);
        assert!((got.centre - expected.centre).norm() < 1e-14);
        assert!((got.inertia - expected.inertia).amax() < 1e-13);
        let halves = [0.0, 1.0].map(|y| {
            let (vertices, triangles) = cuboid([0.0, y, 0.0], [1.0, 1.0, 3.0]);
            surface_mass(2.0, &vertices, &triangles).unwrap()
        });
        let sum = SpatialMass::composite(&halves).unwrap();
        assert!((sum.centre - whole.centre).norm() < 1e-15);
        assert!((sum.inertia - whole.inertia).amax() < 1e-13);
    }

    #[test]
    fn a_fine_sphere_approaches_two_fifths_m_r_squared_with_the_square_of_the_mesh_size() {
        let error = |n: usize| {
            let (vertices, triangles) = sphere(n);
            let got = surface_mass(1.0, &vertices, &triangles).unwrap();
            (got.inertia[(0, 0)] / (8.0 * std::f64::consts::PI / 15.0) - 1.0).abs()
        };
        let slope = (error(16) / error(32)).log2();
        assert!((slope - 2.0).abs() < 0.05, "{slope}");
    }

    /// A unit sphere of n rings of 2n vertices.
    fn sphere(n: usize) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
        let (around, pi) = (2 * n, std::f64::consts::PI);
        let mut vertices = vec![Vector3::z(), -Vector3::z()];
        for ring in 1..n {
            for k in 0..around {
                let (polar, azimuth) = (pi * ring as f64 / n as f64, pi * k as f64 / n as f64);
                let (s, c) = polar.sin_cos();
                vertices.push(Vector3::new(s * azimuth.cos(), s * azimuth.sin(), c));
            }
        }
        let at = |ring: usize, k: usize| match ring {
            0 => 0,
            ring if ring == n => 1,
            ring => 2 + (ring - 1) * around + k % around,
        };
        let mut triangles = Vec::new();
        for ring in 0..n {
            for k in 0..around {
                if ring + 1 < n {
                    triangles.push([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)]);
                }
                if ring > 0 {
                    triangles.push([at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)]);
                }
            }
        }
        (vertices, triangles)
    }

    #[test]
    fn surfaces_that_enclose_no_solid_are_refused_by_name() {
        let (vertices, triangles) = cuboid([0.0; 3], [1.0; 3]);
        let mass = |triangles: &[[usize; 3]]| surface_mass(1.0, &vertices, triangles);
        let open = mass(&triangles[1..]).unwrap_err();
        assert!(matches!(open, RigidError::OpenEdge { .. }), "{open}");
        let mut twice = triangles.clone();
        twice.push(triangles[3]);
        assert!(matches!(mass(&twice), Err(RigidError::SharedEdge { triangle: 12, .. })));
        let mut one_turned = triangles.clone();
        one_turned[5].swap(0, 1);
        assert!(mass(&one_turned).is_err());
        let inside_out: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let error = mass(&inside_out).unwrap_err();
        assert!(matches!(error, RigidError::InsideOut { .. }), "{error}");
        let repaired = turned_outward(&vertices, &inside_out).unwrap();
        assert_eq!(mass(&repaired), mass(&triangles));
        let sheet = [[0, 1, 2], [0, 2, 1]];
        assert_eq!(mass(&sheet), Err(RigidError::Empty("surface")));
        assert_eq!(mass(&[]), Err(RigidError::Empty("surface")));
        assert!(matches!(mass(&[[0, 1, 8]]), Err(RigidError::NoSuchVertex { vertex: 8, .. })));
    }
}
