//! What a run did at all its samples, read off between them by polynomials where these resolve it.
//!
//! ```text
//! x(t) = sum_k l_k(t) x_k       Lagrange, by the 8 samples around t
//! off  = |x(t) - y(t)|          y by the 6 nearest of them
//! ```
//! `x_k` the run at equal distances in time, mostly the ends of its steps. A motion that is smooth and
//! sampled often enough is known between the samples far better than the tolerance: then no step need be
//! taken again in parts. Where `off` is too large, as around an impact, nothing is said.

use stationary_scene::{Motion, Run, Scene};

use super::look::{Look, PLACES};
use super::model::{Model, Sight};
use super::run::distance;

/// Samples that a polynomial goes through, and fewer ones to see how well it does.
const POINTS: usize = 8;
const FEWER: usize = 6;

/// A whole run at its samples.
#[derive(Clone, Debug)]
pub struct Track {
    /// From one sample to the next.
    spacing: f64,
    /// Numbers of the observable.
    columns: usize,
    /// Numbers a sample: the observable, the energy where there is one, places.
    width: usize,
    /// Sample after sample.
    rows: Vec<f64>,
    has_energy: bool,
    kinetic: f64,
    momenta: [f64; 2],
}

/// What was read off, and how far it may be off.
pub struct Reading {
    /// The run at the moments.
    pub look: Look,
    /// The largest distance of the observable by fewer samples.
    pub off: f64,
}

impl Track {
    /// That of a run to its end; nothing where steps are joined by lines, or samples are too few.
    pub fn of(run: &Run, model: &Model) -> Option<Self> {
        let scene = run.scene();
        let samples = run.times().len();
        let breaks = scene.rods().iter().any(|rod| rod.strength.is_finite());
        let spacing = scene.timing().horizon() / samples.checked_sub(1)? as f64;
        let is_equal = |(k, t): (usize, &f64)| (t - k as f64 * spacing).abs() <= 1e-6 * spacing;
        if breaks || samples <= POINTS || !run.times().iter().enumerate().all(is_equal) {
            return None;
        }
        let has_energy = scene.heat().is_none();
        let energies = if has_energy { run.energies() } else { Vec::new() };
        let (d, moved) = (scene.dimension(), moved(model));
        let mut rows = Vec::new();
        for sample in 0..samples {
            rows.extend(run.observed(sample));
            rows.extend(energies.get(sample));
            let places = run.positions(sample);
            moved.iter().for_each(|&k| rows.extend(&places[d * k..d * (k + 1)]));
        }
        Some(Track {
            spacing,
            columns: run.observed(0).len(),
            width: rows.len() / samples,
            rows,
            has_energy,
            kinetic: run.kinetic_energies().iter().copied().fold(0.0, f64::max),
            momenta: run.momentum_scales(),
        })
    }

    fn samples(&self) -> usize {
        self.rows.len() / self.width
    }

    fn row(&self, sample: usize) -> &[f64] {
        &self.rows[self.width * sample..self.width * (sample + 1)]
    }

    /// Whether it was sampled so many times in its horizon, or more often by a whole factor.
    pub fn has(&self, parts: u64) -> bool {
        (self.samples() as u64 - 1).is_multiple_of(parts)
    }

    /// The run at moments in the order of time, the start before them.
    pub fn read(&self, times: &[f64]) -> Reading {
        let (mut row, mut off) = (vec![0.0; self.width], 0.0_f64);
        let mut rows = Vec::with_capacity(times.len() + 1);
        rows.push(self.row(0).to_vec());
        for &t in times {
            off = off.max(self.at(t, &mut row));
            rows.push(row.clone());
        }
        let skipped = self.columns + usize::from(self.has_energy);
        let energies = rows.iter().map(|row| row[self.columns]);
        let look = Look {
            energies: if self.has_energy { energies.collect() } else { Vec::new() },
            kinetic: self.kinetic,
            is_own: vec![true; rows.len()],
            places: rows.iter().map(|row| row[skipped..].to_vec()).collect(),
            values: rows.iter().map(|row| row[..self.columns].to_vec()).collect(),
            momenta: self.momenta,
            work: 0,
        };
        Reading { look, off }
    }

    /// The numbers at a moment, and how far those of the observable may be off.
    fn at(&self, t: f64, row: &mut [f64]) -> f64 {
        let last = self.samples() - 1;
        let place = (t / self.spacing).clamp(0.0, last as f64);
        let nearest = place.round() as usize;
        if (place - nearest as f64).abs() < 1e-6 {
            row.copy_from_slice(self.row(nearest));
            return 0.0;
        }
        let first =
            |points: usize| (place as usize + 1).saturating_sub(points / 2).min(last + 1 - points);
        let add = |row: &mut [f64], first: usize, points: usize| {
            row.fill(0.0);
            let x = place - first as f64;
            for k in 0..points {
                let others = (0..points).filter(|&j| j != k);
                let weight: f64 = others.map(|j| (x - j as f64) / (k as f64 - j as f64)).product();
                row.iter_mut().zip(self.row(first + k)).for_each(|(sum, x)| *sum += weight * x);
            }
        };
        let mut fewer = vec![0.0; self.columns];
        add(&mut fewer, first(FEWER), FEWER);
        add(row, first(POINTS), POINTS);
        distance(&fewer, &row[..self.columns])
    }
}

/// The first things that move, whose places are compared; none of what stands for something else.
fn moved(model: &Model) -> Vec<usize> {
    match model.sight {
        Sight::AsWritten | Sight::Contact { .. } | Sight::Springs { .. } => {
            moving(&model.scene).take(PLACES).collect()
        }
        _ => Vec::new(),
    }
}

/// What is not pinned, by number.
pub fn moving(scene: &Scene) -> impl Iterator<Item = usize> {
    let moves =
        |(_, particle): &(usize, &stationary_scene::Particle)| particle.motion != Motion::Pinned;
    scene.particles().iter().enumerate().filter(moves).map(|(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(samples: usize, x: impl Fn(f64) -> f64) -> Track {
        let spacing = 1.0 / (samples - 1) as f64;
        Track {
            spacing,
            columns: 1,
            width: 1,
            rows: (0..samples).map(|k| x(k as f64 * spacing)).collect(),
            has_energy: false,
            kinetic: 0.0,
            momenta: [0.0; 2],
        }
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
    fn a_kink_is_seen_and_the_ends_of_steps_are_as_they_are() {
        let kink = |t: f64| (t - 0.501).abs();
        let [error, off] = error(&track(101, kink), kink);
        assert!(off > 1e-4 && error < 20.0 * off, "{error:e} {off:e}");
        let reading = track(101, kink).read(&[0.25, 0.5, 1.0]);
        assert_eq!(reading.off, 0.0);
        assert_eq!(reading.look.values[2], [kink(0.5)]);
    }
}
