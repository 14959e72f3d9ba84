//! Whether stability, and not the error, bounds an explicit step.
//!
//! ```text
//! h |f' - f| > limit |y' - y|
//! ```
//! `y y'` two states (n) of nearly the same time, `f f'` the slopes there, `h` the step in seconds; `limit` h times the
//! stiffest rate at the border of the method's stability. Source: Hairer, Wanner, Solving Ordinary Differential
//! Equations II (1996), IV.2.

use stationary_calculus::Storage;

/// Whether the slopes change so much faster than the states.
pub(super) fn is_stiff<S: Storage>(h: f64, limit: f64, slopes: [&S; 2], states: [&S; 2]) -> bool {
    let square = |[a, b]: [&S; 2]| {
        let pairs = a.as_ref().iter().zip(b.as_ref());
        pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    };
    h * h * square(slopes) > limit * limit * square(states)
}
