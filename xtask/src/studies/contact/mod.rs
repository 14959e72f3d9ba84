//! Contact: impact laws against each other, when impulses are given, what tunnels, what sticks.

mod arch;
mod bounce;
mod cost;
mod friction;
mod laws;
mod penalty;
mod pile;
mod tunnelling;

pub use arch::MASONRY_ARCH;
pub use bounce::BOUNCING_BALL;
pub use cost::DETECTION_COST;
pub use friction::FRICTION_THRESHOLD;
pub use laws::IMPACT_LAWS;
pub use penalty::CONTACT_PENALTY;
pub use pile::PILE_SOLVERS;
pub use tunnelling::TUNNELLING;

/// Numbers equally spaced on a logarithmic axis, ends included.
fn spaced(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (to / from).ln() / (count - 1) as f64;
    (0..count).map(move |i| from * (ratio * i as f64).exp())
}
