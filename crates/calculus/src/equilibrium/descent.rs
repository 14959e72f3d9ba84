//! The way down, step by step until no force is left, and what kind of place that is.
//!
//! ```text
//! q <- q + t p      until |M^-1 f| <= tolerance, or f is what rounding makes of its terms
//! ```
//! `f` the differential, `p` the step (`direction`: which way), `t` its length (`line_search`: how far).
//! Source: Nocedal and Wright, Numerical Optimization, chapters 3 and 7.

mod direction;
mod line_search;

use super::curvature::{Lowest, lowest};
use super::terms::{magnitudes, scale};
use super::{EquilibriumReport, Stationary};
use crate::equation::SQUARES;
use crate::{
    Covector, HessianSolver, Metric, Newton, NewtonEnd, NewtonFailure, NewtonReport, Potential,
    Rung, SizeError, Unsolvable, Vector, first_non_finite,
};
use direction::Step;

/// A residual of so many roundings of its terms is rounding.
const ROUNDINGS: f64 = 64.0;
/// Steps below this part of q are so small that the residual may be rounding.
const NEARLY: f64 = 1e-6;
/// Below this part of the first residual the way along a ridge has come to its end.
const SETTLED: f64 = 1e-2;
/// What is left of the guess's size where q itself is close to zero.
const FORGOTTEN: f64 = 1e-8;
/// A residual that has not halved over so many steps stands still.
const STANDSTILL: usize = 4;
/// A search of more steps than this may have come to where higher derivatives decide.
const DOZEN: u32 = 12;

/// A search and its memory.
#[derive(Clone, Debug)]
pub(super) struct Descent<'a, M, P, L> {
    metric: &'a M,
    potential: &'a P,
    solver: L,
    newton: Newton,
    /// The differential at the iterate.
    force: Vec<f64>,
    /// The direction p.
    step: Vec<f64>,
    /// What is left of p in directions that the Hessian does not hold back.
    soft: Vec<f64>,
    trial: Vec<f64>,
    trial_force: Vec<f64>,
    scratch: Vec<f64>,
    /// The differential and the step of the iterate, while steps are tried that raise the energy.
    kept: [Vec<f64>; 2],
    /// How far from the origin the search began, or how far its first step led.
    far: f64,
}

impl<'a, M: Metric, P: Potential, L: HessianSolver> Descent<'a, M, P, L> {
    pub(super) fn new(metric: &'a M, potential: &'a P, solver: L, newton: Newton) -> Self {
        let zeros = || vec![0.0; metric.dim()];
        Descent {
            metric,
            potential,
            solver,
            newton,
            force: zeros(),
            step: zeros(),
            soft: zeros(),
            trial: zeros(),
            trial_force: zeros(),
            scratch: zeros(),
            kept: [zeros(), zeros()],
            far: 0.0,
        }
    }

    /// Moves q to rest.
    pub(super) fn run(
        &mut self,
        q: &mut [f64],
        history: &mut Vec<f64>,
    ) -> Result<EquilibriumReport, NewtonFailure> {
        self.newton.check_tolerance()?;
        let n = self.metric.dim();
        SizeError::check("the configuration's numbers", n, q.len()).map_err(NewtonFailure::Size)?;
        let mut report = NewtonReport { residuals: 1, ..NewtonReport::default() };
        let mut highest_rung = Rung::Cholesky;
        let guess = largest(q);
        self.far = guess;
        self.differential(q);
        let mut size = self.norm();
        history.push(size);
        if let Some(unknown) = first_non_finite(q).or(first_non_finite(&self.force)) {
            return Err(NewtonFailure::NonFinite(unknown));
        }
        let mut energy = None;
        while size > self.newton.tolerance {
            if report.iterations as usize >= self.newton.iterations {
                return if self.is_rounding(q, largest(q).max(FORGOTTEN * guess)) {
                    report.end = NewtonEnd::Rounding;
                    break;
                } else {
                    Err(NewtonFailure::NotConverged)
                };
            }
            let halved = history.iter().rev().nth(1).is_none_or(|before| size < 0.5 * before);
            let falls = size > SETTLED * history[0] && halved;
            let (kind, rung) = self.direction(q, falls)?;
            highest_rung = highest_rung.max(rung);
            report.iterations += 1;
            let nearly = largest(&self.step) <= NEARLY * largest(q).max(guess);
            let least = largest(q).max(FORGOTTEN * guess);
            let rounding = match kind {
                Step::Newton if nearly && stands_still(history) => self.is_rounding(q, least),
                Step::Newton if nearly => self.is_rounding(q, 0.0),
                _ => false,
            };
            if rounding {
                // The last step is at hand: it is taken unless it leads farther off. From the guess it
                // is taken in any case: a load below the rounding of q is known there and nowhere else.
                let is_guess = history.len() == 1;
                if let Some(found) = self.attempt(q, 1.0, &mut report)
                    && (found.size <= size || is_guess)
                {
                    q.copy_from_slice(&self.trial);
                    size = found.size;
                    history.push(size);
                }
                report.end = NewtonEnd::Rounding;
                break;
            }
            let start = match energy {
                Some(energy) => energy,
                None => {
                    report.energies += 1;
                    self.potential.energy(q)
                }
            };
            let relaxed = match kind {
                Step::Newton => self.relax(q, (size, start), &mut report, history),
                _ => None,
            };
            let found = match relaxed {
                Some(found) => Some(found),
                None => self.search(q, (size, start), kind, &mut report)?,
            };
            match found {
                Some(found) => {
                    q.copy_from_slice(&self.trial);
                    std::mem::swap(&mut self.force, &mut self.trial_force);
                    (size, energy) = (found.size, Some(found.energy));
                    history.push(size);
                }
                None if self.is_rounding(q, least) => {
                    report.end = NewtonEnd::Rounding;
                    break;
                }
                None => return Err(NewtonFailure::Stalled),
            }
        }
        report.residual = size;
        let (mut kind, rung) = self.classify(q)?;
        if kind == Stationary::Minimum && report.iterations > DOZEN && !self.bends_around(q) {
            kind = Stationary::Flat;
        }
        Ok(EquilibriumReport { newton: report, kind, highest_rung, rung })
    }

