//! A contact of two rigid bodies, packed for many visits: how each rubs and pushes the other.
//!
//! ```text
//! w = M^1/2 (v - v_f),   J~ = J M^-1/2          scaled velocities, and rows in their terms
//! u = J~ w + o,          o = J v_f + (bias, 0, 0)            rates along normal and tangents, m/s
//! w += J~^T x,           x = (lambda, beta)                  impulses, N s
//! W = J~ J~^T                                                the contact's compliance, 1/kg
//! ```
//! `J` (3 x 6 a body) the rates at which the second point leaves the first along the normal and two
//! tangents, `v_f` the velocity before any impulse, `M` the masses. In scaled velocities a row is
//! its own lift, so that a visit reads each number once. What no impulse moves has no rows; its
//! velocity is in `o`. Source: notes 11.4.1, 11.4.2.

use nalgebra::{Matrix3, Vector3};
use stationary_rigid::{Body, BodySpace, LieGroup, Poses};

use crate::{ContactError, ContactPoint};

/// Six scaled velocities of a body.
pub(crate) type Six = [f64; 6];

/// Where a body is and how impulses move it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// Where its centre is, and how it turns into world axes.
    pub(crate) centre: Vector3<f64>,
    pub(crate) rotation: Matrix3<f64>,
    /// One over the root of mass and moments; zeros where no impulse moves it.
    pub(crate) scale: Six,
    /// Its velocity before any impulse.
    pub(crate) velocity: Six,
}

impl Placed {
    /// A body at its pose among `q` with its velocity among `v`.
    #[inline]
    pub(crate) fn new(body: usize, scale: Six, q: &[f64], v: &[f64]) -> Self {
        let pose = Poses::pose_at(q, body);
        let (centre, rotation) = (pose.translation, pose.rotation.matrix());
        Placed { centre, rotation, scale, velocity: std::array::from_fn(|k| v[6 * body + k]) }
    }

    /// Its velocity after scaled changes.
    #[inline]
    pub(crate) fn after(&self, w: &Six) -> Six {
        std::array::from_fn(|k| self.velocity[k] + self.scale[k] * w[k])
    }

    /// The velocity of a point of it, world axes.
    #[inline]
    pub(crate) fn velocity_at(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        let [x, y, z, a, b, c] = self.velocity;
        Vector3::new(x, y, z) + self.rotation * Vector3::new(a, b, c).cross(arm)
    }

    /// Whether impulses move it.
    #[inline]
    pub(crate) fn moves(&self) -> bool {
        self.scale[0] > 0.0
    }
}

/// How fast what is within a radius of a body's centre moves at most, at this velocity of the body.
#[inline]
pub(crate) fn speed(velocity: &[f64], radius: f64) -> f64 {
    let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    length(&velocity[..3]) + radius * length(&velocity[3..])
}

/// How impulses scale the velocities of a body.
pub(crate) fn scale(body: &Body) -> Six {
    let root = |inertia: f64| inertia.sqrt().recip();
    let (mass, moments) = (root(body.mass()), body.moments().map(root));
    [mass, mass, mass, moments.x, moments.y, moments.z]
}

/// A contact, packed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidContact {
    /// Whose velocities it reads and changes; the number of bodies for what does not move.
    pub(crate) bodies: [usize; 2],
    /// Its coefficient of friction.
    pub(crate) friction: f64,
    /// The rates before any impulse, and how much of the gap is left over the step.
    pub(crate) offset: [f64; 3],
    /// What unit impulses change of the rates.
    pub(crate) compliance: Compliance,
    rows: [[Six; 3]; 2],
}

/// The symmetric matrix `W` of a contact, and what is divided by it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Compliance {
    pub(crate) normal: f64,
    /// Of the normal with each tangent.
    pub(crate) coupling: [f64; 2],
    /// The largest eigenvalue of `W_tt`.
    pub(crate) across: f64,
    /// One over the compliance along the normal.
    pub(crate) normal_mass: f64,
    /// The inverse of `W_tt`: its diagonal, then what is beside it; zeros where one direction does
    /// not give way.
    pub(crate) tangent_mass: [f64; 3],
    /// One over `across`.
    pub(crate) across_mass: f64,
}

/// An inverse is taken where the smaller eigenvalue is more than rounding of the larger.
const SINGULAR: f64 = 1e-12;

impl Compliance {
    #[inline]
    fn of(rows: &[[Six; 3]; 2]) -> Self {
        let product =
            |k: usize, l: usize| -> f64 { rows.iter().map(|rows| dot(&rows[k], &rows[l])).sum() };
        let (normal, coupling) = (product(0, 0), [product(0, 1), product(0, 2)]);
        let [xx, yy, xy] = [product(1, 1), product(2, 2), product(1, 2)];
        let half = 0.5 * (xx - yy);
        let across = 0.5 * (xx + yy) + (half * half + xy * xy).sqrt();
        let determinant = xx * yy - xy * xy;
        let regular = determinant > SINGULAR * across * across;
        let tangent_mass = if regular { [yy, xx, -xy].map(|x| x / determinant) } else { [0.0; 3] };
        Compliance {
            normal,
            coupling,
            across,
            normal_mass: normal.recip(),
            tangent_mass,
            across_mass: across.recip(),
        }
    }
}

