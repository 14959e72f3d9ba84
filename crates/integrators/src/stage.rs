//! The one equation that every implicit method of this crate solves, once a step.
//!
//! ```text
//! M (x - y) + a dV(x) = 0,      the minimum of  1/2 |x - y|_M^2 + a V(x)
//! ```
//! `x` the unknown configuration (n), `y` known, `a` a number in s^2, `M` the metric. With the right
//! y and a it is the step of implicit Euler (a = h^2), of the trapezoid rule and of the implicit
//! midpoint rule (a = h^2/4). The Hessian of the minimized function, `M + a d2V(x)`, is symmetric,
//! and positive definite for small steps; where it is not, the solver's ladder says what it did.
//!
//! Solved by Newton's method, to rounding unless the caller's tolerance ends it sooner. All of it is
//! inlined into each method's step, because the copies in and out of a call, through memory, cost a
//! small system a fifth of its step.
//! Source: notes 4.4 (bonus math).

use stationary_calculus::{
    Covector, Equation, HessianSolver, Metric, Newton, NewtonMemory, Potential, SizeError, Storage,
    System, Unsolvable, Vector,
};

use crate::integrator::{Remembered, check_solver, zeros};
use crate::{StepError, StepReport};

/// A system, a solver, and the memory that solving needs.
#[derive(Clone, Debug)]
pub(crate) struct Stage<'s, M, P, C, L> {
    newton: Newton,
    equation: StageEquation<'s, M, P, C, L>,
    memory: NewtonMemory<C>,
    differential: Remembered<C>,
}

#[derive(Clone, Debug)]
struct StageEquation<'s, M, P, C, L> {
    system: &'s System<M, P>,
    solver: L,
    y: C,
    a: f64,
    difference: Vector<C>,
    flat: Covector<C>,
    report: StepReport,
}

impl<'s, M: Metric, P: Potential, C: Storage, L: HessianSolver> Stage<'s, M, P, C, L> {
    pub(crate) fn new(
        system: &'s System<M, P>,
        solver: L,
        newton: Newton,
    ) -> Result<Self, SizeError> {
        let n = system.dim();
        check_solver(n, &solver)?;
        let y: C = zeros(n)?;
        Ok(Stage {
            newton,
            memory: memory(n, newton)?,
            differential: Remembered::new(n)?,
            equation: StageEquation {
                system,
                solver,
                a: 0.0,
                difference: Vector(y.clone()),
                flat: Covector(y.clone()),
                y,
                report: StepReport::default(),
            },
        })
    }

    pub(crate) fn with_newton(self, newton: Newton) -> Result<Self, SizeError> {
        let memory = memory(self.system().dim(), newton)?;
        Ok(Stage { newton, memory, ..self })
    }

    pub(crate) fn system(&self) -> &'s System<M, P> {
        self.equation.system
    }

    /// The known configuration y, to be written before a solve.
    pub(crate) fn y(&mut self) -> &mut C {
        &mut self.equation.y
    }

    /// Solves for x from the guess in `x`.
    #[inline(always)]
    pub(crate) fn solve(&mut self, x: &mut C, a: f64) -> Result<StepReport, StepError> {
        self.equation.a = a;
        self.equation.report = StepReport::default();
        let solved = self.newton.solve(&mut self.equation, x.as_mut(), &mut self.memory)?;
        Ok(StepReport { residual: solved.residual, ..self.equation.report })
    }

    /// dV(q), evaluated unless it was at this very `q` last time.
    #[inline]
    pub(crate) fn differential_at(&mut self, q: &C, evaluations: &mut u32) -> &Covector<C> {
        self.differential.at(self.equation.system.potential(), q, evaluations)
    }
}

fn memory<C: Storage>(n: usize, newton: Newton) -> Result<NewtonMemory<C>, SizeError> {
    let got = zeros::<C>(n)?.as_ref().len();
    let what = "the storage's numbers";
    NewtonMemory::new(n, newton.iterations).ok_or(SizeError { what, expected: n, got })
}

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> StageEquation<'_, M, P, C, L> {
    #[inline]
    fn subtract(&mut self, x: &[f64]) {
        let difference = self.difference.components_mut();
        difference.copy_from_slice(x);
        for (difference, y) in difference.iter_mut().zip(self.y.as_ref()) {
            *difference -= y;
        }
    }
}

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> Equation
    for StageEquation<'_, M, P, C, L>
{
    #[inline]
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        self.subtract(x);
        self.flat.clear();
        self.system.potential().add_differential(x, self.flat.view_mut());
        self.report.differentials += 1;
        let mut f = Covector(f);
        self.system.metric().flat(self.difference.view(), f.view_mut());
        f.add_scaled(self.a, self.flat.view());
    }

    #[inline(always)]
    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        let rung = self.solver.factor(self.system.metric(), self.system.potential(), x, self.a)?;
        self.report.hessians += 1;
        self.report.rung = self.report.rung.max(rung);
        self.solver.solve(f);
        self.solver.unsolved().map_or(Ok(()), Err)
    }

    #[inline]
    fn norm(&mut self, f: &[f64]) -> f64 {
        let f = Covector(f);
        self.system.metric().sharp(f.view(), self.difference.view_mut());
        f.apply(&self.difference).sqrt()
    }

    #[inline]
    fn energy(&mut self, x: &[f64]) -> Option<f64> {
        self.subtract(x);
        self.system.metric().flat(self.difference.view(), self.flat.view_mut());
        self.report.energies += 1;
        let kinetic = 0.5 * self.flat.apply(&self.difference);
        Some(kinetic + self.a * self.system.potential().energy(x))
    }
}

/// The part that the three implicit methods share: how each is made, and its Newton settings.
macro_rules! implicit_method {
    ($name:ident) => {
        impl<'s, M: Metric, P: Potential, C: Storage> $name<'s, M, P, C, DenseSolver<C>> {
            /// The method on a system of few freedoms: each Newton step factors a dense matrix.
            ///
            /// # Errors
            /// [`SizeError`] for a storage of another size than the system's.
            pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
                let n = system.dim();
                let solver = DenseSolver::new(n).ok_or(SizeError {
                    what: "the storage's numbers",
                    expected: n,
                    got: std::mem::size_of::<C>() / 8,
                })?;
                Self::with_solver(system, solver)
            }
        }

        impl<'s, M: Metric, P: Potential, C: Storage, L: HessianSolver> $name<'s, M, P, C, L> {
            /// The method on a system, with the caller's solver: a sparse one for many freedoms.
            ///
            /// # Errors
            /// A storage, or a solver, of another size.
            pub fn with_solver(system: &'s System<M, P>, solver: L) -> Result<Self, SizeError> {
                Ok($name {
                    stage: Stage::new(system, solver, Newton::default())?,
                    velocity: Vector(zeros(system.dim())?),
                    next: State::new(
                        zeros(system.dim())?,
                        stationary_calculus::Covector(zeros(system.dim())?),
                    ),
                })
            }

            /// The same method with other bounds on Newton's method. The tolerance is in
            /// kg^1/2 m: the size of an error of x in the metric.
            ///
            /// # Errors
            /// [`SizeError`] where there is no memory for it. The bounds are checked by each step.
            pub fn with_newton(mut self, newton: Newton) -> Result<Self, SizeError> {
                self.stage = self.stage.with_newton(newton)?;
                Ok(self)
            }
        }
    };
}
pub(crate) use implicit_method;
