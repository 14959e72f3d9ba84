//! The way down, step by step until no force is left, and what kind of place that is.
//!
//! ```text
//! q <- q + t p      until |M^-1 f| <= tolerance, or f is what rounding makes of its terms
//! ```
//! `f` the differential, `p` the step (`direction`: which way), `t` its length (`line_search`: how far).
//! Source: Nocedal and Wright, Numerical Optimization, chapters 3 and 7.

mod direction;
mod line_search;

use super::asked::Asked;
use super::curvature::{Lowest, lowest};
use super::terms::{dot, scale};
use super::{EquilibriumReport, Stationary};
use crate::equation::SQUARES;
use crate::{
    Covector, Newton, NewtonEnd, NewtonFailure, NewtonReport, Rung, SizeError, Unsolvable, Vector,
    first_non_finite,
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

/// One search.
pub(super) struct Descent<'a> {
    asked: &'a mut dyn Asked,
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

impl<'a> Descent<'a> {
    pub(super) fn new(asked: &'a mut dyn Asked, newton: Newton) -> Self {
        let n = asked.freedoms();
        let zeros = || vec![0.0; n];
        Descent {
            asked,
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
        mut self,
        q: &mut [f64],
        history: &mut Vec<f64>,
    ) -> Result<EquilibriumReport, NewtonFailure> {
        self.newton.check_tolerance()?;
        let n = self.force.len();
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
                return if self.is_rounding_as_a_whole(q, guess) {
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
            let rounding = match kind {
                Step::Newton if nearly && stands_still(history) => {
                    self.is_rounding_as_a_whole(q, guess)
                }
                Step::Newton if nearly => self.is_rounding(q),
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
                    self.asked.energy(q)
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
                None if self.is_rounding_as_a_whole(q, guess) => {
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
        self.asked.factor(0.0, q)
    }

    fn lowest(&mut self, q: &[f64]) -> Result<Option<Lowest>, NewtonFailure> {
        let scale = scale(self.asked, q);
        lowest(self.asked, q, scale).map_err(NewtonFailure::Unsolvable)
    }

    fn differential(&mut self, q: &[f64]) {
        self.force.fill(0.0);
        self.asked.add_differential(q, Covector(&mut self.force[..]));
    }

    fn norm(&mut self) -> f64 {
        norm(self.asked, &self.force, &mut self.scratch)
    }

    /// Whether each component of the differential is what rounding makes of its terms.
    fn is_rounding(&mut self, q: &[f64]) -> bool {
        self.asked.magnitudes(q, q, &mut self.scratch);
        self.force.iter().zip(&self.scratch).all(|(f, t)| f.abs() <= ROUNDINGS * f64::EPSILON * t)
    }

    /// Whether the differential is what rounding makes of it as a whole. Beside a component of q that is to be zero
    /// the force is `H q`, as large as its terms however close it comes: there it is measured by roundings of the
    /// largest component of q, and must be no larger than what rounding leaves elsewhere, which at a kink it is.
    fn is_rounding_as_a_whole(&mut self, q: &[f64], guess: f64) -> bool {
        if self.is_rounding(q) {
            return true;
        }
        let masses = self.asked.masses();
        let of_mass = |(t, m): (&f64, &f64)| t / m.sqrt();
        let elsewhere = self.scratch.iter().zip(&masses).map(of_mass).fold(0.0, f64::max);
        let own = self.scratch.clone();
        let least = largest(q).max(FORGOTTEN * guess);
        let sizes: Vec<f64> = q.iter().map(|q| q.abs().max(least)).collect();
        self.asked.magnitudes(q, &sizes, &mut self.scratch);
        let terms = own.iter().zip(&self.scratch).zip(&masses);
        let allowed = terms.map(|((own, t), m)| own.max(t.min(elsewhere * m.sqrt())));
        self.force.iter().zip(allowed).all(|(f, t)| f.abs() <= ROUNDINGS * f64::EPSILON * t)
    }
}

/// Whether the residual has not halved over the last steps.
fn stands_still(history: &[f64]) -> bool {
    let Some(first) = history.len().checked_sub(STANDSTILL + 1) else { return false };
    history[first + 1..].iter().all(|&size| size > 0.5 * history[first])
}

/// `|M^-1 f|` in the metric. Squares that leave the range of numbers do not.
fn norm(asked: &dyn Asked, f: &[f64], scratch: &mut [f64]) -> f64 {
    asked.sharp(f, scratch);
    let square = dot(f, scratch);
    if SQUARES.contains(&square) || square.is_nan() {
        return square.sqrt();
    }
    let largest = largest(f);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let unit: Vec<f64> = f.iter().map(|f| f / largest).collect();
    asked.sharp(&unit, scratch);
    largest * dot(&unit, scratch).sqrt()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}
