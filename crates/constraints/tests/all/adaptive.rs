//! Steps of their own length, and what is between them.

use stationary_calculus::Covector;
use stationary_constraints::problems::{Pendulum, RodProblem, pendulum};
use stationary_constraints::{
    Adaptive, Composed, ConstrainedIntegrator, ConstrainedReport, Constraint, ConstraintError,
    Dense, Rattle, Redundancy, StepTolerance,
};
use stationary_integrators::{Facts, Scheme, State};
use stationary_measure::loglog_slope;

const ONE: Dense<1> = Dense(Redundancy::Refuse);

fn tolerance(absolute: f64) -> StepTolerance {
    StepTolerance { absolute, relative: 0.0 }
}

/// The largest errors of place and tension at 400 times, and the differentials that were taken.
fn errors<I>(problem: &Pendulum, integrator: I, absolute: f64) -> ([f64; 2], u32)
where
    I: ConstrainedIntegrator<[f64; 2]> + Clone,
{
    let mut state = problem.problem.initial.clone();
    let mut method = Adaptive::new(integrator, tolerance(absolute), 0.1, &state).unwrap();
    let (end, mut next, mut work) = (20.0, 0.05, 0);
    let mut largest = [0.0_f64; 2];
    let rods = &problem.problem.rods;
    while state.t < end {
        let step = method.advance(&mut state, end).unwrap();
        work += step.cost.differentials;
        assert!(step.error <= 1.0 && step.to == state.t && step.from < step.to);
        while next <= step.to {
            let (mut between, mut lambda) = (state.clone(), [0.0]);
            method.at(next, &mut between, &mut lambda).unwrap();
            let mut g = [0.0];
            rods.value(next, &between.q, &mut g).unwrap();
            assert!(g[0].abs() < 1e-12 && between.t == next);
            let tension = rods.rods()[0].tension(lambda[0]);
            let found = [problem.error(next, &between.q), (tension - problem.tension(next)).abs()];
            largest = [0, 1].map(|k| largest[k].max(found[k]));
            next += 0.05;
        }
    }
    assert_eq!(state.t, end);
    (largest, work)
}

#[test]
fn errors_of_place_and_tension_between_steps_fall_with_the_tolerance() {
    let problem = pendulum(2.5).unwrap();
    let rattle = || {
        Rattle::new(&problem.problem.system, &problem.problem.rods, &problem.problem.initial, ONE)
    };
    let runs =
        [1e-4, 1e-5, 1e-6, 1e-7].map(|tol| (tol, errors(&problem, rattle().unwrap(), tol).0));
    for k in 0..2 {
        let points = runs.map(|(tolerance, errors)| (tolerance, errors[k]));
        // An error of h^3 in a step is one of h^2 in the end: two thirds of the tolerance's digits.
        let slope = loglog_slope(&points).unwrap();
        assert!((0.55..0.8).contains(&slope), "{k}: {slope} {points:?}");
    }
    let composed = || {
        let initial = &problem.problem.initial;
        Composed::new(rattle().unwrap(), Scheme::Suzuki4, initial).unwrap()
    };
    let points = [1e-5, 1e-7, 1e-9].map(|tol| (tol, errors(&problem, composed(), tol).0[0]));
    let slope = loglog_slope(&points).unwrap();
    assert!((0.65..1.0).contains(&slope), "{slope} {points:?}");
}

#[test]
fn where_motion_is_fast_and_slow_own_steps_need_less_work_than_equal_ones() {
    // It all but stops at the top.
    let problem = pendulum(2.0001).unwrap();
    let RodAnd { system, rods, initial } = RodAnd::of(&problem);
    let rattle = || Rattle::new(system, rods, initial, ONE).unwrap();
    let ([error, _], work) = errors(&problem, rattle(), 1e-6);
    let equal = |steps: u32| {
        let (mut method, mut state, mut largest) = (rattle(), initial.clone(), 0.0_f64);
        for _ in 0..steps {
            method.step(&mut state, 20.0 / f64::from(steps)).unwrap();
            largest = largest.max(problem.error(state.t, &state.q));
        }
        largest
    };
    assert!(equal(work / 3) > error, "{error} by {work}: {}", equal(work / 3));
}

struct RodAnd<'a> {
    system: &'a stationary_calculus::System<
        stationary_calculus::DiagonalMetric<[f64; 2]>,
        stationary_integrators::UniformGravity<2>,
    >,
    rods: &'a stationary_constraints::Rods<2>,
    initial: &'a State<[f64; 2]>,
}

impl<'a> RodAnd<'a> {
    fn of(problem: &'a Pendulum) -> Self {
        let problem = &problem.problem;
        RodAnd { system: &problem.system, rods: &problem.rods, initial: &problem.initial }
    }
}

