//! The impulses of the last steps, and what they say of the next.
//!
//! ```text
//! A_n+1 / h  ~  B_n / h_n + sum_k w_k (A_k / h_k - B_k-1 / h_k-1)       the parabola through the last three
//! ```
//! `A_k` the impulse (m) at the start of a step of `h_k` seconds and `B_k` that at its end, both about half the
//! constraint's force over the step: their difference at one time changes slowly, even where the force does not.
//! It is what iterations start from, and nothing else: they end at the same configuration to rounding, in fewer
//! of them. The memory belongs to the state that the last step ended in, told by its time.

use stationary_integrators::StepError;

use crate::Extrapolation;

/// The memory of the last steps.
#[derive(Clone, Debug)]
pub(crate) struct WarmStart<N> {
    /// The time of the last state, and the impulse at the end of its step over the length.
    end: f64,
    arrived: N,
    changes: Extrapolation<N>,
}

impl<N: AsRef<[f64]> + AsMut<[f64]> + Clone> WarmStart<N> {
    pub(crate) fn new(numbers: &N) -> Self {
        let changes = Extrapolation::new(numbers);
        WarmStart { end: f64::NAN, arrived: numbers.clone(), changes }
    }

    pub(crate) fn forget(&mut self) {
        self.changes.forget();
        self.end = f64::NAN;
    }

    /// Takes in a step of `h` seconds from `t`, with the impulses at its start and at its end.
    pub(crate) fn remember(&mut self, (t, h): (f64, f64), start: &[f64], end: &[f64]) {
        let (arrived, rate) = (self.arrived.as_mut(), 1.0 / h);
        if t == self.end {
            self.changes.remember(t, |change| {
                let both = start.iter().zip(&*arrived);
                let differences = both.map(|(start, before)| start * rate - before);
                change.iter_mut().zip(differences).for_each(|(change, d)| *change = d);
            });
        } else {
            self.changes.forget();
        }
        arrived.iter_mut().zip(end).for_each(|(to, end)| *to = end * rate);
        self.end = t + h;
    }

    /// Writes the impulse that a step of `h` seconds from `t` is likely to begin with; false where nothing
    /// is known of it.
    pub(crate) fn guess(&self, (t, h): (f64, f64), impulse: &mut [f64]) -> bool {
        if t != self.end {
            return false;
        }
        impulse.copy_from_slice(self.arrived.as_ref());
        self.changes.add_at(t, impulse);
        impulse.iter_mut().for_each(|impulse| *impulse *= h);
        impulse.iter().all(|impulse| impulse.is_finite())
    }

    /// Everything in it.
    pub(crate) fn save(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        if self.end.is_finite() {
            numbers.push(self.end);
            numbers.extend_from_slice(self.arrived.as_ref());
            self.changes.save(&mut numbers);
        }
        numbers
    }

    /// Takes over what was saved.
    pub(crate) fn load(&mut self, numbers: &[f64]) -> Result<(), StepError> {
        let own = self.arrived.as_ref().len() + 1;
        let Some((first, changes)) = numbers.split_at_checked(own) else {
            if numbers.is_empty() {
                self.forget();
                return Ok(());
            }
            return Err(StepError::Saved("it has impulses of another number of equations"));
        };
        self.changes.load(changes)?;
        self.end = first[0];
        self.arrived.as_mut().copy_from_slice(&first[1..]);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force that is no polynomial, and a difference that is a parabola of time.
    fn impulses(t: f64, h: f64) -> [[f64; 1]; 2] {
        let force = |t: f64| (9.0 * t).sin();
        let start = h * (force(t) + 1.0 + 2.0 * t - 3.0 * t * t);
        [[start], [h * force(t + h)]]
    }

    fn moved(steps: &[f64]) -> (WarmStart<[f64; 1]>, f64) {
        let (mut warm, mut t) = (WarmStart::new(&[0.0]), 0.0);
        for &h in steps {
            let [start, end] = impulses(t, h);
            warm.remember((t, h), &start, &end);
            t += h;
        }
        (warm, t)
    }

    #[test]
    fn differences_that_are_a_parabola_are_continued_and_another_time_is_not_known() {
        let mut impulse = [0.0];
        assert!(!moved(&[]).0.guess((0.0, 0.1), &mut impulse));
        let (mut warm, t) = moved(&[0.1, 0.2, 0.15, 0.1]);
        assert!(warm.guess((t, 0.3), &mut impulse));
        assert!((impulse[0] - impulses(t, 0.3)[0][0]).abs() < 1e-14, "{impulse:?}");
        assert!(!warm.guess((t + 1.0, 0.3), &mut impulse));
        warm.remember((t + 1.0, 0.1), &[0.3], &[0.7]);
        assert!(warm.guess((t + 1.1, 0.1), &mut impulse) && (impulse[0] - 0.7).abs() < 1e-15);
    }

    #[test]
    fn what_was_saved_is_taken_back_and_numbers_of_another_size_are_refused() {
        let (warm, t) = moved(&[0.1, 0.2, 0.15]);
        let mut other = WarmStart::new(&[0.0]);
        other.load(&warm.save()).unwrap();
        let (mut a, mut b) = ([0.0], [0.0]);
        assert!(warm.guess((t, 0.1), &mut a) && other.guess((t, 0.1), &mut b));
        assert_eq!(a, b);
        assert!(WarmStart::new(&[0.0; 4]).load(&warm.save()).is_err());
        other.load(&[]).unwrap();
        assert!(!other.guess((t, 0.1), &mut b));
    }
}