    /// What kind of place q is.
    fn classify(&mut self, q: &[f64]) -> Result<(Stationary, Rung), NewtonFailure> {
        let factored = self.factor(q);
        let rung = match factored {
            Ok(Rung::Cholesky) => return Ok((Stationary::Minimum, Rung::Cholesky)),
            Ok(rung) => rung,
            Err(Unsolvable::Singular | Unsolvable::Untrusted { .. }) => Rung::Indefinite,
            Err(error) => return Err(NewtonFailure::Unsolvable(error)),
        };
        let kind = match self.lowest(q)? {
            Some(Lowest { direction, curvature, is_negative: true, .. }) => {
                Stationary::Saddle { down: Vector(direction), curvature }
            }
            _ => Stationary::Flat,
        };
        Ok((kind, rung))
    }

    /// Whether the Hessian is definite a few roundings of q away as well.
    fn bends_around(&mut self, q: &[f64]) -> bool {
        let by = ROUNDINGS * f64::EPSILON * largest(q);
        [by, -by].into_iter().all(|by| {
            let beside: Vec<f64> = q.iter().map(|q| q + by).collect();
            self.factor(&beside) == Ok(Rung::Cholesky)
        })
    }

    fn factor(&mut self, q: &[f64]) -> Result<Rung, Unsolvable> {
        self.solver.factor_weighted(0.0, self.metric, 1.0, self.potential, q)
    }

    fn lowest(&mut self, q: &[f64]) -> Result<Option<Lowest>, NewtonFailure> {
        let scale = scale(self.metric, self.potential, q);
        lowest(&mut self.solver, self.metric, self.potential, q, scale)
            .map_err(NewtonFailure::Unsolvable)
    }

    fn differential(&mut self, q: &[f64]) {
        self.force.fill(0.0);
        self.potential.add_differential(q, Covector(&mut self.force[..]));
    }

    fn norm(&mut self) -> f64 {
        norm(self.metric, &self.force, &mut self.scratch)
    }

    /// Whether each component of the differential is what rounding makes of its terms, where every
    /// component of q is at least `least`.
    fn is_rounding(&mut self, q: &[f64], least: f64) -> bool {
        let sizes: Vec<f64> = q.iter().map(|q| q.abs().max(least)).collect();
        magnitudes(self.potential, q, &sizes, &mut self.scratch);
        let small = |(f, t): (&f64, &f64)| f.abs() <= ROUNDINGS * f64::EPSILON * t;
        self.force.iter().zip(&self.scratch).all(small)
    }
}

/// Whether the residual has not halved over the last steps.
fn stands_still(history: &[f64]) -> bool {
    let Some(first) = history.len().checked_sub(STANDSTILL + 1) else { return false };
    history[first + 1..].iter().all(|&size| size > 0.5 * history[first])
}

/// `|M^-1 f|` in the metric. Squares that leave the range of numbers do not.
fn norm(metric: &impl Metric, f: &[f64], scratch: &mut [f64]) -> f64 {
    metric.sharp(Covector(f), Vector(&mut *scratch));
    let square = dot(f, scratch);
    if SQUARES.contains(&square) || square.is_nan() {
        return square.sqrt();
    }
    let largest = largest(f);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let unit: Vec<f64> = f.iter().map(|f| f / largest).collect();
    metric.sharp(Covector(&unit), Vector(&mut *scratch));
    largest * dot(&unit, scratch).sqrt()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
