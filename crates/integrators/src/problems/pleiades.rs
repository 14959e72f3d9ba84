//! Seven stars in the plane that pass each other closely: the Pleiades of the test sets.
//!
//! ```text
//! V(q) = - sum_{i<j} m_i m_j / |q_i - q_j|,    m_i = i,    i = 1..7          (G = 1)
//! ```
//! Stars come as near to each other as a hundredth of the cluster's size. Known at the start and at
//! t = 3 alone: a run in extended precision differs from the published sixteen digits by 2e-15 at
//! most, runs in double precision by 1e-11. Source: Hairer, Norsett, Wanner, Solving Ordinary
//! Differential Equations I, II.10; Mazzia, Magherini, Test Set for Initial Value Problem Solvers,
//! release 2.4, part II.

use stationary_calculus::{Covector, DiagonalMetric, System, array};

use super::{Problem, ProblemError, SmallProblem};
use crate::{NewtonianGravity, State};

const MASSES: [f64; 7] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

const POSITIONS: [[f64; 2]; 7] =
    [[3.0, 3.0], [3.0, -3.0], [-1.0, 2.0], [-3.0, 0.0], [2.0, 0.0], [-2.0, -4.0], [2.0, 4.0]];

const VELOCITIES: [[f64; 2]; 7] =
    [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, -1.25], [0.0, 1.0], [1.75, 0.0], [-1.5, 0.0]];

/// A time this near to another is the same, but for rounding.
const ROUNDING: f64 = 1e-15;

/// The test set's reference at t = 3.
const AT_THREE: [[f64; 2]; 7] = [
    [0.3706139143970502, -3.943437585517392],
    [3.237284092057233, -3.27138097397255],
    [-3.222559032418324, 5.225081843456543],
    [0.659709145577531, -2.59061243497747],
    [0.3425581707156584, 1.198213693392275],
    [1.562172101400631, -0.2429682344935824],
    [-0.7003092922212495, 1.09144924042898],
];

/// The seven stars, over three units of time.
///
/// # Errors
/// None: all its numbers are given.
pub fn pleiades() -> Result<SmallProblem<NewtonianGravity<2>, 14>, ProblemError> {
    let masses: [f64; 14] = array(|freedom| MASSES[freedom / 2]);
    let velocities = VELOCITIES.as_flattened();
    let gravity = NewtonianGravity { constant: 1.0, masses: MASSES.to_vec(), fixed: Vec::new() };
    Ok(Problem {
        name: "pleiades",
        system: System::new(DiagonalMetric::new(masses)?, gravity)?,
        initial: State::new(
            array(|freedom| POSITIONS.as_flattened()[freedom]),
            Covector(array(|freedom| masses[freedom] * velocities[freedom])),
        ),
        horizon: 3.0,
        period: 3.0,
        scale: 1.0,
        solution: Box::new(|t| {
            let known = if t == 0.0 { Some(&POSITIONS) } else { None };
            let known =
                known.or(if (t - 3.0).abs() < ROUNDING { Some(&AT_THREE) } else { None })?;
            Some(array(|freedom| known.as_flattened()[freedom]))
        }),
        solution_error: 1e-14,
    })
}
