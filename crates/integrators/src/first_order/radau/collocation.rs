//! The equations of a step and their solution by a simplified Newton iteration.
//!
//! ```text
//! w = (T^-1 x I) z,      (GAMMA/h M - J) dw_1 = (T^-1 f)_1 - GAMMA/h M w_1      and likewise
//! ((ALPHA + i BETA)/h M - J) (dw_2 + i dw_3) = ...
//! ```
//! `z` three stages (n each), `w` the same in the coordinates in which they decouple, `J` the
//! Jacobian at one point. The iteration ends where the next change would be below a part of the
//! tolerance, by the rate of its own last two changes: a rate carried over from another step lets a
//! wrong first iterate pass.

use nalgebra::Complex;
use stationary_calculus::{SizeError, Storage};

use super::coefficients::*;
use crate::first_order::error_scale::{ErrorScale, norm, sum_of_squares};
use crate::first_order::linearization::{Linearization, mass_times, pencil};
use crate::first_order::lu::{Lu, Singular};
use crate::first_order::{Moment, VectorField, Work};
use crate::integrator::zeros;

/// Most Newton iterations for a step.
pub(super) const MOST_ITERATIONS: u32 = 7;

/// What of the last step's linear algebra may serve the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reuse {
    /// Nothing: the Jacobian is too old.
    Nothing,
    /// The Jacobian; its factors, too, if the step is the same.
    Jacobian,
    /// The Jacobian, which was taken at this very moment.
    Fresh,
}

/// Most corrections of a state between steps.
const MOST_CORRECTIONS: u64 = 10;
/// A correction is one towards the slow motion if it is at most this part of the one before it.
const CORRECTING: f64 = 0.1;

/// How the iterations ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Iterated {
    /// After so many, small enough.
    Converged(u32),
    /// They would have been too many; a step this much shorter needs fewer.
    TooSlow(f64),
    /// They did not get smaller, or there was no matrix to solve with.
    Diverged,
}

/// The stages of a step and everything that solving for them needs.
#[derive(Clone, Debug)]
pub(super) struct Collocation<C> {
    /// The stages less the state at the start.
    pub(super) z: [C; 3],
    pub(super) reuse: Reuse,
    /// The factor by which the last iterations shrank.
    pub(super) contraction: f64,
    tolerance: f64,
    /// By how many times the estimate an error of stiff parts is counted as more.
    unseen: f64,
    pub(super) jacobian: Linearization<C>,
    /// The step that the factors belong to; 0 where there are none.
    factored: f64,
    real: Lu<f64>,
    complex: Lu<Complex<f64>>,
    w: [C; 3],
    k: [C; 3],
    b: C,
    pair: Vec<Complex<f64>>,
}

impl<C: Storage> Collocation<C> {
    pub(super) fn new<F: VectorField>(
        field: &F,
        relative: f64,
        unseen: f64,
    ) -> Result<Self, SizeError> {
        let n = field.dim();
        let zero: C = zeros(n)?;
        let three = || std::array::from_fn(|_| zero.clone());
        Ok(Collocation {
            z: three(),
            reuse: Reuse::Nothing,
            contraction: 0.0,
            tolerance: (10.0 * f64::EPSILON / relative).max(relative.sqrt().min(0.03)),
            unseen,
            jacobian: Linearization::new(field)?,
            factored: 0.0,
            real: Lu::new(n),
            complex: Lu::new(n),
            w: three(),
            k: three(),
            b: zero.clone(),
            pair: vec![Complex::new(0.0, 0.0); n],
        })
    }

    /// Forgets what was learnt about another motion; with a mass matrix learns what y' is of f.
    pub(super) fn restart<F: VectorField>(
        &mut self,
        field: &F,
        scale: &ErrorScale<C>,
        moment: &Moment<C>,
        work: &mut Work,
    ) {
        (self.reuse, self.factored) = (Reuse::Nothing, 0.0);
        self.contraction = 0.0;
        if field.mass().is_some() {
            self.jacobian.take(field, scale, (moment.t, &moment.y), work);
            self.reuse = Reuse::Fresh;
        }
    }

    fn factor<F: VectorField>(&mut self, field: &F, h: f64) -> Result<(), Singular> {
        let jacobian = &self.jacobian.matrix;
        pencil(field, jacobian, self.real.matrix(), |m, j| GAMMA / h * m - j);
        pencil(field, jacobian, self.complex.matrix(), |m, j| {
            Complex::new(ALPHA / h * m - j, BETA / h * m)
        });
        self.factored = 0.0;
        self.real.factor()?;
        self.complex.factor()?;
        self.factored = h;
        Ok(())
    }

