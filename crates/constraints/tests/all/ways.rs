//! The other ways: step and project, penalty, the angle; and breaking, driving, redundancy.

use stationary_calculus::{Covector, DiagonalMetric, Number, System};
use stationary_constraints::problems::{Pendulum, RodProblem, four_bar, pendulum, square};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedIntegrator, Constraint, ConstraintError, Dense, Function,
    FunctionConstraint, Level, LevelSet, Linear, Penalty, Projection, Rattle, Redundancy, Rod,
    Rods, SparseDiagonal, StepAndProject,
};
use stationary_integrators::{
    Integrator, RungeKutta4, State, StormerVerlet, SymplecticEulerKickDrift, UniformGravity,
    linear_momentum,
};
use stationary_measure::loglog_slope;

const REFUSE: Redundancy = Redundancy::Refuse;

/// The slope of the largest error of the place over a period.
fn order<I: Integrator<[f64; 2]>>(pendulum: &Pendulum, make: impl Fn() -> I) -> f64 {
    let RodProblem { system, rods, .. } = &pendulum.problem;
    let mut points = Vec::new();
    for steps in [800, 1600, 3200, 6400] {
        let mut state = pendulum.state(0.7);
        let choice = Dense::<1>(REFUSE);
        let mut method = StepAndProject::new(make(), system, rods.clone(), &state, choice).unwrap();
        let h = pendulum.period / f64::from(steps);
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            let report = method.step(&mut state, h).unwrap();
            assert!(report.violation <= 1e-12 + 8.0 * f64::EPSILON);
            let [x, y] = state.q;
            assert!((x * state.p.0[0] + y * state.p.0[1]).abs() < 1e-13);
            worst = worst.max(pendulum.error(state.t, &state.q));
        }
        points.push((h, worst));
    }
    loglog_slope(&points).unwrap()
}

#[test]
fn step_and_project_has_order_one_whatever_the_integrator() {
    for speed in [1.0, 2.5] {
        let pendulum = pendulum(speed).unwrap();
        let system = &pendulum.problem.system;
        let orders = [
            order(&pendulum, || SymplecticEulerKickDrift::new(system).unwrap()),
            order(&pendulum, || StormerVerlet::new(system).unwrap()),
            order(&pendulum, || RungeKutta4::new(system).unwrap()),
        ];
        assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.15), "{speed}: {orders:?}");
    }
}

#[test]
fn step_and_project_loses_the_energy_of_a_circling_pendulum() {
    let pendulum = pendulum(6.0).unwrap();
    let RodProblem { system, rods, initial } = &pendulum.problem;
    let verlet = StormerVerlet::new(system).unwrap();
    let mut method =
        StepAndProject::new(verlet, system, rods.clone(), initial, Dense::<1>(REFUSE)).unwrap();
    let mut state = initial.clone();
    let mut energies = vec![system.energy(&state.q, state.p.view())];
    for _ in 0..20 {
        for _ in 0..200 {
            method.step(&mut state, pendulum.period / 200.0).unwrap();
        }
        energies.push(system.energy(&state.q, state.p.view()));
    }
    assert!(energies.windows(2).all(|two| two[1] < two[0]), "{energies:?}");
}

#[test]
fn a_projection_in_the_mass_metric_keeps_linear_momentum_and_a_euclidean_one_does_not() {
    // A dumbbell of masses 1 and 9, its rod stretched by a tenth.
    let metric = DiagonalMetric::new([1.0, 1.0, 9.0, 9.0]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, 0.0], masses: vec![1.0, 9.0] };
    let system = System::new(metric, gravity).unwrap();
    let rods = Rods::<2>::new(2, Vec::new(), vec![Rod::new([0, 1], 1.0)]).unwrap();
    let centre = |q: &[f64; 4]| [(q[0] + 9.0 * q[2]) / 10.0, (q[1] + 9.0 * q[3]) / 10.0];
    let stretched = State::new([0.0, 0.0, 0.66, 0.88], Covector([0.0; 4]));
    let mut state = stretched.clone();
    let mut projection = Projection::new(&system, &rods, &state, Dense::<1>(REFUSE)).unwrap();
    let report = projection.project(&mut state).unwrap();
    assert!(report.violation < 1e-14 && report.distance > 0.0);
    let moved = |state: &State<[f64; 4]>| {
        let (a, b) = (centre(&stretched.q), centre(&state.q));
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    assert!(moved(&state) < 1e-15);
    // The same projection where all masses are taken for equal.
    let euclidean = DiagonalMetric::new([1.0; 4]).unwrap();
    let euclidean = System::new(euclidean, system.potential().clone()).unwrap();
    let mut state = stretched.clone();
    let mut projection = Projection::new(&euclidean, &rods, &state, Dense::<1>(REFUSE)).unwrap();
    projection.project(&mut state).unwrap();
    assert!(moved(&state) > 0.03);
}

