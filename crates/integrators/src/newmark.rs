//! Newmark's method and the generalized-alpha method, with forces that no potential gives.
//!
//! ```text
//! q' = q + h v + h^2 ((1/2 - beta) a + beta a'),      v' = v + h ((1 - gamma) a + gamma a')
//! M ((1 - am) a' + am a) = -dV(x) + F(t~, x, w)
//! x = (1 - af) q' + af q,   w = (1 - af) v' + af v,   t~ = t + (1 - af) h
//! ```
//! `q` configuration (n), `v = M^-1 p` velocity (n), `a` the method's acceleration (n), `M` the
//! metric, `F` a [`Force`], `h` step in seconds; `beta gamma am af` the [`NewmarkWeights`]. Solved
//! for x:
//!
//! ```text
//! M (x - y) + A (dV(x) - F(t~, x, w)) = 0,    A = (1 - af) beta h^2/(1 - am)
//! M + A (d2V + K + gamma/(beta h) C)          Newton's matrix, K = -dF/dx,  C = -dF/dw,  dw/dx = gamma/(beta h)
//! ```
//! Implicit. Order, symmetry and stability depend on the weights, and the facts say which: the
//! average acceleration is the trapezoid rule, and damps nothing; generalized alpha leaves the part
//! `r` of the fastest oscillations after each step and keeps order 2
//! (`what_is_left_of_fast_oscillations`).
//!
//! The acceleration is remembered from step to step: `a` belongs to a moment `af - am` steps before
//! the end of its step. A step from another state than the last one left, or of another length,
//! takes the state's own acceleration instead, at the price of one evaluation and of a power of h in
//! that one step. A run that is resumed from the state alone therefore agrees to rounding where
//! am = af, and to the order of the method elsewhere; with what [`Integrator::save`] gives beside the
//! state it goes on to the same bits. What unsymmetric dF/dq and dF/dv leave out costs iterations, which are
//! bounded.
//! Source: Newmark 1959; Chung and Hulbert 1993.

use stationary_calculus::{
    Covector, DenseSolver, Force, HessianSolver, Metric, Newton, NewtonMemory, Potential,
    SizeError, Space, Storage, System,
};

use crate::alpha_equation::AlphaEquation;
use crate::integrator::{check_solver, check_step, zeros};
use crate::newmark_weights::NewmarkWeights;
use crate::{Facts, Integrator, Saved, State, StepError, StepReport};

/// A method of Newmark's family.
#[derive(Clone, Debug)]
pub struct Newmark<'s, M, P, C, F = (), L = DenseSolver<C>> {
    weights: NewmarkWeights,
    newton: Newton,
    memory: NewtonMemory<C>,
    equation: AlphaEquation<'s, M, P, C, F, L>,
    /// `M a`, the state that it belongs to, and the step that led there: zero for none.
    rate: Covector<C>,
    left: State<C>,
    left_step: f64,
    next_rate: Covector<C>,
    next: State<C>,
}

impl<'s, M: Metric, P: Potential, C: Storage> Newmark<'s, M, P, C> {
    /// The method on a system of few freedoms: each Newton step factors a dense matrix.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>, weights: NewmarkWeights) -> Result<Self, SizeError> {
        Newmark::assembled(system, weights, None, dense(system.dim())?)
    }
}

impl<'s, M: Metric, P: Potential, C: Storage, F: Force> Newmark<'s, M, P, C, F> {
    /// The method on a system of few freedoms with a force beside its potential.
    ///
    /// # Errors
    /// [`SizeError`] for a storage or a force of another size than the system's.
    pub fn with_force(
        system: &'s System<M, P>,
        weights: NewmarkWeights,
        force: F,
    ) -> Result<Self, SizeError> {
        Newmark::with_force_and_solver(system, weights, force, dense(system.dim())?)
    }
}

impl<'s, M: Metric, P: Potential, C: Storage, L: HessianSolver> Newmark<'s, M, P, C, (), L> {
    /// The method on a system, with the caller's solver: a sparse one for many freedoms.
    ///
    /// # Errors
    /// A storage, or a solver, of another size.
    pub fn with_solver(
        system: &'s System<M, P>,
        weights: NewmarkWeights,
        solver: L,
    ) -> Result<Self, SizeError> {
        Newmark::assembled(system, weights, None, solver)
    }
}

