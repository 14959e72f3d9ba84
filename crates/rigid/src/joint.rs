//! Joints between bodies: ball, hinge and fixed, as constraints on poses.
//!
//! ```text
//! ball    x_1 - x_2 = 0                       x = t + R c               3 equations
//! hinge   and  <n_1, u_2> = <n_1, v_2> = 0    n the axis, u v across     5
//! fixed   and  <u_1, v_2> = <v_1, w_2> = <w_1, u_2> = 0                  6
//! d<a_1, b_2> = (a_1 x R_1^T b_2 , b_2 x R_2^T a_1)                      rows, per turn of 1 and 2
//! ```
//! `c` points (m) and `n u v w a b` unit directions in the axes of body 1 or 2, or of the world;
//! inner products are taken in the world. The last two rows of a hinge and three of a fixed joint
//! are pure numbers; all are regular where the joint is closed. A hinge's axis may also point the
//! other way, and a fixed joint has other solutions, such as half a turn off: a motion that starts
//! closed stays where it started.
//!
//! Multipliers are forces: those of the first three rows the force of end 2 on end 1, with its sign
//! turned, in newtons and world axes; the others torques. [`Rattle`] along [`FreeBodies`] moves
//! jointed bodies; straight motions, which would lose their gyroscopic torque, are not theirs.
//! Source: notes 6, 9.2; Haug, Computer Aided Kinematics and Dynamics, 9.4.

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::{FIXED, Sink, SizeError};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_read, check_values,
};

#[cfg(doc)]
use crate::FreeBodies;
use crate::error::check_finite;
use crate::{Attachment, BodySpace, LieGroup, RigidError};
#[cfg(doc)]
use stationary_constraints::Rattle;

/// A joint between two bodies, or a body and the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint<S> {
    bodies: usize,
    ends: [Attachment; 2],
    /// Directions that stay perpendicular.
    perpendicular: Vec<[Attachment; 2]>,
    space: S,
}

/// An orthonormal frame whose third direction is the given one.
fn frame(axis: Vector3<f64>) -> Result<[Vector3<f64>; 3], RigidError> {
    check_finite("the axis", axis.as_slice())?;
    if axis.amax() == 0.0 {
        return Err(RigidError::NoAxis(axis.into()));
    }
    let n = (axis / axis.amax()).normalize();
    let mut across = Vector3::zeros();
    across[n.iamin()] = 1.0;
    let u = n.cross(&across).normalize();
    Ok([u, n.cross(&u), n])
}

impl Attachment {
    /// The same place with another vector.
    fn with(&self, v: Vector3<f64>) -> Self {
        match *self {
            Attachment::World(_) => Attachment::World(v),
            Attachment::Body(body, _) => Attachment::Body(body, v),
        }
    }

    pub(crate) fn vector(&self) -> Vector3<f64> {
        match *self {
            Attachment::World(v) | Attachment::Body(_, v) => v,
        }
    }

    fn body(&self) -> Option<usize> {
        match *self {
            Attachment::World(_) => None,
            Attachment::Body(body, _) => Some(body),
        }
    }

    /// An error where its body is not among `bodies`.
    pub(crate) fn check_body(&self, bodies: usize) -> Result<(), RigidError> {
        match self.body().filter(|&body| body >= bodies) {
            Some(body) => Err(RigidError::NoSuchBody { body, bodies }),
            None => Ok(()),
        }
    }
}

impl<S: BodySpace> Joint<S> {
    /// Two points that stay together, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for a point that is not finite; [`RigidError::NoSuchBody`];
    /// [`RigidError::JoinedToItself`] for two ends on one body, or on the world.
    pub fn ball(space: S, bodies: usize, ends: [Attachment; 2]) -> Result<Self, RigidError> {
        for end in &ends {
            check_finite("the joint's point", end.vector().as_slice())?;
            end.check_body(bodies)?;
        }
        if ends[0].body() == ends[1].body() {
            return Err(RigidError::JoinedToItself { ends: ends.map(|end| end.body()) });
        }
        Ok(Joint { bodies, ends, perpendicular: Vec::new(), space })
    }

    /// A ball joint whose two axes, one in the axes of each end, stay parallel.
    ///
    /// # Errors
    /// Those of [`Joint::ball`]; [`RigidError::NonFinite`] and [`RigidError::NoAxis`] for an axis
    /// that is not finite or zero.
    pub fn hinge(
        space: S,
        bodies: usize,
        ends: [Attachment; 2],
        axes: [Vector3<f64>; 2],
    ) -> Result<Self, RigidError> {
        let [_, _, n] = frame(axes[0])?;
        let [u, v, _] = frame(axes[1])?;
        let joint = Joint::ball(space, bodies, ends)?;
        let pair = |across| [ends[0].with(n), ends[1].with(across)];
        Ok(Joint { perpendicular: vec![pair(u), pair(v)], ..joint })
    }

