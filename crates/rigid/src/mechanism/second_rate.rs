//! The second rate of what is driven, by differences of its first over times that suit it.
//!
//! ```text
//! r(s) = dg/dt (t + s, q exp(2 s v)),      r. = d2g/dt2 + 2 v d(dg/dt)
//! r. ~ (8 (r(h) - r(-h)) - (r(2h) - r(-2h))) / 12h,      h doubled while that changes less and less
//! ```
//! `g` the equations, `q v` a configuration and its velocities, `h` seconds. A short time is lost in rounding, and
//! over a long one a fast drive turns many times: what is taken changes least from one doubling to the next, before it
//! changes by a thousand times as much. Good to ten digits of a rate times its frequency. A rate that jumps has
//! differences that settle at no time.

use stationary_calculus::Vector;
use stationary_constraints::{Constraint, check_read, equation_name};

use super::MechanismError;
use crate::BodySpace;

/// The shortest time, seconds, and how often it is doubled at most.
const SHORTEST: f64 = 1.0 / (1_u64 << 40) as f64;
const DOUBLINGS: u32 = 44;
/// The shortest time in roundings of the time at which it is asked.
const ROUNDINGS: f64 = 64.0;
/// Differences that change by so many times the least are those of too long a time.
const LONGER: f64 = 1e3;
/// Those in doubt by more than this part of themselves and of the rate over their time have not settled.
const SETTLED: f64 = 1e-6;

/// The differences of one rate so far.
#[derive(Clone, Copy)]
struct Differences {
    last: f64,
    best: f64,
    /// By how much the best one may be off, and what the rate over its time is.
    doubt: f64,
    steepest: f64,
    ended: bool,
}

impl Differences {
    fn new() -> Self {
        let unknown = f64::INFINITY;
        Differences { last: f64::NAN, best: 0.0, doubt: unknown, steepest: 0.0, ended: false }
    }

    /// Takes in the rates at `-2 -1 1 2` times `h`.
    fn see(&mut self, h: f64, [b, a, c, d]: [f64; 4]) {
        let found = (8.0 * (c - a) - (d - b)) / (12.0 * h);
        let most = [a, b, c, d].iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let doubt = (found - self.last).abs() + 4.0 * f64::EPSILON * most / h;
        self.last = found;
        // Of the first nothing is known.
        if doubt < self.doubt {
            (self.best, self.doubt, self.steepest) = (found, doubt, most / h);
        }
        // No time is better than one of no doubt, as where nothing drives.
        self.ended |= !found.is_finite() || doubt > LONGER * self.doubt || doubt == 0.0;
    }

    fn is_settled(&self) -> bool {
        self.doubt <= SETTLED * self.best.abs().max(self.steepest)
    }
}

/// `d2g/dt2 + 2 v d(dg/dt)` of each equation, at a time, a configuration and velocities.
pub(super) fn second_rates<S: BodySpace>(
    constraint: &impl Constraint,
    (t, q, v): (f64, &[f64], &[f64]),
) -> Result<Vec<f64>, MechanismError> {
    let mut rows = vec![Differences::new(); constraint.count()];
    let mut rates = [0, 1, 2, 3].map(|_| vec![0.0; constraint.count()]);
    let stored = S::SPACE.stored(v.len());
    check_read(stored, q)?;
    let mut moved = q.to_vec();
    let mut h = SHORTEST;
    while h < ROUNDINGS * f64::EPSILON * t.abs() {
        h *= 2.0;
    }
    for _ in 0..DOUBLINGS {
        for (rates, steps) in rates.iter_mut().zip([-2.0, -1.0, 1.0, 2.0]) {
            moved.copy_from_slice(q);
            S::SPACE.advance(&mut moved[..stored], 2.0 * steps * h, Vector(v));
            constraint.rate(t + steps * h, &moved, rates)?;
        }
        for (row, differences) in rows.iter_mut().enumerate().filter(|(_, row)| !row.ended) {
            differences.see(h, rates.each_ref().map(|rates| rates[row]));
        }
        if rows.iter().all(|row| row.ended) {
            break;
        }
        h *= 2.0;
    }
    match rows.iter().position(|row| !row.is_settled()) {
        None => Ok(rows.iter().map(|row| row.best).collect()),
        Some(row) => {
            Err(MechanismError::RateJumps { row, name: equation_name(constraint, row), t })
        }
    }
}
