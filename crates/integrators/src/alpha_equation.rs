//! The equation that a step of Newmark's family solves.
//!
//! ```text
//! M (x - y) + A (dV(x) - F(t, x, w(x))) = 0,      w(x) = start + slope (x - origin)
//! M + A (d2V + K + slope C),                      K = -dF/dx,  C = -dF/dw
//! ```
//! `x` the unknown configuration (n), `y` and `origin` known ones, `w` the velocity that goes with
//! x, `slope` in 1/s, `A` in s^2, `M` the metric, `V` the potential, `F` the force, which may be
//! absent. A force has no energy, so that with one the line search goes by the residual alone.

use std::cell::RefCell;

use stationary_calculus::{
    Covector, Equation, Force, HessianSolver, Metric, Potential, Scaled, Sink, Storage, System,
    Unsolvable, Vector,
};

use crate::StepReport;
use crate::integrator::subtract;

/// The equation, and the memory that solving needs.
#[derive(Clone, Debug)]
pub(crate) struct AlphaEquation<'s, M, P, C, F, L> {
    pub(crate) system: &'s System<M, P>,
    force: Option<F>,
    solver: L,
    pub(crate) y: C,
    pub(crate) a: f64,
    /// The time, and the velocity w = start + slope (x - origin).
    pub(crate) t: f64,
    pub(crate) slope: f64,
    pub(crate) origin: C,
    pub(crate) start: Vector<C>,
    pub(crate) velocity: Vector<C>,
    pub(crate) difference: Vector<C>,
    flat: Covector<C>,
    scratch: RefCell<Vec<f64>>,
    pub(crate) report: StepReport,
}

impl<'s, M: Metric, P: Potential, C: Storage, F: Force, L: HessianSolver>
    AlphaEquation<'s, M, P, C, F, L>
{
    pub(crate) fn new(system: &'s System<M, P>, force: Option<F>, solver: L, zero: &C) -> Self {
        AlphaEquation {
            system,
            force,
            solver,
            y: zero.clone(),
            a: 0.0,
            t: 0.0,
            slope: 0.0,
            origin: zero.clone(),
            start: Vector(zero.clone()),
            velocity: Vector(zero.clone()),
            difference: Vector(zero.clone()),
            flat: Covector(zero.clone()),
            scratch: RefCell::new(Vec::new()),
            report: StepReport::default(),
        }
    }
}

impl<M: Metric, P: Potential, C: Storage, F: Force, L: HessianSolver>
    AlphaEquation<'_, M, P, C, F, L>
{
    /// Writes `-dV + F` at the origin with the velocity and the time that are set.
    pub(crate) fn evaluate(&mut self, rate: &mut Covector<C>) {
        let q = self.origin.as_ref();
        self.flat.clear();
        self.system.potential().add_differential(q, self.flat.view_mut());
        rate.clear();
        if let Some(force) = &self.force {
            force.add_force(self.t, q, self.velocity.view(), rate.view_mut());
        }
        rate.add_scaled(-1.0, self.flat.view());
        self.report.differentials += 1;
    }

    /// Writes the velocity that belongs to x.
    pub(crate) fn follow(&mut self, x: &[f64]) {
        subtract(x, self.origin.as_ref(), &mut self.difference);
        self.velocity.clone_from(&self.start);
        self.velocity.add_scaled(self.slope, self.difference.view());
    }
}

impl<M: Metric, P: Potential, C: Storage, F: Force, L: HessianSolver> Equation
    for AlphaEquation<'_, M, P, C, F, L>
{
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        self.flat.clear();
        if self.force.is_some() {
            self.follow(x);
        }
        if let Some(force) = &self.force {
            force.add_force(self.t, x, self.velocity.view(), self.flat.view_mut());
            self.flat.components_mut().iter_mut().for_each(|f| *f = -*f);
        }
        self.system.potential().add_differential(x, self.flat.view_mut());
        self.report.differentials += 1;
        subtract(x, self.y.as_ref(), &mut self.difference);
        let mut f = Covector(f);
        self.system.metric().flat(self.difference.view(), f.view_mut());
        f.add_scaled(self.a, self.flat.view());
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        if self.force.is_some() {
            self.follow(x);
        }
        let tangent = Tangent {
            potential: self.system.potential(),
            force: self.force.as_ref(),
            t: self.t,
            velocity: self.velocity.components(),
            slope: self.slope,
            scratch: &self.scratch,
        };
        let rung = self.solver.factor(self.system.metric(), &tangent, x, self.a)?;
        self.report.hessians += 1;
        self.report.rung = self.report.rung.max(rung);
        self.solver.solve(f);
        self.solver.unsolved().map_or(Ok(()), Err)
    }

    fn norm(&mut self, f: &[f64]) -> f64 {
        let f = Covector(f);
        self.system.metric().sharp(f.view(), self.difference.view_mut());
        f.apply(&self.difference).sqrt()
    }

    fn energy(&mut self, x: &[f64]) -> Option<f64> {
        if self.force.is_some() {
            return None;
        }
        subtract(x, self.y.as_ref(), &mut self.difference);
        self.system.metric().flat(self.difference.view(), self.flat.view_mut());
        self.report.energies += 1;
        let kinetic = 0.5 * self.flat.apply(&self.difference);
        Some(kinetic + self.a * self.system.potential().energy(x))
    }
}

/// What a solver takes for a potential: its Hessian is that of the potential, the force's stiffness and the
/// damping that goes with the velocity.
struct Tangent<'a, P, F> {
    potential: &'a P,
    force: Option<&'a F>,
    t: f64,
    velocity: &'a [f64],
    slope: f64,
    scratch: &'a RefCell<Vec<f64>>,
}

impl<P: Potential, F: Force> Potential for Tangent<'_, P, F> {
    fn dim(&self) -> usize {
        self.potential.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.potential.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.potential.add_differential(q, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.potential.add_hessian(q, hessian);
        if let Some(force) = self.force {
            force.add_stiffness(self.t, q, hessian);
            let scratch = self.scratch.take();
            let mut scaled = Scaled::new(self.slope, hessian).with_scratch(scratch);
            force.add_damping(self.t, q, Vector(self.velocity), &mut scaled);
            self.scratch.replace(scaled.into_scratch());
        }
    }
}
