//! Every method against every fact that it claims.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, Metric, Potential, System};
use stationary_integrators::problems::{Problem, kepler, oscillator, three_bodies};
use stationary_integrators::{
    Conservation, EnergyBehavior, ErrorGrowth, Evaluation, Horizon, Integrator, Method, State,
    Symplecticity, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale, simulate,
};

type Boxed<'s, C> = Box<dyn Integrator<C> + 's>;

fn on<'s, M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &'s System<M, P>,
) -> Boxed<'s, [f64; N]> {
    method.integrator(system).unwrap()
}

/// The largest error along the trajectory.
fn error<M: Metric, P: Potential, const N: usize>(
    problem: &Problem<M, P, [f64; N]>,
    method: Method,
    duration: f64,
    steps: u64,
) -> f64 {
    let mut state = problem.initial.clone();
    let mut largest = 0.0_f64;
    let horizon = Horizon::divided(duration, steps).unwrap();
    simulate(&mut *on(method, &problem.system), &mut state, horizon, |now| {
        largest = largest.max(problem.error(now.state.t, &now.state.q).unwrap());
        ControlFlow::Continue(())
    })
    .unwrap();
    largest
}

#[test]
fn implicit_methods_factor_hessians_and_explicit_ones_do_not() {
    let problem = kepler(0.3).unwrap();
    for &method in Method::ALL {
        let mut state = problem.initial.clone();
        let report = on(method, &problem.system).step(&mut state, 0.1).unwrap();
        let implicit = method.facts().evaluation == Evaluation::Implicit;
        assert_eq!(report.hessians > 0, implicit, "{method}");
        assert!(!report.suspects_the_hessian(), "{method} took {} iterations", report.hessians);
    }
}

#[test]
fn symmetric_methods_return_when_the_momentum_is_reversed() {
    let problem = kepler(0.3).unwrap();
    for &method in Method::ALL {
        let mut integrator = on(method, &problem.system);
        let mut state = State::new([0.4, -0.7], Covector([0.9, 0.5]));
        let start = state.clone();
        integrator.step(&mut state, 0.1).unwrap();
        state.p = Covector(state.p.0.map(|p| -p));
        integrator.step(&mut state, 0.1).unwrap();
        let back = State::new(state.q, Covector(state.p.0.map(|p| -p)));
        let miss = (0..2)
            .map(|i| (back.q[i] - start.q[i]).abs() + (back.p.0[i] - start.p.0[i]).abs())
            .sum::<f64>();
        assert_eq!(miss < 1e-14, method.facts().symmetric, "{method} misses by {miss:e}");
    }
}

/// How far the derivative D of a step is from preserving the symplectic form: `|D^T J D - J|`.
fn symplectic_defect(method: Method, h: f64) -> f64 {
    let problem = kepler(0.3).unwrap();
    let mut integrator = on(method, &problem.system);
    let at = [0.4, -0.7, 0.9, 0.5];
    let mut map = |y: [f64; 4]| -> [f64; 4] {
        let mut state = State::new([y[0], y[1]], Covector([y[2], y[3]]));
        integrator.step(&mut state, h).unwrap();
        [state.q[0], state.q[1], state.p.0[0], state.p.0[1]]
    };
    let mut d = [[0.0; 4]; 4];
    for (j, column) in d.iter_mut().enumerate() {
        let mut moved = |by: f64| {
            let mut y = at;
            y[j] += by;
            map(y)
        };
        let e = 1e-3;
        let (a, b) = (moved(e), moved(-e));
        let (c, f) = (moved(2.0 * e), moved(-2.0 * e));
        for i in 0..4 {
            column[i] = (8.0 * (a[i] - b[i]) - (c[i] - f[i])) / (12.0 * e);
        }
    }
    let form = |x: &[f64; 4], y: &[f64; 4]| x[0] * y[2] + x[1] * y[3] - x[2] * y[0] - x[3] * y[1];
    let unit = |j: usize| std::array::from_fn::<f64, 4, _>(|i| f64::from(u8::from(i == j)));
    let mut defect = 0.0_f64;
    for i in 0..4 {
        for j in 0..4 {
            defect = defect.max((form(&d[i], &d[j]) - form(&unit(i), &unit(j))).abs());
        }
    }
    defect
}

#[test]
fn symplectic_methods_preserve_the_symplectic_form_and_no_others_do() {
    for &method in Method::ALL {
        let defect = symplectic_defect(method, 0.3);
        let symplectic = method.facts().symplecticity == Symplecticity::Symplectic;
        assert_eq!(defect < 1e-9, symplectic, "{method}: {defect:e}");
    }
}

#[test]
fn the_trapezoid_rule_is_the_midpoint_rule_seen_half_an_explicit_step_away() {
    let problem = kepler(0.3).unwrap();
    let h = 0.2;
    let mut state = State::new([0.4, -0.7], Covector([0.9, 0.5]));
    let explicit = |state: &State<[f64; 2]>| {
        let mut moved = state.clone();
        on(Method::ExplicitEuler, &problem.system).step(&mut moved, 0.5 * h).unwrap();
        moved
    };
    let mut middle = explicit(&state);
    let (mut trapezoid, mut midpoint) =
        (on(Method::Trapezoid, &problem.system), on(Method::ImplicitMidpoint, &problem.system));
    for _ in 0..100 {
        trapezoid.step(&mut state, h).unwrap();
        midpoint.step(&mut middle, h).unwrap();
        let expected = explicit(&state);
        for i in 0..2 {
            assert!((expected.q[i] - middle.q[i]).abs() < 1e-11);
            assert!((expected.p.0[i] - middle.p.0[i]).abs() < 1e-11);
        }
    }
}

