//! Many equations: the sparse solvers against the dense one, and the work of a chain.

use stationary_calculus::{
    Covector, DiagonalMetric, Sink, SizeError, SparseMetric, SymmetricMatrix, System,
};
use stationary_constraints::problems::{
    RodProblem, chain, folded_chain, four_bar, square, writhing_chain,
};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, Dense, Multipliers, Rattle, Redundancy,
    Rod, Rods, Rows, Solver, SparseDiagonal, SparseGeneral,
};
use stationary_integrators::{State, UniformGravity};

const REFUSE: Redundancy = Redundancy::Refuse;

#[test]
fn the_sparse_solvers_do_what_the_dense_one_does() {
    let RodProblem { system, rods, initial } = folded_chain(3).unwrap();
    let mass = SparseMetric::new(SymmetricMatrix::mass(system.metric()).unwrap()).unwrap();
    let sparse = System::new(mass, system.potential().clone()).unwrap();
    let mut few = Rattle::new(&system, rods.clone(), &initial, Dense::<3>(REFUSE)).unwrap();
    let mut many = Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap();
    let mut coupled = Rattle::new(&sparse, rods, &initial, SparseGeneral).unwrap();
    let mut states = [initial.clone(), initial.clone(), initial];
    for _ in 0..100 {
        few.step(&mut states[0], 0.01).unwrap();
        many.step(&mut states[1], 0.01).unwrap();
        coupled.step(&mut states[2], 0.01).unwrap();
    }
    let tensions = few.multipliers();
    for (others, state) in [(many.multipliers(), &states[1]), (coupled.multipliers(), &states[2])] {
        assert!(state.q.iter().zip(&states[0].q).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(others.iter().zip(tensions).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

/// A constraint that says that it needs two freedoms and has one equation, and brings another entry.
struct Stray {
    row: usize,
    freedom: usize,
}

impl Constraint for Stray {
    fn dim(&self) -> usize {
        2
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, _: f64, _: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        g.fill(0.0);
        Ok(())
    }

    fn differential(&self, _: f64, _: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        rows.add(0, 0, 1.0);
        rows.add(self.row, self.freedom, 1.0);
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

/// What the three solvers say to a constraint under unit masses.
fn analysed(constraint: &impl Constraint, masses: usize, q: &[f64]) -> [ConstraintError; 3] {
    fn error(
        solver: impl Solver<Vec<f64>>,
        constraint: &impl Constraint,
        masses: usize,
        q: &[f64],
    ) -> ConstraintError {
        let metric = DiagonalMetric::new(vec![1.0; masses]).unwrap();
        solver.analyse(&metric, constraint, 0.0, q).map(drop).unwrap_err()
    }
    [
        error(Dense::<3>(REFUSE), constraint, masses, q),
        error(SparseDiagonal::default(), constraint, masses, q),
        error(SparseGeneral, constraint, masses, q),
    ]
}

#[test]
fn a_constraint_that_reads_more_freedoms_than_the_metric_has_is_refused_by_every_solver() {
    let rods = Rods::new(2, vec![[0.0; 2]], vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)]);
    for error in analysed(&rods.unwrap(), 2, &[0.0, -1.0, 0.0, -2.0]) {
        assert_eq!(error, ConstraintError::Freedoms { needed: 4, freedoms: 2 });
    }
    for (row, freedom) in [(0, 2), (1, 0), (5, 1), (0, usize::MAX)] {
        let expected = ConstraintError::UnknownFreedom { row, freedom, rows: 1, freedoms: 2 };
        for error in analysed(&Stray { row, freedom }, 2, &[0.0; 2]) {
            assert_eq!(error, expected);
        }
    }
}

#[test]
fn a_solver_refuses_until_it_is_prepared_and_after_a_preparation_that_failed() {
    // All points on a line, where the rods depend on each other; no places; too few.
    let line = [1.0, 0.0, 3.0, 0.0];
    let bad = [&line[..], &[f64::NAN; 4], &line[..3]];
    fn refuses(solver: impl Solver<Vec<f64>>, bad: &[&[f64]]) {
        let RodProblem { system, rods, initial } = four_bar(1.0, 1.0).unwrap().problem;
        let (metric, q) = (system.metric(), initial.q);
        let mut solver = solver.analyse(metric, &rods, 0.0, &q).unwrap();
        let mut numbers = [0.3, -0.2, 0.5];
        assert_eq!(solver.solve(&mut numbers), Err(ConstraintError::NotPrepared));
        assert_eq!(numbers, [0.3, -0.2, 0.5]);
        solver.prepare(metric, &rods, 0.0, &q).unwrap();
        assert!(solver.solve(&mut [1.0; 2]).is_err() && solver.solve(&mut [1.0; 4]).is_err());
        solver.solve(&mut numbers).unwrap();
        for bad in bad {
            solver.prepare(metric, &rods, 0.0, bad).unwrap_err();
            assert_eq!(solver.solve(&mut numbers), Err(ConstraintError::NotPrepared));
            solver.prepare(metric, &rods, 0.0, &q).unwrap();
            solver.solve(&mut numbers).unwrap();
        }
        let other = DiagonalMetric::new(vec![1.0; 2]).unwrap();
        let stray = Stray { row: 0, freedom: 7 };
        assert!(solver.prepare(&other, &stray, 0.0, &q).is_err());
        assert_eq!(solver.solve(&mut numbers), Err(ConstraintError::NotPrepared));
    }
    refuses(Dense::<3>(REFUSE), &bad);
    refuses(SparseDiagonal::default(), &bad);
    refuses(SparseGeneral, &bad);
    // Dependent rods share their force.
    refuses(Dense::<3>(Redundancy::LeastNorm), &bad[1..]);
    refuses(SparseDiagonal(Redundancy::LeastNorm), &bad[1..]);
}

#[test]
fn a_few_equations_that_change_their_entries_are_refused_without_a_panic() {
    let metric = DiagonalMetric::new(vec![1.0; 2]).unwrap();
    let analyse = |freedom| {
        let solver = Dense::<3>(REFUSE);
        Solver::<Vec<f64>>::analyse(&solver, &metric, &Stray { row: 0, freedom }, 0.0, &[0.0; 2])
    };
    let mut few = analyse(1).unwrap();
    for (row, freedom) in [(0, 2), (1, 0), (4, 0)] {
        let error = few.prepare(&metric, &Stray { row, freedom }, 0.0, &[0.0; 2]).unwrap_err();
        assert_eq!(error, ConstraintError::UnknownFreedom { row, freedom, rows: 1, freedoms: 2 });
    }
    let other = DiagonalMetric::new(vec![1.0; 3]).unwrap();
    assert!(few.prepare(&other, &Stray { row: 0, freedom: 1 }, 0.0, &[0.0; 2]).is_err());
}

#[test]
fn a_metric_that_couples_needs_the_saddle_system() {
    // Two points of mass 2 whose freedoms along x are coupled.
    let blocks =
        [(vec![0, 2], vec![2.0, 0.5, 0.5, 2.0]), (vec![1], vec![2.0]), (vec![3], vec![2.0])];
    let mass = SparseMetric::new(SymmetricMatrix::from_blocks(4, &blocks).unwrap()).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![2.0; 2] };
    let system = System::new(mass, gravity).unwrap();
    let links = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
    let rods = Rods::new(2, vec![[0.0; 2]], links).unwrap();
    let initial = State::new(vec![1.0, 0.0, 1.0, -1.0], Covector(vec![0.0; 4]));
    let error =
        Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap_err();
    assert!(matches!(error, ConstraintError::Coupled { .. }), "{error}");
    let mut coupled = Rattle::new(&system, rods.clone(), &initial, SparseGeneral).unwrap();
    let mut few = Rattle::new(&system, rods, &initial, Dense::<2>(REFUSE)).unwrap();
    let (mut a, mut b) = (initial.clone(), initial);
    for _ in 0..200 {
        coupled.step(&mut a, 0.01).unwrap();
        few.step(&mut b, 0.01).unwrap();
    }
    assert!(a.q.iter().zip(&b.q).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn a_solver_takes_the_masses_of_the_metric_that_it_is_prepared_with() {
    fn solves(choice: impl Solver<Vec<f64>>) {
        let RodProblem { rods, initial, .. } = four_bar(1.0, 1.0).unwrap().problem;
        let q = initial.q.to_vec();
        let masses =
            [[1.0; 4], [5.0, 5.0, 0.2, 0.2], [1e18, 1e18, 3e18, 3e18], [1e-18; 4], [2.0; 4]];
        let metrics = masses.map(|masses| DiagonalMetric::new(masses.to_vec()).unwrap());
        let mut kept = choice.analyse(&metrics[0], &rods, 0.0, &q).unwrap();
        for metric in &metrics {
            let mut own = choice.analyse(metric, &rods, 0.0, &q).unwrap();
            let [found, expected] = [&mut kept, &mut own].map(|solver| {
                let mut numbers = [0.3, -0.2, 0.5];
                solver.prepare(metric, &rods, 0.0, &q).unwrap();
                solver.solve(&mut numbers).unwrap();
                numbers
            });
            let off = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() > 1e-12;
            assert!(!found.iter().zip(&expected).any(off), "{found:?} {expected:?}");
        }
        let other = DiagonalMetric::new(vec![1.0; 6]).unwrap();
        assert!(kept.prepare(&other, &rods, 0.0, &q).is_err());
        assert_eq!(kept.solve(&mut [1.0; 3]), Err(ConstraintError::NotPrepared));
    }
    solves(Dense::<3>(REFUSE));
    solves(SparseDiagonal(REFUSE));
    solves(SparseGeneral);
}

#[test]
fn the_work_of_a_chain_grows_with_its_links() {
    // Each link turns by up to a hundredth of a radian a step.
    let mut counts = Vec::new();
    for n in [10, 100, 1_000, 10_000, 100_000] {
        let RodProblem { system, rods, initial } = writhing_chain(n, 1.0).unwrap();
        let h = 0.01 / (n as f64 / 10.0).sqrt().max(1.0);
        let solver = Solver::<Vec<f64>>::analyse(
            &SparseDiagonal::default(),
            system.metric(),
            &rods,
            0.0,
            &initial.q,
        );
        let factor_per_link = solver.unwrap().factor_len() as f64 / n as f64;
        let mut state = initial.clone();
        let mut rattle = Rattle::new(&system, rods, &initial, SparseDiagonal::default()).unwrap();
        let mut most = 0;
        for _ in 0..5 {
            let report = rattle.step(&mut state, h).unwrap();
            assert!(report.violation <= 1e-12 + 8.0 * f64::EPSILON * n as f64);
            most = most.max(report.iterations);
        }
        counts.push((factor_per_link, most));
    }
    println!("{counts:?}");
    assert!(counts.iter().all(|&(factor, _)| factor < 4.0), "{counts:?}");
    assert!(counts.iter().all(|&(_, iterations)| iterations <= 10), "{counts:?}");
}

#[test]
fn the_tension_of_a_chain_at_rest_is_the_weight_below() {
    let n = 1000;
    let RodProblem { system, rods, initial } = chain(n, 0.0).unwrap();
    let mut rattle =
        Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap();
    let mut state = initial.clone();
    rattle.step(&mut state, 1e-3).unwrap();
    for (i, (rod, lambda)) in rods.rods().iter().zip(rattle.multipliers()).enumerate() {
        let weight = (n - i) as f64;
        assert!((rod.tension(*lambda) - weight).abs() < 1e-9 * n as f64, "link {i}");
    }
    let apart = state.q.iter().zip(&initial.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
}

#[test]
fn redundant_rods_are_refused_by_all_solvers() {
    let RodProblem { system, rods, initial } = square(2, 1.0, [0.0; 2]).unwrap();
    let error =
        Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap_err();
    let ConstraintError::Singular { ratio, .. } = error else { panic!("{error}") };
    assert!(ratio < 1e-14);
    let coupled = Rattle::new(&system, rods, &initial, SparseGeneral).unwrap_err();
    assert_eq!(coupled, ConstraintError::Dependent { row: None });
}

#[test]
fn linkages_of_arrays_are_stepped_by_the_sparse_solver_too() {
    let RodProblem { system, rods, initial } = four_bar(1.0, 1.0).unwrap().problem;
    let mut many = Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap();
    let mut few = Rattle::new(&system, rods, &initial, Dense::<3>(REFUSE)).unwrap();
    let (mut a, mut b) = (initial.clone(), initial);
    for _ in 0..100 {
        many.step(&mut a, 0.01).unwrap();
        few.step(&mut b, 0.01).unwrap();
    }
    assert!(a.q.iter().zip(&b.q).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn sharing_changes_nothing_where_nothing_is_redundant() {
    let RodProblem { system, rods, initial } = folded_chain(200).unwrap();
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let mut sharing = Rattle::new(&system, rods.clone(), &initial, shared).unwrap();
    let mut plain = Rattle::new(&system, rods, &initial, SparseDiagonal::default()).unwrap();
    let (mut a, mut b) = (initial.clone(), initial);
    for _ in 0..50 {
        sharing.step(&mut a, 0.001).unwrap();
        plain.step(&mut b, 0.001).unwrap();
    }
    assert!(a.q.iter().zip(&b.q).all(|(a, b)| (a - b).abs() < 1e-12));
    let pairs = sharing.multipliers().iter().zip(plain.multipliers());
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-8 * (1.0 + b.abs())));
}
