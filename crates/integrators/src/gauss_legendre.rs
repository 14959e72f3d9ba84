//! Gauss-Legendre collocation: a polynomial that obeys the equation of motion at s Gaussian nodes.
//!
//! ```text
//! Q_i = q + c_i h v - h^2 sum_j (A^2)_ij M^-1 dV(Q_j),         i = 1 ... s
//! q'  = q + h v - h^2 sum_i b_i (1 - c_i) M^-1 dV(Q_i)
//! p'  = p - h sum_i b_i dV(Q_i)
//! ```
//! `c` the nodes in (0, 1), `b` the weights, `A` (s x s) the integrals of the Lagrange polynomials
//! from 0 to the nodes; `Q_i` configurations (n), `v = M^-1 p`, `M` the metric, `h` step in
//! seconds. Order 2 s, implicit, symmetric, symplectic; keeps linear and angular momentum, and
//! every other quadratic invariant, to rounding. With s = 1 it is the implicit midpoint rule. On
//! linear systems an oscillator keeps its energy at any step; on nonlinear ones stability is
//! conditional. On a stiff spring that is led along a path the order falls to s, or s + 1 where s
//! is odd (`stiff_stages_cost_order`).
//!
//! The s n coupled equations are solved with one n x n factorization a step, of `M + g h^2 d2V` at
//! the middle of the drift, so that a sparse solver serves as well as a dense one. With S its
//! inverse
//!
//! ```text
//! r_i = M (Q_i - q - c_i h v) + h^2 sum_j (A^2)_ij dV(Q_j),    r~ = g A^-2 r
//! Q  <- Q - S (r~ + M S (r - r~))
//! ```
//! which divides the error on a linear force of any stiffness by at least 4, 2 and 1.6 for s = 2, 3
//! and 4, and by far more where `h omega` is small: `g` is the smallest squared eigenvalue of A.
//! The iteration ends where rounding lets no coordinate go further, or with an error. Source: Hairer,
//! Lubich and Wanner, Geometric Numerical Integration, II.1.3 and VIII.6; Brugnano and Magherini
//! 2002 (blended iteration).

use stationary_calculus::{
    Covector, DenseSolver, HessianSolver, Metric, NewtonError, NewtonFailure, Potential, SizeError,
    Space, Storage, System, Unsolvable, Vector, first_non_finite,
};

use crate::collocation::{Collocation, Nodes};
use crate::integrator::{check_solver, check_step, subtract, zeros};
use crate::own_rounding::write_sizes;
use crate::{Facts, Integrator, State, StepError, StepReport};

/// Gauss-Legendre collocation.
#[derive(Clone, Debug)]
pub struct GaussLegendre<'s, M, P, C, L = DenseSolver<C>> {
    system: &'s System<M, P>,
    solver: L,
    nodes: Nodes,
    table: Collocation,
    stages: Vec<Stage<C>>,
    velocity: Vector<C>,
    difference: Vector<C>,
    blend: Covector<C>,
    middle: C,
    sizes: C,
    next: State<C>,
    history: Vec<f64>,
}

/// A configuration inside the step, with what is known of it.
#[derive(Clone, Debug)]
struct Stage<C> {
    q: C,
    dv: Covector<C>,
    residual: Covector<C>,
    step: Covector<C>,
}

/// No more iterations than this: of the slowest, on the worst stiffness, 80 reach rounding.
const ITERATIONS: usize = 120;
/// Changes of this size relative to the stages are rounding.
const ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Changes of this size, once they no longer shrink, are rounding too.
const NEARLY: f64 = 1e-9;
/// Changes that are rounding of the largest coordinate are so of each, if they are of this size relative to it.
const OF_EACH: f64 = 1e-13;

impl<'s, M: Metric, P: Potential, C: Storage> GaussLegendre<'s, M, P, C, DenseSolver<C>> {
    /// The method on a system of few freedoms: each step factors a dense matrix.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>, nodes: Nodes) -> Result<Self, SizeError> {
        let n = system.dim();
        let got = zeros::<C>(n)?.as_ref().len();
        let what = "the storage's numbers";
        let solver = DenseSolver::new(n).ok_or(SizeError { what, expected: n, got })?;
        Self::with_solver(system, nodes, solver)
    }
}

