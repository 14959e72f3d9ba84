//! The moments of the whole way: the ends of a run's steps, and three within each.
//!
//! ```text
//! t = t_n,  t_(n-1) + theta (t_n - t_(n-1)),   theta = sqrt 5 - 2, sqrt 2 - 1, sqrt 3 - 1
//! ```
//! `t_n` the ends of equal steps, or of those that an adaptive method accepted: every step is looked into
//! at three irrational parts, where nothing of the motion repeats; at five where all of few long steps are
//! looked into, at twenty-one where they were accepted or lines join their ends. A method of equal steps
//! says what it gives there by a step of that part; an adaptive one and modes are read off.

use std::sync::Arc;

use crate::ladder::{At, MOMENTS};

/// Irrational parts of a step.
const PARTS: [f64; 3] = [0.236_067_977_499_789_7, 0.414_213_562_373_095_1, 0.732_050_807_568_877_2];

/// Parts of an accepted step or of a line, and of equal steps that are so few that they are long.
const OF_ACCEPTED: usize = 21;
const OF_LONG: usize = 5;
const FEW: u64 = 80;

/// Parts of the steps of a run that is another motion.
const OF_ANOTHER: usize = 34;

/// Steps that are looked into at most; of more, every so manieth.
const MOST: usize = 1 << 15;

/// How near two moments must be to be the same, in steps.
const SAME: f64 = 1e-6;

/// Whose steps say where whole ways are compared.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grid {
    /// Equal parts of the horizon: a twentieth, halved so often.
    Equal {
        /// See there.
        halvings: u32,
    },
    /// The same, each looked into at many moments.
    Closely {
        /// See there.
        halvings: u32,
    },
    /// Some of these parts.
    Some {
        /// See there.
        halvings: u32,
        /// Which, counted from 0, in the order of time.
        parts: Arc<[u64]>,
    },
    /// Some of these parts, each looked into at many moments.
    SomeClosely {
        /// See there.
        halvings: u32,
        /// Which, counted from 0, in the order of time.
        parts: Arc<[u64]>,
    },
    /// The steps that an adaptive rung accepted.
    Accepted(At),
}

/// What of the steps is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Within {
    /// Their insides and their ends.
    Parts,
    /// Their ends.
    Ends,
}

/// The moments of a grid, in the order of time, the start left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// When.
    pub times: Vec<f64>,
    /// Equal parts of the horizon that are looked into, where they are equal.
    pub parts: Option<u64>,
    /// Every so manieth step is looked into.
    pub every: usize,
    /// Moments within a step.
    pub within: usize,
}

impl Moments {
    /// The ends of the steps alone.
    pub fn ends(&self) -> Self {
        let times = self.times.iter().skip(self.within).step_by(self.within + 1).copied();
        Moments { times: times.collect(), within: 0, ..*self }
    }

    /// Of equal parts.
    pub fn equal(halvings: u32, horizon: f64) -> Self {
        match MOMENTS << halvings <= FEW {
            true => Moments::looked_into(halvings, horizon, &golden::<OF_LONG>()),
            false => Moments::looked_into(halvings, horizon, &PARTS),
        }
    }

    /// Of equal parts whose ends are joined by lines, between which a look costs nothing.
    pub fn joined(halvings: u32, horizon: f64) -> Self {
        Moments::looked_into(halvings, horizon, &golden::<OF_ACCEPTED>())
    }

    /// Of equal parts, at many moments of each.
    pub fn closely(halvings: u32, horizon: f64) -> Self {
        Moments::looked_into(halvings, horizon, &golden::<OF_ANOTHER>())
    }

    fn looked_into(halvings: u32, horizon: f64, thetas: &[f64]) -> Self {
        let parts = MOMENTS << halvings;
        let length = horizon / parts as f64;
        let ends = (1..=parts).map(|part| part as f64 * length);
        let mut moments = Moments::within(parts as usize, ends, thetas);
        moments.parts = Some(parts / moments.every as u64);
        moments
    }

