//! Dormand and Prince's explicit Runge-Kutta method of order 8 with errors of order 5 and 3
//! (DOP853).
//!
//! ```text
//! k_s = f(t + c_s h, y + h sum_j a_sj k_j)       s = 1 ... 12
//! y'  = y + h sum_s b_s k_s
//! err = |e5| |e5| / sqrt(|e5|^2 + 0.01 |e3|^2)    two embedded estimates, combined
//! err = 0.1 tol |e3|^2                            where that is larger
//! h*  = h min(6, max(1/3, 0.8 err^(-1/8)))        what this step could have been
//! r   = h* / h*_before                            how that changes
//! h'  = h* (r < 1: r, else (1 + r) / 2)           within the same bounds
//! ```
//! `y` the state (n), `h` the step in seconds, `err` against the tolerance `tol`, of order 8 both. The
//! second rules where `e5` happens to be near zero, as on a long step it now and then is. Twelve
//! evaluations a step; three more, once they are asked for, make the step a polynomial of order 7. Where
//! its last term says that it is rough, the step is taken again by halves, for the polynomial alone.
//! Few memory accesses: each stage is one pass over the state.
//!
//! A relative tolerance looser than 1e-4 is held as 1e-4.
//!
//! For smooth motion and many digits. On stiff systems its step is bounded by stability: it then
//! takes a number of steps that grows with the stiffness and says so in [`Work::stiff`], see
//! `an_explicit_method_pays_for_stiffness_with_steps`. Knows no mass matrix. Source: Hairer,
//! Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.4-II.6;
//! the trend: Gustafsson, ACM Transactions on Mathematical Software 20 (1994) 496-517.

mod coefficients;
mod last_step;
mod stages;

use stationary_calculus::{Storage, array};

use super::error_scale::ErrorScale;
use super::first_step::guess_step;
use super::method::check_finite;
use super::step_control::Attempt;
use super::stiffness::is_stiff;
use super::{
    AdaptiveError, AdaptiveMethod, FirstOrderFacts, Moment, StepControl, VectorField, Work,
};
use crate::integrator::zeros;
use crate::{Damping, Evaluation};
use coefficients::*;
use last_step::LastStep;
use stages::evaluate_stages;

/// What is known of the method.
pub(super) const FACTS: FirstOrderFacts = FirstOrderFacts {
    name: "dormand-prince-853",
    order: 8,
    dense_order: 7,
    stages: 12,
    dense_stages: 3,
    evaluation: Evaluation::Explicit,
    loosest: LOOSEST,
    damping: Damping::Conditional,
    sector: 0.0,
};

/// A looser relative tolerance is held as this one: steps so long say nothing of their own error.
const LOOSEST: f64 = 1e-4;
/// The weight of the estimate by e3 alone: at three times as much it costs 3 % of the evaluations, at a
/// third it lets steps pass whose polynomial is off by 400 tolerances.
const ROUGH: f64 = 0.1;
/// The safety factor of the step control: at the customary 0.9 a quarter of the steps on an
/// eccentric orbit is rejected.
const SAFETY: f64 = 0.8;
/// A step grows at most to this multiple of the last.
const GROWTH: f64 = 6.0;
/// A step shrinks at most to this multiple of the last.
const SHRINKAGE: f64 = 1.0 / 3.0;
/// Where h times the stiffest rate reaches this, the step is bounded by stability.
const STABILITY: f64 = 6.1;
/// One step in so many is looked at for stiffness.
const LOOK: u64 = 16;
/// The stages that have a weight.
const WEIGHTED: [usize; 8] = [1, 6, 7, 8, 9, 10, 11, 12];

/// The Dormand-Prince method of order 8(5,3), bound to a field.
#[derive(Clone, Debug)]
pub struct DormandPrince853<F, C> {
    field: F,
    control: StepControl,
    scale: ErrorScale<C>,
    moment: Moment<C>,
    /// The step proposed for the next attempt.
    h: f64,
    /// One over what the last step could have been, zero where that is not known.
    before: f64,
    work: Work,
    /// f at the moment.
    f: C,
    last: LastStep<C>,
    stage: C,
    next: C,
    errors: [C; 2],
}