impl<'s, M: Metric, P: Potential, C: Storage, L: HessianSolver> GaussLegendre<'s, M, P, C, L> {
    /// The method on a system, with the caller's solver: a sparse one for many freedoms.
    ///
    /// # Errors
    /// A storage, or a solver, of another size.
    pub fn with_solver(
        system: &'s System<M, P>,
        nodes: Nodes,
        solver: L,
    ) -> Result<Self, SizeError> {
        check_solver(system.dim(), &solver)?;
        let zero: C = zeros(system.dim())?;
        let stage = Stage {
            q: zero.clone(),
            dv: Covector(zero.clone()),
            residual: Covector(zero.clone()),
            step: Covector(zero.clone()),
        };
        Ok(GaussLegendre {
            system,
            solver,
            nodes,
            table: Collocation::new(nodes),
            stages: vec![stage; nodes.count()],
            velocity: Vector(zero.clone()),
            difference: Vector(zero.clone()),
            blend: Covector(zero.clone()),
            middle: zero.clone(),
            sizes: zero.clone(),
            next: State::new(zero.clone(), Covector(zero)),
            history: Vec::with_capacity(ITERATIONS + 1),
        })
    }

    fn failed(&self, failure: NewtonFailure) -> StepError {
        StepError::Newton(NewtonError { failure, history: self.history.clone() })
    }

    /// Puts the stages on the drift, and factors the matrix in its middle.
    fn begin(&mut self, q: &C, h: f64, report: &mut StepReport) -> Result<(), StepError> {
        let space = self.system.space();
        for (stage, c) in self.stages.iter_mut().zip(&self.table.nodes) {
            stage.q.clone_from(q);
            space.advance(stage.q.as_mut(), c * h, self.velocity.view());
        }
        self.middle.clone_from(q);
        space.advance(self.middle.as_mut(), 0.5 * h, self.velocity.view());
        let (metric, potential) = (self.system.metric(), self.system.potential());
        let a = self.table.blend * h * h;
        self.history.clear();
        let rung = self.solver.factor(metric, potential, self.middle.as_ref(), a);
        report.rung = rung.map_err(|why| self.failed(NewtonFailure::Unsolvable(why)))?;
        report.hessians = 1;
        Ok(())
    }

    /// Writes each stage's dV and residual, and returns the residuals' size.
    fn evaluate(&mut self, q: &C, h: f64) -> f64 {
        let (metric, space) = (self.system.metric(), self.system.space());
        for stage in &mut self.stages {
            stage.dv.clear();
            self.system.potential().add_differential(stage.q.as_ref(), stage.dv.view_mut());
        }
        let mut size = 0.0;
        for i in 0..self.stages.len() {
            self.middle.clone_from(q);
            space.advance(self.middle.as_mut(), self.table.nodes[i] * h, self.velocity.view());
            subtract(self.stages[i].q.as_ref(), self.middle.as_ref(), &mut self.difference);
            metric.flat(self.difference.view(), self.blend.view_mut());
            for (stage, weight) in self.stages.iter().zip(&self.table.square[i]) {
                self.blend.add_scaled(h * h * weight, stage.dv.view());
            }
            self.stages[i].residual.clone_from(&self.blend);
            metric.sharp(self.blend.view(), self.difference.view_mut());
            size += self.blend.apply(&self.difference);
        }
        size.sqrt()
    }

    /// Writes the step of each stage, and returns the largest component.
    fn blended_steps(&mut self) -> Result<f64, Unsolvable> {
        let metric = self.system.metric();
        let mut largest = 0.0_f64;
        for i in 0..self.stages.len() {
            self.blend.clear();
            for (stage, weight) in self.stages.iter().zip(&self.table.inverse_square[i]) {
                self.blend.add_scaled(self.table.blend * weight, stage.residual.view());
            }
            let Stage { residual, step, .. } = &mut self.stages[i];
            step.clone_from(residual);
            step.add_scaled(-1.0, self.blend.view());
            self.solver.solve(step.components_mut());
            self.solver.unsolved().map_or(Ok(()), Err)?;
            self.difference.components_mut().copy_from_slice(step.components());
            metric.flat(self.difference.view(), step.view_mut());
            step.add_scaled(1.0, self.blend.view());
            self.solver.solve(step.components_mut());
            self.solver.unsolved().map_or(Ok(()), Err)?;
            largest = largest_of(step.components(), largest);
        }
        Ok(largest)
    }

