//! Events and output at given times, on the dense output of every method.

use std::ops::ControlFlow;

use stationary_integrators::problems::kepler;
use stationary_integrators::{
    AdaptiveError, Direction, Event, FunctionField, MechanicalField, Moment, OutputTimes,
    integrate, integrate_to_event,
};

use crate::first_order_methods::{all, control};

#[test]
fn an_event_is_located_to_rounding_and_ends_the_run_there() {
    // A stone thrown up: y'' = -9.81, height 0 again after 2 v / g, highest at v / g.
    let stone = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], -9.81]);
    });
    let start = Moment::new(0.0, [0.0, 5.0]);
    for mut method in all(&stone, &control(1e-10), &start) {
        let name = method.facts().name;
        let mut lands = Event::new(Direction::Falling, &start, |_t, y: &[f64]| y[0]);
        let mut seen = 0.0;
        let observe = |step: stationary_integrators::AcceptedStep<'_, _, _>| seen = step.to();
        integrate_to_event(&mut *method, 10.0, &mut lands, observe).unwrap();
        let landed = method.moment();
        assert!((landed.t - 10.0 / 9.81).abs() < 1e-9, "{name}: {}", landed.t);
        assert!(landed.y[0].abs() < 1e-9 && (landed.y[1] + 5.0).abs() < 1e-8, "{name}");
        assert_eq!(seen, landed.t);
    }
}

#[test]
fn events_within_a_run_are_counted_and_have_a_direction() {
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], -y[0]]);
    });
    let start = Moment::new(0.0, [1.0, 0.0]);
    for mut method in all(&field, &control(1e-9), &start) {
        let name = method.facts().name;
        let mut times: [Vec<f64>; 3] = Default::default();
        let directions = [Direction::Rising, Direction::Falling, Direction::Any];
        let function = |_t: f64, y: &[f64]| y[0];
        let mut events = directions.map(|d| Event::new(d, &start, function).looking_at(3));
        integrate(&mut *method, 10.0, |mut step| {
            for (event, times) in events.iter_mut().zip(&mut times) {
                if event.crossing(&mut step).unwrap() {
                    times.push(event.moment().t);
                }
            }
            ControlFlow::Continue(())
        })
        .unwrap();
        let half_pi = std::f64::consts::FRAC_PI_2;
        for (times, expected) in times.iter().zip([&[3.0][..], &[1.0, 5.0], &[1.0, 3.0, 5.0]]) {
            assert_eq!(times.len(), expected.len(), "{name}: {times:?}");
            for (time, quarter) in times.iter().zip(expected) {
                assert!((time - quarter * half_pi).abs() < 1e-6, "{name}: {times:?}");
            }
        }
    }
}

