//! What adaptive steps meet beside tolerances: a first step that is too long, a stiff spring, singular positions.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::problems::Pendulum;
use stationary_constraints::{
    Adaptive, Dense, Linear, Rattle, Redundancy, Rod, Rods, SparseDiagonal, StepTolerance,
};
use stationary_integrators::problems::spring_pendulum;
use stationary_integrators::{State, UniformGravity};
use stationary_measure::loglog_slope;

use super::{End, run};
use crate::study::{Claim, StudyError};

const TOLERANCE: f64 = 1e-6;

/// A chart and claims.
pub struct Found {
    pub charts: Vec<Lines>,
    pub claims: Vec<Claim>,
}

/// All three.
pub fn obstacles(problem: &Pendulum) -> Result<Found, StudyError> {
    let (starts, start) = first_steps(problem)?;
    let (springs, spring) = stiff_springs()?;
    Ok(Found { charts: vec![starts, springs], claims: vec![start, spring, flat_positions()?] })
}

/// The error at the end of 20 s against the length of the first step that is tried.
fn first_steps(problem: &Pendulum) -> Result<(Lines, Claim), StudyError> {
    let at = StudyError::at("the method");
    let system = &problem.problem;
    let rattle =
        Rattle::new(&system.system, &system.rods, &system.initial, Dense::<1>(Redundancy::Refuse))
            .map_err(at)?;
    let mut points = Vec::new();
    for first in [1e-4, 1e-3, 1e-2, 0.1, 1.0, 20.0] {
        if let End::Done { error, .. } = run(problem, rattle.clone(), TOLERANCE, (first, 20.0))? {
            points.push((first, error));
        }
    }
    let least = points.iter().fold(f64::INFINITY, |least, point| least.min(point.1));
    let most = points.iter().fold(0.0, |most, point| f64::max(most, point.1));
    let spread = if points.len() == 6 { most / least } else { f64::INFINITY };
    let text = "largest over smallest error after 20 s, first steps from 0.1 ms to 20 s";
    let axes = (Axis::log("first step", "s"), Axis::log("error after 20 s", "m"));
    let chart = Lines::new("error against the first step that is tried", axes.0, axes.1)
        .with(Series::new("RATTLE, order 2", points));
    Ok((chart, Claim::number(text, "1 to 2", spread, (1.0, 2.0))))
}

/// Steps against the frequency of a spring along a line, over 2 s.
fn stiff_springs() -> Result<(Lines, Claim), StudyError> {
    let mut points = Vec::new();
    for stiffness in [1e2, 1e3, 1e4, 1e5, 1e6] {
        let system = spring_pendulum(stiffness).map_err(StudyError::at("the spring"))?.system;
        let line = Linear::new(vec![(vec![(0, 1.0)], 0.0)]).map_err(StudyError::at("the line"))?;
        let mut state = State::new([0.0, -1.1], Covector([0.0; 2]));
        let rattle = Rattle::new(&system, line, &state, Dense::<1>(Redundancy::Refuse))
            .map_err(StudyError::at("the method"))?;
        let tolerance = StepTolerance { absolute: TOLERANCE, relative: 0.0 };
        let mut method =
            Adaptive::new(rattle, tolerance, 0.1, &state).map_err(StudyError::at("a tolerance"))?;
        let mut steps = 0;
        while state.t < 2.0 {
            method.advance(&mut state, 2.0).map_err(StudyError::at("a step"))?;
            steps += 1;
        }
        points.push((stiffness.sqrt(), f64::from(steps)));
    }
    let slope = loglog_slope(&points).unwrap_or(f64::NAN);
    let axes = (Axis::log("frequency of the spring", "rad/s"), Axis::log("steps in 2 s", ""));
    let chart = Lines::new("steps against the frequency of a stiff spring", axes.0, axes.1)
        .with(Series::new("RATTLE, order 2", points));
    let text = "power of a spring's frequency with which steps grow";
    Ok((chart, Claim::number(text, "1", slope, (0.9, 1.1))))
}

/// How a parallelogram goes that turns through its flat positions for 20 s.
fn flat_positions() -> Result<Claim, StudyError> {
    let text = "a parallelogram that turns through flat positions for 20 s";
    let metric = DiagonalMetric::new([1.0, 1.0, 3.0, 3.0]).map_err(StudyError::at("masses"))?;
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![2.0, 0.5] };
    let system = System::new(metric, gravity).map_err(StudyError::at("the system"))?;
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([3, 1], 1.0), Rod::new([0, 1], 0.7)];
    let hooks = vec![[0.0, 0.0], [0.7, 0.0]];
    let rods = Rods::new(2, hooks, rods).map_err(StudyError::at("the rods"))?;
    let mut state = State::new([0.0, -1.0, 0.7, -1.0], Covector([3.0, 0.0, 9.0, 0.0]));
    let rattle = Rattle::new(&system, &rods, &state, SparseDiagonal(Redundancy::Refuse))
        .map_err(StudyError::at("the method"))?;
    let tolerance = StepTolerance { absolute: TOLERANCE, relative: 0.0 };
    let mut method =
        Adaptive::new(rattle, tolerance, 0.1, &state).map_err(StudyError::at("a tolerance"))?;
    let mut off = 0.0_f64;
    while state.t < 20.0 {
        method.advance(&mut state, 20.0).map_err(StudyError::at("a step"))?;
        let [x, y, other, height] = state.q;
        off = off.max((other - x - 0.7).abs()).max((height - y).abs());
    }
    let went = if off < 1e-6 { "stays on its branch" } else { "leaves its branch" };
    Ok(Claim::words(text, "stays on its branch", went))
}
