//! What the Runge-Kutta-Nystrom methods promise, where they stop, and what they say to bad input.

use std::ops::ControlFlow::{Break, Continue};

use stationary_calculus::{
    Covector, DenseMetric, DiagonalMetric, Metric, Potential, Sink, SizeError, System,
};
use stationary_integrators::problems::{Problem, kepler, oscillator, pendulum, pleiades};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, Direction, Event, Moment, NewtonianGravity, Nystrom, Nystrom8,
    Nystrom12, NystromMethod8, NystromMethod12, NystromPair, NystromStep, OutputTimes, Pair8,
    Pair12, State, StepControl, Tolerance, UniformGravity, Work, angular_momentum, integrate,
    integrate_to_event, linear_momentum, linear_momentum_scale,
};

/// The same tolerance, absolute and relative.
fn both(tolerance: f64) -> StepControl {
    Tolerance::new(tolerance, tolerance).unwrap().into()
}

/// Runs a pair to a problem's horizon and gives the largest error along the way.
fn worst_error<T: NystromPair<S>, M: Metric, P: Potential, const N: usize, const S: usize>(
    problem: &Problem<M, P, [f64; N]>,
    tolerance: f64,
) -> (f64, Work) {
    let mut nystrom = Nystrom::<T, M, P, _, S>::new(&problem.system, both(tolerance)).unwrap();
    let mut state = problem.initial.clone();
    let mut worst = 0.0_f64;
    let work = nystrom.run(&mut state, problem.horizon, |step| {
        worst = worst.max(problem.error(step.after.t, &step.after.q).unwrap_or(0.0));
        Continue(())
    });
    assert_eq!(state.t, problem.horizon);
    (worst, work.unwrap())
}

#[test]
fn the_error_follows_the_tolerance_down_to_rounding_at_every_eccentricity() {
    for (e, amplified) in [(0.0, 1e2), (0.6, 1e3), (0.9, 1e4), (0.99, 1e6)] {
        let problem = kepler(e).unwrap();
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let errors = [
                worst_error::<Pair8, _, _, 2, 9>(&problem, tolerance).0,
                worst_error::<Pair12, _, _, 2, 17>(&problem, tolerance).0,
            ];
            for error in errors {
                assert!(error < amplified * tolerance, "e = {e}, {tolerance:e}: {error:e}");
            }
        }
    }
}

#[test]
fn a_pendulum_is_followed_to_ten_digits() {
    let problem = pendulum(2.0).unwrap();
    assert!(worst_error::<Pair8, _, _, 1, 9>(&problem, 1e-12).0 < 1e-10);
    assert!(worst_error::<Pair12, _, _, 1, 17>(&problem, 1e-12).0 < 1e-10);
}

#[test]
fn the_pleiades_end_where_the_test_set_says() {
    let problem = pleiades().unwrap();
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let eight = worst_error::<Pair8, _, _, 14, 9>(&problem, tolerance).0;
        let twelve = worst_error::<Pair12, _, _, 14, 17>(&problem, tolerance).0;
        assert!(eight < 300.0 * tolerance && twelve < 300.0 * tolerance, "{eight:e} {twelve:e}");
    }
    // What is left below that is rounding, which close encounters amplify ten thousand times.
    assert!(worst_error::<Pair8, _, _, 14, 9>(&problem, 1e-13).0 < 2e-11);
    assert!(worst_error::<Pair12, _, _, 14, 17>(&problem, 1e-13).0 < 2e-11);
}

#[test]
fn few_steps_are_refused_on_the_way_into_a_close_encounter() {
    let work = worst_error::<Pair12, _, _, 2, 17>(&kepler(0.9).unwrap(), 1e-9).1;
    assert!(10 * work.rejected < work.steps, "{work:?}");
    let evaluations = 1 + 17 * work.steps + 16 * work.rejected;
    assert_eq!(work.evaluations, evaluations);
    let work = worst_error::<Pair8, _, _, 2, 9>(&kepler(0.9).unwrap(), 1e-9).1;
    assert!(10 * work.rejected < work.steps, "{work:?}");
    assert_eq!(work.evaluations, 1 + 8 * (work.steps + work.rejected));
}

