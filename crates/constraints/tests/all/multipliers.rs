//! The methods with multipliers: their facts, their forces, and where they fail.

use stationary_calculus::Storage;
use stationary_constraints::problems::{
    Hanging, Pendulum, RodProblem, Square, four_bar, pendulum, slider_crank, square,
};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, ConstraintError, Dense, Rattle,
    Redundancy, SparseDiagonal,
};
use stationary_integrators::{State, angular_momentum, angular_momentum_scale, linear_momentum};
use stationary_measure::loglog_slope;

const REFUSE: Redundancy = Redundancy::Refuse;

/// RATTLE for any number of equations.
fn rattle<C: Storage>(problem: &RodProblem<C>) -> impl ConstrainedIntegrator<C> + use<'_, C> {
    let RodProblem { system, rods, initial } = problem;
    Rattle::new(system, rods.clone(), initial, SparseDiagonal(REFUSE)).unwrap()
}

/// When the pendulum starts: not where symmetry would hide a term.
const START: f64 = 0.7;

/// The largest error of the place over a period, and of the tension at a part of the step from the
/// second step on.
fn errors(
    pendulum: &Pendulum,
    method: &mut impl ConstrainedIntegrator<[f64; 2]>,
    steps: u32,
    part: f64,
) -> [f64; 2] {
    let h = pendulum.period / f64::from(steps);
    let mut state = pendulum.state(START);
    let mut worst = [0.0_f64; 2];
    for i in 1..=steps {
        let before = state.t;
        let report = method.step(&mut state, h).unwrap();
        assert!(report.violation <= 1e-12 + 8.0 * f64::EPSILON);
        worst[0] = worst[0].max(pendulum.error(state.t, &state.q));
        let tension = 2.0 * method.multipliers()[0];
        if i > 1 {
            worst[1] = worst[1].max((tension - pendulum.tension(before + part * h)).abs());
        }
    }
    worst
}

/// The orders of the place and of the tension.
fn orders<I: ConstrainedIntegrator<[f64; 2]>>(
    pendulum: &Pendulum,
    part: f64,
    mut make: impl FnMut() -> I,
) -> [f64; 2] {
    let mut points = [Vec::new(), Vec::new()];
    for steps in [400, 800, 1600, 3200] {
        let errors = errors(pendulum, &mut make(), steps, part);
        for (points, error) in points.iter_mut().zip(errors) {
            points.push((1.0 / f64::from(steps), error));
        }
    }
    points.map(|points| loglog_slope(&points).unwrap())
}

#[test]
fn rattle_has_order_two_in_place_and_tension() {
    for speed in [0.2, 1.9, 2.5] {
        let pendulum = pendulum(speed).unwrap();
        let orders = orders(&pendulum, 0.5, || rattle(&pendulum.problem));
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{speed}: {orders:?}");
    }
}

#[test]
fn the_constrained_hamilton_principle_has_order_one_in_place_and_tension() {
    for speed in [0.2, 1.9, 2.5] {
        let pendulum = pendulum(speed).unwrap();
        let RodProblem { system, rods, initial } = &pendulum.problem;
        let orders = orders(&pendulum, 0.0, || {
            ConstrainedHamilton::new(system, rods.clone(), initial, Dense::<1>(REFUSE)).unwrap()
        });
        assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.1), "{speed}: {orders:?}");
    }
}

#[test]
fn a_rod_that_holds_a_weight_at_rest_has_its_weight_as_tension() {
    let mut pendulum = pendulum(1.0).unwrap();
    pendulum.problem.initial.p.0 = [0.0; 2];
    let mut rattle = rattle(&pendulum.problem);
    let mut state = pendulum.problem.initial.clone();
    for _ in 0..100 {
        rattle.step(&mut state, 0.01).unwrap();
        let rod = pendulum.problem.rods.rods()[0];
        assert!((rod.tension(rattle.multipliers()[0]) - 1.0).abs() < 1e-12);
    }
    assert_eq!(state.q, [0.0, -1.0]);
}

/// The largest change of both momenta of a free square over 100,000 steps: relative to the
/// momentum, and to what rounding scales with.
fn changes_of_momenta(square: &Square) -> [f64; 3] {
    let mut rattle = rattle(square);
    let mut state = square.initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let mut worst = [0.0_f64; 3];
    for _ in 0..100_000 {
        rattle.step(&mut state, 0.01).unwrap();
        let now = linear_momentum::<2>(&state);
        let change = (angular_momentum::<2>(&state)[2] - angular).abs();
        worst[0] = worst[0].max((now[0] - linear[0]).abs() + (now[1] - linear[1]).abs());
        worst[1] = worst[1].max(change / angular);
        worst[2] = worst[2].max(change / angular_momentum_scale::<2>(&state));
    }
    worst
}

