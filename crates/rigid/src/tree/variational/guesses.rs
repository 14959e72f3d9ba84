//! What the first guesses of the last steps lacked, and what the next is likely to lack.
//!
//! ```text
//! q' ~ q + h v + h^2 x(t)      x the parabola through what was lacking over h^2
//! ```
//! `v` the speeds of the momentum half a step on, without what velocities do to it. With it Newton's method
//! ends an iteration or two earlier, at the same place to rounding.

use stationary_constraints::Extrapolation;
use stationary_integrators::StepError;

use super::add;

/// What first guesses lacked in the last steps, over the square of the step.
#[derive(Clone)]
pub(super) struct Guesses {
    lacking: Extrapolation<Vec<f64>>,
    /// The time of the state to which the last step led.
    end: f64,
    /// What this step's guess lacks, as far as it is known.
    pub(super) sum: Vec<f64>,
}

impl Guesses {
    pub(super) fn new(freedoms: usize) -> Self {
        let zeros = vec![0.0; freedoms];
        Guesses { lacking: Extrapolation::new(&zeros), end: f64::NAN, sum: zeros }
    }

    pub(super) fn forget(&mut self) {
        self.lacking.forget();
        self.end = f64::NAN;
    }

    /// Adds what is lacking to a displacement, if it is expected to be less than that; whether any is.
    pub(super) fn improve(&mut self, (t, h): (f64, f64), displacement: &mut [f64]) -> bool {
        self.sum.fill(0.0);
        if t == self.end {
            self.lacking.add_at(t, &mut self.sum);
        }
        let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        self.sum.iter_mut().for_each(|lacking| *lacking *= h * h);
        let few = size(&self.sum);
        if !(few > 0.0 && few < size(displacement)) {
            self.sum.fill(0.0);
            return false;
        }
        add(displacement, &self.sum);
        true
    }

    /// Takes in a step, of which `sum` is all that its guess lacked.
    pub(super) fn remember(&mut self, (t, h): (f64, f64)) {
        if t != self.end {
            self.lacking.forget();
        }
        let sums = self.sum.iter().map(|sum| sum / (h * h));
        self.lacking
            .remember(t, |known| known.iter_mut().zip(sums).for_each(|(to, sum)| *to = sum));
        self.end = t + h;
    }

    pub(super) fn save(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        if self.end.is_finite() {
            numbers.push(self.end);
            self.lacking.save(&mut numbers);
        }
        numbers
    }

    pub(super) fn load(&mut self, numbers: &[f64]) -> Result<(), StepError> {
        match numbers.split_first() {
            None => self.forget(),
            Some((&end, lacking)) => {
                self.lacking.load(lacking)?;
                self.end = end;
            }
        }
        Ok(())
    }
}