#[test]
fn a_dense_mass_gives_the_motion_of_its_own_axes() {
    // In the axes of the sum and the difference this is a pair of oscillators.
    let mass = nalgebra::dmatrix![2.0, 1.0; 1.0, 2.0];
    let potential = stationary_integrators::problems::Linear::<2> { stiffness: 3.0 };
    let system = System::new(DenseMetric::new(mass).unwrap(), potential).unwrap();
    let mut state = State::new([1.0, 0.0], Covector([0.0, 0.0]));
    let mut nystrom = Nystrom12::new(&system, both(1e-12)).unwrap();
    nystrom.run(&mut state, 7.0, |_| Continue(())).unwrap();
    let (sum, difference) = (7.0_f64.cos(), (3.0_f64.sqrt() * 7.0).cos());
    assert!((state.q[0] - 0.5 * (sum + difference)).abs() < 1e-10);
    assert!((state.q[1] - 0.5 * (sum - difference)).abs() < 1e-10);
}

#[test]
fn linear_momentum_is_kept_to_rounding_and_energy_and_angular_momentum_only_to_the_tolerance() {
    let problem = pleiades().unwrap();
    let drifts = |tolerance: f64| {
        let mut state = problem.initial.clone();
        let linear = linear_momentum::<2>(&state);
        let (angular, energy) = (angular_momentum::<2>(&state)[2], problem.energy(&state));
        let mut nystrom = Nystrom12::new(&problem.system, both(tolerance)).unwrap();
        let mut worst = 0.0_f64;
        let observe = |step: NystromStep<'_, _, _>| {
            let now: [f64; 2] = linear_momentum::<2>(step.after);
            let drift = (now[0] - linear[0]).hypot(now[1] - linear[1]);
            worst = worst.max(drift / linear_momentum_scale::<2>(step.after));
            Continue(())
        };
        nystrom.run(&mut state, 3.0, observe).unwrap();
        let angular = (angular_momentum::<2>(&state)[2] - angular).abs();
        (worst, angular, (problem.energy(&state) - energy).abs())
    };
    let (linear, angular, energy) = drifts(1e-4);
    assert!(linear < 1e-14, "{linear:e}");
    assert!(angular > 1e-8 && energy > 1e-8, "{angular:e} {energy:e}");
    let (_, angular, energy) = drifts(1e-12);
    assert!(angular < 1e-9 && energy < 1e-9, "{angular:e} {energy:e}");
}

#[test]
fn energy_drifts_steadily_where_a_symplectic_method_would_keep_it() {
    let problem = kepler(0.3).unwrap();
    let mut nystrom = Nystrom8::new(&problem.system, both(1e-5)).unwrap();
    let mut state = problem.initial.clone();
    let mut error_after = |years: f64| {
        nystrom.run(&mut state, years * problem.period, |_| Continue(())).unwrap();
        (problem.energy(&state) + 0.5).abs()
    };
    let (short, long) = (error_after(100.0), error_after(1000.0));
    assert!((5.0..20.0).contains(&(long / short)), "{short:e} {long:e}");
}

/// The largest error of the configuration at the ends of the steps of an orbit, and at nine times
/// within each.
fn errors_at_and_within_steps<T: NystromPair<S>, const S: usize>(
    e: f64,
    tolerance: f64,
) -> [f64; 2] {
    let problem = kepler(e).unwrap();
    let mut nystrom =
        Nystrom::<T, _, _, [f64; 2], S>::new(&problem.system, both(tolerance)).unwrap();
    let (mut state, mut inside) = (problem.initial.clone(), problem.initial.clone());
    let mut errors = [0.0_f64; 2];
    nystrom
        .run(&mut state, problem.horizon, |mut step| {
            let (from, to) = (step.before.t, step.after.t);
            for part in 1..10 {
                step.at(from + 0.1 * f64::from(part) * (to - from), &mut inside).unwrap();
                errors[1] = errors[1].max(problem.error(inside.t, &inside.q).unwrap());
            }
            errors[0] = errors[0].max(problem.error(to, &step.after.q).unwrap());
            Continue(())
        })
        .unwrap();
    errors
}

#[test]
fn within_a_step_the_error_is_that_of_its_ends() {
    for e in [0.1, 0.6, 0.9] {
        for tolerance in [1e-6, 1e-10] {
            let pairs = [
                errors_at_and_within_steps::<Pair8, 9>(e, tolerance),
                errors_at_and_within_steps::<Pair12, 17>(e, tolerance),
            ];
            for [ends, within] in pairs {
                assert!(within < 3.0 * ends, "e = {e}, {tolerance:e}: {ends:e} {within:e}");
            }
        }
    }
}

