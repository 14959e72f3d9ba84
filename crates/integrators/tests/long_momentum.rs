//! Momenta over a hundred thousand steps: what Noether's theorem promises, kept to rounding.
//!
//! ```text
//! |P - P_0| / sum |p_i|            linear
//! |L - L_0| / sum |q_i| |p_i|      angular, about the origin
//! ```
//! Explicit steps round a few sums; implicit ones also leave the residual of a solve that stagnated.

use stationary_calculus::{
    Covector, DiagonalMetric, Metric, Potential, Sink, System, assert_derivatives,
};
use stationary_integrators::problems::three_bodies;
use stationary_integrators::{
    Conservation, Evaluation, Method, State, Symplecticity, angular_momentum,
    angular_momentum_scale, linear_momentum, linear_momentum_scale,
};

const STEPS: u32 = 100_000;
const H: f64 = 0.005;

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

/// The largest relative drift of the linear and of the angular momentum on the way.
fn drifts<M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &System<M, P>,
    initial: &State<[f64; N]>,
) -> [f64; 2] {
    let mut integrator = method.integrator(system).unwrap();
    let mut state = initial.clone();
    let [px, py] = linear_momentum::<2>(&state);
    let [_, _, l] = angular_momentum::<2>(&state);
    let mut largest = [0.0_f64; 2];
    for _ in 0..STEPS {
        integrator.step(&mut state, H).unwrap();
        let [x, y] = linear_momentum::<2>(&state);
        let linear = (x - px).hypot(y - py) / linear_momentum_scale::<2>(&state);
        let angular = angular_momentum::<2>(&state)[2] - l;
        let angular = angular.abs() / angular_momentum_scale::<2>(&state);
        largest = [largest[0].max(linear), largest[1].max(angular)];
    }
    largest
}

/// A momentum that the method promises to keep drifts by no more than rounding.
fn assert_kept_as_promised<M: Metric, P: Potential, const N: usize>(
    method: Method,
    system: &System<M, P>,
    initial: &State<[f64; N]>,
) {
    let facts = method.facts();
    let rounding = match facts.evaluation {
        Evaluation::Explicit => 1e-12,
        Evaluation::Implicit => 1e-11,
    };
    let drifts = drifts(method, system, initial);
    for (drift, promise) in drifts.iter().zip([facts.linear_momentum, facts.angular_momentum]) {
        let kept = *drift <= rounding;
        assert!(kept || promise != Conservation::Exact, "{method}: {drifts:?}");
    }
}

fn lasts_on_three_bodies(method: Method) -> bool {
    method.facts().symplecticity != Symplecticity::No
}

#[test]
fn symplectic_methods_and_their_conjugates_keep_the_momenta_of_three_bodies_as_promised() {
    let problem = three_bodies().unwrap();
    for &method in Method::ALL {
        if lasts_on_three_bodies(method) {
            assert_kept_as_promised(method, &problem.system, &problem.initial);
        }
    }
}

#[test]
fn the_other_methods_keep_the_momenta_of_two_bodies_on_a_wide_spring_as_promised() {
    // Explicit Euler throws three bodies out, implicit Euler drops them into the sun.
    let metric = DiagonalMetric::new([1.0, 1.0, 2.0, 2.0]).unwrap();
    let system = System::new(metric, WideSpring { k: 0.5 }).unwrap();
    let initial = State::new([0.0, 0.0, 3.1, 0.2], [0.2, -0.5, 0.1, 0.9]);
    assert_derivatives(system.potential(), &initial.q);
    for &method in Method::ALL {
        if !lasts_on_three_bodies(method) {
            assert_kept_as_promised(method, &system, &initial);
        }
    }
}