/// The largest drift of linear and angular momentum, relative to the sums of magnitudes.
fn momentum_drift(method: Method, h: f64, steps: u64) -> (f64, f64) {
    let problem = three_bodies().unwrap();
    let mut state = problem.initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let mut drift = (0.0_f64, 0.0_f64);
    let horizon = Horizon::divided(h * steps as f64, steps).unwrap();
    simulate(&mut *on(method, &problem.system), &mut state, horizon, |now| {
        let p = linear_momentum::<2>(now.state);
        let off = (p[0] - linear[0]).hypot(p[1] - linear[1]);
        drift.0 = drift.0.max(off / linear_momentum_scale::<2>(now.state));
        let off = (angular_momentum::<2>(now.state)[2] - angular).abs();
        drift.1 = drift.1.max(off / angular_momentum_scale::<2>(now.state));
        ControlFlow::Continue(())
    })
    .unwrap();
    drift
}

#[test]
fn momenta_are_kept_where_the_facts_say_so_and_nowhere_else() {
    for &method in Method::ALL {
        // Half a turn: later on implicit Euler drops the inner planet into the sun.
        let (linear, angular) = momentum_drift(method, 0.01, 300);
        assert_eq!(method.facts().linear_momentum, Conservation::Exact);
        assert!(linear < 1e-13, "{method}: linear momentum drifts by {linear:e}");
        let exact = method.facts().angular_momentum == Conservation::Exact;
        assert_eq!(angular < 1e-12, exact, "{method}: angular momentum drifts by {angular:e}");
    }
}

#[test]
fn the_trapezoid_rule_keeps_angular_momentum_for_linear_forces() {
    use stationary_integrators::problems::Linear;
    let metric = DiagonalMetric::new([2.0, 2.0]).unwrap();
    let system = System::new(metric, Linear::<2> { stiffness: 3.0 }).unwrap();
    let mut state = State::new([1.0, 0.2], Covector([-0.3, 0.9]));
    let mut trapezoid = on(Method::Trapezoid, &system);
    let start = angular_momentum::<2>(&state)[2];
    for _ in 0..1000 {
        trapezoid.step(&mut state, 0.3).unwrap();
        assert!((angular_momentum::<2>(&state)[2] - start).abs() < 1e-13);
    }
}

#[test]
fn the_trapezoid_rule_keeps_angular_momentum_after_half_an_explicit_step() {
    let problem = kepler(0.6).unwrap();
    let h = 0.02;
    let mut state = problem.initial.clone();
    let mut trapezoid = on(Method::Trapezoid, &problem.system);
    let moved = |state: &State<[f64; 2]>| {
        let mut moved = state.clone();
        on(Method::ExplicitEuler, &problem.system).step(&mut moved, 0.5 * h).unwrap();
        angular_momentum::<2>(&moved)[2]
    };
    let (bare, half) = (angular_momentum::<2>(&state)[2], moved(&state));
    let (mut bare_drift, mut half_drift) = (0.0_f64, 0.0_f64);
    for _ in 0..2000 {
        trapezoid.step(&mut state, h).unwrap();
        bare_drift = bare_drift.max((angular_momentum::<2>(&state)[2] - bare).abs());
        half_drift = half_drift.max((moved(&state) - half).abs());
    }
    assert!(bare_drift > 1e-5 && half_drift < 1e-12, "{bare_drift:e} {half_drift:e}");
}

/// Energy of an oscillator relative to its start, at the end of many periods.
fn energy_left(method: Method) -> f64 {
    let problem = oscillator(1.0).unwrap();
    let mut state = problem.initial.clone();
    let horizon = Horizon::divided(100.0 * TAU, 6400).unwrap();
    let mut integrator = on(method, &problem.system);
    simulate(&mut *integrator, &mut state, horizon, |_| ControlFlow::Continue(())).unwrap();
    problem.energy(&state) / problem.energy(&problem.initial)
}

#[test]
fn energy_behaves_as_the_facts_say() {
    for &method in Method::ALL {
        let left = energy_left(method);
        let holds = match method.facts().energy {
            EnergyBehavior::Bounded => (left - 1.0).abs() < 0.1,
            EnergyBehavior::Grows => left > 10.0,
            EnergyBehavior::Decays => left < 1.0 - 1e-8,
        };
        assert!(holds, "{method}: {left}");
    }
}

#[test]
fn the_error_of_an_oscillator_grows_as_the_facts_say() {
    let problem = oscillator(1.0).unwrap();
    for &method in Method::ALL {
        // High orders need long steps for their drift to outgrow rounding.
        let each = [0, 200, 200, 0, 50, 0, 16, 0, 10][method.facts().order as usize];
        let after = |periods: u64| error(&problem, method, TAU * periods as f64, each * periods);
        match method.facts().error_growth {
            ErrorGrowth::Linear => {
                // Long enough for the drift to outgrow the bounded part of the error.
                let periods = if method.facts().order > 2 { 1600 } else { 400 };
                let power = (after(4 * periods) / after(periods)).log2() / 2.0;
                assert!((power - 1.0).abs() < 0.1, "{method}: t^{power}");
            }
            ErrorGrowth::Exponential => {
                // exp(h omega^2 t / 2), which is the error once it has outgrown the motion.
                let (h, t) = (TAU / 200.0, TAU * 40.0);
                let rate = (after(40) + 1.0).ln() / (0.5 * h * t);
                assert!((rate - 1.0).abs() < 0.01, "{method}: exp({rate} h t/2)");
            }
            ErrorGrowth::Saturates => {
                let size = after(400);
                assert!(size > 0.99 && size < 1.001, "{method}: {size}");
            }
        }
    }
}
