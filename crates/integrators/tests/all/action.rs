//! The action: stationary on the motion, and what kind of stationary point the motion is.

use std::f64::consts::PI;

use stationary_calculus::{Covector, NewtonFailure, Unsolvable};
use stationary_integrators::problems::DoublePendulum;
use stationary_integrators::{
    Action, ActionError, DiscreteLagrangian, Integrator, Mechanical, Quadrature, Sampled, State,
    Stationary, Variational,
};

use crate::discrete_lagrangians::{Spring, sampled};

fn spring() -> Sampled<Mechanical<Spring, 1>> {
    sampled(Spring, Quadrature::Middle)
}

fn double_pendulum() -> Sampled<DoublePendulum> {
    Sampled { lagrangian: DoublePendulum, quadrature: Quadrature::Ends }
}

/// The discrete motion through these steps.
fn motion<L: DiscreteLagrangian<N>, const N: usize>(
    lagrangian: L,
    mut state: State<[f64; N]>,
    steps: &[f64],
) -> (Vec<[f64; N]>, State<[f64; N]>) {
    let mut integrator = Variational::new(lagrangian).unwrap();
    let mut path = vec![state.q];
    for &h in steps {
        integrator.step(&mut state, h).unwrap();
        path.push(state.q);
    }
    (path, state)
}

/// Steps that differ: 0.01, 0.02, 0.03, and again.
fn uneven(count: usize) -> Vec<f64> {
    (0..count).map(|i| 0.01 * (i % 3 + 1) as f64).collect()
}

#[test]
fn the_action_is_stationary_on_the_discrete_motion_and_on_no_other_path() {
    let steps = uneven(60);
    let action = Action::new(double_pendulum(), steps.clone()).unwrap();
    let start = State::new([0.9, -0.4], Covector([0.3, 0.1]));
    let (path, _) = motion(double_pendulum(), start, &steps);
    let largest = |path: &[[f64; 2]]| {
        let differential = action.differential(path).unwrap();
        differential.iter().flat_map(|p| p.0).fold(0.0, |m: f64, p| m.max(p.abs()))
    };
    assert_eq!(action.differential(&path).unwrap().len(), 59);
    assert!(largest(&path) < 1e-10, "{:e}", largest(&path));
    for (point, freedom) in [(1, 0), (30, 1), (59, 0)] {
        let mut other = path.clone();
        other[point][freedom] += 1e-4;
        assert!(largest(&other) > 1e-3, "{:e} at point {point}", largest(&other));
    }
}

#[test]
fn the_differential_is_the_rate_at_which_the_action_changes() {
    let steps = uneven(12);
    let action = Action::new(double_pendulum(), steps).unwrap();
    let path: Vec<[f64; 2]> =
        (0..13).map(|i| [(0.3 * f64::from(i)).sin(), (0.2 * f64::from(i)).cos()]).collect();
    let differential = action.differential(&path).unwrap();
    for (point, freedom) in [(1, 0), (6, 1), (11, 1)] {
        let moved = |by: f64| {
            let mut path = path.clone();
            path[point][freedom] += by;
            action.of(&path).unwrap()
        };
        let e = 1e-4;
        let measured = (moved(e) - moved(-e)) / (2.0 * e);
        let exact = differential[point - 1].0[freedom];
        assert!((measured - exact).abs() < 1e-5 * exact.abs().max(1.0), "{measured} {exact}");
    }
}

#[test]
fn the_boundary_value_problem_finds_the_motion() {
    let steps = uneven(60);
    let start = State::new([0.9, -0.4], Covector([0.3, 0.1]));
    let (path, _) = motion(double_pendulum(), start.clone(), &steps);
    let (first, last) = (path[0], path[60]);
    let straight: Vec<[f64; 2]> = (0..=60)
        .map(|i| {
            let part = f64::from(i) / 60.0;
            std::array::from_fn(|c| first[c] + part * (last[c] - first[c]))
        })
        .collect();
    let action = Action::new(double_pendulum(), steps).unwrap();
    let found = action.stationary_path(straight).unwrap();
    for (found, exact) in found.path.iter().zip(&path) {
        assert!((0..2).all(|c| (found[c] - exact[c]).abs() < 1e-10));
    }
    assert!((0..2).all(|c| (found.momentum.0[c] - start.p.0[c]).abs() < 1e-10));
    assert_eq!(found.kind(), Stationary::Minimum);
}

