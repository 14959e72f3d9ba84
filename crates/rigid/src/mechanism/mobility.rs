//! How many freedoms joints leave, and which of their equations hold what others hold already.
//!
//! ```text
//! mobility = n - rank J,        redundant: equation i of rank(J_0..i) = rank(J_0..i-1)
//! ```
//! An equation is redundant at a pose; at a singular pose more are than elsewhere, and the mobility is
//! that of the instant, larger than the one of the motion.

use stationary_calculus::independent_rows;
use stationary_constraints::Constraint;

use super::MechanismError;
use super::differential::{CLEAR, full, geometric, rank};
use crate::{BodyMetric, BodySpace, JointName};

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
pub fn mobility<S: BodySpace, K: Constraint>(
    metric: &BodyMetric<S>,
    constraints: &Vec<K>,
    t: f64,
    q: &[f64],
) -> Result<Mobility, MechanismError> {
    let n = S::FREEDOMS * metric.bodies().len();
    let g = geometric(metric, constraints, full(constraints, n, t, q)?)?;
    let rank = rank(&g)?;
    let (held, _) = independent_rows(&g, CLEAR);
    if held.len() != rank {
        return Err(MechanismError::RankUnclear { above: CLEAR, below: CLEAR });
    }
    let mut redundant = Vec::new();
    let mut first = 0;
    for (member, constraint) in constraints.iter().enumerate() {
        let own = 0..constraint.count();
        redundant.extend(own.filter(|row| !held.contains(&(first + row))).map(|row| (member, row)));
        first += constraint.count();
    }
    Ok(Mobility { freedoms: n - rank, rank, redundant })
}
