//! Spheres, balls and tori.
//!
//! ```text
//! sphere   an icosahedron, refined, each new vertex moved to radius R at once
//! ball     twenty tetrahedra from the centre of an icosahedron, refined, then x -> R g(x) x/|x|
//! torus    ((R + r cos v) cos u, (R + r cos v) sin u, r sin v)
//! ```
//! `R r` radii (m), `g` the gauge of the icosahedron: 0 at its centre, 1 on its faces, so that
//! shells of the icosahedron become spheres. Each level halves the mesh size. Surfaces face
//! outward.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{check_cells, check_size, direction};
use crate::MeshError;
use crate::mesh::Mesh;
use crate::quadratic::{Quadratic, QuadraticTetrahedra, QuadraticTriangles};
use crate::refinement::{MOST_SIMPLICES, check_count};

/// A sphere about the origin: an icosahedron refined this many times.
///
/// # Errors
/// [`MeshError::Size`] and [`MeshError::TooMany`].
pub fn icosphere(radius: f64, levels: usize) -> Result<Mesh<3, 3>, MeshError> {
    check_size("the radius", radius)?;
    check_levels("the sphere", 20, 4, levels)?;
    let (vertices, triangles) = icosahedron();
    let mut mesh = Mesh::new(vertices, triangles)?;
    for _ in 0..levels {
        mesh = mesh.refined()?.mapped(|x| x.normalize())?;
    }
    mesh.mapped(|x| x * radius)
}

/// A sphere of quadratic triangles, all of whose nodes are on the sphere.
///
/// # Errors
/// Those of [`icosphere`].
pub fn curved_sphere(radius: f64, levels: usize) -> Result<QuadraticTriangles<3>, MeshError> {
    Quadratic::curved(&icosphere(radius, levels)?, |_, middle| direction(middle) * radius)
}

/// A ball about the origin: twenty tetrahedra refined this many times.
///
/// # Errors
/// [`MeshError::Size`] and [`MeshError::TooMany`].
pub fn ball(radius: f64, levels: usize) -> Result<Mesh<3, 4>, MeshError> {
    check_size("the radius", radius)?;
    check_levels("the ball", 20, 8, levels)?;
    let (mut vertices, triangles) = icosahedron();
    let normals: Vec<Vector3<f64>> = triangles
        .iter()
        .map(|&[a, b, c]| vertices[a] + vertices[b] + vertices[c])
        .map(|sum| sum / sum.dot(&sum) * 3.0)
        .collect();
    let centre = vertices.len();
    vertices.push(Vector3::zeros());
    let tetrahedra = triangles.iter().map(|&[a, b, c]| [centre, a, b, c]).collect();
    let mut mesh = Mesh::new(vertices, tetrahedra)?;
    for _ in 0..levels {
        mesh = mesh.refined()?;
    }
    mesh.mapped(|x| {
        let gauge = normals.iter().map(|n| n.dot(x)).fold(0.0, f64::max);
        if gauge > 0.0 { x * (radius * gauge / x.norm()) } else { *x }
    })
}

/// A ball of quadratic tetrahedra, all of whose outer nodes are on the sphere.
///
/// # Errors
/// Those of [`ball`].
pub fn curved_ball(radius: f64, levels: usize) -> Result<QuadraticTetrahedra<3>, MeshError> {
    let mesh = ball(radius, levels)?;
    let boundary = mesh.boundary();
    let mut outer = boundary.mesh.edges().ends;
    for ends in &mut outer {
        *ends = ends.map(|vertex| boundary.vertices[vertex]);
    }
    Quadratic::curved(&mesh, |ends, middle| {
        let on_surface = outer.binary_search(&ends).is_ok();
        if on_surface { direction(middle) * radius } else { middle }
    })
}

/// A torus about the z axis with radii of the tube's centre line and of the tube, in cells around
/// the axis and around the tube.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::Order`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn torus(radii: [f64; 2], cells: [usize; 2]) -> Result<Mesh<3, 3>, MeshError> {
    let ([large, small], [m, n]) = (radii, cells);
    check_size("the radius of the centre line", large)?;
    check_size("the radius of the tube", small)?;
    if small >= large {
        let (smaller, larger) = ("the radius of the tube", "that of the centre line");
        return Err(MeshError::Order { smaller, value: small, larger, bound: large });
    }
    check_cells("cells around the axis", m, 3)?;
    check_cells("cells around the tube", n, 3)?;
    check_count("the torus", [m, n, 2])?;
    let mut vertices = Vec::with_capacity(m * n);
    let mut triangles = Vec::with_capacity(2 * m * n);
    for (i, j) in (0..m).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let (sin_u, cos_u) = (TAU * i as f64 / m as f64).sin_cos();
        let (sin_v, cos_v) = (TAU * j as f64 / n as f64).sin_cos();
        let out = large + small * cos_v;
        vertices.push(Vector3::new(out * cos_u, out * sin_u, small * sin_v));
        let at = |i: usize, j: usize| (i % m) * n + j % n;
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Mesh::new(vertices, triangles)
}

