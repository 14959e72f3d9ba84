//! How far to go along a Newton step.
//!
//! ```text
//! x - t s,    t = 1, 1/2, 1/4, ...        s = df(x)^-1 f(x)
//! E(x - t s) <= E(x) - c t <f, s>         Armijo's condition, c = 1e-4
//! ```
//! `x` the unknowns (n), `s` the step (n), `f` the residual (n), `E` the equation's energy. A full step
//! that halves the residual is taken as it is. Else
//! the step is halved until Armijo's condition holds or, where there is no energy, until the residual
//! falls by the part c t. A step so small that it is nearly rounding is taken whole or not at all.

use super::{Iterate, NewtonReport};
use crate::{Equation, Storage};

/// Armijo's constant: the part of the predicted fall that a step must reach.
const SUFFICIENT: f64 = 1e-4;
/// Step lengths tried: down to 2^-30, below which progress could not be told from rounding.
const LENGTHS: usize = 31;
/// Energies that differ by this much, relatively, cannot be told apart.
const SAME_ENERGY: f64 = 16.0 * f64::EPSILON;

/// Where a search begins.
pub(super) struct Start<'a> {
    /// The iterate.
    pub(super) x: &'a [f64],
    /// The size of its residual.
    pub(super) size: f64,
    /// Whether the step is so small that a residual which no longer falls is rounding.
    pub(super) nearly: bool,
}

/// Leaves an acceptable next iterate in `iterate.trial`, its residual in `iterate.residual`, and
/// returns the residual's size. Where there is none, `iterate.residual` is that of a rejected trial.
#[inline(always)]
pub(super) fn search<C: Storage>(
    equation: &mut impl Equation,
    Start { x, size, nearly }: Start<'_>,
    iterate: &mut Iterate<C>,
    report: &mut NewtonReport,
) -> Option<f64> {
    // The energy changes at this rate along the step, if f is its differential.
    let slope = -dot(iterate.residual.as_ref(), iterate.step.as_ref());
    // A residual up to this size is taken as it is. One comparison, not two of which rounding
    // decides: among noise no processor predicts those.
    let small = if nearly { size } else { 0.5 * size };
    let mut start_energy = None;
    let lengths = std::iter::successors(Some(1.0), |t| Some(0.5 * t));
    for t in lengths.take(if nearly { 1 } else { LENGTHS }) {
        let ends = iterate.trial.as_mut().iter_mut().zip(x).zip(iterate.step.as_ref());
        for ((trial, x), step) in ends {
            *trial = x - t * step;
        }
        equation.residual(iterate.trial.as_ref(), iterate.residual.as_mut());
        report.residuals += 1;
        let new_size = equation.norm(iterate.residual.as_ref());
        if !new_size.is_finite() {
            continue;
        }
        if new_size <= small {
            return Some(new_size);
        }
        if start_energy.is_none() && slope < 0.0 {
            start_energy = equation.energy(x);
            report.energies += u32::from(start_energy.is_some());
        }
        let less = new_size <= (1.0 - SUFFICIENT * t) * size;
        let enough = match start_energy {
            Some(start) => {
                report.energies += 1;
                equation.energy(iterate.trial.as_ref()).is_some_and(|energy| {
                    energy <= start + SUFFICIENT * t * slope
                        || (less && energy <= start + SAME_ENERGY * start.abs())
                })
            }
            None => less,
        };
        if enough {
            return Some(new_size);
        }
    }
    None
}

#[inline]
fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
