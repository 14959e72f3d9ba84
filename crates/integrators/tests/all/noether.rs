//! Momenta over 100,000 steps, of every method whose facts promise them.

use std::ops::ControlFlow;
use std::thread;

use stationary_calculus::{Energy, Number};
use stationary_integrators::problems::three_bodies;
use stationary_integrators::{
    Conservation, EnergyBehavior, Evaluation, Facts, Horizon, Integrator, Mechanical, Method,
    Quadrature, Sampled, State, Variational, angular_momentum, angular_momentum_scale,
    linear_momentum, linear_momentum_scale, simulate,
};

const STEPS: u64 = 100_000;

/// The largest drifts of linear and angular momentum relative to the sums of their magnitudes.
fn drifts<const N: usize>(
    integrator: &mut dyn Integrator<[f64; N]>,
    initial: &State<[f64; N]>,
    h: f64,
) -> [f64; 2] {
    let mut state = initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let mut drifts = [0.0_f64; 2];
    let horizon = Horizon::divided(h * STEPS as f64, STEPS).unwrap();
    simulate(integrator, &mut state, horizon, |now| {
        let p = linear_momentum::<2>(now.state);
        let off = (p[0] - linear[0]).hypot(p[1] - linear[1]);
        drifts[0] = drifts[0].max(off / linear_momentum_scale::<2>(now.state));
        let off = (angular_momentum::<2>(now.state)[2] - angular).abs();
        drifts[1] = drifts[1].max(off / angular_momentum_scale::<2>(now.state));
        ControlFlow::Continue(())
    })
    .unwrap();
    drifts
}

/// The drift that rounding may add up to.
fn rounding(facts: Facts) -> f64 {
    match facts.evaluation {
        Evaluation::Explicit => 1e-12,
        Evaluation::Implicit => 1e-11,
    }
}

/// What is not promised may be kept as well, over short steps: that it is not is tested with facts.
fn check(facts: Facts, [linear, angular]: [f64; 2]) {
    for (what, promise, drift) in
        [("linear", facts.linear_momentum, linear), ("angular", facts.angular_momentum, angular)]
    {
        let kept = drift <= rounding(facts);
        assert!(promise != Conservation::Exact || kept, "{}: {what} {drift:e}", facts.name);
    }
}

#[test]
fn every_method_keeps_the_momenta_that_it_promises_over_a_hundred_thousand_steps() {
    let problem = three_bodies().unwrap();
    for &method in Method::ALL {
        // Where energy is not bounded, planets fall or fly away: a short run, with as many steps.
        let bounded = method.facts().energy == EnergyBehavior::Bounded;
        let h = if bounded { 0.01 } else { 1e-4 };
        let mut integrator = method.integrator(&problem.system).unwrap();
        check(method.facts(), drifts(&mut *integrator, &problem.initial, h));
    }
}

/// A sun and two planets, as in the problem of that name.
struct ThreeBodies;

impl Energy<6> for ThreeBodies {
    fn energy<R: Number>(&self, q: [R; 6]) -> R {
        let pair = |i: usize, j: usize, strength: f64| {
            let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
            (x * x + y * y).sqrt().recip() * -strength
        };
        pair(0, 1, 0.02) + pair(0, 2, 0.01) + pair(1, 2, 2e-4)
    }
}

#[test]
fn variational_integrators_keep_them_too() {
    let problem = three_bodies().unwrap();
    let kept = &|quadrature: Quadrature| {
        let masses = [1.0, 1.0, 0.02, 0.02, 0.01, 0.01];
        let lagrangian = Mechanical::new(masses, ThreeBodies).unwrap();
        let mut integrator = Variational::new(Sampled { lagrangian, quadrature }).unwrap();
        let facts = Integrator::<[f64; 6]>::facts(&integrator);
        check(facts, drifts(&mut integrator, &problem.initial, 0.01));
    };
    thread::scope(|scope| {
        for quadrature in Quadrature::ALL {
            scope.spawn(move || kept(quadrature));
        }
    });
}
