//! Where a choice is looked at over its whole way: at the end of each step, and within those that matter.
//!
//! ```text
//! e_n   the error at the end of step n, known from the run itself
//! b_n = max(|e_n-1|, |e_n|) + |e_n - e_n-1|           what an error within the step is likely below
//! ```
//! A part of a step errs by no more than the whole one, but for its constant. So first the steps of the
//! largest `b_n` are looked into, and as many others, spread evenly; the largest error in one of them over
//! its `b_n` foretells those of the rest. Before that, all steps are read off from polynomials through their
//! ends, which costs nothing. Where these do not resolve the motion, or the tolerance does not hold by both,
//! every step is looked into.

use std::sync::Arc;

use crate::grid::{Grid, Within};
use crate::ladder::{At, Kind, MOMENTS};
use crate::look::{Look, apart};
use crate::measured::{Course, distance};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::told;

/// Where a choice is looked at.
pub struct Way {
    /// One look after the other.
    pub grids: Vec<(Grid, Within)>,
    /// What the errors at the ends of steps foretell, where not every step is looked into.
    foretold: Option<Foretold>,
}

struct Foretold {
    /// Of each part of the horizon, in the observable's unit.
    bounds: Vec<f64>,
    looked: Vec<bool>,
    /// The least bound that is taken for one.
    least: f64,
    /// What is known between the ends of all steps.
    between: Between,
}

/// What polynomials through the ends of steps tell of what lies between them.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Between {
    /// The largest error at three moments of every step, and how far these may be off.
    Resolved(f64),
    /// Nothing: a period has few steps. Nothing happens at once either, so that one step errs as its like.
    Unresolved,
}

/// One of so many parts is looked into, and so many at least; half of them where errors are the largest.
const ONE_OF: usize = 16;
const ONE_OF_UNRESOLVED: usize = 8;
const AT_LEAST: usize = 12;
/// So few do where all errors are below that part of the tolerance; and all that are above this one.
const FEW: usize = 6;
const FAR: f64 = 0.1;
const LARGE: f64 = 0.7;
/// One of so many steps is looked into closely at first where a run is another motion, or where something may
/// happen at once; and so many at least.
pub const ONE_OF_ANOTHER: usize = 4;
pub const ONE_OF_JUMPING: usize = 16;
const LEAST_CLOSELY: usize = 4;
/// Steps of a run that can be looked into closely.
const CLOSELY: u64 = 640;
/// How much larger an error may be than those of other steps foretell.
const MARGIN: f64 = 1.25;
/// What polynomials may be off by, in what may be lost by reading a reference off.
const UNRESOLVED: f64 = 5.0;
/// The part of the tolerance below which an error is nothing.
const NOTHING: f64 = 0.01;
/// The parts of the horizon in which modes are looked at, as steps are.
const OF_MODES: u32 = 4;

impl Grid {
    /// A grid that looks into every step of a run.
    pub fn of(runs: &MeasuredRuns<'_>, at: At) -> Grid {
        match runs.family(at.family).kind {
            Kind::EqualSteps => Grid::Equal { halvings: at.rung as u32 },
            Kind::Adaptive => Grid::Accepted(at),
            Kind::Modes => Grid::Equal { halvings: OF_MODES },
        }
    }
}

impl Way {
    /// Into every step.
    pub fn all(runs: &MeasuredRuns<'_>, at: At) -> Self {
        Way { grids: vec![(Grid::of(runs, at), Within::Parts)], foretold: None }
    }

    /// Into every step of a run of some hundreds, at many moments of each: what is another motion may be
    /// wrong for a small part of a step.
    pub fn closely(runs: &MeasuredRuns<'_>, at: At) -> Option<Self> {
        let Grid::Equal { halvings } = Grid::of(runs, at) else { return None };
        let grids = vec![(Grid::Closely { halvings }, Within::Parts)];
        (MOMENTS << halvings <= CLOSELY).then_some(Way { grids, foretold: None })
    }

