//! Implicit for the stiff potential, explicit for the soft one.
//!
//! ```text
//! p~ = p  - h/2 dU(q)
//! (q', p^) = one step of the implicit midpoint rule for V from (q, p~)
//! p' = p^ - h/2 dU(q')
//! ```
//! `q` configuration (n), `p` momentum covector (n), `V` the system's potential, which is stiff,
//! `U` the soft one, `h` step in seconds; the energy is that of the system and U. Order 2,
//! symmetric, symplectic; keeps linear and angular momentum to rounding. Newton's method sees V
//! alone, whose Hessian may be constant or sparse where that of the sum is neither.
//!
//! Where V is quadratic no step resonates with it: the step is bounded by U alone, `h < 2/sqrt(max
//! d2U)` (`the_soft_potential_alone_bounds_the_step`). The price is the fast motion's phase, which
//! is that of the midpoint rule. Source: Stern and Grinspun 2009.

use stationary_calculus::{
    Covector, DenseSolver, HessianSolver, Metric, Potential, SizeError, Storage, System,
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
    ///
    /// # Errors
    /// [`SizeError`] for a storage or a soft potential of another size than the system's.
    pub fn new(system: &'s System<M, P>, soft: Q) -> Result<Self, SizeError> {
        Imex::around(ImplicitMidpoint::new(system)?, system.dim(), soft)
    }
}

impl<'s, M: Metric, P: Potential, Q: Potential, C: Storage, L: HessianSolver>
    Imex<'s, M, P, Q, C, L>
{
    /// The same with the caller's solver for the stiff potential: a sparse one for many freedoms.
    ///
    /// # Errors
    /// A storage, a solver, or a soft potential of another size.
    pub fn with_solver(system: &'s System<M, P>, soft: Q, solver: L) -> Result<Self, SizeError> {
        Imex::around(ImplicitMidpoint::with_solver(system, solver)?, system.dim(), soft)
    }

    fn around(
        stiff: ImplicitMidpoint<'s, M, P, C, L>,
        n: usize,
        soft: Q,
    ) -> Result<Self, SizeError> {
        SizeError::check("the soft potential's freedoms", n, soft.dim())?;
        let next = State::new(zeros(n)?, Covector(zeros(n)?));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{Linear, PendulumPotential, oscillator};
    use stationary_calculus::{DiagonalMetric, Newton};

    /// A stiff spring of angular frequency `omega`, and a soft one of angular frequency 1.
    fn largest(omega: f64, h: f64) -> f64 {
        let stiff = oscillator(omega).unwrap();
        let mut imex = Imex::new(&stiff.system, Linear::<1> { stiffness: 1.0 }).unwrap();
        let mut state = State::new([1.0], Covector([0.5]));
        let mut largest = 0.0_f64;
        for _ in 0..2000 {
            if imex.step(&mut state, h).is_err() {
                return f64::INFINITY;
            }
            largest = largest.max(state.q[0].abs());
        }
        largest
    }

    #[test]
    fn the_soft_potential_alone_bounds_the_step() {
        for omega in [1.0, 10.0, 31.4159, 100.0, 1e4] {
            for i in 1..100 {
                let h = 0.0199 * f64::from(i);
                assert!(
                    largest(omega, h) < 60.0,
                    "omega = {omega}, h = {h}: {}",
                    largest(omega, h)
                );
            }
        }
        // The trace of the step's matrix passes -2 there, whatever the stiffness.
        for omega in [1e-3, 1.0, 10.0] {
            assert!(largest(omega, 2.1) > 1e6, "omega = {omega}");
        }
    }

    #[test]
    fn it_has_order_2_is_symmetric_and_sees_only_the_stiff_potential() {
        let metric = DiagonalMetric::new([1.0]).unwrap();
        let stiff = System::new(metric, Linear::<1> { stiffness: 9.0 }).unwrap();
        let after = |steps: u32| {
            let mut state = State::new([1.0], Covector([0.3]));
            let mut imex = Imex::new(&stiff, PendulumPotential).unwrap();
            for _ in 0..steps {
                let report = imex.step(&mut state, 1.0 / f64::from(steps)).unwrap();
                // One Newton step solves a quadratic potential, another one finds nothing to do.
                assert!(report.hessians <= 2, "{report:?}");
            }
            state
        };
        let ends = [40, 80, 160].map(|steps| after(steps).q[0]);
        let order = ((ends[0] - ends[1]) / (ends[1] - ends[2])).log2();
        assert!((order - 2.0).abs() < 0.02, "{order}");
        let mut state = after(1);
        state.p.0[0] *= -1.0;
        Imex::new(&stiff, PendulumPotential).unwrap().step(&mut state, 1.0).unwrap();
        assert!((state.q[0] - 1.0).abs() < 1e-14 && (state.p.0[0] + 0.3).abs() < 1e-14);
    }

    #[test]
    fn a_failed_step_leaves_the_state_as_it_was() {
        let stiff = oscillator(10.0).unwrap();
        let mut imex = Imex::new(&stiff.system, PendulumPotential).unwrap();
        imex.stiff = imex.stiff.with_newton(Newton { tolerance: 0.0, iterations: 0 }).unwrap();
        let mut state = State::new([1.0], Covector([0.3]));
        let start = state.clone();
        assert!(imex.step(&mut state, 0.1).is_err());
        assert_eq!(state, start);
    }
}
