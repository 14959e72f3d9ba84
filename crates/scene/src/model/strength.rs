//! How strong something is in time: constant, in steps and ramps, from a table, or a sine.
//!
//! ```text
//! pieces    straight between knots (t_i, s_i), constant before the first and after the last;
//!           two knots at one time are a jump, and the later one holds there
//! sine      s = offset + amplitude sin(2 pi frequency t + phase)
//! mean over [a, b]     1/(b - a) int_a^b s dt     in closed form
//! ```
//! Whoever steps takes means over a step: then a pulse that is shorter than a step is not missed, and its
//! impulse is exact.

use serde::Serialize;
use stationary_calculus::Number;
use std::f64::consts::TAU;

/// A function of time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Strength {
    /// Straight between knots.
    Pieces(Pieces),
    /// About an offset, as often in a unit of time as the frequency says.
    Sine {
        /// Half of what it swings.
        amplitude: f64,
        /// Swings in a unit of time.
        frequency: f64,
        /// The angle at time zero, radians.
        phase: f64,
        /// The mean.
        offset: f64,
    },
}

/// Knots of a function that is straight between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pieces {
    knots: Vec<[f64; 2]>,
    /// From the first knot to each.
    #[serde(skip)]
    integrals: Vec<f64>,
}

impl Pieces {
    /// The function through these knots, times and values, of which there is one at least and whose times
    /// do not fall.
    pub(crate) fn new(knots: Vec<[f64; 2]>) -> Self {
        let mut integrals = Vec::with_capacity(knots.len());
        let mut sum = 0.0;
        for (k, knot) in knots.iter().enumerate() {
            if let Some(last) = k.checked_sub(1).map(|last| knots[last]) {
                sum += 0.5 * (knot[0] - last[0]) * (knot[1] + last[1]);
            }
            integrals.push(sum);
        }
        Pieces { knots, integrals }
    }

    /// The last knot whose time is not after `t`; none before the first.
    fn last(&self, t: f64) -> Option<usize> {
        self.knots.partition_point(|knot| knot[0] <= t).checked_sub(1)
    }

    /// Value, rate and integral from the first knot at a time.
    fn at(&self, t: f64) -> [f64; 3] {
        let [first, last] = [self.knots[0], self.knots[self.knots.len() - 1]];
        match self.last(t) {
            None => [first[1], 0.0, (t - first[0]) * first[1]],
            Some(k) => match self.knots.get(k + 1) {
                None => [last[1], 0.0, self.integrals[k] + (t - last[0]) * last[1]],
                Some(&[end, there]) => {
                    let [start, here] = self.knots[k];
                    let rate = (there - here) / (end - start);
                    let (since, value) = (t - start, here + rate * (t - start));
                    [value, rate, self.integrals[k] + 0.5 * since * (here + value)]
                }
            },
        }
    }
}

impl Strength {
    /// The same at all times.
    pub(crate) fn constant(value: f64) -> Self {
        Strength::Pieces(Pieces::new(vec![[0.0, value]]))
    }

