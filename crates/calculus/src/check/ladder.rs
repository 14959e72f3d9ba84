//! A ladder of steps along one direction, and what its differences say of a derivative.
//!
//! ```text
//! T_k = (f(+h_k) - f(-h_k)) / (2 h_k),    h_k = h_0 / 8^k          centred, error ~ h^2
//! R_k = T_k + (T_k - T_(k-1)) / 63                                 Richardson, error ~ h^4
//! bar_k = 2 |R_k - R_(k-1)| + 4 (N/h_k + eps L B_k) + max over j >= k of  h_j B_j  where B_j > 2 B_(j-1)
//! B_k = |f(+h_k) - 2 f(0) + f(-h_k)| / h_k^2                       bend, where it exceeds 8 N
//! ```
//! `N` noise of f: the largest jump `h |T_k - T_(k+1)|` among the smallest steps, and at least the
//! rounding `eps |f|`. The term with `L` is the rounding of the arguments, of that size. Where a
//! smaller step shows far more bend than the one before, f has a feature of that size, and on a larger
//! step the slope is known to the change `h B` that the feature makes in it and no better: |q|^1.5 at
//! 1e-9 is even over all steps that show anything. The estimate is
//! the R of the smallest bar that no smaller step contradicts; it does not look at the claim, so that
//! a wrong claim cannot pass because some step, too large or too small, happens to agree with it.
//! Where a function is sure of one slope over large steps and of another over small ones that may be its
//! rounding (a term like 1 - cos q near 0 stands still over them), a claim of either is left alone.
//!
//! Steps are powers of two and directions have few bits, so that `(q + h w) - q = h w` exactly and no
//! rounding of the step enters. Source: notes 2.5; Richardson (1911), Ridders (1982).

use super::differences::{Difference, Differences, ROUNDING};

/// From one step to the next smaller one.
const RATIO: f64 = 8.0;

/// How far rounding may exceed the estimate of it.
pub(super) const SAFETY: f64 = 4.0;

/// Configurations below this are at zero, but for rounding.
const ZERO: f64 = 1e-13;

/// A bend that grows by more than this from one step to the next smaller one is not resolved yet; that
/// of |q|^1.5 grows by 2.8, and of a smooth function it stays.
const GROWTH: f64 = 2.1;

/// One that grows by more than this may be noise, which makes it grow by 64; that of a kink grows by 8.
const NOISE: f64 = 12.0;

/// Second differences are seen above this many units of noise.
const SEEN: f64 = 8.0;

/// A function that changes by no more than this many units of noise stands still.
const STILL: f64 = 64.0;

/// Over steps below this part of the length large terms of the function, of which little is left in the
/// sum, may stand still: they confirm nothing.
const TINY: f64 = 1e-6;

/// A slope known within this many margins is one that a function is sure of.
const SURE: f64 = 200.0;

/// The sizes that the numbers of a configuration set.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// The length from which steps start.
    pub far: f64,
    /// The length at which q itself varies: at most `far`.
    pub near: f64,
    /// Up to this length a function that is frozen at small steps is believed at larger ones.
    pub believed: f64,
    /// The magnitude of the arguments that are rounded: the `L` above.
    pub arguments: f64,
    /// The magnitude of each of q's numbers.
    magnitudes: Vec<f64>,
}

impl Scale {
    /// The scale of a configuration `q`, in a problem of a given typical length or of one that is
    /// read off q: its magnitude, and 1. Numbers below a millionth may be displacements of a body of
    /// length 1 as well as places in a problem that is so small: steps are taken of both lengths.
    pub fn of(q: &[f64], length: Option<f64>) -> Self {
        let magnitudes: Vec<f64> = q.iter().map(|x| x.abs()).collect();
        let largest = magnitudes.iter().fold(0.0_f64, |m, x| m.max(*x));
        let (near, far) = match length {
            Some(length) => (length, length),
            None if largest > ZERO => (largest, largest.max(1.0)),
            None => (1.0, 1.0),
        };
        let believed = if largest > 1e-6 || length.is_some() { near } else { far };
        Scale { far, near, believed, arguments: largest.max(far), magnitudes }
    }

