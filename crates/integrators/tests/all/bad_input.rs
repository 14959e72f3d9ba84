//! What bad input gets: an error that names it, and a state that is as it was.

use std::ops::ControlFlow;

use stationary_calculus::{
    Covector, DenseSolver, DiagonalMetric, Metric, Newton, NewtonFailure, Potential, Sink,
    SizeError, System,
};
use stationary_integrators::problems::{
    ProblemError, fermi_pasta_ulam, henon_heiles, kepler, oscillator, pendulum, spring_chain,
    spring_pendulum,
};
use stationary_integrators::{
    CentralGravity, Evaluation, GaussLegendre, Horizon, Imex, ImplicitEuler, ImplicitMidpoint,
    Integrator, Method, Newmark, NewmarkWeights, NewtonianGravity, Nodes, State, StepError,
    Trapezoid, simulate,
};

/// What a method says to one step, which must leave the state as it was.
fn refused<M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &System<M, P>,
    state: &State<[f64; N]>,
    h: f64,
) -> StepError {
    let bits = |state: &State<[f64; N]>| {
        (state.t.to_bits(), state.q.map(f64::to_bits), state.p.0.map(f64::to_bits))
    };
    let mut after = state.clone();
    let error = method.integrator(system).unwrap().step(&mut after, h).unwrap_err();
    assert_eq!(bits(&after), bits(state), "{method} changed the state");
    error
}

#[test]
fn a_step_that_is_not_positive_and_finite_is_refused() {
    let problem = kepler(0.6).unwrap();
    for &method in Method::ALL {
        for h in [0.0, -0.1, f64::INFINITY, f64::NEG_INFINITY] {
            let error = refused(method, &problem.system, &problem.initial, h);
            assert_eq!(error, StepError::Step(h), "{method}");
        }
        let error = refused(method, &problem.system, &problem.initial, f64::NAN);
        assert!(matches!(error, StepError::Step(h) if h.is_nan()), "{method}");
    }
}

#[test]
fn a_step_that_starts_or_ends_at_no_time_is_refused_with_that_time() {
    let problem = kepler(0.6).unwrap();
    for &method in Method::ALL {
        for (t, h) in [(f64::INFINITY, 0.1), (f64::NEG_INFINITY, 0.1), (f64::NAN, 0.1)] {
            let state = State { t, ..problem.initial.clone() };
            let error = refused(method, &problem.system, &state, h);
            let StepError::Time(time) = error else { panic!("{method} at {t}: {error}") };
            assert!(time == t || time.is_nan() && t.is_nan(), "{method}: {error}");
        }
    }
    // No force: however long the step, the place is a number.
    let metric = DiagonalMetric::new([1.0; 2]).unwrap();
    let free = System::new(metric, CentralGravity::<2> { strength: 0.0 }).unwrap();
    let state = State { t: f64::MAX, ..State::new([1.0, 0.0], Covector([0.0; 2])) };
    let error = refused(Method::SymplecticEulerDriftKick, &free, &state, 1e308);
    assert_eq!(error, StepError::Time(f64::INFINITY));
}

#[test]
fn a_solver_of_another_size_is_refused_when_the_method_is_made() {
    let metric = DiagonalMetric::new(vec![1.0; 2]).unwrap();
    let system = System::new(metric, CentralGravity::<2> { strength: 1.0 }).unwrap();
    let solver = || DenseSolver::<Vec<f64>>::new(3).unwrap();
    let expected = SizeError { what: "the solver's freedoms", expected: 2, got: 3 };
    let weights = NewmarkWeights::generalized_alpha(0.5).unwrap();
    let soft = CentralGravity::<2> { strength: 0.1 };
    type V = Vec<f64>;
    let refusals = [
        ImplicitEuler::<_, _, V, _>::with_solver(&system, solver()).err(),
        Trapezoid::<_, _, V, _>::with_solver(&system, solver()).err(),
        ImplicitMidpoint::<_, _, V, _>::with_solver(&system, solver()).err(),
        GaussLegendre::<_, _, V, _>::with_solver(&system, Nodes::Two, solver()).err(),
        Newmark::<_, _, V, (), _>::with_solver(&system, weights, solver()).err(),
        Imex::<_, _, _, V, _>::with_solver(&system, soft, solver()).err(),
    ];
    for refusal in refusals {
        assert_eq!(refusal, Some(expected));
    }
}

#[test]
fn initial_data_that_are_not_finite_are_named() {
    let problem = kepler(0.6).unwrap();
    for &method in Method::ALL {
        for bad in [f64::NAN, f64::INFINITY] {
            let state = State::new([0.4, bad], Covector([0.0, 2.0]));
            let error = refused(method, &problem.system, &state, 0.1);
            let named = match &error {
                StepError::NonFiniteConfiguration { .. } | StepError::NonFiniteMomentum { .. } => {
                    true
                }
                StepError::Newton(error) => {
                    matches!(error.failure, NewtonFailure::NonFinite(_))
                }
                _ => false,
            };
            assert!(named, "{method}: {error}");
        }
    }
}

