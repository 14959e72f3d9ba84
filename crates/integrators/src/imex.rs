//! Implicit for the stiff potential, explicit for the soft one.
//!
//! ```text
//! p~ = p  - h/2 dU(q)
//! (q', p^) = one step of the implicit midpoint rule for V from (q, p~)
//! p' = p^ - h/2 dU(q')
//! ```
//! `q` configuration (n), `p` momentum covector (n), `V` the system's potential, which is stiff, `U`
//! the soft one, `h` step in seconds; the energy is that of the system and U. Order 2, symmetric,
//! symplectic; keeps linear and angular momentum to rounding. Newton's method sees V alone, whose
//! Hessian may be constant or sparse where that of the sum is neither.
//!
//! Where V is quadratic no step resonates with it: the step is bounded by U alone,
//! `h < 2/sqrt(max d2U)` (`the_soft_potential_alone_bounds_the_step`). The price is the fast motion's
//! phase, which is that of the midpoint rule. Source: Stern and Grinspun 2009.

use stationary_calculus::{
    DenseSolver, HessianSolver, Metric, Potential, SizeError, Storage, System,
};

use crate::integrator::{Remembered, check_step, zeros};
use crate::{Facts, ImplicitMidpoint, Integrator, State, StepError, StepReport, implicit_midpoint};

/// What is known of the method; its stability is that of the stiff part.
const FACTS: Facts = Facts { name: "imex", ..implicit_midpoint::FACTS };

/// The implicit midpoint rule between half kicks of a second, soft potential.
#[derive(Clone, Debug)]
pub struct Imex<'s, M, P, Q, C, L = DenseSolver<C>> {
    stiff: ImplicitMidpoint<'s, M, P, C, L>,
    soft: Q,
    remembered: Remembered<C>,
    next: State<C>,
}

impl<'s, M: Metric, P: Potential, Q: Potential, C: Storage> Imex<'s, M, P, Q, C> {
    /// The method on a system whose own potential is stiff, and a soft potential beside it.
    pub fn new(system: &'s System<M, P>, soft: Q) -> Result<Self, SizeError> {
        Imex::around(ImplicitMidpoint::new(system)?, system.dim(), soft)
    }
}

impl<'s, M: Metric, P: Potential, Q: Potential, C: Storage, L: HessianSolver>
    Imex<'s, M, P, Q, C, L>
{
    /// The same with the caller's solver for the stiff potential: a sparse one for many freedoms.
    pub fn with_solver(system: &'s System<M, P>, soft: Q, solver: L) -> Result<Self, SizeError> {
        Imex::around(ImplicitMidpoint::with_solver(system, solver)?, system.dim(), soft)
    }

    fn around(
        stiff: ImplicitMidpoint<'s, M, P, C, L>,
        n: usize,
        soft: Q,
    ) -> Result<Self, SizeError> {
        SizeError::check("the soft potential's freedoms", n, soft.dim())?;
        let next = State::new(zeros(n)?, zeros(n)?);
        Ok(Imex { stiff, soft, remembered: Remembered::new(n)?, next })
    }
}

impl<M: Metric, P: Potential, Q: Potential, C: Storage, L: HessianSolver> Integrator<C>
    for Imex<'_, M, P, Q, C, L>
{
    fn facts(&self) -> Facts {
        FACTS
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, self.soft.dim(), h)?;
        let mut kicks = 0;
        self.next.clone_from(state);
        let State { q, p, .. } = &mut self.next;
        p.add_scaled(-0.5 * h, self.remembered.at(&self.soft, q, &mut kicks).view());
        let mut report = self.stiff.step(&mut self.next, h)?;
        let State { q, p, .. } = &mut self.next;
        p.add_scaled(-0.5 * h, self.remembered.at(&self.soft, q, &mut kicks).view());
        report.differentials += kicks;
        state.accept(&mut self.next, h)?;
        Ok(report)
    }
}
