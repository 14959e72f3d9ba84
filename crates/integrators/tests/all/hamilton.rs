//! What the discrete Hamilton principle promises, measured.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, Energy, Number, Vector};
use stationary_integrators::problems::{DoublePendulum, kepler, pendulum};
use stationary_integrators::{
    DiscreteLagrangian, EulerLagrange, Integrator, Lagrangian, Method, Quadrature, Sampled,
    Stability, State, StepError, Symplecticity, Trapezoid, VARIATIONAL, Variational,
};

use crate::discrete_lagrangians::{Spring, Sun, sampled};

/// A unit pendulum: V = -cos theta.
#[derive(Clone, Copy, Debug)]
struct Rod;

impl Energy<1> for Rod {
    fn energy<R: Number>(&self, [theta]: [R; 1]) -> R {
        -theta.cos()
    }
}

/// The method that each quadrature is said to reproduce.
const TWINS: [(Quadrature, Method); 4] = [
    (Quadrature::End, Method::SymplecticEulerDriftKick),
    (Quadrature::Start, Method::SymplecticEulerKickDrift),
    (Quadrature::Middle, Method::ImplicitMidpoint),
    (Quadrature::Ends, Method::StormerVerlet),
];

fn apart<const N: usize>(a: &State<[f64; N]>, b: &State<[f64; N]>) -> f64 {
    let of = |a: &[f64; N], b: &[f64; N]| {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    of(&a.q, &b.q).max(of(&a.p.0, &b.p.0))
}

/// The largest distance of two integrators over 1,000 steps.
fn largest_distance<const N: usize>(
    initial: &State<[f64; N]>,
    h: f64,
    one: &mut dyn Integrator<[f64; N]>,
    other: &mut dyn Integrator<[f64; N]>,
) -> f64 {
    let (mut a, mut b) = (initial.clone(), initial.clone());
    let mut largest = 0.0_f64;
    for _ in 0..1000 {
        one.step(&mut a, h).unwrap();
        other.step(&mut b, h).unwrap();
        largest = largest.max(apart(&a, &b));
    }
    largest
}

#[test]
fn each_quadrature_reproduces_its_method_over_a_thousand_steps() {
    let (pendulum, kepler) = (pendulum(2.0).unwrap(), kepler(0.3).unwrap());
    for (quadrature, method) in TWINS {
        // One period: over eight orbits one unit in the last place of q grows to 7e-13 by itself.
        let mut twin = method.integrator(&pendulum.system).unwrap();
        let mut ours = Variational::new(sampled(Rod, quadrature)).unwrap();
        let h = pendulum.period / 1000.0;
        let off = largest_distance(&pendulum.initial, h, &mut ours, &mut *twin);
        assert!(off < 1e-12, "{method} on the pendulum: {off:e}");
        let mut twin = method.integrator(&kepler.system).unwrap();
        let mut ours = Variational::new(sampled(Sun, quadrature)).unwrap();
        let off = largest_distance(&kepler.initial, TAU / 1000.0, &mut ours, &mut *twin);
        assert!(off < 1e-12, "{method} on Kepler: {off:e}");
    }
}

#[test]
fn no_quadrature_reproduces_the_trapezoid_rule() {
    // Errata chapter 5: the mean of both ends is Stormer-Verlet; the trapezoid rule is not even
    // symplectic, only conjugate to the midpoint rule.
    let pendulum = pendulum(2.0).unwrap();
    for quadrature in Quadrature::ALL {
        let mut trapezoid = Trapezoid::new(&pendulum.system).unwrap();
        let mut ours = Variational::new(sampled(Rod, quadrature)).unwrap();
        let h = pendulum.period / 1000.0;
        let off = largest_distance(&pendulum.initial, h, &mut ours, &mut trapezoid);
        assert!(off > 1e-6, "{quadrature:?}: {off:e}");
    }
}

/// The largest error of an oscillator's configuration over a period.
fn error_on_the_oscillator(quadrature: Quadrature, steps: u32) -> f64 {
    let mut state = State::new([1.0], Covector([0.0]));
    let mut integrator = Variational::new(sampled(Spring, quadrature)).unwrap();
    let h = TAU / f64::from(steps);
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        integrator.step(&mut state, h).unwrap();
        largest = largest.max((state.q[0] - state.t.cos()).abs());
    }
    largest
}

#[test]
fn each_quadrature_has_its_order() {
    for quadrature in Quadrature::ALL {
        let facts = DiscreteLagrangian::<1>::facts(&sampled(Spring, quadrature));
        for steps in [100, 200, 400, 800] {
            let ratio = error_on_the_oscillator(quadrature, steps)
                / error_on_the_oscillator(quadrature, 2 * steps);
            let off = (ratio.log2() - f64::from(facts.order)).abs();
            assert!(off < 0.1, "{}: {}", facts.name, ratio.log2());
        }
    }
}

