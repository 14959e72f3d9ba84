//! From shapes to motion: a plate with a hole, a dumb-bell of two balls, and a knock on the
//! dumb-bell.
//!
//! `cargo run --example shape_to_motion -p stationary-rigid`

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_mesh::Polygon;
use stationary_rigid::{
    BodyMethod, BodyMetric, BodyMotion, BodySpace, Free, LieGroup, PlanarMass, Poses, RigidMotion,
    SpatialMass, apply_impulse, spatial_angular_momentum,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners = |list: &[[f64; 2]]| list.iter().map(|&p| p.into()).collect::<Vec<Vector2<f64>>>();
    let outline =
        corners(&[[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.4], [0.0, 0.4]]);
    let hole = corners(&[[0.03, 0.03], [0.07, 0.03], [0.07, 0.07], [0.03, 0.07]]);
    let flat = PlanarMass::of(8.0, &Polygon::new(vec![outline, hole])?.moments())?;
    println!("mass {:.4} kg, centre {:.4?} m", flat.mass, flat.centre.as_slice());
    println!("polar moment {:.3e} kg m^2 about the centre", flat.inertia);

    let ball = |x: f64, mass: f64, radius: f64| SpatialMass {
        mass,
        centre: Vector3::new(x, 0.0, 0.0),
        inertia: Matrix3::identity() * (0.4 * mass * radius * radius),
    };
    let bell = SpatialMass::composite(&[ball(-0.2, 1.0, 0.1), ball(0.3, 2.0, 0.12)])?;
    let (body, frame) = bell.body()?;
    println!(
        "dumb-bell: moments {:.4?}, centre {:.4?}",
        body.moments().as_slice(),
        frame.translation.as_slice()
    );

    let metric = BodyMetric::<Poses>::new(vec![body]);
    let rest =
        BodyMotion { pose: frame, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() };
    let mut state = metric.state(&[rest])?;
    let system = metric.under(Free { freedoms: 6 })?;
    let at = frame.rotation.rotate_back(&Vector3::new(0.1, 0.1, 0.0));
    apply_impulse::<Poses>(&mut state, 0, &at, Vector3::new(0.0, 0.4, 1.0))?;
    let knocked = spatial_angular_momentum::<Poses>(&state)?;
    let mut integrator = BodyMethod::AxisRotations.integrator(&system)?;
    for _ in 0..1_000 {
        integrator.step(&mut state, 1e-3)?;
    }
    let pose: RigidMotion = Poses::pose_at(&state.q, 0);
    let turn = frame.rotation.inverse().compose(&pose.rotation).log().norm();
    println!("after 1 s: centre {:.4?} m, turned by {turn:.4} rad", pose.translation.as_slice());
    let drift = spatial_angular_momentum::<Poses>(&state)? - knocked;
    println!("angular momentum moved by {:.0e}", drift.norm() / knocked.norm());
    Ok(())
}
