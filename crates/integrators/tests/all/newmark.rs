//! Newmark's family: what its weights make of it, with and without forces that no potential gives.

use stationary_calculus::{Covector, Force, Newton, Sink, Vector};
use stationary_integrators::problems::{kepler, oscillator, pendulum};
use stationary_integrators::{
    ImplicitMidpoint, Integrator, Newmark, NewmarkWeights, Saved, Stability, State, StepError,
    Trapezoid,
};

/// Drag `-c v` and the load `f cos(w t)` on one freedom.
struct DragAndLoad {
    drag: f64,
    load: f64,
    frequency: f64,
}

impl Force for DragAndLoad {
    fn dim(&self) -> usize {
        1
    }

    fn add_force(&self, t: f64, _: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        f.0[0] += self.load * (self.frequency * t).cos() - self.drag * v.0[0];
    }

    fn add_damping(&self, _: f64, _: &[f64], _: Vector<&[f64]>, damping: &mut impl Sink) {
        damping.add_symmetric(&[0], &[self.drag]);
    }
}

fn alpha(radius: f64) -> NewmarkWeights {
    NewmarkWeights::generalized_alpha(radius).unwrap()
}

#[test]
fn the_average_acceleration_is_the_trapezoid_rule_and_radius_1_the_midpoint_rule() {
    let planet = kepler(0.6).unwrap();
    let mut methods: [Box<dyn Integrator<[f64; 2]>>; 4] = [
        Box::new(Trapezoid::new(&planet.system).unwrap()),
        Box::new(Newmark::new(&planet.system, NewmarkWeights::AVERAGE_ACCELERATION).unwrap()),
        Box::new(ImplicitMidpoint::new(&planet.system).unwrap()),
        Box::new(Newmark::new(&planet.system, alpha(1.0)).unwrap()),
    ];
    let [mut a, mut b, mut c, mut d] = [(); 4].map(|()| planet.initial.clone());
    for _ in 0..300 {
        for (method, state) in methods.iter_mut().zip([&mut a, &mut b, &mut c, &mut d]) {
            method.step(state, 0.02).unwrap();
        }
        for (left, right) in [(&a, &b), (&c, &d)] {
            assert!((left.q[0] - right.q[0]).hypot(left.q[1] - right.q[1]) < 1e-10);
        }
    }
}

#[test]
fn what_is_left_of_fast_oscillations() {
    for radius in [0.0, 0.3, 0.5, 0.8, 1.0] {
        let spring = oscillator(1.0).unwrap();
        let mut method = Newmark::new(&spring.system, alpha(radius)).unwrap();
        let mut state = State::new([1.0], Covector([0.0]));
        let mut after = |steps: usize, state: &mut State<[f64; 1]>| {
            for _ in 0..steps {
                method.step(state, 1e5).unwrap();
            }
            state.q[0].abs()
        };
        let (early, late) = (after(100, &mut state), after(100, &mut state));
        // A double eigenvalue multiplies the power by a slowly growing factor.
        let left = (late / early).powf(0.01);
        if radius == 0.0 {
            assert!(early < 1e-50, "{early}");
        } else {
            assert!((left - radius).abs() < 0.02 * radius, "{radius}: {left}");
        }
    }
}

#[test]
fn a_damped_and_driven_oscillator_comes_out_with_order_2() {
    // q'' = -q - c q' + f cos(w t), in its steady state A cos(w t) + B sin(w t).
    let (drag, load, w) = (0.7, 1.3, 2.0);
    let (d, e) = (1.0 - w * w, drag * w);
    let (a, b) = (load * d / (d * d + e * e), load * e / (d * d + e * e));
    let spring = oscillator(1.0).unwrap();
    for weights in [alpha(0.5), alpha(0.0), NewmarkWeights::newmark(0.3, 0.5).unwrap()] {
        let error = |steps: u32| {
            let h = 5.0 / f64::from(steps);
            let force = DragAndLoad { drag, load, frequency: w };
            let mut method = Newmark::with_force(&spring.system, weights, force).unwrap();
            let mut state = State::new([a], Covector([b * w]));
            let mut error = 0.0_f64;
            for step in 1..=steps {
                let report = method.step(&mut state, h).unwrap();
                assert!(report.hessians <= 3, "the damping is in Newton's matrix");
                let t = f64::from(step) * h;
                error = error.max((state.q[0] - a * (w * t).cos() - b * (w * t).sin()).abs());
            }
            error
        };
        let order = (error(200) / error(800)).log2() / 2.0;
        assert!((order - 2.0).abs() < 0.05, "{weights:?}: {order}");
    }
}

