//! A choice that keeps to the tolerance, but by less than what may lie between two moments: it is looked at
//! again at 34 moments of each step, which leave little between them.
//!
//! Into every step: where a step errs the most at a few moments, another may err more between them. So may a step in
//! which something happens at once, as an error has teeth there, one where each stage comes to what happens: some of
//! those steps in which it may be the largest are looked into as closely.

use crate::grid::Within;
use crate::ladder::At;
use crate::look::{Look, apart};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::told;
use crate::way::{ONE_OF_JUMPING, Way};

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
    largest_on(runs, reference, (at, &way), (error, allowed))
}

/// The same, where something may happen at once in a step of equal length, by a look into all steps.
pub fn largest_where_it_jumps(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (at, own, truth): (At, &Look, &Look),
    (error, allowed): (f64, f64),
) -> Option<f64> {
    let way = Way::some_closely(runs, at, (own, truth), ONE_OF_JUMPING)?;
    largest_on(runs, reference, (at, &way), (error, allowed))
}

fn largest_on(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (at, way): (At, &Way),
    (error, allowed): (f64, f64),
) -> Option<f64> {
    let (grid, _) = way.grids.first()?;
    let own = runs.look(at, grid, Within::Parts)?;
    let of = (grid, Within::Parts);
    let (truth, off) = told(runs, reference, of, allowed, MeasuredRuns::read)?;
    Some(error.max(apart(&own.values, &truth.values)) + off)
}