impl RigidContact {
    /// The contact at a point with these tangents, between bodies that are placed; an error where
    /// neither moves.
    pub(crate) fn new(
        number: usize,
        point: &ContactPoint,
        [first, second]: [Vector3<f64>; 2],
        bias: f64,
        placed: &[Placed],
    ) -> Result<Self, ContactError> {
        let mut contact = RigidContact {
            bodies: [placed.len(); 2],
            friction: point.friction,
            offset: [bias, 0.0, 0.0],
            compliance: Compliance::default(),
            rows: [[[0.0; 6]; 3]; 2],
        };
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(body) = point.bodies[side] {
                let directions = [point.normal * sign, first * sign, second * sign];
                contact.reach(side, body, &point.arms[side], &directions, placed);
            }
        }
        contact.compliance = Compliance::of(&contact.rows);
        match contact.compliance.normal_mass.is_finite() {
            true => Ok(contact),
            false => Err(ContactError::Immovable { contact: number }),
        }
    }

    #[inline]
    fn reach(
        &mut self,
        side: usize,
        body: usize,
        arm: &Vector3<f64>,
        directions: &[Vector3<f64>; 3],
        placed: &[Placed],
    ) {
        let at = &placed[body];
        for (k, direction) in directions.iter().enumerate() {
            let torque = arm.cross(&at.rotation.tr_mul(direction));
            let row = [direction.x, direction.y, direction.z, torque.x, torque.y, torque.z];
            self.offset[k] += dot(&row, &at.velocity);
            self.rows[side][k] = std::array::from_fn(|f| row[f] * at.scale[f]);
        }
        if at.moves() {
            self.bodies[side] = body;
        }
    }

    /// The rates along the normal and the tangents, m/s.
    #[inline]
    pub(crate) fn rates(&self, w: &[Six]) -> [f64; 3] {
        let (a, b) = (&w[self.bodies[0]], &w[self.bodies[1]]);
        std::array::from_fn(|k| self.rate(k, a, b))
    }

    #[inline]
    fn rate(&self, k: usize, a: &Six, b: &Six) -> f64 {
        self.offset[k] + (dot(&self.rows[0][k], a) + dot(&self.rows[1][k], b))
    }

    /// The rows of one of its bodies.
    #[inline]
    pub(crate) fn rows(&self, side: usize) -> &[Six; 3] {
        &self.rows[side]
    }

    /// How much the rates change with these changes of the bodies' velocities.
    #[inline]
    pub(crate) fn pull(&self, a: &Six, b: &Six) -> [f64; 3] {
        std::array::from_fn(|k| dot(&self.rows[0][k], a) + dot(&self.rows[1][k], b))
    }

    /// Gives the bodies impulses.
    #[inline]
    pub(crate) fn push(&self, impulse: &[f64; 3], w: &mut [Six]) {
        for (rows, &body) in self.rows.iter().zip(&self.bodies) {
            add(rows, impulse, &mut w[body]);
        }
    }

    /// Lets its impulses `x` be changed by what `respond` makes of the rates; says by how much.
    #[inline]
    pub(crate) fn visit(
        &self,
        w: &mut [Six],
        x: &[f64; 3],
        respond: impl FnOnce([f64; 3]) -> [f64; 3],
    ) -> [f64; 3] {
        let [a, b] = self.bodies;
        let (mut first, mut second) = (w[a], w[b]);
        let rate = |k: usize| self.rate(k, &first, &second);
        let normal = rate(0);
        // What neither pushes nor closes needs no other rate: a good third of all visits.
        if *x == [0.0; 3] && normal >= 0.0 {
            return [0.0; 3];
        }
        let change = respond([normal, rate(1), rate(2)]);
        add(&self.rows[0], &change, &mut first);
        add(&self.rows[1], &change, &mut second);
        (w[a], w[b]) = (first, second);
        change
    }
}

#[inline]
fn dot(a: &Six, b: &Six) -> f64 {
    let x = a[0] * b[0] + a[2] * b[2] + a[4] * b[4];
    let y = a[1] * b[1] + a[3] * b[3] + a[5] * b[5];
    x + y
}

#[inline]
fn add(rows: &[Six; 3], impulse: &[f64; 3], w: &mut Six) {
    for (f, w) in w.iter_mut().enumerate() {
        *w += rows[0][f] * impulse[0] + rows[1][f] * impulse[1] + rows[2][f] * impulse[2];
    }
}
