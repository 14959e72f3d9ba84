//! Length, area and volume of a simplex, from its edges.
//!
//! ```text
//! |s| = |det(x1 - x0, ..., xn - x0)| / n!        n = K - 1 = D, with the sign of the determinant
//! |s| = |x1 - x0|,   |(x1 - x0) x (x2 - x0)| / 2     in more dimensions than its own, no sign
//! ```
//! `x0 ... xn` corners (m). Differences of corners come first, so that a small simplex far from the
//! origin loses nothing but what its coordinates have lost. Counterclockwise triangles in the plane
//! are positive, and tetrahedra whose last corner sees the first three clockwise.

use nalgebra::{SVector, Vector2, Vector3};

use crate::mesh::Mesh;
use crate::{MeshError, Places};

/// Length, area or volume of a simplex: signed if it has the dimension of its space.
#[inline]
pub fn measure<const D: usize, const K: usize>(corners: &[SVector<f64, D>; K]) -> f64 {
    let [a, b, c] = edges_from_first(corners);
    match (K, D) {
        (2, 1) => a.x,
        (2, _) => a.norm(),
        (3, 2) => Vector2::new(a.x, a.y).perp(&Vector2::new(b.x, b.y)) / 2.0,
        (3, _) => a.cross(&b).norm() / 2.0,
        _ => a.dot(&b.cross(&c)) / 6.0,
    }
}

/// The edges from the first corner to the others, in space, zero where there is none.
#[inline]
fn edges_from_first<const D: usize, const K: usize>(
    corners: &[SVector<f64, D>; K],
) -> [Vector3<f64>; 3] {
    std::array::from_fn(|k| match corners.get(k + 1) {
        Some(corner) => in_space(&(corner - corners[0])),
        None => Vector3::zeros(),
    })
}

/// A vector with zeros for the coordinates that it lacks.
#[inline]
pub(crate) fn in_space<const D: usize>(vector: &SVector<f64, D>) -> Vector3<f64> {
    Vector3::from_fn(|c, _| if c < D { vector[c] } else { 0.0 })
}

/// Below this part of the longest edge's power, a measure is rounding.
const FLAT: f64 = 4.0 * f64::EPSILON;

/// Whether a simplex has no size but rounding.
#[inline]
pub(crate) fn is_flat<const D: usize, const K: usize>(corners: &[SVector<f64, D>; K]) -> bool {
    let mut longest = 0.0_f64;
    for (k, corner) in corners.iter().enumerate() {
        let to = |other: &SVector<f64, D>| (corner - other).norm_squared();
        longest = corners[..k].iter().fold(longest, |longest, other| longest.max(to(other)));
    }
    let size = measure(corners).abs();
    // The longest edge to the power of K - 1, from its square.
    let power = if K == 3 { longest } else { longest.sqrt().powi(K as i32 - 1) };
    size <= FLAT * power
}

impl<const D: usize, const K: usize> Mesh<D, K> {
    /// Length, area or volume of each simplex, signed if it has the dimension of its space.
    pub fn measures(&self) -> impl ExactSizeIterator<Item = f64> {
        self.simplices().iter().map(|simplex| measure(&self.corners(simplex)))
    }

    /// Length, area or volume of the whole mesh.
    pub fn measure(&self) -> f64 {
        self.measures().sum()
    }

    /// An error that lists the simplices whose size is zero to rounding.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`].
    pub fn check_nondegenerate(&self) -> Result<(), MeshError> {
        let numbered = self.simplices().iter().enumerate();
        let flat = numbered.filter(|(_, s)| is_flat(&self.corners(s))).map(|(number, _)| number);
        Places::refuse(flat.collect(), MeshError::Degenerate)
    }

    /// An error that lists the simplices that are turned inside out: what a mesh of elements must
    /// not have. A mesh of smaller dimension than its space has none.
    ///
    /// # Errors
    /// [`MeshError::Inverted`].
    pub fn check_positive(&self) -> Result<(), MeshError> {
        let numbered = self.measures().enumerate();
        let inverted = numbered.filter(|(_, measure)| *measure < 0.0).map(|(number, _)| number);
        Places::refuse(inverted.collect(), MeshError::Inverted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector1, Vector2, Vector3};
    use proptest::prelude::*;

    #[test]
    fn unit_simplices_have_one_over_n_factorial() {
        assert_eq!(measure(&[Vector1::new(0.0), Vector1::new(1.0)]), 1.0);
        assert_eq!(measure(&[Vector2::zeros(), Vector2::x(), Vector2::y()]), 0.5);
        let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        assert_eq!(measure(&corners), 1.0 / 6.0);
    }

    #[test]
    fn a_line_and_a_triangle_in_space_have_no_sign() {
        assert_eq!(measure(&[Vector3::new(3.0, 0.0, 4.0), Vector3::zeros()]), 5.0);
        assert_eq!(measure(&[Vector3::zeros(), Vector3::z(), Vector3::y()]), 0.5);
    }

    #[test]
    fn flat_and_inverted_simplices_are_listed() {
        let vertices = vec![
            Vector2::zeros(),
            Vector2::x(),
            Vector2::y(),
            Vector2::new(0.5, 0.5),
            Vector2::new(0.1, 0.9),
        ];
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2], [0, 2, 1], [1, 4, 3]]).unwrap();
        assert_eq!(mesh.check_nondegenerate(), Err(MeshError::Degenerate(Places(vec![1, 3]))));
        assert!(matches!(
            mesh.check_positive(),
            Err(MeshError::Inverted(places)) if places.0.contains(&2) && !places.0.contains(&0)
        ));
    }

    proptest! {
        #[test]
        fn turning_over_flips_the_sign_and_moving_keeps_the_size(
            numbers in proptest::array::uniform12(-1.0..1.0_f64),
            shift in proptest::array::uniform3(-1e6..1e6_f64),
        ) {
            let corners: [Vector3<f64>; 4] = std::array::from_fn(|k| {
                Vector3::new(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2])
            });
            let [a, b, c, d] = corners;
            prop_assert!((measure(&corners) + measure(&[b, a, c, d])).abs() < 1e-15);
            prop_assert!((measure(&corners) - measure(&[b, c, a, d])).abs() < 1e-15);
            let moved = corners.map(|corner| corner + Vector3::from(shift));
            prop_assert!((measure(&moved) - measure(&corners)).abs() < 1e-8);
        }
    }
}
