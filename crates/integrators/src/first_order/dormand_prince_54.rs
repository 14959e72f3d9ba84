//! Dormand and Prince's explicit Runge-Kutta method of order 5 with an error of order 4 (DOPRI5).
//!
//! ```text
//! k_s = f(t + c_s h, y + h sum_j a_sj k_j)       s = 1 ... 7,  k_7 that of the end
//! y'  = y + h sum_s a_7s k_s
//! err = |h sum_s e_s k_s|                        order 5 minus order 4
//! y(t + x h) = y + x (d + (1-x) (r_3 + x (r_4 + (1-x) r_5)))
//! ```
//! `y` the state (n), `h` the step in seconds, `x` from 0 to 1, `d = y' - y`. Six evaluations a step, as the
//! last is the first of the next; the polynomial of order 4 takes none. A relative tolerance looser than 1e-4
//! is held as 1e-4.
//!
//! For a few digits of smooth motion, and to see whether another method comes to the same: with
//! [`DormandPrince853`](super::DormandPrince853) it has nothing in common but the step control. Knows no mass
//! matrix; what is said there of stiffness holds here. Source: Dormand, Prince, A family of embedded
//! Runge-Kutta formulae, Journal of Computational and Applied Mathematics 6 (1980) 19-26; the polynomial:
//! Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.6.

use std::array;

use stationary_calculus::Storage;

use super::error_scale::ErrorScale;
use super::first_step::guess_step;
use super::method::check_finite;
use super::step_control::Attempt;
use super::step_trend::StepTrend;
use super::stiffness::is_stiff;
use super::{
    AdaptiveError, AdaptiveMethod, FirstOrderFacts, Moment, StepControl, VectorField, Work,
};
use crate::integrator::zeros;
use crate::{Damping, Evaluation};

/// What is known of the method.
pub(super) const FACTS: FirstOrderFacts = FirstOrderFacts {
    name: "dormand-prince-54",
    order: 5,
    dense_order: 4,
    stages: 6,
    dense_stages: 0,
    evaluation: Evaluation::Explicit,
    loosest: LOOSEST,
    damping: Damping::Conditional,
    sector: 0.0,
};

/// A looser relative tolerance is held as this one: steps so long say nothing of their own error.
const LOOSEST: f64 = 1e-4;
/// The order of the error's estimate.
const ESTIMATE: u32 = 4;
/// Where h times the stiffest rate reaches this, the step is bounded by stability.
const STABILITY: f64 = 3.25;
/// One step in so many is looked at for stiffness.
const LOOK: u64 = 16;

const STAGES: usize = 7;

/// Where in the step each stage stands.
const C: [f64; STAGES] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];

/// The stages before each from the second on; the last row are the weights of order 5.
const A: [[f64; STAGES - 1]; STAGES - 1] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The weights of order 5 less those of order 4.
const E: [f64; STAGES] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// The weights of the polynomial's last coefficient.
const D: [f64; STAGES] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// The Dormand-Prince method of order 5(4), bound to a field.
#[derive(Clone, Debug)]
pub struct DormandPrince54<F, S> {
    field: F,
    control: StepControl,
    scale: ErrorScale<S>,
    moment: Moment<S>,
    /// The step proposed for the next attempt, and the errors so far.
    h: f64,
    trend: StepTrend,
    work: Work,
    /// f at the moment.
    f: S,
    last: LastStep<S>,
    stage: S,
    next: S,
    error: S,
}

/// The last step.
#[derive(Clone, Debug)]
struct LastStep<S> {
    begin: Option<f64>,
    h: f64,
    /// The state at its begin.
    y: S,
    k: [S; STAGES],
}

