//! A choice that keeps to the tolerance, but by less than what may lie between two moments: it is looked at
//! again at 34 moments of each step, which leave little between them.
//!
//! Into every step: where a step errs the most at a few moments, another may err more between them.

use crate::ladder::At;
use crate::look::apart;
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::told;
use crate::way::Way;

/// How much larger an error may be between two of so many moments.
pub const CLOSELY_BETWEEN: f64 = 1.005;

/// The largest error, in the observable's unit, seen closely: at fewer moments it is `error`. Nothing where
/// steps are too many for it.
pub fn largest(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    (error, allowed): (f64, f64),
) -> Option<f64> {
    let way = Way::closely(runs, at)?;
    let (grid, within) = way.grids.first()?;
    let own = runs.look(at, grid, *within)?;
    let (truth, off) = told(runs, reference, (grid, *within), allowed, MeasuredRuns::read)?;
    Some(error.max(apart(&own.values, &truth.values)) + off)
}