/// A year of a planet of eccentricity e from where it is farthest: the errors of position and energy.
fn errors_from_the_apoapsis<T: NystromPair<S>, const S: usize>(e: f64, tolerance: f64) -> [f64; 2] {
    let problem = kepler(e).unwrap();
    let slow = ((1.0 - e) / (1.0 + e)).sqrt();
    let mut state = State::new([-1.0 - e, 0.0], Covector([0.0, -slow]));
    let mut nystrom =
        Nystrom::<T, _, _, [f64; 2], S>::new(&problem.system, both(tolerance)).unwrap();
    nystrom.run(&mut state, problem.period, |_| Continue(())).unwrap();
    let off = (state.q[0] + 1.0 + e).hypot(state.q[1]);
    [off, (problem.energy(&state) + 0.5).abs()]
}

#[test]
fn an_orbit_that_begins_far_from_its_close_encounter_is_followed_through_it() {
    for (e, tolerance, bound) in [(0.999, 1e-4, 2e-4), (0.9999, 1e-8, 5e-7)] {
        let pairs = [
            errors_from_the_apoapsis::<Pair8, 9>(e, tolerance),
            errors_from_the_apoapsis::<Pair12, 17>(e, tolerance),
        ];
        for [off, energy] in pairs {
            assert!(off < bound && energy < bound, "e = {e}: {off:e} {energy:e}");
        }
    }
}

#[test]
fn a_fall_into_the_sun_ends_there_with_an_error() {
    let problem = kepler(0.5).unwrap();
    let collision = std::f64::consts::PI / 8.0_f64.sqrt();
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let mut state = State::new([1.0, 0.0], Covector([0.0, 0.0]));
        let mut nystrom = Nystrom8::new(&problem.system, both(tolerance)).unwrap();
        let error = nystrom.run(&mut state, 3.0, |_| Continue(())).unwrap_err();
        assert!(matches!(error, AdaptiveError::StepTooSmall { .. }), "{error}");
        assert!((state.t - collision).abs() < 1e-2, "{}", state.t);
    }
}

/// A planet as an adaptive method: a year is over where it crosses the axis upwards.
#[test]
fn a_pair_finds_events_gives_output_and_goes_on_from_what_it_saved_like_any_method() {
    let problem = kepler(0.6).unwrap();
    let start = Moment::new(0.0, [0.4, 0.0, 0.0, 2.0]);
    let method = || NystromMethod12::new(&problem.system, both(1e-11), start.clone()).unwrap();
    let mut nystrom = method();
    let mut year = Event::new(Direction::Rising, &start, |_, y: &[f64]| y[1]).looking_at(3);
    nystrom.step(10.0).unwrap();
    integrate_to_event(&mut nystrom, 10.0, &mut year, |_| ()).unwrap();
    assert!((nystrom.moment().t - problem.period).abs() < 1e-9, "{}", nystrom.moment().t);

    let times: Vec<f64> = (1..200).map(|i| 0.05 * f64::from(i)).collect();
    let mut output = OutputTimes::new(4, &times).unwrap();
    let (mut nystrom, mut worst, mut seen) = (method(), 0.0_f64, 0);
    integrate(&mut nystrom, 10.0, |mut step| {
        let take = |t, y: &[f64]| {
            worst = worst.max(problem.error(t, &[y[0], y[1]]).unwrap());
            seen += 1;
        };
        output.within(&mut step, take).unwrap();
        Continue(())
    })
    .unwrap();
    assert!(seen == 199 && worst < 1e-9, "{seen} {worst:e}");

    let (mut whole, mut resumed) = (method(), method());
    for _ in 0..7 {
        whole.step(30.0).unwrap();
    }
    resumed.load(&whole.save()).unwrap();
    for method in [&mut whole, &mut resumed] {
        integrate(method, 30.0, |_| Continue(())).unwrap();
    }
    assert_eq!(whole.moment(), resumed.moment());
    assert_eq!(whole.work(), resumed.work());
}

#[test]
fn a_pair_as_a_method_takes_the_same_steps_as_its_own_run() {
    let problem = kepler(0.7).unwrap();
    let mut state = problem.initial.clone();
    let mut run = Nystrom8::new(&problem.system, both(1e-8)).unwrap();
    let work = run.run(&mut state, 20.0, |_| Continue(())).unwrap();
    let [q, p] = [problem.initial.q, problem.initial.p.0];
    let start = Moment::new(0.0, vec![q[0], q[1], p[0], p[1]]);
    let mut method = NystromMethod8::new(&problem.system, both(1e-8), start).unwrap();
    integrate(&mut method, 20.0, |_| Continue(())).unwrap();
    assert_eq!(method.moment().y, [state.q, state.p.0].concat());
    assert_eq!(*method.work(), work);
}

