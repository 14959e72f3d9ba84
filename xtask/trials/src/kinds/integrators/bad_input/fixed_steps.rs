//! Steps of equal and of reversible length, with impulses between them.

use std::ops::ControlFlow;

use stationary_calculus::Covector;
use stationary_integrators::{
    Horizon, Impulse, Method, Observation, PotentialPower, ReversibleSteps, State, StormerVerlet,
    simulate, simulate_with_impulses,
};

use super::{judge, length, numbers, of_state, planet, positive, state};
use crate::{Draw, Verdict};

pub(super) fn fixed_step(draw: &mut Draw) -> Verdict {
    let method = draw.one_of(Method::ALL);
    let (mut now, h) = (state(draw, 2), positive(draw));
    draw.note(format!("{method}, {now:?}, step {h}"));
    let system = planet();
    let mut stepper = match method.integrator::<_, _, Vec<f64>>(&system) {
        Ok(stepper) => stepper,
        Err(error) => return Verdict::wrong(format!("a right size is refused: {error}")),
    };
    let before = format!("{now:?}");
    let answer = stepper.step(&mut now, h);
    if answer.is_err() && format!("{now:?}") != before {
        return Verdict::wrong("an error changed the state");
    }
    let numbers = || now.q.iter().chain(now.p.components()).copied().chain([now.t]).collect();
    judge("step", answer.map(|_| numbers()))
}

pub(super) fn horizons(draw: &mut Draw) -> Verdict {
    let duration = positive(draw);
    let horizon = match draw.chance(0.5) {
        true => Horizon::divided(duration, draw.below(20) as u64),
        false => {
            let step = if draw.chance(0.5) { duration / 4.0 } else { positive(draw) };
            Horizon::new(duration, step)
        }
    };
    let start = if draw.chance(0.3) { draw.any_f64() } else { 0.0 };
    let done = draw.below(5) as u64;
    draw.note(format!("{horizon:?} starting at {start}, resumed at {done}"));
    let Ok(horizon) = horizon else { return Verdict::due() };
    let Ok(horizon) = horizon.resumed(done) else { return Verdict::due() };
    let horizon = horizon.starting(start);
    if horizon.steps() > 1000 {
        return judge("a horizon", Ok::<_, ()>(vec![horizon.step()]));
    }
    let system = planet();
    let mut verlet = StormerVerlet::new(&system).expect("one size");
    let mut now = State::new(vec![1.0, 0.0], Covector(vec![0.0, 1.0]));
    let answer = simulate(&mut verlet, &mut now, horizon, |_| ControlFlow::Continue(()));
    judge("simulate", answer.map(|_| of_state(&now)))
}

pub(super) fn impulses(draw: &mut Draw) -> Verdict {
    let system = planet();
    let mut verlet = StormerVerlet::new(&system).expect("one size");
    let mut now = state(draw, 2);
    let impulses: Vec<Impulse<Vec<f64>>> = (0..draw.below(4))
        .map(|_| {
            let n = length(draw, 2);
            Impulse { time: positive(draw), momentum: Covector(numbers(draw, n)) }
        })
        .collect();
    draw.note(format!("{now:?}, {impulses:?}"));
    let horizon = Horizon::new(1.0, 0.1).expect("ten steps");
    let observe = |_: Observation<'_, _>| ControlFlow::Continue(());
    let answer = simulate_with_impulses(&mut verlet, &mut now, horizon, &impulses, observe);
    judge("impulses", answer.map(|_| of_state(&now)))
}

pub(super) fn reversible(draw: &mut Draw) -> Verdict {
    let system = planet();
    let verlet = StormerVerlet::new(&system).expect("one size");
    let (power, scale) = (positive(draw), positive(draw));
    let density = PotentialPower { potential: *system.potential(), power, scale };
    let mut now = state(draw, 2);
    draw.note(format!("density {power} {scale}, {now:?}"));
    let Ok(mut steps) = ReversibleSteps::new(&system, verlet, density) else {
        return Verdict::due();
    };
    for _ in 0..3 {
        let answer = steps.advance(&mut now);
        let verdict = judge("advance", answer.map(|_| of_state(&now)));
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    Verdict::due()
}
