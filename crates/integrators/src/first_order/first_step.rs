//! The step to begin with, guessed from f at two points.
//!
//! ```text
//! h (max(|f|, |f'|))^(1/k) ~ 0.01^(1/k)        in the norm of the tolerance
//! ```
//! `f` is y', with a mass matrix not the field's; `f'` by a difference along an explicit Euler step that is short
//! enough to be harmless, `k` the order. A guess only: the error of the first step decides. It is long enough for the
//! clock to resolve, whatever the unit of time.
//! Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.4.

use stationary_calculus::Storage;

use super::error_scale::{ErrorScale, norm};
use super::{Moment, VectorField};

/// A first step is at least this part of the time at which it begins.
pub(crate) const CLOCK: f64 = 1e-12;

/// A step for a method of order `k`, with one evaluation of f beside the known `rate` y'. What `solve` makes of f
/// is y': f itself where there is no mass matrix.
pub(crate) fn guess_step<F: VectorField, C: Storage>(
    field: &F,
    scale: &ErrorScale<C>,
    moment: &Moment<C>,
    (rate, solve): (&C, impl Fn(&mut [f64])),
    k: u32,
    [s, difference, moved]: [&mut C; 3],
) -> f64 {
    let (t, y, f, s) = (moment.t, moment.y.as_ref(), rate.as_ref(), s.as_mut());
    scale.write(y, s);
    let (size, slope) = (norm(y, s), norm(f, s));
    let short = if size < 1e-5 || slope < 1e-5 { 1e-6 } else { 0.01 * size / slope };
    for ((moved, y), f) in moved.as_mut().iter_mut().zip(y).zip(f) {
        *moved = y + short * f;
    }
    let difference = difference.as_mut();
    field.evaluate(t + short, moved.as_ref(), difference);
    solve(difference);
    for (difference, f) in difference.iter_mut().zip(f) {
        *difference -= f;
    }
    let steepest = slope.max(norm(difference, s) / short);
    let longer = if steepest <= 1e-15 {
        (1e-3 * short).max(1e-6)
    } else {
        (0.01 / steepest).powf(1.0 / f64::from(k))
    };
    // Where f is not finite nearby, the control of errors finds a step or says that there is none.
    let guess = if longer > 0.0 { longer.min(100.0 * short) } else { short };
    guess.max(CLOCK * t.abs())
}
