//! What the discrete Hamilton principle promises, measured.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, Energy, Number, Vector};
use stationary_integrators::problems::{DoublePendulum, kepler, pendulum};
use stationary_integrators::{
    DiscreteLagrangian, Drag, EulerLagrange, Integrator, Lagrangian, Load, Mechanical, Method,
    Quadrature, Sampled, Stability, State, StepError, Symplecticity, Trapezoid, VARIATIONAL,
    Variational, angular_momentum,
};

/// A planet about a fixed sun: V = -1/|q|.
#[derive(Clone, Copy, Debug)]
struct Sun;

impl Energy<2> for Sun {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        -(x * x + y * y).sqrt().recip()
    }
}

/// A unit pendulum: V = -cos theta.
#[derive(Clone, Copy, Debug)]
struct Rod;

impl Energy<1> for Rod {
    fn energy<R: Number>(&self, [theta]: [R; 1]) -> R {
        -theta.cos()
    }
}

/// A unit mass on a spring of stiffness 1: V = q^2/2.
#[derive(Clone, Copy, Debug)]
struct Spring;

impl Energy<1> for Spring {
    fn energy<R: Number>(&self, [q]: [R; 1]) -> R {
        q * q * 0.5
    }
}

/// The method that each quadrature is said to reproduce.
const TWINS: [(Quadrature, Method); 4] = [
    (Quadrature::End, Method::SymplecticEulerDriftKick),
    (Quadrature::Start, Method::SymplecticEulerKickDrift),
    (Quadrature::Middle, Method::ImplicitMidpoint),
    (Quadrature::Ends, Method::StormerVerlet),
];

fn sampled<E: Energy<N>, const N: usize>(
    energy: E,
    quadrature: Quadrature,
) -> Sampled<Mechanical<E, N>> {
    Sampled { lagrangian: Mechanical::new([1.0; N], energy).unwrap(), quadrature }
}

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
    let mut state = State::new([1.0], [0.0]);
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
        let start = State::new([0.4, -0.7], [0.9, 0.5]);
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
        let mut state = State::new([x, y], [px, py]);
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
        let mut state = State::new([1.0], [0.5]);
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
    let mut state = State::new(start, [0.0; 2]);
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
        let mut state = State::new([0.9, -0.4], [0.0; 2]);
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

type Driven<S> =
    Variational<Sampled<Mechanical<Spring, 1>>, 1, (Drag<[f64; 1]>, Load<[f64; 1], S>)>;

/// A damped and driven unit oscillator: q'' = -q - c q' + s(t).
fn driven<S: Fn(f64) -> f64>(quadrature: Quadrature, c: f64, strength: S) -> Driven<S> {
    let load = Load { direction: Covector([1.0]), strength };
    Variational::forced(sampled(Spring, quadrature), (Drag::new([c]).unwrap(), load)).unwrap()
}

/// A damped oscillator that starts at rest at 1: its configuration and momentum.
fn damped(c: f64, t: f64) -> (f64, f64) {
    let omega = (1.0 - 0.25 * c * c).sqrt();
    let (sin, cos) = (omega * t).sin_cos();
    let decay = (-0.5 * c * t).exp();
    (decay * (cos + 0.5 * c / omega * sin), -decay / omega * sin)
}

#[test]
fn drag_is_integrated_with_the_order_of_the_discrete_lagrangian() {
    let c = 0.3;
    for quadrature in Quadrature::ALL {
        let error = |steps: u32| {
            let mut integrator = driven(quadrature, c, |_| 0.0);
            let mut state = State::new([1.0], [0.0]);
            let mut largest = 0.0_f64;
            for _ in 0..steps {
                integrator.step(&mut state, 8.0 / f64::from(steps)).unwrap();
                let (q, p) = damped(c, state.t);
                largest = largest.max((state.q[0] - q).abs()).max((state.p.0[0] - p).abs());
            }
            largest
        };
        let order = f64::from(Integrator::<[f64; 1]>::facts(&driven(quadrature, c, |_| 0.0)).order);
        for steps in [100, 200, 400, 800] {
            let measured = (error(steps) / error(2 * steps)).log2();
            assert!((measured - order).abs() < 0.1, "{quadrature:?}: {measured}");
        }
    }
}

