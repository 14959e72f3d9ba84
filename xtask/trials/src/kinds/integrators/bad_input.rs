//! Every public function with bad numbers, wrong sizes and empty input: it may refuse, but neither
//! panic nor hide a number that is not finite behind an Ok. Each file is a family of functions.

mod empty;
mod fields;
mod filters;
mod first_order;
mod fixed_steps;
mod forces;
mod known_problems;
mod lagrangians;
mod momenta;
mod nystrom;
mod outputs;

use std::fmt::Debug;

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_integrators::{CentralGravity, State};

use crate::{Draw, Verdict};

/// Draws one of the functions.
pub fn trial(draw: &mut Draw) -> Verdict {
    let functions: [fn(&mut Draw) -> Verdict; 16] = [
        fixed_steps::fixed_step,
        fixed_steps::horizons,
        first_order::adaptive,
        first_order::saved,
        empty::empty,
        nystrom::nystrom,
        outputs::outputs_and_events,
        fixed_steps::impulses,
        forces::forces,
        forces::weights,
        known_problems::known_problems,
        lagrangians::lagrangians,
        fixed_steps::reversible,
        filters::split,
        momenta::momenta,
        first_order::controls,
    ];
    let function = draw.below(functions.len());
    draw.note(format!("function {function}"));
    functions[function](draw)
}

/// Mostly harmless, sometimes anything.
fn number(draw: &mut Draw) -> f64 {
    if draw.chance(0.3) { draw.any_f64() } else { draw.symmetric() }
}

fn positive(draw: &mut Draw) -> f64 {
    if draw.chance(0.4) { draw.any_f64() } else { draw.log_uniform(1e-2, 10.0) }
}

fn numbers(draw: &mut Draw, n: usize) -> Vec<f64> {
    (0..n).map(|_| number(draw)).collect()
}

/// The right length, mostly.
fn length(draw: &mut Draw, n: usize) -> usize {
    if draw.chance(0.2) { draw.below(n + 3) } else { n }
}

fn are_finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> bool {
    numbers.into_iter().all(|x| x.is_finite())
}

/// An error is right; an answer must be finite.
fn judge<E: Debug>(what: &str, answer: Result<Vec<f64>, E>) -> Verdict {
    match answer {
        Ok(answer) if !are_finite(&answer) => Verdict::wrong(format!("{what}: Ok with {answer:?}")),
        _ => Verdict::due(),
    }
}

fn of_state(state: &State<Vec<f64>>) -> Vec<f64> {
    let numbers = state.q.iter().chain(state.p.components());
    numbers.copied().chain([state.t]).collect()
}

type Planet = System<DiagonalMetric<[f64; 2]>, CentralGravity<2>>;

fn planet() -> Planet {
    let metric = DiagonalMetric::new([1.0; 2]).expect("masses");
    System::new(metric, CentralGravity { strength: 1.0 }).expect("one size")
}

fn state(draw: &mut Draw, n: usize) -> State<Vec<f64>> {
    let [q, p] = [length(draw, n), length(draw, n)].map(|n| numbers(draw, n));
    let mut state = State::new(q, Covector(p));
    state.t = number(draw);
    state
}
