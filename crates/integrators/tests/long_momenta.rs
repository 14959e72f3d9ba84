//! Linear and angular momentum over 100,000 steps, for every method whose facts promise them.

use std::ops::ControlFlow;

use stationary_integrators::problems::three_bodies;
use stationary_integrators::{
    Conservation, Evaluation, Horizon, Method, angular_momentum, angular_momentum_scale,
    linear_momentum, linear_momentum_scale, simulate,
};

/// The largest drifts, relative to `sum |p_i|` and `sum |q_i| |p_i|`, and the steps taken.
fn drifts(method: Method, h: f64, steps: u64) -> (f64, f64, u64) {
    let problem = three_bodies().unwrap();
    let mut state = problem.initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let (mut off, mut turned) = (0.0_f64, 0.0_f64);
    let horizon = Horizon::divided(h * steps as f64, steps).unwrap();
    let mut integrator = method.integrator(&problem.system).unwrap();
    let cost = simulate(&mut *integrator, &mut state, horizon, |now| {
        let p = linear_momentum::<2>(now.state);
        let distance = (p[0] - linear[0]).hypot(p[1] - linear[1]);
        off = off.max(distance / linear_momentum_scale::<2>(now.state));
        let distance = (angular_momentum::<2>(now.state)[2] - angular).abs();
        turned = turned.max(distance / angular_momentum_scale::<2>(now.state));
        ControlFlow::Continue(())
    })
    .unwrap();
    (off, turned, cost.steps)
}

#[test]
fn momenta_that_are_promised_drift_by_rounding_alone_over_100_000_steps() {
    for &method in Method::ALL {
        let facts = method.facts();
        if facts.angular_momentum != Conservation::Exact {
            continue;
        }
        let bound = if facts.evaluation == Evaluation::Explicit { 1e-12 } else { 1e-11 };
        let (linear, angular, steps) = drifts(method, 0.02, 100_000);
        assert_eq!(steps, 100_000);
        assert!(linear < bound && angular < bound, "{method}: {linear:e} {angular:e}");
    }
}
