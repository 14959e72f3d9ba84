//! Equations that Newton's method solves: what each of them knows of itself.
//!
//! ```text
//! f(x) = 0,    df(x) delta = -f(x),    optionally f = dE
//! ```
//! `x` the unknowns (n), `f` the residual (n), `df` its differential (n x n) or what the equation takes
//! for it, `E` an energy. The equation measures its residuals and solves its linearization; whoever
//! searches for its root knows nothing of matrices, and the equation nothing of steps and tolerances.

use crate::SizeError;

/// An equation f(x) = 0 in n unknowns that can be linearized.
pub trait Equation {
    /// Writes f(x).
    fn residual(&mut self, x: &[f64], f: &mut [f64]);

    /// Replaces `f` by `df(x)^-1 f`.
    ///
    /// # Errors
    /// Where there is no solution that can be trusted.
    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable>;

    /// The size of a residual, in the units of the tolerance.
    fn norm(&mut self, f: &[f64]) -> f64;

    /// The energy whose differential is f, where there is one.
    fn energy(&mut self, x: &[f64]) -> Option<f64>;

    /// The number of unknowns n, where the equation knows it.
    #[inline]
    fn unknowns(&self) -> Option<usize> {
        None
    }
}

/// The linearized equation has no solution that can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// A pivot vanished.
    #[error("the linearized equation is singular to working precision")]
    Singular,
    /// The linearization overflowed, or was evaluated outside its domain.
    #[error("the linearized equation has numbers that are not finite")]
    NonFinite,
    /// A Hessian or Jacobian must visit the same blocks in the same order as when it was analysed.
    #[error("block {block} of the linearization is not where it was when its pattern was analysed")]
    PatternChanged {
        /// The first block that differs, counted from 0.
        block: usize,
    },
    /// The factorization was finished, but what it gives does not solve the equation.
    #[error("the linearized equation was solved with a relative residual of {relative_residual:e}")]
    Untrusted {
        /// The best residual that refinement reached, relative to the right-hand side.
        relative_residual: f64,
    },
    /// An iteration met a direction in which the matrix is not positive.
    #[error(
        "after {iterations} iterations the linearized equation has a direction in which it is not positive"
    )]
    NotPositive {
        /// Iterations until then.
        iterations: usize,
    },
    /// An iteration was ended by its bound.
    #[error(
        "{iterations} iterations left the linearized equation a relative residual of {relative_residual:e}"
    )]
    NotConverged {
        /// The bound.
        iterations: usize,
        /// The residual relative to the right-hand side.
        relative_residual: f64,
    },
    /// A solver was made for another number of freedoms.
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// The Euclidean length, not a number if any component is none. Squares that leave the range of
/// numbers do not: the components are then measured by the largest of them.
#[inline]
pub(crate) fn length(x: &[f64]) -> f64 {
    let squares = x.iter().map(|x| x * x).sum::<f64>();
    if SQUARES.contains(&squares) || squares.is_nan() {
        return squares.sqrt();
    }
    scaled_length(x)
}

/// Sums of squares in this range have lost nothing.
pub(crate) const SQUARES: std::ops::Range<f64> = 1e-280..1e300;

/// The power of two below a number that is very large or very small; else 1.
pub(crate) fn power_of_two(x: f64) -> f64 {
    if (1e-100..1e100).contains(&x) || !(x > 0.0 && x < f64::INFINITY) {
        return 1.0;
    }
    2.0_f64.powi(x.log2().floor().max(-1022.0) as i32)
}

/// Solves for a right side that is divided by a power of two where it is large, as what is met on the way may be larger
/// than both it and the solution. NaN where a component of the solution is too large for a number, or is none.
#[inline]
pub(crate) fn solve_in_range(b: &mut [f64], solve: impl FnOnce(&mut [f64])) {
    let load = power_of_two(b.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()))).max(1.0);
    if load > 1.0 {
        b.iter_mut().for_each(|x| *x /= load);
    }
    solve(b);
    if load > 1.0 {
        b.iter_mut().for_each(|x| *x *= load);
    }
    nan_where_not_finite(b);
}

/// Makes all of a vector NaN that is not finite.
#[inline]
pub(crate) fn nan_where_not_finite(x: &mut [f64]) {
    // Zero times a number that is not finite is NaN.
    if x.iter().map(|x| 0.0 * x).sum::<f64>().is_nan() {
        x.fill(f64::NAN);
    }
}

#[cold]
fn scaled_length(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    largest * x.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_right_side_is_solved_in_range_or_all_of_the_solution_is_nan() {
        // By way of 1e10 b.
        let solve = |by: f64| move |b: &mut [f64]| b.iter_mut().for_each(|b| *b = *b * 1e10 * by);
        let mut b = [1e300, -3.0];
        solve_in_range(&mut b, solve(1e-10));
        assert!((b[0] / 1e300 - 1.0).abs() < 1e-15 && (b[1] + 3.0).abs() < 1e-14, "{b:?}");
        solve_in_range(&mut b, solve(1.0));
        assert!(b.iter().all(|b| b.is_nan()), "{b:?}");
    }

    #[test]
    fn a_length_is_right_at_every_scale() {
        for scale in [5e-324, 1e-310, 1e-200, 1e-150, 1.0, 1e150, 1e200, 1e307] {
            let [three, four] = [3.0 * scale, 4.0 * scale];
            let error = (length(&[three, -four]) / scale - 5.0).abs();
            assert!(error <= 1e-15, "{scale}: {error}");
        }
        assert_eq!(length(&[]), 0.0);
        assert_eq!(length(&[0.0; 3]), 0.0);
        assert_eq!(length(&[1.0, f64::INFINITY]), f64::INFINITY);
        assert!(length(&[f64::NAN, f64::INFINITY]).is_nan());
        assert!(length(&[1e-300, f64::NAN]).is_nan());
    }
}
