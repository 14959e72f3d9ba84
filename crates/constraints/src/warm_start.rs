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

/// Differences that are remembered.
const MEMORY: usize = 3;
/// Weights whose sizes add up to more than this would multiply rounding, and the last steps' errors.
const STEEP: f64 = 10.0;

/// The memory of the last steps.
#[derive(Clone, Debug)]
pub(crate) struct WarmStart<N> {
    /// At the time of the last state, which is here: the impulse at the end of its step over the length.
    end: f64,
    arrived: N,
    /// The last step first: the time at its start, and the difference there.
    changes: [(f64, N); MEMORY],
    known: usize,
}

impl<N: AsRef<[f64]> + AsMut<[f64]> + Clone> WarmStart<N> {
    pub(crate) fn new(numbers: &N) -> Self {
        let changes = std::array::from_fn(|_| (0.0, numbers.clone()));
        WarmStart { end: f64::NAN, arrived: numbers.clone(), changes, known: 0 }
    }

    pub(crate) fn forget(&mut self) {
        self.known = 0;
        self.end = f64::NAN;
    }

    /// Takes in a step of `h` seconds from `t`, with the impulses at its start and at its end.
    pub(crate) fn remember(&mut self, (t, h): (f64, f64), start: &[f64], end: &[f64]) {
        if t == self.end {
            self.changes.rotate_right(1);
            let (time, change) = &mut self.changes[0];
            *time = t;
            let both = start.iter().zip(self.arrived.as_ref());
            let differences = both.map(|(start, before)| start / h - before);
            change.as_mut().iter_mut().zip(differences).for_each(|(change, d)| *change = d);
            self.known = MEMORY.min(self.known + 1);
        } else {
            self.known = 0;
        }
        self.arrived.as_mut().iter_mut().zip(end).for_each(|(to, end)| *to = end / h);
        self.end = t + h;
    }

    /// Writes the impulse that a step of `h` seconds from `t` is likely to begin with; false where nothing
    /// is known of it.
    pub(crate) fn guess(&self, (t, h): (f64, f64), impulse: &mut [f64]) -> bool {
        if t != self.end {
            return false;
        }
        let Some(weights) = (0..=self.known).rev().find_map(|known| self.weights(t, known)) else {
            return false;
        };
        impulse.copy_from_slice(self.arrived.as_ref());
        for ((_, change), weight) in self.changes.iter().zip(weights) {
            let add = |(impulse, change): (&mut f64, &f64)| *impulse += weight * change;
            impulse.iter_mut().zip(change.as_ref()).for_each(add);
        }
        impulse.iter_mut().for_each(|impulse| *impulse *= h);
        impulse.iter().all(|impulse| impulse.is_finite())
    }

    /// Lagrange's weights at `t` of the last steps, unless they are steep.
    fn weights(&self, t: f64, known: usize) -> Option<[f64; MEMORY]> {
        let mut weights = [0.0; MEMORY];
        for (k, weight) in weights.iter_mut().enumerate().take(known) {
            let own = self.changes[k].0;
            let others = (0..known).filter(|&j| j != k).map(|j| self.changes[j].0);
            *weight = others.map(|other| (t - other) / (own - other)).product();
        }
        let size = weights.iter().map(|weight| weight.abs()).sum::<f64>();
        (size <= STEEP).then_some(weights)
    }

    /// Everything in it.
    pub(crate) fn save(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        if self.end.is_finite() {
            let changes = self.changes.iter().take(self.known);
            for (t, force) in std::iter::once(&(self.end, self.arrived.clone())).chain(changes) {
                numbers.push(*t);
                numbers.extend_from_slice(force.as_ref());
            }
        }
        numbers
    }

    /// Takes over what was saved.
    pub(crate) fn load(&mut self, numbers: &[f64]) -> Result<(), StepError> {
        let each = 1 + self.arrived.as_ref().len();
        let many = numbers.len() / each;
        if many > 1 + MEMORY || many * each != numbers.len() {
            return Err(StepError::Saved("it has impulses of another number of equations"));
        }
        self.forget();
        let mut parts = numbers.chunks_exact(each);
        let Some(first) = parts.next() else { return Ok(()) };
        self.end = first[0];
        self.arrived.as_mut().copy_from_slice(&first[1..]);
        for ((t, change), numbers) in self.changes.iter_mut().zip(parts) {
            *t = numbers[0];
            change.as_mut().copy_from_slice(&numbers[1..]);
        }
        self.known = many - 1;
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
    fn steps_that_start_at_almost_one_time_are_not_continued_steeply() {
        let (warm, t) = moved(&[0.1, 1e-9, 0.1]);
        let mut impulse = [0.0];
        assert!(warm.guess((t, 0.1), &mut impulse));
        let nearest = impulses(t, 0.1)[0][0];
        assert!((impulse[0] - nearest).abs() < 0.1, "{impulse:?} {nearest}");
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
