//! Steps that the method chooses, read off at moments: what a run and a look of such methods have in
//! common.

use std::time::Instant;

use stationary_integrators::{AdaptiveError, AdaptiveMethod, ControlError, Cost, Work};

use crate::experiment::Record;
use crate::grid::Moments;
use crate::ladder::{MOMENTS, samples};
use crate::look::Look;
use crate::measured::{Failure, counted};
use crate::samples::Samples;
use crate::watch::Watch;

/// A method that stands at its start.
pub type Own<'m> = Box<dyn AdaptiveMethod<Vec<f64>> + 'm>;

/// Adds what is seen of a state at a time.
pub type See<'s> = &'s dyn Fn(&mut Samples, f64, &[f64]);

/// Steps between two looks at the clock.
const CLOCK: u64 = 256;

/// A run over `horizon`, where a Hessian counts as so many differentials. What is read off counts nothing.
pub fn run(
    mut method: Own<'_>,
    horizon: f64,
    hessian: u64,
    see: See<'_>,
    watch: &mut Watch<'_>,
) -> Record {
    let start = method.moment().clone();
    let each = samples(start.y.len()) as usize;
    let mut record = Record { each, is_smooth: true, ..Record::default() };
    see(&mut record.samples, start.t, &start.y);
    let mut spent = Cost::default();
    let followed = follow(&mut method, horizon, hessian, see, watch, (&mut record, &mut spent));
    record.work = counted(spent, hessian);
    record.failure = followed.err().as_ref().map(failure);
    record
}

fn follow(
    method: &mut Own<'_>,
    horizon: f64,
    hessian: u64,
    see: See<'_>,
    watch: &mut Watch<'_>,
    (record, spent): (&mut Record, &mut Cost),
) -> Result<(), AdaptiveError> {
    let start = method.moment().t;
    let end = start + horizon;
    let mut y = method.moment().y.clone();
    let each = record.each as u64;
    let all = MOMENTS * each;
    for sample in 1..=all {
        let to = if sample == all { end } else { start + horizon * sample as f64 / all as f64 };
        while method.moment().t < to {
            let before = *method.work();
            method.step(end)?;
            add(spent, &before, method.work());
            record.accepted.push(method.moment().t - start);
            if watch.stepped().is_break() {
                return Ok(());
            }
        }
        method.interpolate(to, &mut y)?;
        see(&mut record.samples, to, &y);
        if sample.is_multiple_of(each) {
            let observed = record.samples.observed(record.samples.len() - 1);
            if watch.moment(observed, counted(*spent, hessian)).is_break() {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Adds what a step took.
fn add(spent: &mut Cost, before: &Work, after: &Work) {
    spent.steps += after.steps - before.steps;
    spent.differentials += after.evaluations - before.evaluations;
    spent.hessians += after.factorizations - before.factorizations;
}

/// The same at moments.
pub fn look(
    mut method: Own<'_>,
    horizon: f64,
    hessian: u64,
    (see, moments, deadline): (See<'_>, &Moments, Instant),
) -> Option<Look> {
    let start = method.moment().clone();
    let end = start.t + horizon;
    let (mut samples, mut y, mut steps) = (Samples::default(), start.y.clone(), 0_u64);
    see(&mut samples, start.t, &start.y);
    let mut spent = Cost::default();
    for &t in &moments.times {
        let to = (start.t + t).min(end);
        while method.moment().t < to {
            let before = *method.work();
            method.step(end).ok()?;
            add(&mut spent, &before, method.work());
            steps += 1;
            if steps.is_multiple_of(CLOCK) && Instant::now() >= deadline {
                return None;
            }
        }
        method.interpolate(to, &mut y).ok()?;
        see(&mut samples, to, &y);
    }
    Some(Look::of(&samples, counted(spent, hessian)))
}

fn failure(error: &AdaptiveError) -> Failure {
    let said = error.to_string();
    let said = said.lines().next().unwrap_or_default().to_owned();
    match error {
        AdaptiveError::NonFinite { .. } => Failure::Unstable(said),
        _ => Failure::NotConverged(said),
    }
}

/// Why a method does not begin.
#[derive(Debug, thiserror::Error)]
pub enum NoStart {
    /// By its tolerance.
    #[error(transparent)]
    Tolerance(#[from] ControlError),
    /// By its start.
    #[error(transparent)]
    Start(#[from] AdaptiveError),
}

/// What is left of a run that did not begin.
pub fn refused(error: &NoStart) -> Record {
    Record { failure: Some(Failure::NotConverged(error.to_string())), ..Record::default() }
}
