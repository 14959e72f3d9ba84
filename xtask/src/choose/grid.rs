//! The moments of the whole way: the ends of equal parts of the horizon, and three within each.
//!
//! ```text
//! t = n H,  (n - 1 + theta) H      H = T / (20 2^m),   theta = sqrt 5 - 2, sqrt 2 - 1, sqrt 3 - 1
//! ```
//! `H` is the step of a run of equal steps, or at most an accepted one of adaptive steps: so that every
//! accepted step is looked into at three irrational parts, where nothing of the motion repeats.
//! Between the ends a method of equal steps says what it gives by a step of that part; an adaptive one is
//! read off its dense output; steps of heat and of rods that break are joined by straight lines.

use super::ladder::MOMENTS;

/// Irrational parts of a step.
const PARTS: [f64; 3] = [0.236_067_977_499_789_7, 0.414_213_562_373_095_1, 0.732_050_807_568_877_2];

/// Parts of the horizon that are looked into at most; of more, every so manieth.
const MOST: u64 = 1 << 12;

/// How near two moments must be to be the same, in steps.
const SAME: f64 = 1e-6;

/// The moments at which whole ways are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Grid {
    /// Halvings of a twentieth of the horizon.
    pub halvings: u32,
}

impl Grid {
    /// Equal parts of the horizon.
    pub fn parts(self) -> u64 {
        MOMENTS << self.halvings
    }

    /// Every so manieth part is looked into.
    pub fn stride(self) -> u64 {
        self.parts().div_ceil(MOST).next_power_of_two()
    }

    /// Whether every part is looked into.
    pub fn is_whole(self) -> bool {
        self.stride() == 1
    }

    /// The moments in the order of time.
    pub fn times(self, horizon: f64) -> Vec<f64> {
        let (parts, stride) = (self.parts(), self.stride());
        let length = horizon / parts as f64;
        (1..=parts)
            .filter(|part| part % stride == 0)
            .flat_map(|part| {
                let from = (part - 1) as f64;
                let inside = PARTS.map(|theta| (from + theta) * length);
                inside.into_iter().chain([part as f64 * length])
            })
            .collect()
    }
}

/// The parts of one step from a time on, of length `h`, at which the moments lie: without its end.
pub fn inside(times: &[f64], from: f64, h: f64) -> Vec<f64> {
    let part = |t: &f64| (t - from) / h;
    times
        .iter()
        .map(part)
        .take_while(|&part| part < 1.0 - SAME)
        .filter(|&part| part > SAME)
        .collect()
}

/// Whether a moment is that of a step's end.
pub fn is_at(t: f64, end: f64, h: f64) -> bool {
    (t - end).abs() <= SAME * h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_the_horizon_is_looked_into_three_times_and_at_its_end() {
        let grid = Grid { halvings: 3 };
        let times = grid.times(4.0);
        assert_eq!(times.len(), 4 * 160);
        assert!(times.is_sorted() && times.last() == Some(&4.0));
        // A run of half the steps sees all of them too: six within its step, and one in its middle.
        let h = 4.0 / 80.0;
        assert_eq!(inside(&times, 0.0, h).len(), 7);
        assert!(is_at(times[7], h, h));
    }
}
