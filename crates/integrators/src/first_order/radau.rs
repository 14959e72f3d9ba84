//! Radau IIA of order 5: collocation at three points, the last of which is the end of the step.
//!
//! ```text
//! M z_i = h sum_j a_ij f(t + c_j h, y + z_j)      i = 1, 2, 3
//! y'    = y + z_3
//! ```
//! `y` the state (n), `z_i` the stages less y, `M` the mass matrix (n x n, the identity unless the
//! field says otherwise; it may be singular), `h` the step in seconds. The 3n equations are solved
//! by Newton's method with the Jacobian of one point, in coordinates that split them into a real
//! and a complex system of size n. A Jacobian serves as long as the iterations contract well, its
//! factors as long as the step stays.
//!
//! A step is accepted after two iterates at least: the first says nothing of the rate at which they
//! converge. The estimate of a step's error is of order 3 and is held to `0.1 tol^(2/3)`, a
//! relative tolerance looser than 1e-4 as if it were 1e-4, and to 20 tol where that is less: a stiff
//! part that is driven is off by three times what the estimate says, and so much is held to 20 tol. Between
//! steps the polynomial is corrected, by solves with the factors of the step, where a part is stiff or
//! algebraic.
//!
//! A step that is so long that it would let a motion decay which grows, by the sign of the determinant
//! of `GAMMA/h M - J`, is halved: see `an_explosion_from_below_the_tolerance_is_not_stepped_over`.
//!
//! L-stable: fast decay dies out within a step. Keeps order 5 on smooth solutions, but loses some
//! where a fast part is driven: see `radau_loses_order_on_a_stiff_part_that_is_driven`. Constraints
//! of index 1 (rows of M that are zero) are met at the end of each step. Dense matrices only.
//! Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.8.

mod coefficients;
mod collocation;

use stationary_calculus::Storage;

use super::error_scale::{ErrorScale, larger};
use super::first_step::guess_step;
use super::linearization::check_mass;
use super::method::check_finite;
use super::{
    AdaptiveError, AdaptiveMethod, FirstOrderFacts, Moment, StepControl, Tolerance, VectorField,
    Work,
};
use crate::integrator::zeros;
use crate::{Damping, Evaluation};
use coefficients::*;
use collocation::{Collocation, Iterated, MOST_ITERATIONS, Reuse};

/// What is known of the method.
pub(super) const FACTS: FirstOrderFacts = FirstOrderFacts {
    name: "radau-iia-5",
    order: 5,
    dense_order: 3,
    stages: 3,
    dense_stages: 1,
    evaluation: Evaluation::Implicit,
    loosest: LOOSEST,
    damping: Damping::LStable,
    sector: 90.0,
};

/// A looser relative tolerance is held as this one: steps so long say nothing of their own error.
const LOOSEST: f64 = 1e-4;
/// The safety factor of the step control.
const SAFETY: f64 = 0.9;
/// A step grows at most to this multiple of the last.
const GROWTH: f64 = 8.0;
/// A step shrinks at most to this multiple of the last.
const SHRINKAGE: f64 = 0.2;
/// A step that would grow by less than this keeps its length, and with it the factors.
const NOT_WORTH_GROWING: f64 = 1.2;
/// The Newton iterations of a Jacobian that is good enough contract by less than this.
const CONTRACTION: f64 = 1e-3;

/// The Radau IIA method of order 5, bound to a field.
#[derive(Clone, Debug)]
pub struct RadauIia5<F, C> {
    field: F,
    control: StepControl,
    scale: ErrorScale<C>,
    moment: Moment<C>,
    h: f64,
    work: Work,
    /// f at the moment.
    f: C,
    /// The tolerated error at the moment.
    s: C,
    collocation: Collocation<C>,
    last: Last<C>,
    error: C,
    moved: C,
}

/// The last step: its polynomial, and what the control of the next one remembers of it.
#[derive(Clone, Debug)]
struct Last<C> {
    /// Its beginning, unless nobody knows the polynomial.
    begin: Option<f64>,
    /// Its length; 0 where there was none.
    h: f64,
    error: f64,
    /// Divided differences of the collocation polynomial.
    polynomial: [C; 3],
}

/// The estimate of order 3 is held to more than the error of order 5 may be, but to no more than so
/// many tolerances.
const MOST_TOLERANCES: f64 = 20.0;