impl<F: VectorField, S: Storage> DormandPrince54<F, S> {
    /// The method on a field, starting from a moment.
    ///
    /// # Errors
    /// [`AdaptiveError::MassMatrix`] for a field that has one; [`AdaptiveError::Size`] unless
    /// storage, tolerances and state have the field's size; [`AdaptiveError::NonFinite`] for the
    /// time, the state or f there.
    pub fn new(field: F, control: StepControl, start: Moment<S>) -> Result<Self, AdaptiveError> {
        let n = field.dim();
        if field.mass().is_some() {
            return Err(AdaptiveError::MassMatrix { method: FACTS.name });
        }
        let zero: S = zeros(n)?;
        let k = array::from_fn(|_| zero.clone());
        let mut method = DormandPrince54 {
            scale: ErrorScale::new(&control.tolerance.held(1.0, LOOSEST), n)?,
            field,
            control,
            moment: start.clone(),
            h: 0.0,
            trend: StepTrend::new(ESTIMATE),
            work: Work::default(),
            f: zero.clone(),
            last: LastStep { begin: None, h: 0.0, y: zero.clone(), k },
            stage: zero.clone(),
            next: zero.clone(),
            error: zero,
        };
        method.restart(&start)?;
        Ok(method)
    }

    /// Evaluates the stages of a step and the next state, and returns the error in tolerances.
    #[inline]
    fn attempt(&mut self, h: f64) -> f64 {
        let DormandPrince54 { field, moment: Moment { t, y }, last, stage, next, .. } = self;
        let (y, k) = (y.as_ref(), &mut last.k);
        k[0].clone_from(&self.f);
        for s in 1..STAGES {
            // The last stage is the next state.
            let to = if s + 1 == STAGES { next.as_mut() } else { stage.as_mut() };
            combine(to, y, h, &A[s - 1][..s], k);
            field.evaluate(*t + C[s] * h, to, k[s].as_mut());
        }
        self.work.evaluations += STAGES as u64 - 1;
        let mut sum = 0.0;
        let states = y.iter().zip(self.next.as_ref()).zip(self.scale.absolute.as_ref());
        for (i, ((y, next), absolute)) in states.enumerate() {
            let error: f64 = E.iter().zip(&self.last.k).map(|(e, k)| e * k.as_ref()[i]).sum();
            let tolerated = absolute + self.scale.relative * y.abs().max(next.abs());
            // A state that overflowed makes the whole sum a NaN.
            sum += (h * error / tolerated).powi(2) + 0.0 * next;
        }
        (sum / y.len().max(1) as f64).sqrt()
    }

    #[inline]
    fn accept(&mut self, Attempt { h, to }: Attempt) {
        let last = &mut self.last;
        std::mem::swap(&mut last.y, &mut self.moment.y);
        std::mem::swap(&mut self.moment.y, &mut self.next);
        last.begin = Some(self.moment.t);
        last.h = h;
        self.moment.t = to;
        self.f.clone_from(&last.k[STAGES - 1]);
        self.work.steps += 1;
        if self.work.steps.is_multiple_of(LOOK) {
            let slopes = [&last.k[STAGES - 1], &last.k[STAGES - 2]];
            let states = [&self.moment.y, &self.stage];
            self.work.stiff += u64::from(is_stiff(h, STABILITY, slopes, states));
        }
    }
}

/// Writes y + h sum a_j k_j over the first stages.
#[inline(always)]
fn combine<S: Storage>(out: &mut [f64], y: &[f64], h: f64, a: &[f64], k: &[S; STAGES]) {
    for (i, (out, y)) in out.iter_mut().zip(y).enumerate() {
        *out = y + h * a.iter().zip(k).map(|(a, k)| a * k.as_ref()[i]).sum::<f64>();
    }
}

impl<F: VectorField, S: Storage> AdaptiveMethod<S> for DormandPrince54<F, S> {
    fn facts(&self) -> FirstOrderFacts {
        FACTS
    }

    fn moment(&self) -> &Moment<S> {
        &self.moment
    }

    fn work(&self) -> &Work {
        &self.work
    }

