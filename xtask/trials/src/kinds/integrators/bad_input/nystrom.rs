//! The Nystrom pairs.

use std::ops::ControlFlow;

use stationary_calculus::Covector;
use stationary_integrators::{
    AdaptiveError, Moment, Nystrom12, NystromMethod8, NystromMethod12, State, StepControl,
    Tolerance,
};

use super::fields::{Boxed, control};
use super::first_order::{loaded, used};
use super::{Planet, judge, length, number, numbers, of_state, planet, state};
use crate::{Draw, Verdict};

fn any_pair<'s>(
    draw: &mut Draw,
    system: &'s Planet,
    control: StepControl,
    start: Moment<Vec<f64>>,
) -> Result<Boxed<'s>, AdaptiveError> {
    Ok(match draw.chance(0.5) {
        true => Box::new(NystromMethod8::new(system, control, start)?),
        false => Box::new(NystromMethod12::new(system, control, start)?),
    })
}

/// A pair as an adaptive method: from any moment, or from what it has saved.
fn as_method(draw: &mut Draw) -> Verdict {
    let system = planet();
    if draw.chance(0.5) {
        let tolerance = Tolerance::new(1e-6, 1e-6).expect("a tolerance");
        let start = Moment::new(0.0, vec![1.0, 0.0, 0.0, 1.0]);
        return match any_pair(draw, &system, tolerance.into(), start) {
            Ok(mut pair) => loaded(draw, &mut *pair),
            Err(error) => Verdict::wrong(format!("a planet is refused: {error}")),
        };
    }
    let Ok(control) = control(draw, 4) else { return Verdict::due() };
    let n = length(draw, 4);
    let start = Moment::new(number(draw), numbers(draw, n));
    draw.note(format!("{control:?}, {start:?}"));
    match any_pair(draw, &system, control, start) {
        Ok(mut pair) => used(draw, &mut *pair, 4),
        Err(_) => Verdict::due(),
    }
}

pub(super) fn nystrom(draw: &mut Draw) -> Verdict {
    if draw.chance(0.5) {
        return as_method(draw);
    }
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
