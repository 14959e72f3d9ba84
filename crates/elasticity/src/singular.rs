//! Singular values with signs, of matrices of at most three columns.
//!
//! ```text
//! F = U diag(s) V^T         U D x R, V R x R a rotation, s_k >= 0, orthonormal columns
//! D = R                     U a rotation too: the smallest s carries the sign of det F
//! ```
//! By Jacobi's rotations of pairs of columns, which find small singular values to full relative
//! accuracy; four elements side by side are rotated together until all of them are done. Three
//! columns start from the eigenvectors of F^T F in closed form, which leave nothing to rotate but
//! where one stretch is far below another. The number of sweeps is bounded. What is not finite comes
//! out as NaN. Source: Hestenes (1958); Demmel and Veselic (1992).

use stationary_calculus::array;

use crate::Real;
use crate::eigen::{SWEEPS, frame_of, identity, rotate, rotation, spectral};
use crate::tensor::{determinant, dot, gram, inner, product, scaled};

/// A stretch this far below the largest leaves its direction open: its square has lost digits.
const NOTHING: f64 = 1e-146;

/// A matrix as two frames and the stretches between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singular<T, const D: usize, const R: usize> {
    /// The columns `u_k`.
    pub(crate) left: [[T; D]; R],
    /// The stretches `s_k`.
    pub(crate) values: [T; R],
    /// The columns `v_k`.
    pub(crate) right: [[T; R]; R],
}

/// One, or where squares of entries could overflow or vanish, powers of two that bring the largest
/// entries to between one and two: no digit is lost.
#[inline(always)]
fn size<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> T {
    let square = inner(f, f);
    if square.all(|x| (1e-2..1e2).contains(&x)) { T::splat(1.0) } else { power_of_two(f) }
}

#[cold]
#[inline(never)]
fn power_of_two<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> T {
    const EXPONENT: u64 = 0x7ff << 52;
    let mut largest = T::splat(0.0);
    for entry in f.as_flattened() {
        largest = largest.larger(entry.magnitude());
    }
    let [size] = T::each(&[largest], |[x]| {
        let power = f64::from_bits(x.to_bits() & EXPONENT);
        [if power > 0.0 { power } else { 1.0 }]
    });
    size
}