/// The error of a stiff part that is driven over the estimate: of a driver `t^4/24` it is
/// `(1 - C1) (1 - C2) = 3/10` of `h^3/24` over the stiffness, and the estimate's weights see `sum E c^4 = -1/10`.
const DRIVEN: f64 = 3.0;

/// No error is taken for less: the control divides by it.
const SMALLEST_ERROR: f64 = 1e-10;

/// The part of an error that counts where it is measured at the step's end: all of it would shorten
/// every step that ends near a zero.
const AT_END: f64 = 0.2;

/// What the estimate of a step's error is held to.
fn stricter(tolerance: &Tolerance) -> Tolerance {
    let tolerance = tolerance.held(1.0, LOOSEST);
    tolerance.scaled((0.1 * tolerance.relative.powf(-1.0 / 3.0)).min(MOST_TOLERANCES))
}

/// By how many times the estimate the error of a stiff part that is driven counts as more, so that all of it
/// is at most [`MOST_TOLERANCES`].
fn unseen(tolerance: &Tolerance) -> f64 {
    let held = tolerance.held(MOST_TOLERANCES, LOOSEST);
    (DRIVEN * stricter(tolerance).relative / held.relative - 1.0).max(0.0)
}

impl<F: VectorField, C: Storage> RadauIia5<F, C> {
    /// The method on a field, starting from a moment.
    ///
    /// # Errors
    /// [`AdaptiveError::Size`] unless storage, tolerances, mass matrix and state have the field's
    /// size; [`AdaptiveError::NonFinite`] for the mass matrix, the time, the state or f there.
    pub fn new(field: F, control: StepControl, start: Moment<C>) -> Result<Self, AdaptiveError> {
        let n = field.dim();
        check_mass(&field)?;
        let zero: C = zeros(n)?;
        let tolerance = stricter(&control.tolerance);
        let mut method = RadauIia5 {
            scale: ErrorScale::new(&tolerance, n)?,
            collocation: Collocation::new(&field, tolerance.relative, unseen(&control.tolerance))?,
            field,
            control,
            moment: start.clone(),
            h: 0.0,
            work: Work::default(),
            f: zero.clone(),
            s: zero.clone(),
            last: Last {
                begin: None,
                h: 0.0,
                error: 0.0,
                polynomial: std::array::from_fn(|_| zero.clone()),
            },
            error: zero.clone(),
            moved: zero,
        };
        method.restart(&start)?;
        Ok(method)
    }

    /// The collocation polynomial `x` steps after the end of the last step, less the state there.
    fn polynomial(&self, x: f64, i: usize) -> f64 {
        let [a, b, c] = self.last.polynomial.each_ref().map(|d| d.as_ref()[i]);
        x * (a + (x - C2 + 1.0) * (b + (x - C1 + 1.0) * c))
    }

    /// The slope of the polynomial there, per step.
    fn slope(&self, x: f64, i: usize) -> f64 {
        let [a, b, c] = self.last.polynomial.each_ref().map(|d| d.as_ref()[i]);
        let inner = b + (x - C1 + 1.0) * c;
        a + (x - C2 + 1.0) * inner + x * (inner + (x - C2 + 1.0) * c)
    }

    /// Corrects the polynomial's value `y` at `t` in the components that are stiff.
    fn correct(&mut self, x: f64, t: f64, y: &mut [f64]) {
        let mut slope = self.moved.lend();
        for (i, slope) in slope.as_mut().iter_mut().enumerate() {
            *slope = self.slope(x, i) / self.last.h;
        }
        let RadauIia5 { field, collocation, s, error, last, work, .. } = self;
        let room = (&mut slope, error);
        work.evaluations += collocation.correct(field, (t, last.h), (y, s), room);
        self.moved.put_back(slope);
    }

    /// Starts the iterations from the last step's polynomial, carried on.
    fn extrapolate(&mut self, h: f64) {
        let mut z = self.collocation.z.each_mut().map(C::lend);
        for (z, c) in z.iter_mut().zip([C1, C2, 1.0]) {
            if self.last.h == 0.0 {
                z.as_mut().fill(0.0);
                continue;
            }
            let x = c * h / self.last.h;
            for (i, z) in z.as_mut().iter_mut().enumerate() {
                *z = self.polynomial(x, i);
            }
        }
        for (place, z) in self.collocation.z.iter_mut().zip(z) {
            *place = z;
        }
    }