    /// The largest component of the steps relative to its coordinate, from now on measured by sizes that
    /// tell the coordinates' own rounding. The Hessian is asked only where their numbers do not say enough.
    fn weigh(&mut self, q: &C, h: f64) -> f64 {
        for (i, own) in self.sizes.as_mut().iter_mut().enumerate() {
            let stages = self.stages.iter().map(|stage| stage.q.as_ref()[i].abs());
            *own = stages.fold(q.as_ref()[i].abs(), f64::max);
        }
        let part = self.largest_part();
        if part <= OF_EACH {
            return part;
        }
        self.middle.clone_from(&self.sizes);
        let at = (self.stages[0].q.as_ref(), self.table.blend * h * h);
        let (own, diagonal) = (self.middle.as_ref(), self.blend.components_mut());
        write_sizes(self.system, at, own, diagonal, self.sizes.as_mut());
        self.largest_part()
    }

    /// The largest component of the steps relative to the size of its coordinate.
    fn largest_part(&self) -> f64 {
        let sizes = self.sizes.as_ref();
        let parts = |stage: &Stage<C>, largest: f64| {
            let each = stage.step.components().iter().zip(sizes);
            each.filter(|(step, _)| **step != 0.0).fold(largest, |largest: f64, (step, size)| {
                let part = step.abs() / size;
                if part <= largest { largest } else { part }
            })
        };
        self.stages.iter().fold(0.0, |largest, stage| parts(stage, largest))
    }

    /// Solves for the stages; their dV are left in them.
    fn solve(&mut self, q: &C, h: f64, report: &mut StepReport) -> Result<(), StepError> {
        let mut last = f64::INFINITY;
        // What is rounding of the largest coordinate may be an error of another: known once that is.
        let mut last_part = None;
        for _ in 0..ITERATIONS {
            report.residual = self.evaluate(q, h);
            report.differentials += self.stages.len() as u32;
            self.history.push(report.residual);
            let step = self.blended_steps();
            let step = step.map_err(|why| self.failed(NewtonFailure::Unsolvable(why)))?;
            if !(step.is_finite() && report.residual.is_finite()) {
                return Err(self.failed(NewtonFailure::NonFinite(self.first_non_finite())));
            }
            let size =
                self.stages.iter().fold(0.0, |size, stage| largest_of(stage.q.as_ref(), size));
            let rounding_of_largest =
                step <= ROUNDING * size || (step <= NEARLY * size && step >= 0.9 * last);
            let is_rounding = match last_part {
                None if !rounding_of_largest => false,
                None => {
                    let part = self.weigh(q, h);
                    last_part = Some(part);
                    part <= OF_EACH
                }
                Some(last) => {
                    let part = self.largest_part();
                    last_part = Some(part);
                    part <= ROUNDING || (part <= NEARLY && part >= 0.9 * last)
                }
            };
            if is_rounding {
                return Ok(());
            }
            last = step;
            for stage in &mut self.stages {
                for (q, step) in stage.q.as_mut().iter_mut().zip(stage.step.components()) {
                    *q -= step;
                }
            }
        }
        Err(self.failed(NewtonFailure::NotConverged))
    }

    fn first_non_finite(&self) -> usize {
        let n = self.system.dim();
        let bad = |stage: &Stage<C>| {
            let residual = first_non_finite(stage.residual.components());
            residual.or(first_non_finite(stage.step.components()))
        };
        let mut stages = self.stages.iter().enumerate();
        stages.find_map(|(i, stage)| Some(i * n + bad(stage)?)).unwrap_or(0)
    }
}

