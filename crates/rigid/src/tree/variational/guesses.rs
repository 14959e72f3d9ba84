//! The displacement that the last steps lead to expect of the next.
//!
//! ```text
//! d_n+1 / h  ~  sum_k w_k d_k / h_k        the polynomial through the middles of the last steps
//! ```
//! `d_k` the displacement (n, in the axes of the speeds) of a step of `h_k` seconds. Newton's method starts from it
//! and ends where it would have ended, in an iteration or two. Where the last displacement changed by more than
//! itself nothing is expected.

use stationary_constraints::Extrapolation;
use stationary_integrators::StepError;

/// Steps that are remembered: more would multiply rounding, fewer cost an iteration.
const MEMORY: usize = 5;

/// The mean speeds of the last steps.
#[derive(Clone)]
pub(super) struct Guesses {
    speeds: Extrapolation<Vec<f64>, MEMORY>,
    /// The time of the state to which the last step led.
    end: f64,
    /// The displacement of this step, as far as it is known.
    pub(super) displacement: Vec<f64>,
}

impl Guesses {
    pub(super) fn new(freedoms: usize) -> Self {
        let zeros = vec![0.0; freedoms];
        let speeds = Extrapolation::new(&zeros);
        Guesses { speeds, end: f64::NAN, displacement: zeros }
    }

    pub(super) fn forget(&mut self) {
        self.speeds.forget();
        self.end = f64::NAN;
    }

    /// Whether the last step led to this time.
    pub(super) fn go_on_from(&self, t: f64) -> bool {
        t == self.end
    }

    /// Writes the displacement that is expected of a step; whether one is.
    pub(super) fn expect(&mut self, (t, h): (f64, f64)) -> bool {
        if t != self.end || !self.speeds.is_full() {
            return false;
        }
        let Guesses { speeds, displacement, .. } = self;
        displacement.fill(0.0);
        speeds.add_at(t + 0.5 * h, displacement);
        let last = speeds.last().unwrap_or_default();
        let (mut change, mut size) = (0.0, 0.0);
        for (speed, last) in displacement.iter_mut().zip(last) {
            change += (*speed - last).powi(2);
            size += last * last;
            *speed *= h;
        }
        change <= size
    }

    /// Takes in a step that was made.
    pub(super) fn remember(&mut self, (t, h): (f64, f64)) {
        if t != self.end {
            self.speeds.forget();
        }
        let speeds = self.displacement.iter().map(|d| d / h);
        self.speeds.remember(t + 0.5 * h, |known| {
            known.iter_mut().zip(speeds).for_each(|(to, v)| *to = v)
        });
        self.end = t + h;
    }

    pub(super) fn save(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        if self.end.is_finite() {
            numbers.push(self.end);
            self.speeds.save(&mut numbers);
        }
        numbers
    }

    pub(super) fn load(&mut self, numbers: &[f64]) -> Result<(), StepError> {
        match numbers.split_first() {
            None => self.forget(),
            Some((&end, speeds)) => {
                self.speeds.load(speeds)?;
                self.end = end;
            }
        }
        Ok(())
    }
}