    /// The value at a time.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Strength::Pieces(pieces) => pieces.at(t)[0],
            &Strength::Sine { amplitude, frequency, phase, offset } => {
                offset + amplitude * (TAU * frequency * t + phase).sin()
            }
        }
    }

    /// How fast it changes at a time.
    pub fn rate(&self, t: f64) -> f64 {
        match self {
            Strength::Pieces(pieces) => pieces.at(t)[1],
            &Strength::Sine { amplitude, frequency, phase, .. } => {
                let omega = TAU * frequency;
                amplitude * omega * (omega * t + phase).cos()
            }
        }
    }

    /// How fast its rate changes at a time; between knots it does not.
    pub(crate) fn curvature(&self, t: f64) -> f64 {
        match self {
            Strength::Pieces(_) => 0.0,
            &Strength::Sine { amplitude, frequency, phase, .. } => {
                let omega = TAU * frequency;
                -amplitude * omega * omega * (omega * t + phase).sin()
            }
        }
    }

    /// The least and the largest value between two times, jumps there included.
    pub(crate) fn range(&self, a: f64, b: f64) -> [f64; 2] {
        let ends = [self.at(a), self.at(b)];
        let mut range = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let mut widen = |value: f64| range = [range[0].min(value), range[1].max(value)];
        match self {
            Strength::Pieces(Pieces { knots, .. }) => {
                let within = |knot: &&[f64; 2]| a <= knot[0] && knot[0] <= b;
                knots.iter().filter(within).for_each(|knot| widen(knot[1]));
            }
            &Strength::Sine { amplitude, frequency, phase, offset } => {
                // Crests and troughs in half turns, of which two are enough.
                let turns = |t: f64| (TAU * frequency * t + phase) / (0.5 * TAU) - 0.5;
                let [first, last] = [turns(a).min(turns(b)).ceil(), turns(a).max(turns(b))];
                for half in [first, first + 1.0].into_iter().filter(|half| *half <= last) {
                    let sign = if half.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
                    widen(offset + sign * amplitude);
                }
            }
        }
        range
    }

    /// By how much it leaves its mean between two times at most.
    pub(crate) fn swing(&self, a: f64, b: f64) -> f64 {
        let ([least, most], mean) = (self.range(a, b), self.mean(a, b));
        (mean - least).max(most - mean).max(0.0)
    }

    /// The same of how fast its rate changes, but for jumps of the rate.
    pub(crate) fn swing_of_curvature(&self, a: f64, b: f64) -> f64 {
        match self {
            Strength::Pieces(_) => 0.0,
            Strength::Sine { frequency, .. } => (TAU * frequency).powi(2) * self.swing(a, b),
        }
    }

    /// The largest size of it between two times.
    pub(crate) fn largest(&self, a: f64, b: f64) -> f64 {
        self.range(a, b).into_iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    /// No less than the size of its rate between two times, and than that of how fast this changes but for jumps.
    pub(crate) fn fastest(&self, a: f64, b: f64) -> [f64; 2] {
        match self {
            Strength::Pieces(Pieces { knots, .. }) => {
                let within = |pair: &&[[f64; 2]]| pair[0][0] < b && a < pair[1][0];
                let pieces = knots.windows(2).filter(within);
                let rates = pieces.map(|p| ((p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).abs());
                [rates.fold(0.0, f64::max), 0.0]
            }
            &Strength::Sine { amplitude, frequency, .. } => {
                let (size, omega) = (amplitude.abs(), TAU * frequency.abs());
                [size * omega, size * omega * omega]
            }
        }
    }

    /// The integral from `a` to `b`.
    pub fn integral(&self, a: f64, b: f64) -> f64 {
        match self {
            Strength::Pieces(pieces) => pieces.at(b)[2] - pieces.at(a)[2],
            &Strength::Sine { amplitude, frequency, phase, offset } => {
                // cos(x - y) - cos(x + y) = 2 sin x sin y, without cancellation where a and b are near.
                let (middle, half) = (0.5 * (a + b), 0.5 * TAU * frequency * (b - a));
                let part = if half == 0.0 { 1.0 } else { half.sin() / half };
                let swing = amplitude * (TAU * frequency * middle + phase).sin();
                (b - a) * (offset + swing * part)
            }
        }
    }

    /// The mean over an interval; the value where that is a moment.
    pub fn mean(&self, a: f64, b: f64) -> f64 {
        match self {
            Strength::Pieces(Pieces { knots, .. }) if knots.len() == 1 => knots[0][1],
            _ if a == b => self.at(a),
            _ => self.integral(a, b) / (b - a),
        }
    }

    /// The first time after `t` at which it is not smooth.
    pub(crate) fn next_corner(&self, t: f64) -> Option<f64> {
        match self {
            Strength::Pieces(Pieces { knots, .. }) if knots.len() > 1 => {
                knots.get(knots.partition_point(|knot| knot[0] <= t)).map(|knot| knot[0])
            }
            _ => None,
        }
    }

    /// The integral from time zero, with its first two derivatives.
    pub(crate) fn integral_of<R: Number>(&self, t: R) -> R {
        let now = t.re();
        let since = t - now;
        since * since * (0.5 * self.rate(now)) + since * self.at(now) + self.integral(0.0, now)
    }

    /// By how much it jumps at a time: what is only steep there does not.
    pub(crate) fn jump(&self, t: f64) -> f64 {
        jump_between([self.at(t.next_down()), self.at(t)])
    }

    /// By how much its rate jumps at a time.
    pub(crate) fn jump_of_rate(&self, t: f64) -> f64 {
        jump_between([self.rate(t.next_down()), self.rate(t)])
    }

    /// Whether it jumps at any time.
    pub(crate) fn jumps(&self) -> bool {
        match self {
            Strength::Pieces(Pieces { knots, .. }) => {
                knots.windows(2).any(|pair| pair[0][0] == pair[1][0] && pair[0][1] != pair[1][1])
            }
            Strength::Sine { .. } => false,
        }
    }

    /// The same with its sign turned.
    pub(crate) fn reversed(self) -> Self {
        match self {
            Strength::Pieces(Pieces { knots, .. }) => {
                Strength::Pieces(Pieces::new(knots.iter().map(|&[t, x]| [t, -x]).collect()))
            }
            Strength::Sine { amplitude, frequency, phase, offset } => {
                Strength::Sine { amplitude: -amplitude, frequency, phase, offset: -offset }
            }
        }
    }

    /// Whether it is the same at all times.
    pub fn is_constant(&self) -> bool {
        matches!(self, Strength::Pieces(Pieces { knots, .. }) if knots.len() == 1)
    }
}

/// A jump from one value to another, but for rounding.
fn jump_between([before, after]: [f64; 2]) -> f64 {
    let steep = 1e-9 * before.abs().max(after.abs());
    if (after - before).abs() > steep { after - before } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> [Strength; 4] {
        let pieces = |knots: &[[f64; 2]]| Strength::Pieces(Pieces::new(knots.to_vec()));
        [
            Strength::constant(3.0),
            pieces(&[[0.3, 1.0], [0.3, 5.0]]),
            pieces(&[[0.1, -1.0], [0.4, 2.0], [0.4, 0.0], [0.9, 7.0]]),
            Strength::Sine { amplitude: 2.0, frequency: 1.7, phase: 0.4, offset: -0.5 },
        ]
    }

    #[test]
    fn the_integral_is_that_of_the_values() {
        for strength in all() {
            for (a, b) in [(-0.5, 0.05), (0.0, 0.3), (0.2, 0.5), (-1.0, 2.0), (0.35, 0.41)] {
                // The midpoint rule of many cells, some of which have a jump in them.
                let cells = 200_000;
                let width = (b - a) / f64::from(cells);
                let middles = (0..cells).map(|k| a + (f64::from(k) + 0.5) * width);
                let sum: f64 = middles.map(|t| strength.at(t) * width).sum();
                let exact = strength.integral(a, b);
                assert!(
                    (sum - exact).abs() < 1e-4 * (b - a),
                    "{strength:?} {a} {b}: {sum} {exact}"
                );
                assert!((strength.mean(a, b) * (b - a) - exact).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_rate_is_that_of_the_values_where_they_are_smooth() {
        for strength in all() {
            for t in [-0.2, 0.15, 0.33, 0.6, 1.5] {
                let h = 1e-6;
                let slope = (strength.at(t + h) - strength.at(t - h)) / (2.0 * h);
                assert!((slope - strength.rate(t)).abs() < 1e-6, "{strength:?} at {t}");
            }
        }
    }

    #[test]
    fn bounds_over_an_interval_are_those_of_many_values() {
        for strength in all() {
            for (a, b) in [(-0.5, 0.05), (0.0, 0.3), (0.2, 0.5), (-1.0, 2.0), (0.35, 0.41)] {
                let times = (0..=4000).map(|k| a + (b - a) * f64::from(k) / 4000.0);
                let [low, high] = strength.range(a, b);
                let [mut least, mut most] = [f64::INFINITY, -f64::INFINITY];
                for t in times {
                    let s = strength.at(t);
                    (least, most) = (least.min(s), most.max(s));
                    assert!(strength.rate(t).abs() <= strength.fastest(a, b)[0] + 1e-12 || t == b);
                }
                assert!(low <= least && most <= high, "{strength:?} {a} {b}");
                // No wider but by what it changes between two of the values, and by a jump at an end.
                let between = strength.fastest(a, b)[0] * (b - a) / 4000.0 + 1e-12;
                let wider = between + if b == 0.3 { 4.0 } else { 0.0 };
                assert!(least - low < wider && high - most < wider, "{strength:?} {a} {b}");
            }
        }
    }

    #[test]
    fn a_swing_is_the_farthest_from_the_mean() {
        for strength in all() {
            for (a, b) in [(-0.5, 0.05), (0.0, 0.3), (0.2, 0.5), (-1.0, 2.0), (0.35, 0.36)] {
                let times = (0..=4000).map(|k| a + (b - a) * f64::from(k) / 4000.0);
                let off = times.map(|t| (strength.at(t) - strength.mean(a, b)).abs());
                let most = off.fold(0.0, f64::max);
                let between = strength.fastest(a, b)[0] * (b - a) / 4000.0 + 1e-12;
                // A jump at the end itself is of the step.
                let wider = between + if b == 0.3 { 4.0 } else { 0.0 };
                let swing = strength.swing(a, b);
                assert!(swing >= most - 1e-12 && swing < most + wider, "{strength:?} {a} {b}");
            }
        }
        let sine = &all()[3];
        let farthest = (0..=4000).map(|k| 0.2 + 0.1 * f64::from(k) / 4000.0);
        let mean = (sine.rate(0.3) - sine.rate(0.2)) / 0.1;
        let off = farthest.map(|t| (sine.curvature(t) - mean).abs()).fold(0.0, f64::max);
        assert!((sine.swing_of_curvature(0.2, 0.3) / off - 1.0).abs() < 1e-3, "{off}");
    }

    #[test]
    fn at_a_jump_the_later_value_holds_and_its_time_is_a_corner() {
        let [_, step, table, _] = all();
        assert_eq!((step.at(0.3), step.at(0.3 - 1e-15)), (5.0, 1.0));
        assert_eq!(step.next_corner(0.0), Some(0.3));
        assert_eq!(step.next_corner(0.3), None);
        assert_eq!(table.next_corner(0.1), Some(0.4));
        assert_eq!((step.jump(0.3), table.jump(0.1)), (4.0, 0.0));
        assert!((table.jump(0.4) + 2.0).abs() < 1e-14, "{}", table.jump(0.4));
    }
}