    /// A ball joint whose ends do not turn against each other, either: `frames` turns vectors in
    /// the joint's axes into those of each end.
    ///
    /// # Errors
    /// Those of [`Joint::ball`].
    pub fn fixed(
        space: S,
        bodies: usize,
        ends: [Attachment; 2],
        frames: [crate::Rotation; 2],
    ) -> Result<Self, RigidError> {
        let joint = Joint::ball(space, bodies, ends)?;
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let pair = |k: usize| {
            let turned = |end: usize, axis: usize| ends[end].with(frames[end].rotate(&axes[axis]));
            [turned(0, k), turned(1, (k + 1) % 3)]
        };
        Ok(Joint { perpendicular: (0..3).map(pair).collect(), ..joint })
    }

    /// An error where a configuration holds fewer bodies.
    fn check(&self, q: &[f64]) -> Result<(), SizeError> {
        check_read(S::STORED.saturating_mul(self.bodies), q)
    }

    fn place(q: &[f64], end: &Attachment) -> Vector3<f64> {
        match *end {
            Attachment::World(x) => x,
            Attachment::Body(body, c) => S::pose_at(q, body).apply(&c),
        }
    }

    fn direction(q: &[f64], of: &Attachment) -> Vector3<f64> {
        match *of {
            Attachment::World(v) => v,
            Attachment::Body(body, v) => S::pose_at(q, body).rotation.rotate(&v),
        }
    }

    /// The first freedom of rotation of an end's body.
    fn turns(body: usize) -> usize {
        S::FREEDOMS * body + S::TRANSLATION
    }
}

/// What the acceleration of a turning vector `v` adds to a Hessian where `g` multiplies it.
fn curvature(v: &Vector3<f64>, g: &Vector3<f64>) -> Matrix3<f64> {
    let product = g * v.transpose();
    (product + product.transpose()) * 0.5 - Matrix3::identity() * g.dot(v)
}

impl<S: BodySpace> ConstraintOn<S> for Joint<S> {}

impl<S: BodySpace> Constraint for Joint<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn count(&self) -> usize {
        3 + self.perpendicular.len()
    }

    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        self.check(q)?;
        let gap = Self::place(q, &self.ends[0]) - Self::place(q, &self.ends[1]);
        let across = self.perpendicular.iter();
        let across = across.map(|[a, b]| Self::direction(q, a).dot(&Self::direction(q, b)));
        g.iter_mut().zip(gap.iter().copied().chain(across)).for_each(|(g, value)| *g = value);
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.check(q)?;
        for row in 0..3 {
            for (end, sign) in self.ends.iter().zip([1.0, -1.0]) {
                let Attachment::Body(body, c) = *end else { continue };
                if S::TRANSLATION > 0 {
                    rows.add(row, S::FREEDOMS * body + row, sign);
                }
                // <e, R (a x c)> = <a, c x R^T e>
                let mut e = Vector3::zeros();
                e[row] = sign;
                let turn = c.cross(&S::pose_at(q, body).rotation.rotate_back(&e));
                (0..3).for_each(|k| rows.add(row, Self::turns(body) + k, turn[k]));
            }
        }
        for (k, [a, b]) in self.perpendicular.iter().enumerate() {
            for (one, other) in [(a, b), (b, a)] {
                let Attachment::Body(body, v) = *one else { continue };
                let seen = S::pose_at(q, body).rotation.rotate_back(&Self::direction(q, other));
                let turn = v.cross(&seen);
                (0..3).for_each(|c| rows.add(3 + k, Self::turns(body) + c, turn[c]));
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        self.check(q)?;
        let block = |body: usize| [0, 1, 2].map(|c| Self::turns(body) + c);
        let pull = Vector3::from_column_slice(&lambda[..3]);
        for (end, sign) in self.ends.iter().zip([1.0, -1.0]) {
            let Attachment::Body(body, c) = *end else { continue };
            let g = S::pose_at(q, body).rotation.rotate_back(&(pull * sign));
            hessian.add_symmetric(&block(body), curvature(&c, &g).as_slice());
        }
        for ([a, b], &lambda) in self.perpendicular.iter().zip(&lambda[3..]) {
            let mut whole = nalgebra::SMatrix::<f64, 6, 6>::zeros();
            let mut freedoms = [FIXED; 6];
            let mut moved = [Matrix3::zeros(); 2];
            for (side, (one, other)) in [(a, b), (b, a)].into_iter().enumerate() {
                let Attachment::Body(body, v) = *one else { continue };
                let rotation = S::pose_at(q, body).rotation;
                let seen = rotation.rotate_back(&Self::direction(q, other));
                let first = 3 * side;
                whole.fixed_view_mut::<3, 3>(first, first).copy_from(&curvature(&v, &seen));
                freedoms[first..first + 3].copy_from_slice(&block(body));
                moved[side] = rotation.matrix() * v.cross_matrix();
            }
            let cross = moved[0].transpose() * moved[1];
            whole.fixed_view_mut::<3, 3>(0, 3).copy_from(&cross);
            whole.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross.transpose());
            hessian.add_symmetric(&freedoms, (whole * lambda).as_slice());
        }
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        let arm = self.ends.iter().filter(|end| end.body().is_some());
        let arm = arm.map(|end| end.vector().norm()).fold(0.0, f64::max);
        match row {
            0..3 if arm > 0.0 => Scale { slope: 1.0, length: arm },
            _ => Scale::default(),
        }
    }
}
