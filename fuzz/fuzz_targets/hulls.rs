//! Whatever the points, a convex solid and a ball that falls towards it meet within the motion, or do
//! not, or an error has words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;
use stationary_contact::{Closeness, RigidPath, Shape, rigid_bodies_meet};
use stationary_rigid::{LieGroup, RigidMotion};

fuzz_target!(|points: Vec<[i8; 3]>| {
    let points: Vec<_> = points.iter().map(|x| Vector3::from(x.map(f64::from))).collect();
    let hull = match Shape::convex(&points) {
        Ok(hull) => hull,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let ball = Shape::ball(1.0).unwrap();
    let above = RigidMotion {
        translation: Vector3::new(0.0, 0.0, 200.0),
        ..RigidMotion::identity()
    };
    let down = Vector3::new(0.0, 0.0, -400.0);
    let falls = RigidPath::straight(above, down, Vector3::zeros()).unwrap();
    let rests = RigidPath::still(RigidMotion::identity()).unwrap();
    let close = Closeness { thickness: 0.0, tolerance: 1e-6 };
    if let Some(hit) = rigid_bodies_meet((&hull, &rests), (&ball, &falls), close).unwrap() {
        assert!((0.0..=1.0).contains(&hit.time) && hit.normal.norm() <= 1.0 + 1e-9);
    }
});
