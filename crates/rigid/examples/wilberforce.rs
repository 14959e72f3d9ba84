//! Wilberforce's pendulum: a bob on a coil spring whose stretch and twist are coupled, so that it bounces
//! and spins by turns. Its energy is written once; its derivatives are exact.
//!
//! `cargo run -p stationary-rigid --example wilberforce`

use nalgebra::Vector3;
use stationary_calculus::Number;
use stationary_integrators::Integrator;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, ExactRotation, LieGroup, LieVerlet, PoseEnergy, PoseOf,
    PosePotential, Poses, RigidMotion, Rotation,
};

/// Stretch z (m) and twist (rad) of the spring: 2.0 N/m, 2e-4 N m/rad, coupled by 2e-3 N.
struct Coil;

impl PoseEnergy<1> for Coil {
    fn energy<R: Number>(&self, [bob]: [PoseOf<R>; 1]) -> R {
        let (z, twist) = (bob.position[2], bob.turn_about([0.0, 0.0, 1.0]));
        (z * z * 2.0 + twist * twist * 2e-4 + z * twist * 2e-3) * 0.5
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(0.5, [4e-5, 4e-5, 5e-5])?]);
    let start = BodyMotion {
        pose: RigidMotion { translation: Vector3::z() * 0.01, rotation: Rotation::identity() },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let mut state = metric.state(&[start])?;
    let system = metric.under(PosePotential::new(Poses, 1, [0], Coil)?)?;
    let mut verlet = LieVerlet::<_, _, ExactRotation>::new(&system)?;
    println!("   t [s]   bouncing [J]   spinning [J]");
    for step in 0..=4000 {
        if step % 500 == 0 {
            let (z, p, m) = (state.q[2], state.p.0[2], state.p.0[5]);
            let twist = 2.0 * state.q[6].atan2(state.q[3]);
            let bouncing = p * p / (2.0 * 0.5) + z * z;
            let spinning = m * m / (2.0 * 5e-5) + 1e-4 * twist * twist;
            println!("{:8.1} {bouncing:14.3e} {spinning:14.3e}", state.t);
        }
        verlet.step(&mut state, 0.01)?;
    }
    Ok(())
}
