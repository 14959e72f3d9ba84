//! What a run shows at moments: the observable, energies where there are some, places of a few things.

/// Rows of numbers, the start first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Numbers of the observable.
    columns: usize,
    has_energy: bool,
    /// Numbers of all a row.
    width: usize,
    rows: Vec<f64>,
}

/// The energy of a moment, and the kinetic energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energies {
    /// All of it.
    pub total: f64,
    /// Its part of motion.
    pub kinetic: f64,
}

impl Samples {
    /// Adds a moment. The first says how many numbers each has: what later ones have more is left out,
    /// what they lack is no number.
    pub fn push(&mut self, observed: &[f64], energies: Option<Energies>, places: &[f64]) {
        if self.width == 0 {
            self.columns = observed.len();
            self.has_energy = energies.is_some();
            self.width = self.columns + self.skipped() + places.len();
        }
        let padded = |x: &[f64], n: usize| {
            let lacking = n.saturating_sub(x.len());
            let kept: Vec<f64> = x.iter().copied().take(n).collect();
            kept.into_iter().chain(std::iter::repeat_n(f64::NAN, lacking))
        };
        self.rows.extend(padded(observed, self.columns));
        if self.has_energy {
            let none = Energies { total: f64::NAN, kinetic: f64::NAN };
            let Energies { total, kinetic } = energies.unwrap_or(none);
            self.rows.extend([total, kinetic]);
        }
        self.rows.extend(padded(places, self.width - self.columns - self.skipped()));
    }

    /// Numbers of energies a row.
    fn skipped(&self) -> usize {
        if self.has_energy { 2 } else { 0 }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len().checked_div(self.width).unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Numbers of the observable.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// All numbers of a sample.
    pub(crate) fn row(&self, sample: usize) -> &[f64] {
        &self.rows[self.width * sample..self.width * (sample + 1)]
    }

    /// The observable's numbers.
    pub fn observed(&self, sample: usize) -> &[f64] {
        &self.row(sample)[..self.columns]
    }

    /// The energies, where there are some.
    pub fn energies(&self, sample: usize) -> Option<Energies> {
        let row = &self.row(sample)[self.columns..];
        self.has_energy.then(|| Energies { total: row[0], kinetic: row[1] })
    }

    /// The largest kinetic energy of the first so many; zero where there is none.
    pub fn kinetic(&self, samples: usize) -> f64 {
        let each = (0..samples.min(self.len())).filter_map(|sample| self.energies(sample));
        each.map(|energies| energies.kinetic).fold(0.0, f64::max)
    }

    /// The largest magnitude of an observed number.
    pub(crate) fn largest_observed(&self) -> f64 {
        let all = (0..self.len()).flat_map(|sample| self.observed(sample));
        all.fold(0.0, |largest: f64, x| largest.max(x.abs()))
    }

    /// Places.
    pub fn places(&self, sample: usize) -> &[f64] {
        &self.row(sample)[self.columns + self.skipped()..]
    }

    /// No samples of rows like these.
    pub(crate) fn like(&self) -> Samples {
        Samples { rows: Vec::new(), ..*self }
    }

    /// Adds a whole row.
    pub(crate) fn push_row(&mut self, row: &[f64]) {
        self.rows.extend_from_slice(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_the_width_of_the_first() {
        let mut samples = Samples::default();
        let energies = Some(Energies { total: 2.0, kinetic: 1.0 });
        samples.push(&[1.0, 2.0], energies, &[3.0]);
        samples.push(&[4.0], None, &[5.0, 6.0]);
        assert_eq!((samples.len(), samples.columns()), (2, 2));
        assert_eq!(samples.places(0), [3.0]);
        assert_eq!((samples.observed(1)[0], samples.places(1)), (4.0, [5.0].as_slice()));
        assert!(samples.observed(1)[1].is_nan());
        assert_eq!(samples.kinetic(2), 1.0);
        assert_eq!(Samples::default().len(), 0);
    }
}
