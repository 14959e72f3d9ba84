//! What a run does at the moments of a grid: the observable, its energies, and places of its things.

use crate::ladder::Scale;
use crate::measured::{distance, drift, scale_of};
use crate::samples::Samples;

/// A run at the moments of a grid.
#[derive(Clone, Debug)]
pub struct Look {
    /// The observable's numbers at the start, and then at each moment.
    pub values: Vec<Vec<f64>>,
    /// The energy at the same moments, where there is one.
    pub energies: Vec<f64>,
    /// The largest kinetic energy.
    pub kinetic: f64,
    /// Places of some things at the same moments, one after the other.
    pub places: Vec<Vec<f64>>,
    /// Whether the run itself gives what stands at a moment, and not a line between two steps.
    pub is_own: Vec<bool>,
    /// The largest scale that the run tells, where [`Scale::Told`] asks for it.
    pub told: f64,
    /// Counted work.
    pub work: u64,
}

impl Look {
    /// What was seen at the start and at each moment, by the run itself, with so much counted work.
    pub fn of(samples: &Samples, work: u64) -> Self {
        let all = 0..samples.len();
        Look {
            values: all.clone().map(|k| samples.observed(k).to_vec()).collect(),
            energies: all.clone().filter_map(|k| Some(samples.energies(k)?.total)).collect(),
            kinetic: samples.kinetic(samples.len()),
            places: all.clone().map(|k| samples.places(k).to_vec()).collect(),
            is_own: all.map(|_| true).collect(),
            told: 0.0,
            work,
        }
    }

    /// Whether it has so many moments beside the start, and every number is one.
    pub(crate) fn is_whole(&self, moments: usize) -> bool {
        let count = moments + 1;
        let is_full =
            |rows: &[Vec<f64>]| rows.len() == count && rows.iter().flatten().all(|x| x.is_finite());
        let energies = self.energies.is_empty() || self.energies.len() == count;
        is_full(&self.values)
            && is_full(&self.places)
            && self.is_own.len() == count
            && energies
            && self.energies.iter().all(|x| x.is_finite())
    }

    /// This one's moments, and then others' without their start.
    pub fn and(mut self, other: &Look) -> Self {
        let rest = |rows: &[Vec<f64>]| rows.iter().skip(1).cloned().collect::<Vec<_>>();
        self.values.extend(rest(&other.values));
        self.places.extend(rest(&other.places));
        self.energies.extend(other.energies.iter().skip(1));
        self.is_own.extend(other.is_own.iter().skip(1));
        self.kinetic = self.kinetic.max(other.kinetic);
        self.told = self.told.max(other.told);
        self
    }

    /// What errors of the observable are relative to, over the whole way.
    pub fn scale(&self, scale: Scale) -> f64 {
        scale_of(scale, || self.values.iter().map(Vec::as_slice), self.kinetic, self.told)
    }

    /// The largest change of the energy, relative to the largest kinetic energy.
    pub fn drift(&self) -> f64 {
        drift(&self.energies, self.kinetic)
    }
}

/// The largest distance of two rows of numbers.
pub fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let each = a.iter().zip(b).map(|(a, b)| distance(a, b));
    each.fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
}

/// The largest distance of two looks where both are their runs' own.
pub fn apart_where_own(a: &Look, b: &Look) -> f64 {
    let own = a.is_own.iter().zip(&b.is_own).map(|(a, b)| *a && *b);
    let rows = own.zip(a.values.iter().zip(&b.values)).filter(|(own, _)| *own);
    let each = rows.map(|(_, (a, b))| distance(a, b));
    each.fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
}
