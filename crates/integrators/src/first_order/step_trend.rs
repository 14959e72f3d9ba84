//! The next step, from the error of this one and of the one before.
//!
//! ```text
//! g = SAFETY err^(-1/(k+1))                       what a step could be, relative to this one
//! h' = h g min(1, (h / h_before) (g / g_before))           accepted: err <= 1
//! h' = h g                                                 refused
//! ```
//! `err` the estimated error in units of the tolerance, `k` the order of the estimate. The second
//! factor follows a trend: on the way into a close encounter each step comes out shorter than the
//! last, by a ratio that changes slowly. Without it a third of the steps there are refused. Source:
//! Gustafsson, Control-theoretic techniques for stepsize selection in implicit Runge-Kutta methods,
//! ACM Transactions on Mathematical Software 20 (1994) 496-517.

/// What is aimed at, relative to the longest step that the estimate allows.
const SAFETY: f64 = 0.9;
/// The most that a step may be longer than the last.
const GROWTH: f64 = 5.0;
/// The least that a step may be, relative to the last.
const SHRINK: f64 = 0.1;

/// What is remembered of the steps so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepTrend {
    exponent: f64,
    before: Option<(f64, f64)>,
    growth: f64,
}

impl StepTrend {
    pub(crate) fn new(order: u32) -> Self {
        StepTrend { exponent: -1.0 / f64::from(order + 1), before: None, growth: GROWTH }
    }

    /// Visits what is remembered; a length of 0 stands for no step.
    pub(crate) fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let (mut length, mut factor) = self.before.unwrap_or((0.0, 0.0));
        visit(&mut length);
        visit(&mut factor);
        visit(&mut self.growth);
        self.before = (length != 0.0).then_some((length, factor));
    }

    /// Whether steps may have left this behind.
    pub(crate) fn is_possible(&self) -> bool {
        let before = self.before.is_none_or(|(length, factor)| length > 0.0 && factor > 0.0);
        before && (1.0..=GROWTH).contains(&self.growth)
    }

    /// The step after an accepted one of `h` seconds.
    #[inline]
    pub(crate) fn accepted(&mut self, h: f64, error: f64) -> f64 {
        // An error of zero leaves a number that can be saved, too.
        let factor = (SAFETY * error.powf(self.exponent)).min(f64::MAX);
        let trend = self.before.map_or(1.0, |(length, before)| h / length * (factor / before));
        let next = h * (factor * trend.min(1.0)).clamp(SHRINK, self.growth);
        self.before = Some((h, factor));
        self.growth = GROWTH;
        next
    }

    /// The step in place of a refused one of `h` seconds. The one after it may not be longer.
    #[inline]
    pub(crate) fn refused(&mut self, h: f64, error: f64) -> f64 {
        self.growth = 1.0;
        let factor = SAFETY * error.powf(self.exponent);
        // An error that is not a number shrinks the step the most.
        h * if factor < 1.0 { factor.max(SHRINK) } else { SHRINK }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_a_number_shrinks_the_step_the_most() {
        for error in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(StepTrend::new(10).refused(2.0, error), 0.2);
        }
    }

    #[test]
    fn no_error_at_all_grows_the_step_the_most() {
        let mut control = StepTrend::new(6);
        assert_eq!(control.accepted(1.0, 0.0), 5.0);
        assert_eq!(control.accepted(5.0, 0.0), 25.0);
    }

    #[test]
    fn a_step_that_keeps_getting_shorter_is_followed() {
        let mut control = StepTrend::new(6);
        assert!(control.accepted(1.0, 0.9_f64.powi(7)) >= 1.0);
        // The same margin at half the length: the next can be half as long again.
        assert!((control.accepted(0.5, 0.9_f64.powi(7)) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn after_a_refusal_the_step_does_not_grow() {
        let mut control = StepTrend::new(6);
        let shorter = control.refused(1.0, 2.0);
        assert!(shorter < 0.9);
        assert_eq!(control.accepted(shorter, 1e-9), shorter);
    }
}