/// The oscillator between 1 and its place after `duration` seconds, from a guess at rest.
fn oscillator_over(duration: f64, steps: usize) -> Result<(usize, Stationary, f64), ActionError> {
    let h = vec![duration / steps as f64; steps];
    let (path, _) = motion(spring(), State::new([1.0], Covector([0.2])), &h);
    let mut guess = vec![[0.0]; steps + 1];
    (guess[0], guess[steps]) = (path[0], path[steps]);
    let found = Action::new(spring(), h).unwrap().stationary_path(guess)?;
    let off = found.path.iter().zip(&path).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
    Ok((found.index, found.kind(), off))
}

#[test]
fn an_oscillator_is_a_minimum_for_half_a_period_and_a_saddle_beyond() {
    // Morse: the index counts the conjugate points passed, one every half period, pi seconds.
    for duration in [1.0, 3.0, 3.3, 6.0, 6.5, 9.0, 9.8, 20.0] {
        let passed = (duration / PI).floor() as usize;
        let (index, kind, off) = oscillator_over(duration, 200).unwrap();
        let expected = if passed == 0 { Stationary::Minimum } else { Stationary::Saddle };
        assert_eq!((index, kind), (passed, expected), "{duration} s");
        assert!(off < 1e-9, "{duration} s: {off:e}");
    }
}

#[test]
fn a_conjugate_point_within_the_path_costs_no_accuracy() {
    // Steps of the midpoint rule turn by 2 atan(h/2): 20 of them by exactly half a turn.
    let h = 2.0 * (PI / 40.0).tan();
    let (index, kind, off) = oscillator_over(30.0 * h, 30).unwrap();
    assert_eq!((index, kind), (1, Stationary::Saddle));
    assert!(off < 1e-10, "{off:e}");
}

#[test]
fn ends_that_are_conjugate_are_an_error() {
    let h = 2.0 * (PI / 40.0).tan();
    let error = oscillator_over(20.0 * h, 20).unwrap_err();
    let ActionError::Newton(newton) = &error else { panic!("{error}") };
    assert_eq!(newton.failure, NewtonFailure::Unsolvable(Unsolvable::Singular));
    let action = Action::new(spring(), vec![h; 20]).unwrap();
    let error = action.stationary_path(vec![[0.0]; 21]).unwrap_err();
    assert_eq!(error, ActionError::Conjugate(Unsolvable::Singular));
}

#[test]
fn steps_longer_than_the_motions_own_time_make_it_a_maximum() {
    let lagrangian = Mechanical::new([1.0], Spring).unwrap();
    let ends = Sampled { lagrangian, quadrature: Quadrature::Ends };
    // One interior point: d2S = 2/h - h, negative above h = sqrt 2.
    for (h, kind) in [(1.4, Stationary::Minimum), (1.42, Stationary::Maximum)] {
        let action = Action::new(ends, vec![h; 2]).unwrap();
        let found = action.stationary_path(vec![[0.0], [0.3], [1.0]]).unwrap();
        assert_eq!(found.kind(), kind, "h = {h}");
    }
}

#[test]
fn a_path_that_is_none_is_refused() {
    assert_eq!(Action::new(spring(), vec![]).unwrap_err(), ActionError::NoSteps);
    for h in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = Action::new(spring(), vec![0.1, h]).unwrap_err();
        assert!(matches!(error, ActionError::Step { step: 1, .. }), "{error}");
    }
    let action = Action::new(spring(), vec![0.1; 3]).unwrap();
    assert!(action.of(&[[0.0]; 3]).is_err() && action.differential(&[[0.0]; 5]).is_err());
    let error = action.stationary_path(vec![[0.0]; 3]).unwrap_err();
    assert!(matches!(error, ActionError::Size(_)), "{error}");
    let error = action.stationary_path(vec![[0.0], [0.0], [f64::NAN], [1.0]]).unwrap_err();
    assert_eq!(error, ActionError::NonFinite { point: 2, freedom: 0 });
}

#[test]
fn a_path_of_one_step_has_nothing_to_vary() {
    let action = Action::new(spring(), vec![0.1]).unwrap();
    let found = action.stationary_path(vec![[0.0], [1.0]]).unwrap();
    assert_eq!((found.index, found.kind()), (0, Stationary::Minimum));
}
