//! What the methods promise beside their order: areas, momenta, and the stability limit.

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_constraints::problems::{Pendulum, RodProblem, pendulum, square};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Dense, Linear, Rattle, Redundancy, SparseDiagonal,
    StepAndProject,
};
use stationary_integrators::{
    State, StormerVerlet, Symplecticity, angular_momentum, linear_momentum,
};

const FEW: Dense<1> = Dense(Redundancy::Refuse);

/// A step of a pendulum in its angle and angular momentum.
fn stepped(
    method: &mut dyn ConstrainedIntegrator<[f64; 2]>,
    [angle, momentum]: [f64; 2],
) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    let mut state = State::new([s, -c], Covector([momentum * c, momentum * s]));
    method.step(&mut state, 0.1).unwrap();
    let [x, y] = state.q;
    [x.atan2(-y), x * state.p.0[1] - y * state.p.0[0]]
}

/// By what a step multiplies areas in the plane of angle and angular momentum.
fn area(method: &mut dyn ConstrainedIntegrator<[f64; 2]>) -> f64 {
    let (at, d) = ([0.8, 1.1], 1e-5);
    let mut along = |i: usize| {
        let mut moved = [at, at];
        moved[0][i] += d;
        moved[1][i] -= d;
        let [ahead, behind] = moved.map(|at| stepped(&mut *method, at));
        [(ahead[0] - behind[0]) / (2.0 * d), (ahead[1] - behind[1]) / (2.0 * d)]
    };
    let (a, b) = (along(0), along(1));
    a[0] * b[1] - a[1] * b[0]
}

#[test]
fn areas_are_kept_where_the_facts_say_symplectic() {
    let Pendulum { problem: RodProblem { system, rods, initial }, .. } = pendulum(1.0).unwrap();
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut rattle = Rattle::new(&system, &rods, &initial, FEW).unwrap();
    let mut hamilton = ConstrainedHamilton::new(&system, &rods, &initial, FEW).unwrap();
    let mut project = StepAndProject::new(verlet, &system, &rods, &initial, FEW).unwrap();
    let methods: [&mut dyn ConstrainedIntegrator<[f64; 2]>; 3] =
        [&mut rattle, &mut hamilton, &mut project];
    for method in methods {
        let facts = method.facts();
        let change = (area(method) - 1.0).abs();
        let symplectic = facts.symplecticity == Symplecticity::Symplectic;
        assert_eq!(change < 1e-8, symplectic, "{}: {change:e}", facts.name);
    }
}

/// A unit spring along the first axis.
#[derive(Clone, Copy, Debug)]
struct Spring;

impl Potential for Spring {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * q[0] * q[0]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += q[0];
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[1.0]);
    }
}

#[test]
fn a_bead_with_a_spring_on_a_line_is_unstable_above_two_over_omega() {
    let system = System::new(DiagonalMetric::new([1.0; 2]).unwrap(), Spring).unwrap();
    let line = Linear::new(vec![(vec![(1, 1.0)], 0.0)]).unwrap();
    let initial = State::new([1.0, 0.0], Covector([0.3, 0.0]));
    let grows = |method: &mut dyn ConstrainedIntegrator<[f64; 2]>, h: f64| {
        let mut state = initial.clone();
        for _ in 0..1000 {
            method.step(&mut state, h).unwrap();
        }
        state.q[0].abs() > 1e3
    };
    let mut rattle = Rattle::new(&system, &line, &initial, FEW).unwrap();
    let mut hamilton = ConstrainedHamilton::new(&system, &line, &initial, FEW).unwrap();
    assert!(!grows(&mut rattle, 1.99) && grows(&mut rattle, 2.01));
    assert!(!grows(&mut hamilton, 1.99) && grows(&mut hamilton, 2.01));
}

#[test]
fn the_constrained_hamilton_principle_keeps_momenta_and_the_projection_the_linear_one_only() {
    let RodProblem { system, rods, initial } = square(1, 2.0, [0.3, 0.2]).unwrap();
    let few = SparseDiagonal(Redundancy::Refuse);
    let change = |method: &mut dyn ConstrainedIntegrator<[f64; 8]>| {
        let mut state = initial.clone();
        for _ in 0..1000 {
            method.step(&mut state, 0.01).unwrap();
        }
        let (now, start) = (linear_momentum::<2>(&state), linear_momentum::<2>(&initial));
        let angular = angular_momentum::<2>(&state)[2] - angular_momentum::<2>(&initial)[2];
        [(now[0] - start[0]).abs() + (now[1] - start[1]).abs(), angular.abs()]
    };
    let mut hamilton = ConstrainedHamilton::new(&system, &rods, &initial, few).unwrap();
    let [linear, angular] = change(&mut hamilton);
    assert!(linear < 1e-12 && angular < 1e-12, "{linear:e} {angular:e}");
    let verlet = StormerVerlet::new(&system).unwrap();
    let mut project = StepAndProject::new(verlet, &system, &rods, &initial, few).unwrap();
    let [linear, angular] = change(&mut project);
    assert!(linear < 1e-12 && angular > 1e-3, "{linear:e} {angular:e}");
}
