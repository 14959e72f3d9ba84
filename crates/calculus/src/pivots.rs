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

/// Whether a matrix is singular to rounding by its own factor: `x` is the answer to a unit load at
/// freedom `j`, whose energy `<x, A x> = x_j` is no more than rounding makes of its terms,
///
/// ```text
/// x_j <= 16 eps sum of a_ii x_i^2
/// ```
pub(crate) fn is_rounding(j: usize, x: &[f64], diagonal: impl Fn(usize) -> f64) -> bool {
    let answer = x[j];
    let term = |(i, x): (usize, &f64)| diagonal(i) * answer * (x / answer) * (x / answer);
    let terms: f64 = x.iter().enumerate().map(term).sum();
    let is_regular = ROUNDINGS * f64::EPSILON * terms < 1.0;
    !is_regular
}