#[test]
fn quadratures_that_claim_it_are_symmetric_and_the_others_are_not() {
    for quadrature in Quadrature::ALL {
        let mut integrator = Variational::new(sampled(Sun, quadrature)).unwrap();
        let start = State::new([0.4, -0.7], Covector([0.9, 0.5]));
        let mut state = start.clone();
        for _ in 0..2 {
            integrator.step(&mut state, 0.1).unwrap();
            state.p = Covector(state.p.0.map(|p| -p));
        }
        let miss = apart(&state, &start);
        let facts = DiscreteLagrangian::<2>::facts(&sampled(Sun, quadrature));
        assert_eq!(miss < 1e-14, facts.symmetric, "{}: {miss:e}", facts.name);
    }
}

/// How far the derivative D of a map of (x, y, px, py) is from preserving the symplectic form.
fn symplectic_defect(at: [f64; 4], mut map: impl FnMut([f64; 4]) -> [f64; 4]) -> f64 {
    let e = 1e-3;
    let columns: [[f64; 4]; 4] = std::array::from_fn(|j| {
        let mut moved = |by: f64| {
            let mut y = at;
            y[j] += by;
            map(y)
        };
        let [a, b, c, d] = [e, -e, 2.0 * e, -2.0 * e].map(&mut moved);
        std::array::from_fn(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * e))
    });
    let form = |x: &[f64; 4], y: &[f64; 4]| x[0] * y[2] + x[1] * y[3] - x[2] * y[0] - x[3] * y[1];
    let mut defect = 0.0_f64;
    for i in 0..4 {
        for j in 0..4 {
            let exact = f64::from(i8::from(j == i + 2) - i8::from(i == j + 2));
            defect = defect.max((form(&columns[i], &columns[j]) - exact).abs());
        }
    }
    defect
}

fn step_as_a_map<L: DiscreteLagrangian<2>>(lagrangian: L) -> impl FnMut([f64; 4]) -> [f64; 4] {
    let mut integrator = Variational::new(lagrangian).unwrap();
    move |[x, y, px, py]| {
        let mut state = State::new([x, y], Covector([px, py]));
        integrator.step(&mut state, 0.1).unwrap();
        [state.q[0], state.q[1], state.p.0[0], state.p.0[1]]
    }
}

#[test]
fn every_discrete_lagrangian_preserves_the_symplectic_form() {
    for quadrature in Quadrature::ALL {
        let lagrangian = Sampled { lagrangian: DoublePendulum, quadrature };
        let defect = symplectic_defect([0.8, -0.5, 0.4, 0.3], step_as_a_map(lagrangian));
        assert!(defect < 1e-9, "{quadrature:?} on the double pendulum: {defect:e}");
        let lagrangian = sampled(Sun, quadrature);
        let defect = symplectic_defect([0.4, -0.7, 0.9, 0.5], step_as_a_map(lagrangian));
        assert!(defect < 1e-9, "{quadrature:?} on Kepler: {defect:e}");
    }
}

#[test]
fn each_quadrature_is_stable_where_its_facts_say() {
    let amplitude = |quadrature, h: f64| {
        let mut state = State::new([1.0], Covector([0.5]));
        let mut integrator = Variational::new(sampled(Spring, quadrature)).unwrap();
        let mut largest = 0.0_f64;
        for _ in 0..1000 {
            integrator.step(&mut state, h).unwrap();
            largest = largest.max(state.q[0].abs());
        }
        largest
    };
    for quadrature in Quadrature::ALL {
        match DiscreteLagrangian::<1>::facts(&sampled(Spring, quadrature)).stability {
            Stability::Below(limit) => {
                assert!(amplitude(quadrature, 0.999 * limit) < 100.0, "{quadrature:?} below");
                assert!(amplitude(quadrature, 1.001 * limit) > 1e3, "{quadrature:?} above");
            }
            Stability::Always => {
                for h in [0.1, 1.0, 10.0, 100.0] {
                    assert!(amplitude(quadrature, h) < 1.2, "{quadrature:?} at h = {h}");
                }
            }
            Stability::Never => panic!("no quadrature is unstable at every step"),
        }
    }
}

/// The double pendulum's configurations, by RK4 on the Euler-Lagrange equations, `fine` steps for
/// each of ours.
fn reference(q: [f64; 2], h: f64, steps: u32, fine: u32) -> Vec<[f64; 2]> {
    let mut equations = EulerLagrange::new(DoublePendulum);
    let (mut y, k) = ([q, [0.0; 2]], h / f64::from(fine));
    let mut slope = |[q, v]: [[f64; 2]; 2]| [v, equations.acceleration(q, Vector(v)).unwrap().0];
    let ahead = |y: [[f64; 2]; 2], s: f64, d: [[f64; 2]; 2]| -> [[f64; 2]; 2] {
        std::array::from_fn(|a| std::array::from_fn(|i| y[a][i] + s * d[a][i]))
    };
    let mut path = vec![q];
    for _ in 0..steps {
        for _ in 0..fine {
            let a = slope(y);
            let b = slope(ahead(y, 0.5 * k, a));
            let c = slope(ahead(y, 0.5 * k, b));
            let d = slope(ahead(y, k, c));
            y = ahead(ahead(ahead(ahead(y, k / 6.0, a), k / 3.0, b), k / 3.0, c), k / 6.0, d);
        }
        path.push(y[0]);
    }
    path
}