#[test]
fn a_projection_finds_the_closest_configuration() {
    // Closest to a point outside of an ellipse: the difference is normal to it.
    #[derive(Clone, Debug)]
    struct Ellipse;
    impl Level<2> for Ellipse {
        fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
            x * x * 0.25 + y * y - 1.0
        }
    }
    let system = pendulum(1.0).unwrap().problem.system;
    let outside = State::new([1.9, 0.9], Covector([0.0; 2]));
    let ellipse = LevelSet::new(0, Ellipse);
    let mut state = outside.clone();
    let mut projection = Projection::new(&system, ellipse, &state, Dense::<1>(REFUSE)).unwrap();
    projection.project(&mut state).unwrap();
    let [x, y] = state.q;
    let (dx, dy) = (outside.q[0] - x, outside.q[1] - y);
    assert!((0.25 * x * x + y * y - 1.0).abs() < 1e-14);
    assert!((dx * 2.0 * y - dy * 0.5 * x).abs() < 1e-13, "not normal");
}

#[test]
fn an_infeasible_state_is_refused_with_its_violation_and_projected_on_request() {
    let pendulum = pendulum(1.0).unwrap();
    let RodProblem { system, rods, .. } = &pendulum.problem;
    let choice = Dense::<1>(REFUSE);
    let mut state = State::new([0.0, -1.01], Covector([0.3, 0.2]));
    let error = Rattle::new(system, rods.clone(), &state, choice).unwrap_err();
    let ConstraintError::Infeasible { row: 0, violation, .. } = error else { panic!("{error}") };
    assert!((violation - 0.01).abs() < 1e-4);
    let mut leaving = State::new([0.0, -1.0], Covector([0.3, 0.2]));
    let error = Rattle::new(system, rods.clone(), &leaving, choice).unwrap_err();
    let ConstraintError::InfeasibleVelocity { rate, .. } = error else { panic!("{error}") };
    assert!((rate - 0.2).abs() < 1e-15);
    for state in [&mut state, &mut leaving] {
        let mut projection = Projection::new(system, rods, state, choice).unwrap();
        projection.project(state).unwrap();
        assert!((state.q[1] + 1.0).abs() < 1e-15 && (state.p.0[0] - 0.3).abs() < 1e-15);
        Rattle::new(system, rods.clone(), state, choice).unwrap();
    }
}

#[test]
fn equations_that_contradict_each_other_are_an_error_and_leave_the_state() {
    let system = pendulum(1.0).unwrap().problem.system;
    let lines = Linear::new(vec![(vec![(0, 1.0)], 0.0), (vec![(0, 1.0)], 1.0)]).unwrap();
    let mut state = State::new([0.3, 0.0], Covector([0.0; 2]));
    for redundancy in [REFUSE, Redundancy::LeastNorm] {
        let choice = Dense::<2>(redundancy);
        let mut projection = Projection::new(&system, &lines, &state, choice).unwrap();
        let error = projection.project(&mut state).unwrap_err();
        let named = matches!(
            error,
            ConstraintError::Singular { .. } | ConstraintError::NotConverged { .. }
        );
        assert!(named, "{error}");
        assert_eq!(state.q, [0.3, 0.0]);
    }
}

#[test]
fn the_square_of_a_constraint_has_no_rank_where_it_holds() {
    /// `(|x|^2 - 1)^2`: zero on the circle, and so is its differential.
    #[derive(Clone, Debug)]
    struct Squared;
    impl Level<2> for Squared {
        fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
            (x * x + y * y - 1.0).powi(2)
        }
    }
    let RodProblem { system, initial, .. } = pendulum(1.0).unwrap().problem;
    let squared = LevelSet::new(0, Squared);
    let error = Rattle::new(&system, squared, &initial, Dense::<1>(REFUSE)).unwrap_err();
    let ConstraintError::Singular { ratio, row: 0 } = error else { panic!("{error}") };
    assert!(ratio < 1e-8);
}

