//! No step allocates: every method, on arrays and on vectors, dense and sparse.

use allocation_counter::measure;
use stationary_calculus::Storage;
use stationary_constraints::problems::{RodProblem, four_bar, pendulum, square};
use stationary_constraints::{
    Adaptive, ConstrainedHamilton, ConstrainedIntegrator, Dense, Rattle, Redundancy,
    SparseDiagonal, StepAndProject, StepTolerance,
};
use stationary_integrators::{State, StormerVerlet};

/// Allocations in ten steps after two.
fn allocations<C: Storage>(
    method: &mut impl ConstrainedIntegrator<C>,
    state: &State<C>,
    h: f64,
) -> u64 {
    let mut state = state.clone();
    let mut steps = |count: u32| {
        for _ in 0..count {
            method.step(&mut state, h).unwrap();
        }
    };
    steps(2);
    measure(|| steps(10)).count_total
}

#[test]
fn no_method_allocates_in_a_step() {
    let RodProblem { system, rods, initial } = pendulum(1.0).unwrap().problem;
    let few = Dense::<1>(Redundancy::Refuse);
    let mut rattle = Rattle::new(&system, rods.clone(), &initial, few).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.01), 0);
    let mut hamilton = ConstrainedHamilton::new(&system, rods.clone(), &initial, few).unwrap();
    assert_eq!(allocations(&mut hamilton, &initial, 0.01), 0);
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut project = StepAndProject::new(verlet, &system, rods, &initial, few).unwrap();
    assert_eq!(allocations(&mut project, &initial, 0.01), 0);
    let RodProblem { system, rods, initial } = square(2, 1.0, [0.1, 0.2]).unwrap();
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = Rattle::new(&system, rods, &initial, shared).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.01), 0);
    let RodProblem { system, rods, initial } = four_bar(1.0, 1.0).unwrap().problem;
    let few = Dense::<3>(Redundancy::Refuse);
    let mut rattle = Rattle::new(&system, rods, &initial, few).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.01), 0);
}

#[test]
fn adaptive_steps_and_output_between_them_do_not_allocate() {
    let RodProblem { system, rods, initial } = square(2, 1.0, [0.1, 0.2]).unwrap();
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let rattle = Rattle::new(&system, rods, &initial, shared).unwrap();
    let tolerance = StepTolerance { absolute: 1e-6, relative: 0.0 };
    let mut method = Adaptive::new(rattle, tolerance, 0.01, &initial).unwrap();
    let (mut state, mut between) = (initial.clone(), initial.clone());
    let mut forces = vec![0.0; method.integrator().multipliers().len()];
    let mut steps = |count: u32| {
        for _ in 0..count {
            let step = method.advance(&mut state, 100.0).unwrap();
            let t = step.from + 0.6 * (step.to - step.from);
            method.at(t, &mut between, &mut forces).unwrap();
        }
    };
    steps(2);
    assert_eq!(measure(|| steps(10)).count_total, 0);
}

#[cfg(feature = "sparse")]
#[test]
fn no_sparse_step_allocates() {
    use stationary_calculus::{SparseMetric, SymmetricMatrix, System};
    use stationary_constraints::problems::chain;
    use stationary_constraints::{Redundancy, SparseDiagonal, SparseGeneral};
    let RodProblem { system, rods, initial } = chain(200, 0.1).unwrap();
    let mut rattle =
        Rattle::new(&system, rods.clone(), &initial, SparseDiagonal::default()).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.005), 0);
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = Rattle::new(&system, rods.clone(), &initial, shared).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.005), 0);
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut project =
        StepAndProject::new(verlet, &system, rods.clone(), &initial, SparseDiagonal::default())
            .unwrap();
    assert_eq!(allocations(&mut project, &initial, 0.005), 0);
    let mass = SparseMetric::new(SymmetricMatrix::mass(system.metric()).unwrap()).unwrap();
    let sparse = System::new(mass, system.potential().clone()).unwrap();
    let mut rattle = Rattle::new(&sparse, rods, &initial, SparseGeneral).unwrap();
    assert_eq!(allocations(&mut rattle, &initial, 0.005), 0);
}
