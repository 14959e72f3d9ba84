//! Bad input is refused by name, and leaves the state as it was.

use stationary_calculus::{Covector, DiagonalMetric, Number, Sink, SizeError, System};
use stationary_constraints::problems::{
    RodProblem, chain, four_bar, pendulum, slider_crank, square, writhing_chain,
};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, ConstraintError, Dense, FixedPoint,
    Level, LevelSet, Linear, Pairing, Penalty, Projection, Rattle, Redundancy, Rod, Rods, Rows,
    Scale, SparseDiagonal, StepAndProject,
};
use stationary_integrators::{
    Facts, Integrator, State, StepError, StepReport, StormerVerlet, UniformGravity,
};

const FEW: Dense<3> = Dense(Redundancy::Refuse);

#[test]
fn steps_that_do_not_go_forward_are_refused() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    let mut rattle = Rattle::new(&system, rods.clone(), &initial, FEW).unwrap();
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut project = StepAndProject::new(verlet, &system, rods, &initial, FEW).unwrap();
    let mut state = initial.clone();
    for h in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        for error in [rattle.step(&mut state, h), project.step(&mut state, h)] {
            let error = error.unwrap_err();
            assert!(matches!(error, ConstraintError::Step(StepError::Step(_))), "{error}");
        }
        assert_eq!(state, initial);
    }
}

#[test]
fn problems_refuse_numbers_that_are_not_finite_and_speeds_that_overflow() {
    let made = |x: f64| {
        [
            ("sway", chain(3, x).map(drop)),
            ("rate", writhing_chain(3, x).map(drop)),
            ("angle", four_bar(x, 1.0).map(drop)),
            ("rate", four_bar(1.0, x).map(drop)),
            ("angle", slider_crank(x, 1.0).map(drop)),
            ("rate", slider_crank(1.0, x).map(drop)),
            ("spin", square(1, x, [0.0; 2]).map(drop)),
            ("drift", square(1, 1.0, [0.0, x]).map(drop)),
            ("speed", pendulum(x).map(drop)),
        ]
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (name, made) in made(bad) {
            let Err(ConstraintError::Parameter { what, value, .. }) = made else {
                panic!("{name}: {made:?}")
            };
            assert!(what == name && value.to_bits() == bad.to_bits(), "{name}: {made:?}");
        }
    }
    assert!(made(0.5).iter().all(|(_, made)| made.is_ok()));
    let what = "momentum";
    assert_eq!(chain(3, f64::MAX).err(), Some(ConstraintError::NonFinite { what, index: 2 }));
    let drift = square(1, f64::MAX, [f64::MAX; 2]);
    assert_eq!(drift.err(), Some(ConstraintError::NonFinite { what, index: 0 }));
}

#[test]
fn a_square_has_one_or_two_diagonals() {
    for diagonals in [0, 3, usize::MAX] {
        let error = square(diagonals, 1.0, [0.0; 2]).unwrap_err();
        let value = diagonals as f64;
        let expected =
            ConstraintError::Parameter { what: "the number of diagonals", value, range: "1 or 2" };
        assert_eq!(error, expected);
    }
    for diagonals in [1, 2] {
        assert_eq!(square(diagonals, 1.0, [0.0; 2]).unwrap().rods.count(), 4 + diagonals);
    }
}

#[test]
fn a_constraint_on_a_particle_that_is_not_there_is_refused() {
    let RodProblem { system, initial, .. } = pendulum(1.0).unwrap().problem;
    let held = FixedPoint::new(1, [0.0, 0.0]).unwrap();
    let error = Rattle::new(&system, held, &initial, FEW).unwrap_err();
    assert_eq!(error, ConstraintError::Freedoms { needed: 4, freedoms: 2 });
    let rods = Rods::<2>::new(2, Vec::new(), vec![Rod::new([0, 1], 1.0)]).unwrap();
    let error = Rattle::new(&system, rods, &initial, FEW).unwrap_err();
    assert_eq!(error, ConstraintError::Freedoms { needed: 4, freedoms: 2 });
}

/// A constraint that says it reads one freedom, and brings an entry of another.
#[derive(Debug)]
struct Lying;

impl Constraint for Lying {
    fn dim(&self) -> usize {
        1
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, _: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        g[0] = q[0];
        Ok(())
    }

