//! A reference where there is no closed form: Stormer-Verlet, extrapolated to a step of zero.
//!
//! ```text
//! q(h) = q + c_2 h^2 + c_4 h^4 + ...       only even powers, since the method is symmetric
//! ```
//! Runs at h, h/2, h/4 and h/8 cancel the first three of them (Richardson; notes 4.5 for the order).
//! The reference's own error is the larger of two differences: from the second best extrapolation,
//! and from a run of another method, of order 8.

use std::ops::ControlFlow;
use std::sync::Arc;

use stationary_calculus::{Metric, Potential, Storage};
use stationary_integrators::problems::Problem;
use stationary_integrators::{Horizon, Method, Scheme, simulate};

use crate::study::StudyError;

/// Times at which a reference is known, equally spaced over the horizon, the start left out.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    /// How many.
    pub count: u64,
    /// Steps between two of them in the coarsest of the extrapolated runs.
    pub coarsest: u64,
}

/// Halvings of the coarsest step.
const HALVINGS: u32 = 3;

/// The method that the reference is compared with, at twice the coarsest step: its order is such that
/// finer steps would only add rounding.
const OTHER: Method = Method::Composition(Scheme::KahanLi8);

/// The problem with its true configuration known at samples.
///
/// # Errors
/// [`StudyError::Library`] where no such steps divide the horizon, or one of them fails.
pub fn with_reference<M: Metric, P: Potential, C: Storage + Send + Sync + 'static>(
    mut problem: Problem<M, P, C>,
    at: Samples,
) -> Result<Problem<M, P, C>, StudyError> {
    let mut columns = Vec::new();
    for halving in 0..=HALVINGS {
        columns.push(samples(&problem, Method::StormerVerlet, at.count, at.coarsest << halving)?);
    }
    let mut previous = columns[HALVINGS as usize].clone();
    for order in 1..=HALVINGS {
        let power = 4.0_f64.powi(order as i32);
        previous = columns[columns.len() - 1].clone();
        columns = columns
            .windows(2)
            .map(|pair| extrapolate(&pair[0], &pair[1], 1.0 / (power - 1.0)))
            .collect();
    }
    let best = columns.swap_remove(0);
    let other = samples(&problem, OTHER, at.count, at.coarsest.div_ceil(2))?;
    let off = largest_distance(&best, &previous).max(largest_distance(&best, &other));
    problem.solution_error = off / problem.scale;
    let every = problem.horizon / at.count as f64;
    let best = Arc::new(best);
    problem.solution = Box::new(move |time| {
        let index = (time / every).round();
        let sampled = (time / every - index).abs() < 1e-6 && index >= 1.0;
        if sampled { best.get(index as usize - 1).cloned() } else { None }
    });
    Ok(problem)
}

/// The configurations at the samples, with this many steps between two of them.
fn samples<M: Metric, P: Potential, C: Storage>(
    problem: &Problem<M, P, C>,
    method: Method,
    count: u64,
    between: u64,
) -> Result<Vec<C>, StudyError> {
    let stage = "the reference";
    let horizon =
        Horizon::divided(problem.horizon, count * between).map_err(StudyError::at(stage))?;
    let mut integrator = method.integrator(&problem.system).map_err(StudyError::at(stage))?;
    let mut state = problem.initial.clone();
    let mut samples = Vec::with_capacity(count as usize);
    simulate(&mut *integrator, &mut state, horizon, |now| {
        if now.step % between == 0 {
            samples.push(now.state.q.clone());
        }
        ControlFlow::Continue(())
    })
    .map_err(StudyError::at(stage))?;
    Ok(samples)
}

/// `fine + weight (fine - coarse)` at every sample.
fn extrapolate<C: Storage>(coarse: &[C], fine: &[C], weight: f64) -> Vec<C> {
    let sample = |(coarse, fine): (&C, &C)| {
        let mut best = fine.clone();
        let pairs = best.as_mut().iter_mut().zip(coarse.as_ref());
        pairs.for_each(|(fine, coarse)| *fine += weight * (*fine - coarse));
        best
    };
    coarse.iter().zip(fine).map(sample).collect()
}

fn largest_distance<C: Storage>(a: &[C], b: &[C]) -> f64 {
    let square = |(a, b): (&C, &C)| -> f64 {
        a.as_ref().iter().zip(b.as_ref()).map(|(a, b)| (a - b) * (a - b)).sum()
    };
    a.iter().zip(b).map(square).fold(0.0, f64::max).sqrt()
}
