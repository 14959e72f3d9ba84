//! A contact point: a gap, where it is, and its differential.
//!
//! ```text
//! g = n.(x2 - x1)                          the gap, m; negative where the bodies overlap     (11.2)
//! dg = (-n, -c1 x R1^T n,  n, c2 x R2^T n)  on the velocities (t1., w1, t2., w2)             (11.4.1)
//! ```
//! `n` the unit normal from the first body to the second, world axes; `x1 x2` the points that face
//! each other; `c` the same in body axes, from the centre. The normal's own rate drops out: it is
//! perpendicular to the gap where the points are closest. What belongs to a fixed shape has no
//! columns.

use nalgebra::Vector3;
use stationary_calculus::Vector;
use stationary_rigid::{BodySpace, Poses, force_at_point};

use crate::ContactRows;

/// Which features of which colliders face each other: the same from step to step while they do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ContactId {
    /// The two colliders, the smaller number first.
    pub colliders: [u32; 2],
    /// The triangle of each, where it is a mesh.
    pub parts: [u32; 2],
    /// The vertex, edge or face of each, as the geometry library packs them.
    pub features: [u32; 2],
}

/// Two points that face each other across a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// What it is between.
    pub id: ContactId,
    /// The bodies; none where a fixed shape takes part.
    pub bodies: [Option<usize>; 2],
    /// The gap, m.
    pub gap: f64,
    /// From the first to the second, of length 1, world axes.
    pub normal: Vector3<f64>,
    /// Where each point is, world axes.
    pub points: [Vector3<f64>; 2],
    /// Where each is in the axes of its body, or in the world.
    pub arms: [Vector3<f64>; 2],
    /// The restitution of the pair.
    pub restitution: f64,
    /// The friction of the pair.
    pub friction: f64,
}

impl ContactPoint {
    /// Appends the differential of the gap at the poses `q`.
    pub fn push_row(&self, q: &[f64], rows: &mut ContactRows) {
        self.push_along(q, &self.normal, rows);
    }

    /// Appends the rates of sliding along two directions across the normal.
    pub fn push_tangents(&self, q: &[f64], rows: &mut ContactRows) {
        for tangent in self.tangents() {
            self.push_along(q, &tangent, rows);
        }
    }

    /// How fast the second point slides along the first at these velocities, m/s.
    pub fn sliding(&self, q: &[f64], v: Vector<&[f64]>) -> f64 {
        let rate = |k: usize| match self.bodies[k] {
            Some(body) => {
                let [x, y, z, a, b, c] = [0, 1, 2, 3, 4, 5].map(|f| v.0[6 * body + f]);
                let turning = Vector3::new(a, b, c).cross(&self.arms[k]);
                Vector3::new(x, y, z) + Poses::pose(q, body).rotation.rotate(&turning)
            }
            None => Vector3::zeros(),
        };
        let apart = rate(1) - rate(0);
        (apart - self.normal * apart.dot(&self.normal)).norm()
    }

    /// Two unit vectors across the normal and each other.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        let n = &self.normal;
        let axis = Vector3::ith(n.iamin(), 1.0);
        let first = n.cross(&axis).normalize();
        [first, n.cross(&first)]
    }

    /// Appends the rate at which the second point leaves the first along a direction.
    fn push_along(&self, q: &[f64], direction: &Vector3<f64>, rows: &mut ContactRows) {
        let side = |k: usize, sign: f64| {
            self.bodies[k].map(|body| {
                let pose = Poses::pose(q, body);
                let wrench = force_at_point(&pose, &self.arms[k], direction * sign);
                let at = move |c: usize, value: f64| (6 * body + c, value);
                [
                    at(0, wrench.force.x),
                    at(1, wrench.force.y),
                    at(2, wrench.force.z),
                    at(3, wrench.torque.x),
                    at(4, wrench.torque.y),
                    at(5, wrench.torque.z),
                ]
            })
        };
        let both = [side(0, -1.0), side(1, 1.0)];
        rows.push(both.into_iter().flatten().flatten());
    }
}