    /// Solves for the stages of a step of `h`, starting from those in `z`.
    pub(super) fn solve<F: VectorField>(
        &mut self,
        field: &F,
        scale: &ErrorScale<C>,
        (moment, s): (&Moment<C>, &C),
        h: f64,
        work: &mut Work,
    ) -> Iterated {
        if self.reuse == Reuse::Nothing {
            self.jacobian.take(field, scale, (moment.t, &moment.y), work);
            (self.reuse, self.factored) = (Reuse::Fresh, 0.0);
        }
        if self.factored != h {
            work.factorizations += 2;
            if self.factor(field, h).is_err() {
                return Iterated::Diverged;
            }
        }
        self.iterate(field, (moment, s), h, work)
    }

    fn iterate<F: VectorField>(
        &mut self,
        field: &F,
        (moment, s): (&Moment<C>, &C),
        h: f64,
        work: &mut Work,
    ) -> Iterated {
        transform(&T_INVERSE, &self.z, &mut self.w);
        let (mut contraction, mut last_ratio, mut last_size) = (1e-3_f64, 1.0_f64, 0.0_f64);
        for iteration in 1..=MOST_ITERATIONS {
            work.iterations += 1;
            work.evaluations += 3;
            let size = self.improve(field, (moment, s), h);
            if !size.is_finite() {
                return Iterated::Diverged;
            }
            let mut converged = false;
            if iteration > 1 {
                let ratio = size / last_size;
                contraction = if iteration == 2 { ratio } else { (ratio * last_ratio).sqrt() };
                last_ratio = ratio;
                if contraction >= 0.99 {
                    return Iterated::Diverged;
                }
                let slowness = contraction / (1.0 - contraction);
                let left = (MOST_ITERATIONS - iteration) as i32;
                let expected = slowness * size * contraction.powi(left - 1) / self.tolerance;
                if left > 0 && expected >= 1.0 {
                    let excess = expected.clamp(1e-4, 20.0);
                    return Iterated::TooSlow(0.8 * excess.powf(-1.0 / f64::from(3 + left)));
                }
                converged = slowness * size <= self.tolerance;
            }
            last_size = size.max(f64::EPSILON);
            self.contraction = contraction;
            if converged || size == 0.0 {
                return Iterated::Converged(iteration);
            }
        }
        Iterated::Diverged
    }

    /// One iteration; the size of the change against the tolerance.
    fn improve<F: VectorField>(&mut self, field: &F, (moment, s): (&Moment<C>, &C), h: f64) -> f64 {
        let Collocation { z, w, k, b, pair, real, complex, .. } = self;
        for ((z, k), c) in z.iter().zip(k.iter_mut()).zip([C1, C2, 1.0]) {
            let sums = b.as_mut().iter_mut().zip(moment.y.as_ref()).zip(z.as_ref());
            sums.for_each(|((b, y), z)| *b = y + z);
            field.evaluate(moment.t + c * h, b.as_ref(), k.as_mut());
        }
        // The stages are written anew at the end: until then they hold the right-hand sides.
        transform(&T_INVERSE, k, z);
        for (w, k) in w.iter().zip(k.iter_mut()) {
            mass_times(field, w.as_ref(), k.as_mut());
        }
        let (gamma, alpha, beta) = (GAMMA / h, ALPHA / h, BETA / h);
        let [r1, r2, r3] = z.each_mut().map(C::as_mut);
        let [m1, m2, m3] = k.each_ref().map(C::as_ref);
        for i in 0..r1.len() {
            r1[i] -= gamma * m1[i];
            pair[i].re = r2[i] - alpha * m2[i] + beta * m3[i];
            pair[i].im = r3[i] - alpha * m3[i] - beta * m2[i];
        }
        real.solve(r1);
        complex.solve(pair);
        for i in 0..r1.len() {
            (r2[i], r3[i]) = (pair[i].re, pair[i].im);
        }
        let sum: f64 = z.iter().map(|dw| sum_of_squares(dw.as_ref(), s.as_ref())).sum();
        for (w, dw) in w.iter_mut().zip(z.iter()) {
            w.as_mut().iter_mut().zip(dw.as_ref()).for_each(|(w, dw)| *w += dw);
        }
        transform(&T, w, z);
        (sum / (3 * pair.len()).max(1) as f64).sqrt()
    }

    /// Whether a motion grows faster than the step that was solved last can follow.
    pub(super) fn is_outgrown(&self) -> bool {
        self.jacobian.is_outgrown(self.factored / GAMMA, &self.real)
    }