#[test]
fn a_step_holds_its_ends_exactly_and_nothing_outside() {
    let problem = kepler(0.6).unwrap();
    let mut nystrom = Nystrom8::new(&problem.system, both(1e-6)).unwrap();
    let mut state = problem.initial.clone();
    let mut within = state.clone();
    let mut last = state.clone();
    nystrom
        .run(&mut state, 3.0, |mut step| {
            assert_eq!(*step.before, last);
            last = step.after.clone();
            for end in [step.before, step.after] {
                step.at(end.t, &mut within).unwrap();
                for c in 0..2 {
                    assert!((within.q[c] - end.q[c]).abs() < 1e-15);
                    assert!((within.p.0[c] - end.p.0[c]).abs() < 2e-15);
                }
            }
            for t in [step.before.t - 1e-9, step.after.t + 1e-9, f64::NAN] {
                let error = step.at(t, &mut within).unwrap_err();
                assert!(matches!(error, AdaptiveError::OutsideStep { .. }), "{error}");
            }
            Continue(())
        })
        .unwrap();
    assert_eq!(last, state);
}

#[test]
fn an_observer_that_breaks_off_leaves_the_state_it_saw_and_the_run_goes_on_from_there() {
    let problem = kepler(0.6).unwrap();
    let mut nystrom = Nystrom12::new(&problem.system, both(1e-10)).unwrap();
    let mut state = problem.initial.clone();
    let work = nystrom
        .run(&mut state, 10.0, |step| if step.number == 5 { Break(()) } else { Continue(()) })
        .unwrap();
    assert_eq!(work.steps, 5);
    assert!(state.t < 10.0);
    assert!(problem.error(state.t, &state.q).unwrap() < 1e-9);
    nystrom.run(&mut state, 10.0, |_| Continue(())).unwrap();
    assert_eq!(state.t, 10.0);
    assert!(problem.error(10.0, &state.q).unwrap() < 1e-8);
}

#[test]
fn a_body_at_rest_stays_there_in_one_step() {
    let problem = oscillator(1.0).unwrap();
    let mut state = State::new([0.0; 1], Covector([0.0; 1]));
    let mut nystrom = Nystrom8::new(&problem.system, both(1e-9)).unwrap();
    let work = nystrom.run(&mut state, 5.0, |_| Continue(())).unwrap();
    assert_eq!((work.steps, state.q, state.t), (1, [0.0], 5.0));
}

/// What a run from a state that cannot be run from says; the state must stay as it was.
#[test]
fn a_start_that_is_zero_but_for_rounding_is_one_as_any_other() {
    let system = oscillator(1.0).unwrap().system;
    for x in [0.0, 1e-300, 1.8e-16, -1e-14, 1e-12, 1e-8] {
        for start in [0.0, 4.71238898038469, 1e6] {
            let mut state = State::new([x], Covector([1.0]));
            state.t = start;
            let mut nystrom = Nystrom12::new(&system, both(1e-13)).unwrap();
            let work = nystrom.run(&mut state, start + 1.0, |_| Continue(())).unwrap();
            let truth = x * 1.0_f64.cos() + 1.0_f64.sin();
            assert!((state.q[0] - truth).abs() < 1e-9 * start.max(1e-3), "{x} at {start}");
            assert!(work.steps + work.rejected < 60, "{x} at {start}: {work:?}");
        }
    }
}

fn refused(state: State<Vec<f64>>, end: f64) -> AdaptiveError {
    let problem = kepler(0.6).unwrap();
    let mut nystrom = Nystrom12::new(&problem.system, both(1e-9)).unwrap();
    let bits = |state: &State<Vec<f64>>| {
        let numbers = state.q.iter().chain(&state.p.0).chain([&state.t]);
        numbers.map(|x| x.to_bits()).collect::<Vec<_>>()
    };
    let mut after = state.clone();
    let seen = |_: NystromStep<'_, _, _>| panic!("a step was taken");
    let error = nystrom.run(&mut after, end, seen).unwrap_err();
    assert_eq!(bits(&after), bits(&state));
    error
}

