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

use nalgebra::Vector3;

use super::builder::Link;
use super::error::{TreeError, check_numbers};
use super::joint::turn;
use super::motion::{Moving, TreeMotion};
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
        self.coordinates[link.coordinates.clone()].copy_from_slice(q);
        let (before, own) = self.placed.split_at_mut(body);
        let parent = link.parent.map_or(&self.ground, |parent| &before[parent]);
        let (placed, columns) = (&mut own[0], &mut self.columns[link.speeds.clone()]);
        let RigidMotion { translation, rotation } = &link.before;
        let turned = link.turned[0].then(|| parent.rotation.compose(rotation));
        let frame = turned.as_ref().unwrap_or(&parent.rotation);
        let turned_axes = turned.map(|turned| turned.matrix());
        let axes = turned_axes.as_ref().unwrap_or(&parent.matrix);
        placed.reach = parent.matrix * translation;
        if let JointKind::Hinge { axis } = &link.joint {
            placed.turn_by(&frame.compose(&turn(axis, q[0])), link);
            let angular = axes * axis;
            columns[0] = Twist { linear: angular.cross(&placed.arm), angular };
        } else {
            let joint = link.joint.motion(q);
            placed.turn_by(&frame.compose(&joint.rotation), link);
            placed.reach += axes * joint.translation;
            let mut local = [Twist::zero(); 6];
            link.joint.columns(q, &joint, &mut local);
            for (column, local) in columns.iter_mut().zip(&local) {
                let origin = Twist { linear: axes * local.linear, angular: axes * local.angular };
                *column = origin.outward(&placed.arm);
            }
        }
        placed.centre = parent.centre + placed.offset();
    }

    /// Velocities and biases, of a tree that was put at `q`.
    pub(super) fn set_moving(&mut self, q: &[f64], v: &[f64]) {
        let TreeMotion { tree, placed, moving, columns, .. } = self;
        for (body, link) in tree.links.iter().enumerate() {
            let Link { parent, joint, before, coordinates, speeds, .. } = link;
            let base = parent.map_or(Twist::zero(), |parent| moving[parent].twist);
            let v = &v[speeds.clone()];
            let mut own = Twist::zero();
            for (column, v) in columns[speeds.clone()].iter().zip(v) {
                own += *column * *v;
            }
            let here = &placed[body];
            let (w, arm) = (base.angular, here.arm);
            let twist = base.outward(&here.offset()) + own;
            let mut angular = w.cross(&own.angular);
            let mut swung = w.cross(&here.reach);
            // A hinge leaves its origin where it is.
            if !matches!(joint, JointKind::Hinge { .. }) {
                swung += (own.linear - own.angular.cross(&arm)) * 2.0;
                if let Some(own) = joint.bias(&q[coordinates.clone()], v) {
                    let turned = parent.map_or(Rotation::identity(), |p| placed[p].rotation);
                    angular += turned.compose(&before.rotation).rotate(&own);
                }
            }
            let spin = twist.angular;
            let linear = w.cross(&swung) + angular.cross(&arm) + spin.cross(&spin.cross(&arm));
            moving[body] = Moving { twist, bias: Twist { linear, angular } };
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
