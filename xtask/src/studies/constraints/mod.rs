//! Constraints: the four ways against each other, and where each fails.

mod chain;
mod drift;
mod failures;
mod four_bar;
mod penalty;
mod pendulum;

pub use chain::CHAIN_COST;
pub use drift::ACCELERATION_DRIFT;
pub use failures::WHERE_THEY_FAIL;
pub use four_bar::FOUR_BAR;
pub use penalty::PENALTY_STABILITY;
pub use pendulum::{PENDULUM_ENERGY, PENDULUM_WAYS};

/// Numbers equally spaced on a logarithmic axis, ends included.
fn spaced(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (to / from).ln() / (count - 1) as f64;
    (0..count).map(move |i| from * (ratio * i as f64).exp())
}
