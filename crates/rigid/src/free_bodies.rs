//! The free motion of bodies: centres straight, rotations by a map of their own.
//!
//! ```text
//! t <- t + h P/m,   P <- P,      (R, m) <- turned for h seconds
//! ```
//! `t` centres and `P` momenta in world axes, `R` orientations and `m` angular momenta in body
//! axes, where they turn although no torque acts; the map is a [`FreeRotation`]. It is what
//! [`LieVerlet`](crate::LieVerlet) does between two kicks, and what [`Rattle`] does between two
//! impulses of joints: with [`ConstantVelocity`](crate::ConstantVelocity) that is the constrained
//! discrete Hamilton principle of 6.5 for the discrete Lagrangian of 9.5, with the potential shared
//! by both ends of a step.
//!
//! ```text
//! sum_i h (L_d(R_i, R_i+1) - <lambda_i, g(R_i)>)  stationary,    g(R_i) = 0,   J v_i = 0
//! ```
//! Jointed so, bodies of unequal moments keep their gyroscopic torque, poses and velocities both
//! stay, and the multipliers are forces. Order 2, symmetric and symplectic, whichever of the maps
//! turns the bodies. Source: notes 6.5, 9.5; Leimkuhler and Reich (2004), 7.2 and 8.

use stationary_calculus::{Covector, Vector};
use stationary_constraints::FreeMotion;
use stationary_integrators::{StepError, StepReport};

use crate::free_rotation::FreeRotation;
use crate::metric::body_momentum;
use crate::{BodyMetric, BodySpace};
#[cfg(doc)]
use stationary_constraints::Rattle;

/// Bodies that move freely, each turned by the map R: what [`Rattle::along`] takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FreeBodies<R>(pub R);

impl<S: BodySpace, R: FreeRotation> FreeMotion<BodyMetric<S>, S> for FreeBodies<R> {
    #[inline]
    fn advance(
        &mut self,
        metric: &BodyMetric<S>,
        _space: &S,
        (_, h): (f64, f64),
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        _room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        move_freely::<S, R>(metric, h, q, p.0).map(|_| ())
    }
}

/// Moves every body for `h` seconds; the most iterations and the largest residual of its maps.
#[inline]
pub(crate) fn move_freely<S: BodySpace, R: FreeRotation>(
    metric: &BodyMetric<S>,
    h: f64,
    q: &mut [f64],
    p: &mut [f64],
) -> Result<StepReport, StepError> {
    let mut report = StepReport::default();
    for (i, body) in metric.bodies().iter().enumerate() {
        let turned = R::turn(body, S::pose_at(q, i).rotation, body_momentum::<S>(p, i), h)?;
        let q = &mut q[S::STORED * i..][..S::STORED];
        let p = &mut p[S::FREEDOMS * i..][..S::FREEDOMS];
        for c in 0..S::TRANSLATION {
            q[c] += h * body.inverse_mass() * p[c];
        }
        q[S::TRANSLATION..].copy_from_slice(&turned.rotation.quaternion());
        p[S::TRANSLATION..].copy_from_slice(turned.momentum.as_slice());
        report.hessians = report.hessians.max(turned.iterations);
        report.residual = report.residual.max(turned.residual);
    }
    Ok(report)
}
