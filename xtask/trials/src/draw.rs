//! Where cases come from: random numbers that remember what was drawn, so that a case can be shrunk.
//!
//! Every number that a generator asks for is made from one word of 64 bits. A case is its list of
//! words, and the word 0 is the simplest answer to any question: the smallest count, the first choice,
//! the lower end, zero, no. So a smaller list, or one with smaller words, is a simpler case, whatever
//! the generator makes of it. Source: MacIver and Donaldson, "Test-case reduction via test-case
//! generation" (ECOOP 2020).

use std::f64::consts::TAU;

/// The random numbers of one case.
#[derive(Clone, Debug)]
pub struct Draw {
    /// What was drawn, or what is drawn again.
    words: Vec<u64>,
    /// How many words were used.
    used: usize,
    /// Where new words come from; `None` where only the given ones are, then zeros.
    state: Option<u64>,
    notes: Vec<String>,
}

impl Draw {
    /// The case that a seed stands for.
    pub fn new(seed: u64) -> Self {
        Draw { words: Vec::new(), used: 0, state: Some(seed), notes: Vec::new() }
    }

    /// The case of these words.
    pub(crate) fn again(words: Vec<u64>) -> Self {
        Draw { words, used: 0, state: None, notes: Vec::new() }
    }

    /// What was drawn so far.
    pub(crate) fn into_parts(mut self) -> (Vec<u64>, Vec<String>) {
        self.words.truncate(self.used);
        (self.words, self.notes)
    }

    /// Says in words what the case is, for whoever has to mend it.
    pub fn note(&mut self, words: impl Into<String>) {
        self.notes.push(words.into());
    }

    /// The next 64 random bits.
    pub fn word(&mut self) -> u64 {
        let word = match self.words.get(self.used) {
            Some(&word) => word,
            None => {
                let word = self.state.as_mut().map_or(0, split_mix);
                self.words.push(word);
                word
            }
        };
        self.used += 1;
        word
    }

    /// Uniform in [0, 1); simplest 0.
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Uniform in [low, high); simplest `low`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in [-1, 1); simplest 0.
    pub fn symmetric(&mut self) -> f64 {
        (self.word() as i64 >> 10) as f64 * 2.0_f64.powi(-53)
    }

    /// Its logarithm is uniform between those of `low` and `high`; simplest `low`.
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * ((high / low).ln() * self.unit()).exp()
    }

    /// Normal with mean 0 and deviation 1; simplest 0.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (TAU * self.unit()).cos()
    }

    /// A whole number from `low` to `high`, both included; simplest `low`.
    pub fn between(&mut self, low: usize, high: usize) -> usize {
        let count = (high - low) as u128 + 1;
        low + ((u128::from(self.word()) * count) >> 64) as usize
    }

    /// A whole number below `count`; simplest 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.between(0, count - 1)
    }

    /// Yes with this probability; simplest no.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() >= 1.0 - probability
    }

    /// One of these, all as probable; simplest the first.
    pub fn one_of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())].clone()
    }

    /// A vector of numbers uniform in [-1, 1).
    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.symmetric()).collect()
    }

    /// Any double: zeros, infinities, NaN, denormals and whole numbers among them more often than by
    /// their share of the bits.
    pub fn any_f64(&mut self) -> f64 {
        const SPECIAL: [f64; 14] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            5e-324,
            1e-200,
            1e200,
            f64::EPSILON,
        ];
        match self.below(3) {
            0 => self.one_of(&SPECIAL),
            1 => self.symmetric(),
            _ => f64::from_bits(self.word()),
        }
    }
}

/// The next output of SplitMix64 (Steele, Lea and Flood 2014), kept apart from the crates' own.
pub(crate) fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_drawn_again_from_its_words_is_the_same() {
        let case = |draw: &mut Draw| (draw.between(1, 9), draw.symmetric(), draw.normal());
        let mut first = Draw::new(7);
        let drawn = case(&mut first);
        assert_eq!(case(&mut Draw::again(first.into_parts().0)), drawn);
    }

    #[test]
    fn the_word_zero_is_the_simplest_answer_to_each_question() {
        let mut zeros = Draw::again(Vec::new());
        assert_eq!(zeros.between(3, 9), 3);
        assert_eq!(zeros.symmetric(), 0.0);
        assert_eq!(zeros.normal(), 0.0);
        assert_eq!(zeros.log_uniform(1e-3, 1e3), 1e-3);
        assert!(!zeros.chance(0.99));
    }

    #[test]
    fn numbers_fill_their_intervals_evenly() {
        let mut draw = Draw::new(1);
        let mean = |numbers: Vec<f64>| numbers.iter().sum::<f64>() / numbers.len() as f64;
        // The means of 10,000 numbers: deviations 0.006, 0.01 and 0.01.
        assert!(mean((0..10_000).map(|_| draw.symmetric()).collect()).abs() < 0.03);
        assert!(mean((0..10_000).map(|_| draw.normal()).collect()).abs() < 0.05);
        let whole: Vec<usize> = (0..10_000).map(|_| draw.between(2, 4)).collect();
        assert!((2..=4).all(|n| whole.iter().filter(|&&m| m == n).count() > 3_000));
        let logs = (0..10_000).map(|_| draw.log_uniform(1e-3, 1e3).log10()).collect();
        assert!(mean(logs).abs() < 0.1);
    }
}
