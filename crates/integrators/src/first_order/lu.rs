//! Elimination with row exchanges for a full matrix, real or complex.
//!
//! ```text
//! P A = L U
//! ```
//! `A` n x n by columns, factored in place; `P` a permutation of the rows. The memory is taken
//! once.

use std::ops::{Add, Mul, Sub};

use nalgebra::Complex;

/// A number that can be eliminated with.
pub(crate) trait Entry:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    const ZERO: Self;

    /// A size, equal to the absolute value up to a factor of sqrt 2.
    fn size(self) -> f64;

    fn reciprocal(self) -> Self;
}

impl Entry for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn size(self) -> f64 {
        self.abs()
    }

    #[inline]
    fn reciprocal(self) -> Self {
        1.0 / self
    }
}

impl Entry for Complex<f64> {
    const ZERO: Self = Complex { re: 0.0, im: 0.0 };

    #[inline]
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }

    #[inline]
    fn reciprocal(self) -> Self {
        let square = self.re * self.re + self.im * self.im;
        Complex { re: self.re / square, im: -self.im / square }
    }
}

/// A pivot that is zero or not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Singular;

/// A matrix, or its factors once [`Lu::factor`] was called.
#[derive(Clone, Debug)]
pub(crate) struct Lu<T> {
    n: usize,
    entries: Vec<T>,
    exchanges: Vec<usize>,
    pivots: Vec<T>,
}

impl<T: Entry> Lu<T> {
    pub(crate) fn new(n: usize) -> Self {
        Lu { n, entries: vec![T::ZERO; n * n], exchanges: vec![0; n], pivots: vec![T::ZERO; n] }
    }

    /// The matrix by columns, to be written before it is factored.
    pub(crate) fn matrix(&mut self) -> &mut [T] {
        &mut self.entries
    }

    pub(crate) fn factor(&mut self) -> Result<(), Singular> {
        let n = self.n;
        for j in 0..n {
            let (done, rest) = self.entries.split_at_mut(n * (j + 1));
            let column = &mut done[n * j..];
            let mut k = j;
            for i in j + 1..n {
                if column[i].size() > column[k].size() {
                    k = i;
                }
            }
            let size = column[k].size();
            if !(size > 0.0 && size.is_finite()) {
                return Err(Singular);
            }
            column.swap(j, k);
            self.exchanges[j] = k;
            self.pivots[j] = column[j].reciprocal();
            for entry in &mut column[j + 1..] {
                *entry = *entry * self.pivots[j];
            }
            for other in rest.chunks_exact_mut(n.max(1)) {
                other.swap(j, k);
                let top = other[j];
                for (entry, factor) in other[j + 1..].iter_mut().zip(&column[j + 1..]) {
                    *entry = *entry - *factor * top;
                }
            }
        }
        // Rows of the columns to the left are exchanged last: nobody read them meanwhile.
        for j in 1..n {
            let k = self.exchanges[j];
            for column in self.entries.chunks_exact_mut(n.max(1)).take(j) {
                column.swap(j, k);
            }
        }
        Ok(())
    }

    pub(crate) fn solve(&self, b: &mut [T]) {
        let n = self.n;
        for (j, &k) in self.exchanges.iter().enumerate() {
            b.swap(j, k);
        }
        for (j, column) in self.entries.chunks_exact(n.max(1)).enumerate() {
            let known = b[j];
            for (b, entry) in b[j + 1..].iter_mut().zip(&column[j + 1..]) {
                *b = *b - *entry * known;
            }
        }
        for (j, column) in self.entries.chunks_exact(n.max(1)).enumerate().rev() {
            let known = b[j] * self.pivots[j];
            b[j] = known;
            for (b, entry) in b[..j].iter_mut().zip(column) {
                *b = *b - *entry * known;
            }
        }
    }
}

impl Lu<f64> {
    /// Whether the determinant of the factored matrix is negative.
    pub(crate) fn is_negative(&self) -> bool {
        let exchanged = self.exchanges.iter().enumerate().filter(|&(j, &k)| j != k).count();
        let negative = self.pivots.iter().filter(|pivot| **pivot < 0.0).count();
        (exchanged + negative) % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use stationary_measure::SplitMix64;

    use super::*;

    #[test]
    fn the_solution_solves_the_system_real_and_complex() {
        let mut random = SplitMix64::new(4);
        for n in [1, 2, 3, 8, 40] {
            let (mut real, mut complex) = (Lu::new(n), Lu::new(n));
            let exact: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut b = vec![0.0; n];
            let mut c = vec![Complex::new(0.0, 0.0); n];
            for (j, &x) in exact.iter().enumerate() {
                for i in 0..n {
                    let a = Complex::new(random.symmetric(), random.symmetric());
                    real.matrix()[i + n * j] = a.re;
                    complex.matrix()[i + n * j] = a;
                    b[i] += a.re * x;
                    c[i] += a * Complex::new(x, -2.0 * x);
                }
            }
            real.factor().unwrap();
            complex.factor().unwrap();
            real.solve(&mut b);
            complex.solve(&mut c);
            for i in 0..n {
                assert!((b[i] - exact[i]).abs() < 1e-10, "{n}: {}", b[i] - exact[i]);
                assert!((c[i] - Complex::new(exact[i], -2.0 * exact[i])).size() < 1e-10, "{n}");
            }
        }
    }

    #[test]
    fn the_sign_of_the_determinant_counts_exchanges_and_pivots() {
        let mut lu = Lu::new(2);
        for (matrix, negative) in [
            ([1.0, 2.0, 3.0, 7.0], false),
            ([1.0, 2.0, 3.0, 5.0], true),
            ([0.0, 1.0, 1.0, 0.0], true),
            ([0.0, 1.0, -1.0, 0.0], false),
        ] {
            lu.matrix().copy_from_slice(&matrix);
            lu.factor().unwrap();
            assert_eq!(lu.is_negative(), negative, "{matrix:?}");
        }
    }

    #[test]
    fn a_singular_matrix_and_one_that_is_not_finite_are_refused() {
        let mut lu = Lu::new(2);
        lu.matrix().copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(lu.factor(), Err(Singular));
        lu.matrix().copy_from_slice(&[1.0, f64::NAN, 2.0, 4.0]);
        assert_eq!(lu.factor().and_then(|()| lu.factor()), Err(Singular));
    }
}