/// The singular values of `f` and their frames.
#[inline]
pub(crate) fn singular<T: Real, const D: usize, const R: usize>(
    f: &[[T; D]; R],
) -> Singular<T, D, R> {
    const CLOSE: f64 = (8.0 * f64::EPSILON) * (8.0 * f64::EPSILON);
    let size = size(f);
    let (mut columns, mut right) = started(&scaled(f, size.reciprocal()));
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..R {
            for q in p + 1..R {
                let (a, c) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
                let b = dot(&columns[p], &columns[q]);
                let excess = b * b - a * c * CLOSE;
                // False of NaN too: nothing helps it.
                if excess.any(|x| x > 0.0) {
                    rotated = true;
                    let turn = rotation(a, b, c);
                    rotate(&mut columns, (p, q), turn);
                    rotate(&mut right, (p, q), turn);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let mut values = [size; R];
    for k in 0..R {
        values[k] = dot(&columns[k], &columns[k]).square_root();
    }
    let mut result = Singular { left: columns, values, right };
    result.normalize();
    for value in &mut result.values {
        *value = *value * size;
    }
    result
}

/// `F V` and V: three columns are at right angles to rounding of the longest one from the start.
#[inline(always)]
fn started<T: Real, const D: usize, const R: usize>(
    columns: &[[T; D]; R],
) -> ([[T; D]; R], [[T; R]; R]) {
    let mut right = identity();
    if R == 3 {
        let squares = gram(columns);
        if (0..3).any(|k| squares[k][(k + 1) % 3].any(|x| x != 0.0)) {
            frame_of(&squares, &mut right);
            return (product(columns, &right), right);
        }
    }
    (*columns, right)
}

impl<T: Real, const D: usize, const R: usize> Singular<T, D, R> {
    #[inline(always)]
    fn normalize(&mut self) {
        if self.values.iter().any(|value| value.any(|s| s <= NOTHING)) {
            self.normalize_degenerate();
        } else {
            for k in 0..R {
                let inverse = self.values[k].reciprocal();
                for entry in &mut self.left[k] {
                    *entry = *entry * inverse;
                }
            }
        }
        if D != R {
            return;
        }
        // V is a product of rotations: only U may be a reflection.
        let volume = square_determinant(&self.left);
        if volume.any(|x| x < 0.0) {
            for lane in 0..T::WIDTH {
                if volume.lane(lane) < 0.0 {
                    self.reflect(lane);
                }
            }
        }
    }

    /// Turns the direction of the least stretch around.
    fn reflect(&mut self, lane: usize) {
        let mut least = 0;
        for k in 1..R {
            if self.values[k].lane(lane) < self.values[least].lane(lane) {
                least = k;
            }
        }
        for entry in self.left[least].iter_mut().chain([&mut self.values[least]]) {
            entry.set_lane(lane, -entry.lane(lane));
        }
    }

    /// The same where some stretch vanishes and leaves its direction open.
    #[cold]
    fn normalize_degenerate(&mut self) {
        for lane in 0..T::WIDTH {
            let values: [f64; R] = array(|k| self.values[k].lane(lane));
            let mut left: [[f64; D]; R] = array(|k| array(|i| self.left[k][i].lane(lane)));
            for k in 0..R {
                if values[k] > NOTHING || values[k].is_nan() {
                    left[k] = left[k].map(|x| x / values[k]);
                }
            }
            for k in 0..R {
                if values[k] <= NOTHING {
                    left[k] = completed(&left, &values, k);
                }
            }
            for (column, numbers) in self.left.iter_mut().zip(left) {
                for (entry, number) in column.iter_mut().zip(numbers) {
                    entry.set_lane(lane, number);
                }
            }
        }
    }

    /// The rotation nearest to F, `U V^T`, by columns.
    #[inline(always)]
    pub(crate) fn rotation(&self) -> [[T; D]; R] {
        let mut rotation = self.left;
        for k in 0..R {
            for i in 0..D {
                let mut sum = self.left[0][i] * self.right[0][k];
                for m in 1..R {
                    sum = self.left[m][i].multiply_add(self.right[m][k], sum);
                }
                rotation[k][i] = sum;
            }
        }
        rotation
    }
}

impl<const D: usize, const R: usize> Singular<f64, D, R> {
    /// `V diag(g(s)) V^T`, by columns: the strain of a measure of stretch.
    pub(crate) fn spectral(&self, g: impl Fn(f64) -> f64) -> [[f64; R]; R] {
        spectral(&self.right, &self.values.map(g))
    }
}

/// A unit vector at right angles to the columns that are known: those before k, and those of positive
/// stretch.
fn completed<const D: usize, const R: usize>(
    left: &[[f64; D]; R],
    values: &[f64; R],
    k: usize,
) -> [f64; D] {
    let known = |other: &usize| *other != k && (*other < k || values[*other] > NOTHING);
    let mut best = ([0.0; D], 0.0);
    for axis in 0..D {
        let mut candidate = [0.0; D];
        candidate[axis] = 1.0;
        for other in (0..R).filter(known) {
            let along = dot(&candidate, &left[other]);
            for i in 0..D {
                candidate[i] -= along * left[other][i];
            }
        }
        let length = dot(&candidate, &candidate).sqrt();
        if length > best.1 {
            best = (candidate.map(|x| x / length), length);
        }
    }
    best.0
}

/// The determinant where the matrix is square, else zero.
#[inline(always)]
pub(crate) fn square_determinant<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> T {
    let at = |i: usize, k: usize| f[k][i];
    match (D, R) {
        (1, 1) => at(0, 0),
        (2, 2) => at(0, 0) * at(1, 1) - at(1, 0) * at(0, 1),
        (3, 3) => {
            let mut columns = [[T::splat(0.0); 3]; 3];
            for k in 0..3 {
                for i in 0..3 {
                    columns[k][i] = at(i, k);
                }
            }
            determinant::<T, 3>(&columns)
        }
        _ => T::splat(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lanes;
    use proptest::prelude::*;

    fn assert_decomposes<const D: usize, const R: usize>(f: &[[f64; D]; R], size: f64) {
        let Singular { left, values, right } = singular(f);
        for k in 0..R {
            for l in 0..R {
                let unit = if k == l { 1.0 } else { 0.0 };
                assert!((dot(&left[k], &left[l]) - unit).abs() < 1e-14, "{f:?}: {left:?}");
                assert!((dot(&right[k], &right[l]) - unit).abs() < 1e-14, "{right:?}");
            }
            for i in 0..D {
                let sum: f64 = (0..R).map(|m| values[m] * left[m][i] * right[m][k]).sum();
                assert!((sum - f[k][i]).abs() < 1e-14 * size, "{f:?}");
            }
        }
        if D == R {
            let sign = square_determinant(&left) * square_determinant(&right);
            assert!((sign - 1.0).abs() < 1e-14, "{f:?}");
        }
    }

    fn matrix() -> impl Strategy<Value = [[f64; 3]; 3]> {
        prop::array::uniform3(prop::array::uniform3(-2.0..2.0))
    }

    proptest! {
        #[test]
        fn every_matrix_is_two_rotations_and_stretches(f in matrix()) {
            assert_decomposes(&f, 6.0);
            assert_decomposes(&[[f[0][0], f[0][1]], [f[1][0], f[1][1]]], 6.0);
            let membrane: [[f64; 3]; 2] = [f[0], f[1]];
            assert_decomposes(&membrane, 6.0);
            assert_decomposes(&[f[2]], 6.0);
        }
    }

    #[test]
    fn four_matrices_side_by_side_are_what_each_is_alone() {
        let at = |lane: usize, k: usize, i: usize| match lane {
            0 => f64::from(u8::from(k == i)),
            1 => 1e100 * ((3 * k + i) as f64).sin(),
            2 => {
                if k == 1 {
                    0.0
                } else {
                    (k + 2 * i) as f64
                }
            }
            _ => 1e-90 * ((5 * k + 2 * i) as f64).cos(),
        };
        let lanes: [[Lanes; 3]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|i| Lanes::from(std::array::from_fn(|lane| at(lane, k, i))))
        });
        let together = singular(&lanes);
        for lane in 0..4 {
            let f: [[f64; 3]; 3] = std::array::from_fn(|k| std::array::from_fn(|i| at(lane, k, i)));
            let largest = f.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert_decomposes(&f, 3.0 * largest);
            let (mut alone, mut values) =
                (singular(&f).values, together.values.map(|s| s.lane(lane)));
            alone.sort_by(f64::total_cmp);
            values.sort_by(f64::total_cmp);
            for (a, b) in alone.iter().zip(values) {
                assert!((a - b).abs() < 1e-14 * largest, "{alone:?} {values:?}");
            }
        }
    }

    #[test]
    fn degenerate_matrices_have_frames_too() {
        assert_decomposes(&[[0.0; 3]; 3], 1.0);
        assert_decomposes(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], 1.0);
        assert_decomposes(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.5, 0.0, 1.0]], 10.0);
        assert_decomposes(&[[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [1e-160, 2e-160, 3e-160]], 1.0);
        assert_decomposes(&[[0.0; 3]; 2], 1.0);
        let inside_out = singular(&[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -0.5]]);
        assert_eq!(inside_out.values, [2.0, 1.0, -0.5]);
        assert_eq!(inside_out.rotation(), identity());
        assert!(singular(&[[f64::NAN, 0.0], [0.0, 1.0]]).values[0].is_nan());
    }
}
