//! A reference for the outer solar system: Stormer-Verlet, extrapolated to a step of zero.
//!
//! ```text
//! q(h) = q + c_2 h^2 + c_4 h^4 + ...       only even powers, since the method is symmetric
//! ```
//! Runs at h, h/2, h/4 and h/8 cancel the first three of them (Richardson; notes 4.5 for the order).
//! The difference between the two best extrapolations is the reference's own error.

use std::ops::ControlFlow;
use std::sync::Arc;

use stationary_integrators::{Horizon, Method, simulate};
use stationary_scene::SceneProblem;

use crate::study::StudyError;

/// Times at which the reference is known, equally spaced over the horizon, the start left out.
pub const SAMPLES: u64 = 500;

/// Steps between two samples of the coarsest run: a step of about three days.
const COARSEST: u64 = 128;

/// Halvings of the coarsest step.
const HALVINGS: u32 = 3;

/// The shipped scene, with the true configuration known at [`SAMPLES`] times.
pub fn with_reference() -> Result<SceneProblem<3>, StudyError> {
    let mut problem = stationary_scene::problems::outer_solar_system()
        .map_err(StudyError::at("the outer solar system"))?;
    let mut columns = Vec::new();
    for halving in 0..=HALVINGS {
        columns.push(samples(&problem, COARSEST << halving)?);
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
    let scale = problem.scale;
    problem.solution_error =
        best.iter().zip(&previous).map(|(a, b)| distance(a, b)).fold(0.0, f64::max) / scale;
    let every = problem.horizon / SAMPLES as f64;
    let best = Arc::new(best);
    problem.solution = Box::new(move |time| {
        let index = (time / every).round();
        let sampled = (time / every - index).abs() < 1e-6 && index >= 1.0;
        if sampled { best.get(index as usize - 1).cloned() } else { None }
    });
    Ok(problem)
}

/// The configurations at the samples, with this many steps between two of them.
fn samples(problem: &SceneProblem<3>, between: u64) -> Result<Vec<Vec<f64>>, StudyError> {
    let stage = "the reference";
    let horizon =
        Horizon::divided(problem.horizon, SAMPLES * between).map_err(StudyError::at(stage))?;
    let mut verlet =
        Method::StormerVerlet.integrator(&problem.system).map_err(StudyError::at(stage))?;
    let mut state = problem.initial.clone();
    let mut samples = Vec::with_capacity(SAMPLES as usize);
    simulate(&mut *verlet, &mut state, horizon, |now| {
        if now.step % between == 0 {
            samples.push(now.state.q.clone());
        }
        ControlFlow::Continue(())
    })
    .map_err(StudyError::at(stage))?;
    Ok(samples)
}

/// `fine + weight (fine - coarse)` at every sample.
fn extrapolate(coarse: &[Vec<f64>], fine: &[Vec<f64>], weight: f64) -> Vec<Vec<f64>> {
    let sample = |(coarse, fine): (&Vec<f64>, &Vec<f64>)| {
        coarse.iter().zip(fine).map(|(coarse, fine)| fine + weight * (fine - coarse)).collect()
    };
    coarse.iter().zip(fine).map(sample).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