    /// Writes (GAMMA/h M - J)^-1 (f + M E z/h), the error of a step.
    pub(super) fn error<F: VectorField>(&mut self, field: &F, f: &C, h: f64, error: &mut C) {
        let [z1, z2, z3] = self.z.each_ref().map(C::as_ref);
        for (i, b) in self.b.as_mut().iter_mut().enumerate() {
            *b = (E[0] * z1[i] + E[1] * z2[i] + E[2] * z3[i]) / h;
        }
        mass_times(field, self.b.as_ref(), error.as_mut());
        error.as_mut().iter_mut().zip(f.as_ref()).for_each(|(error, f)| *error += f);
        self.real.solve(error.as_mut());
    }

    /// Adds to an error what the estimate does not see of stiff parts, and returns its norm:
    ///
    /// ```text
    /// error += unseen (I - GAMMA/h A^-1 M) error,      A = GAMMA/h M - J
    /// ```
    pub(super) fn whole_error<F: VectorField>(
        &mut self,
        field: &F,
        h: f64,
        (error, s): (&mut C, &C),
    ) -> f64 {
        if self.unseen == 0.0 {
            return norm(error.as_ref(), s.as_ref());
        }
        mass_times(field, error.as_ref(), self.b.as_mut());
        self.real.solve(self.b.as_mut());
        for (error, slow) in error.as_mut().iter_mut().zip(self.b.as_ref()) {
            *error += self.unseen * (*error - GAMMA / h * slow);
        }
        norm(error.as_ref(), s.as_ref())
    }

    /// Adds to `y`, what the polynomial says at `t`, the correction
    ///
    /// ```text
    /// (I - GAMMA/h A^-1 M) A^-1 (f(t, y) - M y'),      A = GAMMA/h M - J
    /// ```
    /// with the slope y' of the polynomial, and returns how often f was evaluated. In stiff components
    /// it is a Newton step towards the slow motion, which the polynomial follows to order 3 only while
    /// the ends of the steps lie on it; in the others the factor in front is of the order of h J. It is
    /// repeated while it is more than a part of the tolerated error `s` and shrinks as a Newton step does:
    /// rows of M that are zero have no error that would bound the step.
    pub(super) fn correct<F: VectorField>(
        &mut self,
        field: &F,
        (t, h): (f64, f64),
        (y, s): (&mut [f64], &C),
        (slope, defect): (&mut C, &mut C),
    ) -> u64 {
        if self.factored != h {
            return 0;
        }
        mass_times(field, slope.as_ref(), self.b.as_mut());
        let mut last = f64::INFINITY;
        for evaluations in 1..=MOST_CORRECTIONS {
            field.evaluate(t, y, defect.as_mut());
            let terms = defect.as_mut().iter_mut().zip(self.b.as_ref());
            terms.for_each(|(defect, b)| *defect -= b);
            self.real.solve(defect.as_mut());
            mass_times(field, defect.as_ref(), slope.as_mut());
            self.real.solve(slope.as_mut());
            let terms = defect.as_mut().iter_mut().zip(slope.as_ref());
            terms.for_each(|(defect, slope)| *defect -= GAMMA / h * slope);
            let size = norm(defect.as_ref(), s.as_ref());
            if !(size.is_finite() && size <= CORRECTING * last) {
                return evaluations;
            }
            y.iter_mut().zip(defect.as_ref()).for_each(|(y, d)| *y += d);
            if size <= self.tolerance {
                return evaluations;
            }
            last = size;
        }
        MOST_CORRECTIONS
    }

    pub(super) fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let mut reuse = match self.reuse {
            Reuse::Nothing => 0.0,
            Reuse::Jacobian => 1.0,
            Reuse::Fresh => 2.0,
        };
        visit(&mut reuse);
        self.reuse = match reuse {
            0.0 => Reuse::Nothing,
            1.0 => Reuse::Jacobian,
            _ => Reuse::Fresh,
        };
        visit(&mut self.contraction);
        visit(&mut self.factored);
        visit(&mut self.jacobian.at.t);
        self.jacobian.at.y.as_mut().iter_mut().for_each(visit);
    }

    /// Takes the Jacobian and its factors anew where they were.
    pub(super) fn settle<F: VectorField>(&mut self, field: &F, scale: &ErrorScale<C>) {
        self.jacobian.renew(field, scale, &mut Work::default());
        let h = self.factored;
        if !(h > 0.0 && h.is_finite() && self.factor(field, h).is_ok()) {
            self.factored = 0.0;
        }
    }
}

/// Writes the combinations of three vectors that the rows of a matrix name.
fn transform<C: Storage>(rows: &[[f64; 3]; 3], from: &[C; 3], to: &mut [C; 3]) {
    let [a, b, c] = from.each_ref().map(C::as_ref);
    for (to, row) in to.iter_mut().zip(rows) {
        for (i, to) in to.as_mut().iter_mut().enumerate() {
            *to = row[0] * a[i] + row[1] * b[i] + row[2] * c[i];
        }
    }
}
