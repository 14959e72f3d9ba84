//! Steps that no multiplier step can make whole, and the same in halves.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::{
    Composed, ConstrainedIntegrator, ConstraintError, Dense, Halving, Projection, Rattle,
    Redundancy, Rod, Rods,
};
use stationary_integrators::{Scheme, State, Symplecticity, UniformGravity};

type Problem = System<DiagonalMetric<[f64; 4]>, UniformGravity<2>>;

/// A double pendulum whose outer mass is `ratio` times the inner, bent and turning at 1 rad/s.
fn double(ratio: f64) -> (Problem, Rods<2>, State<[f64; 4]>) {
    let metric = DiagonalMetric::new([1.0, 1.0, ratio, ratio]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0, ratio] };
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0]], rods).unwrap();
    let (sine, cosine) = (0.6, 0.8);
    let initial = State::new(
        [sine, -cosine, sine, -cosine - 1.0],
        Covector([cosine, sine, ratio * cosine, ratio * sine]),
    );
    (System::new(metric, gravity).unwrap(), rods, initial)
}

const FEW: Dense<2> = Dense(Redundancy::Refuse);

/// The first error in two seconds of steps.
fn failure(
    method: &mut impl ConstrainedIntegrator<[f64; 4]>,
    start: &State<[f64; 4]>,
    h: f64,
) -> Option<ConstraintError> {
    let mut state = start.clone();
    (0..(2.0 / h) as u32).find_map(|_| method.step(&mut state, h).err())
}

#[test]
fn a_step_too_long_for_a_light_joint_is_made_in_halves_where_that_is_asked_for() {
    let (system, rods, initial) = double(1e3);
    let rattle = || Rattle::new(&system, rods.clone(), &initial, FEW).unwrap();
    let h = 0.05;
    assert!(failure(&mut rattle(), &initial, h).is_some());
    let mut halving = Halving::new(rattle(), 20, &initial).unwrap();
    let mut state = initial.clone();
    let mut halved = 0;
    for k in 1..=40 {
        let report = halving.step(&mut state, h).unwrap();
        halved += report.halvings;
        assert!(report.violation < 1e-12);
        assert!((state.t - h * f64::from(k)).abs() < 1e-12);
        assert!(halving.multipliers().iter().all(|lambda| lambda.is_finite()));
    }
    assert!(halved > 0);
    assert!(!halving.facts().symmetric && halving.facts().symplecticity == Symplecticity::No);
}

#[test]
fn steps_that_succeed_are_not_halved_and_are_those_of_the_method() {
    let (system, rods, initial) = double(1.0);
    let mut rattle = Rattle::new(&system, rods, &initial, FEW).unwrap();
    let mut halving = Halving::new(rattle.clone(), 20, &initial).unwrap();
    let (mut one, mut other) = (initial.clone(), initial);
    for _ in 0..100 {
        let report = rattle.step(&mut one, 1e-2).unwrap();
        assert_eq!(halving.step(&mut other, 1e-2).unwrap(), report);
        assert_eq!((&one, rattle.multipliers()), (&other, halving.multipliers()));
    }
}

#[test]
fn a_step_that_fails_in_its_smallest_parts_leaves_the_state() {
    let (system, rods, initial) = double(1e3);
    let rattle = Rattle::new(&system, rods, &initial, FEW).unwrap();
    let mut halving = Halving::new(rattle, 1, &initial).unwrap();
    let mut state = initial.clone();
    assert!(halving.step(&mut state, 5.0).is_err());
    assert_eq!(state, initial);
}

/// Steps, then fails, and tells the multipliers after both.
fn before_and_after_a_failure(
    mut method: impl ConstrainedIntegrator<[f64; 4]>,
    initial: &State<[f64; 4]>,
) -> [Vec<f64>; 2] {
    let mut state = initial.clone();
    method.step(&mut state, 1e-3).unwrap();
    let before = method.multipliers().to_vec();
    assert!(method.step(&mut state, 5.0).is_err());
    [before, method.multipliers().to_vec()]
}

#[test]
fn a_step_that_fails_leaves_the_multipliers_of_the_last() {
    let (system, rods, initial) = double(10.0);
    let rattle = || Rattle::new(&system, rods.clone(), &initial, FEW).unwrap();
    let halved = Halving::new(rattle(), 1, &initial).unwrap();
    let composed = Composed::new(rattle(), Scheme::Suzuki4, &initial).unwrap();
    for [before, after] in [
        before_and_after_a_failure(rattle(), &initial),
        before_and_after_a_failure(halved, &initial),
        before_and_after_a_failure(composed, &initial),
    ] {
        assert_eq!(before, after);
    }
}

#[test]
fn masses_that_differ_by_any_factor_are_held() {
    for exponent in -12..=12 {
        let (system, rods, initial) = double(10_f64.powi(exponent));
        let mut rattle = Rattle::new(&system, rods, &initial, FEW).unwrap();
        let mut state = initial.clone();
        for step in 0..200 {
            let held = rattle.step(&mut state, 1e-4);
            assert!(held.is_ok(), "1e{exponent}, step {step}: {held:?}");
        }
    }
}

#[test]
fn a_projection_between_masses_that_differ_by_a_billion_settles_or_is_refused() {
    let (system, rods, _) = double(1e9);
    // Stretched, so that the joint between the masses is all but at rest.
    let rest = State::new([0.6, -0.8, 1.2, -1.6], Covector([0.0; 4]));
    let mut projection = Projection::new(&system, &rods, &rest, FEW).unwrap();
    let mut settled = 0;
    for seed in 0..300 {
        let mut state = rest.clone();
        for (k, q) in state.q.iter_mut().enumerate() {
            *q += 1e-3 * (f64::from(seed) + 2.4 * k as f64).sin();
        }
        if let Ok(report) = projection.project(&mut state) {
            assert!(report.iterations < 30, "{seed}: {report:?}");
            settled += 1;
        }
    }
    assert!(settled > 100, "{settled}");
}

#[test]
fn halves_go_back_in_time_too_so_that_composed_steps_may_be_halved() {
    let (system, rods, initial) = double(1e3);
    let rattle = Rattle::new(&system, rods, &initial, FEW).unwrap();
    let alone = Composed::new(rattle.clone(), Scheme::Suzuki4, &initial).unwrap();
    assert!(failure(&mut alone.clone(), &initial, 0.05).is_some());
    let halving = Halving::new(rattle, 20, &initial).unwrap();
    let mut method = Composed::new(halving, Scheme::Suzuki4, &initial).unwrap();
    let (mut state, mut halved) = (initial.clone(), 0);
    for _ in 0..40 {
        let report = method.step(&mut state, 0.05).unwrap();
        assert!(report.violation < 1e-12);
        halved += report.halvings;
    }
    assert!(halved > 0);
}