/// The same torus in curved triangles, with nodes on its surface.
///
/// # Errors
/// Those of [`torus`].
pub fn curved_torus(
    radii: [f64; 2],
    cells: [usize; 2],
) -> Result<QuadraticTriangles<3>, MeshError> {
    let [large, small] = radii;
    Quadratic::curved(&torus(radii, cells)?, |_, middle| {
        let centre = direction(Vector3::new(middle.x, middle.y, 0.0)) * large;
        centre + direction(middle - centre) * small
    })
}

/// The icosahedron with vertices on the unit sphere, facing outward.
fn icosahedron() -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices = Vec::with_capacity(12);
    for k in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut vertex = Vector3::zeros();
            (vertex[(k + 1) % 3], vertex[(k + 2) % 3]) = (s, t * golden);
            vertices.push(vertex.normalize());
        }
    }
    // Faces are the triples of neighbours, whose dot product is 1/sqrt 5.
    let near = |a: usize, b: usize| vertices[a].dot(&vertices[b]) > 0.4;
    let mut triangles = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = vertices[a].dot(&vertices[b].cross(&vertices[c])) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [b, a, c] });
                }
            }
        }
    }
    (vertices, triangles)
}

/// An error if that many levels make too many simplices.
fn check_levels(
    what: &'static str,
    first: usize,
    children: usize,
    levels: usize,
) -> Result<(), MeshError> {
    let levels = u32::try_from(levels).ok();
    let children = levels.and_then(|levels| children.checked_pow(levels));
    check_count(what, [first, children.unwrap_or(MOST_SIMPLICES)]).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ClosedSurface, Quality};
    use std::f64::consts::PI;

    #[test]
    fn spheres_and_tori_are_closed_surfaces_of_their_kind() {
        for levels in 0..4 {
            let sphere = icosphere(2.0, levels).unwrap();
            assert_eq!(sphere.euler_characteristic(), 2);
            assert!(sphere.vertices().iter().all(|x| (x.norm() - 2.0).abs() < 1e-15));
            ClosedSurface::new(sphere).unwrap();
        }
        let torus = torus([2.0, 0.5], [40, 20]).unwrap();
        assert_eq!(torus.euler_characteristic(), 0);
        let volume = ClosedSurface::new(torus).unwrap().moments().measure;
        assert!((volume / (2.0 * PI * PI * 2.0 * 0.25) - 1.0).abs() < 0.03);
    }

    #[test]
    fn a_ball_is_a_solid_whose_shapes_stay_good() {
        for levels in 0..4 {
            let ball = ball(1.0, levels).unwrap();
            ball.check_manifold().and(ball.check_oriented()).and(ball.check_positive()).unwrap();
            assert_eq!(ball.euler_characteristic(), 1);
            let surface = ball.boundary().mesh;
            assert_eq!(surface.simplices().len(), 20 * 4_usize.pow(levels as u32));
            assert!(surface.vertices().iter().all(|x| (x.norm() - 1.0).abs() < 1e-14));
            let worst = ball.quality(Quality::MeanRatio).into_iter().fold(1.0, f64::min);
            assert!(worst > 0.5, "{levels} levels: {worst}");
        }
    }

    #[test]
    fn a_curved_ball_gains_two_orders() {
        let exact = 4.0 / 3.0 * PI;
        let curved = [2, 3].map(|k| (curved_ball(1.0, k).unwrap().measure() - exact).abs());
        let straight = [2, 3].map(|k| (ball(1.0, k).unwrap().measure() - exact).abs());
        let order = |[a, b]: [f64; 2]| (a / b).log2();
        assert!((order(curved) - 4.0).abs() < 0.2, "{}", order(curved));
        assert!((order(straight) - 2.0).abs() < 0.1, "{}", order(straight));
    }

    #[test]
    fn a_curved_torus_gains_two_orders() {
        let exact = [4.0 * PI * PI * 2.0 * 0.5, 2.0 * PI * PI * 2.0 * 0.25];
        let errors = [1, 2].map(|k| {
            let torus = curved_torus([2.0, 0.5], [24 * k, 12 * k]).unwrap();
            let measured = [torus.measure(), torus.enclosed_moments().measure];
            [0, 1].map(|i| (measured[i] / exact[i] - 1.0).abs())
        });
        for (coarse, fine) in errors[0].into_iter().zip(errors[1]) {
            assert!(fine < 1e-4 && coarse / fine > 14.0, "{errors:?}");
        }
    }

    #[test]
    fn impossible_shapes_are_named() {
        assert!(matches!(icosphere(0.0, 1), Err(MeshError::Size { .. })));
        for levels in [40, usize::MAX] {
            assert!(matches!(icosphere(1.0, levels), Err(MeshError::TooMany { .. })));
            assert!(matches!(ball(1.0, levels), Err(MeshError::TooMany { .. })));
        }
        assert!(matches!(torus([1.0, 1.0], [9, 9]), Err(MeshError::Order { .. })));
        assert!(matches!(torus([2.0, 1.0], [9, 2]), Err(MeshError::TooFew { .. })));
    }
}