    /// Into some steps of a run of equal ones, one of so many, at many moments of each: half of them those where
    /// the error may be the largest by a look into all, `max |e(t)| + max |e(t) - e_n-1|`, the others spread evenly.
    pub fn some_closely(
        runs: &mut MeasuredRuns<'_>,
        at: At,
        (own, truth): (&Look, &Look),
        one_of: usize,
    ) -> Option<Self> {
        let all = Way::all(runs, at);
        let Grid::Equal { halvings } = Grid::of(runs, at) else { return None };
        let (horizon, parts) = (runs.ladder().horizon, (MOMENTS << halvings) as usize);
        let errors: Vec<Vec<f64>> = own.values.iter().zip(&truth.values).map(off).collect();
        let (mut largest, mut grown) = (vec![0.0_f64; parts], vec![0.0_f64; parts]);
        let mut before = (0, &errors[0]);
        for (k, t) in all.times(runs).iter().enumerate() {
            let part = ((t / horizon * parts as f64 - 1e-6) as usize).min(parts - 1);
            if part != before.0 {
                before = (part, &errors[k]);
            }
            largest[part] = largest[part].max(size(&errors[k + 1]));
            grown[part] = grown[part].max(distance(&errors[k + 1], before.1));
        }
        let bounds: Vec<f64> = largest.iter().zip(&grown).map(|(e, growth)| e + growth).collect();
        let looked = looked(&bounds, (parts / one_of).max(LEAST_CLOSELY));
        let steps = (0..parts as u64).filter(|&part| looked[part as usize]).collect();
        let grid = Grid::SomeClosely { halvings, parts: steps };
        Some(Way { grids: vec![(grid, Within::Parts)], foretold: None })
    }

    /// Into some steps; nothing where what is between the ends of the others is not known, or known to be
    /// too far off, or these are few.
    pub fn some(
        runs: &mut MeasuredRuns<'_>,
        reference: &Reference,
        at: At,
        (least, allowed): (f64, f64),
    ) -> Option<Self> {
        let Grid::Equal { halvings } = Grid::of(runs, at) else { return None };
        // A line errs by how the truth bends, of which the errors at its ends tell nothing.
        if runs.is_joined(at) {
            return None;
        }
        let most = least / NOTHING;
        let between = between(runs, reference, at, allowed).filter(|between| match between {
            Between::Resolved(largest) => *largest <= most,
            Between::Unresolved => runs.ladder().is_smooth,
        })?;
        let track = runs.seen(at)?.track.clone()?;
        // Of very many steps not every one was sampled.
        let sampled = (0..=halvings).rev().find(|&halvings| track.has(MOMENTS << halvings))?;
        let parts = (MOMENTS << sampled) as usize;
        let ends = (Grid::Equal { halvings: sampled }, Within::Ends);
        let (own, _) = runs.read(at, (&ends.0, ends.1), 0.0)?;
        let (truth, _) = told(runs, reference, (&ends.0, ends.1), least, MeasuredRuns::read)?;
        let errors: Vec<Vec<f64>> = own.values.iter().zip(&truth.values).map(off).collect();
        let sizes: Vec<f64> = errors.iter().map(|error| size(error)).collect();
        let bounds: Vec<f64> = (0..parts)
            .map(|part| {
                let largest = sizes[part].max(sizes[part + 1]);
                largest + distance(&errors[part], &errors[part + 1])
            })
            .collect();
        // What is far below the tolerance needs few witnesses.
        let at_least = if bounds.iter().all(|&bound| bound < FAR * most) { FEW } else { AT_LEAST };
        let large = bounds.iter().filter(|&&bound| bound > LARGE * most).count();
        let count = match between {
            Between::Resolved(_) => at_least.max(parts / ONE_OF).max(2 * large),
            Between::Unresolved => at_least.max(parts / ONE_OF_UNRESOLVED),
        };
        if 2 * count > 3 * parts / 2 {
            return None;
        }
        let looked = looked(&bounds, count);
        let each = 1_u64 << (halvings - sampled);
        let chosen = (0..parts as u64).filter(|&part| looked[part as usize]);
        let steps: Arc<[u64]> = chosen.flat_map(|part| part * each..(part + 1) * each).collect();
        let within = (Grid::Some { halvings, parts: steps }, Within::Parts);
        let foretold = Some(Foretold { bounds, looked, least, between });
        Some(Way { grids: vec![ends, within], foretold })
    }

    /// Whether every step is looked into.
    pub fn is_all(&self) -> bool {
        self.foretold.is_none()
    }

    /// The moments of all its grids, one after the other.
    pub fn times(&self, runs: &mut MeasuredRuns<'_>) -> Vec<f64> {
        let times = self.grids.iter().filter_map(|(grid, within)| runs.moments(grid, *within));
        times.flat_map(|moments| moments.times.clone()).collect()
    }

