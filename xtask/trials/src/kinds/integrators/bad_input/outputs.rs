//! Output times and events.

use std::ops::ControlFlow;

use stationary_integrators::{
    Direction, Event, Moment, OutputTimes, StepControl, Tolerance, integrate, integrate_to_event,
};

use super::fields::{AnyField, any_method, of_moment};
use super::{judge, length, number, positive};
use crate::{Draw, Verdict};

pub(super) fn outputs_and_events(draw: &mut Draw) -> Verdict {
    let n = draw.below(4);
    let times: Vec<f64> = (0..draw.below(4)).map(|_| positive(draw)).collect();
    let field = AnyField { n: 2, bad: None, mass: None };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let control = control.most_steps(10_000).expect("a bound");
    let start = Moment::new(0.0, vec![1.0, 0.0]);
    let mut method = any_method(draw, &field, control, start.clone());
    let Ok(method) = &mut method else { return Verdict::due() };
    draw.note(format!("times {times:?} of {n} numbers"));
    if draw.chance(0.5) {
        let Ok(mut output) = OutputTimes::new(n, &times) else { return Verdict::due() };
        let (mut seen, mut fault) = (Vec::new(), Ok(()));
        let answer = integrate(&mut **method, 2.0, |mut step| {
            fault = output.within(&mut step, |t, y| {
                seen.push(t);
                seen.extend_from_slice(y);
            });
            if fault.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        return judge("output", answer.and(fault).map(|()| seen));
    }
    let (level, value) = (number(draw), draw.any_f64());
    let direction = draw.one_of(&[Direction::Rising, Direction::Falling, Direction::Any]);
    let points = draw.below(4) as u32;
    let like = Moment::new(0.0, vec![0.0; length(draw, 2)]);
    let late = draw.chance(0.3);
    let mut event =
        Event::new(
            direction,
            &like,
            move |t, y: &[f64]| {
                if late && t > 0.5 { value } else { y[0] - level }
            },
        )
        .looking_at(points);
    let end = positive(draw);
    draw.note(format!("event at {level}, later {value}: {late}, until {end}, {}", like.y.len()));
    let answer = integrate_to_event(&mut **method, end, &mut event, |_| ());
    judge("event", answer.map(|()| of_moment(&**method)))
}
