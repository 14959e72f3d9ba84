//! Which pivots of an elimination are zero but for rounding.

/// A pivot this small relative to its diagonal entry is what rounding leaves of zero after n
/// eliminations: n units of rounding, as in LAPACK's `dpstrf`, and a few more where n is small.
pub(crate) fn zero_pivot(n: usize) -> f64 {
    (n + 16) as f64 * f64::EPSILON
}

/// A pivot of less than this part of its diagonal entry may be what rounding leaves of zero, where the
/// elimination before it has magnified rounding.
pub(crate) const SUSPICIOUS: f64 = 1e-8;

/// Units of rounding of each entry `sqrt(a_ii a_kk)` that a factorization may leave: exactly singular
/// matrices of whole numbers stay below one, regular ones of condition 1e13 above a thousand.
const ROUNDINGS: f64 = 16.0;

/// The load on freedom `k` that shows whether its suspicious pivot is rounding. Of no two freedoms the
/// same, so that those of a null vector do not cancel.
pub(crate) fn load(k: usize, diagonal: f64) -> f64 {
    (1.0 + (0.618_033_988_749_895 * k as f64).fract()) * diagonal.sqrt()
}

/// Whether a matrix is singular to rounding by its own factor: `x` is the answer to a load `b` on all
/// suspicious freedoms, whose energy `<x, A x> = <b, x>` is no more than rounding makes of its terms,
///
/// ```text
/// <b, x> <= 16 eps sum of a_ii x_i^2
/// ```
pub(crate) fn is_rounding(
    x: &[f64],
    load: impl Fn(usize) -> f64,
    diagonal: impl Fn(usize) -> f64,
) -> bool {
    let energy: f64 = x.iter().enumerate().map(|(i, x)| load(i) * x).sum();
    let terms: f64 = x.iter().enumerate().map(|(i, x)| diagonal(i) * x * x).sum();
    let is_regular = ROUNDINGS * f64::EPSILON * terms < energy;
    !is_regular
}
