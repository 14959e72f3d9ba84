//! What a run did at all its samples, read off between them by polynomials where these resolve it.
//!
//! ```text
//! x(t) = sum_k l_k(t) x_k       Lagrange, by the 8, 12 or 16 samples around t
//! off  = |x(t) - y(t)|          y by one and by two fewer of them, the larger; as many as make this the least
//! ```
//! `x_k` the run at equal distances in time, mostly the ends of its steps. A motion that is smooth and
//! sampled often enough is known between the samples far better than the tolerance: then no step need be
//! taken again in parts. Where `off` is too large, as around an impact, nothing is said.

use crate::look::Look;
use crate::measured::{distance, norm};
use crate::samples::Samples;

/// Samples that polynomials go through, and so many fewer to see how well they do: where one of these comes near
/// by chance, the other does not.
const POINTS: [usize; 3] = [8, 12, 16];
const FEWER: [usize; 2] = [1, 2];
/// How much nearer more samples must come.
const SHRINKS: f64 = 8.0;
/// What a polynomial at the end of its samples makes of their rounding.
const ROUNDING: f64 = 1e-12;

/// A whole run at its samples, the horizon in equal parts.
#[derive(Clone, Debug)]
pub struct Track {
    /// From one sample to the next.
    spacing: f64,
    samples: Samples,
    kinetic: f64,
    told: f64,
}

/// What was read off, and how far it may be off.
pub struct Reading {
    /// The run at the moments.
    pub look: Look,
    /// The largest distance of the observable by fewer samples.
    pub off: f64,
}

impl Track {
    /// That of a run to its end; nothing where samples are too few.
    pub fn of(samples: Samples, told: f64, horizon: f64) -> Option<Self> {
        let (kinetic, count) = (samples.kinetic(samples.len()), samples.len());
        let spacing = horizon / count.checked_sub(1)? as f64;
        (count > POINTS[0]).then_some(Track { spacing, samples, kinetic, told })
    }

    /// Whether it was sampled so many times in its horizon, or more often by a whole factor.
    pub fn has(&self, parts: u64) -> bool {
        (self.samples.len() as u64 - 1).is_multiple_of(parts)
    }

    /// The run at moments in the order of time, the start before them.
    pub fn read(&self, times: &[f64]) -> Reading {
        let (mut row, mut off) = (self.samples.row(0).to_vec(), 0.0_f64);
        let mut read = self.samples.like();
        read.push_row(&row);
        for &t in times {
            off = off.max(self.at(t, &mut row));
            read.push_row(&row);
        }
        let look = Look { kinetic: self.kinetic, told: self.told, ..Look::of(&read, 0) };
        Reading { look, off }
    }

    /// The numbers at a moment, and how far those of the observable may be off: by ever more samples, as long
    /// as these differ the less from two fewer of them.
    fn at(&self, t: f64, row: &mut [f64]) -> f64 {
        let last = self.samples.len() - 1;
        let place = (t / self.spacing).clamp(0.0, last as f64);
        let nearest = place.round() as usize;
        if (place - nearest as f64).abs() < 1e-6 {
            row.copy_from_slice(self.samples.row(nearest));
            return 0.0;
        }
        let (mut fewer, mut more) = (vec![0.0; row.len()], vec![0.0; row.len()]);
        // What is observed, and what stands beside it, which may move faster.
        let columns = self.samples.columns();
        let parts = [0..columns, columns..row.len()];
        let mut least = [f64::INFINITY; 2];
        for points in POINTS.into_iter().filter(|points| *points <= last) {
            self.lagrange(place, points, &mut more);
            let mut off = [0.0_f64; 2];
            for left_out in FEWER {
                self.lagrange(place, points - left_out, &mut fewer);
                for (part, off) in parts.iter().zip(&mut off) {
                    *off = off.max(distance(&fewer[part.clone()], &more[part.clone()]));
                }
            }
            for ((part, least), off) in parts.iter().zip(&mut least).zip(off) {
                // What is smooth and sampled often enough is told far better by more of them.
                if least.is_infinite() || SHRINKS * off < *least {
                    let more = &more[part.clone()];
                    *least = off.max(ROUNDING * norm(more));
                    row[part.clone()].copy_from_slice(more);
                }
            }
        }
        least[0]
    }

