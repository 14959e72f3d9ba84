//! Backward differentiation formulas of order 1 to 5, the order and the step chosen on the way
//! (BDF).
//!
//! ```text
//! sum_{m=1..k} 1/m D^m y' = h f(t', y')      D y' = y' - y,  D^m its m-th power
//! ```
//! `y` the state (n), primes mark the end of the step, `D^m` backward differences on a grid of
//! equal steps `h` in seconds; when the step changes, the differences are those of the same
//! polynomial on the new grid. One evaluation of f an iteration, one real factorization for as long
//! as the step stays: cheap where f and its Jacobian are costly and few digits are asked for.
//!
//! A step may use a twentieth of the tolerance, because the errors of many steps add up; a relative
//! tolerance looser than 1e-3 is held as 1e-3. A step that is so long that it would let a motion decay
//! which grows, by the sign of the determinant of `M - c J`, is halved: see
//! `an_explosion_from_below_the_tolerance_is_not_stepped_over`.
//!
//! Orders 1 and 2 are L-stable. From order 3 on the formulas are stable in a sector only: motion
//! that oscillates fast makes them fail, see `bdf_of_high_order_blows_up_near_the_imaginary_axis`;
//! ask for at most order 2 there. Constraints of index 1 (rows of M that are zero) are met at the
//! end of each step. Dense matrices only. Source: Hairer and Wanner, Solving Ordinary Differential
//! Equations II (1996), V.1-V.2; Shampine and Reichelt, SIAM J. Sci. Comput. 18 (1997) 1, for the
//! change of grid.

mod history;

use stationary_calculus::Storage;

use super::error_scale::{ErrorScale, norm};
use super::first_step::guess_step;
use super::linearization::{Linearization, check_mass, mass_times, pencil};
use super::lu::Lu;
use super::method::check_finite;
use super::{
    AdaptiveError, AdaptiveMethod, FirstOrderFacts, Moment, StepControl, VectorField, Work,
};
use crate::integrator::zeros;
use crate::{Damping, Evaluation};
use history::{HIGHEST, History, harmonic};

/// Half the opening angles of the sectors of stability, degrees, for orders 1 to 5.
const SECTORS: [f64; HIGHEST] = [90.0, 90.0, 86.03, 73.35, 51.84];
/// Their names, by the highest order.
const NAMES: [&str; HIGHEST] = ["bdf-1", "bdf-2", "bdf-3", "bdf-4", "bdf-5"];

/// The part of the tolerance that a step may use: the errors of many steps add up.
const PART: f64 = 0.05;
/// A looser relative tolerance is held as this one: the past of steps that long is no past.
const LOOSEST: f64 = 1e-3;
/// The safety factor of the step control.
const SAFETY: f64 = 0.9;
/// A step grows at most to this multiple of the last.
const GROWTH: f64 = 10.0;
/// A step shrinks at most to this multiple of the last.
const SHRINKAGE: f64 = 0.2;
/// Most Newton iterations for a step.
const MOST_ITERATIONS: u32 = 4;

/// What is known of the formulas up to an order.
pub(super) fn facts(highest: usize) -> FirstOrderFacts {
    let sector = SECTORS[highest - 1];
    FirstOrderFacts {
        name: NAMES[highest - 1],
        order: highest as u32,
        dense_order: highest as u32,
        stages: 1,
        dense_stages: 0,
        evaluation: Evaluation::Implicit,
        loosest: LOOSEST,
        damping: if sector == 90.0 { Damping::LStable } else { Damping::Conditional },
        sector,
    }
}

/// Backward differentiation formulas, bound to a field.
#[derive(Clone, Debug)]
pub struct BackwardDifferences<F, C> {
    field: F,
    control: StepControl,
    scale: ErrorScale<C>,
    highest: usize,
    tolerance: f64,
    moment: Moment<C>,
    /// The step and the order proposed for the next attempt.
    h: f64,
    order: usize,
    work: Work,
    last_begin: Option<f64>,
    history: History<C>,
    jacobian: Linearization<C>,
    /// The coefficient h / harmonic(k) that the factors belong to; 0 where there are none.
    factored: f64,
    lu: Lu<f64>,
    next: Moment<C>,
    d: C,
    s: C,
    psi: C,
    b: C,
    f: C,
}

impl<F: VectorField, C: Storage> BackwardDifferences<F, C> {
    /// All five orders on a field, starting from a moment.
    ///
    /// # Errors
    /// [`AdaptiveError::Size`] unless storage, tolerances, mass matrix and state have the field's
    /// size; [`AdaptiveError::NonFinite`] for the mass matrix, the time, the state or f there.
    pub fn new(field: F, control: StepControl, start: Moment<C>) -> Result<Self, AdaptiveError> {
        Self::of_order_at_most(HIGHEST, field, control, start)
    }

