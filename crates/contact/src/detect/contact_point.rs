//! A contact point: a gap, where it is, and its differential.
//!
//! ```text
//! g = n.(x2 - x1)                         the gap, m; negative where the bodies overlap     (11.2)
//! dg = (-n, -c1 x R1^T n,  n, c2 x R2^T n)  on the velocities (t1., w1, t2., w2)          (11.4.1)
//! dg = (-n, -n.Z R1 c1,  n, n.Z R2 c2)      in the plane, on (t1., theta1., t2., theta2.)
//! ```
//! `n` the unit normal from the first body to the second, world axes; `x1 x2` the points that face
//! each other; `c` the same in body axes, from the centre. The normal's own rate drops out: it is
//! perpendicular to the gap where the points are closest. What belongs to a fixed shape has no
//! columns.

use crate::solve::body_state::speed;
use crate::{ContactRows, Dimension};

/// Which features of which colliders face each other: the same from step to step while they do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ContactId {
    /// The two colliders, the smaller number first.
    pub colliders: [u32; 2],
    /// The triangle of each, where it is a mesh; the convex piece, where it is a polygon.
    pub parts: [u32; 2],
    /// The vertex, edge or face of each, as the geometry library packs them.
    pub features: [u32; 2],
}

impl ContactId {
    /// The two colliders.
    pub(crate) fn pair(&self) -> [usize; 2] {
        self.colliders.map(|collider| collider as usize)
    }
}

/// Two points that face each other across a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactIn<G: Dimension> {
    /// What it is between.
    pub id: ContactId,
    /// The bodies; none where a fixed shape takes part.
    pub bodies: [Option<usize>; 2],
    /// The gap, m.
    pub gap: f64,
    /// From the first to the second, of length 1, world axes.
    pub normal: G::Vector,
    /// Where each point is, world axes.
    pub points: [G::Vector; 2],
    /// Where each is in the axes of its body, or in the world.
    pub arms: [G::Vector; 2],
    /// The restitution of the pair.
    pub restitution: f64,
    /// The friction of the pair.
    pub friction: f64,
}

/// Two points in space that face each other.
#[cfg(feature = "3d")]
pub type ContactPoint = ContactIn<crate::Spatial>;
/// Two points in the plane that face each other.
#[cfg(feature = "2d")]
pub type PlanarContactPoint = ContactIn<crate::Planar>;

impl<G: Dimension> ContactIn<G> {
    /// Whether both are between the same colliders.
    pub(crate) fn same_pair(&self, other: &Self) -> bool {
        self.id.colliders == other.id.colliders
    }

    /// Appends the differential of the gap at the poses `q`.
    pub fn push_row(&self, q: &[f64], rows: &mut ContactRows) {
        self.push_along(q, &self.normal, rows);
    }

    /// Appends the rates of sliding along each direction across the normal.
    pub fn push_tangents(&self, q: &[f64], rows: &mut ContactRows) {
        for tangent in self.tangents() {
            self.push_along(q, &tangent, rows);
        }
    }

    /// The unit vectors across the normal and each other.
    pub fn tangents(&self) -> impl Iterator<Item = G::Vector> {
        let directions = G::directions(&self.normal);
        let count = directions.as_ref().len();
        (1..count).map(move |k| directions.as_ref()[k])
    }

    /// How fast its bodies move where they meet, each at most and whatever the direction, m/s.
    pub(crate) fn speed(&self, v: &[f64]) -> f64 {
        let side = |k: usize| {
            let arm = G::dot(&self.arms[k], &self.arms[k]).sqrt();
            let own = |body: usize| speed::<G>(&v[G::FREEDOMS * body..][..G::FREEDOMS], arm);
            self.bodies[k].map_or(0.0, own)
        };
        side(0) + side(1)
    }

    /// Appends the rate at which the second point leaves the first along a direction.
    fn push_along(&self, q: &[f64], direction: &G::Vector, rows: &mut ContactRows) {
        let side = |k: usize, sign: f64| {
            self.bodies[k].into_iter().flat_map(move |body| {
                let frame = G::frame(&G::pose(q, body));
                let arm = G::rotate(&frame, &self.arms[k]);
                let row = G::row(&frame, &arm, &(*direction * sign));
                row.into_iter().enumerate().map(move |(c, value)| (G::FREEDOMS * body + c, value))
            })
        };
        rows.push(side(0, -1.0).chain(side(1, 1.0)));
    }
}