    /// The polynomial through so many of the samples around a place, there: `sum_k w_k x_k / sum_k w_k` with
    /// `w_k = (-1)^k binomial(points - 1, k) / (place - k)`.
    fn lagrange(&self, place: f64, points: usize, row: &mut [f64]) {
        let count = self.samples.len();
        let first = (place as usize + 1).saturating_sub(points / 2).min(count - points);
        let (x, degree) = (place - first as f64, points - 1);
        let (mut binomial, mut sum) = (1.0, 0.0);
        row.fill(0.0);
        for k in 0..points {
            let weight = binomial / (x - k as f64);
            sum += weight;
            let sample = self.samples.row(first + k);
            row.iter_mut().zip(sample).for_each(|(row, x)| *row += weight * x);
            binomial *= -((degree - k) as f64) / (k + 1) as f64;
        }
        row.iter_mut().for_each(|row| *row /= sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(samples: usize, x: impl Fn(f64) -> f64) -> Track {
        let mut rows = Samples::default();
        (0..samples).for_each(|k| rows.push(&[x(k as f64 / (samples - 1) as f64)], None, &[]));
        Track::of(rows, 0.0, 1.0).unwrap()
    }

    fn error(track: &Track, x: impl Fn(f64) -> f64) -> [f64; 2] {
        let times: Vec<f64> = (1..=997).map(|k| f64::from(k) / 997.0).collect();
        let reading = track.read(&times);
        let rows = reading.look.values.iter().skip(1);
        let errors = times.iter().zip(rows).map(|(&t, row)| (row[0] - x(t)).abs());
        [errors.fold(0.0, f64::max), reading.off]
    }

    #[test]
    fn a_smooth_motion_is_known_between_its_samples_better_than_fewer_of_them_tell() {
        // Ten turns: 10, 20 and 40 samples in each.
        for (samples, most) in [(101, 2e-2), (201, 2e-4), (401, 1e-6)] {
            let wave = |t: f64| (20.0 * std::f64::consts::PI * t + 0.3).sin();
            let [error, off] = error(&track(samples, wave), wave);
            assert!(error <= off && off < most, "{samples}: {error:e} {off:e}");
        }
    }

    #[test]
    fn waves_that_samples_hardly_resolve_come_near_by_chance_in_no_place() {
        // Three to ten samples in each turn; near an end polynomials are the worst.
        let mut worst = 0.0_f64;
        for k in 0..4000 {
            let part = |rate: f64| (f64::from(k) * rate).fract();
            let [turns, phase, place] = [2_f64.sqrt(), 3_f64.sqrt(), 5_f64.sqrt()].map(part);
            let turns = 10.0 + 23.0 * turns;
            let wave = |t: f64| (std::f64::consts::TAU * (turns * t + phase)).sin();
            let t = if k % 2 == 0 { 1.0 - 0.01 * place } else { place };
            let reading = track(101, wave).read(&[t]);
            let error = (reading.look.values[1][0] - wave(t)).abs();
            // What is told to be known is.
            if reading.off < 1e-2 {
                worst = worst.max(error / reading.off);
            }
        }
        assert!(worst < 10.0, "{worst}");
    }

    #[test]
    fn a_kink_is_seen_and_the_ends_of_steps_are_as_they_are() {
        let kink = |t: f64| (t - 0.501).abs();
        let [error, off] = error(&track(101, kink), kink);
        assert!(off > 1e-4 && error < 20.0 * off, "{error:e} {off:e}");
        let reading = track(101, kink).read(&[0.25, 0.5, 1.0]);
        assert_eq!(reading.off, 0.0);
        assert_eq!(reading.look.values[2], [kink(0.5)]);
    }
}
