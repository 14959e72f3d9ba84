//! Forces, drives and springs on bodies: their derivatives and powers, and what is refused.

use nalgebra::Vector3;
use stationary_calculus::{
    Covector, Force, Metric, Potential, ProductSink, Vector, assert_derivatives_on,
};
use stationary_constraints::{Constraint, Pairing};
use stationary_integrators::{Integrator, State, StepError};
use stationary_rigid::{
    Along, Attachment, AxisRotations, Body, BodyForces, BodyMethod, BodyMetric, BodyMotion,
    BodySpring, ConstantVelocity, Drive, ExactRotation, Free, JointEnd, LieGroup, LieVerlet,
    Orientations, Poses, RigidError, RigidMotion, Rotation, Schedule, Steady, TorsionSpring,
};

pub(crate) const POINT: Vector3<f64> = Vector3::new(0.1, 0.4, -0.3);
pub(crate) const OTHER: Vector3<f64> = Vector3::new(-0.2, 0.3, 0.6);
pub(crate) const AXIS: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);

fn turned(body: usize) -> Rotation {
    Rotation::exp([Vector3::new(0.3, -0.8, 1.1), Vector3::new(-1.0, 0.2, 0.5)][body])
}

pub(crate) fn two_poses() -> Vec<f64> {
    let mut q = vec![0.4, -0.2, 0.9];
    q.extend(turned(0).quaternion());
    q.extend([-0.5, 0.1, 0.3]);
    q.extend(turned(1).quaternion());
    q
}

fn two_orientations() -> Vec<f64> {
    [0, 1].into_iter().flat_map(|body| turned(body).quaternion()).collect()
}

pub(crate) fn ends() -> [[JointEnd; 2]; 2] {
    let second = JointEnd::on(1, OTHER).turned(Rotation::exp(-OTHER));
    [
        [JointEnd::on(0, POINT).turned(Rotation::exp(POINT)), second],
        [JointEnd::world(OTHER), second],
    ]
}

#[test]
fn springs_with_a_rest_and_of_a_turn_or_a_shift_have_right_derivatives() {
    for along in [Along::Turn, Along::Shift] {
        for ends in ends() {
            let spring = TorsionSpring::new(Poses, 2, (along, AXIS), ends, [3.0, 0.4]).unwrap();
            assert_derivatives_on(&Poses, &spring, &two_poses());
            let spring = TorsionSpring::new(Orientations, 2, (along, AXIS), ends, [3.0, 0.4]);
            assert_derivatives_on(&Orientations, &spring.unwrap(), &two_orientations());
        }
    }
    for rest in [0.0, 0.3, 5.0] {
        let ends = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
        let spring = BodySpring::new(Poses, 2, 3.0, ends).unwrap().with_rest_length(rest).unwrap();
        assert_derivatives_on(&Poses, &spring, &two_poses());
    }
}

/// A turn that is not steady.
pub(crate) struct Swing;
impl Schedule for Swing {
    fn at<R: stationary_calculus::Number>(&self, t: R) -> R {
        (t * 1.7).sin() * 0.8
    }
}

#[test]
fn a_drive_has_right_derivatives_along_poses_and_in_time() {
    for along in [Along::Turn, Along::Shift] {
        for ends in ends() {
            let drive = || Drive::new(Poses, 2, along, AXIS, ends, Swing).unwrap();
            assert_derivatives_on(
                &Poses,
                &Pairing::new(drive(), vec![0.7], 0.3).unwrap(),
                &two_poses(),
            );
            let (q, mut rate) = (two_poses(), [0.0]);
            let value = |t: f64| {
                let mut g = [0.0];
                drive().value(t, &q, &mut g).unwrap();
                g[0]
            };
            drive().rate(0.3, &q, &mut rate).unwrap();
            let e = 1e-6;
            assert!((rate[0] - (value(0.3 + e) - value(0.3 - e)) / (2.0 * e)).abs() < 1e-9);
        }
    }
}

/// Everything that acts, on two bodies: dampers, a motor, a load and a torque.
pub(crate) fn everything() -> BodyForces<Poses> {
    let mut forces = BodyForces::new(Poses, 2);
    let ends_of = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    forces.between_points(ends_of, |_, l, rate| -0.8 * rate * (1.0 + l)).unwrap();
    let tied = [Attachment::World(OTHER), Attachment::Body(1, POINT)];
    forces.between_points(tied, |t, _, rate| 0.3 * t.cos() - 0.2 * rate.powi(3)).unwrap();
    forces
        .about_axis(ends()[0], AXIS, |t, turn, rate| 0.4 * (turn - t).sin() - 0.02 * rate)
        .unwrap();
    let drag = |t: f64, x: Vector3<f64>, v: Vector3<f64>| {
        Vector3::new(0.1, 0.0, t.sin()) - v * (0.3 * v.norm()) + x.cross(&AXIS) * 0.2
    };
    forces.at_point(0, POINT, drag).unwrap();
    let spin = |t: f64, _: Rotation, w: Vector3<f64>| AXIS * (0.2 * t) - w * 0.1;
    forces.on_body(1, spin).unwrap();
    forces
}

