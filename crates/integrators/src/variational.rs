//! Variational integrators: a step is whatever makes the action stationary.
//!
//! ```text
//! p0 = -h d1 L_d(q0, q1, h) - h/2 F       solved for q1 by Newton's method          (5.5, 10.1)
//! p1 =  h d2 L_d(q0, q1, h) + h/2 F
//! F  =  F(t + h/2, (q0 + q1)/2, (q1 - q0)/h)
//! ```
//! `q` configuration (N), `p` momentum covector (N), `L_d` a [`DiscreteLagrangian`] in joules, `h`
//! step in seconds, `F` a force that no potential gives, of which either end takes half: the
//! discrete Lagrange-d'Alembert principle with the midpoint's virtual work.
//!
//! Without a force the step is symplectic, and keeps the momentum of every symmetry of L_d to
//! rounding. The order is that of L_d; with a force it is at most 2. The last Newton step is too
//! small to move q1, yet (q1 - q0)/h shows it: its effect on p1 is added, or rounding of q1 would
//! be magnified by 1/h in every step.
//!
//! A step costs N (N + 1) evaluations of L_d an iteration: right for a few freedoms. The residual
//! that it reports is in units of momentum. The next configuration is looked for from q0, so a step
//! so long that q1 has several solutions takes the one that Newton's method finds from there.
//! Source: notes 5.5, 10.1; Marsden and West (2001), sections 1 and 3.2.

use stationary_calculus::{
    Covector, DenseLu, DenseSink, Equation, Force, Newton, NewtonError, NewtonFailure,
    NewtonMemory, SizeError, Unsolvable, Vector, array,
};

use crate::discrete_lagrangian::{End, add_second_differential};
use crate::integrator::{check_step, newton_memory};
use crate::{DiscreteLagrangian, Facts, Integrator, State, StepError, StepReport};

/// The integrator of a discrete Lagrangian, and of forces beside it.
#[derive(Clone, Debug)]
pub struct Variational<L, const N: usize, F = ()> {
    newton: Newton,
    equation: StepEquation<L, F, N>,
    memory: NewtonMemory<[f64; N]>,
}

/// `p0 + h d1 L_d + h/2 F = 0` in the unknown q1.
#[derive(Clone, Debug)]
struct StepEquation<L, F, const N: usize> {
    lagrangian: L,
    force: F,
    lu: DenseLu,
    block: Vec<f64>,
    t: f64,
    h: f64,
    q0: [f64; N],
    p0: Covector<[f64; N]>,
    report: StepReport,
}

impl<L: DiscreteLagrangian<N>, const N: usize> Variational<L, N> {
    /// The integrator of a discrete Lagrangian.
    ///
    /// # Errors
    /// None: an array of N numbers has the size of every N.
    pub fn new(lagrangian: L) -> Result<Self, SizeError> {
        Variational::solving(lagrangian, ())
    }
}

impl<L: DiscreteLagrangian<N>, const N: usize, F: Force> Variational<L, N, F> {
    /// The integrator of a discrete Lagrangian and a force.
    ///
    /// # Errors
    /// Where the force has another number of freedoms.
    pub fn forced(lagrangian: L, force: F) -> Result<Self, SizeError> {
        SizeError::check("the force's freedoms", N, force.dim())?;
        Variational::solving(lagrangian, force)
    }

    fn solving(lagrangian: L, force: F) -> Result<Self, SizeError> {
        let newton = Newton::default();
        let equation = StepEquation {
            lagrangian,
            force,
            lu: DenseLu::new(N),
            block: vec![0.0; N * N],
            t: 0.0,
            h: 0.0,
            q0: [0.0; N],
            p0: Covector([0.0; N]),
            report: StepReport::default(),
        };
        Ok(Variational { newton, equation, memory: newton_memory(N, newton)? })
    }

    /// The same integrator with other bounds on Newton's method. The tolerance is in units of
    /// momentum.
    ///
    /// # Errors
    /// None: an array of N numbers has the size of every N. The bounds are checked by each step.
    pub fn with_newton(self, newton: Newton) -> Result<Self, SizeError> {
        Ok(Variational { newton, memory: newton_memory(N, newton)?, ..self })
    }

    /// The discrete Lagrangian.
    pub fn lagrangian(&self) -> &L {
        &self.equation.lagrangian
    }
}

