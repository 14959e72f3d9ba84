//! How good the motion of boxes is, whoever moved them.

use nalgebra::Vector3;
use rapier3d_f64::prelude::{PhysicsWorld, RigidBodyHandle, Rotation as Turn, Vector};
use stationary_calculus::Vector as Velocity;
use stationary_contact::problems::GRAVITY;
use stationary_contact::{Detector, gap_rows};
use stationary_rigid::Body;

/// Poses and velocities as ours are.
pub fn poses(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for handle in handles {
        let body = &world.bodies[*handle];
        let (at, turn): (Vector, Turn) = (body.translation(), *body.rotation());
        q.extend([at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z]);
        let (linear, angular) = (body.linvel(), turn.inverse() * body.angvel());
        v.extend([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]);
    }
    (q, v)
}

/// The velocities of bodies that are all the same, of their momenta.
pub fn velocities(p: &[f64], body: &Body) -> Vec<f64> {
    let velocity = |p: &[f64]| {
        let w = body.angular_velocity(&Vector3::from_column_slice(&p[3..]));
        let m = body.mass();
        [p[0] / m, p[1] / m, p[2] / m, w.x, w.y, w.z]
    };
    p.chunks_exact(6).flat_map(velocity).collect()
}

/// What boxes are like.
#[derive(Clone, Copy, Default)]
pub struct Quality {
    /// How deep they overlap, m.
    pub overlap: f64,
    /// How fast they still close once their gaps are used up, m/s.
    pub closing: f64,
    /// How fast the fastest is, m/s.
    pub speed: f64,
    /// Kinetic and potential, J.
    pub energy: f64,
}

/// Looks at velocities over a step of `h` seconds that starts at some poses.
pub fn look(detector: &mut Detector, q: &[f64], v: &[f64], body: &Body, h: f64) -> Quality {
    let mut quality = Quality::default();
    let contacts = detector.detect(q, 0.02).expect("detection");
    let rows = gap_rows(contacts, q);
    for (i, contact) in contacts.iter().enumerate() {
        quality.overlap = quality.overlap.max(-contact.gap);
        let closing = -rows.along(i, Velocity(v)) - contact.gap.max(0.0) / h;
        quality.closing = quality.closing.max(closing);
    }
    for (q, v) in q.chunks_exact(7).zip(v.chunks_exact(6)) {
        let linear = Vector3::from_column_slice(&v[..3]);
        let angular = Vector3::from_column_slice(&v[3..]);
        quality.speed = quality.speed.max(linear.norm());
        let kinetic = linear.norm_squared() + angular.dot(&body.angular_momentum(&angular));
        quality.energy += 0.5 * kinetic + GRAVITY * q[2];
    }
    quality
}
