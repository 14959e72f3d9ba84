//! Methods for first-order systems: on fields of any size, with any controls, and what they save.

use stationary_integrators::{AdaptiveMethod, Moment, StepControl, Tolerance};

use super::fields::{AnyField, any_method, control, field, of_moment};
use super::{judge, length, number, numbers, positive};
use crate::{Draw, Verdict};

pub(super) fn adaptive(draw: &mut Draw) -> Verdict {
    let field = field(draw);
    let Ok(control) = control(draw, field.n) else { return Verdict::due() };
    let n = length(draw, field.n);
    let start = Moment::new(number(draw), numbers(draw, n));
    draw.note(format!("{} unknowns, mass {:?}, {control:?}, {start:?}", field.n, field.mass));
    match any_method(draw, &field, control, start) {
        Ok(mut method) => used(draw, &mut *method, field.n),
        Err(_) => Verdict::due(),
    }
}

/// Steps, looks between them and restarts, of any numbers.
pub(super) fn used(
    draw: &mut Draw,
    method: &mut dyn AdaptiveMethod<Vec<f64>>,
    unknowns: usize,
) -> Verdict {
    for _ in 0..4 {
        let verdict = match draw.below(4) {
            0 | 1 => {
                let end = method.moment().t + positive(draw);
                draw.note(format!("step to {end}"));
                let answer = method.step(end);
                judge("step", answer.map(|()| of_moment(method)))
            }
            2 => {
                let n = length(draw, unknowns);
                let t = match (draw.below(3), method.last_begin()) {
                    (0, _) => draw.any_f64(),
                    (_, Some(begin)) => begin + draw.unit() * (method.moment().t - begin),
                    _ => method.moment().t,
                };
                draw.note(format!("interpolate at {t}"));
                let mut y = vec![0.0; n];
                judge("interpolate", method.interpolate(t, &mut y).map(|()| y))
            }
            _ => {
                let n = length(draw, unknowns);
                let moment = Moment::new(number(draw), numbers(draw, n));
                draw.note(format!("restart from {moment:?}"));
                judge("restart", method.restart(&moment).map(|()| of_moment(method)))
            }
        };
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    Verdict::due()
}

/// Numbers that were saved, one of them changed.
pub(super) fn saved(draw: &mut Draw) -> Verdict {
    let field = AnyField { n: draw.between(1, 3), bad: None, mass: None };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let start = Moment::new(0.0, vec![1.0; field.n]);
    let control = control.most_steps(10_000).expect("a bound");
    match any_method(draw, &field, control, start) {
        Ok(mut method) => loaded(draw, &mut *method),
        Err(_) => Verdict::due(),
    }
}

/// A few steps; then what was saved is taken back with one number changed.
pub(super) fn loaded(draw: &mut Draw, method: &mut dyn AdaptiveMethod<Vec<f64>>) -> Verdict {
    for _ in 0..draw.below(6) {
        if method.step(10.0).is_err() {
            return Verdict::wrong("a smooth motion is not followed");
        }
    }
    let mut saved = method.save();
    if draw.chance(0.1) {
        saved.numbers.truncate(draw.below(saved.numbers.len()));
        draw.note("truncated");
        return match method.load(&saved) {
            Err(_) => Verdict::due(),
            Ok(()) => Verdict::wrong("load: too few numbers are accepted"),
        };
    }
    let slot = draw.below(saved.numbers.len());
    let value = draw.any_f64();
    draw.note(format!("{} of {} numbers is {value}", slot, saved.numbers.len()));
    saved.numbers[slot] = value;
    if method.load(&saved).is_err() {
        return Verdict::due();
    }
    if !value.is_finite() {
        return Verdict::wrong(format!("load: {value} is accepted"));
    }
    if method.save().numbers != saved.numbers {
        return Verdict::wrong(format!("load: {value} is accepted and read as another number"));
    }
    let end = method.moment().t + 1.0;
    judge("step after load", method.step(end).map(|()| of_moment(method)))
}

pub(super) fn controls(draw: &mut Draw) -> Verdict {
    let n = draw.below(4);
    judge("control", control(draw, n).map(|_| Vec::new()))
}