#[test]
fn states_and_ends_that_cannot_be_run_from_are_refused_by_name() {
    let state = || State::new(vec![0.4, 0.0], Covector(vec![0.0, 2.0]));
    for end in [-1.0, 0.0, f64::INFINITY] {
        assert_eq!(refused(state(), end), AdaptiveError::End { end, t: 0.0 });
    }
    assert!(matches!(refused(state(), f64::NAN), AdaptiveError::End { .. }));
    let late = State { t: f64::NAN, ..state() };
    assert!(matches!(refused(late, 1.0), AdaptiveError::End { .. }));
    let bad = State::new(vec![0.4, f64::INFINITY], Covector(vec![0.0, 2.0]));
    let named = AdaptiveError::NonFinite { what: "the configuration", t: 0.0, component: 1 };
    assert_eq!(refused(bad, 1.0), named);
    let bad = State::new(vec![0.4, 0.0], Covector(vec![f64::NAN, 2.0]));
    let named = AdaptiveError::NonFinite { what: "the momentum", t: 0.0, component: 0 };
    assert_eq!(refused(bad, 1.0), named);
    let bad = State::new(vec![0.4, 0.0, 0.0], Covector(vec![0.0; 3]));
    assert!(matches!(refused(bad, 1.0), AdaptiveError::Size(_)));
    let uneven = Tolerance::componentwise(1e-9, vec![1e-9; 3]).unwrap();
    let problem = kepler(0.6).unwrap();
    let storage = Nystrom8::<_, _, [f64; 3]>::new(&problem.system, both(1e-9)).map(drop);
    assert!(matches!(storage, Err(SizeError { expected: 2, got: 3, .. })));
    let tolerances = Nystrom8::<_, _, [f64; 2]>::new(&problem.system, uneven.into()).map(drop);
    assert!(matches!(tolerances, Err(SizeError { expected: 4, got: 3, .. })));
}

#[test]
fn bodies_that_fall_into_each_other_are_an_error_with_the_last_good_state() {
    let gravity =
        NewtonianGravity::<2> { constant: 1.0, masses: vec![1.0, 1.0], fixed: Vec::new() };
    let system = System::new(DiagonalMetric::new([1.0; 4]).unwrap(), gravity).unwrap();
    let mut state = State::new([0.5, 0.0, -0.5, 0.0], Covector([0.0; 4]));
    let mut last = state.clone();
    let mut nystrom = Nystrom12::new(&system, both(1e-10)).unwrap();
    let error = nystrom
        .run(&mut state, 10.0, |step| {
            last = step.after.clone();
            Continue(())
        })
        .unwrap_err();
    // Two unit masses at distance 1 meet after pi/4 seconds.
    assert_eq!(state, last);
    assert!((state.t - std::f64::consts::FRAC_PI_4).abs() < 1e-6, "{error}");
    let AdaptiveError::StepTooSmall { last, .. } = error else { panic!("{error}") };
    assert_eq!((last.t, last.y), (state.t, [state.q, state.p.0].concat()));
}

#[test]
fn an_end_that_is_the_next_number_is_reached() {
    let problem = kepler(0.6).unwrap();
    for t in [1.0_f64, 1e6] {
        let mut nystrom = Nystrom12::new(&problem.system, both(1e-10)).unwrap();
        let mut state = State { t, ..problem.initial.clone() };
        nystrom.run(&mut state, t.next_up(), |_| Continue(())).unwrap();
        assert_eq!(state.t, t.next_up());
        assert!((state.q[1] - problem.initial.q[1]).abs() <= 1e-9);
    }
}

#[test]
fn a_run_that_takes_too_many_steps_says_so() {
    let problem = kepler(0.6).unwrap();
    let control = both(1e-10).most_steps(20).unwrap();
    let mut nystrom = Nystrom12::new(&problem.system, control).unwrap();
    let mut state = problem.initial.clone();
    let error = nystrom.run(&mut state, problem.horizon, |_| Continue(())).unwrap_err();
    let AdaptiveError::TooManySteps { steps: 20, last } = error else { panic!("{error}") };
    assert_eq!(last.t, state.t);
    assert!(state.t > 0.0 && problem.error(state.t, &state.q).unwrap() < 1e-8);
}

/// A force that is finite near the start and not a number beyond q = 1.
#[derive(Clone, Debug)]
struct Edge;

impl Potential for Edge {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        -(1.0 - q[0]).sqrt()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += 0.5 / (1.0 - q[0]).sqrt();
    }

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}