    /// The error of a step whose equations are solved, against the tolerance. `again` filters it
    /// once more, for steps that begin in a fast transient. NaN where f at the state that the filter
    /// looks at is none: such a step is not known to be good.
    fn error(&mut self, h: f64, again: Again) -> f64 {
        let RadauIia5 { field, moment, collocation, f, s, error, moved, .. } = self;
        collocation.error(field, f, h, error);
        let parts = moved.as_mut().iter_mut().zip(moment.y.as_ref()).zip(error.as_ref());
        parts.for_each(|((moved, y), e)| *moved = y + e);
        let first = collocation.whole_error(field, h, (error, s));
        let first = larger(first, self.error_at_end());
        if first < 1.0 || !first.is_finite() || again == Again::No {
            return larger(first, SMALLEST_ERROR);
        }
        let RadauIia5 { field, moment, collocation, s, error, moved, .. } = self;
        field.evaluate(moment.t, moved.as_ref(), error.as_mut());
        self.work.evaluations += 1;
        moved.clone_from(error);
        collocation.error(field, moved, h, error);
        let second = collocation.whole_error(field, h, (error, s));
        larger(larger(second, self.error_at_end()), SMALLEST_ERROR)
    }

    /// The same error against what is tolerated at the step's end, in parts of what it may be there: a
    /// stiff part that is driven through zero brings to its end what was tolerable at the start.
    fn error_at_end(&self) -> f64 {
        let (y, z) = (self.moment.y.as_ref(), self.collocation.z[2].as_ref());
        let states = y.iter().zip(z).map(|(y, z)| y + z).zip(self.scale.absolute.as_ref());
        let scales = states.map(|(end, absolute)| absolute + self.scale.relative * end.abs());
        let squares = self.error.as_ref().iter().zip(scales).map(|(e, s)| (e / s) * (e / s));
        AT_END * (squares.sum::<f64>() / y.len().max(1) as f64).sqrt()
    }

    /// By how much the error lets the step change, more cautiously after many iterations.
    fn factor(error: f64, iterations: u32) -> f64 {
        let most = f64::from(MOST_ITERATIONS);
        let caution = SAFETY * (1.0 + 2.0 * most) / (f64::from(iterations) + 2.0 * most);
        (caution.min(SAFETY) / error.sqrt().sqrt()).clamp(SHRINKAGE, GROWTH)
    }

    fn accept(&mut self, (h, to): (f64, f64), (error, iterations): (f64, u32), most: f64) {
        let mut factor = Self::factor(error, iterations).min(most);
        if self.last.h > 0.0 && self.last.error > 0.0 {
            // What the last two errors foretell of the next (Gustafsson).
            let ratio = (self.last.error / (error * error)).sqrt().sqrt();
            let foretold = SAFETY * h / self.last.h * ratio;
            factor = factor.min(foretold.clamp(SHRINKAGE, GROWTH));
        }
        self.last.error = error.max(1e-2);
        let [a, b, c] = &mut self.last.polynomial;
        let [z1, z2, z3] = self.collocation.z.each_ref().map(C::as_ref);
        let y = self.moment.y.as_mut();
        for i in 0..y.len() {
            let (first, second) = (z1[i] / C1, (z2[i] - z1[i]) / (C2 - C1));
            let third = (z3[i] - z2[i]) / (1.0 - C2);
            let left = (second - first) / C2;
            a.as_mut()[i] = third;
            b.as_mut()[i] = (third - second) / (1.0 - C1);
            c.as_mut()[i] = b.as_ref()[i] - left;
            y[i] += z3[i];
        }
        self.last.begin = Some(self.moment.t);
        self.last.h = h;
        self.moment.t = to;
        self.work.steps += 1;
        self.arrive();
        let grown = self.control.next(h * factor);
        let keep = h == self.h && (1.0..=NOT_WORTH_GROWING).contains(&(grown / h));
        let reuse = if self.collocation.contraction > CONTRACTION {
            Reuse::Nothing
        } else {
            Reuse::Jacobian
        };
        self.collocation.reuse = reuse;
        if h < self.h {
            // A last step that was cut short says little of the next one.
            self.h = self.h.max(grown);
        } else if !(keep && reuse == Reuse::Jacobian) {
            self.h = grown;
        }
    }

    /// f and the tolerated error at the moment.
    fn arrive(&mut self) {
        let Moment { t, y } = &self.moment;
        self.field.evaluate(*t, y.as_ref(), self.f.as_mut());
        self.scale.write(y.as_ref(), self.s.as_mut());
        self.work.evaluations += 1;
    }

