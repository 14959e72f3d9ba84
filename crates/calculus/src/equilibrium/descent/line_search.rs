//! How far down: along a step until the energy has fallen enough, or for as long as it falls.
//!
//! ```text
//! V(q + t p) <= V(q) + c t <f, p>                    Armijo's condition, c = 1e-4
//! ```
//! `t` 1, 1/2, 1/4, ... for a step of Newton's. Where p has no length of its own, what of it is soft is
//! followed by 4, 16, 64, ... times its length for as long as the energy falls. Where energies differ by
//! rounding only, the residual decides. Along a narrow bent valley a few whole steps may raise the
//! energy, if it is lower after them. Source: Nocedal and Wright, Numerical Optimization, chapter 3.1;
//! the watchdog of Chamberlain, Powell, Lemarechal and Pedersen (1982).

use super::direction::Step;
use super::{Descent, largest, norm};
use crate::equilibrium::terms::dot;
use crate::{Covector, NewtonFailure, NewtonReport, Rung};

/// Armijo's constant: the part of the predicted fall that a step must reach.
const SUFFICIENT: f64 = 1e-4;
/// Step lengths tried, down to 2^-60: from far away into a narrow domain.
const LENGTHS: usize = 61;
/// Energies that differ by this much, relatively, cannot be told apart.
const SAME_ENERGY: f64 = 16.0 * f64::EPSILON;
/// A step that promises no more than this of the energy is judged by the residual.
const UNTOLD: f64 = 1e-11;
/// From one length to the next while the energy falls.
const GROWTH: f64 = 4.0;
/// From one length to the next while the energy rises, where a step has no length of its own.
const SHORTER: f64 = 8.0;
/// Halvings between a good length and one that is too long.
const HALVINGS: u32 = 40;
/// A force along the step of this part of the first ends them.
const FLAT: f64 = 0.1;
/// An energy that still falls so many times as far away as the search began has no end.
const ENDLESS: f64 = 1e15;
/// Newton steps that may follow one that raises the energy, until it is lower than before.
const RELAXED: u32 = 3;

/// Where a line search ended.
pub(super) struct Found {
    pub(super) size: f64,
    pub(super) energy: f64,
}