    fn largest(&self) -> f64 {
        self.magnitudes.iter().fold(0.0_f64, |m, x| m.max(*x))
    }

    /// The steps along a direction, descending: from a quarter of the length to what rounding leaves of
    /// the freedom that moves, or of all of them.
    pub fn steps(&self, w: &[f64]) -> Vec<f64> {
        let mut moving = w.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(i, _)| i);
        let alone = match (moving.next(), moving.next()) {
            // Where q stores other numbers than the freedoms, none of them stands for one.
            (Some(i), None) if w.len() == self.magnitudes.len() => self.magnitudes[i],
            _ => 0.0,
        };
        let size = if alone > 0.0 { alone.min(self.near) } else { self.near };
        // What moves, or where it stands still at zero the largest beside it, is rounded.
        let rounded = if alone > 0.0 { alone } else { self.largest() };
        let smallest = (size.max(rounded) * 2.0_f64.powi(-47)).max(f64::MIN_POSITIVE);
        let mut steps = vec![2.0_f64.powi(self.far.log2().floor() as i32 - 2)];
        while let Some(&h) = steps.last()
            && h / RATIO >= smallest
        {
            steps.push(h / RATIO);
        }
        steps
    }
}

/// A derivative by differences, within `bar` of the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    pub value: f64,
    pub bar: f64,
}

impl Estimate {
    /// Nothing is known: the function is not defined on both sides.
    pub(super) const NONE: Estimate = Estimate { value: 0.0, bar: f64::INFINITY };
}

/// The values of m functions at the steps of a ladder, on both sides.
#[derive(Debug)]
pub(super) struct Ladder<'a> {
    scale: &'a Scale,
    steps: Vec<f64>,
    centre: Vec<f64>,
    sides: Vec<[Vec<f64>; 2]>,
}

/// One step, for one of the functions.
#[derive(Clone, Copy, Debug)]
struct Rung {
    h: f64,
    /// T, the centred difference.
    slope: f64,
    /// The second difference, `|f''|`.
    bend: f64,
    /// The larger magnitude of f on the two sides.
    magnitude: f64,
    /// The smaller change of f from the centre: zero where f stands still on a side.
    change: f64,
}

/// A rung's estimate.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    h: f64,
    estimate: Estimate,
    /// The change of f over the step, in units of its noise.
    change: f64,
}

impl Candidate {
    fn contradicts(&self, other: &Candidate) -> bool {
        let (a, b) = (self.estimate, other.estimate);
        (a.value - b.value).abs() > a.bar + b.bar
    }
}

impl<'a> Ladder<'a> {
    /// Evaluates the functions at 0 and at each step along w to either side.
    pub fn climb(scale: &'a Scale, w: &[f64], value: impl Fn(f64) -> Vec<f64>) -> Self {
        let steps = scale.steps(w);
        let sides = steps.iter().map(|&h| [value(h), value(-h)]).collect();
        Ladder { scale, steps, centre: value(0.0), sides }
    }

    /// The derivative of function `i` at 0.
    pub fn estimate(&self, i: usize) -> Estimate {
        best(&self.candidates(i)).map_or(Estimate::NONE, |best| best.estimate)
    }

