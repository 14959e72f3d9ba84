//! Random numbers that are the same in every run: SplitMix64.
//!
//! ```text
//! state <- state + 0x9e3779b97f4a7c15       then three rounds of shift, xor and multiply
//! ```
//! 64 bits of state, period 2^64: enough for test points and test directions, not for statistics of
//! billions of samples and never for secrets. Source: Steele, Lea and Flood, "Fast splittable
//! pseudorandom number generators" (OOPSLA 2014).

/// A seeded generator of random numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The generator that a seed stands for. Every seed is as good as any other.
    pub fn new(seed: u64) -> Self {
        SplitMix64 { state: seed }
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number, uniform in [-1, 1).
    pub fn symmetric(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first outputs for the seed 1234567, as published with the reference implementation.
    #[test]
    fn the_bits_are_those_of_the_reference_implementation() {
        let mut random = SplitMix64::new(1_234_567);
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973];
        assert_eq!([random.bits(), random.bits()], expected);
    }

    #[test]
    fn symmetric_numbers_fill_their_interval_evenly() {
        let mut random = SplitMix64::new(1);
        let numbers: Vec<f64> = (0..10_000).map(|_| random.symmetric()).collect();
        assert!(numbers.iter().all(|x| (-1.0..1.0).contains(x)));
        // The mean of 10,000 numbers of variance 1/3 has standard deviation 0.006.
        assert!((numbers.iter().sum::<f64>() / 1e4).abs() < 0.03);
        let squares: f64 = numbers.iter().map(|x| x * x).sum();
        assert!((squares / 1e4 - 1.0 / 3.0).abs() < 0.02);
    }
}
