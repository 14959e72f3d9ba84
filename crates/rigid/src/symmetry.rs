//! Generators of the groups on bodies: what Noether's theorem asks of a motion of all of them, or
//! of a spin of one.
//!
//! ```text
//! (t, R) -> g (t, R),  g = exp(s (v, a)):    xi = (v + a x t, R^T a)                         (8.3)
//! (t, R) -> (t, R exp(s a)):                 xi = (0, a)
//! J = <P, v> + <a, t x P + R m>              sum over bodies         J = <m, a>
//! (x, theta) -> g (x, theta):                xi = (v + a Z x, a),    Z a quarter turn
//! ```
//! `t x` centres (m), `R theta` orientations, `P m` linear and angular momenta, the latter in body
//! axes in space; `v` a velocity and `a` an angular velocity of the world, but of the body in a
//! spin. `J` is linear momentum along `v`, angular momentum about `a` through the origin, or that
//! of a body about its own axis.
//!
//! A motion of the world moves velocities of centres as vectors, and leaves angular velocities in
//! body axes as they are; a spin by `a` turns those by `w x a`. So all bodies' potential must not
//! feel the motion, and a spin is a symmetry where the moments across its axis agree. Source: notes
//! 8.2, 8.3, 9.4. Sizes are checked by who asks; where bodies are missing no component is finite.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::Vector;
use stationary_integrators::Symmetry;

use crate::error::check_finite;
use crate::space::pose_or_none;
use crate::{BodySpace, RigidError};

/// All bodies in space move together, as one rigid thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried<S> {
    /// The velocity v at the origin, metres per unit of the symmetry's parameter.
    pub velocity: Vector3<f64>,
    /// The angular velocity a, radians per unit.
    pub angular_velocity: Vector3<f64>,
    /// Whether the bodies are free or turn about fixed points, which stay.
    pub space: S,
}

/// One body spins about an axis of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spun<S> {
    body: usize,
    axis: Vector3<f64>,
    space: S,
}

impl<S: BodySpace> Spun<S> {
    /// The spin of one of `bodies` bodies, which are free or turn about fixed points, about an axis in
    /// its own axes, radians per unit of the symmetry's parameter.
    ///
    /// # Errors
    /// An axis that is not finite, and a body that is not there.
    pub fn new(
        space: S,
        bodies: usize,
        body: usize,
        axis: Vector3<f64>,
    ) -> Result<Self, RigidError> {
        check_finite("the axis", axis.as_slice())?;
        if body >= bodies {
            return Err(RigidError::NoSuchBody { body, bodies });
        }
        Ok(Spun { body, axis, space })
    }

    /// The freedoms of the body's turns.
    fn turns(&self) -> std::ops::Range<usize> {
        let first = S::FREEDOMS * self.body + S::TRANSLATION;
        first..first + 3
    }
}

/// All bodies in the plane move together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarCarried {
    /// The velocity v at the origin, metres per unit of the symmetry's parameter.
    pub velocity: Vector2<f64>,
    /// The angular velocity a, radians per unit.
    pub angular_velocity: f64,
}

impl<S: BodySpace> Symmetry for Carried<S> {
    fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>) {
        for (body, xi) in xi.0.chunks_exact_mut(S::FREEDOMS).enumerate() {
            let pose = pose_or_none::<S>(q, body);
            let (linear, turn) = xi.split_at_mut(S::TRANSLATION);
            let moved = self.velocity + self.angular_velocity.cross(&pose.translation);
            linear.copy_from_slice(&moved.as_slice()[..S::TRANSLATION]);
            turn.copy_from_slice(pose.rotation.rotate_back(&self.angular_velocity).as_slice());
        }
    }

    fn generator_along(&self, _q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        dxi.0.fill(0.0);
        if S::TRANSLATION == 0 {
            return;
        }
        let bodies = dxi.0.chunks_exact_mut(S::FREEDOMS).zip(v.0.chunks_exact(S::FREEDOMS));
        for (dxi, v) in bodies {
            let turned = self.angular_velocity.cross(&Vector3::new(v[0], v[1], v[2]));
            dxi[..3].copy_from_slice(turned.as_slice());
        }
    }
}

impl<S: BodySpace> Symmetry for Spun<S> {
    fn generator(&self, _q: &[f64], xi: Vector<&mut [f64]>) {
        xi.0.fill(0.0);
        match xi.0.get_mut(self.turns()) {
            Some(turn) => turn.copy_from_slice(self.axis.as_slice()),
            None => xi.0.fill(f64::NAN),
        }
    }

    fn generator_along(&self, _q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        dxi.0.fill(0.0);
        if let (Some(w), Some(turn)) = (v.0.get(self.turns()), dxi.0.get_mut(self.turns())) {
            let w = Vector3::from_column_slice(w);
            turn.copy_from_slice(w.cross(&self.axis).as_slice());
        }
    }
}

impl Symmetry for PlanarCarried {
    fn generator(&self, q: &[f64], xi: Vector<&mut [f64]>) {
        let a = self.angular_velocity;
        if q.len() != xi.0.len() {
            return xi.0.fill(f64::NAN);
        }
        for (xi, [x, y, _]) in xi.0.as_chunks_mut::<3>().0.iter_mut().zip(q.as_chunks::<3>().0) {
            *xi = [self.velocity.x - a * y, self.velocity.y + a * x, a];
        }
    }

    fn generator_along(&self, _q: &[f64], v: Vector<&[f64]>, dxi: Vector<&mut [f64]>) {
        let a = self.angular_velocity;
        for (dxi, [x, y, _]) in dxi.0.as_chunks_mut::<3>().0.iter_mut().zip(v.0.as_chunks::<3>().0)
        {
            *dxi = [-a * y, a * x, 0.0];
        }
    }
}