    /// Of some of them.
    pub fn some(halvings: u32, some: &[u64], horizon: f64) -> Self {
        Moments::of_some(halvings, some, horizon, &PARTS)
    }

    /// Of some of them, at many moments of each.
    pub fn some_closely(halvings: u32, some: &[u64], horizon: f64) -> Self {
        Moments::of_some(halvings, some, horizon, &golden::<OF_ANOTHER>())
    }

    fn of_some(halvings: u32, some: &[u64], horizon: f64, thetas: &[f64]) -> Self {
        let parts = MOMENTS << halvings;
        let length = horizon / parts as f64;
        let each = some.iter().flat_map(|&part| {
            let start = part as f64 * length;
            let inside = thetas.iter().map(move |theta| start + theta * length);
            inside.chain([(part + 1) as f64 * length])
        });
        Moments { times: each.collect(), parts: Some(parts), every: 1, within: thetas.len() }
    }

    /// Of so many accepted steps that end there.
    pub fn accepted(count: usize, ends: impl Iterator<Item = f64>) -> Self {
        Moments::within(count, ends, &golden::<OF_ACCEPTED>())
    }

    fn within(count: usize, ends: impl Iterator<Item = f64>, parts: &[f64]) -> Self {
        let every = count.div_ceil(MOST).next_power_of_two();
        let room = (parts.len() + 1) * (count / every + 1);
        let (mut times, mut before) = (Vec::with_capacity(room), 0.0);
        for (step, end) in ends.enumerate() {
            if (step + 1).is_multiple_of(every) {
                times.extend(parts.iter().map(|theta| before + theta * (end - before)));
                times.push(end);
            }
            before = end;
        }
        Moments { times, parts: None, every, within: parts.len() }
    }
}

/// The parts at which an accepted step is looked into.
pub fn own_parts() -> [f64; OF_ACCEPTED] {
    golden::<OF_ACCEPTED>()
}

/// So many parts of a step: of all irrational numbers this one's multiples lie the most evenly.
fn golden<const N: usize>() -> [f64; N] {
    let golden = 0.5 * (f64::sqrt(5.0) - 1.0);
    let mut parts = [0.0; N];
    (1..).zip(&mut parts).for_each(|(k, part)| *part = (f64::from(k) * golden).fract());
    parts.sort_by(f64::total_cmp);
    parts
}

/// The parts of one step from a time on, of length `h`, at which the moments lie: without its end.
pub fn inside(times: &[f64], from: f64, h: f64) -> impl Iterator<Item = f64> {
    let part = move |t: &f64| (t - from) / h;
    times.iter().map(part).take_while(|&part| part < 1.0 - SAME).filter(|&part| part > SAME)
}

/// The same with its end.
pub fn until(times: &[f64], from: f64, h: f64) -> impl Iterator<Item = f64> {
    let part = move |t: &f64| (t - from) / h;
    times.iter().map(part).take_while(|&part| part < 1.0 + SAME).map(|part| part.min(1.0))
}

/// Whether a moment is that of a step's end.
pub fn is_at(t: f64, end: f64, h: f64) -> bool {
    (t - end).abs() <= SAME * h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_is_looked_into_three_times_and_at_its_end() {
        let times = Moments::equal(3, 4.0).times;
        assert_eq!(times.len(), 4 * 160);
        assert!(times.is_sorted() && times.last() == Some(&4.0));
        // A run of half the steps sees all of them too: six within its step, and one in its middle.
        let h = 4.0 / 80.0;
        assert_eq!(inside(&times, 0.0, h).count(), 7);
        assert!(is_at(times[7], h, h));
        assert_eq!(until(&times, 0.0, h).last(), Some(1.0));
    }

    #[test]
    fn of_very_many_steps_every_so_manieth_is_looked_into() {
        let moments = Moments::equal(13, 1.0);
        assert_eq!(moments.every, 8);
        assert_eq!(moments.times.len() as u64, 4 * moments.parts.unwrap());
    }
}