    fn differential(&self, _: f64, _: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        rows.add(0, 5, 1.0);
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        _: &[f64],
        _: &[f64],
        _: &mut impl Sink,
    ) -> Result<(), SizeError> {
        Ok(())
    }
}

#[test]
fn an_entry_outside_of_the_differential_is_refused_by_place() {
    let RodProblem { system, initial, .. } = pendulum(1.0).unwrap().problem;
    let error = Rattle::new(&system, Lying, &initial, FEW).unwrap_err();
    let expected = ConstraintError::UnknownFreedom { row: 0, freedom: 5, rows: 1, freedoms: 2 };
    assert_eq!(error, expected);
}

#[test]
fn more_equations_than_the_solver_has_room_for_are_refused() {
    let RodProblem { system, rods, initial } = four_bar(1.0, 1.0).unwrap().problem;
    let few = Dense::<2>(Redundancy::Refuse);
    let error = Rattle::new(&system, rods, &initial, few).unwrap_err();
    assert_eq!(error, ConstraintError::TooMany { room: 2, count: 3 });
}

#[test]
fn a_point_that_is_held_twice_is_singular_and_named() {
    let RodProblem { system, initial, .. } = pendulum(1.0).unwrap().problem;
    let mut rest = initial.clone();
    rest.p.0 = [0.0; 2];
    let hold = || FixedPoint::new(0, [0.0, -1.0]).unwrap();
    let both = (hold(), hold());
    let few = SparseDiagonal(Redundancy::Refuse);
    let error = Rattle::new(&system, both, &rest, few).unwrap_err();
    assert!(matches!(error, ConstraintError::Singular { ratio, .. } if ratio < 1e-12), "{error}");
    // Shared, the two holds carry half of the weight each.
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = Rattle::new(&system, (hold(), hold()), &rest, shared).unwrap();
    let mut state = rest.clone();
    rattle.step(&mut state, 0.1).unwrap();
    let lambda = rattle.multipliers();
    assert!((lambda[1] + 0.5).abs() < 1e-12 && (lambda[3] + 0.5).abs() < 1e-12, "{lambda:?}");
    assert_eq!(state.q, rest.q);
}

#[test]
fn equations_that_are_none_are_refused_by_number() {
    let good = || (vec![(0, 1.0)], 0.0);
    let bad = [
        (vec![(0, f64::NAN)], 0.0),
        (vec![(0, 1.0)], f64::INFINITY),
        (vec![(0, 1.0), (0, 2.0)], 0.0),
        (vec![(0, 0.0)], 0.0),
        (Vec::new(), 1.0),
    ];
    for equation in bad {
        let error = Linear::new(vec![good(), equation]).unwrap_err();
        assert_eq!(error, ConstraintError::Equation { row: 1 });
    }
    assert!(FixedPoint::new(0, [f64::NAN, 0.0]).is_err());
}

/// A level function with a scale of its own, and a value that may not be one.
#[derive(Clone, Debug)]
struct Odd {
    value: f64,
    slope: f64,
}

impl Level<2> for Odd {
    fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
        (x * x + y * y - 1.0) * self.value
    }

    fn scale(&self) -> Scale {
        Scale { slope: self.slope, ..Scale::default() }
    }
}

#[test]
fn scales_and_values_that_are_no_numbers_are_refused() {
    let RodProblem { system, initial, .. } = pendulum(1.0).unwrap().problem;
    for slope in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let odd = || LevelSet::new(0, Odd { value: 1.0, slope });
        let error = Rattle::new(&system, odd(), &initial, FEW).unwrap_err();
        assert!(matches!(error, ConstraintError::Parameter { what: "slope", .. }), "{error}");
        assert!(Penalty::new(odd(), 1.0, 0.0).is_err());
    }
    let odd = LevelSet::new(0, Odd { value: f64::NAN, slope: 2.0 });
    let error = Rattle::new(&system, odd.clone(), &initial, FEW).unwrap_err();
    assert!(matches!(error, ConstraintError::NonFinite { .. }), "{error}");
    let mut state = initial.clone();
    let mut projection = Projection::new(&system, odd, &state, FEW).unwrap();
    assert!(projection.project(&mut state).is_err());
    assert_eq!(state, initial);
}

