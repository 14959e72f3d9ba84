//! An integrator: a map from phase space to itself that approximates the flow over a step.
//!
//! ```text
//! (q, p) -> Phi_h(q, p),    Phi_h close to the exact flow over the time h  (notes 4.3)
//! ```
//! An integrator is bound to a system when it is made: sizes are checked and all memory is taken
//! then, so that a step checks little and allocates nothing.

use stationary_calculus::{
    Covector, HessianSolver, Newton, NewtonMemory, Potential, Rung, SizeError, Storage, Vector,
};

use crate::{Facts, Saved, State, StepError};

/// A map from phase space to itself.
pub trait Integrator<C> {
    /// What is known of the method.
    fn facts(&self) -> Facts;

    /// Moves `state` forward by `h` seconds. On an error the state is as it was.
    ///
    /// # Errors
    /// [`StepError::Step`] unless `h` is positive and finite; [`StepError::Size`] for a state of
    /// another size; [`StepError::NonFiniteConfiguration`], [`StepError::NonFiniteMomentum`] and
    /// [`StepError::Time`] where the step leads there; of implicit methods [`StepError::Newton`] or
    /// [`StepError::SingularLegendreTransform`]; of methods for bodies [`StepError::Configuration`].
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError>;

    /// Everything on which the next steps depend beside the state: nothing, of a method that does not
    /// say otherwise.
    fn save(&self) -> Saved {
        Saved { method: self.facts().name.to_owned(), numbers: Vec::new() }
    }

    /// Takes over what the same method on the same system had saved, and goes on from its state to
    /// the same bits.
    ///
    /// # Errors
    /// Another method's numbers, or another system's; the method is then as it was.
    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        saved.check_empty(self.facts().name)
    }
}

impl<C, I: Integrator<C> + ?Sized> Integrator<C> for Box<I> {
    fn facts(&self) -> Facts {
        (**self).facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        (**self).step(state, h)
    }

    fn save(&self) -> Saved {
        (**self).save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        (**self).load(saved)
    }
}

/// What a step cost, and how it went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Differentials of the potential evaluated.
    pub differentials: u32,
    /// Hessians of the potential evaluated, each one a factorization.
    pub hessians: u32,
    /// Energies evaluated by a line search.
    pub energies: u32,
    /// Size of the residual of an implicit step, in kg^1/2 m.
    pub residual: f64,
    /// The highest rung of the solver's ladder that was needed.
    pub rung: Rung,
}

/// More Newton iterations than this in a step make the Hessian suspect (notes 4.4).
const DOZEN: u32 = 12;

impl StepReport {
    /// True where Newton's method needed so many iterations that the Hessian is probably wrong.
    pub fn suspects_the_hessian(&self) -> bool {
        self.hessians > DOZEN
    }
}

/// An error unless the step is positive and finite and the state has the system's size.
#[inline]
pub(crate) fn check_step<C: Storage>(state: &State<C>, n: usize, h: f64) -> Result<(), StepError> {
    if !(h > 0.0 && h.is_finite()) {
        return Err(StepError::Step(h));
    }
    SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
    SizeError::check("the momentum's components", n, state.p.components().len())?;
    Ok(())
}

/// An error where a solver says that it was made for another number of freedoms.
pub(crate) fn check_solver(n: usize, solver: &impl HessianSolver) -> Result<(), SizeError> {
    SizeError::check("the solver's freedoms", n, solver.dim().unwrap_or(n))
}

/// Zeros of the system's size, or an error where the storage has another.
pub(crate) fn zeros<C: Storage>(n: usize) -> Result<C, SizeError> {
    let what = "the storage's numbers";
    C::zeros(n).ok_or(SizeError { what, expected: n, got: std::mem::size_of::<C>() / 8 })
}

/// Memory for Newton's method in n unknowns, or an error where the storage has another size.
pub(crate) fn newton_memory<C: Storage>(
    n: usize,
    newton: Newton,
) -> Result<NewtonMemory<C>, SizeError> {
    let got = zeros::<C>(n)?.as_ref().len();
    let what = "the storage's numbers";
    NewtonMemory::new(n, newton.iterations).ok_or(SizeError { what, expected: n, got })
}

/// `difference = x - y`, entry by entry.
pub(crate) fn subtract<C: Storage>(x: &[f64], y: &[f64], difference: &mut Vector<C>) {
    for ((difference, x), y) in difference.components_mut().iter_mut().zip(x).zip(y) {
        *difference = x - y;
    }
}

/// The differential of a potential at a configuration, remembered for the next step.
#[derive(Clone, Debug)]
pub(crate) struct Remembered<C> {
    q: Option<C>,
    dv: Covector<C>,
}

impl<C: Storage> Remembered<C> {
    pub(crate) fn new(n: usize) -> Result<Self, SizeError> {
        Ok(Remembered { q: None, dv: Covector(zeros(n)?) })
    }

    /// dV(q), evaluated unless it was at this very `q` last time.
    #[inline]
    pub(crate) fn at(
        &mut self,
        potential: &impl Potential,
        q: &C,
        evaluations: &mut u32,
    ) -> &Covector<C> {
        if self.q.as_ref() != Some(q) {
            self.dv.clear();
            potential.add_differential(q.as_ref(), self.dv.view_mut());
            match &mut self.q {
                Some(last) => last.clone_from(q),
                None => self.q = Some(q.clone()),
            }
            *evaluations += 1;
        }
        &self.dv
    }
}