#[test]
fn redundant_rods_share_their_force_and_move_as_the_independent_ones() {
    let (five, six) = (square(1, 2.0, [0.3, 0.2]).unwrap(), square(2, 2.0, [0.3, 0.2]).unwrap());
    let error = Rattle::new(&six.system, six.rods.clone(), &six.initial, SparseDiagonal(REFUSE))
        .unwrap_err();
    assert!(matches!(error, ConstraintError::Singular { .. }), "{error}");
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let mut both = Rattle::new(&six.system, six.rods.clone(), &six.initial, shared).unwrap();
    let mut one =
        Rattle::new(&five.system, five.rods.clone(), &five.initial, SparseDiagonal(REFUSE))
            .unwrap();
    let (mut a, mut b) = (six.initial.clone(), five.initial.clone());
    for _ in 0..1000 {
        both.step(&mut a, 0.01).unwrap();
        one.step(&mut b, 0.01).unwrap();
        assert!(a.q.iter().zip(&b.q).all(|(a, b)| (a - b).abs() < 1e-10));
        // By symmetry all sides carry alike, and so do the diagonals.
        let tension = |rod: usize| six.rods.rods()[rod].tension(both.multipliers()[rod]);
        for side in 1..4 {
            assert!((tension(side) - tension(0)).abs() < 1e-9);
        }
        assert!((tension(5) - tension(4)).abs() < 1e-9);
    }
}

#[test]
fn a_rod_that_is_pulled_beyond_its_strength_breaks_in_that_step() {
    // At the bottom of a full swing the tension is 1 + speed^2: 3 is passed on the way down.
    let pendulum = pendulum(1.9).unwrap();
    let RodProblem { system, initial, .. } = &pendulum.problem;
    let rods = vec![Rod::new([1, 0], 1.0).with_strength(3.0)];
    let rods = Rods::new(1, vec![[0.0, 0.0]], rods).unwrap();
    let quarter = 0.25 * pendulum.period;
    let mut state = pendulum.state(-quarter);
    state.t = 0.0;
    let choice = Dense::<1>(REFUSE);
    let mut rattle = Rattle::new(system, rods, &state, choice).unwrap();
    let h = 1e-3;
    let broken = loop {
        let (_, broken) = rattle.step_and_break(&mut state, h, choice).unwrap();
        if let Some(broken) = broken {
            break broken;
        }
        assert!(state.t < quarter, "it should have broken on the way down");
    };
    assert!((broken.time - state.t).abs() < 1e-15);
    assert_eq!((broken.index, rattle.constraint().count()), (0, 0));
    assert!(pendulum.tension(broken.time - quarter) >= 3.0 - 1e-5);
    assert!(pendulum.tension(broken.time - quarter - 2.0 * h) < 3.0);
    // Then it flies on a parabola.
    let (start, q, p) = (state.t, state.q, state.p.0);
    for _ in 0..100 {
        rattle.step(&mut state, h).unwrap();
    }
    let t = state.t - start;
    assert!((state.q[0] - q[0] - p[0] * t).abs() < 1e-12);
    assert!((state.q[1] - q[1] - p[1] * t + 0.5 * t * t).abs() < 1e-12);
    assert!(initial.q[1] == -1.0);
}

/// A bead on a straight wire through the origin that turns at a constant rate.
#[derive(Clone, Debug)]
struct TurningWire {
    rate: f64,
}

impl Function<2, 1> for TurningWire {
    fn value<R: Number>(&self, t: R, [x, y]: [R; 2]) -> [R; 1] {
        let angle = t * self.rate;
        [y * angle.cos() - x * angle.sin()]
    }
}

#[test]
fn the_work_of_a_motor_is_the_energy_that_the_system_gains() {
    // Free of gravity the bead leaves as r = cosh(rate t).
    let metric = DiagonalMetric::new([1.0; 2]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, 0.0], masses: vec![1.0] };
    let system = System::new(metric, gravity).unwrap();
    let wire = || FunctionConstraint::new(TurningWire { rate: 1.3 }, [0, 1]).unwrap();
    let initial = State::new([1.0, 0.0], Covector([0.0, 1.3]));
    let energy = |state: &State<[f64; 2]>| system.energy(&state.q, state.p.view());
    let errors = |steps: u32| {
        let mut state = initial.clone();
        let mut rattle = Rattle::new(&system, wire(), &state, Dense::<1>(REFUSE)).unwrap();
        let h = 1.0 / f64::from(steps);
        let mut work = 0.0;
        for _ in 0..steps {
            work += rattle.step(&mut state, h).unwrap().work;
        }
        let radius = state.q[0].hypot(state.q[1]);
        let gained = energy(&state) - energy(&initial);
        [(radius - 1.3_f64.cosh()).abs(), (work - gained).abs()]
    };
    let (coarse, fine) = (errors(200), errors(400));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.1, "{order}: {coarse:e} {fine:e}");
    }
}