#[test]
fn states_that_are_no_numbers_are_refused() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = initial.clone();
        state.q[0] = bad;
        assert!(Rattle::new(&system, rods.clone(), &state, FEW).is_err());
        let mut state = initial.clone();
        state.p.0[0] = bad;
        assert!(Rattle::new(&system, rods.clone(), &state, FEW).is_err());
        let mut rattle = Rattle::new(&system, rods.clone(), &initial, FEW).unwrap();
        let before = state.p.0.map(f64::to_bits);
        assert!(rattle.step(&mut state, 0.1).is_err());
        assert_eq!(state.p.0.map(f64::to_bits), before);
    }
}

#[test]
fn a_state_of_another_size_is_refused() {
    let metric = DiagonalMetric::new(vec![1.0; 2]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0] };
    let system = System::new(metric, gravity).unwrap();
    let rods = Rods::new(1, vec![[0.0, 0.0]], vec![Rod::new([1, 0], 1.0)]).unwrap();
    let state = State::new(vec![0.0, -1.0, 0.0], Covector(vec![0.0; 2]));
    let error = Rattle::new(&system, rods, &state, FEW).unwrap_err();
    assert!(matches!(error, ConstraintError::Size(_)), "{error}");
}

#[test]
fn a_state_that_was_moved_off_between_steps_is_refused() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    let mut rattle = Rattle::new(&system, rods, &initial, FEW).unwrap();
    let mut state = initial.clone();
    rattle.step(&mut state, 0.01).unwrap();
    let good = state.clone();
    state.q[1] -= 1e-6;
    let moved = state.clone();
    let error = rattle.step(&mut state, 0.01).unwrap_err();
    let ConstraintError::Infeasible { violation, .. } = error else { panic!("{error}") };
    assert!((violation - 1e-6).abs() < 1e-8);
    assert_eq!(state, moved);
    rattle.step(&mut good.clone(), 0.01).unwrap();
}

#[test]
fn a_state_at_no_time_is_refused() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    for t in [f64::NAN, f64::INFINITY] {
        let mut state = State { t, ..initial.clone() };
        let error = Rattle::new(&system, rods.clone(), &state, FEW).unwrap_err();
        assert!(matches!(error, ConstraintError::Step(StepError::Time(_))), "{error}");
        let mut rattle = Rattle::new(&system, rods.clone(), &initial, FEW).unwrap();
        assert!(rattle.step(&mut state, 0.1).is_err());
    }
}

#[test]
fn step_and_project_refuses_a_velocity_that_stretches_a_rod() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    let mut state = initial;
    state.p.0[1] += 1e-3;
    let verlet = StormerVerlet::new(&system).unwrap();
    let error = StepAndProject::new(verlet, &system, rods, &state, FEW).unwrap_err();
    assert!(matches!(error, ConstraintError::InfeasibleVelocity { row: 0, .. }), "{error}");
}

/// Counts what a constraint brings.
#[derive(Default)]
struct Brought(usize);

impl Rows for Brought {
    fn add(&mut self, _: usize, _: usize, _: f64) {
        self.0 += 1;
    }
}

impl Sink for Brought {
    fn add_symmetric(&mut self, _: &[usize], _: &[f64]) {
        self.0 += 1;
    }
}

/// Everything that a constraint is asked with fewer numbers, values and multipliers than it has.
fn refuses_other_sizes(constraint: &impl Constraint, enough: usize) {
    let count = constraint.count();
    let (q, mut g, mut brought) = (vec![0.3; enough], vec![0.0; count], Brought::default());
    assert_eq!(constraint.value(0.0, &q, &mut g), Ok(()));
    let what = "the configuration's numbers";
    let short = Err(SizeError { what, expected: enough, got: enough - 1 });
    let fewer = &q[..enough - 1];
    assert_eq!(constraint.value(0.0, fewer, &mut g), short);
    assert_eq!(constraint.differential(0.0, fewer, &mut brought), short);
    assert_eq!(constraint.add_hessian(0.0, fewer, &g, &mut brought), short);
    assert_eq!(brought.0, 0);
    for other in [count - 1, count + 1] {
        let refused = |what| Err(SizeError { what, expected: count, got: other });
        let mut values = vec![0.0; other];
        let sizes = refused("the constraint's values");
        assert_eq!(constraint.value(0.0, &q, &mut values), sizes);
        assert_eq!(constraint.rate(0.0, &q, &mut values), sizes);
        let hessian = constraint.add_hessian(0.0, &q, &values, &mut brought);
        assert_eq!(hessian, refused("the constraint's multipliers"));
        assert!(Pairing::new(constraint, values, 0.0).is_err());
    }
}

