//! Integrals of 1, x and x x^T: what mass, centre and inertia are made of.
//!
//! ```text
//! m = int 1,   f = int (x - o),   C = int (x - o)(x - o)^T           over a shape, about a point o
//! simplex:  m = |s|,   f = m s/K,   C = m (sum_k v_k v_k^T + s s^T) / (K (K + 1)),   s = sum_k v_k
//! another o, d = o - o':  f' = f + m d,   C' = C + f d^T + d f^T + m d d^T
//! ```
//! `v_k` corners seen from `o` (m), `K` of them; `m` in m^n, `f` in m^(n+1), `C` in m^(n+2),
//! where n is the dimension of the shape. Exact for polynomials of degree 2. Sums run about the
//! middle of the shape's extent, never about the origin: a unit cube a million metres away keeps
//! what its coordinates have. Times a density `C` gives the inertia tensor `tr(C) 1 - C` in space
//! and the polar inertia `tr(C)` in the plane. Source: notes 7.1-7.3, 9.4; errata chapter 7.

use nalgebra::{Matrix3, SMatrix, SVector};

use crate::measure::measure;
use crate::mesh::Mesh;

/// The integrals of 1, `x - about` and its square over a shape of density one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<const D: usize> {
    /// The point they are taken about.
    pub about: SVector<f64, D>,
    /// Length, area or volume.
    pub measure: f64,
    /// First moments.
    pub first: SVector<f64, D>,
    /// Second moments, symmetric.
    pub second: SMatrix<f64, D, D>,
}

impl<const D: usize> Moments<D> {
    /// The moments of nothing.
    pub fn zero(about: SVector<f64, D>) -> Self {
        let (first, second) = (SVector::zeros(), SMatrix::zeros());
        Moments { about, measure: 0.0, first, second }
    }

    /// The moments of a simplex, about its first corner.
    pub fn of_simplex<const K: usize>(corners: &[SVector<f64, D>; K]) -> Self {
        let mut moments = Moments::zero(corners[0]);
        moments.add_simplex(measure(corners), &corners.map(|corner| corner - corners[0]), K);
        moments
    }

    /// Adds a simplex of this measure and number of corners. They are seen from `about`; one that
    /// is there may be left out of the list.
    pub(crate) fn add_simplex(&mut self, measure: f64, corners: &[SVector<f64, D>], number: usize) {
        let s: SVector<f64, D> = corners.iter().sum();
        let k = number as f64;
        let squares: SMatrix<f64, D, D> = corners.iter().map(|v| v * v.transpose()).sum();
        self.measure += measure;
        self.first += s * (measure / k);
        self.second += (squares + s * s.transpose()) * (measure / (k * (k + 1.0)));
    }

    /// Where the shape balances; `None` where it has no measure.
    pub fn centroid(&self) -> Option<SVector<f64, D>> {
        let offset = self.first / self.measure;
        offset.iter().all(|x| x.is_finite()).then(|| self.about + offset)
    }

    /// The same shape's moments about another point, by the parallel-axis rule.
    #[must_use]
    pub fn seen_from(&self, about: SVector<f64, D>) -> Self {
        let d = self.about - about;
        let mixed = self.first * d.transpose();
        Moments {
            about,
            measure: self.measure,
            first: self.first + d * self.measure,
            second: self.second + mixed + mixed.transpose() + d * d.transpose() * self.measure,
        }
    }

    /// The moments about the centroid, first ones zero; `None` where the shape has no measure.
    pub fn central(&self) -> Option<Self> {
        let about = self.centroid()?;
        let offset = self.first / self.measure;
        let second = self.second - offset * self.first.transpose();
        Some(Moments { about, measure: self.measure, first: SVector::zeros(), second })
    }

    /// The moments of both shapes together, about the point of this one.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        let other = other.seen_from(self.about);
        Moments {
            about: self.about,
            measure: self.measure + other.measure,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    /// The moments of the same shape counted negative: a hole.
    #[must_use]
    pub fn negative(&self) -> Self {
        let Moments { about, measure, first, second } = *self;
        Moments { about, measure: -measure, first: -first, second: -second }
    }

    /// `tr(C)`: in the plane, the polar inertia for density one.
    pub fn polar(&self) -> f64 {
        self.second.trace()
    }
}

impl Moments<3> {
    /// `tr(C) 1 - C`, the inertia tensor for density one.
    pub fn inertia(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.second.trace() - self.second
    }
}

impl<const D: usize, const K: usize> Mesh<D, K> {
    /// The moments of all simplices, about the middle of their extent. Inverted simplices count
    /// negative, as their measure does.
    pub fn moments(&self) -> Moments<D> {
        let mut moments = Moments::zero(self.middle());
        for simplex in self.simplices() {
            let corners = self.corners(simplex);
            let seen = corners.map(|corner| corner - moments.about);
            moments.add_simplex(measure(&corners), &seen, K);
        }
        moments
    }

