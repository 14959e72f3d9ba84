//! Forward kinematics: poses, velocities and what velocities add to accelerations, outward.
//!
//! ```text
//! x_G = x_p + R_p F + R_F J,        x = x_G + d,         d = -R G          places
//! w = w_p + W,                      W = R_F sum w_k v_k
//! v = v_p + w_p x r + U + W x d,    U = R_F sum u_k v_k,   r = x - x_p      velocities
//! alpha = w_p x W + R_F b
//! a = w_p x (w_p x (x_G - x_p)) + 2 w_p x U + alpha x d + w x (w x d)      bias
//! ```
//! `p` the parent, `u w` the columns of the joint and `b` their own rate ([`JointKind`]), `d` from
//! the joint to the body's centre. Accelerations are those of the centre itself. Source: Featherstone
//! 2008, 4 and 5, told at centres; the theorem of Coriolis.
//!
//! [`JointKind`]: crate::JointKind

use nalgebra::{Matrix3, Vector3};

use super::builder::Link;
use super::error::{TreeError, check_numbers};
use super::motion::TreeMotion;
use super::spatial::Twist;
use crate::{JointKind, LieGroup, RigidMotion, Rotation};

impl TreeMotion {
    /// Places the tree at these coordinates, moving with these speeds.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite, a quaternion without a direction. The
    /// motion is then as it was.
    pub fn place(&mut self, q: &[f64], v: &[f64]) -> Result<(), TreeError> {
        self.tree.check_coordinates(q)?;
        self.tree.check_speeds("the speeds", v)?;
        self.put(q);
        self.set_moving(q, v);
        Ok(())
    }

    /// Poses and columns.
    pub(super) fn put(&mut self, q: &[f64]) {
        for body in 0..self.placed.len() {
            let own = self.tree.links[body].coordinates.clone();
            self.put_body(body, &q[own]);
        }
    }

    /// The pose and the columns of a body whose parent is placed, at the coordinates of its joint.
    #[inline]
    pub(super) fn put_body(&mut self, body: usize, q: &[f64]) {
        let link = &self.tree.links[body];
        let (centre, turned, matrix) = match link.parent {
            Some(parent) => {
                let parent = &self.placed[parent];
                (parent.centre, parent.rotation, parent.matrix)
            }
            None => (Vector3::zeros(), Rotation::identity(), Matrix3::identity()),
        };
        let RigidMotion { translation, rotation } = link.before;
        let (frame, axes) = if link.turned[0] {
            let frame = turned.compose(&rotation);
            (frame, frame.matrix())
        } else {
            (turned, matrix)
        };
        let joint = link.joint.motion(q);
        let placed = &mut self.placed[body];
        placed.rotation = frame.compose(&joint.rotation);
        if link.turned[1] {
            placed.rotation = placed.rotation.compose(&link.after.rotation);
        }
        placed.matrix = placed.rotation.matrix();
        placed.reach = matrix * translation;
        placed.arm = -(placed.matrix * link.on_body.translation);
        let columns = &mut self.columns[link.speeds.clone()];
        if let JointKind::Hinge { axis } = &link.joint {
            let origin = Twist { linear: Vector3::zeros(), angular: axes * axis };
            columns[0] = origin.outward(&placed.arm);
        } else {
            placed.reach += axes * joint.translation;
            let mut local = [Twist::zero(); 6];
            link.joint.columns(q, &joint, &mut local);
            for (column, local) in columns.iter_mut().zip(&local) {
                let origin = Twist { linear: axes * local.linear, angular: axes * local.angular };
                *column = origin.outward(&placed.arm);
            }
        }
        placed.centre = centre + placed.offset();
    }

    /// Velocities and biases, of a tree that was put at `q`.
    pub(super) fn set_moving(&mut self, q: &[f64], v: &[f64]) {
        for body in 0..self.placed.len() {
            let Link { parent, joint, before, coordinates, speeds, .. } = &self.tree.links[body];
            let (base, turned) = match *parent {
                Some(parent) => (self.moving[parent].twist, self.placed[parent].rotation),
                None => (Twist::zero(), Rotation::identity()),
            };
            let (q, v) = (&q[coordinates.clone()], &v[speeds.clone()]);
            let mut own = Twist::zero();
            for (column, v) in self.columns[speeds.clone()].iter().zip(v) {
                own += *column * *v;
            }
            let (placed, moving) = (&self.placed[body], &mut self.moving[body]);
            let (w, arm) = (base.angular, placed.arm);
            moving.twist = base.outward(&placed.offset()) + own;
            let shift = own.linear - own.angular.cross(&arm);
            let mut angular = w.cross(&own.angular);
            if let Some(own) = joint.bias(q, v) {
                angular += turned.compose(&before.rotation).rotate(&own);
            }
            let spin = moving.twist.angular;
            let linear = w.cross(&(w.cross(&placed.reach) + shift * 2.0))
                + angular.cross(&arm)
                + spin.cross(&spin.cross(&arm));
            moving.bias = Twist { linear, angular };
        }
    }

    /// Writes how the velocity of a point of a body, in world axes, depends on the speeds: three
    /// rows, by columns, entry (i, j) at `i + 3 j`. `point` is in body axes, metres.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`], a point that is not finite, another size than `3 n`.
    pub fn point_jacobian(
        &self,
        body: usize,
        point: &Vector3<f64>,
        jacobian: &mut [f64],
    ) -> Result<(), TreeError> {
        check_numbers("the point", 3, point.as_slice())?;
        let placed = self.placed(body)?;
        stationary_calculus::SizeError::check(
            "the jacobian's numbers",
            3 * self.columns.len(),
            jacobian.len(),
        )?;
        jacobian.fill(0.0);
        // From the centre of each body on the way to the point.
        let mut arm = placed.matrix * point;
        let mut on_the_way = Some(body);
        while let Some(body) = on_the_way {
            let link = &self.tree.links[body];
            for k in link.speeds.clone() {
                let velocity = self.columns[k].outward(&arm).linear;
                jacobian[3 * k..][..3].copy_from_slice(velocity.as_slice());
            }
            arm += self.placed[body].offset();
            on_the_way = link.parent;
        }
        Ok(())
    }
}
