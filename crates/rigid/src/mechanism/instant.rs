//! Accelerations and forces of a mechanism at an instant, with no step taken.
//!
//! ```text
//! M a + J^T lambda = f,     f = -dV + F(t, q, v) + (0, m x w)
//! J a = -b,      b = v^T d2g v + 2 v d(dg/dt) + d2g/dt2
//! B z = R (J M^-1 f + b),    B^T R^-1 lambda = z,    a = M^-1 f - M^-1/2 z
//! ```
//! `B = R J M^-1/2` of independent equations, rows of length 1, so that masses far apart cost no more
//! digits than they must; `a` the rates of the velocities (world axes, and body axes), `lambda` the
//! multipliers with the signs and units of the joints, `m w` angular momentum and velocity in body axes.
//! Where equations are redundant, the multipliers are those of the smallest norm in reference scales and
//! the accelerations the only ones. The second rate of a drive is a difference of its first over a time that suits it,
//! good to ten digits.

use nalgebra::{DVector, Vector3};
use stationary_calculus::{
    Covector, Force, Metric, Potential, ProductSink, SizeError, System, Vector, independent_rows,
    least_norm,
};
use stationary_constraints::Constraint;

use super::MechanismError;
use super::differential::{DEPENDENT, Held, full, geometric, inverse_roots, weights};
use super::error::check_finite;
use super::second_rate::second_rates;
use crate::{BodyMetric, BodySpace};

/// What holds at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// The rates of all velocities: m/s^2 in world axes, rad/s^2 in body axes.
    pub accelerations: Vec<f64>,
    /// The multipliers: forces (N) and torques (N m) of the joints, as their pages say.
    pub multipliers: Vec<f64>,
}

/// What is left of the equations may be this part of their terms.
const LEFT: f64 = 1e-8;

/// The accelerations and multipliers of bodies at a time, a configuration and velocities `v`.
///
/// # Errors
/// Sizes that do not fit, numbers that are not finite, [`MechanismError::Contradictory`] where no
/// accelerations and forces satisfy the equations, [`MechanismError::RateJumps`] where a drive has none.
pub fn instant<P: Potential, S: BodySpace>(
    system: &System<BodyMetric<S>, P, S>,
    constraint: &impl Constraint,
    force: &impl Force,
    (t, q, v): (f64, &[f64], &[f64]),
) -> Result<Instant, MechanismError> {
    let (n, metric) = (system.dim(), system.metric());
    SizeError::check("the velocities", n, v.len())?;
    check_finite("the time", &[t])?;
    check_finite("the configuration", q)?;
    check_finite("the velocities", v)?;
    let j = full(constraint, n, t, q)?;
    let free = free_forces(system, force, (t, q, v));
    check_finite("the forces", &free.0)?;
    let sharp = |p: &[f64]| {
        let mut u = Vector(vec![0.0; n]);
        metric.sharp(Covector(p), u.view_mut());
        DVector::from_vec(u.0)
    };
    let (falling, bend) = (sharp(&free.0), bend::<S>(constraint, (t, q, v))?);
    if constraint.count() == 0 {
        return Ok(Instant { accelerations: falling.data.into(), multipliers: Vec::new() });
    }
    let g = geometric(metric, constraint, j.clone())?;
    let (rows, _) = independent_rows(&g, DEPENDENT);
    let roots = inverse_roots(metric);
    let held = Held::new(&j, rows, &roots)?;
    let asked = &j * &falling + &bend;
    let z = least_norm(&held.b, &asked.select_rows(&held.rows).component_mul(&held.scales), 0.0)?.x;
    let accelerations = &falling - z.component_mul(&roots);
    let d = weights(constraint);
    let terms = j.abs() * falling.abs() + bend.abs();
    check_left((&j * &accelerations + &bend).component_mul(&d), terms.component_mul(&d))?;
    let mut multipliers = held.multipliers(&z, constraint.count())?;
    let pushed = j.tr_mul(&multipliers).component_mul(&roots);
    check_left(pushed - &z, z)?;
    if held.rows.len() < constraint.count() {
        // The shortest that push the same.
        let push = g.tr_mul(&multipliers.component_div(&d));
        multipliers = least_norm(&g.transpose(), &push, DEPENDENT)?.x.component_mul(&d);
    }
    Ok(Instant { accelerations: accelerations.data.into(), multipliers: multipliers.data.into() })
}

/// An error where more is left of equations than rounding of their terms.
fn check_left(residual: DVector<f64>, terms: DVector<f64>) -> Result<(), MechanismError> {
    let (residual, terms) = (residual.norm(), terms.norm());
    if residual.is_nan() || residual > LEFT * terms {
        return Err(MechanismError::Contradictory { residual: residual / terms });
    }
    Ok(())
}

/// All forces but those of the joints, and the gyroscopic torques.
fn free_forces<P: Potential, S: BodySpace>(
    system: &System<BodyMetric<S>, P, S>,
    force: &impl Force,
    (t, q, v): (f64, &[f64], &[f64]),
) -> Covector<Vec<f64>> {
    let mut f = Covector(vec![0.0; system.dim()]);
    system.potential().add_differential(q, f.view_mut());
    f.0.iter_mut().for_each(|f| *f = -*f);
    force.add_force(t, q, Vector(v), f.view_mut());
    for (i, body) in system.metric().bodies().iter().enumerate() {
        let turn = S::FREEDOMS * i + S::TRANSLATION;
        let w = Vector3::new(v[turn], v[turn + 1], v[turn + 2]);
        let torque = body.angular_momentum(&w).cross(&w);
        f.0[turn..turn + 3].iter_mut().zip(&torque).for_each(|(f, torque)| *f += torque);
    }
    f
}

/// `v^T d2g v + 2 v d(dg/dt) + d2g/dt2` of each equation.
fn bend<S: BodySpace>(
    constraint: &impl Constraint,
    (t, q, v): (f64, &[f64], &[f64]),
) -> Result<DVector<f64>, MechanismError> {
    let count = constraint.count();
    let mut bend = DVector::from_vec(second_rates::<S>(constraint, (t, q, v))?);
    let (mut one, mut product) = (vec![0.0; count], vec![0.0; v.len()]);
    for row in 0..count {
        one[row] = 1.0;
        product.fill(0.0);
        if let Some(mut sink) = ProductSink::new(1.0, v, &mut product) {
            constraint.add_hessian(t, q, &one, &mut sink)?;
        }
        one[row] = 0.0;
        bend[row] += product.iter().zip(v).map(|(p, v)| p * v).sum::<f64>();
    }
    Ok(bend)
}