impl<L: DiscreteLagrangian<N>, const N: usize, F: Force> Integrator<[f64; N]>
    for Variational<L, N, F>
{
    fn facts(&self) -> Facts {
        self.equation.lagrangian.facts()
    }

    fn step(&mut self, state: &mut State<[f64; N]>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, N, h)?;
        let Variational { newton, equation, memory } = self;
        equation.begin(state, h);
        let mut q = state.q;
        let solved = newton.solve(equation, &mut q, memory).map_err(or_singular)?;
        let mut correction = Vector([0.0; N]);
        equation.residual(&q, correction.components_mut());
        equation.solve(&q, correction.components_mut()).map_err(|why| {
            or_singular(NewtonError {
                failure: NewtonFailure::Unsolvable(why),
                history: memory.history().to_vec(),
            })
        })?;
        let p = equation.momentum_after(&q, &correction);
        (0..N).for_each(|i| q[i] -= correction.0[i]);
        let mut next = State { t: state.t, q, p };
        state.accept(&mut next, h)?;
        Ok(StepReport { residual: solved.residual, ..equation.report })
    }
}

/// A singular Jacobian is a property of the discrete Lagrangian, and has a name.
fn or_singular(error: NewtonError) -> StepError {
    match error.failure {
        NewtonFailure::Unsolvable(Unsolvable::Singular) => StepError::SingularLegendreTransform,
        _ => StepError::Newton(error),
    }
}

impl<L: DiscreteLagrangian<N>, F: Force, const N: usize> StepEquation<L, F, N> {
    fn begin(&mut self, state: &State<[f64; N]>, h: f64) {
        (self.t, self.h, self.report) = (state.t, h, StepReport::default());
        (self.q0, self.p0) = (state.q, state.p);
    }

    /// The middle of the step, and the velocity there.
    fn middle(&self, q1: &[f64]) -> (f64, [f64; N], Vector<[f64; N]>) {
        let q = array(|i| 0.5 * (self.q0[i] + q1[i]));
        let v = array(|i| (q1[i] - self.q0[i]) / self.h);
        (self.t + 0.5 * self.h, q, Vector(v))
    }

    /// h/2 F, in units of momentum.
    fn half_of_the_force(&self, q1: &[f64]) -> Covector<[f64; N]> {
        let (t, q, v) = self.middle(q1);
        let mut f = Covector([0.0; N]);
        self.force.add_force(t, &q, v.view(), f.view_mut());
        Covector(f.0.map(|f| 0.5 * self.h * f))
    }

    /// p1 at `q1 - correction`, to first order in the correction.
    fn momentum_after(
        &mut self,
        q1: &[f64; N],
        correction: &Vector<[f64; N]>,
    ) -> Covector<[f64; N]> {
        let mut p = self.lagrangian.momentum_after(self.q0, *q1, self.h);
        p.add_scaled(1.0, self.half_of_the_force(q1).view());
        self.block.fill(0.0);
        let (ends, both) = ([self.q0, *q1], (End::Last, End::Last));
        add_second_differential(&self.lagrangian, ends, self.h, both, &mut self.block);
        for (column, correction) in self.block.chunks_exact(N.max(1)).zip(&correction.0) {
            p.add_scaled(-correction, Covector(column));
        }
        p
    }
}

impl<L: DiscreteLagrangian<N>, F: Force, const N: usize> Equation for StepEquation<L, F, N> {
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        let q1 = array(|i| x[i]);
        let p = self.lagrangian.momentum_before(self.q0, q1, self.h);
        let force = self.half_of_the_force(x);
        for (i, f) in f.iter_mut().enumerate() {
            *f = self.p0.0[i] - p.0[i] + force.0[i];
        }
        self.report.differentials += 1;
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        let q1 = array(|i| x[i]);
        let matrix = self.lu.matrix();
        matrix.fill(0.0);
        let (ends, rows) = ([self.q0, q1], (End::First, End::Last));
        add_second_differential(&self.lagrangian, ends, self.h, rows, matrix);
        let (t, q, v) = self.middle(x);
        if let Some(mut half) = DenseSink::new(-0.5, N, self.lu.matrix()) {
            self.force.add_damping(t, &q, v.view(), &mut half);
        }
        self.report.hessians += 1;
        self.lu.factor()?;
        self.lu.solve(f);
        Ok(())
    }

    fn norm(&mut self, f: &[f64]) -> f64 {
        f.iter().map(|f| f * f).sum::<f64>().sqrt()
    }

    fn energy(&mut self, _: &[f64]) -> Option<f64> {
        None
    }
}
