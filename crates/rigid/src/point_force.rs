//! A force or an impulse at a point of a body, pulled back by virtual work.
//!
//! ```text
//! x = t + R c,     dx = [ I   -R [c] ]                                            (10.1.2)
//! F dx = (F, c x R^T F)          a force at x acts as itself, and as a torque in body axes
//! (P, m) <- (P, m) + (J, c x R^T J)                                                (10.2, 10.3)
//! ```
//! `c` the point in body axes (m); `F` newtons, `J` newton seconds, world axes. The chart's `T` of
//! the notes cancels: no axis-angle is ever formed. An impulse at a point of a body that turns
//! about a fixed point leaves its torque only; the support takes the rest.

use nalgebra::Vector3;
use stationary_integrators::State;

use crate::error::check_finite;
use crate::metric::check_bodies;
use crate::{BodySpace, RigidError, RigidMotion};

/// A force and a torque on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// The force, N, world axes; or an impulse, N s.
    pub force: Vector3<f64>,
    /// The torque about the centre, N m, body axes; or its impulse, N m s.
    pub torque: Vector3<f64>,
}

/// The force on the freedoms of a body that a force `force` at its point `point` exerts.
#[inline]
pub fn force_at_point(pose: &RigidMotion, point: &Vector3<f64>, force: Vector3<f64>) -> Wrench {
    Wrench { force, torque: point.cross(&pose.rotation.rotate_back(&force)) }
}

/// Adds a multiple of what acts on a body to a covector of all bodies; nothing of the world's.
#[inline]
pub(crate) fn add_wrench<S: BodySpace>(
    f: &mut [f64],
    body: Option<usize>,
    wrench: &Wrench,
    scale: f64,
) {
    let own = body.map(|body| S::FREEDOMS * body..S::FREEDOMS * (body + 1));
    let Some(f) = own.and_then(|own| f.get_mut(own)) else { return };
    let (forces, torques) = f.split_at_mut(S::TRANSLATION);
    forces.iter_mut().zip(&wrench.force).for_each(|(f, force)| *f += scale * force);
    torques.iter_mut().zip(&wrench.torque).for_each(|(f, torque)| *f += scale * torque);
}

/// Adds an impulse at a point of a body to its momentum.
///
/// # Errors
/// Numbers that are not finite, before or after, a body that the state does not hold, a momentum that
/// has not the configuration's bodies. The state is then as it was.
pub fn apply_impulse<S: BodySpace>(
    state: &mut State<Vec<f64>>,
    body: usize,
    point: &Vector3<f64>,
    impulse: Vector3<f64>,
) -> Result<(), RigidError> {
    check_finite("the impulse", impulse.as_slice())?;
    check_finite("the point", point.as_slice())?;
    check_bodies::<S>(state)?;
    let wrench = force_at_point(&S::pose(&state.q, body)?, point, impulse);
    let p = &mut state.p.components_mut()[S::FREEDOMS * body..][..S::FREEDOMS];
    let mut pushed = [0.0; 6];
    let pushed = &mut pushed[..S::FREEDOMS];
    let impulses = wrench.force.iter().take(S::TRANSLATION).chain(&wrench.torque);
    for (pushed, (p, impulse)) in pushed.iter_mut().zip(p.iter().zip(impulses)) {
        *pushed = p + impulse;
    }
    check_finite("the momentum after the impulse", pushed)?;
    p.copy_from_slice(pushed);
    Ok(())
}
