//! A stiff problem for every stiff solver.

use std::cell::Cell;
use std::ops::ControlFlow;

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use stationary_integrators::problems::{StiffProblem, VanDerPolField};
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, RadauIia5, Tolerance, VectorField, integrate,
};

use crate::contest::{Contestant, Outcome};

/// Van der Pol's oscillator.
pub type Oscillator = StiffProblem<VanDerPolField, 2>;

/// The absolute tolerance of each component, in proportion to its size.
fn absolute(problem: &Oscillator, tolerance: f64) -> [f64; 2] {
    problem.scale.map(|scale| scale * tolerance)
}

/// Runs one of ours to the end.
fn finish<A: AdaptiveMethod<[f64; 2]>>(mut method: A, end: f64) -> Option<Outcome> {
    integrate(&mut method, end, |_| ControlFlow::Continue(())).ok()?;
    let end = method.moment().y.to_vec();
    Some(Outcome { end, evaluations: method.work().evaluations })
}

fn radau(problem: &Oscillator) -> Contestant<'_> {
    let run = |tolerance: f64| {
        let absolute = absolute(problem, tolerance).to_vec();
        let tolerance = Tolerance::componentwise(tolerance, absolute).ok()?;
        let start = problem.initial.clone();
        finish(RadauIia5::new(problem.field, tolerance.into(), start).ok()?, problem.end)
    };
    Contestant { name: "our radau", ours: true, run: Box::new(run) }
}

fn backward_differences(problem: &Oscillator) -> Contestant<'_> {
    let run = |tolerance: f64| {
        let absolute = absolute(problem, tolerance).to_vec();
        let tolerance = Tolerance::componentwise(tolerance, absolute).ok()?;
        let start = problem.initial.clone();
        finish(BackwardDifferences::new(problem.field, tolerance.into(), start).ok()?, problem.end)
    };
    Contestant { name: "our bdf", ours: true, run: Box::new(run) }
}

/// `diffsol`'s BDF with the product of the Jacobian and a vector in closed form.
fn their_bdf(problem: &Oscillator) -> Contestant<'_> {
    let run = |tolerance: f64| {
        let (evaluations, mu) = (Cell::new(0), problem.field.mu);
        let stated = OdeBuilder::<NalgebraMat<f64>>::new()
            .rtol(tolerance)
            .atol(absolute(problem, tolerance))
            .rhs_implicit(
                |y: &[f64], _p: &[f64], t: f64, dy: &mut [f64]| {
                    evaluations.set(evaluations.get() + 1);
                    problem.field.evaluate(t, y, dy);
                },
                |y: &[f64], _p: &[f64], _t: f64, v: &[f64], jv: &mut [f64]| {
                    let by_x = -2.0 * mu * y[0] * y[1] - 1.0;
                    jv[0] = v[1];
                    jv[1] = by_x * v[0] + mu * (1.0 - y[0] * y[0]) * v[1];
                },
            )
            .init(|_p: &[f64], _t: f64, y: &mut [f64]| y.copy_from_slice(&problem.initial.y), 2)
            .build()
            .ok()?;
        let mut solver = stated.bdf::<NalgebraLU<f64>>().ok()?;
        solver.set_stop_time(problem.end).ok()?;
        while solver.state().t < problem.end {
            solver.step().ok()?;
        }
        let end = solver.state().y.batch_as_slice(0).to_vec();
        Some(Outcome { end, evaluations: evaluations.get() })
    };
    Contestant { name: "diffsol bdf", ours: false, run: Box::new(run) }
}

/// Every stiff solver, ours first.
pub fn contestants(problem: &Oscillator) -> [Contestant<'_>; 3] {
    [radau(problem), backward_differences(problem), their_bdf(problem)]
}