#[test]
fn a_force_that_is_not_a_number_ahead_is_an_error_and_not_a_nan() {
    let system = System::new(DiagonalMetric::new([1.0]).unwrap(), Edge).unwrap();
    let mut state = State::new([0.0], Covector([3.0]));
    let mut nystrom = Nystrom8::new(&system, both(1e-8)).unwrap();
    let error = nystrom.run(&mut state, 1.0, |_| Continue(())).unwrap_err();
    assert!(matches!(error, AdaptiveError::StepTooSmall { .. }), "{error}");
    assert!(state.q[0] < 1.0 && state.q[0] > 0.99, "{state:?}");
}

#[test]
fn a_start_where_the_force_is_not_a_number_is_refused_and_a_restart_there_changes_nothing() {
    let system = System::new(DiagonalMetric::new([1.0]).unwrap(), Edge).unwrap();
    let there = || Moment::new(0.0, [2.0, 0.0]);
    for control in [both(1e-8), both(1e-8).first_step(0.01).unwrap()] {
        let named =
            |error: AdaptiveError| matches!(error, AdaptiveError::NonFinite { what: "dV", .. });
        let made = NystromMethod8::new(&system, control.clone(), there());
        assert!(named(made.unwrap_err()));
        let mut nystrom = Nystrom8::new(&system, control.clone()).unwrap();
        let mut state = State::new([2.0], Covector([0.0]));
        assert!(named(nystrom.run(&mut state, 0.2, |_| Continue(())).unwrap_err()));
        let start = Moment::new(0.0, [-1.0, 0.0]);
        let mut one = NystromMethod8::new(&system, control, start).unwrap();
        one.step(0.2).unwrap();
        let mut other = one.clone();
        assert!(named(other.restart(&there()).unwrap_err()));
        assert_eq!((one.moment(), one.last_begin()), (other.moment(), other.last_begin()));
        for method in [&mut one, &mut other] {
            integrate(method, 0.2, |_| Continue(())).unwrap();
        }
        assert_eq!(one.moment(), other.moment());
    }
}

#[test]
fn steps_are_as_long_as_the_caller_says() {
    let problem = kepler(0.6).unwrap();
    let lengths = |control: StepControl| {
        let mut nystrom = Nystrom12::new(&problem.system, control).unwrap();
        let mut lengths = Vec::new();
        let mut state = problem.initial.clone();
        nystrom
            .run(&mut state, 3.0, |step| {
                lengths.push(step.after.t - step.before.t);
                Continue(())
            })
            .unwrap();
        lengths
    };
    let constant = lengths(both(1e-9).constant_step(0.3).unwrap());
    assert!(constant.len() == 10 && constant.iter().all(|h| (h - 0.3).abs() < 1e-14));
    let short = lengths(both(1e-9).longest_step(0.05).unwrap());
    assert!(short.len() >= 60 && short.iter().all(|&h| h < 0.0506));
    assert_eq!(lengths(both(1e-9).first_step(1e-3).unwrap())[0], 1e-3);
}

#[test]
fn what_no_pair_has_saved_is_refused_and_changes_nothing() {
    let problem = kepler(0.6).unwrap();
    let start = Moment::new(0.0, [0.4, 0.0, 0.0, 2.0]);
    let mut pair = NystromMethod8::new(&problem.system, both(1e-9), start).unwrap();
    for _ in 0..3 {
        pair.step(10.0).unwrap();
    }
    let before = pair.save();
    for place in 0..before.numbers.len() {
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            let mut broken = before.clone();
            broken.numbers[place] = bad;
            match pair.load(&broken) {
                Err(_) => assert_eq!(pair.save(), before, "{place} {bad}"),
                // A number that a run may have left: another place, another count.
                Ok(()) => {
                    assert!(bad.is_finite(), "{place} {bad}");
                    let _ = pair.step(10.0);
                    pair.load(&before).unwrap();
                }
            }
        }
    }
}

#[test]
fn a_run_without_any_error_can_be_saved_and_goes_on() {
    let force = UniformGravity { acceleration: [0.0], masses: vec![1.0] };
    let system = System::new(DiagonalMetric::new([1.0]).unwrap(), force).unwrap();
    let start = Moment::new(0.0, [0.0, 1.0]);
    let mut free = NystromMethod8::new(&system, both(1e-9), start).unwrap();
    free.step(10.0).unwrap();
    let saved = free.save();
    free.load(&saved).unwrap();
    free.step(1e3).unwrap();
}
