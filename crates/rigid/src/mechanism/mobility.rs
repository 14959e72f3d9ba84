//! How many freedoms joints leave, and which of their equations hold what others hold already.
//!
//! ```text
//! mobility = n - rank J,        redundant: equation i of rank(J_0..i) = rank(J_0..i-1)
//! ```
//! An equation is redundant at a pose; at a singular pose more are than elsewhere, and the mobility is
//! that of the instant, larger than the one of the motion.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::Metric;
use stationary_constraints::Constraint;

use super::MechanismError;
use super::differential::{CLEAR, full, inverse_root, rank, weights};
use crate::JointName;

/// What joints leave free at a pose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mobility {
    /// Freedoms that are left.
    pub freedoms: usize,
    /// Independent equations.
    pub rank: usize,
    /// The equations that those before them imply here: the member of the list of constraints, and the
    /// equation of it, both counted from 0.
    pub redundant: Vec<(usize, usize)>,
}

impl Mobility {
    /// The redundant equations as messages name them: `equation 3 of joint 4 (hinge between body 2 and
    /// the world)`. The names are those of the members of the list, by their places in it.
    pub fn redundant_names(&self, name: impl Fn(usize) -> JointName) -> Vec<String> {
        let told = |&(joint, equation): &(usize, usize)| {
            format!("equation {equation} of joint {joint} ({})", name(joint))
        };
        self.redundant.iter().map(told).collect()
    }
}

/// The mobility of a list of constraints at a time and a configuration.
///
/// # Errors
/// [`MechanismError::RankUnclear`] near a singular pose, a configuration with too few numbers, numbers
/// that are not finite.
pub fn mobility<K: Constraint>(
    metric: &impl Metric,
    constraints: &Vec<K>,
    t: f64,
    q: &[f64],
) -> Result<Mobility, MechanismError> {
    let j = full(constraints, metric.dim(), t, q)?;
    let a = DMatrix::from_diagonal(&weights(constraints)) * j * inverse_root(metric);
    let rank = rank(&a)?;
    let redundant = dependent(&a);
    if redundant.len() != a.nrows() - rank {
        return Err(MechanismError::RankUnclear { above: CLEAR, below: CLEAR });
    }
    let mut named = Vec::new();
    let mut first = 0;
    for (member, constraint) in constraints.iter().enumerate() {
        let own = first..first + constraint.count();
        named.extend(
            redundant.iter().filter(|row| own.contains(row)).map(|row| (member, row - first)),
        );
        first = own.end;
    }
    Ok(Mobility { freedoms: metric.dim() - rank, rank, redundant: named })
}

/// The rows that lie in the span of those before them, by Gram and Schmidt, twice.
fn dependent(a: &DMatrix<f64>) -> Vec<usize> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut dependent = Vec::new();
    for (number, row) in a.row_iter().enumerate() {
        let mut rest: DVector<f64> = row.transpose();
        let length = rest.norm();
        for _ in 0..2 {
            for unit in &basis {
                rest -= unit * unit.dot(&rest);
            }
        }
        if length == 0.0 || rest.norm() <= CLEAR * length {
            dependent.push(number);
        } else {
            basis.push(rest.normalize());
        }
    }
    dependent
}
