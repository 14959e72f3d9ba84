//! The plane shapes of two published benchmarks.
//!
//! ```text
//! LE1    ((2 + 5/4 s) cos t, (1 + 7/4 s) sin t)          s in [0, 1],  t in [0, pi/2]
//! FV32   (10 s, (5/2 - 2 s) (2 t - 1))                   s, t in [0, 1]
//! ```
//! In metres. LE1 is a quarter of an elliptic ring between semi-axes 2, 1 and 3.25, 2.75, with
//! its corners at (2, 0), (3.25, 0), (0, 2.75), (0, 1); FV32 a symmetric membrane 10 long, 5 high
//! at x = 0 and 1 at its tip. Areas are pi/4 (3.25 2.75 - 2 1) and 30. Source: NAFEMS, The
//! standard NAFEMS benchmarks, 1990, tests LE1 and FV32.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;

use super::{Diagonals, rectangle};
use crate::MeshError;
use crate::mesh::Mesh;
use crate::quadratic::{Quadratic, QuadraticTriangles};

/// The membrane of NAFEMS LE1, in cells outward and around.
///
/// # Errors
/// [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn elliptic_membrane(cells: [usize; 2]) -> Result<Mesh<2, 3>, MeshError> {
    rectangle([1.0, 1.0], cells, Diagonals::Alternating)?.mapped(elliptic)
}

/// The membrane of NAFEMS LE1 in quadratic triangles, all of whose nodes are where the true shape
/// has them.
///
/// # Errors
/// [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn curved_elliptic_membrane(cells: [usize; 2]) -> Result<QuadraticTriangles<2>, MeshError> {
    Quadratic::straight(&rectangle([1.0, 1.0], cells, Diagonals::Alternating)?).mapped(elliptic)
}

/// The membrane of NAFEMS FV32, in cells along and across.
///
/// # Errors
/// [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn tapered_membrane(cells: [usize; 2]) -> Result<Mesh<2, 3>, MeshError> {
    rectangle([1.0, 1.0], cells, Diagonals::Alternating)?
        .mapped(|x| Vector2::new(10.0 * x.x, (2.5 - 2.0 * x.x) * (2.0 * x.y - 1.0)))
}

fn elliptic(x: &Vector2<f64>) -> Vector2<f64> {
    // On the axes to the last bit, so that symmetry can be asked for by x = 0 and y = 0.
    let (s, c) = match x.y {
        1.0 => (1.0, 0.0),
        y => (FRAC_PI_2 * y).sin_cos(),
    };
    Vector2::new((2.0 + 1.25 * x.x) * c, (1.0 + 1.75 * x.x) * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_elliptic_membrane_has_its_corners_and_its_area() {
        let exact = PI / 4.0 * (3.25 * 2.75 - 2.0);
        let mesh = elliptic_membrane([4, 6]).unwrap();
        mesh.check_positive().and(mesh.check_manifold()).unwrap();
        for corner in [[2.0, 0.0], [3.25, 0.0], [0.0, 2.75], [0.0, 1.0]] {
            assert!(mesh.vertices().contains(&corner.into()), "{corner:?}");
        }
        let straight = |n| (elliptic_membrane([n, n]).unwrap().measure() - exact).abs();
        let curved = |n| (curved_elliptic_membrane([n, n]).unwrap().measure() - exact).abs();
        assert!(((straight(4) / straight(8)).log2() - 2.0).abs() < 0.1);
        let order = (curved(4) / curved(8)).log2();
        assert!((order - 4.0).abs() < 0.2, "{order}");
        curved_elliptic_membrane([4, 4]).unwrap().check_positive().unwrap();
    }

    #[test]
    fn nodes_of_the_curved_membrane_lie_on_both_ellipses() {
        let mesh = curved_elliptic_membrane([2, 5]).unwrap();
        let on = |a: f64, b: f64| {
            let level =
                |x: &&Vector2<f64>| ((x.x / a).powi(2) + (x.y / b).powi(2) - 1.0).abs() < 1e-14;
            mesh.nodes().iter().filter(level).count()
        };
        assert_eq!((on(2.0, 1.0), on(3.25, 2.75)), (11, 11));
    }

    #[test]
    fn the_tapered_membrane_has_area_thirty_and_is_symmetric() {
        let mesh = tapered_membrane([8, 4]).unwrap();
        mesh.check_positive().and(mesh.check_manifold()).unwrap();
        let moments = mesh.moments();
        assert!((moments.measure - 30.0).abs() < 1e-13);
        assert!(moments.first.y.abs() < 1e-13);
        for corner in [[0.0, 2.5], [0.0, -2.5], [10.0, 0.5], [10.0, -0.5]] {
            assert!(mesh.vertices().contains(&corner.into()), "{corner:?}");
        }
    }
}
