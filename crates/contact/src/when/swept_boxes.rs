//! A swept broad phase: which straight motions can meet, by the boxes that they sweep.
//!
//! ```text
//! box of a motion = hull of its start and its end, `margin` larger on every side
//! ```
//! Sorted along one axis and swept: n log n and the overlaps along it. Pairs come out sorted.

use nalgebra::Vector3;

use crate::Moving;

/// The box that some corners sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SweptBox {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl SweptBox {
    pub(crate) fn of(corners: &[Moving], margin: f64) -> Self {
        let places = || corners.iter().flat_map(|corner| [corner.start, corner.end]);
        let far = Vector3::repeat(f64::INFINITY);
        SweptBox {
            low: places().fold(far, |low, x| low.inf(&x)).add_scalar(-margin),
            high: places().fold(-far, |high, x| high.sup(&x)).add_scalar(margin),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}

/// Pairs (first, second) of boxes that overlap, one from each list.
pub(crate) fn overlapping(first: &[SweptBox], second: &[SweptBox]) -> Vec<(usize, usize)> {
    let mut all: Vec<(f64, bool, usize)> = Vec::with_capacity(first.len() + second.len());
    all.extend(first.iter().enumerate().map(|(i, b)| (b.low.x, false, i)));
    all.extend(second.iter().enumerate().map(|(i, b)| (b.low.x, true, i)));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut open: [Vec<usize>; 2] = Default::default();
    let mut pairs = Vec::new();
    for (low, is_second, i) in all {
        let (own, other) = if is_second { (second, first) } else { (first, second) };
        let candidates = &mut open[usize::from(!is_second)];
        candidates.retain(|&j| other[j].high.x >= low);
        for &j in candidates.iter().filter(|&&j| own[i].meets(&other[j])) {
            pairs.push(if is_second { (j, i) } else { (i, j) });
        }
        open[usize::from(is_second)].push(i);
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_measure::SplitMix64;

    #[test]
    fn every_pair_that_overlaps_is_found_once() {
        let mut random = SplitMix64::new(8);
        let mut boxes = |count: usize| -> Vec<SweptBox> {
            let mut place = || Vector3::from_fn(|_, _| random.symmetric());
            let mut corner = || {
                let start = place();
                Moving { start, end: start + place() * 0.3 }
            };
            (0..count).map(|_| SweptBox::of(&[corner()], 0.05)).collect()
        };
        let (first, second) = (boxes(60), boxes(80));
        let mut expected = Vec::new();
        for (i, a) in first.iter().enumerate() {
            expected.extend((0..80).filter(|&j| a.meets(&second[j])).map(|j| (i, j)));
        }
        assert!(expected.len() > 50);
        assert_eq!(overlapping(&first, &second), expected);
    }
}