    /// Orders up to `highest` only: 2 for the L-stable formula with variable steps.
    ///
    /// # Errors
    /// [`AdaptiveError::Order`] unless `highest` is from 1 to 5; those of
    /// [`BackwardDifferences::new`].
    pub fn of_order_at_most(
        highest: usize,
        field: F,
        control: StepControl,
        start: Moment<C>,
    ) -> Result<Self, AdaptiveError> {
        if !(1..=HIGHEST).contains(&highest) {
            return Err(AdaptiveError::Order { got: highest, highest: HIGHEST });
        }
        check_mass(&field)?;
        let n = field.dim();
        let zero: C = zeros(n)?;
        let held = control.tolerance.held(PART, LOOSEST);
        let relative = held.relative;
        let mut method = BackwardDifferences {
            scale: ErrorScale::new(&held, n)?,
            tolerance: (10.0 * f64::EPSILON / relative).max(relative.sqrt().min(0.03)),
            jacobian: Linearization::new(&field)?,
            field,
            control,
            highest,
            moment: start.clone(),
            h: 0.0,
            order: 1,
            work: Work::default(),
            last_begin: None,
            history: History::new(n)?,
            factored: 0.0,
            lu: Lu::new(n),
            next: start.clone(),
            d: zero.clone(),
            s: zero.clone(),
            psi: zero.clone(),
            b: zero.clone(),
            f: zero,
        };
        method.restart(&start)?;
        Ok(method)
    }

    /// Solves for the next state, a Jacobian of the prediction taken where an older one does not
    /// do.
    fn solve(&mut self, h: f64, to: f64) -> Option<u32> {
        let k = self.history.order;
        self.next.t = to;
        self.history.predict(&mut self.next.y, &mut self.psi);
        self.scale.write(self.next.y.as_ref(), self.s.as_mut());
        let c = h / harmonic(k);
        let mut fresh = false;
        loop {
            let factored = self.factored == c || self.factor(c);
            if factored && !self.is_outgrown() {
                if let Some(iterations) = self.iterate(c) {
                    return Some(iterations);
                }
                self.history.predict(&mut self.next.y, &mut self.psi);
            }
            if fresh {
                return None;
            }
            self.jacobian.take(&self.field, &self.scale, (to, &self.next.y), &mut self.work);
            (fresh, self.factored) = (true, 0.0);
        }
    }

    /// Whether a motion grows faster than a step with these factors can follow.
    fn is_outgrown(&self) -> bool {
        self.control.constant.is_none() && self.jacobian.is_outgrown(self.factored, &self.lu)
    }

    fn factor(&mut self, c: f64) -> bool {
        let matrix = self.lu.matrix();
        pencil(&self.field, &self.jacobian.matrix, matrix, |m, j| m - c * j);
        self.work.factorizations += 1;
        let done = self.lu.factor().is_ok();
        self.factored = if done { c } else { 0.0 };
        done
    }

    /// Newton's iteration for d = y' less the prediction.
    fn iterate(&mut self, c: f64) -> Option<u32> {
        let BackwardDifferences { field, next, d, s, psi, b, f, lu, .. } = self;
        d.as_mut().fill(0.0);
        let (mut last_size, mut slowness) = (f64::INFINITY, f64::INFINITY);
        for iteration in 1..=MOST_ITERATIONS {
            self.work.iterations += 1;
            self.work.evaluations += 1;
            field.evaluate(next.t, next.y.as_ref(), f.as_mut());
            let sums = psi.as_ref().iter().zip(d.as_ref());
            let mut moved = b.lend();
            moved.as_mut().iter_mut().zip(sums).for_each(|(b, (psi, d))| *b = psi + d);
            let mut residual = self.history.scratch.lend();
            mass_times(field, moved.as_ref(), residual.as_mut());
            for (residual, f) in residual.as_mut().iter_mut().zip(f.as_ref()) {
                *residual = c * f - *residual;
            }
            lu.solve(residual.as_mut());
            let size = norm(residual.as_ref(), s.as_ref());
            let sums = next.y.as_mut().iter_mut().zip(d.as_mut()).zip(residual.as_ref());
            sums.for_each(|((y, d), change)| {
                *y += change;
                *d += change;
            });
            b.put_back(moved);
            self.history.scratch.put_back(residual);
            let ratio = size / last_size;
            if iteration > 1 {
                slowness = ratio / (1.0 - ratio);
                let left = (MOST_ITERATIONS - iteration) as i32;
                let hopeless = ratio.powi(left) * slowness * size > self.tolerance;
                if ratio >= 1.0 || (left > 0 && hopeless) {
                    return None;
                }
            }
            if !size.is_finite() {
                return None;
            }
            if size == 0.0 || slowness * size < self.tolerance {
                return Some(iteration);
            }
            last_size = size;
        }
        None
    }

    /// The error of an order that differs by `by` from the present one.
    fn error(&self, k: usize, by: &C) -> f64 {
        norm(by.as_ref(), self.s.as_ref()) / (k + 1) as f64
    }