    fn step(&mut self, end: f64) -> Result<(), AdaptiveError> {
        loop {
            let attempt = self.control.attempt(&self.moment, self.h, end, &self.work)?;
            // The stages of the last step are overwritten: a failure leaves no polynomial.
            self.last.begin = None;
            let h = attempt.h;
            let error = self.attempt(h);
            if error <= 1.0 || self.control.constant.is_some() && error.is_finite() {
                // A last step that was cut short says little of the next one.
                let cut = h < self.h;
                self.accept(attempt);
                let proposed = self.trend.accepted(h, error);
                self.h = self.control.next(if cut { self.h.max(proposed) } else { proposed });
                return Ok(());
            }
            self.work.rejected += 1;
            self.h = self.trend.refused(h, error);
        }
    }

    fn last_begin(&self) -> Option<f64> {
        self.last.begin
    }

    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        let LastStep { begin, h, y: from, k } = &self.last;
        let x = (t - begin.unwrap_or(t)) / h;
        for (i, (y, (from, to))) in
            y.iter_mut().zip(from.as_ref().iter().zip(self.moment.y.as_ref())).enumerate()
        {
            let way = to - from;
            let r3 = h * k[0].as_ref()[i] - way;
            let r4 = way - h * k[STAGES - 1].as_ref()[i] - r3;
            let r5 = h * D.iter().zip(k).map(|(d, k)| d * k.as_ref()[i]).sum::<f64>();
            *y = from + x * (way + (1.0 - x) * (r3 + x * (r4 + (1.0 - x) * r5)));
        }
        Ok(())
    }

    fn restart(&mut self, moment: &Moment<S>) -> Result<(), AdaptiveError> {
        moment.check(self.field.dim())?;
        self.field.evaluate(moment.t, moment.y.as_ref(), self.stage.as_mut());
        self.work.evaluations += 1;
        check_finite("f", moment.t, self.stage.as_ref())?;
        std::mem::swap(&mut self.f, &mut self.stage);
        self.moment.clone_from(moment);
        self.last.begin = None;
        let scratch = [&mut self.error, &mut self.next, &mut self.stage];
        let (field, order) = (&self.field, FACTS.order);
        let guess =
            guess_step(field, &self.scale, &self.moment, (&self.f, |_: &mut _| {}), order, scratch);
        self.work.evaluations += 1;
        self.h = self.control.begin(guess);
        self.trend = StepTrend::new(ESTIMATE);
        Ok(())
    }

    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.moment.t);
        self.moment.y.as_mut().iter_mut().for_each(&mut *visit);
        visit(&mut self.h);
        self.trend.visit(visit);
        self.work.visit(visit);
    }

    fn settle(&mut self) -> Result<(), AdaptiveError> {
        self.moment.check(self.field.dim())?;
        if !(self.h > 0.0 && self.h.is_finite()) {
            return Err(AdaptiveError::Saved("its step is not positive and finite"));
        }
        if !self.trend.is_possible() {
            return Err(AdaptiveError::Saved("no steps leave its errors behind"));
        }
        self.field.evaluate(self.moment.t, self.moment.y.as_ref(), self.f.as_mut());
        self.last.begin = None;
        check_finite("f", self.moment.t, self.f.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_meet_the_conditions_of_their_orders() {
        for (s, row) in A.iter().enumerate() {
            assert!((row.iter().sum::<f64>() - C[s + 1]).abs() < 1e-14, "stage {}", s + 2);
        }
        let weights = A[STAGES - 2];
        for power in 0..5 {
            let sum: f64 = weights.iter().zip(C).map(|(b, c)| b * c.powi(power)).sum();
            assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-15, "power {power}");
        }
        for power in 0..4 {
            let error: f64 = E.iter().zip(C).map(|(e, c)| e * c.powi(power)).sum();
            assert!(error.abs() < 1e-15, "power {power}");
        }
        let fifth: f64 = E.iter().zip(C).map(|(e, c)| e * c.powi(4)).sum();
        assert!(fifth.abs() > 1e-4);
    }
}
