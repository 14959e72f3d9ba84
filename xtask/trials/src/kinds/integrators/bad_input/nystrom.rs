//! The Nystrom pairs.

use std::ops::ControlFlow;

use stationary_calculus::Covector;
use stationary_integrators::{Nystrom12, State};

use super::fields::control;
use super::{judge, length, number, of_state, planet, state};
use crate::{Draw, Verdict};

pub(super) fn nystrom(draw: &mut Draw) -> Verdict {
    let system = planet();
    let Ok(control) = control(draw, 2) else { return Verdict::due() };
    let mut now = state(draw, 2);
    let end = number(draw) + 1.0;
    draw.note(format!("{now:?} to {end}, {control:?}"));
    let Ok(mut nystrom) = Nystrom12::new(&system, control) else { return Verdict::due() };
    let n = length(draw, 2);
    let mut within = State::new(vec![0.0; n], Covector(vec![0.0; n]));
    let part = if draw.chance(0.3) { draw.any_f64() } else { draw.unit() };
    let mut inside = Verdict::due();
    let answer = nystrom.run(&mut now, end, |mut step| {
        let t = step.before.t + part * (step.after.t - step.before.t);
        inside = judge("at", step.at(t, &mut within).map(|()| of_state(&within)));
        match inside {
            Verdict::Wrong { .. } => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    inside.and(judge("run", answer.map(|_| of_state(&now))))
}
