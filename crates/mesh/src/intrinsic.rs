//! A triangle known by its edge lengths alone: area, angles, cotangents.
//!
//! ```text
//! A = 1/4 sqrt((a + (b + c)) (c - (a - b)) (c + (a - b)) (a + (b - c))),      a >= b >= c
//! cot alpha = (b^2 + c^2 - a^2) / 4A,     alpha = atan2(4A, b^2 + c^2 - a^2)      opposite to a
//! ```
//! `a b c` lengths (m). The brackets are Kahan's, and keep needles accurate, where Heron's formula
//! loses half of the digits. Lengths are taken in units of the longest, a power of two, so that angles
//! are right at every size. A Laplacian of a surface needs nothing else. Three lengths that no
//! triangle has are refused, and three whose area no number holds; three that lie on a line have area
//! zero and no finite cotangents.
//! Source: Kahan, Miscalculating area and angles of a needle-like triangle, 2014.

/// The lengths of a triangle's edges 01, 12 and 20.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntrinsicTriangle {
    lengths: [f64; 3],
}

impl IntrinsicTriangle {
    /// A triangle with edges 01, 12 and 20 of these lengths; `None` if there is none, or only one whose
    /// area is more than the largest number.
    pub fn new(lengths: [f64; 3]) -> Option<Self> {
        let [a, b, c] = falling(lengths);
        let triangle = IntrinsicTriangle { lengths };
        (c > 0.0 && a.is_finite() && a - b <= c && triangle.area().is_finite()).then_some(triangle)
    }

    /// A triangle of lengths that are known to be one's.
    pub(crate) fn known(lengths: [f64; 3]) -> Self {
        IntrinsicTriangle { lengths }
    }

    /// The lengths of the edges 01, 12 and 20.
    pub fn lengths(&self) -> [f64; 3] {
        self.lengths
    }

    /// The area.
    pub fn area(&self) -> f64 {
        let (unit, triangle) = self.in_its_unit();
        unit * (unit * triangle.plain_area())
    }

    /// The cotangents of the angles at the corners 0, 1 and 2.
    pub fn cotangents(&self) -> [f64; 3] {
        let (_, triangle) = self.in_its_unit();
        let quadruple = 4.0 * triangle.plain_area();
        triangle.dots().map(|dot| dot / quadruple)
    }

    /// The angles at the corners 0, 1 and 2, radians.
    pub fn angles(&self) -> [f64; 3] {
        let (_, triangle) = self.in_its_unit();
        let quadruple = 4.0 * triangle.plain_area();
        triangle.dots().map(|dot| quadruple.atan2(dot))
    }

    /// The largest power of two that is not above the longest side, and the triangle in that unit.
    fn in_its_unit(&self) -> (f64, Self) {
        let unit = power_below(self.lengths.iter().fold(0.0, |a, &b| b.max(a)));
        (unit, IntrinsicTriangle { lengths: self.lengths.map(|length| length / unit) })
    }

    /// The area where the longest side is near 1.
    fn plain_area(&self) -> f64 {
        let [a, b, c] = falling(self.lengths);
        let short = power_below(c);
        let needle = ((c - (a - b)) / short) * ((c + (a - b)) / short);
        let brackets = (a + (b + c)) * needle * (a + (b - c));
        short * brackets.max(0.0).sqrt() / 4.0
    }

    /// Twice the dot products of the edges that meet at each corner: `b^2 + c^2 - a^2`.
    fn dots(&self) -> [f64; 3] {
        let [l01, l12, l20] = self.lengths;
        // The difference of squares as a product: a needle's short edge is not lost.
        let dot = |a: f64, b: f64, c: f64| {
            let (long, short) = (b.max(c), b.min(c));
            (long - a) * (long + a) + short * short
        };
        [dot(l12, l20, l01), dot(l20, l01, l12), dot(l01, l12, l20)]
    }
}

/// The largest power of two that is not above a positive normal number.
fn power_below(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & f64::INFINITY.to_bits())
}

fn falling(mut lengths: [f64; 3]) -> [f64; 3] {
    lengths.sort_by(|a, b| b.total_cmp(a));
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use nalgebra::Vector3;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    #[test]
    fn three_four_five_has_its_area_and_a_right_angle() {
        let triangle = IntrinsicTriangle::new([3.0, 4.0, 5.0]).unwrap();
        assert_eq!(triangle.area(), 6.0);
        assert_eq!(triangle.cotangents(), [0.75, 0.0, 4.0 / 3.0], "corner 1 joins 3 and 4");
        assert_eq!(triangle.angles()[1], PI / 2.0);
    }

    #[test]
    fn lengths_that_no_triangle_has_are_refused() {
        assert_eq!(IntrinsicTriangle::new([1.0, 2.0, 3.0_f64.next_up()]), None);
        assert_eq!(IntrinsicTriangle::new([1.0, 2.0, 3.0]).unwrap().area(), 0.0);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(IntrinsicTriangle::new([1.0, 1.0, bad]), None);
        }
    }

    #[test]
    fn angles_are_right_at_every_size_and_an_area_beyond_all_numbers_is_refused() {
        for size in [1e-300, 1e-100, 1.0, 1e100, 1e153] {
            let triangle = IntrinsicTriangle::new([3.0 * size, 4.0 * size, 5.0 * size]).unwrap();
            assert!((triangle.angles()[1] - PI / 2.0).abs() < 1e-15);
            assert!((triangle.cotangents()[0] - 0.75).abs() < 1e-15);
            assert!((triangle.area() - 6.0 * size * size).abs() <= 1e-14 * size * size);
        }
        assert_eq!(IntrinsicTriangle::new([1e308; 3]), None);
        assert_eq!(IntrinsicTriangle::new([1e155; 3]), None);
        let needle = IntrinsicTriangle::new([1e300, 1e-5, 1e300]).unwrap();
        assert!((needle.area() / 5e294 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_area_of_a_needle_keeps_its_digits_where_herons_formula_loses_half() {
        // Isosceles with base e: A = e/2 sqrt(1 - e^2/4).
        let e = 1e-8_f64;
        let exact = e / 2.0 * (1.0 - e * e / 4.0).sqrt();
        let kahan = IntrinsicTriangle::new([1.0, e, 1.0]).unwrap().area();
        assert!((kahan / exact - 1.0).abs() < 1e-15);
        let s = (1.0 + e + 1.0) / 2.0;
        let heron = (s * (s - 1.0) * (s - e) * (s - 1.0)).sqrt();
        assert!((heron / exact - 1.0).abs() > 1e-9, "{heron:e}");
    }

    proptest! {
        #[test]
        fn a_triangle_in_space_and_its_lengths_agree(
            n in proptest::array::uniform9(-1.0..1.0_f64),
        ) {
            let corners = [0, 3, 6].map(|k| Vector3::new(n[k], n[k + 1], n[k + 2]));
            let [a, b, c]: [Vector3<f64>; 3] = corners;
            prop_assume!(measure(&corners) > 1e-3);
            let lengths = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
            let triangle = IntrinsicTriangle::new(lengths).unwrap();
            prop_assert!((triangle.area() - measure(&corners)).abs() < 1e-11);
            prop_assert!((triangle.angles()[0] - (b - a).angle(&(c - a))).abs() < 1e-9);
            prop_assert!((triangle.angles().iter().sum::<f64>() - PI).abs() < 1e-9);
            let [x, y, z] = triangle.cotangents();
            let size = 1.0 + x * x + y * y + z * z;
            prop_assert!((x * y + y * z + z * x - 1.0).abs() < 1e-6 * size);
        }
    }
}
