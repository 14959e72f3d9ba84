//! Linear and angular momentum over 100,000 steps, for every method whose facts promise them.

use std::ops::ControlFlow;

use stationary_calculus::{
    Covector, DiagonalMetric, Metric, Potential, Sink, System, assert_derivatives,
};
use stationary_integrators::problems::three_bodies;
use stationary_integrators::{
    Conservation, Evaluation, Facts, Horizon, Method, State, Symplecticity, angular_momentum,
    angular_momentum_scale, linear_momentum, linear_momentum_scale, simulate,
};

const STEPS: u64 = 100_000;

/// The largest drifts of the linear and of the angular momentum, relative to `sum |p_i|` and
/// `sum |q_i| |p_i|`.
fn drifts<M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &System<M, P>,
    initial: &State<[f64; N]>,
    h: f64,
) -> (f64, f64) {
    let mut state = initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let (mut off, mut turned) = (0.0_f64, 0.0_f64);
    let horizon = Horizon::divided(h * STEPS as f64, STEPS).unwrap();
    let mut integrator = method.integrator(system).unwrap();
    let cost = simulate(&mut *integrator, &mut state, horizon, |now| {
        let p = linear_momentum::<2>(now.state);
        let distance = (p[0] - linear[0]).hypot(p[1] - linear[1]);
        off = off.max(distance / linear_momentum_scale::<2>(now.state));
        let distance = (angular_momentum::<2>(now.state)[2] - angular).abs();
        turned = turned.max(distance / angular_momentum_scale::<2>(now.state));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(cost.steps, STEPS);
    (off, turned)
}

/// How far rounding may carry a momentum that is kept. Implicit steps leave a residual as well.
fn rounding(facts: Facts) -> f64 {
    if facts.evaluation == Evaluation::Explicit { 1e-12 } else { 1e-11 }
}

#[test]
fn momenta_that_are_promised_drift_by_rounding_alone_over_100_000_steps() {
    let problem = three_bodies().unwrap();
    for &method in Method::ALL {
        let facts = method.facts();
        if facts.angular_momentum != Conservation::Exact {
            continue;
        }
        for h in [0.005, 0.02] {
            let (linear, angular) = drifts(method, &problem.system, &problem.initial, h);
            let kept = linear < rounding(facts) && angular < rounding(facts);
            assert!(kept, "{method}: {linear:e} {angular:e}");
        }
    }
}

#[test]
fn linear_momentum_drifts_by_rounding_alone_where_angular_momentum_is_not_promised() {
    let bodies = three_bodies().unwrap();
    // Other methods than these throw three bodies out, or drop them into the sun.
    let lasts = |facts: Facts| facts.symplecticity != Symplecticity::No;
    let metric = DiagonalMetric::new([1.0, 1.0, 2.0, 2.0]).unwrap();
    let spring = System::new(metric, WideSpring { k: 0.5 }).unwrap();
    let initial = State::new([0.0, 0.0, 3.1, 0.2], Covector([0.2, -0.5, 0.1, 0.9]));
    assert_derivatives(spring.potential(), &initial.q);
    for &method in Method::ALL {
        let facts = method.facts();
        let promises = [facts.linear_momentum, facts.angular_momentum];
        let [linear, angular] = promises.map(|promise| promise == Conservation::Exact);
        if !linear || angular {
            continue;
        }
        let (drift, _) = match lasts(facts) {
            true => drifts(method, &bodies.system, &bodies.initial, 0.005),
            false => drifts(method, &spring, &initial, 0.005),
        };
        assert!(drift < rounding(facts), "{method}: {drift:e}");
    }
}

/// A spring of stiffness k and length 3 between two particles in the plane:
/// `V = k/2 (|q_2 - q_1| - 3)^2`.
struct WideSpring {
    k: f64,
}

impl WideSpring {
    const LENGTH: f64 = 3.0;

    /// From the first to the second particle, and how far that is.
    fn apart(q: &[f64]) -> ([f64; 2], f64) {
        let d = [q[2] - q[0], q[3] - q[1]];
        (d, d[0].hypot(d[1]))
    }
}

impl Potential for WideSpring {
    fn dim(&self) -> usize {
        4
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * self.k * (Self::apart(q).1 - Self::LENGTH).powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let (d, length) = Self::apart(q);
        let [first, second] = dv.0.as_chunks_mut::<2>().0 else { return };
        for c in 0..2 {
            let part = self.k * (1.0 - Self::LENGTH / length) * d[c];
            first[c] -= part;
            second[c] += part;
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let (d, length) = Self::apart(q);
        let across = 1.0 - Self::LENGTH / length;
        let along = Self::LENGTH / length.powi(3);
        let block: [[f64; 4]; 4] = std::array::from_fn(|j| {
            std::array::from_fn(|i| {
                let same = if i % 2 == j % 2 { across } else { 0.0 };
                let sign = if i / 2 == j / 2 { self.k } else { -self.k };
                sign * (same + along * d[i % 2] * d[j % 2])
            })
        });
        hessian.add_symmetric(&[0, 1, 2, 3], block.as_flattened());
    }
}