fn velocity() -> Vector<Vec<f64>> {
    Vector(vec![0.3, -0.7, 0.2, 1.1, -0.4, 0.6, -0.2, 0.5, 0.9, -0.3, 0.8, 0.1])
}

#[test]
fn the_damping_of_every_force_is_the_symmetric_part_of_its_slope_with_velocity() {
    let (forces, q, v, t) = (everything(), two_poses(), velocity(), 0.7);
    let force = |v: &Vector<Vec<f64>>| {
        let mut f = Covector(vec![0.0; 12]);
        forces.add_force(t, &q, v.view(), f.view_mut());
        f.0
    };
    let e = 1e-5;
    let slope = |i: usize, j: usize| {
        let moved = |e: f64| {
            let mut v = v.clone();
            v.0[j] += e;
            force(&v)[i]
        };
        (moved(-e) - moved(e)) / (2.0 * e)
    };
    for j in 0..12 {
        let (mut unit, mut column) = ([0.0; 12], [0.0; 12]);
        unit[j] = 1.0;
        let mut sink = ProductSink::new(1.0, &unit, &mut column).unwrap();
        forces.add_damping(t, &q, v.view(), &mut sink);
        for (i, entry) in column.iter().enumerate() {
            let expected = 0.5 * (slope(i, j) + slope(j, i));
            assert!((entry - expected).abs() < 1e-7, "({i}, {j}): {entry} {expected}");
        }
    }
}

#[test]
fn the_powers_of_all_things_add_up_to_that_of_the_force_and_of_virtual_work() {
    let (forces, q, v) = (everything(), two_poses(), velocity());
    let mut f = Covector(vec![0.0; 12]);
    forces.add_force(0.7, &q, v.view(), f.view_mut());
    let mut powers = vec![0.0; forces.works()];
    forces.add_powers(0.7, &q, v.view(), v.view(), &mut powers);
    assert_eq!(powers.len(), 5);
    assert!((powers.iter().sum::<f64>() - f.apply(&v)).abs() < 1e-14);
    // A damper's power is -c l'^2 (1 + l): the length's rate by a difference along the motion.
    let length = |s: f64| {
        let mut q = q.clone();
        stationary_calculus::Space::advance(&Poses, &mut q, s, v.view());
        let place = |body: usize, c: &Vector3<f64>| {
            <Poses as stationary_rigid::BodySpace>::pose(&q, body).unwrap().apply(c)
        };
        (place(1, &OTHER) - place(0, &POINT)).norm()
    };
    let rate = (length(1e-5) - length(-1e-5)) / 2e-5;
    assert!((powers[0] + 0.8 * rate * rate * (1.0 + length(0.0))).abs() < 1e-8);
}

pub(crate) type Sprung = stationary_calculus::System<BodyMetric<Poses>, BodySpring<Poses>, Poses>;

/// Two boxes on a spring with a rest.
pub(crate) fn boxes() -> (Sprung, State<Vec<f64>>) {
    let metric = BodyMetric::<Poses>::new(vec![
        Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap(),
        Body::solid_box(0.7, [0.3, 0.1, 0.2]).unwrap(),
    ]);
    let at = |x: f64, w| BodyMotion {
        pose: RigidMotion { translation: Vector3::x() * x, rotation: turned(usize::from(x > 0.5)) },
        velocity: Vector3::new(0.1, 0.4 * x, -0.2),
        angular_velocity: w,
    };
    let motions = [at(0.0, Vector3::new(1.0, 0.5, -0.3)), at(1.2, Vector3::new(-0.4, 1.2, 0.6))];
    let initial = metric.state(&motions).unwrap();
    let ends = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    let spring = BodySpring::new(Poses, 2, 9.0, ends).unwrap().with_rest_length(0.7).unwrap();
    (metric.under(spring).unwrap(), initial)
}

pub(crate) fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |far, (a, b)| f64::max(far, (a - b).abs()))
}

