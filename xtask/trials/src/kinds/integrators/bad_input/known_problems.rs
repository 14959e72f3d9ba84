//! The problems whose answers are known.

use stationary_calculus::{Metric, Potential};
use stationary_integrators::problems;

use super::{judge, positive};
use crate::{Draw, Verdict};

fn of_problem<M: Metric, P: Potential, C: AsRef<[f64]>>(
    draw: &mut Draw,
    problem: &problems::Problem<M, P, C>,
) -> Vec<f64> {
    let mut numbers = problem.initial.q.as_ref().to_vec();
    numbers.extend_from_slice(problem.initial.p.components());
    numbers.extend([problem.energy(&problem.initial), problem.horizon, problem.period]);
    let t = problem.horizon * draw.unit();
    if let Some(solution) = (problem.solution)(t) {
        numbers.extend_from_slice(solution.as_ref());
    }
    numbers
}

pub(super) fn known_problems(draw: &mut Draw) -> Verdict {
    let x = positive(draw);
    let count = draw.below(6);
    let which = draw.below(7);
    draw.note(format!("problem {which} at {x}, {count}"));
    let answer = match which {
        0 => problems::kepler(x).map(|problem| of_problem(draw, &problem)),
        1 => problems::oscillator(x).map(|problem| of_problem(draw, &problem)),
        2 => problems::pendulum(x).map(|problem| of_problem(draw, &problem)),
        3 => problems::spring_pendulum(x).map(|problem| of_problem(draw, &problem)),
        4 => problems::spring_chain(count, x).map(|problem| of_problem(draw, &problem)),
        5 => problems::fermi_pasta_ulam(x).map(|problem| of_problem(draw, &problem)),
        _ => problems::henon_heiles(x).map(|problem| of_problem(draw, &problem)),
    };
    judge("a problem", answer)
}
