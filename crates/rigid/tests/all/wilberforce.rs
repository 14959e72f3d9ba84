//! A Wilberforce pendulum, told by one energy of its pose.

use nalgebra::Vector3;
use stationary_calculus::assert_derivatives_on;
use stationary_integrators::Integrator;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, ExactRotation, LieGroup, LieVerlet, PoseEnergy, PoseOf,
    PosePotential, Poses, RigidMotion, Rotation,
};

use crate::body_forces::two_poses;

/// Wilberforce's pendulum at resonance: stretch and twist of one spring, coupled.
struct Wilberforce;
impl PoseEnergy<1> for Wilberforce {
    fn energy<R: stationary_calculus::Number>(&self, [bob]: [PoseOf<R>; 1]) -> R {
        let (z, turn) = (bob.position[2], bob.turn_about([0.0, 0.0, 1.0]));
        (z * z * 2.0 + turn * turn * 2e-4 + z * turn * 2e-3) * 0.5
    }
}

#[test]
fn a_wilberforce_pendulum_beats_as_its_two_modes_say() {
    // Mass 0.5 kg and inertia 5e-5 kg m^2: both alone swing at 2 rad/s.
    let metric = BodyMetric::<Poses>::new(vec![Body::new(0.5, [4e-5, 4e-5, 5e-5]).unwrap()]);
    let pose = RigidMotion { translation: Vector3::z() * 0.01, rotation: Rotation::identity() };
    let still = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() };
    let initial = metric.state(&[still]).unwrap();
    let potential = PosePotential::new(Poses, 1, [0], Wilberforce).unwrap();
    assert_derivatives_on(&Poses, &potential, &initial.q);
    assert_derivatives_on(&Poses, &potential, &two_poses()[..7]);
    let system = metric.under(potential).unwrap();
    let coupling = 1e-3 / (0.5_f64 * 5e-5).sqrt();
    let modes = [4.0 + coupling, 4.0 - coupling].map(f64::sqrt);
    let points = [2000_u32, 4000, 8000].map(|steps| {
        let h = 40.0 / f64::from(steps);
        let mut verlet = LieVerlet::<_, _, ExactRotation>::new(&system).unwrap();
        let (mut state, mut error, mut least) = (initial.clone(), 0.0_f64, f64::INFINITY);
        for step in 1..=steps {
            verlet.step(&mut state, h).unwrap();
            let t = h * f64::from(step);
            let z = 0.005 * ((modes[0] * t).cos() + (modes[1] * t).cos());
            error = error.max((state.q[2] - z).abs());
            let swing = 0.5 * state.p.0[2].powi(2) / 0.5 + state.q[2].powi(2);
            least = least.min(swing);
        }
        assert!(least < 1e-3 * 1e-4, "all of the energy goes into the twist once: {least}");
        (h, error)
    });
    let slope = loglog_slope(&points).unwrap();
    assert!((slope - 2.0).abs() < 0.05, "{slope} {points:?}");
}

#[test]
fn beside_and_at_a_quarter_turn_about_a_tilted_axis_a_turn_has_derivatives() {
    let potential = PosePotential::new(Poses, 1, [0], Wilberforce).unwrap();
    let tilt = Rotation::exp(Vector3::new(0.3, -0.4, 0.0));
    // A third of a turn about (1, 1, 1), and what leads up to it: a quarter about the third axis, tilted.
    assert_derivatives_on(&Poses, &potential, &[0.1, 0.2, 0.3, 0.5, 0.5, 0.5, 0.5]);
    for off in [1e-15, 1e-12, 1e-9] {
        let turn = Rotation::exp(Vector3::z() * (std::f64::consts::FRAC_PI_2 + off));
        let [w, x, y, z] = tilt.compose(&turn).quaternion();
        assert_derivatives_on(&Poses, &potential, &[0.1, 0.2, 0.3, w, x, y, z]);
    }
}
