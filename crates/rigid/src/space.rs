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
use stationary_calculus::{Curved, SizeError, Space, Vector};

use crate::{LieGroup, RigidError, RigidMotion, Rotation};

/// A space whose configurations are those of bodies, one after the other.
pub trait BodySpace: Curved + Copy {
    /// Freedoms of translation of a body, in front of its rotation.
    const TRANSLATION: usize;
    /// Numbers that store a body's configuration.
    const STORED: usize = Self::TRANSLATION + 4;
    /// Freedoms of a body.
    const FREEDOMS: usize = Self::TRANSLATION + 3;
    /// The space itself.
    const SPACE: Self;

    /// The pose of a body.
    ///
    /// # Errors
    /// A body that `q` does not hold.
    #[inline]
    fn pose(q: &[f64], body: usize) -> Result<RigidMotion, RigidError> {
        let bodies = q.len() / Self::STORED;
        if body < bodies {
            Ok(Self::pose_at(q, body))
        } else {
            Err(RigidError::NoSuchBody { body, bodies })
        }
    }

    /// The pose of a body that is there, as an index is: for steps, whose sizes were checked before.
    ///
    /// # Panics
    /// Where `q` does not hold the body.
    #[inline]
    fn pose_at(q: &[f64], body: usize) -> RigidMotion {
        let q = &q[Self::STORED.saturating_mul(body)..][..Self::STORED];
        let translation = match Self::TRANSLATION {
            0 => Vector3::zeros(),
            _ => Vector3::new(q[0], q[1], q[2]),
        };
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| q[Self::TRANSLATION + k]);
        RigidMotion { translation, rotation: Rotation::unchecked([w, x, y, z]) }
    }

    /// An error unless every pose is finite and its quaternion of length 1.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`]; [`RigidError::Size`] for numbers that are not whole poses;
    /// [`RigidError::Pose`] with the first body whose quaternion's length is off 1 by more than
    /// 1e-9.
    fn check(q: &[f64]) -> Result<(), RigidError> {
        crate::error::check_finite("the pose", q)?;
        let whole = q.len() / Self::STORED * Self::STORED;
        SizeError::check("the numbers of whole poses", whole, q.len())?;
        match first_stretched::<Self>(q) {
            Some((body, square)) => Err(RigidError::Pose { body, length: square.sqrt() }),
            None => Ok(()),
        }
    }
}

/// The pose of a body in a potential, of which a system checks the sizes when it is made: numbers that
/// are none where `q` does not hold it, so that no energy is finite.
#[inline]
pub(crate) fn pose_or_none<S: BodySpace>(q: &[f64], body: usize) -> RigidMotion {
    const NAN: f64 = f64::NAN;
    let nowhere = || RigidMotion {
        translation: Vector3::repeat(NAN),
        rotation: Rotation::unchecked([NAN; 4]),
    };
    S::pose(q, body).unwrap_or_else(|_| nowhere())
}

/// How far the square of a quaternion's length may be from 1: twice what a file with ten digits has.
const UNIT: f64 = 2e-9;

/// The first body whose quaternion's length is not 1, and its square.
#[inline]
fn first_stretched<S: BodySpace>(q: &[f64]) -> Option<(usize, f64)> {
    let squares =
        q.chunks_exact(S::STORED).map(|q| q[S::TRANSLATION..].iter().map(|c| c * c).sum::<f64>());
    squares.enumerate().find(|(_, square)| square.is_nan() || (square - 1.0).abs() > UNIT)
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

impl Curved for Poses {}
impl Curved for Orientations {}

impl Space for Poses {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / Self::FREEDOMS * Self::STORED
    }

    #[inline]
    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        advance::<Self>(q, h, v.0);
    }

    #[inline]
    fn first_misfit(&self, q: &[f64]) -> Option<usize> {
        first_stretched::<Self>(q).map(|(body, _)| Self::STORED * body + Self::TRANSLATION)
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

    #[inline]
    fn first_misfit(&self, q: &[f64]) -> Option<usize> {
        first_stretched::<Self>(q).map(|(body, _)| Self::STORED * body + Self::TRANSLATION)
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