fn dense<C: Storage>(n: usize) -> Result<DenseSolver<C>, SizeError> {
    let got = zeros::<C>(n)?.as_ref().len();
    DenseSolver::new(n).ok_or(SizeError { what: "the storage's numbers", expected: n, got })
}

impl<'s, M: Metric, P: Potential, C: Storage, F: Force, L: HessianSolver>
    Newmark<'s, M, P, C, F, L>
{
    /// The method on a system with a force beside its potential, with the caller's solver: a sparse
    /// one is analysed with a [`DampedPattern`](crate::DampedPattern).
    ///
    /// # Errors
    /// [`SizeError`] for a storage, a force or a solver of another size than the system's.
    pub fn with_force_and_solver(
        system: &'s System<M, P>,
        weights: NewmarkWeights,
        force: F,
        solver: L,
    ) -> Result<Self, SizeError> {
        SizeError::check("the force's freedoms", system.dim(), force.dim())?;
        Newmark::assembled(system, weights, Some(force), solver)
    }

    fn assembled(
        system: &'s System<M, P>,
        weights: NewmarkWeights,
        force: Option<F>,
        solver: L,
    ) -> Result<Self, SizeError> {
        let (n, newton) = (system.dim(), Newton::default());
        check_solver(n, &solver)?;
        let zero: C = zeros(n)?;
        let memory = NewtonMemory::new(n, newton.iterations);
        let got = zero.as_ref().len();
        let missing = SizeError { what: "the storage's numbers", expected: n, got };
        Ok(Newmark {
            weights,
            newton,
            memory: memory.ok_or(missing)?,
            equation: AlphaEquation::new(system, force, solver, &zero),
            rate: Covector(zero.clone()),
            left: State::new(zero.clone(), Covector(zero.clone())),
            left_step: 0.0,
            next_rate: Covector(zero.clone()),
            next: State::new(zero.clone(), Covector(zero)),
        })
    }

    /// The same method with other bounds on Newton's method. The tolerance is in kg^1/2 m: the size
    /// of an error of x in the metric.
    ///
    /// # Errors
    /// [`SizeError`] where there is no memory for it. The bounds are checked by each step.
    pub fn with_newton(self, newton: Newton) -> Result<Self, SizeError> {
        let (n, got) = (self.equation.system.dim(), self.next.q.as_ref().len());
        let missing = SizeError { what: "the storage's numbers", expected: n, got };
        let memory = NewtonMemory::new(n, newton.iterations).ok_or(missing)?;
        Ok(Newmark { newton, memory, ..self })
    }

    /// Whether the remembered acceleration is that of this state.
    fn continues(&self, state: &State<C>, h: f64) -> bool {
        // The time of a simulation is a product, and so differs by rounding from this sum.
        let same_time = (self.left.t - state.t).abs() <= 1e-6 * h;
        self.left_step == h && same_time && self.left.q == state.q && self.left.p == state.p
    }

    /// The acceleration at a state.
    fn start(&mut self, state: &State<C>) {
        let equation = &mut self.equation;
        equation.origin.clone_from(&state.q);
        equation.t = state.t;
        equation.system.metric().sharp(state.p.view(), equation.velocity.view_mut());
        self.left_step = 0.0;
        equation.evaluate(&mut self.rate);
    }

    /// Sets the equation up for a step from this state; its unknown starts on the drift.
    fn prepare(&mut self, state: &State<C>, h: f64) {
        let NewmarkWeights { beta, gamma, old_place, old_inertia, old_force, .. } = self.weights;
        let (new_force, equation) = (1.0 - old_force, &mut self.equation);
        let metric = equation.system.metric();
        equation.a = new_force * beta * h * h / (1.0 - old_inertia);
        equation.slope = gamma / (beta * h);
        equation.t = state.t + new_force * h;
        // The velocity w at x = origin, where the new acceleration is zero.
        self.next.p.clone_from(&state.p);
        self.next.p.add_scaled(new_force * h * (1.0 - gamma), self.rate.view());
        metric.sharp(self.next.p.view(), equation.start.view_mut());
        // The origin: q + (1 - af) (h v + h^2 (1/2 - beta) a), and without a by implicit Euler.
        self.next.p.clone_from(&state.p);
        self.next.p.add_scaled(h * old_place, self.rate.view());
        metric.drift(new_force * h, self.next.p.view(), equation.velocity.view_mut());
        equation.origin.clone_from(&state.q);
        let space = equation.system.space();
        space.advance(equation.origin.as_mut(), 1.0, equation.velocity.view());
        equation.y.clone_from(&equation.origin);
        metric.sharp(self.rate.view(), equation.velocity.view_mut());
        let back = -equation.a * old_inertia;
        space.advance(equation.y.as_mut(), back, equation.velocity.view());
        self.next.q.clone_from(&equation.y);
    }

    /// The state after the step, from the unknown in `next.q`.
    fn finish(&mut self, state: &State<C>, h: f64) {
        let NewmarkWeights { beta, gamma, old_place, old_inertia, .. } = self.weights;
        let equation = &mut self.equation;
        equation.follow(self.next.q.as_ref());
        std::mem::swap(&mut equation.origin, &mut self.next.q);
        equation.evaluate(&mut self.next_rate);
        self.next_rate.add_scaled(-old_inertia, self.rate.view());
        let scale = 1.0 / (1.0 - old_inertia);
        self.next_rate.components_mut().iter_mut().for_each(|rate| *rate *= scale);
        let (metric, State { q, p, .. }) = (equation.system.metric(), &mut self.next);
        q.clone_from(&state.q);
        p.clone_from(&state.p);
        p.add_scaled(h * old_place, self.rate.view());
        p.add_scaled(h * beta, self.next_rate.view());
        metric.drift(h, p.view(), equation.difference.view_mut());
        equation.system.space().advance(q.as_mut(), 1.0, equation.difference.view());
        p.clone_from(&state.p);
        p.add_scaled(h * (1.0 - gamma), self.rate.view());
        p.add_scaled(h * gamma, self.next_rate.view());
    }
}

