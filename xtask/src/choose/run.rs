//! A rung that was run: what it cost, and what its observable did, or how it failed.
//!
//! ```text
//! work = max(steps, differentials + energies) + w Hessians
//! ```
//! `w` the work of a Hessian in differentials ([`Ladder::hessian_work`]). Work is counted and so
//! the same on every machine; the wall time stands beside it.

use std::fmt;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use stationary_integrators::{Cost, StepError};
use stationary_scene::{Observable, Run, RunError, Scene, StepFailure};

use super::ladder::{Ladder, Rung};

/// What an observable did in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The observable's numbers at each moment, the start first.
    pub values: Vec<Vec<f64>>,
    /// The energy at each moment.
    pub energies: Vec<f64>,
    /// The largest kinetic energy.
    pub kinetic: f64,
    /// The rods that broke, in the order of time.
    pub broken: Vec<usize>,
    /// What errors are relative to.
    pub scale: f64,
}

/// How a rung failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// Its numbers grew out of bounds.
    Unstable(String),
    /// An equation of a step was not solved.
    NotConverged(String),
    /// It ran to its end, but to another motion.
    WrongPhysics(String),
    /// The time was over.
    OutOfBudget,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Unstable(how) => write!(f, "unstable: {how}"),
            Failure::NotConverged(how) => write!(f, "not converged: {how}"),
            Failure::WrongPhysics(how) => write!(f, "wrong physics: {how}"),
            Failure::OutOfBudget => f.write_str("out of budget"),
        }
    }
}

/// A rung that was run.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Counted work.
    pub work: u64,
    /// Wall time of the run, once.
    pub wall: Duration,
    /// What happened.
    pub outcome: Result<Course, Failure>,
}

/// Steps between two looks at the clock.
const LOOK: u64 = 256;

/// Runs the scene as the rung says, until the deadline at most.
pub fn measure(ladder: &Ladder, rung: &Rung, deadline: Instant) -> Measured {
    let start = Instant::now();
    let scene = match Scene::parse(&ladder.name, &ladder.text(rung)) {
        Ok(scene) => scene,
        Err(error) => {
            let outcome = Err(Failure::NotConverged(first_line(&error.to_string())));
            return Measured { work: 0, wall: start.elapsed(), outcome };
        }
    };
    let run = scene.run_watched(|now| {
        let late = now.step % LOOK == 0 && Instant::now() >= deadline;
        if late { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let wall = start.elapsed();
    let work = |run: Option<&Run>| run.map_or(0, |run| work(run.cost(), ladder.hessian_work));
    match run {
        Ok(run) if run.cost().steps < scene.timing().steps() => {
            Measured { work: work(Some(&run)), wall, outcome: Err(Failure::OutOfBudget) }
        }
        Ok(run) => Measured { work: work(Some(&run)), wall, outcome: course(&run) },
        Err(error) => Measured { work: work(error.partial()), wall, outcome: Err(failure(&error)) },
    }
}

fn work(cost: Cost, hessian_work: u64) -> u64 {
    cost.steps.max(cost.differentials + cost.energies) + hessian_work * cost.hessians
}

fn course(run: &Run) -> Result<Course, Failure> {
    let samples = 0..run.times().len();
    let values: Vec<Vec<f64>> = samples.map(|sample| run.observed(sample).to_vec()).collect();
    let energies = run.energies();
    if !values.iter().flatten().chain(&energies).all(|x| x.is_finite()) {
        return Err(Failure::Unstable("the observable is not finite".to_owned()));
    }
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    let broken = run.broken().iter().map(|broken| broken.rod).collect();
    let scale = scale(run, &values, kinetic);
    Ok(Course { values, energies, kinetic, broken, scale })
}

/// What an observable's errors are relative to, in words and as a number: for energies the largest
/// kinetic energy, for momenta the sum of the parts' magnitudes, for a place the way from its
/// start, else the largest value. One where that is zero.
fn scale(run: &Run, values: &[Vec<f64>], kinetic: f64) -> f64 {
    let [linear, angular] = run.momentum_scales();
    let largest = values.iter().map(|x| norm(x)).fold(0.0, f64::max);
    let way = values.iter().map(|x| distance(x, &values[0])).fold(0.0, f64::max);
    let scale = match run.scene().observables().first() {
        Some(Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy) => {
            kinetic
        }
        Some(Observable::LinearMomentum) => linear,
        Some(Observable::AngularMomentum) => angular,
        Some(Observable::Position(_)) => way,
        _ => largest,
    };
    if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }
}

/// What errors of an observable are relative to, in words.
pub fn relative_to(observable: &Observable) -> &'static str {
    match observable {
        Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy => {
            "the largest kinetic energy"
        }
        Observable::LinearMomentum => "the sum of |p|",
        Observable::AngularMomentum => "the sum of |q| |p|",
        Observable::Position(_) => "the largest way from its start",
        _ => "its largest value",
    }
}

fn failure(error: &RunError) -> Failure {
    let said = first_line(&error.to_string());
    let source = match error {
        RunError::Interrupted(interruption) => Some(&interruption.source),
        RunError::Stopped(stop) => Some(&stop.source),
        RunError::Assembly(_) | RunError::Checkpoint(_) => None,
    };
    match source {
        Some(StepFailure::Step(
            StepError::NonFiniteConfiguration { .. } | StepError::NonFiniteMomentum { .. },
        )) => Failure::Unstable(said),
        _ => Failure::NotConverged(said),
    }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}

/// The Euclidean norm.
pub fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The Euclidean distance.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// The largest distance of two courses at a moment.
pub fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
}