    fn accept(&mut self, h: f64, iterations: u32) {
        self.last_begin = Some(self.moment.t);
        std::mem::swap(&mut self.moment, &mut self.next);
        self.work.steps += 1;
        self.history.accept(&self.d);
        let k = self.history.order;
        self.order = k;
        if self.history.equal_steps <= k as u64 {
            return;
        }
        let most = f64::from(MOST_ITERATIONS);
        let safety = SAFETY * (2.0 * most + 1.0) / (2.0 * most + f64::from(iterations));
        let factor = |k: usize, difference: usize| {
            let error = self.error(k, &self.history.d[difference]);
            let factor = safety * error.powf(-1.0 / (k + 1) as f64);
            // `min` ignores what is not a number: differences that overflowed let no step grow.
            if factor.is_nan() { 0.0 } else { factor.min(GROWTH) }
        };
        if self.control.constant.is_some() {
            self.order = (k + 1).min(self.highest);
            return;
        }
        let mut best = (k, factor(k, k + 1));
        if k > 1 && factor(k - 1, k) > best.1 {
            best = (k - 1, factor(k - 1, k));
        }
        if k < self.highest && factor(k + 1, k + 2) > best.1 {
            best = (k + 1, factor(k + 1, k + 2));
        }
        let grown = self.control.next(h * best.1);
        // A last step that was cut short says little of the next one.
        let cut = h < self.h;
        self.order = best.0;
        self.h = if cut { self.h.max(grown) } else { grown };
    }
}

impl<F: VectorField, C: Storage> AdaptiveMethod<C> for BackwardDifferences<F, C> {
    fn facts(&self) -> FirstOrderFacts {
        facts(self.highest)
    }

    fn moment(&self) -> &Moment<C> {
        &self.moment
    }

    fn work(&self) -> &Work {
        &self.work
    }

    fn step(&mut self, end: f64) -> Result<(), AdaptiveError> {
        loop {
            let attempt = self.control.attempt(&self.moment, self.h, end, &self.work)?;
            let h = attempt.h;
            // The differences move to another grid: what they say of the last step changes.
            self.last_begin = self.last_begin.filter(|_| self.history.keeps(h, self.order));
            self.history.regrid(h, self.order);
            let Some(iterations) = self.solve(h, attempt.to) else {
                self.work.rejected += 1;
                self.h = 0.5 * h;
                continue;
            };
            self.scale.write(self.next.y.as_ref(), self.s.as_mut());
            let k = self.history.order;
            let error = self.error(k, &self.d);
            let constant = self.control.constant.is_some() && error.is_finite();
            if error <= 1.0 || constant {
                self.accept(h, iterations);
                return Ok(());
            }
            self.work.rejected += 1;
            let factor = SAFETY * error.powf(-1.0 / (k + 1) as f64);
            self.h = if error.is_finite() { h * factor.max(SHRINKAGE) } else { SHRINKAGE * h };
        }
    }

    fn last_begin(&self) -> Option<f64> {
        self.last_begin
    }

    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        self.history.interpolate(t - self.moment.t, y);
        Ok(())
    }

    fn restart(&mut self, moment: &Moment<C>) -> Result<(), AdaptiveError> {
        moment.check(self.field.dim())?;
        self.field.evaluate(moment.t, moment.y.as_ref(), self.f.as_mut());
        check_finite("f", moment.t, self.f.as_ref())?;
        self.moment.clone_from(moment);
        self.last_begin = None;
        self.jacobian.take(&self.field, &self.scale, (moment.t, &moment.y), &mut self.work);
        let BackwardDifferences { field, scale, jacobian, s, b, d, f, psi, .. } = self;
        psi.clone_from(f);
        let solve = |f: &mut [f64]| jacobian.solve_for_rate(field, f);
        solve(psi.as_mut());
        let guess = guess_step(field, scale, moment, (psi, solve), 2, [s, b, d]);
        self.work.evaluations += 2;
        (self.h, self.order) = (self.control.begin(guess), 1);
        self.factored = 0.0;
        if self.field.mass().is_some() && self.factor(self.h) {
            // The slope of a first step that is implicit and linear: it lets die out what is fast.
            self.psi.clone_from(&self.f);
            self.lu.solve(self.psi.as_mut());
        }
        self.history.restart(&moment.y, &self.psi, self.h);
        Ok(())
    }

    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.moment.t);
        self.moment.y.as_mut().iter_mut().for_each(&mut *visit);
        visit(&mut self.h);
        let mut order = self.order as f64;
        visit(&mut order);
        self.order = order as usize;
        self.history.visit(visit);
        visit(&mut self.factored);
        visit(&mut self.jacobian.at.t);
        self.jacobian.at.y.as_mut().iter_mut().for_each(&mut *visit);
        self.work.visit(visit);
    }

    fn settle(&mut self) -> Result<(), AdaptiveError> {
        self.moment.check(self.field.dim())?;
        let positive = |h: f64| h > 0.0 && h.is_finite();
        if !(positive(self.h) && positive(self.history.h)) {
            return Err(AdaptiveError::Saved("its step is not positive and finite"));
        }
        let orders = 1..=self.highest;
        if !(orders.contains(&self.order) && orders.contains(&self.history.order)) {
            return Err(AdaptiveError::Saved("its order is not one of the method's"));
        }
        self.last_begin = None;
        let work = self.work;
        self.jacobian.renew(&self.field, &self.scale, &mut self.work);
        if self.factored > 0.0 && !self.factor(self.factored) {
            self.factored = 0.0;
        }
        self.work = work;
        Ok(())
    }
}
