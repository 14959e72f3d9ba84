//! How far a run of steps of its own choice is from the true motion: the distance to a tighter run.
//!
//! ```text
//! e = y_2 - y_0        its error, but for that of the tightest of three runs
//! |y_2 - y_1|          how far that may be off: the estimate's doubt
//! ```
//! `y_0`, `y_1` and `y_2` the runs of falling tolerance at the end of a step of the first. A tolerance holds
//! the error of a step; this is what the flow makes of all of them. Where runs take the same steps,
//! whatever their tolerances, nothing is known, and that is said.

use std::ops::ControlFlow;

use stationary_calculus::Storage;

use super::{AdaptiveError, AdaptiveMethod, Moment, Outcome};
use crate::global_error::{DOUBTFUL, ROUNDING, distance, norm};

/// What the observer sees after a step of the loosest run.
#[derive(Debug)]
pub struct EstimatedMoment<'a, C> {
    /// The moment at the step's end, of the loosest run.
    pub moment: &'a Moment<C>,
    /// The tightest run's state there minus this one.
    pub error: &'a [f64],
    /// How far the two tighter runs are apart: as far as the tightest may itself be off.
    pub doubt: f64,
}

impl<C: AsRef<[f64]>> EstimatedMoment<'_, C> {
    /// The estimated distance of the state from the true one.
    pub fn distance(&self) -> f64 {
        norm(self.error)
    }

    /// Whether the estimate can be relied on: its doubt is at most a quarter of it, and it is more than
    /// rounding. It is not where the runs took the same steps, whatever their tolerances.
    pub fn is_sure(&self) -> bool {
        let distance = self.distance();
        let rounding = 16.0 * ROUNDING * norm(self.moment.y.as_ref());
        self.doubt <= DOUBTFUL * distance && distance > rounding
    }
}

/// Runs a method to `end` beside two of smaller tolerances from the same moment, such as a tenth and a
/// hundredth, and shows at each of its steps how far it is from the tightest: its error, but for that
/// of the tightest run.
///
/// # Errors
/// [`AdaptiveError::OutsideStep`] and [`AdaptiveError::Size`] where the runs do not stand at one moment
/// with one size; else those of [`AdaptiveMethod::step`] and of [`AdaptiveMethod::interpolate`], from
/// any. Each stands at its last good moment.
pub fn integrate_with_error<C, A>(
    [loose, middle, tight]: [&mut A; 3],
    end: f64,
    mut observe: impl FnMut(EstimatedMoment<'_, C>) -> ControlFlow<()>,
) -> Result<Outcome, AdaptiveError>
where
    C: Storage,
    A: AdaptiveMethod<C> + ?Sized,
{
    let start = loose.moment().t;
    if let Some(t) = [middle.moment().t, tight.moment().t].into_iter().find(|t| *t != start) {
        return Err(AdaptiveError::OutsideStep { t, from: start, to: start });
    }
    let mut between = loose.moment().y.as_ref().to_vec();
    let mut error = between.clone();
    loop {
        loose.step(end)?;
        let to = loose.moment().t;
        for (run, there) in [(&mut *middle, &mut between), (&mut *tight, &mut error)] {
            while run.moment().t < to {
                run.step(end)?;
            }
            run.interpolate(to, there)?;
        }
        let doubt = distance(&between, &error);
        let moment = loose.moment();
        error.iter_mut().zip(moment.y.as_ref()).for_each(|(error, y)| *error -= y);
        if observe(EstimatedMoment { moment, error: &error, doubt }).is_break() {
            return Ok(Outcome::BrokenOff);
        }
        if to >= end {
            return Ok(Outcome::Finished);
        }
    }
}
