//! A chain of boxes that lands on a floor with all of its corners: joints, dry friction and contacts at once.
//!
//! ```text
//! ball joints      J v = 0            between neighbours, at the middle of their ends
//! dry friction     |x| <= 0.02 N m s  about the upright through each joint
//! corners          u = J v + g        four of each box, g >= 0 what a gap leaves them, Coulomb's cone
//! ```
//! Boxes of 0.3 m x 0.1 m x 0.1 m in a row, with the moments of 1 kg scaled by their masses. Four corners of a box
//! that lie on one plane depend on each other, and joints make them depend on those of the neighbours.

use nalgebra::Vector3;
use stationary_constraints::{ConstraintError, RowLaw, VelocityRows};
use stationary_measure::SplitMix64;

/// Half a box, m.
const HALF: [f64; 3] = [0.15, 0.05, 0.05];
/// From the middle of a box to its joints, m.
const ARM: f64 = 0.2;
/// The most impulse of the dry friction of a joint, N m s.
const DRY: f64 = 0.02;
/// Masses and moments of a box of 1 kg.
const MASSES: [f64; 6] = [1.0, 1.0, 1.0, 0.0017, 0.0083, 0.0083];

/// Rows between boxes, and the velocity before any impulse.
#[derive(Clone, Debug)]
pub struct LandingChain {
    /// Joints and corners.
    pub rows: VelocityRows,
    /// The mass of each freedom, kg or kg m^2.
    pub masses: Vec<f64>,
    /// The velocity, m/s or rad/s.
    pub velocity: Vec<f64>,
}

/// So many boxes, at random, whose masses are `10^-spread` to `10^spread` kg.
///
/// # Errors
/// [`ConstraintError`] where rows are not finite: none.
pub fn landing_chain(
    bodies: usize,
    spread: f64,
    random: &mut SplitMix64,
) -> Result<LandingChain, ConstraintError> {
    let mut rows = VelocityRows::default();
    let axes = [Vector3::z(), Vector3::x(), Vector3::y()];
    for body in 1..bodies {
        for axis in axes {
            let arm = ARM * Vector3::x();
            let mut row = entries(body, axis, (-arm).cross(&axis));
            row.extend(entries(body - 1, -axis, -arm.cross(&axis)));
            rows.push(RowLaw::Equality, &[(&row, 0.0)])?;
        }
        let turns = [(6 * body + 5, 1.0), (6 * body - 1, -1.0)];
        rows.push(RowLaw::Bounded(DRY), &[(&turns, 0.0)])?;
    }
    let friction = 0.55 + 0.45 * random.symmetric();
    let [x, y, z] = HALF;
    for body in 0..bodies {
        for [i, j] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
            let arm = Vector3::new(i * x, j * y, -z);
            let corner = axes.map(|axis| entries(body, axis, arm.cross(&axis)));
            let gap = 0.2 * random.symmetric().max(0.0);
            let [normal, across @ ..] = &corner;
            rows.push(
                RowLaw::Cone(friction),
                &[(normal, -gap), (&across[0], 0.0), (&across[1], 0.0)],
            )?;
        }
    }
    let scales: Vec<f64> =
        (0..bodies).map(|_| 10.0_f64.powf(spread * random.symmetric())).collect();
    let masses = scales.iter().flat_map(|scale| MASSES.map(|mass| scale * mass)).collect();
    let mut speed = |i: usize| {
        let falls = if i % 6 == 2 { 0.3 } else { 0.0 };
        [0.1, 0.1, 0.05, 0.1, 0.1, 0.5][i % 6] * random.symmetric() - falls
    };
    let velocity = (0..6 * bodies).map(&mut speed).collect();
    Ok(LandingChain { rows, masses, velocity })
}

/// What a body's velocity along an axis and turn about another have to do with a row.
fn entries(body: usize, along: Vector3<f64>, turn: Vector3<f64>) -> Vec<(usize, f64)> {
    let both = along.iter().chain(&turn).enumerate();
    both.filter(|(_, value)| **value != 0.0).map(|(k, value)| (6 * body + k, *value)).collect()
}