#[test]
fn newmarks_own_damping_costs_an_order() {
    let swing = pendulum(1.0).unwrap();
    let error = |steps: u32| {
        let weights = NewmarkWeights::newmark(0.3025, 0.6).unwrap();
        let mut method = Newmark::new(&swing.system, weights).unwrap();
        let h = swing.period / f64::from(steps);
        let (mut state, mut error) = (swing.initial.clone(), 0.0_f64);
        for step in 1..=steps {
            method.step(&mut state, h).unwrap();
            error = error.max(swing.error(f64::from(step) * h, &state.q).unwrap());
        }
        (error, method.facts().order)
    };
    let order = (error(2000).0 / error(4000).0).log2();
    assert!((order - f64::from(error(10).1)).abs() < 0.05, "{order}");
}

#[test]
fn a_limit_below_the_average_acceleration_is_where_the_facts_say() {
    let spring = oscillator(1.0).unwrap();
    for beta in [1.0 / 6.0, 1.0 / 12.0, 0.24] {
        let weights = NewmarkWeights::newmark(beta, 0.5).unwrap();
        let Stability::Below(limit) = weights.facts().stability else { panic!("no limit") };
        let largest = |h: f64| {
            let mut method = Newmark::new(&spring.system, weights).unwrap();
            let (mut state, mut largest) = (State::new([1.0], Covector([0.5])), 0.0_f64);
            for _ in 0..1000 {
                method.step(&mut state, h).unwrap();
                largest = largest.max(state.q[0].abs());
            }
            largest
        };
        assert!(largest(0.999 * limit) < 100.0 && largest(1.001 * limit) > 1e3, "{beta}");
    }
    assert_eq!(NewmarkWeights::newmark(0.25, 0.5).unwrap().facts().stability, Stability::Always);
}

#[test]
fn weights_outside_their_range_are_named() {
    for (beta, gamma) in [(0.0, 0.5), (-0.1, 0.5), (0.25, 0.4), (f64::NAN, 0.5), (0.25, 2.0)] {
        let error = NewmarkWeights::newmark(beta, gamma).unwrap_err();
        assert!(["beta", "gamma"].contains(&error.name), "{error}");
    }
    for radius in [-0.1, 1.1, f64::NAN] {
        let error = NewmarkWeights::generalized_alpha(radius).unwrap_err();
        assert_eq!(error.name, "the spectral radius");
    }
}

#[test]
fn a_failed_step_leaves_the_state_and_what_is_remembered_as_they_were() {
    let swing = pendulum(1.0).unwrap();
    let mut method = Newmark::new(&swing.system, alpha(0.5)).unwrap();
    let mut state = swing.initial.clone();
    method.step(&mut state, 0.1).unwrap();
    let (before, mut twin) = (state.clone(), method.clone());
    let mut expected = state.clone();
    twin.step(&mut expected, 0.1).unwrap();
    let none = Newton { tolerance: 0.0, iterations: 0 };
    let mut method = method.with_newton(none).unwrap();
    assert!(method.step(&mut state, 0.1).is_err());
    assert_eq!(state, before);
    let mut method = method.with_newton(Newton::default()).unwrap();
    method.step(&mut state, 0.1).unwrap();
    assert_eq!(state, expected);
}

#[test]
fn what_was_saved_goes_on_to_the_same_bits() {
    let planet = kepler(0.6).unwrap();
    let made = |weights| Newmark::new(&planet.system, weights).unwrap();
    for weights in [alpha(0.5), alpha(1.0), NewmarkWeights::AVERAGE_ACCELERATION] {
        let (mut whole, mut method) = (planet.initial.clone(), made(weights));
        for _ in 0..40 {
            method.step(&mut whole, 0.02).unwrap();
        }
        let (saved, mut resumed, mut fresh) = (method.save(), whole.clone(), made(weights));
        fresh.load(&saved).unwrap();
        for _ in 0..40 {
            method.step(&mut whole, 0.02).unwrap();
            fresh.step(&mut resumed, 0.02).unwrap();
        }
        assert_eq!(resumed, whole);
    }
}

#[test]
fn what_another_system_or_method_saved_is_refused() {
    let (planet, spring) = (kepler(0.6).unwrap(), oscillator(1.0).unwrap());
    let mut method = Newmark::<_, _, [f64; 2]>::new(&planet.system, alpha(0.5)).unwrap();
    let before = method.save();
    let other = Newmark::<_, _, [f64; 1]>::new(&spring.system, alpha(0.5)).unwrap().save();
    let foreign =
        Newmark::<_, _, [f64; 2]>::new(&planet.system, NewmarkWeights::AVERAGE_ACCELERATION);
    let mut broken = before.clone();
    broken.numbers[3] = f64::NAN;
    let empty = Saved { numbers: Vec::new(), ..before.clone() };
    for saved in [other, foreign.unwrap().save(), broken, empty] {
        assert!(matches!(method.load(&saved), Err(StepError::Saved(_))), "{saved:?}");
        assert_eq!(method.save(), before);
    }
}
