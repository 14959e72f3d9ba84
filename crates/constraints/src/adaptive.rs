//! Steps whose length follows a tolerance, and places and forces at any time of the last step.
//!
//! ```text
//! Phi_h,  Phi_h/2 Phi_h/2      error of the second about their distance / (2^p - 1), p the order
//! h <- 0.9 h error^(-1/(p+1))  in units of the tolerance, within a factor of 5
//! q(t) = Phi_(t - t_k) q_k     t_k the start of the half in which t lies
//! lambda(t)                    the line through the mean forces of both halves, at their middles
//! ```
//! The motion goes on from the halves, which are steps of the method: constraints hold to its own rounding.
//! So they do at any time between, because there, too, a step of the method leads. Places and velocities
//! are continuous in time; forces are of order 2 within a step. The tolerance is that of the stored numbers
//! of a configuration, in one step.
//!
//! A step that fails where a shorter one may not is taken again, shorter; and so is one that would begin or
//! end too close to a singular position, for which a linkage is led across by a step that is not. The
//! step depends on the state: the whole is neither symmetric nor symplectic, and energy has a trend (equal
//! steps have none). A tolerance below rounding is met by no step, or by chance: where shorter steps are no better and
//! their error is slight, that is an error.
//! Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.4.

use stationary_calculus::{SizeError, Storage};
use stationary_integrators::State;

use crate::checks::{check_step, check_time};
use crate::feasible::largest;
use crate::halving::is_mended_by_shorter_steps;
use crate::parts::Parts;
use crate::{ConstrainedIntegrator, ConstrainedReport, ConstraintError};

/// Steps that are refused or too long, one after another, at most.
const REJECTIONS: u32 = 60;
/// How much longer or shorter a step may be than the last.
const CHANGE: f64 = 5.0;
/// What is aimed at of the length that the error allows.
const CAUTION: f64 = 0.9;
/// A step that fails is taken again with this part of its length: a part of which no power is a half.
const SHORTER: f64 = 0.37;

/// Steps at most half as long as the one before, whose error is no smaller than half of it, are off by rounding when
/// so many follow each other, and when that error is this part of the configuration at most.
const STAGNANT: u32 = 3;
const SLIGHT: f64 = 1e-8;

/// The error of the stored numbers of a configuration that a step may have: `absolute + relative |q_i|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTolerance {
    /// In the units of the numbers: metres, or 1 for those of a quaternion.
    pub absolute: f64,
    /// Relative to the larger of each number before and after the step.
    pub relative: f64,
}

/// What a step with a length of its own was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveReport {
    /// Its start, seconds.
    pub from: f64,
    /// Its end, seconds.
    pub to: f64,
    /// Its estimated error in units of the tolerance.
    pub error: f64,
    /// Lengths that were tried in vain before.
    pub rejected: u32,
    /// What all of it cost, those that were tried in vain but failed left aside; the violation is the one at the end.
    pub cost: ConstrainedReport,
}

/// A method with steps of its own length.
#[derive(Clone, Debug)]
pub struct Adaptive<I, C> {
    integrator: I,
    /// Another, for output between steps.
    between: I,
    tolerance: StepTolerance,
    /// The length that is tried next.
    length: f64,
    whole: Parts<C>,
    halves: Parts<C>,
    /// The start and the middle of the last step, and the mean forces of its halves.
    nodes: [State<C>; 2],
    end: f64,
    forces: [Vec<f64>; 2],
    /// The middle of the step that is tried, and the mean forces of its halves.
    tried: (State<C>, [Vec<f64>; 2]),
}

/// Steps that are much shorter than the last and no better.
#[derive(Clone, Copy, Debug)]
struct Stagnation {
    count: u32,
    length: f64,
    error: f64,
}

/// An error in units of a tolerance, which may be none: no error is within it, and any other beyond.
fn in_tolerances(error: f64, allowed: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / allowed }
}

impl Default for Stagnation {
    fn default() -> Self {
        Stagnation { count: 0, length: f64::INFINITY, error: f64::INFINITY }
    }
}

impl Stagnation {
    /// Takes in a step that was too long.
    fn see(&mut self, length: f64, error: f64) {
        if length > 0.5 * self.length {
            return;
        }
        self.count = if error > 0.5 * self.error { self.count + 1 } else { 0 };
        (self.length, self.error) = (length, error);
    }
}

impl<C: Storage, I: ConstrainedIntegrator<C> + Clone> Adaptive<I, C> {
    /// A method with a tolerance, for states as large as this one, and the length of the first step that is
    /// tried.
    ///
    /// # Errors
    /// A tolerance that is not positive and finite, a first step that is not; storage that has not the state's
    /// size.
    pub fn new(
        integrator: I,
        tolerance: StepTolerance,
        first: f64,
        state: &State<C>,
    ) -> Result<Self, ConstraintError> {
        let StepTolerance { absolute, relative } = tolerance;
        for (what, value) in [("absolute tolerance", absolute), ("relative tolerance", relative)] {
            if !(value >= 0.0 && value.is_finite() && absolute + relative > 0.0) {
                let range = "finite and not negative, and one of them positive";
                return Err(ConstraintError::Parameter { what, value, range });
            }
        }
        check_step(first)?;
        let whole = Parts::new(&integrator, state)?;
        let none = vec![0.0; integrator.multipliers().len()];
        let forces = [none.clone(), none];
        Ok(Adaptive {
            between: integrator.clone(),
            integrator,
            tolerance,
            length: first,
            halves: whole.clone(),
            whole,
            nodes: [state.clone(), state.clone()],
            end: state.t,
            tried: (state.clone(), forces.clone()),
            forces,
        })
    }

    /// The method.
    pub fn integrator(&self) -> &I {
        &self.integrator
    }

