//! No step allocates: every method, on arrays and on vectors, dense and sparse.

use std::ops::ControlFlow;

use allocation_counter::measure;
use nalgebra::dmatrix;
use stationary_calculus::{BilinearForm, Covector, Force, Sink, Vector};
use stationary_calculus::{DiagonalMetric, SparseSolver, Storage, System};
use stationary_calculus::{Metric, Potential, Stencils};
use stationary_elasticity::{Net, Strain, net};
use stationary_integrators::problems::kepler;
use stationary_integrators::{
    Evaluation, Filter, Gautschi, Imex, Integrator, Method, Newmark, NewmarkWeights, Nystrom,
    NystromPair, Pair8, Pair12, PotentialPower, ReversibleSteps, State, StormerVerlet, Tolerance,
    UniformGravity,
};

/// Allocations in ten steps after a first one.
fn allocations<C: Storage>(integrator: &mut dyn Integrator<C>, state: &State<C>, h: f64) -> u64 {
    let mut state = state.clone();
    integrator.step(&mut state, h).unwrap();
    let counted = measure(|| {
        for _ in 0..10 {
            integrator.step(&mut state, h).unwrap();
        }
    });
    counted.count_total
}

fn checked<M: Metric, P: Potential, C: Storage>(
    method: Method,
    system: &System<M, P>,
    state: &State<C>,
    h: f64,
) {
    let mut integrator = method.integrator(system).unwrap();
    assert_eq!(allocations(&mut *integrator, state, h), 0, "{method}");
}

#[test]
fn no_method_allocates_in_a_step() {
    let planet = kepler(0.6).unwrap();
    let State { q, p, .. } = planet.initial.clone();
    for &method in Method::ALL {
        checked(method, &planet.system, &planet.initial, 0.01);
        checked(method, &planet.system, &State::new(q.to_vec(), Covector(p.0.to_vec())), 0.01);
    }
}

/// Allocations in a run of many steps.
fn allocations_of_a_run<T: NystromPair<S>, C: Storage, const S: usize>(state: State<C>) -> u64 {
    let planet = kepler(0.6).unwrap();
    let tolerance = Tolerance::new(1e-9, 1e-9).unwrap();
    let mut nystrom = Nystrom::<T, _, _, C, S>::new(&planet.system, tolerance.into()).unwrap();
    let (mut state, mut middle) = (state.clone(), state);
    let counted = measure(|| {
        let run = nystrom.run(&mut state, 10.0, |mut step| {
            let half = 0.5 * (step.before.t + step.after.t);
            assert!(step.at(half, &mut middle).is_ok());
            ControlFlow::Continue(())
        });
        assert!(run.unwrap().steps > 10);
    });
    counted.count_total
}

#[test]
fn no_run_with_adaptive_steps_allocates() {
    let initial = kepler(0.6).unwrap().initial;
    let long = State::new(initial.q.to_vec(), Covector(initial.p.0.to_vec()));
    assert_eq!(allocations_of_a_run::<Pair8, _, 9>(initial.clone()), 0);
    assert_eq!(allocations_of_a_run::<Pair12, _, 17>(initial), 0);
    assert_eq!(allocations_of_a_run::<Pair8, _, 9>(long.clone()), 0);
    assert_eq!(allocations_of_a_run::<Pair12, _, 17>(long), 0);
}

#[test]
fn no_implicit_method_allocates_in_a_sparse_step() {
    let size = Net { rows: 10, columns: 10, spacing: 0.1, stiffness: 50.0, strain: Strain::Cauchy };
    let springs = Stencils::<_, 2, 2>::new(100, Vec::new(), net(size).unwrap()).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -9.81], masses: vec![0.01; 100] };
    let metric = DiagonalMetric::particles::<2>(&[0.01; 100]).unwrap();
    let system = System::new(metric, (springs, gravity)).unwrap();
    let q: Vec<f64> = (0..200)
        .map(|i| 0.1 * [i / 2 % 10, i / 2 / 10][i % 2] as f64 * (1.0 + 0.02 * (i as f64).sin()))
        .collect();
    let state = State::new(q.clone(), Covector(vec![0.0; 200]));
    for &method in Method::ALL {
        if method.facts().evaluation == Evaluation::Implicit {
            let solver = SparseSolver::new(system.metric(), system.potential(), &q).unwrap();
            let mut integrator = method.integrator_with(&system, solver).unwrap();
            assert_eq!(allocations(&mut *integrator, &state, 0.01), 0, "{method}");
        }
    }
}

/// Drag in the plane.
struct Drag;

impl Force for Drag {
    fn dim(&self) -> usize {
        2
    }

    fn add_force(&self, _: f64, _: &[f64], v: Vector<&[f64]>, mut f: Covector<&mut [f64]>) {
        f.add_scaled(-0.1, Covector(v.0));
    }

    fn add_damping(&self, _: f64, _: &[f64], _: Vector<&[f64]>, damping: &mut impl Sink) {
        damping.add_symmetric(&[0, 1], &[0.1, 0.0, 0.0, 0.1]);
    }
}

#[test]
fn no_method_with_a_second_force_allocates_in_a_step() {
    let planet = kepler(0.6).unwrap();
    let (system, soft) = (&planet.system, planet.system.potential());
    let State { q, p, .. } = planet.initial.clone();
    let state = State::new(q.to_vec(), Covector(p.0.to_vec()));
    let weights = NewmarkWeights::generalized_alpha(0.5).unwrap();
    let stiffness = BilinearForm(dmatrix![4.0, 1.0; 1.0, 9.0]);
    let methods: [Box<dyn Integrator<Vec<f64>>>; 3] = [
        Box::new(Newmark::with_force(system, weights, Drag).unwrap()),
        Box::new(Imex::new(system, soft).unwrap()),
        Box::new(Gautschi::new(system, &stiffness, Filter::Mollified).unwrap()),
    ];
    for mut method in methods {
        assert_eq!(allocations(&mut *method, &state, 0.01), 0, "{}", method.facts().name);
    }
}

#[test]
fn no_reversible_step_allocates() {
    let planet = kepler(0.6).unwrap();
    let State { q, p, .. } = planet.initial.clone();
    let mut state = State::new(q.to_vec(), Covector(p.0.to_vec()));
    let density = PotentialPower { potential: planet.system.potential(), power: 1.5, scale: 20.0 };
    let verlet = StormerVerlet::new(&planet.system).unwrap();
    let mut steps = ReversibleSteps::new(&planet.system, verlet, density).unwrap();
    steps.advance(&mut state).unwrap();
    let counted = measure(|| {
        for _ in 0..10 {
            steps.advance(&mut state).unwrap();
        }
    });
    assert_eq!(counted.count_total, 0);
}
