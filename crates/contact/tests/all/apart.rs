//! How far numbers are apart, and the order that errors show.

/// The largest difference.
pub(crate) fn off(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The order that two numbers of steps show, one twice the other.
pub(crate) fn order(error: impl Fn(u32) -> f64, steps: u32) -> f64 {
    (error(steps) / error(2 * steps)).log2()
}
