//! Potentials of bodies, forces and impulses at points.

use nalgebra::Vector3;
use stationary_calculus::{
    Covector, Metric, Potential, Space, Vector, assert_derivatives_on, check_potential_on,
};
use stationary_rigid::{
    Attachment, Body, BodyMetric, BodyMotion, BodySpace, BodySpring, Free, LieGroup, Orientations,
    PointMass, Poses, RigidError, RigidMotion, Rotation, Weight, apply_impulse, force_at_point,
    spatial_angular_momentum,
};

fn pose(x: f64) -> RigidMotion {
    RigidMotion {
        translation: Vector3::new(x, 0.3, -0.7),
        rotation: Rotation::exp(Vector3::new(0.4 * x, -1.3, 0.8)),
    }
}

fn configuration<S: BodySpace>(poses: &[RigidMotion]) -> Vec<f64> {
    let one = |pose: &RigidMotion| {
        let mut q = pose.translation.as_slice()[..S::TRANSLATION].to_vec();
        q.extend(pose.rotation.quaternion());
        q
    };
    poses.iter().flat_map(one).collect()
}

fn weight<S: BodySpace>(space: S) -> Weight<S> {
    let load = |mass, point| PointMass { mass, point };
    Weight {
        gravity: Vector3::new(0.3, -1.0, -9.6),
        masses: vec![load(2.0, Vector3::new(0.1, -0.2, 0.5)), load(0.7, Vector3::zeros())],
        space,
    }
}

fn springs<S: BodySpace>(space: S) -> (BodySpring<S>, BodySpring<S>) {
    let spring = |ends| BodySpring::new(space, 2, 3.0, ends).unwrap();
    let world = Attachment::World(Vector3::new(0.2, 1.0, -0.4));
    let [a, b] = [Vector3::new(0.1, 0.4, -0.3), Vector3::new(-0.2, 0.3, 0.6)];
    (
        spring([world, Attachment::Body(1, a)]),
        spring([Attachment::Body(0, a), Attachment::Body(1, b)]),
    )
}

#[test]
fn differentials_and_hessians_are_right_on_poses_and_orientations() {
    let two = [pose(0.5), pose(-1.2)];
    assert_derivatives_on(&Poses, &weight(Poses), &configuration::<Poses>(&two));
    assert_derivatives_on(&Poses, &springs(Poses), &configuration::<Poses>(&two));
    let turned = configuration::<Orientations>(&two);
    assert_derivatives_on(&Orientations, &weight(Orientations), &turned);
    assert_derivatives_on(&Orientations, &springs(Orientations), &turned);
}

/// A weight whose torque has the sign printed in 9.4: minus what virtual work says.
struct WrongTorque(Weight<Orientations>);
impl Potential for WrongTorque {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn energy(&self, q: &[f64]) -> f64 {
        self.0.energy(q)
    }
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let mut right = Covector(vec![0.0; self.dim()]);
        self.0.add_differential(q, right.view_mut());
        dv.0.iter_mut().zip(&right.0).for_each(|(dv, right)| *dv -= right);
    }
    fn add_hessian(&self, q: &[f64], hessian: &mut impl stationary_calculus::Sink) {
        self.0.add_hessian(q, hessian);
    }
}

#[test]
fn the_sign_of_the_torque_printed_in_9_4_is_refused() {
    let q = configuration::<Orientations>(&[pose(0.5), pose(-1.2)]);
    assert!(check_potential_on(&Orientations, &WrongTorque(weight(Orientations)), &q).is_err());
}