#[test]
fn forces_that_cannot_be_are_refused_by_name() {
    let mut forces = BodyForces::new(Poses, 1);
    let none = |_: f64, _: f64, _: f64| 0.0;
    let absent = [Attachment::Body(1, POINT), Attachment::World(OTHER)];
    let error = forces.between_points(absent, none).unwrap_err();
    assert_eq!(error, RigidError::NoSuchBody { body: 1, bodies: 1 });
    let here = [JointEnd::world(POINT), JointEnd::on(0, OTHER)];
    let error = forces.about_axis(here, Vector3::zeros(), none).unwrap_err().to_string();
    assert!(error.starts_with("motor between the world and body 0: axis"), "{error}");
    let steady = Steady { start: 0.0, speed: f64::NAN };
    let itself = [JointEnd::on(0, POINT), JointEnd::on(0, OTHER)];
    let error = Drive::new(Poses, 1, Along::Turn, AXIS, itself, steady).unwrap_err().to_string();
    assert!(error.starts_with("turning drive between body 0 and body 0: it holds"), "{error}");
    let spring =
        BodySpring::new(Poses, 1, 1.0, [Attachment::World(POINT), Attachment::World(OTHER)]);
    let error = spring.unwrap().with_rest_length(-1.0).unwrap_err();
    assert!(matches!(error, RigidError::Negative { value: -1.0, .. }));
    // Of another number of bodies, and a law that is no number: typed, and the state stays.
    let (system, initial) = boxes();
    assert!(LieVerlet::<_, _, ExactRotation, _>::forced(&system, forces).is_err());
    let mut wild = BodyForces::new(Poses, 2);
    wild.on_body(0, |_, _, _| Vector3::repeat(f64::NAN)).unwrap();
    for &method in BodyMethod::ALL {
        let mut state = initial.clone();
        let error = method.forced(&system, wild.clone()).unwrap().step(&mut state, 0.1);
        let named = [
            matches!(error, Err(StepError::Newton(_))),
            matches!(error, Err(StepError::NonFiniteMomentum { .. })),
            matches!(error, Err(StepError::NonFiniteConfiguration { .. })),
        ];
        assert!(named.contains(&true), "{method}: {error:?}");
        assert_eq!(state, initial);
    }
}

#[test]
fn points_that_meet_are_damped_along_their_way_through_each_other() {
    let mut forces = BodyForces::new(Poses, 2);
    let points = [Attachment::Body(0, Vector3::zeros()), Attachment::Body(1, Vector3::zeros())];
    forces.between_points(points, |_, _, rate| -2.0 * rate).unwrap();
    let mut q = two_poses();
    q.copy_within(0..3, 7);
    let (v, mut f) = (velocity(), Covector(vec![0.0; 12]));
    forces.add_force(0.0, &q, v.view(), f.view_mut());
    for k in 0..3 {
        assert!((f.0[k] - 2.0 * (v.0[6 + k] - v.0[k])).abs() < 1e-15);
        assert!((f.0[6 + k] + f.0[k]).abs() < 1e-15);
    }
    assert!(Metric::dim(boxes().0.metric()) == 12 && boxes().0.potential().dim() == 12);
}

#[test]
fn a_step_with_forces_allocates_nothing() {
    let (system, initial) = boxes();
    let mut verlet = LieVerlet::<_, _, ConstantVelocity, _>::forced(&system, everything()).unwrap();
    let mut state = initial.clone();
    verlet.step(&mut state, 0.01).unwrap();
    let count = allocation_counter::measure(|| {
        (0..10).for_each(|_| assert!(verlet.step(&mut state, 0.01).is_ok()));
    });
    assert_eq!(count.count_total, 0, "{count:?}");
}

#[test]
fn friction_brakes_alike_in_every_unit_of_length() {
    // A ball at the unit of length a second, under friction that is all but constant from a hundredth of it on.
    let braked = |l: f64| {
        let metric = BodyMetric::<Poses>::new(vec![Body::solid_ball(1.0, 0.1 * l).unwrap()]);
        let velocity = Vector3::new(l, 0.5 * l, 0.0);
        let pose = RigidMotion::identity();
        let start = BodyMotion { pose, velocity, angular_velocity: Vector3::zeros() };
        let mut state = metric.state(&[start]).unwrap();
        let system = metric.under(Free { freedoms: 6 }).unwrap();
        let mut forces = BodyForces::new(Poses, 1);
        let law = move |_: f64, _: Vector3<f64>, v: Vector3<f64>| {
            let speed = v.norm() / l;
            v.try_normalize(0.0).map_or(v, |along| along * (-l * (speed / 0.01).tanh()))
        };
        forces.at_point(0, Vector3::zeros(), law).unwrap();
        let mut method = LieVerlet::<_, _, AxisRotations, _>::forced(&system, forces).unwrap();
        for step in 0..40 {
            method
                .step(&mut state, 0.05)
                .unwrap_or_else(|error| panic!("{l}, step {step}: {error}"));
        }
        state.q[0] / l
    };
    let expected = braked(1.0);
    for l in [1e-9, 1e-6, 1e-3, 1e3, 1e6] {
        let came = braked(l);
        assert!((came / expected - 1.0).abs() < 1e-9, "{l}: {came}, not {expected}");
    }
}
