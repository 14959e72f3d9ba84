//! Sorting what belongs to vertices: by the vertex, in linear time, then each vertex's own few.

/// The items in rising order, given that a smaller bucket means a smaller item; buckets are below
/// `count`.
pub(crate) fn sorted_by_bucket<T: Copy + Ord>(
    count: usize,
    items: &[T],
    bucket: impl Fn(&T) -> usize,
) -> Vec<T> {
    let mut next = vec![0; count + 1];
    items.iter().for_each(|item| next[bucket(item) + 1] += 1);
    for k in 0..count {
        next[k + 1] += next[k];
    }
    let mut sorted = items.to_vec();
    for item in items {
        let place = &mut next[bucket(item)];
        sorted[*place] = *item;
        *place += 1;
    }
    // Each bucket now ends where the next one began.
    let mut start = 0;
    for &end in &next[..count] {
        sorted[start..end].sort_unstable();
        start = end;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn buckets_sort_like_any_sort(
            items in proptest::collection::vec((0..9_usize, 0..99_u8), 0..60),
        ) {
            let mut expected = items.clone();
            expected.sort_unstable();
            prop_assert_eq!(sorted_by_bucket(9, &items, |item| item.0), expected);
        }
    }
}
