//! Forces that no potential gives, in variational steps: drag and loads by Lagrange-d'Alembert.

use stationary_calculus::Covector;
use stationary_integrators::problems::kepler;
use stationary_integrators::{
    Drag, Integrator, Load, Mechanical, Quadrature, Sampled, State, Variational, angular_momentum,
};

use crate::discrete_lagrangians::{Spring, Sun, sampled};

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
            let mut state = State::new([1.0], Covector([0.0]));
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
        let mut state = State::new([1.0], Covector([0.0]));
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
            let mut state = State::new([0.0], Covector([0.0]));
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
    let mut state = State::new([1.0], Covector([0.0]));
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

#[test]
fn a_force_of_another_size_is_refused() {
    let three = Drag::new([1.0; 3]).unwrap();
    assert!(Variational::forced(sampled(Sun, Quadrature::Ends), three).is_err());
}
