//! How the joints of a tree move: each by a product of motions along fixed screws.
//!
//! ```text
//! J(q) = exp(q1 s1) exp(q2 s2) ...        the body's frame G as seen from the parent's frame F
//! S = (u, w) columns                      of the speeds: velocity of G's origin, and rotation
//! ```
//! Coordinates and speeds are those of [`JointKind`]; F and G coincide where all coordinates are zero
//! and quaternions 1. Metres, radians. `S` is seen from F here. Only the universal joint's has a rate of change of its
//! own as seen from there: `v1 v2 a x R b`. Of a quaternion only the direction matters. Source:
//! Featherstone 2008, 4.4; notes 8.2.

use nalgebra::{Vector3, Vector4};

use super::spatial::Twist;
use crate::{JointKind, LieGroup, RigidMotion, Rotation};

use JointKind::{
    Ball, Cylinder, Free, Hinge, OnCircle, OnLine, Planar, Rod, Screw, Slider, Universal, Weld,
};

/// Twists of a joint's speeds; a joint has at most six.
pub(super) type Columns = [Twist; 6];

/// The turn about a unit axis.
#[inline]
pub(super) fn turn(axis: &Vector3<f64>, angle: f64) -> Rotation {
    let (sine, cosine) = (0.5 * angle).sin_cos();
    Rotation::unchecked([cosine, axis.x * sine, axis.y * sine, axis.z * sine])
}

/// The rotation of a quaternion of any length.
fn rotation(q: &[f64]) -> Rotation {
    Rotation::unchecked([q[0], q[1], q[2], q[3]]).normalized()
}

fn quaternion_rate(q: &[f64], w: &[f64], rate: &mut [f64]) {
    let (scalar, x) = (q[0], Vector3::new(q[1], q[2], q[3]));
    let w = Vector3::new(w[0], w[1], w[2]) * 0.5;
    rate[0] = -x.dot(&w);
    rate[1..].copy_from_slice((w * scalar + x.cross(&w)).as_slice());
}

fn turned_quaternion(q: &mut [f64], by: &[f64]) {
    let next = rotation(q).compose(&Rotation::exp(Vector3::new(by[0], by[1], by[2])));
    q.copy_from_slice(&next.normalized().quaternion());
}

impl JointKind {
    /// How many coordinates it has.
    pub(super) fn coordinates(&self) -> usize {
        match self {
            Ball => 4,
            Free => 7,
            _ => self.freedoms(),
        }
    }

    /// The first of its coordinates that belong to a quaternion.
    pub(super) fn quaternion(&self) -> Option<usize> {
        match self {
            Ball => Some(0),
            Free => Some(3),
            _ => None,
        }
    }

    /// Writes the coordinates at which both frames coincide.
    pub(super) fn rest(&self, q: &mut [f64]) {
        q.fill(0.0);
        if let Some(first) = self.quaternion() {
            q[first] = 1.0;
        }
    }

    /// The motion `J(q)`, with the axes in F's axes that the speeds are seen along.
    #[inline]
    pub(super) fn motion(&self, q: &[f64]) -> RigidMotion {
        let at = |translation, rotation| RigidMotion { translation, rotation };
        let here = Vector3::zeros();
        match self {
            // The builder refuses the last three.
            Weld | Rod { .. } | OnLine { .. } | OnCircle { .. } => RigidMotion::identity(),
            Hinge { axis } => at(here, turn(axis, q[0])),
            Slider { axis } => at(axis * q[0], Rotation::identity()),
            Screw { axis, pitch } => at(axis * (pitch * q[0]), turn(axis, q[0])),
            Cylinder { axis } => at(axis * q[0], turn(axis, q[1])),
            Universal { axes: [a, b] } => at(here, turn(a, q[0]).compose(&turn(b, q[1]))),
            Planar { axes: [a, b] } => at(a * q[0] + b * q[1], turn(&a.cross(b).normalize(), q[2])),
            Ball => at(here, rotation(q)),
            Free => at(Vector3::new(q[0], q[1], q[2]), rotation(&q[3..])),
        }
    }

    /// The twist of each speed: velocity of G's origin and rotation, in F's axes.
    #[inline]
    pub(super) fn columns(&self, q: &[f64], motion: &RigidMotion, columns: &mut Columns) {
        let shift = |v: Vector3<f64>| Twist { linear: v, angular: Vector3::zeros() };
        let spin = |w: Vector3<f64>| Twist { linear: Vector3::zeros(), angular: w };
        let unit = |k: usize| Vector3::ith(k, 1.0);
        match self {
            Weld | Rod { .. } | OnLine { .. } | OnCircle { .. } => {}
            Hinge { axis } => columns[0] = spin(*axis),
            Slider { axis } => columns[0] = shift(*axis),
            Screw { axis, pitch } => {
                columns[0] = Twist { linear: axis * *pitch, angular: *axis };
            }
            Cylinder { axis } => {
                columns[0] = shift(*axis);
                columns[1] = spin(*axis);
            }
            Universal { axes: [a, b] } => {
                columns[0] = spin(*a);
                columns[1] = spin(turn(a, q[0]).rotate(b));
            }
            Planar { axes: [a, b] } => {
                columns[0] = shift(*a);
                columns[1] = shift(*b);
                columns[2] = spin(a.cross(b).normalize());
            }
            Ball => (0..3).for_each(|k| columns[k] = spin(motion.rotation.rotate(&unit(k)))),
            Free => (0..3).for_each(|k| {
                columns[k] = shift(unit(k));
                columns[3 + k] = spin(motion.rotation.rotate(&unit(k)));
            }),
        }
    }