/// A floor that rises at 0.7 m/s.
#[derive(Clone, Debug)]
struct Lift;

impl Level<2> for Lift {
    fn value<R: Number>(&self, t: R, [_, y]: [R; 2]) -> R {
        y - t * 0.7
    }
}

#[test]
fn the_work_of_a_lift_is_the_energy_gained_by_step_and_project_too() {
    let metric = DiagonalMetric::new([3.0; 2]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -2.0], masses: vec![3.0] };
    let system = System::new(metric, gravity).unwrap();
    let initial = State::new([0.0, 0.0], Covector([1.0, 3.0 * 0.7]));
    let verlet = StormerVerlet::new(&system).unwrap();
    let lift = LevelSet::new(0, Lift);
    let choice = Dense::<1>(REFUSE);
    let mut method = StepAndProject::new(verlet, &system, lift, &initial, choice).unwrap();
    let mut state = initial.clone();
    for k in 1..=10 {
        let report = method.step(&mut state, 0.1).unwrap();
        // Weight times way.
        assert!((report.work - 6.0 * 0.07).abs() < 1e-14, "{report:?}");
        let gained =
            system.energy(&state.q, state.p.view()) - system.energy(&initial.q, initial.p.view());
        assert!((gained - 0.42 * f64::from(k)).abs() < 1e-13);
    }
}

#[test]
fn a_constraint_that_stays_does_no_work() {
    let RodProblem { system, rods, initial } = four_bar(1.0, 2.0).unwrap().problem;
    let mut state = initial.clone();
    let mut rattle = Rattle::new(&system, rods, &initial, Dense::<3>(REFUSE)).unwrap();
    for _ in 0..100 {
        assert_eq!(rattle.step(&mut state, 0.01).unwrap().work, 0.0);
    }
}

#[test]
fn the_angle_of_a_pendulum_has_order_one_and_keeps_its_energy_near() {
    for speed in [0.5, 1.9, 2.5] {
        let exact = pendulum(speed).unwrap();
        let pendulum = ArcsinePendulum::new(1.0, 1.0, 1.0).unwrap();
        let mut points = Vec::new();
        for steps in [400_u32, 800, 1600, 3200] {
            let h = exact.period / f64::from(steps);
            let mut state = State::new([exact.angle(0.7)], Covector([exact.rate(0.7)]));
            state.t = 0.7;
            let mut worst = 0.0_f64;
            for _ in 0..steps {
                pendulum.step(&mut state, h).unwrap();
                worst = worst.max((state.q[0] - exact.angle(state.t)).abs());
            }
            points.push((h, worst));
        }
        let order = loglog_slope(&points).unwrap();
        assert!((order - 1.0).abs() < 0.1, "{speed}: {order}");
    }
    let pendulum = ArcsinePendulum::new(1.0, 1.0, 1.0).unwrap();
    let mut state = State::new([1.5], Covector([0.0]));
    let mut worst = 0.0_f64;
    for _ in 0..100_000 {
        pendulum.step(&mut state, 0.01).unwrap();
        let energy = 0.5 * state.p.0[0].powi(2) - state.q[0].cos();
        worst = worst.max((energy + 1.5_f64.cos()).abs());
    }
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn a_bob_that_moves_more_than_a_rod_in_a_step_is_too_fast_for_its_angle() {
    let pendulum = ArcsinePendulum::new(2.0, 0.5, 9.81).unwrap();
    let mut state = State::new([0.0], Covector([1.0]));
    pendulum.step(&mut state.clone(), 0.49).unwrap();
    let error = pendulum.step(&mut state, 0.51).unwrap_err();
    let ConstraintError::TooFast { ratio } = error else { panic!("{error}") };
    assert!((ratio - 1.02).abs() < 1e-12);
    assert_eq!(state, State::new([0.0], Covector([1.0])));
    for bad in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, f64::NAN]] {
        assert!(ArcsinePendulum::new(bad[0], bad[1], bad[2]).is_err());
    }
}

