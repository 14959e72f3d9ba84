//! The lowest frequencies of a body in the plane, its rigid motions left out.

use stationary_calculus::{Metric, Potential};
use stationary_modal::{Linearized, ModalError, RigidMotions};

/// How far from rest a body may be, kg^1/2 m/s^2: rounding of the stiffest one.
const AT_REST: f64 = 1e-3;

/// The lowest angular frequencies of a body, rad/s.
pub(super) fn frequencies<const D: usize>(
    metric: &impl Metric,
    potential: &impl Potential,
    q: &[f64],
    count: usize,
) -> Result<Vec<f64>, ModalError> {
    let mut body = Linearized::at(metric, potential, q, AT_REST)?;
    let rigid = RigidMotions::of_points::<D>(&body, q.as_chunks().0)?;
    Ok(body.lowest(count, &rigid)?.frequencies().collect())
}