fn error_on_the_double_pendulum(quadrature: Quadrature, steps: u32) -> f64 {
    let (start, h) = ([0.9, -0.4], 4.0 / f64::from(steps));
    let path = reference(start, h, steps, 3200 / steps);
    let mut integrator =
        Variational::new(Sampled { lagrangian: DoublePendulum, quadrature }).unwrap();
    let mut state = State::new(start, Covector([0.0; 2]));
    let mut largest = 0.0_f64;
    for q in &path[1..] {
        integrator.step(&mut state, h).unwrap();
        largest = largest.max((0..2).map(|i| (state.q[i] - q[i]).abs()).fold(0.0, f64::max));
    }
    largest
}

#[test]
fn the_double_pendulum_converges_with_order_two() {
    for quadrature in [Quadrature::Middle, Quadrature::Ends] {
        for steps in [100, 200, 400, 800] {
            let ratio = error_on_the_double_pendulum(quadrature, steps)
                / error_on_the_double_pendulum(quadrature, 2 * steps);
            assert!((ratio.log2() - 2.0).abs() < 0.1, "{quadrature:?}: {}", ratio.log2());
        }
    }
}

#[test]
fn the_double_pendulum_keeps_its_energy_bounded() {
    let equations = EulerLagrange::new(DoublePendulum);
    let energy = |state: &State<[f64; 2]>| {
        let v = equations.velocity(state.q, state.p).unwrap();
        DoublePendulum.energy(state.q, v)
    };
    for quadrature in Quadrature::ALL {
        let mut integrator =
            Variational::new(Sampled { lagrangian: DoublePendulum, quadrature }).unwrap();
        let mut state = State::new([0.9, -0.4], Covector([0.0; 2]));
        let start = energy(&state);
        let mut worst = [0.0_f64; 2];
        for step in 0..50_000 {
            integrator.step(&mut state, 0.02).unwrap();
            let half = usize::from(step >= 25_000);
            worst[half] = worst[half].max((energy(&state) - start).abs());
        }
        // A drift would double it.
        assert!(worst[1] < 1.1 * worst[0] && worst[0] < 0.05, "{quadrature:?}: {worst:?}");
    }
}

/// Only the sum of two velocities has energy.
struct Degenerate;

impl DiscreteLagrangian<2> for Degenerate {
    fn value<R: Number>(&self, q0: [R; 2], q1: [R; 2], h: f64) -> R {
        let v = (q1[0] - q0[0] + q1[1] - q0[1]) / h;
        v * v * 0.5 - q1[0] * q1[0]
    }
}

#[test]
fn a_singular_discrete_legendre_transform_is_an_error_and_the_state_stays() {
    let mut integrator = Variational::new(Degenerate).unwrap();
    // The second momentum is one that a step can have, and still it determines none.
    for p in [[1.0, 0.5], [1.0, 1.0], [0.0, 0.0]] {
        let mut state = State::new([0.3, 0.4], Covector(p));
        let before = state.clone();
        let error = integrator.step(&mut state, 0.1).unwrap_err();
        assert_eq!(error, StepError::SingularLegendreTransform);
        assert_eq!(state, before);
    }
}

#[test]
fn a_step_that_cannot_be_taken_leaves_the_state_as_it_was() {
    let mut integrator = Variational::new(sampled(Sun, Quadrature::Ends)).unwrap();
    for (q, p, h) in [
        ([1.0, 0.0], [0.0, 1.0], 0.0),
        ([1.0, 0.0], [0.0, 1.0], f64::NAN),
        ([0.0, 0.0], [0.0, 1.0], 0.1),
        ([f64::INFINITY, 0.0], [0.0, 1.0], 0.1),
    ] {
        let mut state = State::new(q, Covector(p));
        let before = state.clone();
        assert!(integrator.step(&mut state, h).is_err());
        assert_eq!(state, before);
    }
}

#[test]
fn a_discrete_lagrangian_promises_the_least_unless_it_says_more() {
    assert_eq!(Degenerate.facts(), VARIATIONAL);
    assert_eq!(VARIATIONAL.symplecticity, Symplecticity::Symplectic);
    assert_eq!(VARIATIONAL.stability, Stability::Below(0.0));
}
