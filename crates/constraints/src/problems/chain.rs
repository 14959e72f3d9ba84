//! A chain of n unit masses on n unit rods, hung from one end.

use super::{RodProblem, check_finite, hanging};
use crate::{ConstraintError, Rod, Rods};

/// A chain with as many links as it is asked for.
pub type Chain = RodProblem<Vec<f64>>;

fn rods(n: usize) -> Result<Rods<2>, ConstraintError> {
    let link = |i: usize| Rod::new([if i == 0 { n } else { i - 1 }, i], 1.0);
    Rods::new(n, vec![[0.0, 0.0]], (0..n).map(link).collect())
}

/// A chain of `n` links that hangs and sways: each link moves sideways with the speed `sway` times
/// its depth over n.
///
/// # Errors
/// [`ConstraintError::Parameter`] for a `sway` that is not finite; [`ConstraintError::NonFinite`] for one
/// that overflows times `n`.
pub fn chain(n: usize, sway: f64) -> Result<Chain, ConstraintError> {
    check_finite("sway", sway)?;
    let depth = |i: usize| (i + 1) as f64;
    let q = (0..n).flat_map(|i| [0.0, -depth(i)]).collect();
    let p = (0..n).flat_map(|i| [sway * depth(i) / n as f64, 0.0]).collect();
    hanging(q, p, 1.0, rods(n)?)
}

/// A chain of `n` links that is let go from rest with its links to the right and down in turn, like
/// stairs.
///
/// # Errors
/// None: the rods are well formed for every `n`.
pub fn folded_chain(n: usize) -> Result<Chain, ConstraintError> {
    let q = (0..n).flat_map(|i| [(i / 2 + 1) as f64, -(i.div_ceil(2) as f64)]).collect();
    hanging(q, vec![0.0; 2 * n], 1.0, rods(n)?)
}

/// A chain of `n` links that writhes: their angles from hanging are `0.5 sin(0.7 i)`, and each
/// turns at up to `rate` radians a second, neighbours differently.
///
/// # Errors
/// [`ConstraintError::Parameter`] for a `rate` that is not finite; [`ConstraintError::NonFinite`] where
/// a link's speed overflows.
pub fn writhing_chain(n: usize, rate: f64) -> Result<Chain, ConstraintError> {
    check_finite("rate", rate)?;
    let (mut x, mut v) = ([0.0; 2], [0.0; 2]);
    let (mut q, mut p) = (Vec::with_capacity(2 * n), Vec::with_capacity(2 * n));
    for i in 0..n {
        let (s, c) = (0.5 * (0.7 * i as f64).sin()).sin_cos();
        let turning = rate * (1.3 * i as f64).cos();
        x = [x[0] + s, x[1] - c];
        v = [v[0] + turning * c, v[1] + turning * s];
        q.extend(x);
        p.extend(v);
    }
    hanging(q, p, 1.0, rods(n)?)
}