    /// How the columns change along the speeds, times the speeds: an angular acceleration in F's
    /// axes.
    #[inline]
    pub(super) fn bias(&self, q: &[f64], v: &[f64]) -> Option<Vector3<f64>> {
        match self {
            Universal { axes: [a, b] } => Some(a.cross(&turn(a, q[0]).rotate(b)) * (v[0] * v[1])),
            _ => None,
        }
    }

    /// The rate of the coordinates at these speeds. It leaves a quaternion's length, and is in
    /// proportion to it.
    #[inline]
    pub(super) fn rate(&self, q: &[f64], v: &[f64], rate: &mut [f64]) {
        match self.quaternion() {
            None => rate.copy_from_slice(v),
            Some(first) => {
                rate[..first].copy_from_slice(&v[..first]);
                quaternion_rate(&q[first..], &v[first..], &mut rate[first..]);
            }
        }
    }

    /// Moves the coordinates along a displacement in the axes of the speeds.
    #[inline]
    pub(super) fn advance(&self, q: &mut [f64], by: &[f64]) {
        let flat = self.quaternion().unwrap_or(q.len());
        q[..flat].iter_mut().zip(by).for_each(|(q, by)| *q += by);
        if flat < q.len() {
            turned_quaternion(&mut q[flat..], &by[flat..]);
        }
    }

    /// The length of its quaternion, where that has no direction.
    #[inline]
    pub(super) fn lost_quaternion(&self, q: &[f64]) -> Option<f64> {
        let q = &q[self.quaternion()?..];
        let square = Vector4::new(q[0], q[1], q[2], q[3]).norm_squared();
        (!square.is_normal()).then(|| square.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);
    const B: Vector3<f64> = Vector3::new(0.0, 1.0, 0.0);

    pub(super) const ALL: [JointKind; 9] = [
        Weld,
        Hinge { axis: A },
        Slider { axis: A },
        Screw { axis: A, pitch: 0.3 },
        Cylinder { axis: A },
        Universal { axes: [A, B] },
        Planar { axes: [A, B] },
        Ball,
        Free,
    ];

    fn some() -> ([f64; 7], [f64; 6]) {
        ([0.4, -0.7, 1.1, 0.3, -0.2, 0.5, 0.9], [0.8, -1.3, 0.6, 1.7, -0.4, 0.2])
    }

    /// `(velocity of the origin, angular velocity)` of a motion by differences along its coordinates.
    fn difference(joint: &JointKind, q: &[f64], v: &[f64]) -> Twist {
        let e = 1e-6;
        let moved = |sign: f64| {
            let mut moved = q.to_vec();
            let by: Vec<_> = v.iter().map(|v| v * sign * e).collect();
            joint.advance(&mut moved, &by);
            joint.motion(&moved)
        };
        let (ahead, behind) = (moved(1.0), moved(-1.0));
        Twist {
            linear: (ahead.translation - behind.translation) / (2.0 * e),
            angular: ahead.rotation.compose(&behind.rotation.inverse()).log() / (2.0 * e),
        }
    }

    #[test]
    fn every_joint_moves_along_its_columns() {
        for joint in ALL {
            let (q, v) = some();
            let (q, v) = (&q[..joint.coordinates()], &v[..joint.freedoms()]);
            let mut columns = [Twist::zero(); 6];
            joint.columns(q, &joint.motion(q), &mut columns);
            let sum = |twist, (column, v): (&Twist, &f64)| twist + *column * *v;
            let twist = columns.iter().zip(v).fold(Twist::zero(), sum);
            let expected = difference(&joint, q, v);
            let off =
                (twist.linear - expected.linear).norm() + (twist.angular - expected.angular).norm();
            assert!(off < 1e-9, "{}: {off:e}", joint.name());
        }
    }

    #[test]
    fn the_rate_of_a_quaternion_keeps_its_length_and_grows_with_it() {
        let (q, v) = some();
        let (q, w) = ([q[3], q[4], q[5], q[6]], &v[..3]);
        let mut rate = [0.0; 4];
        Ball.rate(&q, w, &mut rate);
        assert!(q.iter().zip(&rate).map(|(q, rate)| q * rate).sum::<f64>().abs() < 1e-15);
        let mut double = [0.0; 4];
        Ball.rate(&q.map(|q| 2.0 * q), w, &mut double);
        assert!((0..4).all(|k| double[k] == 2.0 * rate[k]));
    }
}