    /// The derivative of function `i` at 0, and how many times a claim of it is farther off than
    /// `margin` and the bar allow; 0 where it is not.
    pub fn judge(&self, i: usize, claimed: f64, margin: f64) -> (Estimate, f64) {
        let candidates = self.candidates(i);
        let Some(best) = best(&candidates) else {
            return (Estimate::NONE, 0.0);
        };
        let off = |candidate: &Candidate| (claimed - candidate.estimate.value).abs();
        let agrees = |candidate: &Candidate| off(candidate) <= margin + candidate.estimate.bar;
        let sure = |candidate: &Candidate| {
            let steps = best.h..=self.scale.believed;
            steps.contains(&candidate.h) && candidate.estimate.bar <= SURE * margin
        };
        let excused = |other: &Candidate| other.contradicts(best) && sure(other) && agrees(other);
        let near = |a: f64, b: f64| (a - b).abs() <= 0.25 * off(best);
        let confirms = |other: &Candidate| {
            let Estimate { value, bar } = other.estimate;
            let is_another = other.h != best.h && other.h >= TINY * self.scale.far;
            is_another && near(value, best.estimate.value) && near(bar, 0.0)
        };
        let may_be_rounding = best.change <= STILL || !candidates.iter().any(confirms);
        let right = agrees(best) || may_be_rounding && candidates.iter().any(excused);
        let excess = if right { 0.0 } else { off(best) / (margin + best.estimate.bar) };
        (best.estimate, excess)
    }

    /// An estimate for each step but the largest.
    fn candidates(&self, i: usize) -> Vec<Candidate> {
        let rungs = self.rungs(i);
        let noise = self.noise(i, &rungs);
        let features = self.features(&rungs, noise);
        let mut previous = rungs.first().map_or(0.0, |rung| rung.slope);
        let candidate = |(pair, feature): (&[Rung], &f64)| {
            let [large, small] = [pair[0], pair[1]];
            let value = small.slope + (small.slope - large.slope) / (RATIO * RATIO - 1.0);
            let truncation = 2.0 * (value - previous).abs();
            let bar = truncation + self.rounding(&small, noise) + feature;
            previous = value;
            let change = small.change / noise.max(f64::EPSILON * small.magnitude);
            Candidate { h: small.h, estimate: Estimate { value, bar }, change }
        };
        rungs.windows(2).zip(&features).map(candidate).collect()
    }

    /// For each step but the largest, how much the slope changes over features that no larger step
    /// resolves, its own included.
    fn features(&self, rungs: &[Rung], noise: f64) -> Vec<f64> {
        // How the bend grows, where it is seen.
        let growth = |pair: &[Rung]| {
            let [large, small] = [pair[0], pair[1]];
            let arguments = f64::EPSILON * self.scale.arguments * small.slope.abs();
            let unseen = SEEN * (noise.max(f64::EPSILON * small.magnitude) + arguments);
            (small.bend * small.h * small.h > unseen).then_some(small.bend / large.bend)
        };
        let growths: Vec<Option<f64>> = rungs.windows(2).map(growth).collect();
        let is_signal = |k: usize| growths.get(k).copied().flatten().is_some_and(|g| g < NOISE);
        let grows = |k: usize| growths[k].is_some_and(|growth| growth > GROWTH);
        let mut features: Vec<f64> = (0..growths.len())
            .map(|k| {
                let is_feature = grows(k) && (is_signal(k) || is_signal(k + 1));
                if is_feature { rungs[k + 1].bend * rungs[k + 1].h } else { 0.0 }
            })
            .collect();
        for k in (1..features.len()).rev() {
            features[k - 1] = features[k - 1].max(features[k]);
        }
        features
    }

    /// The errors of both differences of function `i` against a claim, relative to `largest`.
    pub fn differences(&self, i: usize, claimed: f64, largest: f64) -> Differences {
        let rungs = self.rungs(i);
        let noise = self.noise(i, &rungs);
        let size = if largest > 0.0 { largest } else { 1.0 };
        let first = self.sides.len() - rungs.len();
        let row = |(rung, [plus, _]): (&Rung, &[Vec<f64>; 2])| Difference {
            step: rung.h,
            forward: ((plus[i] - self.centre[i]) / rung.h - claimed).abs() / size,
            centred: (rung.slope - claimed).abs() / size,
            rounding: self.rounding(rung, noise).max(ROUNDING * rung.magnitude / rung.h) / size,
        };
        Differences { rows: rungs.iter().zip(&self.sides[first..]).map(row).collect() }
    }

