//! References of exp, its differential and log, to the last digit of a double.
//!
//! ```text
//! exp     quaternion (cos(a/2), sin(a/2)/a theta), a = |theta|
//! T       sum_k (-1)^k [theta]^k / (k + 1)!           no closed form, 160 terms; its inverse by LU
//! dT v    the same series, differentiated term by term along delta
//! log     2 atan2(|x|, w)/|x| x of a quaternion (w, x) as stored
//! ```
//! Computed with 120 digits by Python's mpmath 1.3 from exactly these inputs, rounded once.
//! Matrices by rows; `v = (0.3, -1.1, 0.7)`, `delta = (-0.6, 0.2, 0.9)`; axes along (0.36, -0.48, 0.8).

mod exponentials;
mod logarithms;

pub use exponentials::{REFERENCES, Reference};
pub use logarithms::{LOGARITHMS, Logarithm};