#[test]
fn momenta_of_a_free_rigid_square_are_kept_to_rounding() {
    let [linear, angular, _] = changes_of_momenta(&square(1, 2.0, [0.0; 2]).unwrap());
    assert!(linear < 1e-12 && angular < 1e-12, "{linear:e} {angular:e}");
    let [linear, _, angular] = changes_of_momenta(&square(1, 2.0, [0.3, 0.2]).unwrap());
    assert!(linear < 1e-12 && angular < 1e-12, "{linear:e} {angular:e}");
}

#[test]
fn energy_oscillates_and_stays() {
    let linkage = four_bar(1.0, 2.0).unwrap().problem;
    let energy = |state: &State<[f64; 4]>| linkage.system.energy(&state.q, state.p.view());
    let worst = |h: f64| {
        let mut rattle = rattle(&linkage);
        let mut state = linkage.initial.clone();
        let start = energy(&state);
        let mut worst = 0.0_f64;
        for _ in 0..(200.0 / h) as u64 {
            rattle.step(&mut state, h).unwrap();
            worst = worst.max((energy(&state) - start).abs());
        }
        worst
    };
    let (coarse, fine) = (worst(0.02), worst(0.01));
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.2, "{order}: {coarse:e} {fine:e}");
}

#[test]
fn a_step_back_undoes_a_step() {
    let linkage = four_bar(1.0, 2.0).unwrap().problem;
    let mut state = linkage.initial.clone();
    let mut rattle = rattle(&linkage);
    rattle.step(&mut state, 0.05).unwrap();
    state.p.0.iter_mut().for_each(|p| *p = -*p);
    rattle.step(&mut state, 0.05).unwrap();
    for (q, start) in state.q.iter().zip(&linkage.initial.q) {
        assert!((q - start).abs() < 1e-14);
    }
    for (p, start) in state.p.0.iter().zip(&linkage.initial.p.0) {
        assert!((p + start).abs() < 1e-13);
    }
}

#[test]
fn a_step_that_is_too_long_is_an_error_and_leaves_the_state() {
    let pendulum = pendulum(1.9).unwrap();
    let mut rattle = rattle(&pendulum.problem);
    let mut state = pendulum.problem.initial.clone();
    let error = rattle.step(&mut state, 3.0).unwrap_err();
    assert!(matches!(error, ConstraintError::Diverged { .. }), "{error}");
    assert_eq!(state, pendulum.problem.initial);
    rattle.step(&mut state, 0.1).unwrap();
    assert_ne!(state, pendulum.problem.initial);
}

#[test]
fn the_first_position_is_constrained_like_all_others() {
    let pendulum = pendulum(1.0).unwrap();
    let RodProblem { system, rods, initial } = &pendulum.problem;
    for h in [0.02, 0.01] {
        // The notes' first position.
        let printed = [initial.q[0] + h * initial.p.0[0], initial.q[1] + h * initial.p.0[1]];
        let off = printed[0].hypot(printed[1]) - 1.0;
        assert!((off / (0.5 * h * h) - 1.0).abs() < 1e-3);
        let mut method =
            ConstrainedHamilton::new(system, rods.clone(), initial, Dense::<1>(REFUSE)).unwrap();
        let mut state = initial.clone();
        method.step(&mut state, h).unwrap();
        assert!((state.q[0].hypot(state.q[1]) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn closed_loops_are_where_they_began_after_whole_revolutions() {
    // The time of a revolution follows from energy alone, by a sum over angles.
    let linkage = four_bar(1.0, 4.0).unwrap();
    let time = 2.0 * linkage.revolution.unwrap();
    let four_bar =
        ends(&linkage.problem.system, &linkage.problem.rods, &linkage.problem.initial, time);
    let engine = slider_crank(1.0, 4.0).unwrap();
    let time = 2.0 * engine.revolution.unwrap();
    let slider = ends(&engine.system, &engine.constraint, &engine.initial, time);
    for (name, points) in [("four-bar linkage", four_bar), ("slider-crank", slider)] {
        let order = loglog_slope(&points).unwrap();
        assert!((order - 2.0).abs() < 0.05, "{name}: {order}, {points:?}");
        assert!(points[2].1 < 1e-4, "{name}: {points:?}");
    }
}

/// Steps, and the distance from where the motion began.
fn ends(
    system: &Hanging<[f64; 4]>,
    constraint: &impl Constraint,
    initial: &State<[f64; 4]>,
    time: f64,
) -> Vec<(f64, f64)> {
    let distance = |steps: u32| {
        let h = time / f64::from(steps);
        let mut state = initial.clone();
        let mut rattle = Rattle::new(system, constraint, initial, Dense::<3>(REFUSE)).unwrap();
        for _ in 0..steps {
            rattle.step(&mut state, h).unwrap();
        }
        let pairs = state.q.iter().zip(&initial.q);
        (h, pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
    };
    [4000, 8000, 16_000].map(distance).to_vec()
}
