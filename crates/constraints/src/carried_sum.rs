//! A sum that carries along what its additions lost.
//!
//! ```text
//! a + b = fl(a + b) + lost        exactly
//! ```
//! Impulses that all but cancel are as large as a position that is nearly singular makes them. What they give to two
//! points is opposite to the last bit, so the momentum of all stays as long as no addition loses a part of it.
//!
//! Source: Knuth, The Art of Computer Programming 2, 4.2.2, theorem B.

/// F sums and what they lost so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarriedSum<const F: usize> {
    sum: [f64; F],
    lost: [f64; F],
}

impl<const F: usize> CarriedSum<F> {
    #[inline]
    pub(crate) fn from(sum: [f64; F]) -> Self {
        CarriedSum { sum, lost: [0.0; F] }
    }

    #[inline]
    pub(crate) fn add(&mut self, parts: [f64; F]) {
        for ((sum, lost), part) in self.sum.iter_mut().zip(&mut self.lost).zip(parts) {
            let before = *sum;
            let after = before + part;
            let added = after - before;
            *lost += (before - (after - added)) + (part - added);
            *sum = after;
        }
    }

    /// The sums, rounded once.
    #[inline]
    pub(crate) fn rounded(self) -> [f64; F] {
        let mut sum = self.sum;
        (0..F).for_each(|k| sum[k] += self.lost[k]);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cancels_leaves_what_is_small() {
        let mut carried = CarriedSum::from([1.0, 0.1]);
        for part in [1e17, -3e16, -7e16] {
            carried.add([part, -part]);
        }
        assert_eq!(carried.rounded(), [1.0, 0.1]);
    }
}
