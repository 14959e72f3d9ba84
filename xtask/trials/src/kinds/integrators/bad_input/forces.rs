//! Forces, loads and Newmark's weights.

use stationary_calculus::Covector;
use stationary_integrators::{
    AdaptiveMethod, Drag, Integrator, MechanicalField, Moment, Newmark, NewmarkWeights, RadauIia5,
    Stability, State, StepControl, Tolerance, bump,
};

use super::fields::of_moment;
use super::{judge, length, number, numbers, of_state, planet, positive, state};
use crate::{Draw, Verdict};

pub(super) fn forces(draw: &mut Draw) -> Verdict {
    let system = planet();
    let coefficients: Vec<f64> = (0..length(draw, 2)).map(|_| positive(draw)).collect();
    let (start, width) = (number(draw), positive(draw));
    let t = start + draw.unit() * width;
    draw.note(format!("drag {coefficients:?}, bump from {start} for {width} at {t}"));
    let bumped = judge("bump", bump(start, width).map(|strength| vec![strength(t)]));
    let Ok(drag) = Drag::new(coefficients) else { return bumped };
    let weights = NewmarkWeights::generalized_alpha(0.5).expect("a radius");
    let Ok(mut newmark) = Newmark::<_, _, Vec<f64>, _>::with_force(&system, weights, &drag) else {
        return bumped;
    };
    let mut now = state(draw, 2);
    let answer = newmark.step(&mut now, 0.1);
    let stepped = judge(
        "a step with drag",
        answer.map(|_| now.q.iter().chain(now.p.components()).copied().collect()),
    );
    let Ok(field) = MechanicalField::forced(&system, &drag) else { return bumped.and(stepped) };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let y = numbers(draw, 4);
    let answer =
        RadauIia5::new(&field, control.most_steps(500).expect("a bound"), Moment::new(0.0, y));
    let answer = answer.and_then(|mut radau| {
        radau.step(1.0)?;
        Ok(of_moment(&radau))
    });
    bumped.and(stepped).and(judge("radau with drag", answer))
}

pub(super) fn weights(draw: &mut Draw) -> Verdict {
    let weights = match draw.chance(0.5) {
        true => NewmarkWeights::newmark(positive(draw), draw.uniform(0.4, 1.1)),
        false => NewmarkWeights::generalized_alpha(positive(draw)),
    };
    draw.note(format!("{weights:?}"));
    let Ok(weights) = weights else { return Verdict::due() };
    let system = planet();
    let mut now = State::new(vec![1.0, 0.0], Covector(vec![0.0, 1.0]));
    let answer = Newmark::<_, _, Vec<f64>>::new(&system, weights).expect("one size");
    let mut newmark = answer;
    let answer = newmark.step(&mut now, 0.1);
    let facts = newmark.facts();
    if let Stability::Below(limit) = facts.stability
        && (limit.is_nan() || limit <= 0.0)
    {
        return Verdict::wrong(format!("weights: stable below {limit}"));
    }
    judge("weights", answer.map(|_| of_state(&now)))
}