#[test]
fn a_penalty_is_stable_below_the_predicted_step_and_unstable_above() {
    let pendulum = pendulum(0.5).unwrap();
    let RodProblem { system, rods, initial } = &pendulum.problem;
    for stiffness in [1e3, 1e5] {
        let penalty = Penalty::new(rods.clone(), stiffness, 0.0).unwrap();
        let stiff = System::new(
            DiagonalMetric::new([1.0; 2]).unwrap(),
            (system.potential().clone(), penalty),
        )
        .unwrap();
        let survives = |part: f64| {
            let mut verlet = StormerVerlet::new(&stiff).unwrap();
            let predicted = stiff
                .potential()
                .1
                .stable_step(verlet.facts(), stiff.metric(), &initial.q)
                .unwrap();
            let mut state = initial.clone();
            (0..2000).all(|_| {
                verlet.step(&mut state, part * predicted).is_ok()
                    && (state.q[0].hypot(state.q[1]) - 1.0).abs() < 0.1
            })
        };
        assert!(survives(0.9), "{stiffness}");
        assert!(!survives(1.1), "{stiffness}");
    }
}

#[test]
fn a_penalty_is_violated_in_inverse_proportion_to_its_stiffness() {
    let pendulum = pendulum(1.0).unwrap();
    let RodProblem { system, rods, initial } = &pendulum.problem;
    let mut points = Vec::new();
    for stiffness in [1e3, 1e4, 1e5] {
        let penalty = Penalty::new(rods.clone(), stiffness, 0.0).unwrap();
        let metric = DiagonalMetric::new([1.0; 2]).unwrap();
        let stiff = System::new(metric, (system.potential().clone(), penalty)).unwrap();
        let mut verlet = StormerVerlet::new(&stiff).unwrap();
        let h = 0.2 / f64::sqrt(stiffness);
        let mut state = initial.clone();
        let mut worst = 0.0_f64;
        while state.t < 3.0 {
            verlet.step(&mut state, h).unwrap();
            worst = worst.max((state.q[0].hypot(state.q[1]) - 1.0).abs());
        }
        points.push((stiffness, worst));
    }
    let slope = loglog_slope(&points).unwrap();
    assert!((slope + 1.0).abs() < 0.05, "{slope}: {points:?}");
}

#[test]
fn linear_momentum_of_a_free_square_survives_the_projections() {
    let RodProblem { system, rods, initial } = square(1, 2.0, [0.3, 0.2]).unwrap();
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut method =
        StepAndProject::new(verlet, &system, rods, &initial, SparseDiagonal(REFUSE)).unwrap();
    let mut state = initial.clone();
    let start = linear_momentum::<2>(&state);
    for _ in 0..1000 {
        method.step(&mut state, 0.01).unwrap();
        let now = linear_momentum::<2>(&state);
        assert!((now[0] - start[0]).abs() + (now[1] - start[1]).abs() < 1e-13);
    }
}

#[test]
fn a_parallelogram_that_lies_flat_has_no_rank() {
    // All three rods lie along one line: pins that move across it change no length to first order.
    let metric = DiagonalMetric::new([1.0; 4]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0; 2] };
    let system = System::new(metric, gravity).unwrap();
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0), Rod::new([1, 3], 1.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0], [2.0, 0.0]], rods).unwrap();
    let at = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let state = State::new([c, s, c + 2.0, s], Covector([0.0; 4]));
        Rattle::new(&system, rods.clone(), &state, Dense::<3>(REFUSE)).map(|_| ())
    };
    assert_eq!(at(0.5), Ok(()));
    let error = at(0.0).unwrap_err();
    assert!(matches!(error, ConstraintError::Singular { ratio, .. } if ratio < 1e-15), "{error}");
}

#[test]
fn a_rod_whose_loss_is_refused_stays_and_so_does_the_state() {
    // A weight in the middle of four hooks, two rods more than hold it.
    let hooks = vec![[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let rods = (1..=4).map(|hook| Rod::new([0, hook], 1.0).with_strength(0.1)).collect();
    let rods = Rods::new(1, hooks, rods).unwrap();
    let metric = DiagonalMetric::new([1.0; 2]).unwrap();
    let gravity = UniformGravity { acceleration: [0.3, -1.0], masses: vec![1.0] };
    let system = System::new(metric, gravity).unwrap();
    let initial = State::new([0.0; 2], Covector([0.0; 2]));
    let share = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = Rattle::new(&system, rods.clone(), &initial, share).unwrap();
    let mut state = initial.clone();
    // Three are still too many for a solver that refuses.
    let refuse = SparseDiagonal(Redundancy::Refuse);
    let error = rattle.step_and_break(&mut state, 1e-3, refuse).unwrap_err();
    assert!(matches!(error, ConstraintError::Singular { row: 2, .. }), "{error}");
    assert_eq!((&state, rattle.constraint()), (&initial, &rods));
    let (_, broken) = rattle.step_and_break(&mut state, 1e-3, share).unwrap();
    assert_eq!((broken.unwrap().time, state.t), (1e-3, 1e-3));
}
