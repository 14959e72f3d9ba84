//! Where bodies are: poses of free bodies, and orientations of bodies that turn about a fixed
//! point.
//!
//! ```text
//! Poses          q = (t, w, x, y, z),   v = (t., omega)     t <- t + h t.,  R <- R exp(h omega)
//! Orientations   q = (w, x, y, z),      v = omega                           R <- R exp(h omega)
//! ```
//! `t` the centre in world axes (m), the quaternion scalar first, `t.` in world axes, `omega` in
//! body axes. Seven numbers store the six freedoms of a pose, four the three of an orientation;
//! bodies follow each other. The space of poses is the product of R^3 and SO(3): a body's centre
//! moves straight while it turns.
//!
//! Covectors pair with these velocities: a momentum is (linear in world axes, angular in body
//! axes), a differential is (minus the force in world axes, minus the torque in body axes). So the
//! metric of a body is constant, as the house's metrics are, although in world axes its inertia
//! turns with it: the axes carry the dependence, not the matrix.

use nalgebra::Vector3;
use stationary_calculus::{Space, Vector};

use crate::{LieGroup, RigidError, RigidMotion, Rotation};

/// A space whose configurations are those of bodies, one after the other.
pub trait BodySpace: Space + Copy {
    /// Freedoms of translation of a body, in front of its rotation.
    const TRANSLATION: usize;
    /// Numbers that store a body's configuration.
    const STORED: usize = Self::TRANSLATION + 4;
    /// Freedoms of a body.
    const FREEDOMS: usize = Self::TRANSLATION + 3;
    /// The space itself.
    const SPACE: Self;

    /// The pose of a body.
    #[inline]
    fn pose(q: &[f64], body: usize) -> RigidMotion {
        let q = &q[Self::STORED * body..][..Self::STORED];
        let translation = match Self::TRANSLATION {
            0 => Vector3::zeros(),
            _ => Vector3::new(q[0], q[1], q[2]),
        };
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| q[Self::TRANSLATION + k]);
        RigidMotion { translation, rotation: Rotation::unchecked([w, x, y, z]) }
    }

    /// An error unless every pose is finite and its quaternion of length 1.
    fn check(q: &[f64]) -> Result<(), RigidError> {
        crate::error::check_finite("the pose", q)?;
        for body in 0..q.len() / Self::STORED {
            let quaternion = Self::pose(q, body).rotation.quaternion();
            let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (length - 1.0).abs() > 1e-9 {
                return Err(RigidError::Pose { body, length });
            }
        }
        Ok(())
    }
}

/// Poses of free bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Poses;

/// Orientations of bodies that turn about fixed points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orientations;

impl BodySpace for Poses {
    const TRANSLATION: usize = 3;
    const SPACE: Self = Poses;
}

impl BodySpace for Orientations {
    const TRANSLATION: usize = 0;
    const SPACE: Self = Orientations;
}

impl Space for Poses {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / Self::FREEDOMS * Self::STORED
    }

    #[inline]
    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        advance::<Self>(q, h, v.0);
    }
}

impl Space for Orientations {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / Self::FREEDOMS * Self::STORED
    }

    #[inline]
    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        advance::<Self>(q, h, v.0);
    }
}

#[inline]
fn advance<S: BodySpace>(q: &mut [f64], h: f64, v: &[f64]) {
    let bodies = q.chunks_exact_mut(S::STORED).zip(v.chunks_exact(S::FREEDOMS));
    for (q, v) in bodies {
        let (t, r) = q.split_at_mut(S::TRANSLATION);
        let (velocity, w) = v.split_at(S::TRANSLATION);
        t.iter_mut().zip(velocity).for_each(|(t, v)| *t += h * v);
        let turn = Rotation::exp(Vector3::new(w[0], w[1], w[2]) * h);
        let turned = Rotation::unchecked([r[0], r[1], r[2], r[3]]).compose(&turn);
        r.copy_from_slice(&turned.normalized().quaternion());
    }
}