    /// Tries again with a step of `h`, and a Jacobian of this very moment.
    fn reject(&mut self, h: f64) {
        self.work.rejected += 1;
        self.h = h;
        if self.collocation.reuse == Reuse::Jacobian {
            self.collocation.reuse = Reuse::Nothing;
        }
    }
}

/// Whether an error that is too large is filtered a second time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Again {
    Yes,
    No,
}

impl<F: VectorField, C: Storage> AdaptiveMethod<C> for RadauIia5<F, C> {
    fn facts(&self) -> FirstOrderFacts {
        FACTS
    }

    fn moment(&self) -> &Moment<C> {
        &self.moment
    }

    fn work(&self) -> &Work {
        &self.work
    }

    fn step(&mut self, end: f64) -> Result<(), AdaptiveError> {
        let (mut again, mut most) = (Again::No, GROWTH);
        let constant = self.control.constant.is_some();
        // A step that is taken whatever its error has none to filter.
        let filtered = if constant { Again::No } else { Again::Yes };
        if self.last.h == 0.0 {
            again = filtered;
        }
        loop {
            let attempt = self.control.attempt(&self.moment, self.h, end, &self.work)?;
            let h = attempt.h;
            self.extrapolate(h);
            let RadauIia5 { field, scale, moment, s, work, .. } = self;
            match self.collocation.solve(field, scale, (moment, s), h, work) {
                Iterated::Converged(_) if !constant && self.collocation.is_outgrown() => {
                    self.reject(0.5 * h);
                }
                Iterated::Converged(iterations) => {
                    let error = self.error(h, again);
                    let constant = constant && error.is_finite();
                    if error < 1.0 || constant {
                        self.accept((h, attempt.to), (error, iterations), most);
                        return Ok(());
                    }
                    let first = self.last.h == 0.0 && most == GROWTH;
                    let factor = Self::factor(error, iterations);
                    self.reject(if first || !error.is_finite() { 0.1 * h } else { h * factor });
                }
                Iterated::TooSlow(factor) => self.reject(factor * h),
                Iterated::Diverged => self.reject(0.5 * h),
            }
            (again, most) = (filtered, 1.0);
        }
    }

    fn last_begin(&self) -> Option<f64> {
        self.last.begin
    }

    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        y.copy_from_slice(self.moment.y.as_ref());
        let x = (t - self.moment.t) / self.last.h;
        for (i, y) in y.iter_mut().enumerate() {
            *y += self.polynomial(x, i);
        }
        if self.last.begin != Some(t) {
            self.correct(x, t, y);
        }
        Ok(())
    }

    fn restart(&mut self, moment: &Moment<C>) -> Result<(), AdaptiveError> {
        moment.check(self.field.dim())?;
        self.field.evaluate(moment.t, moment.y.as_ref(), self.error.as_mut());
        check_finite("f", moment.t, self.error.as_ref())?;
        self.moment.clone_from(moment);
        self.arrive();
        self.last.begin = None;
        (self.last.h, self.last.error) = (0.0, 0.0);
        let RadauIia5 { field, scale, f, collocation, error, moved, work, .. } = self;
        collocation.restart(field, scale, moment, work);
        let Collocation { z: [scratch, difference, _], jacobian, .. } = collocation;
        error.clone_from(f);
        let solve = |f: &mut [f64]| jacobian.solve_for_rate(field, f);
        solve(error.as_mut());
        let scratch = [scratch, difference, moved];
        let guess = guess_step(field, scale, moment, (error, solve), 4, scratch);
        self.work.evaluations += 2;
        self.h = self.control.begin(guess);
        Ok(())
    }

    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.moment.t);
        self.moment.y.as_mut().iter_mut().for_each(&mut *visit);
        visit(&mut self.h);
        visit(&mut self.last.h);
        visit(&mut self.last.error);
        for d in &mut self.last.polynomial {
            d.as_mut().iter_mut().for_each(&mut *visit);
        }
        self.collocation.visit(visit);
        self.work.visit(visit);
    }

    fn settle(&mut self) -> Result<(), AdaptiveError> {
        self.moment.check(self.field.dim())?;
        let positive = self.h > 0.0 && self.h.is_finite() && self.last.h >= 0.0;
        if !positive {
            return Err(AdaptiveError::Saved("its step is not positive and finite"));
        }
        self.last.begin = None;
        let work = self.work;
        self.arrive();
        self.collocation.settle(&self.field, &self.scale);
        self.work = work;
        check_finite("f", self.moment.t, self.f.as_ref())
    }
}
