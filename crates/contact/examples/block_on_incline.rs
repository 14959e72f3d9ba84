//! A block on an incline: it sticks below the angle of friction, and slides above it.
//!
//! `cargo run --example block_on_incline -p stationary-contact`

use nalgebra::Vector3;
use stationary_contact::{Collider, Detector, Shape, SpatialWorld};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("the angle of friction is {:.3} degrees", FRICTION.atan().to_degrees());
    println!("{:>8} {:>18} {:>18} {:>16}", "degrees", "speed at 1 s", "Coulomb", "residual [m/s]");
    for degrees in [10.0_f64, 20.0, 26.0, 27.0, 35.0, 50.0] {
        let angle = degrees.to_radians();
        let rotation = Rotation::exp(Vector3::y() * angle);
        let normal = rotation.rotate(&Vector3::z());
        let pose = RigidMotion { translation: normal * 0.1, rotation };
        let (velocity, angular_velocity) = (Vector3::zeros(), Vector3::zeros());
        let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.2, 0.2, 0.1])?]);
        let mut state = metric.state(&[BodyMotion { pose, velocity, angular_velocity }])?;
        let weight = Weight {
            gravity: -Vector3::z() * GRAVITY,
            masses: vec![PointMass { mass: 1.0, point: Vector3::zeros() }],
            space: Poses,
        };
        let system = metric.under(weight)?;
        let block = Collider::on_body(0, Shape::cuboid([0.2, 0.2, 0.1])?).with_friction(FRICTION);
        let slope = Collider::fixed(RigidMotion::identity(), Shape::half_space(normal)?);
        let detector = Detector::new(vec![block, slope.with_friction(FRICTION)], 1)?;
        let mut bodies = SpatialWorld::new(system, detector)?;
        let mut residual = 0.0_f64;
        for _ in 0..1000 {
            residual = residual.max(bodies.step(&mut state, 1e-3)?.coulomb);
        }
        let speed = Vector3::from_column_slice(&state.p.0[..3]).norm();
        let expected = (GRAVITY * (angle.sin() - FRICTION * angle.cos())).max(0.0);
        println!("{degrees:8.0} {speed:18.12} {expected:18.12} {residual:16.0e}");
    }
    Ok(())
}
