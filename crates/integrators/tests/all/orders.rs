//! The order that every method claims, as the slope of its largest error along a trajectory.

use stationary_calculus::{Covector, Metric, Potential};
use stationary_integrators::problems::{Problem, kepler, pendulum};
use stationary_integrators::{Convergence, Evaluation, Horizon, Method, Scheme, State, deliver};
use stationary_measure::{loglog_slope, truncation_regime};

/// The slope over at least four halvings in which the error obeys one power law.
fn over_halvings<M: Metric, P: Potential, const N: usize>(
    problem: &Problem<M, P, [f64; N]>,
    method: Method,
) -> f64 {
    let finest = if method.facts().order == 1 { 15 } else { 12 };
    let steps = (3..=finest).map(|k| 1_u64 << k);
    let errors = Convergence::measure(problem, method, steps).unwrap().errors();
    let regime = truncation_regime(&errors);
    assert!(regime.len() >= 5, "{method}: {errors:?}");
    loglog_slope(regime).unwrap()
}

/// The slope over three decades of error, in steps that grow by 2^(1/4).
fn over_decades<M: Metric, P: Potential, const N: usize>(
    problem: &Problem<M, P, [f64; N]>,
    method: Method,
) -> f64 {
    let mut points = Vec::new();
    for quarter in 12..60 {
        let steps = 2_f64.powf(f64::from(quarter) / 4.0).round() as u64;
        let horizon = Horizon::divided(problem.horizon, steps).unwrap();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let Ok(run) = deliver(problem, &mut *integrator, horizon) else { continue };
        let error = run.error.unwrap();
        if (1e-12..1e-9).contains(&error) {
            points.push((horizon.step(), error));
        }
    }
    assert!(points.len() >= 4, "{method}: {points:?}");
    loglog_slope(&points).unwrap()
}

#[test]
fn the_error_at_a_fixed_end_time_has_the_claimed_order() {
    let mut swing = pendulum(2.0).unwrap();
    swing.horizon = 0.8 * swing.period;
    let mut orbit = kepler(0.3).unwrap();
    orbit.horizon = 0.5 * orbit.period;
    for &method in Method::ALL {
        let order = method.facts().order;
        let (measured, band) = if order <= 4 {
            ([over_halvings(&swing, method), over_halvings(&orbit, method)], 0.1)
        } else {
            ([over_decades(&swing, method), over_decades(&orbit, method)], 0.3)
        };
        for slope in measured {
            assert!((slope - f64::from(order)).abs() < band, "{method}: {measured:?}");
        }
    }
}

#[test]
fn one_step_has_one_order_more() {
    let problem = kepler(0.3).unwrap();
    for &method in Method::ALL {
        // From a quarter of the orbit on, where no symmetry hides a term.
        let start = State::new([0.4, -0.7], Covector([0.9, 0.5]));
        let after = |method: Method, h: f64, steps: u32| {
            let mut state = start.clone();
            let mut integrator = method.integrator(&problem.system).unwrap();
            for _ in 0..steps {
                integrator.step(&mut state, h / f64::from(steps)).unwrap();
            }
            state
        };
        let one = |h: f64| {
            let (state, exact) =
                (after(method, h, 1), after(Method::Composition(Scheme::KahanLi8), h, 64));
            let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            apart(&state.q, &exact.q).hypot(apart(&state.p.0, &exact.p.0))
        };
        // High orders need steps long enough for their error to stand out from rounding.
        let h = [0.02, 0.02, 0.02, 0.02, 0.04, 0.0, 0.12, 0.0, 0.25][method.facts().order as usize];
        let measured = (one(h) / one(0.5 * h)).log2();
        // The first step of generalized alpha takes an acceleration from a third of a step too
        // late.
        let late = method == Method::GeneralizedAlpha;
        let expected = f64::from(method.facts().order) + if late { 0.0 } else { 1.0 };
        assert!((measured - expected).abs() < 0.3, "{method}: {measured}");
    }
}

#[test]
fn a_step_evaluates_the_force_as_often_as_the_facts_say() {
    let problem = kepler(0.3).unwrap();
    for &method in Method::ALL {
        let facts = method.facts();
        if facts.evaluation == Evaluation::Implicit {
            continue;
        }
        let mut state = problem.initial.clone();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let first = integrator.step(&mut state, 0.1).unwrap().differentials;
        let second = integrator.step(&mut state, 0.1).unwrap().differentials;
        assert!(first == facts.stages || first == facts.stages + 1, "{method}: {first}");
        assert_eq!(second, facts.stages, "{method}");
    }
}