#[test]
fn every_constraint_refuses_too_few_numbers_and_other_counts_of_values() {
    let RodProblem { rods, .. } = pendulum(1.0).unwrap().problem;
    refuses_other_sizes(&rods, 2);
    let point = FixedPoint::new(1, [0.0, 1.0]).unwrap();
    refuses_other_sizes(&point, 4);
    let lines = Linear::new(vec![(vec![(0, 1.0), (2, 1.0)], 0.5), (vec![(1, 2.0)], 0.0)]).unwrap();
    refuses_other_sizes(&lines, 3);
    refuses_other_sizes(&LevelSet::new(2, Odd { value: 1.0, slope: 2.0 }), 6);
    // A vertex beyond all counting is one that is not there.
    let beyond = FixedPoint::new(usize::MAX, [0.0, 1.0]).unwrap();
    assert!(beyond.value(0.0, &[0.3; 4], &mut [0.0; 2]).is_err());
    // Of a set whose members read equally far the first refuses.
    refuses_other_sizes(&vec![point, point], 4);
    refuses_other_sizes(&(point, point), 4);
}

#[test]
fn a_penalty_has_no_frequency_under_a_metric_or_at_a_configuration_that_is_too_small() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    let penalty = Penalty::new(rods, 10.0, 0.0).unwrap();
    let small = DiagonalMetric::new([1.0]).unwrap();
    let what = "the metric's freedoms";
    let error = penalty.highest_frequency(&small, &initial.q).unwrap_err();
    assert_eq!(error, SizeError { what, expected: 2, got: 1 });
    let verlet: StormerVerlet<'_, _, _, [f64; 2]> = StormerVerlet::new(&system).unwrap();
    let facts = Integrator::<[f64; 2]>::facts(&verlet);
    assert!(penalty.stable_step(facts, system.metric(), &initial.q[..1]).is_err());
}

/// A method that throws what is not constrained out of the world.
struct Throwing<I>(I);

impl<I: Integrator<[f64; 2]>> Integrator<[f64; 2]> for Throwing<I> {
    fn facts(&self) -> Facts {
        self.0.facts()
    }

    fn step(&mut self, state: &mut State<[f64; 2]>, h: f64) -> Result<StepReport, StepError> {
        let report = self.0.step(state, h)?;
        state.q[0] = f64::INFINITY;
        Ok(report)
    }
}

#[test]
fn a_step_that_leaves_the_numbers_where_nothing_is_constrained_is_refused() {
    let RodProblem { system, .. } = pendulum(1.0).unwrap().problem;
    let initial = State::new([1.0, 0.0], Covector([1.0, 0.0]));
    let floor = Linear::new(vec![(vec![(1, 1.0)], 0.0)]).unwrap();
    let throwing = Throwing(StormerVerlet::new(&system).unwrap());
    let mut project = StepAndProject::new(throwing, &system, floor, &initial, FEW).unwrap();
    let mut state = initial.clone();
    let error = project.step(&mut state, 0.1).unwrap_err();
    let expected = StepError::NonFiniteConfiguration { freedom: 0 };
    assert_eq!(error, ConstraintError::Step(expected));
    assert_eq!(state, initial);
}

/// Two crossed lines.
#[derive(Clone, Debug)]
struct Cross;

impl Level<2> for Cross {
    fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
        x * y
    }
}

#[test]
fn a_step_that_ends_where_equations_have_no_rank_is_refused_and_leaves_the_state() {
    let metric = DiagonalMetric::new([1.0; 2]).unwrap();
    let free = UniformGravity { acceleration: [0.0, 0.0], masses: vec![1.0] };
    let system = System::new(metric, free).unwrap();
    let initial = State::new([-1.0, 0.0], Covector([1.0, 0.0]));
    let cross = || LevelSet::new(0, Cross);
    let mut hamilton = ConstrainedHamilton::new(&system, cross(), &initial, FEW).unwrap();
    let mut rattle = Rattle::new(&system, cross(), &initial, FEW).unwrap();
    let mut state = initial.clone();
    for step in [hamilton.step(&mut state, 1.0), rattle.step(&mut state, 1.0)] {
        let error = step.unwrap_err();
        assert!(
            matches!(&error, ConstraintError::SingularPosition { rows, .. } if *rows == [0]),
            "{error}"
        );
    }
    assert_eq!(state, initial);
    hamilton.step(&mut state, 0.9).unwrap();
}