/// The largest of some sizes and another, NaN where one of them is.
fn largest_of(numbers: &[f64], other: f64) -> f64 {
    let larger = |largest: f64, x: &f64| if x.abs() <= largest { largest } else { x.abs() };
    numbers.iter().fold(other, larger)
}

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> Integrator<C>
    for GaussLegendre<'_, M, P, C, L>
{
    fn facts(&self) -> Facts {
        self.nodes.facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let system = self.system;
        check_step(state, system.dim(), h)?;
        state.check_finite()?;
        let mut report = StepReport::default();
        system.metric().sharp(state.p.view(), self.velocity.view_mut());
        self.begin(&state.q, h, &mut report)?;
        self.solve(&state.q, h, &mut report)?;
        self.blend.clear();
        self.next.clone_from(state);
        for (stage, (b, c)) in
            self.stages.iter().zip(self.table.weights.iter().zip(&self.table.nodes))
        {
            self.blend.add_scaled(-h * h * b * (1.0 - c), stage.dv.view());
            self.next.p.add_scaled(-h * b, stage.dv.view());
        }
        system.metric().sharp(self.blend.view(), self.difference.view_mut());
        let q = self.next.q.as_mut();
        system.space().advance(q, h, self.velocity.view());
        system.space().advance(q, 1.0, self.difference.view());
        state.accept(&mut self.next, h)?;
        Ok(report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ImplicitMidpoint;
    use crate::problems::{TetherPotential, kepler, oscillator, pendulum};
    use stationary_calculus::{Automatic, DenseSink, DiagonalMetric, Energy, Number, Sink};
    use stationary_measure::loglog_slope;

    #[test]
    fn at_one_node_it_is_the_implicit_midpoint_rule() {
        let planet = kepler(0.6).unwrap();
        let mut midpoint = ImplicitMidpoint::new(&planet.system).unwrap();
        let mut gauss = GaussLegendre::new(&planet.system, Nodes::One).unwrap();
        let (mut a, mut b) = (planet.initial.clone(), planet.initial.clone());
        for _ in 0..200 {
            midpoint.step(&mut a, 0.02).unwrap();
            gauss.step(&mut b, 0.02).unwrap();
            assert!((a.q[0] - b.q[0]).hypot(a.q[1] - b.q[1]) < 1e-11);
        }
    }

    #[test]
    fn the_iteration_converges_on_springs_of_every_stiffness() {
        for nodes in [Nodes::Two, Nodes::Three, Nodes::Four] {
            let mut most = 0;
            for power in -4..=8 {
                let spring = oscillator(10_f64.powf(0.5 * f64::from(power))).unwrap();
                let mut gauss = GaussLegendre::new(&spring.system, nodes).unwrap();
                let mut state = spring.initial.clone();
                let start = spring.energy(&state);
                for _ in 0..10 {
                    let report = gauss.step(&mut state, 1.0).unwrap();
                    most = most.max(report.differentials / nodes.count() as u32);
                }
                assert!((spring.energy(&state) / start - 1.0).abs() < 1e-10, "{nodes:?} {power}");
            }
            // Each iteration divides the error by 4, 2 and 1.6 at worst.
            let bound = [0, 0, 32, 60, 90][nodes.count()];
            assert!(most > 5 && most < bound, "{nodes:?}: {most} iterations");
        }
    }

    #[test]
    fn a_resolved_step_takes_few_iterations_and_one_hessian() {
        let swing = pendulum(2.0).unwrap();
        let mut gauss = GaussLegendre::new(&swing.system, Nodes::Three).unwrap();
        let mut state = swing.initial.clone();
        for _ in 0..100 {
            let report = gauss.step(&mut state, 0.05).unwrap();
            assert!(report.hessians == 1 && report.differentials <= 3 * 9, "{report:?}");
        }
    }

    /// A potential of the freedoms after the first, which moves freely.
    struct Beside<P>(P);

    impl<P: Potential> Potential for Beside<P> {
        fn dim(&self) -> usize {
            1 + self.0.dim()
        }

        fn energy(&self, q: &[f64]) -> f64 {
            self.0.energy(&q[1..])
        }

        fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
            self.0.add_differential(&q[1..], Covector(&mut dv.0[1..]));
        }

        fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
            let n = self.0.dim();
            let mut block = vec![0.0; n * n];
            let mut sink = DenseSink::new(1.0, n, &mut block).unwrap();
            self.0.add_hessian(&q[1..], &mut sink);
            let freedoms: Vec<usize> = (1..=n).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
    }

    struct Swing;

    impl Energy<1> for Swing {
        fn energy<R: Number>(&self, [angle]: [R; 1]) -> R {
            angle.cos() * -9.81
        }
    }

    #[test]
    fn a_particle_that_rests_far_away_costs_a_pendulum_no_digits() {
        let swing = || Automatic::<_, 1>(Swing);
        let alone = System::new(DiagonalMetric::new([1.0]).unwrap(), swing()).unwrap();
        let both = System::new(DiagonalMetric::new([1.0; 2]).unwrap(), Beside(swing())).unwrap();
        for nodes in [Nodes::One, Nodes::Two, Nodes::Three, Nodes::Four] {
            for far in [0.0, 1.0, 1e6, 1e9, 1e12] {
                let mut gauss = GaussLegendre::new(&alone, nodes).unwrap();
                let mut beside = GaussLegendre::new(&both, nodes).unwrap();
                let mut one = State::new([2.5], Covector([0.0]));
                let mut two = State::new([far, 2.5], Covector([0.0; 2]));
                let start = both.energy(&two.q, two.p.view());
                for _ in 0..2000 {
                    gauss.step(&mut one, 0.05).unwrap();
                    beside.step(&mut two, 0.05).unwrap();
                    let off = (one.q[0] - two.q[1]).abs();
                    assert!(off < 1e-10, "{nodes:?} beside {far}: {off}");
                }
                if nodes == Nodes::Three {
                    let drift = (both.energy(&two.q, two.p.view()) - start).abs();
                    assert!(drift < 2e-6, "beside {far}: {drift}");
                }
            }
        }
    }

    #[test]
    fn a_tether_that_cannot_be_solved_is_refused_beside_a_far_particle_too() {
        let metric = DiagonalMetric::new([1.0; 3]).unwrap();
        let system = System::new(metric, Beside(TetherPotential { stiffness: 1e4 })).unwrap();
        let refused = [0.0, 1.0, 1e6, 1e10].map(|far| {
            let mut gauss = GaussLegendre::new(&system, Nodes::Two).unwrap();
            let mut state = State::new([far, 1.0, 0.0], Covector([0.0; 3]));
            (0..40).find(|_| gauss.step(&mut state, 0.2).is_err())
        });
        assert!(refused.iter().all(|step| step.is_some() && *step == refused[0]), "{refused:?}");
    }

    /// A stiff spring whose other end is moved: k/2 (x - sin t)^2. The time t is a freedom so heavy
    /// that the spring does not hold it up.
    struct Led(f64);

    impl Potential for Led {
        fn dim(&self) -> usize {
            2
        }

        fn energy(&self, q: &[f64]) -> f64 {
            0.5 * self.0 * (q[0] - q[1].sin()).powi(2)
        }

        fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
            let pull = self.0 * (q[0] - q[1].sin());
            dv.0[0] += pull;
            dv.0[1] -= pull * q[1].cos();
        }

        fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
            let (sine, cosine, k) = (q[1].sin(), q[1].cos(), self.0);
            let time = k * (cosine * cosine + (q[0] - sine) * sine);
            hessian.add_symmetric(&[0, 1], &[k, -k * cosine, -k * cosine, time]);
        }
    }

    /// The order on the led spring of stiffness k, from x = k/(k - 1) sin t.
    fn order_when_led(nodes: Nodes, k: f64) -> f64 {
        let metric = DiagonalMetric::new([1.0, 1e20]).unwrap();
        let system = System::new(metric, Led(k)).unwrap();
        let exact = |t: f64| k / (k - 1.0) * t.sin();
        let points = [10, 14, 20, 28, 40].map(|steps| {
            let h = 2.0 / f64::from(steps);
            let mut gauss = GaussLegendre::new(&system, nodes).unwrap();
            let mut state = State::new([0.0, 0.0], Covector([k / (k - 1.0), 1e20]));
            let mut error = 0.0_f64;
            for step in 1..=steps {
                gauss.step(&mut state, h).unwrap();
                error = error.max((state.q[0] - exact(f64::from(step) * h)).abs());
            }
            (h, error)
        });
        loglog_slope(&points).unwrap()
    }

    #[test]
    fn stiff_stages_cost_order() {
        // From 2 s to s, or s + 1 where s is odd.
        for (nodes, classical, left) in [(Nodes::Two, 4.0, 2.0), (Nodes::Three, 6.0, 4.0)] {
            let (soft, stiff) = (order_when_led(nodes, 4.0), order_when_led(nodes, 1e8));
            assert!((soft - classical).abs() < 0.1, "{nodes:?}: {soft}");
            assert!((stiff - left).abs() < 0.1, "{nodes:?}: {stiff}");
        }
    }
}