    /// The length that is tried next, seconds.
    pub fn next_length(&self) -> f64 {
        self.length
    }

    /// Moves a state by one step, which does not pass the time `until`. On an error the state is as it was.
    ///
    /// # Errors
    /// Those of the method's step, where shorter ones fail as well; [`ConstraintError::StepTooShort`] where none
    /// meets the tolerance; a time that is not after the state's.
    pub fn advance(
        &mut self,
        state: &mut State<C>,
        until: f64,
    ) -> Result<AdaptiveReport, ConstraintError> {
        check_time(until)?;
        let from = state.t;
        check_step(until - from)?;
        let order = f64::from(self.integrator.facts().order);
        let mut cost = ConstrainedReport::default();
        let (mut rejected, mut stagnation) = (0, Stagnation::default());
        loop {
            let left = until - from;
            // What would be left of it should not be a sliver.
            let last = self.length >= left * (1.0 - 1e-10);
            let h = if last { left } else { self.length.min(left) };
            let tried = self.attempt(state, h);
            let again = |shorter: f64| from + shorter > from && rejected < REJECTIONS;
            let (number, error) = match tried {
                Ok(report) => {
                    cost = cost.followed_by(&report);
                    self.error(state, order)
                }
                Err(error) if is_mended_by_shorter_steps(&error) && again(SHORTER * h) => {
                    self.length = SHORTER * h;
                    rejected += 1;
                    continue;
                }
                Err(error) => return Err(error),
            };
            let factor = CAUTION * error.powf(-1.0 / (order + 1.0));
            let factor = factor.clamp(CHANGE.recip(), CHANGE);
            if error > 1.0 || error.is_nan() {
                let shorter = h * if error.is_nan() { SHORTER } else { factor.min(CAUTION) };
                stagnation.see(h, error);
                let rounding = stagnation.count >= STAGNANT && self.is_slight(number);
                if rounding || !again(shorter) {
                    return Err(ConstraintError::StepTooShort { t: from, h, error, number });
                }
                self.length = shorter;
                rejected += 1;
                continue;
            }
            self.length = if last { self.length.max(h * factor) } else { h * factor };
            self.nodes[0].clone_from(state);
            std::mem::swap(&mut self.nodes[1], &mut self.tried.0);
            std::mem::swap(&mut self.forces, &mut self.tried.1);
            self.end = if last { until } else { from + h };
            self.halves.moving.t = self.end;
            state.clone_from(&self.halves.moving);
            return Ok(AdaptiveReport { from, to: self.end, error, rejected, cost });
        }
    }

    /// A step and its halves.
    fn attempt(&mut self, state: &State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError> {
        let Adaptive { integrator, whole, halves, tried: (middle, forces), .. } = self;
        halves.begin(state)?;
        whole.begin(state)?;
        let mut cost = integrator.step(&mut whole.moving, h)?;
        let [first, second] = forces;
        cost = cost.followed_by(&integrator.step(&mut halves.moving, 0.5 * h)?);
        first.copy_from_slice(integrator.multipliers());
        middle.clone_from(&halves.moving);
        cost = cost.followed_by(&integrator.step(&mut halves.moving, 0.5 * h)?);
        second.copy_from_slice(integrator.multipliers());
        Ok(cost)
    }

    /// The number in which the halves are off most, and by how many tolerances.
    fn error(&self, state: &State<C>, order: f64) -> (usize, f64) {
        let (whole, halves) = (self.whole.moving.q.as_ref(), self.halves.moving.q.as_ref());
        let StepTolerance { absolute, relative } = self.tolerance;
        let numbers = whole.iter().zip(halves).zip(state.q.as_ref()).enumerate();
        let (number, largest) = numbers.fold((0, 0.0_f64), |largest, (k, ((whole, halves), q))| {
            let allowed = absolute + relative * q.abs().max(halves.abs());
            let off = in_tolerances((whole - halves).abs(), allowed);
            // Not `max`, which loses what is not a number.
            if off <= largest.1 || largest.1.is_nan() { largest } else { (k, off) }
        });
        (number, largest / (order.exp2() - 1.0))
    }

    /// Whether a number is off by a small part of the configuration.
    fn is_slight(&self, number: usize) -> bool {
        let (whole, halves) = (self.whole.moving.q.as_ref(), self.halves.moving.q.as_ref());
        (whole[number] - halves[number]).abs() <= SLIGHT * largest(halves)
    }

    /// Writes the state and the multipliers at a time within the last step.
    ///
    /// # Errors
    /// A time outside of it; sizes that differ; those of a step of the method.
    pub fn at(
        &mut self,
        t: f64,
        state: &mut State<C>,
        multipliers: &mut [f64],
    ) -> Result<(), ConstraintError> {
        let (from, middle) = (self.nodes[0].t, self.nodes[1].t);
        if !(t >= from && t <= self.end) {
            let (what, range) = ("time of the output", "within the last step");
            return Err(ConstraintError::Parameter { what, value: t, range });
        }
        SizeError::check("the multipliers", self.forces[0].len(), multipliers.len())?;
        let node = &self.nodes[usize::from(t >= middle)];
        let moved = &mut self.whole.moving;
        moved.clone_from(node);
        if t > node.t {
            self.between.step(moved, t - node.t)?;
        }
        moved.t = t;
        state.clone_from(moved);
        // Mean forces are those at the middles of the halves, but for order 2.
        let half = middle - from;
        let along = if half > 0.0 { (t - from - 0.5 * half) / half } else { 0.0 };
        let means = self.forces[0].iter().zip(&self.forces[1]);
        for (multiplier, (first, second)) in multipliers.iter_mut().zip(means) {
            *multiplier = first + along * (second - first);
        }
        Ok(())
    }
}