impl<M: Metric, P: Potential, C: Storage, F: Force, L: HessianSolver> Integrator<C>
    for Newmark<'_, M, P, C, F, L>
{
    fn facts(&self) -> Facts {
        self.weights.facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, self.equation.system.dim(), h)?;
        self.equation.report = StepReport::default();
        if !self.continues(state, h) {
            self.start(state);
        }
        self.prepare(state, h);
        let unknown = self.next.q.as_mut();
        let solved = self.newton.solve(&mut self.equation, unknown, &mut self.memory)?;
        self.finish(state, h);
        let report = StepReport { residual: solved.residual, ..self.equation.report };
        state.accept(&mut self.next, h)?;
        std::mem::swap(&mut self.rate, &mut self.next_rate);
        self.left.clone_from(state);
        self.left_step = h;
        Ok(report)
    }

    /// The acceleration that the last step left, with the state and the step that it belongs to.
    fn save(&self) -> Saved {
        let mut numbers = vec![self.left_step, self.left.t];
        numbers.extend(self.left.q.as_ref());
        numbers.extend(self.left.p.components());
        numbers.extend(self.rate.components());
        Saved { method: self.weights.facts().name.to_owned(), numbers }
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        if saved.method != self.weights.facts().name {
            return Err(StepError::Saved("it is another method's"));
        }
        let n = self.equation.system.dim();
        let [step, time, rest @ ..] = saved.numbers.as_slice() else {
            return Err(StepError::Saved("it has no step"));
        };
        if rest.len() != 3 * n || saved.numbers.iter().any(|number| !number.is_finite()) {
            return Err(StepError::Saved("it has other numbers than the system's"));
        }
        (self.left_step, self.left.t) = (*step, *time);
        self.left.q.as_mut().copy_from_slice(&rest[..n]);
        self.left.p.components_mut().copy_from_slice(&rest[n..2 * n]);
        self.rate.components_mut().copy_from_slice(&rest[2 * n..]);
        Ok(())
    }
}