    /// The largest error that steps may have which were not looked into, by those that were.
    pub fn foretold(&self, runs: &mut MeasuredRuns<'_>, own: &Look, truth: &Look) -> f64 {
        let Some(known) = &self.foretold else { return 0.0 };
        let horizon = runs.ladder().horizon;
        let parts = known.bounds.len();
        let times = self.times(runs);
        let rows = own.values.iter().zip(&truth.values).skip(1);
        let ratio = times.iter().zip(rows).map(|(t, (own, truth))| {
            let part = ((t / horizon * parts as f64 - 1e-6) as usize).min(parts - 1);
            distance(own, truth) / known.bounds[part].max(known.least)
        });
        // Errors that swing as fast as there are steps have bounds far above them.
        let least = match known.between {
            Between::Resolved(_) => 1.0,
            Between::Unresolved => 0.0,
        };
        let ratio = ratio.fold(least, f64::max);
        let rest = known.bounds.iter().zip(&known.looked).filter(|(_, looked)| !**looked);
        MARGIN * ratio * rest.map(|(bound, _)| bound.max(known.least)).fold(0.0, f64::max)
    }

    /// The largest error between the ends of steps, where not every one is looked into and polynomials tell
    /// it.
    pub fn between(&self) -> f64 {
        match self.foretold.as_ref().map(|known| known.between) {
            Some(Between::Resolved(most)) => most,
            _ => 0.0,
        }
    }

    /// How often its equal parts are halved twentieths of the horizon; none of other steps.
    pub fn halvings(&self) -> u32 {
        match self.grids.first() {
            Some((grid, _)) => match grid {
                Grid::Equal { halvings }
                | Grid::Closely { halvings }
                | Grid::Some { halvings, .. }
                | Grid::SomeClosely { halvings, .. } => *halvings,
                Grid::Accepted(_) => 0,
            },
            None => 0,
        }
    }

    /// Steps that are looked into, where not all are.
    pub fn steps(&self) -> Option<usize> {
        self.grids.iter().find_map(|(grid, _)| match grid {
            Grid::Some { parts, .. } => Some(parts.len()),
            _ => None,
        })
    }
}

/// What polynomials through the ends of a run's steps tell of its error between them; nothing where those of the
/// reference do not.
fn between(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    allowed: f64,
) -> Option<Between> {
    let grid = Grid::of(runs, at);
    let moments = runs.moments(&grid, Within::Parts)?;
    let own = runs.seen(at)?.track.as_ref()?.read(&moments.times);
    let read = MeasuredRuns::read_off;
    let Some((truth, off)) = told(runs, reference, (&grid, Within::Parts), allowed, read) else {
        return Some(Between::Unresolved);
    };
    let largest = apart(&own.look.values, &truth.values) + own.off + off;
    let resolves = own.off <= UNRESOLVED * allowed;
    Some(if resolves { Between::Resolved(largest) } else { Between::Unresolved })
}

/// What is no error, in the observable's unit.
pub fn nothing(course: &Course, tolerance: f64) -> f64 {
    NOTHING * tolerance * course.scale
}

fn off((own, truth): (&Vec<f64>, &Vec<f64>)) -> Vec<f64> {
    own.iter().zip(truth).map(|(x, y)| x - y).collect()
}

fn size(error: &[f64]) -> f64 {
    crate::measured::norm(error)
}

/// Which parts are looked into: half by their bounds, the others evenly.
fn looked(bounds: &[f64], count: usize) -> Vec<bool> {
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|&a, &b| bounds[b].total_cmp(&bounds[a]));
    let mut looked = vec![false; bounds.len()];
    order.iter().take(count / 2).for_each(|&part| looked[part] = true);
    let rest: Vec<usize> = (0..bounds.len()).filter(|&part| !looked[part]).collect();
    let others = count - count / 2;
    (0..others).for_each(|k| looked[rest[(2 * k + 1) * rest.len() / (2 * others)]] = true);
    looked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_steps_that_are_looked_into_are_those_of_the_largest_errors() {
        let bounds: Vec<f64> = (0..160).map(|k| f64::from((k * 37) % 160)).collect();
        let looked = looked(&bounds, 12);
        assert_eq!(looked.iter().filter(|looked| **looked).count(), 12);
        assert!((0..160).all(|k| bounds[k] < 154.0 || looked[k]));
        // No quarter of the way is left out.
        assert!(looked.chunks(40).all(|part| part.contains(&true)));
    }
}
