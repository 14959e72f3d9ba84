//! The way down: Newton's steps where the energy is convex, the lowest curvature where it is not, the
//! force where there is no curvature at all.
//!
//! ```text
//! definite         p = -H^-1 f
//! not definite     p = -(H + sigma M)^-1 f + l w,    <f, w> <= 0
//! no Hessian       p = -M^-1 f
//! V(q + t p) <= V(q) + c t <f, p>                    Armijo's condition, c = 1e-4
//! ```
//! `f` the differential, `w` the direction of the lowest curvature, `l` the length of the first part,
//! once the residual has become small: a ridge is followed to its saddle before it is left. `t` 1, 1/2,
//! 1/4, ...; where p has no length of its own, because the Hessian is not definite, what of it is soft
//! is followed by 4, 16, 64, ... times its length for as long as the energy falls. Where energies differ
//! by rounding only, the residual decides. Source: Nocedal and Wright, Numerical Optimization, chapters 3 and 7.

use super::curvature::{Lowest, lowest};
use super::terms::{length, magnitudes, scale};
use super::{EquilibriumReport, Stationary};
use crate::equation::SQUARES;
use crate::{
    Covector, HessianSolver, Metric, Newton, NewtonEnd, NewtonFailure, NewtonReport, Potential,
    Rung, SizeError, Unsolvable, Vector, first_non_finite,
};

/// Armijo's constant: the part of the predicted fall that a step must reach.
const SUFFICIENT: f64 = 1e-4;
/// Step lengths tried, down to 2^-60: from far away into a narrow domain.
const LENGTHS: usize = 61;
/// Energies that differ by this much, relatively, cannot be told apart.
const SAME_ENERGY: f64 = 16.0 * f64::EPSILON;
/// A step that promises no more than this of the energy is judged by the residual.
const UNTOLD: f64 = 1e-11;
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

/// What a direction knows of its own length.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// Newton's: its length is 1.
    Newton,
    /// It goes on for as long as the energy falls.
    Open,
    /// Newton's to any place at rest: it may rise.
    ToAnyRest,
}

/// Where a line search ended.
struct Found {
    size: f64,
    energy: f64,
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

    /// Writes the direction.
    /// `falls`: whether the residual is still far from what it was at first.
    fn direction(&mut self, q: &[f64], falls: bool) -> Result<(Step, Rung), NewtonFailure> {
        let (kind, rung) = match self.factor(q) {
            Ok(Rung::Cholesky) => {
                self.solve();
                (Step::Newton, Rung::Cholesky)
            }
            Ok(rung @ Rung::Indefinite) => {
                self.solve();
                if first_non_finite(&self.step).is_some() {
                    self.along_the_force(q);
                    self.soft.copy_from_slice(&self.step);
                    (Step::Open, rung)
                } else {
                    (Step::ToAnyRest, rung)
                }
            }
            Ok(rung) => (self.without_convexity(q, falls)?, rung),
            Err(Unsolvable::Singular) => (self.without_convexity(q, falls)?, Rung::Indefinite),
            Err(error) => return Err(NewtonFailure::Unsolvable(error)),
        };
        match first_non_finite(&self.step) {
            Some(unknown) => Err(NewtonFailure::NonFinite(unknown)),
            None => Ok((kind, rung)),
        }
    }

    /// Writes `-A^-1 f` for the matrix that was factored last.
    fn solve(&mut self) {
        self.step.copy_from_slice(&self.force);
        self.solver.solve(&mut self.step);
        self.step.iter_mut().for_each(|p| *p = -*p);
    }

    /// Writes the direction where the Hessian is not definite, and the part of it that is soft.
    fn without_convexity(&mut self, q: &[f64], falls: bool) -> Result<Step, NewtonFailure> {
        let lowest = match self.lowest(q)? {
            Some(lowest) => lowest,
            None => {
                self.along_the_force(q);
                self.soft.copy_from_slice(&self.step);
                return Ok(Step::Open);
            }
        };
        self.solve();
        if lowest.is_negative && !falls {
            // Along w as far as along the rest, to the side to which the force leads.
            self.metric.flat(Vector(&lowest.direction), Covector(&mut self.scratch[..]));
            let backwards = dot(&self.scratch, &self.step) < 0.0;
            let l = length(self.metric, &self.step, &mut self.scratch);
            let l = if backwards { -l } else { l };
            self.step.iter_mut().zip(&lowest.direction).for_each(|(p, w)| *p += l * w);
        }
        // The factor at hand leaves of a vector what the Hessian does not hold back.
        self.soft.copy_from_slice(&self.step);
        for _ in 0..2 {
            self.metric.flat(Vector(&self.soft), Covector(&mut self.scratch[..]));
            self.scratch.iter_mut().for_each(|p| *p *= lowest.sigma);
            self.solver.solve(&mut self.scratch);
            self.soft.copy_from_slice(&self.scratch);
        }
        if first_non_finite(&self.step).or(first_non_finite(&self.soft)).is_some() {
            self.along_the_force(q);
            self.soft.copy_from_slice(&self.step);
        }
        Ok(Step::Open)
    }

    /// Writes `-M^-1 f`, a thousandth of q long.
    fn along_the_force(&mut self, q: &[f64]) {
        let f = largest(&self.force);
        self.scratch.iter_mut().zip(&self.force).for_each(|(g, f0)| *g = f0 / f);
        self.metric.sharp(Covector(&self.scratch), Vector(&mut self.step[..]));
        let (way, far) = (largest(&self.step), largest(q));
        let wanted = if far > 0.0 { 1e-3 * far } else { 1.0 };
        self.step.iter_mut().for_each(|p| *p *= -wanted / way);
    }

    /// Writes q + t p, and its differential; the size of that and the energy, or `None` where one is not
    /// finite.
    fn attempt(&mut self, q: &[f64], t: f64, report: &mut NewtonReport) -> Option<Found> {
        let ends = self.trial.iter_mut().zip(q).zip(&self.step);
        ends.for_each(|((trial, q), p)| *trial = q + t * p);
        report.energies += 1;
        let energy = self.potential.energy(&self.trial);
        if !energy.is_finite() {
            return None;
        }
        report.residuals += 1;
        self.trial_force.fill(0.0);
        self.potential.add_differential(&self.trial, Covector(&mut self.trial_force[..]));
        let size = norm(self.metric, &self.trial_force, &mut self.scratch);
        size.is_finite().then_some(Found { size, energy })
    }

    /// Whole Newton steps, of which the first may raise the energy if the last ends below: along a
    /// narrow bent valley each step leaves it and the next one returns. Leaves the end in `trial`, as a
    /// line search does; without success all is as it was.
    ///
    /// Source: the watchdog of Chamberlain, Powell, Lemarechal and Pedersen (1982).
    fn relax(
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
    fn search(
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

/// Whether a step of length t leads far enough down.
fn is_enough(found: &Found, (size, start): (f64, f64), slope: f64, t: f64) -> bool {
    let less = found.size <= (1.0 - SUFFICIENT * t) * size;
    let largest = start.abs().max(found.energy.abs());
    let same = found.energy <= start + SAME_ENERGY * largest;
    let untold = slope.abs() <= UNTOLD * largest;
    let falls = found.energy <= start + SUFFICIENT * t * slope;
    (falls && !untold) || (less && (same || untold))
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
