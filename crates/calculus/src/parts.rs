//! Blocks in parts that are computed side by side, with the same sums for any number of them.
//!
//! ```text
//! freedoms 0 .. n  =  part 0 | part 1 | ...        each part adds to its own freedoms only
//! ```
//! A part visits every block that touches its freedoms, in the order of the whole, and drops what
//! belongs to others: a block at a border is computed twice, and no two threads write to one place.
//! So every sum runs in one order, whatever the number of parts or of threads. With the feature
//! `threads` the parts run on rayon's threads, those of the pool that the caller is in; without it
//! one after the other. Knows nothing of elements: who has blocks decides where to cut.

use crate::Sink;

/// Blocks that come in parts.
pub trait Parts: Sync {
    /// Where the parts' freedoms begin, ascending from 0, and after the last one where they end. No
    /// vertex is cut in two.
    fn bounds(&self) -> &[usize];

    /// Visits every block that has a freedom of this part, in the order of [`Parts::visit_all`].
    fn visit(&self, part: usize, sink: &mut impl Sink);

    /// Visits every block once.
    fn visit_all(&self, sink: &mut impl Sink);
}

/// Does two things: at the same time with the feature `threads`, else one after the other. Both are asked by their
/// address, so that what hands work to threads is compiled once.
pub fn side_by_side(one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
    #[cfg(feature = "threads")]
    {
        rayon::join(one, other);
    }
    #[cfg(not(feature = "threads"))]
    {
        one();
        other();
    }
}

/// Gives each part its own piece of `values`: `work(part, first, piece)`, where `first` is the place
/// of the piece in the whole. `cut` is the place in `values` that belongs to a bound.
pub fn in_parts<T: Send>(
    bounds: &[usize],
    values: &mut [T],
    cut: &(dyn Fn(usize) -> usize + Sync),
    work: &(dyn Fn(usize, usize, &mut [T]) + Sync),
) {
    let Some(&first) = bounds.first() else { return };
    let place = cut(first);
    share(bounds, 0, &mut values[place..], place, cut, work);
}

fn share<T: Send>(
    bounds: &[usize],
    part: usize,
    values: &mut [T],
    first: usize,
    cut: &(dyn Fn(usize) -> usize + Sync),
    work: &(dyn Fn(usize, usize, &mut [T]) + Sync),
) {
    match bounds.len() {
        0 | 1 => {}
        2 => work(part, first, &mut values[..cut(bounds[1]) - first]),
        count => {
            let half = (count - 1) / 2;
            let middle = cut(bounds[half]);
            let (low, high) = values.split_at_mut(middle - first);
            let mut one = || share(&bounds[..=half], part, low, first, cut, work);
            let mut other = || share(&bounds[half..], part + half, high, middle, cut, work);
            side_by_side(&mut one, &mut other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_gets_its_own_piece() {
        for bounds in [&[0, 6][..], &[0, 2, 6], &[0, 1, 1, 4, 6], &[0, 1, 2, 3, 4, 6]] {
            let mut values = [0; 13];
            in_parts(bounds, &mut values, &|bound| 2 * bound, &|part, first, piece| {
                for (k, value) in piece.iter_mut().enumerate() {
                    *value += 100 * (part + 1) + first + k;
                }
            });
            for (part, ends) in bounds.windows(2).enumerate() {
                let own = 2 * ends[0]..2 * ends[1];
                for (k, value) in own.clone().zip(&values[own]) {
                    assert_eq!(*value, 100 * (part + 1) + k, "{bounds:?}");
                }
            }
            assert_eq!(values[12], 0);
        }
    }
}