    /// The middle of the extent of the vertices that simplices name; the origin if there are none.
    pub fn middle(&self) -> SVector<f64, D> {
        let used = self.simplices().iter().flatten().map(|&vertex| self.vertices()[vertex]);
        middle(used).unwrap_or_else(SVector::zeros)
    }
}

/// The middle of the extent of points, if there are any.
pub(crate) fn middle<const D: usize>(
    mut points: impl Iterator<Item = SVector<f64, D>>,
) -> Option<SVector<f64, D>> {
    let first = points.next()?;
    let (low, high) = points.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
    Some(low + (high - low) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};
    use proptest::prelude::*;

    /// The integral of x^a y^b z^c over the unit tetrahedron is a! b! c! / (a + b + c + 3)!.
    #[test]
    fn monomials_over_the_unit_tetrahedron_are_factorials() {
        let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let moments = Moments::of_simplex(&corners);
        assert!((moments.measure - 1.0 / 6.0).abs() < 1e-16);
        assert!((moments.first - Vector3::repeat(1.0 / 24.0)).amax() < 1e-17);
        let exact = Matrix3::from_fn(|i, j| if i == j { 2.0 } else { 1.0 } / 120.0);
        assert!((moments.second - exact).amax() < 1e-17);
    }

    #[test]
    fn monomials_over_the_unit_triangle_are_factorials() {
        let moments = Moments::of_simplex(&[Vector2::zeros(), Vector2::x(), Vector2::y()]);
        assert_eq!(moments.measure, 0.5);
        assert!((moments.first - Vector2::repeat(1.0 / 6.0)).amax() < 1e-16);
        assert!((moments.second[(0, 0)] - 1.0 / 12.0).abs() < 1e-16);
        assert!((moments.second[(0, 1)] - 1.0 / 24.0).abs() < 1e-16);
    }

    #[test]
    fn a_rod_has_its_textbook_inertia() {
        let rod = Moments::of_simplex(&[Vector3::new(1.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 2.0)]);
        let central = rod.central().unwrap();
        assert_eq!(central.about, Vector3::new(1.0, 0.0, 1.0));
        assert!(
            (central.inertia() - Matrix3::from_diagonal(&Vector3::new(2.0, 2.0, 0.0)) / 3.0).amax()
                < 1e-15
        );
    }

    #[test]
    fn a_shape_without_measure_has_no_centroid() {
        assert_eq!(Moments::<2>::zero(Vector2::zeros()).centroid(), None);
        let flat = Moments::of_simplex(&[Vector2::zeros(), Vector2::x(), Vector2::x() * 2.0]);
        assert_eq!(flat.central(), None);
    }

    fn triangle(numbers: [f64; 6]) -> [Vector2<f64>; 3] {
        std::array::from_fn(|k| Vector2::new(numbers[2 * k], numbers[2 * k + 1]))
    }

    proptest! {
        #[test]
        fn a_point_of_view_and_its_way_back_change_nothing(
            numbers in proptest::array::uniform6(-1.0..1.0_f64),
            point in proptest::array::uniform2(-3.0..3.0_f64),
        ) {
            let moments = Moments::of_simplex(&triangle(numbers));
            let back = moments.seen_from(point.into()).seen_from(moments.about);
            prop_assert!((back.first - moments.first).amax() < 1e-13);
            prop_assert!((back.second - moments.second).amax() < 1e-13);
        }

        #[test]
        fn a_simplex_has_the_moments_of_its_pieces(
            numbers in proptest::array::uniform6(-1.0..1.0_f64),
            weights in (0.1..0.9_f64, 0.1..0.9_f64),
        ) {
            let [a, b, c] = triangle(numbers);
            let (u, v) = (weights.0 * weights.1, weights.0 * (1.0 - weights.1));
            let inner = a + (b - a) * u + (c - a) * v;
            let whole = Moments::of_simplex(&[a, b, c]);
            let pieces = [[a, b, inner], [b, c, inner], [c, a, inner]];
            let sum = pieces.iter().fold(Moments::zero(a), |sum, piece| {
                sum.with(&Moments::of_simplex(piece))
            });
            prop_assert!((whole.measure - sum.measure).abs() < 1e-14);
            prop_assert!((whole.first - sum.first).amax() < 1e-14);
            prop_assert!((whole.second - sum.second).amax() < 1e-14);
        }
    }
}
