//! Numbers that change slowly from step to step, continued.
//!
//! ```text
//! x(t) ~ sum_k w_k x_k        the polynomial through the last few, at t: through three a parabola
//! ```
//! `x_k` what was found at the times `t_k`, seconds. Iterations that start from it need fewer turns and end where
//! they would have ended.

use stationary_integrators::StepError;

/// Weights whose sizes add up to more than those of equal steps by this factor would multiply rounding, and the
/// last steps' errors.
const STEEP: f64 = 3.0;

/// The numbers at the last few times, `MEMORY` of them.
#[derive(Clone, Debug)]
pub struct Extrapolation<N, const MEMORY: usize = 3> {
    /// The last first.
    known: [(f64, N); MEMORY],
    count: usize,
}

impl<N: AsRef<[f64]> + AsMut<[f64]> + Clone, const MEMORY: usize> Extrapolation<N, MEMORY> {
    /// Nothing is known yet of numbers that are as many as these.
    pub fn new(numbers: &N) -> Self {
        Extrapolation { known: std::array::from_fn(|_| (0.0, numbers.clone())), count: 0 }
    }

    /// Whether as many times are known as are remembered.
    pub fn is_full(&self) -> bool {
        self.count == MEMORY
    }

    /// The numbers at the last time, where one is known.
    pub fn last(&self) -> Option<&[f64]> {
        (self.count > 0).then(|| self.known[0].1.as_ref())
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        self.count = 0;
    }

    /// Takes in the numbers at a time, which `write` writes.
    pub fn remember(&mut self, t: f64, write: impl FnOnce(&mut [f64])) {
        self.known.rotate_right(1);
        let (time, numbers) = &mut self.known[0];
        *time = t;
        write(numbers.as_mut());
        self.count = MEMORY.min(self.count + 1);
    }

    /// Adds what is to be expected at a time; nothing where nothing is known.
    pub fn add_at(&self, t: f64, sum: &mut [f64]) {
        let Some(weights) = (1..=self.count).rev().find_map(|count| self.weights(t, count)) else {
            return;
        };
        for ((_, numbers), weight) in self.known.iter().zip(weights) {
            let add = |(sum, number): (&mut f64, &f64)| *sum += weight * number;
            sum.iter_mut().zip(numbers.as_ref()).for_each(add);
        }
    }

    /// Lagrange's weights at `t` of the last times, unless they are steep.
    fn weights(&self, t: f64, count: usize) -> Option<[f64; MEMORY]> {
        let mut weights = [0.0; MEMORY];
        for (k, weight) in weights.iter_mut().enumerate().take(count) {
            let own = self.known[k].0;
            let others = (0..count).filter(|&j| j != k).map(|j| self.known[j].0);
            *weight = others.map(|other| (t - other) / (own - other)).product();
        }
        let size = weights.iter().map(|weight| weight.abs()).sum::<f64>();
        // Those of equal steps are binomial coefficients.
        let equal = (count as f64).exp2() - 1.0;
        (size <= STEEP * equal).then_some(weights)
    }

    /// Appends everything that is known.
    pub fn save(&self, numbers: &mut Vec<f64>) {
        for (t, known) in self.known.iter().take(self.count) {
            numbers.push(*t);
            numbers.extend_from_slice(known.as_ref());
        }
    }

    /// Takes over what was saved.
    ///
    /// # Errors
    /// [`StepError::Saved`] for numbers of another size; it is then as it was.
    pub fn load(&mut self, numbers: &[f64]) -> Result<(), StepError> {
        let each = 1 + self.known[0].1.as_ref().len();
        let count = numbers.len() / each;
        if count > MEMORY || count * each != numbers.len() {
            return Err(StepError::Saved("it remembers steps with another count of numbers"));
        }
        for ((t, known), numbers) in self.known.iter_mut().zip(numbers.chunks_exact(each)) {
            *t = numbers[0];
            known.as_mut().copy_from_slice(&numbers[1..]);
        }
        self.count = count;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(times: &[f64]) -> Extrapolation<[f64; 1]> {
        let mut known = Extrapolation::<_, 3>::new(&[0.0]);
        times.iter().for_each(|&t| known.remember(t, |x| x[0] = 1.0 + 2.0 * t - 3.0 * t * t));
        known
    }

    fn at(known: &Extrapolation<[f64; 1]>, t: f64) -> f64 {
        let mut sum = [0.0];
        known.add_at(t, &mut sum);
        sum[0]
    }

    #[test]
    fn a_parabola_is_continued_from_three_times_a_line_from_two_and_nothing_from_none() {
        let exact = 1.0 + 2.0 * 0.6 - 3.0 * 0.36;
        assert!((at(&known(&[-1.0, 0.1, 0.3, 0.45]), 0.6) - exact).abs() < 1e-14);
        let line = at(&known(&[0.2, 0.4]), 0.6);
        assert!((line - (2.0 * 1.32 - 1.28)).abs() < 1e-14, "{line}");
        assert_eq!(at(&known(&[]), 0.6), 0.0);
    }

    #[test]
    fn times_that_are_almost_one_are_not_continued_steeply() {
        let found = at(&known(&[0.1, 0.3, 0.3 + 1e-9]), 0.6);
        assert!((found - (1.0 + 0.6 - 0.27)).abs() < 1e-6, "{found}");
    }

    #[test]
    fn what_was_saved_is_taken_back_and_numbers_of_another_size_are_refused() {
        let (first, mut second) = (known(&[0.1, 0.2]), Extrapolation::new(&[0.0]));
        let mut numbers = Vec::new();
        first.save(&mut numbers);
        second.load(&numbers).unwrap();
        assert_eq!(at(&first, 0.5), at(&second, 0.5));
        assert!(Extrapolation::<_, 3>::new(&[0.0; 2]).load(&numbers).is_err());
        second.load(&[]).unwrap();
        assert_eq!(at(&second, 0.5), 0.0);
    }
}