#[test]
fn particles_that_meet_under_gravity_are_an_error_and_not_a_nan() {
    let gravity =
        NewtonianGravity::<2> { constant: 1.0, masses: vec![1.0, 2.0], fixed: Vec::new() };
    let system = System::new(DiagonalMetric::new([1.0, 1.0, 2.0, 2.0]).unwrap(), gravity).unwrap();
    let state = State::new([0.5, 0.5, 0.5, 0.5], Covector([0.0; 4]));
    for &method in Method::ALL {
        let error = refused(method, &system, &state, 0.1);
        assert!(!matches!(error, StepError::Step(_) | StepError::Size(_)), "{method}: {error}");
    }
}

#[test]
fn sizes_that_do_not_match_are_named() {
    let problem = kepler(0.6).unwrap();
    let metric = DiagonalMetric::new([1.0; 3]).unwrap();
    let error = System::new(metric, *problem.system.potential()).unwrap_err();
    assert_eq!(error, SizeError { what: "the potential's freedoms", expected: 3, got: 2 });
    for &method in Method::ALL {
        let storage = method.integrator::<_, _, [f64; 3]>(&problem.system);
        assert!(matches!(storage, Err(SizeError { expected: 2, got: 3, .. })), "{method}");
        let mut state = State::new(vec![1.0, 0.0, 0.0], Covector(vec![0.0; 3]));
        let error = method.integrator(&problem.system).unwrap().step(&mut state, 0.1).unwrap_err();
        assert!(matches!(error, StepError::Size(SizeError { expected: 2, got: 3, .. })));
    }
}

#[test]
fn problems_with_impossible_parameters_are_refused() {
    let parameter = |result: Result<(), ProblemError>| {
        assert!(matches!(result, Err(ProblemError::Parameter { .. })), "{result:?}");
    };
    for e in [-0.1, 1.0, f64::NAN] {
        parameter(kepler(e).map(drop));
    }
    for theta in [0.0, 3.2, f64::NAN] {
        parameter(pendulum(theta).map(drop));
    }
    for k in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        parameter(oscillator(k).map(drop));
        parameter(spring_pendulum(k).map(drop));
        parameter(spring_chain(5, k).map(drop));
        parameter(fermi_pasta_ulam(k).map(drop));
    }
    for masses in [0, 1, usize::MAX] {
        parameter(spring_chain(masses, 1.0).map(drop));
    }
    for energy in [0.0, 1.0 / 6.0, f64::NAN] {
        parameter(henon_heiles(energy).map(drop));
    }
}

/// A potential that falls off ever faster: no implicit step has a solution for large h.
struct Cliff;

impl Potential for Cliff {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        -q[0].exp()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] -= q[0].exp();
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[-q[0].exp()]);
    }
}

#[test]
fn an_implicit_step_without_a_solution_ends_and_says_so() {
    let system = System::new(DiagonalMetric::new([1.0]).unwrap(), Cliff).unwrap();
    let state = State::new([0.0], Covector([1.0]));
    for &method in Method::ALL {
        if method.facts().evaluation == Evaluation::Implicit {
            let error = refused(method, &system, &state, 10.0);
            assert!(matches!(error, StepError::Newton(_)), "{method}: {error}");
        }
    }
}

#[test]
fn too_few_newton_iterations_are_reported_with_their_residuals() {
    let problem = pendulum(2.0).unwrap();
    let newton = Newton { tolerance: 0.0, iterations: 1 };
    let method = ImplicitEuler::new(&problem.system).unwrap().with_newton(newton);
    let mut state = problem.initial.clone();
    let error = method.unwrap().step(&mut state, 2.0).unwrap_err();
    let StepError::Newton(error) = error else { panic!("{error}") };
    assert_eq!(error.failure, NewtonFailure::NotConverged);
    assert_eq!(error.history.len(), 2);
    assert_eq!(state, problem.initial);
}

#[test]
fn a_simulation_that_fails_names_the_step_and_the_time_and_keeps_the_last_good_state() {
    // Explicit Euler doubles the amplitude of this oscillator some 500 times before it overflows.
    let problem = oscillator(1.0).unwrap();
    let mut method = Method::ExplicitEuler.integrator(&problem.system).unwrap();
    let mut state = problem.initial.clone();
    let mut last = state.clone();
    let horizon = Horizon::new(1e6, 10.0).unwrap();
    let error = simulate(&mut *method, &mut state, horizon, |now| {
        last = now.state.clone();
        ControlFlow::Continue(())
    })
    .unwrap_err();
    assert!((300..320).contains(&error.step), "{error}");
    assert_eq!(error.time, (error.step - 1) as f64 * 10.0);
    assert_eq!(state, last);
}

#[test]
fn the_implicit_midpoint_rule_fails_on_a_swinging_stiff_spring() {
    // On the linear spring the rule is stable at every step. Here the border lies at h omega = 21,
    // far above the step where the spring is resolved.
    let problem = spring_pendulum(1e4).unwrap();
    let worst = |h_omega: f64| {
        let mut midpoint = ImplicitMidpoint::new(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        let start = problem.energy(&state);
        let mut worst = 0.0_f64;
        for _ in 0..200 {
            midpoint.step(&mut state, h_omega / 100.0).unwrap();
            worst = worst.max((problem.energy(&state) - start).abs());
        }
        worst
    };
    assert!(worst(1.0) < 1e-4 && worst(20.0) < 1.0);
    assert!(worst(22.0) > 1e4 && worst(30.0) > 1e4);
}
