//! A point of phase space: a configuration and its momentum.

use stationary_calculus::{Covector, Storage, first_non_finite};

use crate::{StepError, StepReport};

/// A configuration `q` and a momentum `p` (a covector), as many numbers each (notes 4.2), at a time.
#[derive(Debug, Default, PartialEq)]
pub struct State<C> {
    /// The time, seconds.
    pub t: f64,
    /// The configuration.
    pub q: C,
    /// The momentum.
    pub p: Covector<C>,
}

impl<C: Clone> Clone for State<C> {
    #[inline]
    fn clone(&self) -> Self {
        State { t: self.t, q: self.q.clone(), p: self.p.clone() }
    }

    /// Reuses the memory that is there.
    #[inline]
    fn clone_from(&mut self, source: &Self) {
        self.t = source.t;
        self.q.clone_from(&source.q);
        self.p.clone_from(&source.p);
    }
}

impl<C: Storage> State<C> {
    /// See [`Storage::lend`].
    #[inline]
    pub(crate) fn lend(&mut self) -> Self {
        State { t: self.t, q: self.q.lend(), p: Covector(self.p.0.lend()) }
    }

    /// See [`Storage::put_back`].
    #[inline]
    pub(crate) fn put_back(&mut self, lent: Self) {
        self.q.put_back(lent.q);
        self.p.0.put_back(lent.p.0);
    }

    /// Moves a copy of this state, in the memory of `spare`, and takes it over `h` seconds later; or
    /// returns an error and stays as it was.
    #[inline]
    pub(crate) fn step(
        &mut self,
        spare: &mut Self,
        h: f64,
        advance: impl FnOnce(&Self, &mut Self) -> Result<StepReport, StepError>,
    ) -> Result<StepReport, StepError> {
        let mut next = spare.lend();
        next.clone_from(self);
        let advanced = advance(self, &mut next);
        let accepted = advanced.and_then(|report| self.accept(&mut next, h).map(|()| report));
        spare.put_back(next);
        accepted
    }
}

impl<C: AsRef<[f64]>> State<C> {
    /// The state at configuration `q` with momentum `p` at time zero.
    ///
    /// A velocity is no momentum: the metric makes one of the other.
    ///
    /// ```compile_fail,E0308
    /// use stationary_calculus::Vector;
    /// let velocity = Vector([0.5]);
    /// stationary_integrators::State::new([1.0], velocity);
    /// ```
    pub fn new(q: C, p: Covector<C>) -> Self {
        State { t: 0.0, q, p }
    }

    /// An error that names the first number that is not finite, if there is one.
    #[inline]
    pub(crate) fn check_finite(&self) -> Result<(), StepError> {
        if let Some(freedom) = first_non_finite(self.q.as_ref()) {
            return Err(StepError::NonFiniteConfiguration { freedom });
        }
        if let Some(freedom) = first_non_finite(self.p.components()) {
            return Err(StepError::NonFiniteMomentum { freedom });
        }
        Ok(())
    }

    /// Takes over `next`, `h` seconds later, or returns an error and stays as it was.
    #[inline]
    pub(crate) fn accept(&mut self, next: &mut Self, h: f64) -> Result<(), StepError> {
        next.check_finite()?;
        next.t = self.t + h;
        if !next.t.is_finite() {
            return Err(StepError::Time(next.t));
        }
        std::mem::swap(self, next);
        Ok(())
    }
}
