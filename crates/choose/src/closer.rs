//! A choice that keeps to the tolerance, but by less than what may lie between two moments: it is looked at
//! again where it errs the most.
//!
//! ```text
//! steps in which    1.05 max |x - x*|  >=  the largest of all        at 34 moments of each
//! ```
//! So many moments leave little between them. Where this is so in many steps, it is not worth it.

use std::sync::Arc;

use crate::grid::{Grid, Within};
use crate::ladder::{At, MOMENTS};
use crate::look::{Look, apart};
use crate::measured::distance;
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::{BETWEEN, told};
use crate::way::Way;

/// How much larger an error may be between two of so many moments.
pub const CLOSELY_BETWEEN: f64 = 1.005;
/// Steps that are looked into again: so many, and one of so many, at most.
const MOST: usize = 8;
const ONE_OF: usize = 4;
/// How near a moment must be to the end of a step to be that, in steps.
const AT_END: f64 = 1e-6;

/// The largest error, in the observable's unit, seen closely: at moments of a way it is `error`. Nothing where
/// too many steps err as much.
pub fn largest(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (at, way): (At, &Way),
    (own, truth): (&Look, &Look),
    (error, allowed): (f64, f64),
) -> Option<f64> {
    let Grid::Equal { halvings } = Grid::of(runs, at) else { return None };
    let count = (MOMENTS << halvings) as usize;
    let spacing = runs.ladder().horizon / count as f64;
    let mut steps = Vec::new();
    let rows = own.values.iter().zip(&truth.values).skip(1);
    for (t, (own, truth)) in way.times(runs).iter().zip(rows) {
        if BETWEEN * distance(own, truth) >= error {
            // The end of one step is the start of the next.
            let place = t / spacing;
            steps.push((place - AT_END) as usize);
            steps.push((place + AT_END) as usize);
        }
    }
    steps.retain(|&step| step < count);
    steps.sort_unstable();
    steps.dedup();
    if steps.len() > MOST.min(count / ONE_OF) {
        return None;
    }
    let parts: Arc<[u64]> = steps.into_iter().map(|step| step as u64).collect();
    let grid = Grid::SomeClosely { halvings, parts };
    let own = runs.look(at, &grid, Within::Parts)?;
    let (truth, off) = told(runs, reference, (&grid, Within::Parts), allowed, MeasuredRuns::read)?;
    Some(error.max(apart(&own.values, &truth.values)) + off)
}