#[test]
fn what_no_tolerance_or_time_is_is_refused_and_leaves_the_state() {
    let problem = pendulum(1.0).unwrap();
    let RodAnd { system, rods, initial } = RodAnd::of(&problem);
    let rattle = Rattle::new(system, rods, initial, ONE).unwrap();
    for (absolute, relative) in [(0.0, 0.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        let wrong = StepTolerance { absolute, relative };
        let error = Adaptive::new(rattle.clone(), wrong, 0.1, initial).unwrap_err();
        assert!(matches!(error, ConstraintError::Parameter { .. }), "{error}");
    }
    assert!(Adaptive::new(rattle.clone(), tolerance(1e-6), 0.0, initial).is_err());
    let mut method = Adaptive::new(rattle, tolerance(1e-6), 0.1, initial).unwrap();
    let mut state = initial.clone();
    for until in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(method.advance(&mut state, until).is_err());
        assert_eq!(&state, initial);
    }
    let step = method.advance(&mut state, 1.0).unwrap();
    let mut between = initial.clone();
    for t in [-1e-3, step.to + 1e-3, f64::NAN] {
        assert!(method.at(t, &mut between, &mut [0.0]).is_err());
    }
    assert!(method.at(step.to, &mut between, &mut [0.0, 0.0]).is_err());
    assert_eq!(&between, initial);
    method.at(step.to, &mut between, &mut [0.0]).unwrap();
    assert!(between.q.iter().zip(&state.q).all(|(a, b)| (a - b).abs() < 1e-14));
}

/// A method that is not consistent: whatever the step, it leads to another place than two halves of it.
#[derive(Clone)]
struct Jumps;

impl ConstrainedIntegrator<[f64; 2]> for Jumps {
    fn facts(&self) -> Facts {
        let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
        Rattle::new(&system, rods, &initial, ONE).unwrap().facts()
    }

    fn step(
        &mut self,
        state: &mut State<[f64; 2]>,
        h: f64,
    ) -> Result<ConstrainedReport, ConstraintError> {
        state.q[1] += 1e-3;
        state.t += h;
        Ok(ConstrainedReport::default())
    }

    fn multipliers(&self) -> &[f64] {
        &[]
    }
}

#[test]
fn where_no_step_meets_the_tolerance_the_time_the_step_and_the_number_are_named() {
    let mut state = pendulum(1.0).unwrap().problem.initial;
    state.t = 2.0;
    let before = state.clone();
    let mut method = Adaptive::new(Jumps, tolerance(1e-6), 0.1, &state).unwrap();
    let error = method.advance(&mut state, 3.0).unwrap_err();
    let ConstraintError::StepTooShort { t, h, error: off, number } = error else {
        panic!("{error}")
    };
    assert!(t == 2.0 && h < 1e-14 && number == 1, "{t} {h} {number}");
    // A jump of 1e-3, over 2^2 - 1, in tolerances of 1e-6.
    assert!((off / (1e3 / 3.0) - 1.0).abs() < 1e-6, "{off}");
    assert_eq!(state, before);
}

#[test]
fn a_tolerance_below_rounding_is_an_error_and_no_crawl() {
    let problem = pendulum(1.0).unwrap();
    let RodAnd { system, rods, initial } = RodAnd::of(&problem);
    let ended = |tol: f64| {
        let rattle = Rattle::new(system, rods, initial, ONE).unwrap();
        let mut state = initial.clone();
        let mut method = Adaptive::new(rattle, tolerance(tol), 0.1, &state).unwrap();
        for _ in 0..30_000 {
            match method.advance(&mut state, 1.0) {
                Ok(step) if step.to == 1.0 => return Some(problem.error(1.0, &state.q)),
                Ok(_) => {}
                Err(ConstraintError::StepTooShort { h, .. }) if h > 1e-9 => return None,
                Err(error) => panic!("{tol:e}: {error}"),
            }
        }
        panic!("{tol:e}: it crawls at {}", state.t)
    };
    assert!(ended(1e-14).unwrap() < 1e-9);
    assert_eq!([1e-17, 1e-18, 1e-20, 1e-30].map(ended), [None; 4]);
}

#[test]
fn a_number_that_stays_zero_is_within_a_tolerance_of_zero() {
    let problem = pendulum(1.0).unwrap();
    let RodAnd { system, rods, .. } = RodAnd::of(&problem);
    let only_relative = StepTolerance { absolute: 0.0, relative: 1e-6 };
    let mut state = State::new([0.0, -1.0], Covector([0.0, 0.0]));
    let rattle = Rattle::new(system, rods, &state, ONE).unwrap();
    let mut method = Adaptive::new(rattle, only_relative, 0.1, &state).unwrap();
    while state.t < 10.0 {
        assert_eq!(method.advance(&mut state, 10.0).unwrap().error, 0.0);
    }
    assert_eq!(state.q, [0.0, -1.0]);
}

#[test]
fn after_a_step_that_fails_places_and_forces_are_still_those_of_the_last_one() {
    let problem = pendulum(0.01).unwrap();
    let initial = &problem.problem.initial;
    let rattle = Rattle::new(&problem.problem.system, &problem.problem.rods, initial, ONE).unwrap();
    let mut state = initial.clone();
    let mut method = Adaptive::new(rattle, tolerance(1e-9), 1e-2, &state).unwrap();
    for _ in 0..4 {
        method.advance(&mut state, 1.0).unwrap();
    }
    let (end, mut there) = (state.t, state.clone());
    let mut look = |method: &mut Adaptive<_, _>| {
        [0.2, 0.8].map(|part| {
            let mut lambda = [0.0];
            method.at(end - 1e-3 * part, &mut there, &mut lambda).unwrap();
            (there.clone(), lambda)
        })
    };
    let before = look(&mut method);
    // Faster, and so late that the clock does not tell shorter steps apart.
    let mut late = State { t: 1e15, ..state };
    late.p.0.iter_mut().for_each(|p| *p *= 30.0);
    let error = method.advance(&mut late, 1e15 + 1.0).unwrap_err();
    assert!(matches!(error, ConstraintError::StepTooShort { .. }), "{error}");
    assert_eq!(look(&mut method), before);
}