impl<F: VectorField, C: Storage> DormandPrince853<F, C> {
    /// The method on a field, starting from a moment.
    ///
    /// # Errors
    /// [`AdaptiveError::MassMatrix`] for a field that has one; [`AdaptiveError::Size`] unless
    /// storage, tolerances and state have the field's size; [`AdaptiveError::NonFinite`] for the
    /// time, the state or f there.
    pub fn new(field: F, control: StepControl, start: Moment<C>) -> Result<Self, AdaptiveError> {
        let n = field.dim();
        if field.mass().is_some() {
            return Err(AdaptiveError::MassMatrix { method: FACTS.name });
        }
        let zero: C = zeros(n)?;
        let mut method = DormandPrince853 {
            scale: ErrorScale::new(&control.tolerance.held(1.0, LOOSEST), n)?,
            field,
            control,
            moment: start.clone(),
            h: 0.0,
            before: 0.0,
            work: Work::default(),
            f: zero.clone(),
            last: LastStep::new(&zero),
            stage: zero.clone(),
            next: zero.clone(),
            errors: [zero.clone(), zero],
        };
        method.restart(&start)?;
        Ok(method)
    }

    /// Evaluates stages 2 to 12 of a step and the next state, and returns the inverse square of the
    /// error, which is at least one where the step may be accepted.
    #[inline]
    fn attempt(&mut self, h: f64) -> f64 {
        let DormandPrince853 { field, moment: Moment { t, y }, last, stage, next, errors, .. } =
            self;
        let (t, y, k) = (*t, y.as_ref(), &mut last.k);
        k[0].clone_from(&self.f);
        evaluate_stages(field, t, y, h, k, stage.as_mut());
        self.work.evaluations += 11;
        let [e5, e3] = errors;
        finish(next.as_mut(), y, h, k, [e5.as_mut(), e3.as_mut()]);
        let (mut fifth, mut third) = (0.0, 0.0);
        let pairs = y.iter().zip(next.as_ref()).zip(self.scale.absolute.as_ref());
        for ((pair, e5), e3) in pairs.zip(e5.as_ref()).zip(e3.as_ref()) {
            let ((y, next), absolute) = pair;
            let s = 1.0 / (absolute + self.scale.relative * y.abs().max(next.abs()));
            // A state that overflowed makes the whole sum a NaN.
            fifth += (e5 * s) * (e5 * s) + 0.0 * next;
            third += (e3 * s) * (e3 * s);
        }
        let both = fifth + 0.01 * third;
        let both = if both > 0.0 { both } else { 1.0 };
        let n = y.len().max(1) as f64;
        let rough = ROUGH * self.scale.relative * (h * h * third) / n;
        // err = max(h fifth / sqrt(both n), rough). The divisions do not wait for each other.
        let (fine, rough) = (both * n / ((h * fifth) * (h * fifth)), 1.0 / (rough * rough));
        // A NaN stays one.
        if rough < fine { rough } else { fine }
    }

    /// Proposes the next step after one of `h`, which could have been longer by a factor.
    #[inline]
    fn propose(&mut self, h: f64, factor: f64, growth: f64) {
        // A last step that was cut short says little of the next one.
        if h < self.h {
            self.h = self.control.next(self.h.max(h * factor));
            return;
        }
        let could_be = h * factor;
        let change = if self.before > 0.0 { could_be * self.before } else { 1.0 };
        // Out of a close encounter the trend is trusted less than into it: what is lost there is a
        // little work, and not a step.
        let trend = if change > 1.0 { 0.5 * (1.0 + change) } else { change };
        self.h = self.control.next((could_be * trend).clamp(h * SHRINKAGE, h * growth));
        // Nothing waits for this division.
        self.before = 1.0 / could_be;
    }

    #[inline]
    fn accept(&mut self, Attempt { h, to }: Attempt) {
        let last = &mut self.last;
        std::mem::swap(&mut last.y, &mut self.moment.y);
        std::mem::swap(&mut self.moment.y, &mut self.next);
        last.begin = Some(self.moment.t);
        last.h = h;
        last.piece = None;
        self.moment.t = to;
        self.field.evaluate(to, self.moment.y.as_ref(), self.f.as_mut());
        last.k[12].clone_from(&self.f);
        self.work.evaluations += 1;
        self.work.steps += 1;
        if self.work.steps.is_multiple_of(LOOK) {
            let slopes = [&last.k[12], &last.k[11]];
            let states = [&self.moment.y, &self.stage];
            self.work.stiff += u64::from(is_stiff(h, STABILITY, slopes, states));
        }
    }
}

/// x^(1/16) to one part in a hundred, which a step may be off: the bits of a number grow as its
/// logarithm, and four square roots would wait for each other.
#[inline(always)]
fn sixteenth_root(x: f64) -> f64 {
    const ONE: u64 = 1.0_f64.to_bits();
    const FRACTION: u64 = (1 << 52) - 1;
    let bits = x.to_bits() / 16 + (ONE - ONE / 16);
    let f = f64::from_bits(bits & FRACTION | ONE) - 1.0;
    // The bits are a straight line from one power of two to the next.
    f64::from_bits(bits) * (1.0 - 0.2288 * f * (1.0 - f))
}