    /// The steps from the largest below which the function is finite on both sides.
    fn rungs(&self, i: usize) -> Vec<Rung> {
        let bad = |[plus, minus]: &[Vec<f64>; 2]| !(plus[i].is_finite() && minus[i].is_finite());
        let first = self.sides.iter().rposition(bad).map_or(0, |k| k + 1);
        let centre = self.centre[i];
        let rung = |(&h, [plus, minus]): (&f64, &[Vec<f64>; 2])| {
            let (plus, minus) = (plus[i], minus[i]);
            Rung {
                h,
                slope: (plus - minus) / (2.0 * h),
                bend: (plus - 2.0 * centre + minus).abs() / (h * h),
                magnitude: plus.abs().max(minus.abs()),
                change: (plus - centre).abs().min((minus - centre).abs()),
            }
        };
        self.steps.iter().zip(&self.sides).skip(first).map(rung).collect()
    }

    /// The noise of function `i`: how far its values are from those of a smooth function.
    fn noise(&self, i: usize, rungs: &[Rung]) -> f64 {
        let small = self.scale.far * 2.0_f64.powi(-12);
        let moves = |rung: &Rung| rung.change > 0.0;
        let jump = |pair: &[Rung]| pair[1].h * (pair[0].slope - pair[1].slope).abs();
        let seen = rungs.windows(2).filter(|pair| pair[0].h <= small && moves(&pair[0]));
        let jumps: Vec<f64> = seen.rev().take(3).map(jump).collect();
        // Truncation shrinks a jump by 8^3 from step to step, noise does not.
        let jumps = match jumps[..] {
            [small, middle, large] if large > 64.0 * middle && middle > 64.0 * small => small,
            _ => jumps.into_iter().fold(0.0, f64::max),
        };
        // Where f stands still on both sides below some small step, its values are multiples of a
        // quantum; where it stands still from a large step on, nothing acts.
        let still = rungs.iter().rposition(moves).map_or(0, |k| k + 1);
        let frozen = rungs.get(still).is_some_and(|rung| rung.h <= small);
        let quantum = rungs.iter().map(|rung| rung.change).filter(|&change| change > 0.0);
        let quantum = if frozen { quantum.fold(f64::INFINITY, f64::min) } else { 0.0 };
        // Numbers below the normal ones are multiples of a smallest one.
        let rounding = f64::EPSILON * self.centre[i].abs().max(f64::MIN_POSITIVE);
        rounding.max(jumps).max(if quantum.is_finite() { quantum } else { 0.0 })
    }

    /// What rounding, of the values and of the arguments, may contribute to a difference.
    fn rounding(&self, rung: &Rung, noise: f64) -> f64 {
        let values = noise.max(f64::EPSILON * rung.magnitude) / rung.h;
        SAFETY * (values + f64::EPSILON * self.scale.arguments * rung.bend)
    }
}