#[test]
fn drag_takes_the_energy_that_the_closed_form_says() {
    let (c, t) = (0.05, 40.0);
    let energy = |q: f64, p: f64| 0.5 * (q * q + p * p);
    let (q, p) = damped(c, t);
    let off = |steps: u32| {
        let mut integrator = driven(Quadrature::Middle, c, |_| 0.0);
        let mut state = State::new([1.0], [0.0]);
        for _ in 0..steps {
            integrator.step(&mut state, t / f64::from(steps)).unwrap();
        }
        energy(state.q[0], state.p.0[0]) / energy(q, p) - 1.0
    };
    // exp(-c t) is left, with a ripple of c; the step's share is of order h^2 c t.
    assert!((energy(q, p) / 0.5 - (-c * t).exp()).abs() < 0.01);
    assert!(off(2000).abs() < 3e-4 && (off(2000) / off(4000) - 4.0).abs() < 0.2, "{}", off(2000));
}

#[test]
fn a_load_is_integrated_with_order_two() {
    // q'' = -q + sin 2t from rest at 0: q = (2 sin t - sin 2t)/3.
    let exact = |t: f64| (2.0 * t.sin() - (2.0 * t).sin()) / 3.0;
    for quadrature in [Quadrature::Middle, Quadrature::Ends] {
        let error = |steps: u32| {
            let mut integrator = driven(quadrature, 0.0, |t| (2.0 * t).sin());
            let mut state = State::new([0.0], [0.0]);
            let mut largest = 0.0_f64;
            for _ in 0..steps {
                integrator.step(&mut state, 8.0 / f64::from(steps)).unwrap();
                largest = largest.max((state.q[0] - exact(state.t)).abs());
            }
            largest
        };
        for steps in [100, 200, 400, 800] {
            let measured = (error(steps) / error(2 * steps)).log2();
            assert!((measured - 2.0).abs() < 0.1, "{quadrature:?}: {measured}");
        }
    }
}

#[test]
fn what_forces_work_is_what_the_energy_gains() {
    // The midpoint rule's energy is quadratic here: its gain is <F, q1 - q0>, to rounding.
    let strength = |t: f64| (1.3 * t).cos();
    let mut integrator = driven(Quadrature::Middle, 0.2, strength);
    let mut state = State::new([1.0], [0.0]);
    let energy = |state: &State<[f64; 1]>| 0.5 * (state.q[0].powi(2) + state.p.0[0].powi(2));
    let (start, h, mut work, mut dissipated) = (energy(&state), 0.1, 0.0, 0.0);
    for _ in 0..1000 {
        let before = state.clone();
        integrator.step(&mut state, h).unwrap();
        let moved = state.q[0] - before.q[0];
        work += strength(before.t + 0.5 * h) * moved;
        dissipated += 0.2 * moved / h * moved;
        let balance = energy(&state) - start - work + dissipated;
        assert!(balance.abs() < 1e-12, "{balance:e} at {}", state.t);
    }
    assert!(dissipated > 10.0 && work > 10.0, "{dissipated} {work}");
}

#[test]
fn drag_takes_angular_momentum_away_at_its_own_rate() {
    // A planet in a thin gas: angular momentum decays as exp(-c t).
    let c = 1e-2;
    let lagrangian = sampled(Sun, Quadrature::Middle);
    let mut integrator = Variational::forced(lagrangian, Drag::new([c; 2]).unwrap()).unwrap();
    let mut state = kepler(0.3).unwrap().initial;
    let start = angular_momentum::<2>(&state)[2];
    for _ in 0..1000 {
        integrator.step(&mut state, 0.01).unwrap();
    }
    let left = angular_momentum::<2>(&state)[2] / start;
    // The discrete drag acts on (q1 - q0)/h, which differs from p by h^2: of c t, 1e-5.
    assert!((left - (-c * state.t).exp()).abs() < 1e-5, "{left}");
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
        let mut state = State::new([0.3, 0.4], p);
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
        let mut state = State::new(q, p);
        let before = state.clone();
        assert!(integrator.step(&mut state, h).is_err());
        assert_eq!(state, before);
    }
    let three = Drag::new([1.0; 3]).unwrap();
    assert!(Variational::forced(sampled(Sun, Quadrature::Ends), three).is_err());
}

#[test]
fn a_discrete_lagrangian_promises_the_least_unless_it_says_more() {
    assert_eq!(Degenerate.facts(), VARIATIONAL);
    assert_eq!(VARIATIONAL.symplecticity, Symplecticity::Symplectic);
    assert_eq!(VARIATIONAL.stability, Stability::Below(0.0));
}