impl Descent<'_> {
    /// Writes q + t p, and its differential; the size of that and the energy, or `None` where one is not
    /// finite.
    pub(super) fn attempt(
        &mut self,
        q: &[f64],
        t: f64,
        report: &mut NewtonReport,
    ) -> Option<Found> {
        let ends = self.trial.iter_mut().zip(q).zip(&self.step);
        ends.for_each(|((trial, q), p)| *trial = q + t * p);
        report.energies += 1;
        let energy = self.asked.energy(&self.trial);
        if !energy.is_finite() {
            return None;
        }
        report.residuals += 1;
        self.trial_force.fill(0.0);
        self.asked.add_differential(&self.trial, Covector(&mut self.trial_force[..]));
        let size = norm(self.asked, &self.trial_force, &mut self.scratch);
        size.is_finite().then_some(Found { size, energy })
    }

    /// Whole Newton steps, of which the first may raise the energy if the last ends below: along a
    /// narrow bent valley each step leaves it and the next one returns. Leaves the end in `trial`, as a
    /// line search does; without success all is as it was.
    ///
    /// Source: the watchdog of Chamberlain, Powell, Lemarechal and Pedersen (1982).
    pub(super) fn relax(
        &mut self,
        q: &[f64],
        (size, start): (f64, f64),
        report: &mut NewtonReport,
        history: &mut Vec<f64>,
    ) -> Option<Found> {
        let slope = dot(&self.force, &self.step);
        let mut found = self.attempt(q, 1.0, report)?;
        if is_enough(&found, (size, start), slope, 1.0) {
            return Some(found);
        }
        let (before, steps) = (history.len(), report.iterations);
        self.kept[0].copy_from_slice(&self.force);
        self.kept[1].copy_from_slice(&self.step);
        for _ in 0..RELAXED {
            std::mem::swap(&mut self.force, &mut self.trial_force);
            let here = self.trial.clone();
            if self.factor(&here) != Ok(Rung::Cholesky) {
                break;
            }
            self.solve();
            report.iterations += 1;
            history.push(found.size);
            match self.attempt(&here, 1.0, report) {
                Some(next) if next.energy <= start + SUFFICIENT * slope => return Some(next),
                Some(next) => found = next,
                None => break,
            }
        }
        history.truncate(before);
        report.iterations = steps;
        self.force.copy_from_slice(&self.kept[0]);
        self.step.copy_from_slice(&self.kept[1]);
        None
    }

    /// Leaves an acceptable next iterate in `trial` and its differential in `trial_force`.
    pub(super) fn search(
        &mut self,
        q: &[f64],
        (size, start): (f64, f64),
        kind: Step,
        report: &mut NewtonReport,
    ) -> Result<Option<Found>, NewtonFailure> {
        let slope = dot(&self.force, &self.step);
        if kind == Step::Open {
            return self.search_open(q, (size, start), slope, report);
        }
        let rises = kind == Step::ToAnyRest && slope >= 0.0;
        // The whole of Newton's step was tried before.
        let mut t = if kind == Step::Newton { 0.5 } else { 1.0 };
        for _ in 0..LENGTHS {
            if let Some(found) = self.attempt(q, t, report) {
                let less = found.size <= (1.0 - SUFFICIENT * t) * size;
                if if rises { less } else { is_enough(&found, (size, start), slope, t) } {
                    return Ok(Some(found));
                }
            }
            t *= 0.5;
        }
        Ok(None)
    }

    /// The same for a step without a length of its own: the lowest place along it, as far as it takes.
    fn search_open(
        &mut self,
        q: &[f64],
        (size, start): (f64, f64),
        slope: f64,
        report: &mut NewtonReport,
    ) -> Result<Option<Found>, NewtonFailure> {
        let mut t = 1.0;
        for _ in 0..LENGTHS {
            if let Some(found) = self.attempt(q, t, report)
                && is_enough(&found, (size, start), slope, t)
            {
                return if found.energy >= start {
                    Ok(Some(found))
                } else if t == 1.0 {
                    self.go_on(start, found, report).map(Some)
                } else {
                    Ok(Some(self.between(q, (t, SHORTER * t), found, report)))
                };
            }
            t /= SHORTER;
        }
        Ok(None)
    }

    /// From the place on trial on along what is soft, for as long as the energy falls.
    fn go_on(
        &mut self,
        start: f64,
        first: Found,
        report: &mut NewtonReport,
    ) -> Result<Found, NewtonFailure> {
        let base = self.trial.clone();
        std::mem::swap(&mut self.step, &mut self.soft);
        if self.far == 0.0 {
            self.far = largest(&base);
        }
        let slope = dot(&self.trial_force, &self.step);
        let (mut t, mut longer, mut best) = (0.0, 1.0, first);
        while slope < 0.0
            && let Some(found) = self.attempt(&base, longer, report)
            && found.energy < best.energy
        {
            if largest(&self.trial) > ENDLESS * self.far && found.energy < start {
                return Err(NewtonFailure::Unbounded);
            }
            (t, best) = (longer, found);
            longer *= GROWTH;
        }
        match self.attempt(&base, t, report) {
            Some(_) if slope < 0.0 && t > 0.0 => Ok(self.between(&base, (t, longer), best, report)),
            found => Ok(found.unwrap_or(best)),
        }
    }

    /// The lowest place between a length that is good and one that is too long, by halving where the
    /// force along the step changes its sign. Begins, and ends, with the good one on trial.
    fn between(
        &mut self,
        base: &[f64],
        (mut low, mut high): (f64, f64),
        mut best: Found,
        report: &mut NewtonReport,
    ) -> Found {
        let first = dot(&self.trial_force, &self.step);
        let mut at = low;
        if first >= 0.0 {
            return best;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.attempt(base, middle, report) {
                Some(found) if found.energy <= best.energy => {
                    let slope = dot(&self.trial_force, &self.step);
                    (at, best) = (middle, found);
                    if slope.abs() <= FLAT * first.abs() {
                        return best;
                    }
                    if slope < 0.0 { low = middle } else { high = middle }
                }
                _ => high = middle,
            }
        }
        self.attempt(base, at, report).unwrap_or(best)
    }
}

/// Whether a step of length t leads far enough down.
fn is_enough(found: &Found, (size, start): (f64, f64), slope: f64, t: f64) -> bool {
    let less = found.size <= (1.0 - SUFFICIENT * t) * size;
    let largest = start.abs().max(found.energy.abs());
    let same = found.energy <= start + SAME_ENERGY * largest;
    let untold = slope.abs() <= UNTOLD * largest;
    let falls = found.energy <= start + SUFFICIENT * t * slope;
    (falls && !untold) || (less && (same || untold))
}