/// Writes the next state and both error slopes, in one pass over the stages.
#[inline(always)]
fn finish<C: Storage>(next: &mut [f64], y: &[f64], h: f64, k: &[C; 13], [e5, e3]: [&mut [f64]; 2]) {
    let n = next.len();
    let (y, e5, e3) = (&y[..n], &mut e5[..n], &mut e3[..n]);
    let k: [&[f64]; 8] = array(|j| &k[WEIGHTED[j] - 1].as_ref()[..n]);
    for i in 0..n {
        let (mut slope, mut fifth) = (B[0] * k[0][i], E5[0] * k[0][i]);
        for j in 1..8 {
            slope += B[j] * k[j][i];
            fifth += E5[j] * k[j][i];
        }
        next[i] = y[i] + h * slope;
        e5[i] = fifth;
        e3[i] = slope - B3[0] * k[0][i] - B3[1] * k[4][i] - B3[2] * k[7][i];
    }
}

impl<F: VectorField, C: Storage> AdaptiveMethod<C> for DormandPrince853<F, C> {
    fn facts(&self) -> FirstOrderFacts {
        FACTS
    }

    fn moment(&self) -> &Moment<C> {
        &self.moment
    }

    fn work(&self) -> &Work {
        &self.work
    }

    #[inline]
    fn step(&mut self, end: f64) -> Result<(), AdaptiveError> {
        let mut growth = GROWTH;
        loop {
            let attempt = self.control.attempt(&self.moment, self.h, end, &self.work)?;
            // The stages of the last step are overwritten: a failure leaves no polynomial.
            self.last.begin = None;
            let h = attempt.h;
            let margin = self.attempt(h);
            // err^(-1/8)
            let root = sixteenth_root(margin);
            let factor = (SAFETY * root).clamp(SHRINKAGE, growth);
            let constant = self.control.constant.is_some() && margin > 0.0;
            if margin >= 1.0 || constant {
                self.accept(attempt);
                self.propose(h, factor, growth);
                return Ok(());
            }
            self.work.rejected += 1;
            growth = 1.0;
            self.h = if margin.is_nan() { SHRINKAGE * h } else { h * factor };
        }
    }

    fn last_begin(&self) -> Option<f64> {
        self.last.begin
    }

    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        let begin = self.last.begin.unwrap_or(t);
        let DormandPrince853 { field, last, stage, moment, work, scale, f, .. } = self;
        let (next, stage) = (moment.y.as_ref(), stage.as_mut());
        // Fixed steps are held to no tolerance.
        let scale = self.control.constant.is_none().then_some(&*scale);
        let x = (t - begin) / last.h;
        work.evaluations += last.complete(field, begin, next, f.as_ref(), x, scale, stage);
        last.at(x, y);
        Ok(())
    }

    fn restart(&mut self, moment: &Moment<C>) -> Result<(), AdaptiveError> {
        moment.check(self.field.dim())?;
        self.field.evaluate(moment.t, moment.y.as_ref(), self.stage.as_mut());
        self.work.evaluations += 1;
        check_finite("f", moment.t, self.stage.as_ref())?;
        std::mem::swap(&mut self.f, &mut self.stage);
        self.moment.clone_from(moment);
        self.last.begin = None;
        let [s, difference] = &mut self.errors;
        let scratch = [s, difference, &mut self.stage];
        let (field, order) = (&self.field, FACTS.order);
        let guess =
            guess_step(field, &self.scale, &self.moment, (&self.f, |_: &mut _| {}), order, scratch);
        self.work.evaluations += 1;
        self.h = self.control.begin(guess);
        self.before = 0.0;
        Ok(())
    }

    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.moment.t);
        self.moment.y.as_mut().iter_mut().for_each(&mut *visit);
        visit(&mut self.h);
        visit(&mut self.before);
        self.work.visit(visit);
    }

    fn settle(&mut self) -> Result<(), AdaptiveError> {
        self.moment.check(self.field.dim())?;
        if !(self.h > 0.0 && self.h.is_finite()) {
            return Err(AdaptiveError::Saved("its step is not positive and finite"));
        }
        if !(self.before >= 0.0 && self.before.is_finite()) {
            return Err(AdaptiveError::Saved("the step that could have been is not positive"));
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
    fn the_root_is_right_to_one_part_in_a_hundred_at_every_size() {
        for i in -4000..4000 {
            let x = 2_f64.powf(0.25 * f64::from(i));
            let exact = x.powf(1.0 / 16.0);
            assert!((sixteenth_root(x) / exact - 1.0).abs() < 1e-2, "{x:e}");
        }
        assert!(sixteenth_root(0.0) < SHRINKAGE && sixteenth_root(f64::INFINITY) > GROWTH);
    }
}
