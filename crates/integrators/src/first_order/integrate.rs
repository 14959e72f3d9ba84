//! A run: step after step to an end, with an observer that sees every accepted one.
//!
//! ```text
//! t0 -> t1 -> ... -> end,      and between them the polynomial of each step
//! ```
//! The observer may look at the state at the step's end, at the dense output within the step, and
//! for crossings of an [`Event`]; it may end the run; it allocates only what it wants to. On an
//! error the method stands at its last good moment.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use stationary_calculus::Storage;

use super::{AdaptiveError, AdaptiveMethod, Event, Moment};

/// How many steps observers have seen, of all methods: the count of a method is set back where it loads.
static SEEN: AtomicU64 = AtomicU64::new(0);

/// What the observer sees after a step.
#[derive(Debug)]
pub struct AcceptedStep<'a, C, A: ?Sized> {
    method: &'a mut A,
    number: u64,
    from: f64,
    /// Whether it began where the step before it had ended, in the same state.
    goes_on: bool,
    /// The moment of an event at which the run ends before the step does.
    cut: Option<&'a Moment<C>>,
}

impl<'a, C: Storage, A: AdaptiveMethod<C> + ?Sized> AcceptedStep<'a, C, A> {
    fn new(method: &'a mut A, from: f64, goes_on: bool, cut: Option<&'a Moment<C>>) -> Self {
        let number = SEEN.fetch_add(1, Ordering::Relaxed);
        AcceptedStep { method, number, from, goes_on, cut }
    }

    /// What no other step has, not even the same one taken again.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Whether what was known at the end of the step before it holds where it began.
    pub(super) fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// The time at which the step began, seconds.
    pub fn from(&self) -> f64 {
        self.from
    }

    /// The time at which it ended, seconds.
    pub fn to(&self) -> f64 {
        self.moment().t
    }

    /// The moment at its end.
    pub fn moment(&self) -> &Moment<C> {
        self.cut.unwrap_or(self.method.moment())
    }

    /// Writes the state at a time within the step.
    ///
    /// # Errors
    /// [`AdaptiveError::OutsideStep`] for a time before the step or after it; those of
    /// [`AdaptiveMethod::interpolate`].
    pub fn interpolate(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        let (from, to) = (self.from, self.to());
        if !(from <= t && t <= to) {
            return Err(AdaptiveError::OutsideStep { t, from, to });
        }
        self.method.interpolate(t, y)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At its end.
    Finished,
    /// Where the observer broke off.
    BrokenOff,
}

/// Steps to `end` seconds, or until the observer breaks off.
///
/// # Errors
/// Those of [`AdaptiveMethod::step`], as for an end that does not lie ahead.
pub fn integrate<C: Storage, A: AdaptiveMethod<C> + ?Sized>(
    method: &mut A,
    end: f64,
    mut observe: impl FnMut(AcceptedStep<'_, C, A>) -> ControlFlow<()>,
) -> Result<Outcome, AdaptiveError> {
    loop {
        let from = method.moment().t;
        // After a restart there is no last step.
        let goes_on = method.last_begin().is_some();
        method.step(end)?;
        if observe(AcceptedStep::new(method, from, goes_on, None)).is_break() {
            return Ok(Outcome::BrokenOff);
        }
        if method.moment().t >= end {
            return Ok(Outcome::Finished);
        }
    }
}

/// Steps until the event, where the method then stands, and which must come before `end` seconds.
/// The observer cannot break off; the last step that it sees ends at the event.
///
/// # Errors
/// [`AdaptiveError::NoEvent`] where the function does not cross zero in the event's direction; those
/// of [`AdaptiveMethod::step`], [`AdaptiveMethod::restart`] and [`Event::crossing`].
pub fn integrate_to_event<C, A, G>(
    method: &mut A,
    end: f64,
    event: &mut Event<G, C>,
    mut observe: impl FnMut(AcceptedStep<'_, C, A>),
) -> Result<(), AdaptiveError>
where
    C: Storage,
    A: AdaptiveMethod<C> + ?Sized,
    G: FnMut(f64, &[f64]) -> f64,
{
    let first = event.begin(method.moment())?;
    loop {
        let from = method.moment().t;
        method.step(end)?;
        if event.crossing(&mut AcceptedStep::new(method, from, true, None))? {
            let cut = event.moment();
            observe(AcceptedStep::new(method, from, true, Some(cut)));
            return method.restart(event.moment());
        }
        observe(AcceptedStep::new(method, from, true, None));
        if method.moment().t >= end {
            return Err(AdaptiveError::NoEvent { first, last: event.value(), end });
        }
    }
}