#[test]
fn every_crossing_of_a_step_is_found_in_turn() {
    // Steps over which the function turns several times: x = t, and crossings of a half at known times.
    let field = FunctionField::new(1, |_t, _y: &[f64], f: &mut [f64]| f[0] = 1.0);
    let start = Moment::new(0.0, [0.0]);
    let wave = |_t: f64, y: &[f64]| (std::f64::consts::TAU * y[0]).sin() - 0.5;
    for mut method in all(&field, &control(1e-6), &start) {
        let name = method.facts().name;
        let mut event = Event::new(Direction::Any, &start, wave).looking_at(400);
        let (mut times, mut longest) = (Vec::new(), 0.0_f64);
        integrate(&mut *method, 10.0, |mut step| {
            longest = longest.max(step.to() - step.from());
            while event.crossing(&mut step).unwrap() {
                times.push(event.moment().t);
            }
            assert!(!event.crossing(&mut step).unwrap());
            ControlFlow::Continue(())
        })
        .unwrap();
        assert!(longest > 1.0, "{name}: {longest}");
        let expected = (0..20).map(|k| f64::from(k / 2) + [1.0, 5.0][k as usize % 2] / 12.0);
        let expected: Vec<f64> = expected.collect();
        assert_eq!(times.len(), 20, "{name}: {times:?}");
        let off = times.iter().zip(&expected).map(|(t, e)| (t - e).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{name}: {off:e}");
    }
}

#[test]
fn an_event_that_never_comes_is_an_error() {
    let field = FunctionField::new(1, |_t, y: &[f64], f: &mut [f64]| f[0] = -y[0]);
    let start = Moment::new(0.0, [1.0]);
    for mut method in all(&field, &control(1e-8), &start) {
        let mut below = Event::new(Direction::Any, &start, |_t, y: &[f64]| y[0] + 0.1);
        let error = integrate_to_event(&mut *method, 2.0, &mut below, |_| {}).unwrap_err();
        let AdaptiveError::NoEvent { first, last, end } = error else { panic!("{error}") };
        assert_eq!((first, end), (1.1, 2.0));
        assert!((last - 0.1 - (-2.0_f64).exp()).abs() < 1e-6);
        let mut nan = Event::new(Direction::Any, &start, |_t, _y: &[f64]| f64::NAN);
        let error = integrate_to_event(&mut *method, 3.0, &mut nan, |_| {}).unwrap_err();
        assert!(matches!(error, AdaptiveError::EventValue { .. }), "{error}");
    }
}

#[test]
fn output_at_given_times_costs_no_steps() {
    let planet = kepler(0.5).unwrap();
    let field = MechanicalField::new(&planet.system);
    let [q, p] = [planet.initial.q, planet.initial.p.0];
    let start = Moment::new(0.0, [q[0], q[1], p[0], p[1]]);
    let times: Vec<f64> = (0..=100).map(|i| 0.1 * f64::from(i)).collect();
    for (method, mut bare) in
        all(&field, &control(1e-10), &start).into_iter().zip(all(&field, &control(1e-10), &start))
    {
        let mut method = method;
        let mut output = OutputTimes::new(4, &times).unwrap();
        let (mut seen, mut worst) = (0, 0.0_f64);
        integrate(&mut *method, 10.0, |mut step| {
            let taken = output.within(&mut step, |t, y| {
                assert_eq!(t, times[seen]);
                seen += 1;
                worst = worst.max(planet.error(t, &[y[0], y[1]]).unwrap());
            });
            taken.unwrap();
            ControlFlow::Continue(())
        })
        .unwrap();
        let name = method.facts().name;
        assert!(seen == 101 && output.ahead().is_empty(), "{name}: {seen}");
        assert!(worst < 1e-5, "{name}: {worst:e}");
        integrate(&mut *bare, 10.0, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(bare.work().steps, method.work().steps);
        assert_eq!(bare.moment(), method.moment());
    }
}

#[test]
fn tiny_and_huge_numbers_are_shown_with_an_exponent() {
    let last = Moment::new(6e-75, Vec::new());
    let error = AdaptiveError::TooManySteps { steps: 3, last: last.clone() };
    assert_eq!(error.to_string(), "3 steps were tried, and t = 6e-75 s is as far as they led");
    let error = AdaptiveError::StepTooSmall { step: 1e-300, last };
    assert!(error.to_string().contains("1e-300 s at t = 6e-75 s,"), "{error}");
    let error = AdaptiveError::End { end: -1e300, t: 2.5 };
    assert_eq!(error.to_string(), "the end -1e300 s does not lie ahead of t = 2.5 s");
}

#[test]
fn an_event_looks_afresh_after_a_restart_at_the_end_of_a_step() {
    // y' = 1 from -1 to -1/2; then from +1, where nothing crosses, or from -1/4, where something does.
    let field = FunctionField::new(1, |_t, _y: &[f64], f: &mut [f64]| f[0] = 1.0);
    let start = Moment::new(0.0, [-1.0]);
    for (again, crossings) in [(1.0, 0), (-0.25, 1)] {
        for mut method in all(&field, &control(1e-6), &start) {
            let name = method.facts().name;
            let mut event = Event::new(Direction::Any, &start, |_t, y: &[f64]| y[0]);
            let mut count = 0;
            for (end, restart) in [(0.5, Some(again)), (1.5, None)] {
                integrate(&mut *method, end, |mut step| {
                    count += u32::from(event.crossing(&mut step).unwrap());
                    ControlFlow::Continue(())
                })
                .unwrap();
                if let Some(y) = restart {
                    method.restart(&Moment::new(end, [y])).unwrap();
                }
            }
            assert_eq!(count, crossings, "{name} from {again}");
        }
    }
}

#[test]
fn a_step_that_is_taken_again_after_a_load_has_its_crossing_again() {
    let field = FunctionField::new(1, |_t, _y: &[f64], f: &mut [f64]| f[0] = 1.0);
    let start = Moment::new(0.0, [-1.0]);
    for mut method in all(&field, &control(1e-6), &start) {
        let name = method.facts().name;
        let mut event = Event::new(Direction::Any, &start, |_t, y: &[f64]| y[0]);
        let mut times = Vec::new();
        while method.moment().t < 1.5 {
            let saved = method.save();
            for again in [false, true] {
                if again {
                    method.load(&saved).unwrap();
                }
                integrate(&mut *method, 1.5, |mut step| {
                    while event.crossing(&mut step).unwrap() {
                        times.push(event.moment().t);
                    }
                    ControlFlow::Break(())
                })
                .unwrap();
            }
        }
        assert!(times.len() == 2 && times[0] == times[1], "{name}: {times:?}");
    }
}