/// The candidate of the smallest bar that no smaller step contradicts.
fn best(candidates: &[Candidate]) -> Option<&Candidate> {
    let contradicted =
        |k: usize| candidates[k + 1..].iter().any(|smaller| smaller.contradicts(&candidates[k]));
    (0..candidates.len())
        .filter(|&k| candidates[k].estimate.bar.is_finite() && !contradicted(k))
        .map(|k| &candidates[k])
        .min_by(|a, b| a.estimate.bar.total_cmp(&b.estimate.bar))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_measure::SplitMix64;

    fn slope_of(f: impl Fn(f64) -> f64, q: f64) -> Estimate {
        let scale = Scale::of(&[q], None);
        Ladder::climb(&scale, &[1.0], |s| vec![f(q + s)]).estimate(0)
    }

    #[test]
    fn steps_are_taken_exactly() {
        let mut random = SplitMix64::new(5);
        for size in [0.0, 1e-12, 1e-3, 1.0, 7.0, 1e8] {
            let q = size * random.symmetric();
            let exact = |h: f64, w: f64| (q + h * w) - q == h * w || (h * w).abs() >= q.abs() / 8.0;
            for h in Scale::of(&[q], None).steps(&[1.0]) {
                assert!([1.0, 0.5625, 0.9375].into_iter().all(|w| exact(h, w)), "{q} {h}");
            }
        }
    }

    #[test]
    fn a_smooth_function_is_differentiated_to_nine_digits_and_the_bar_is_honest() {
        type Case = (fn(f64) -> f64, fn(f64) -> f64);
        let cases: [Case; 5] = [
            (f64::sin, f64::cos),
            (f64::exp, f64::exp),
            (|x| (1.0 + x * x).sqrt(), |x| x / (1.0 + x * x).sqrt()),
            (|x| x.powi(3), |x| 3.0 * x * x),
            (|x| 1.0 / (x + 3.0), |x| -1.0 / (x + 3.0).powi(2)),
        ];
        let mut random = SplitMix64::new(3);
        for (f, df) in cases {
            for _ in 0..200 {
                let q = 2.0 * random.symmetric();
                let Estimate { value, bar } = slope_of(f, q);
                assert!(bar < 1e-9 * (1.0 + value.abs()), "{q} {bar}");
                assert!((value - df(q)).abs() <= bar, "{q} {} {bar}", value - df(q));
            }
        }
    }

    #[test]
    fn a_function_without_truncation_error_is_differentiated_at_its_largest_steps() {
        assert_eq!(slope_of(|_| 5.0, 0.3).value, 0.0);
        for scale in [1e-12, 1.0, 1e12] {
            let Estimate { value, bar } = slope_of(|x| scale * (3.0 * x + 1.0), 0.3);
            assert!((value - 3.0 * scale).abs() <= bar && bar < 1e-12 * scale);
        }
    }

    #[test]
    fn far_from_zero_a_bounded_function_is_not_taken_for_a_constant() {
        // The constant hides the function at small steps, and over large ones it averages out.
        let q = 1e8;
        let Estimate { value, bar } = slope_of(|x| 1e9 + x.sin(), q);
        assert!((value - q.cos()).abs() <= bar && bar < 1e-3, "{value} {bar}");
    }

    #[test]
    fn features_far_smaller_than_the_configuration_need_a_length() {
        let (q, f) = (1e8, |x: f64| (1e3 * x).sin());
        let scale = Scale::of(&[q], Some(1e-3));
        let Estimate { value, bar } = Ladder::climb(&scale, &[1.0], |s| vec![f(q + s)]).estimate(0);
        assert!((value - 1e3 * (1e3 * q).cos()).abs() <= bar && bar < 1.0, "{value} {bar}");
    }

    #[test]
    fn a_function_that_stands_still_below_some_step_is_known_to_be_coarse() {
        let Estimate { value, bar } = slope_of(|x| (x + 1e8) - 1e8, 0.3);
        assert!((value - 1.0).abs() <= bar && bar < 1e-4, "{value} {bar}");
    }

    #[test]
    fn a_contact_out_of_reach_does_not_hide_that_nothing_acts() {
        let Estimate { value, bar } = slope_of(|x| (x - 0.4).max(0.0).powi(2), 0.3);
        assert!(value == 0.0 && bar < 1e-300, "{value} {bar}");
    }

    #[test]
    fn where_the_function_ends_smaller_steps_are_taken() {
        let Estimate { value, bar } = slope_of(f64::ln, 1e-5);
        assert!((value - 1e5).abs() <= bar && bar < 1e-2, "{value} {bar}");
        assert_eq!(slope_of(f64::sqrt, 0.0), Estimate::NONE);
    }
}
