//! Small arrays, written by a loop.
//!
//! ```text
//! array(f) = (f(0), f(1), .., f(N - 1))
//! ```
//! Of each closure that is handed to `from_fn` or `map` of the standard library four and seven functions are compiled,
//! and what is not inlined of them is called for every element of a mesh; of one that is handed to this, two.

/// The values of a function at 0, 1, .., in their order. It is asked at 0 even if the array is empty.
#[inline]
pub fn array<T: Copy, const N: usize>(mut value: impl FnMut(usize) -> T) -> [T; N] {
    let mut values = [value(0); N];
    for (k, place) in values.iter_mut().enumerate().skip(1) {
        *place = value(k);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_in_their_order_and_each_is_asked_for_once() {
        let mut asked = Vec::new();
        let squares: [usize; 4] = array(|k| {
            asked.push(k);
            k * k
        });
        assert_eq!(squares, [0, 1, 4, 9]);
        assert_eq!(asked, [0, 1, 2, 3]);
        assert_eq!(array::<_, 2>(|k| array::<_, 2>(|l| 10 * k + l)), [[0, 1], [10, 11]]);
    }
}
