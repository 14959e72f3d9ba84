//! Systems of no freedoms.

use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_integrators::{
    AdaptiveError, Method, Moment, Nystrom8, State, StepControl, Tolerance, integrate,
};

use super::fields::{AnyField, any_method, of_moment};
use super::{judge, of_state};
use crate::{Draw, Verdict};

/// A system without freedoms: time passes, or the error says why it cannot.
pub(super) fn empty(draw: &mut Draw) -> Verdict {
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let which = draw.below(3 + Method::ALL.len());
    draw.note(format!("an empty system, method {which}"));
    if which < 2 {
        let field = AnyField { n: 0, bad: None, mass: draw.chance(0.5).then(Vec::new) };
        let start = Moment::new(0.0, Vec::new());
        let answer = any_method(draw, &field, control, start).and_then(|mut method| {
            integrate(&mut *method, 1.0, |_| ControlFlow::Continue(()))?;
            Ok(of_moment(&*method))
        });
        return match answer {
            Err(error @ AdaptiveError::StepTooSmall { .. }) => {
                Verdict::wrong(format!("nothing at all is a singularity: {error}"))
            }
            answer => judge("an empty system", answer),
        };
    }
    let metric = DiagonalMetric::new(Vec::new());
    let Ok(metric) = metric else { return Verdict::due() };
    let system = System::new(metric, Nothing).expect("one size");
    let mut now = State::new(Vec::new(), Covector(Vec::new()));
    if which == 2 {
        let answer = Nystrom8::new(&system, control).map_err(AdaptiveError::from);
        let answer = answer
            .and_then(|mut nystrom| nystrom.run(&mut now, 1.0, |_| ControlFlow::Continue(())));
        return match answer {
            Err(error @ AdaptiveError::StepTooSmall { .. }) => {
                Verdict::wrong(format!("nothing at all is a singularity: {error}"))
            }
            answer => judge("an empty system", answer.map(|_| of_state(&now))),
        };
    }
    let stepper = Method::ALL[which - 3].integrator::<_, _, Vec<f64>>(&system);
    let Ok(mut stepper) = stepper else { return Verdict::due() };
    judge("an empty system", stepper.step(&mut now, 0.1).map(|_| of_state(&now)))
}

struct Nothing;

impl Potential for Nothing {
    fn dim(&self) -> usize {
        0
    }

    fn energy(&self, _q: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _q: &[f64], _dv: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}