#[test]
fn the_work_of_a_force_at_a_point_is_that_of_its_wrench() {
    let (pose, point, force) =
        (pose(0.8), Vector3::new(0.2, -0.5, 0.9), Vector3::new(1.0, 2.0, -0.4));
    let wrench = force_at_point(&pose, &point, force);
    let v = [0.3, -0.7, 0.2, 1.1, -0.4, 0.6];
    let place = |h: f64| {
        let mut q = configuration::<Poses>(&[pose]);
        Poses.advance(&mut q, h, Vector(v.as_slice()));
        Poses::pose_at(&q, 0).apply(&point)
    };
    let power = force.dot(&((place(1e-6) - place(-1e-6)) / 2e-6));
    let turned = Vector3::new(v[3], v[4], v[5]);
    let claimed = wrench.force.dot(&Vector3::new(v[0], v[1], v[2])) + wrench.torque.dot(&turned);
    assert!((power - claimed).abs() < 1e-9, "{power} {claimed}");
    // Along the arm there is no torque.
    let along = force_at_point(&pose, &point, pose.rotation.rotate(&point));
    assert!(along.torque.norm() < 1e-15);
}

#[test]
fn an_impulse_at_a_point_changes_both_momenta_by_what_it_carries() {
    let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(2.0, [0.1, 0.2, 0.3]).unwrap()]);
    let motion = BodyMotion {
        pose: pose(0.8),
        velocity: Vector3::new(0.1, 0.0, 0.4),
        angular_velocity: Vector3::new(1.0, -2.0, 0.3),
    };
    let mut state = metric.state(&[motion]).unwrap();
    let before = (state.p.0.clone(), spatial_angular_momentum::<Poses>(&state).unwrap());
    let (point, impulse) = (Vector3::new(0.1, 0.2, -0.3), Vector3::new(0.5, -0.2, 0.9));
    apply_impulse::<Poses>(&mut state, 0, &point, impulse).unwrap();
    let linear =
        Vector3::from_column_slice(&state.p.0[..3]) - Vector3::from_column_slice(&before.0[..3]);
    assert!((linear - impulse).norm() < 1e-15);
    let moment = spatial_angular_momentum::<Poses>(&state).unwrap() - before.1;
    assert!((moment - motion.pose.apply(&point).cross(&impulse)).norm() < 1e-14);
    let outside = apply_impulse::<Poses>(&mut state, 1, &point, impulse);
    assert!(matches!(outside, Err(RigidError::NoSuchBody { body: 1, bodies: 1 })));
}

#[test]
fn kinetic_energy_is_that_of_the_points_that_the_body_is_made_of() {
    // Eight corners of a box as point masses.
    let half = [0.1, 0.2, 0.3];
    let [x, y, z] = half.map(|a: f64| a * a);
    let body = Body::new(8.0, [y + z, z + x, x + y].map(|sum| 8.0 * sum)).unwrap();
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let motion = BodyMotion {
        pose: pose(0.8),
        velocity: Vector3::new(0.1, 0.7, 0.4),
        angular_velocity: Vector3::new(1.0, -2.0, 0.3),
    };
    let state = metric.state(&[motion]).unwrap();
    let corner = |k: usize| {
        let sign = |bit: usize| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let v = Vector3::new(sign(0) * half[0], sign(1) * half[1], sign(2) * half[2]);
        let turning = motion.angular_velocity.cross(&v);
        0.5 * (motion.velocity + motion.pose.rotation.rotate(&turning)).norm_squared()
    };
    let sum: f64 = (0..8).map(corner).sum();
    assert!((metric.kinetic_energy(state.p.view()) - sum).abs() < 1e-14);
    // And flat, sharp, and the system's own energy agree with it.
    let mut v = Vector(vec![0.0; 6]);
    metric.sharp(state.p.view(), v.view_mut());
    assert!((v.0[4] + 2.0).abs() < 1e-15 && (v.0[1] - 0.7).abs() < 1e-15);
    let mut p = Covector(vec![0.0; 6]);
    metric.flat(v.view(), p.view_mut());
    assert!(p.0.iter().zip(&state.p.0).all(|(a, b)| (a - b).abs() < 1e-15));
    let system = metric.under(Free { freedoms: 6 }).unwrap();
    assert!((system.energy(&state.q, state.p.view()) - sum).abs() < 1e-14);
}
