//! Numbers equally spaced on a logarithmic axis.

/// So many from the one to the other, ends included.
pub(super) fn spaced(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (to / from).ln() / (count - 1) as f64;
    (0..count).map(move |i| from * (ratio * i as f64).exp())
}
