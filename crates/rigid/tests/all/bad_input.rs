//! What bad input gets: a typed error, and a state as it was.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DenseSink, Potential, SizeError};
use stationary_constraints::Constraint;
use stationary_integrators::{State, StepError};
use stationary_rigid::problems::{held_at_a_point, nodding_top, top_on_its_tip, tumbling_box};
use stationary_rigid::{
    Attachment, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, BodySpring, Free, Joint,
    JointEnd, JointFault, JointKind, LieGroup, Orientations, PlanarEnd, PlanarJoint,
    PlanarJointKind, PlanarWeight, PointMass, Poses, RigidError, RigidMotion, Rotation, Spun,
    Weight, apply_impulse, spatial_angular_momentum,
};

#[test]
fn a_pose_that_is_not_one_is_refused_by_body() {
    let q = |w: f64| vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, w, 0.0, 0.0, 0.0];
    assert!(Poses::check(&q(1.0)).is_ok());
    assert!(matches!(Poses::check(&q(1.1)), Err(RigidError::Pose { body: 1, .. })));
    assert!(matches!(Poses::check(&q(f64::NAN)), Err(RigidError::NonFinite { index: 10, .. })));
    let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.1; 3]).unwrap()]);
    let mut motion = BodyMotion {
        pose: RigidMotion::identity(),
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::new(f64::NAN, 0.0, 0.0),
    };
    assert!(matches!(metric.state(&[motion]), Err(RigidError::NonFinite { index: 3, .. })));
    motion.angular_velocity = Vector3::zeros();
    motion.pose.translation.y = f64::INFINITY;
    assert!(matches!(metric.state(&[motion]), Err(RigidError::NonFinite { index: 1, .. })));
    assert!(matches!(metric.state(&[]), Err(RigidError::Size(_))));
}

#[test]
fn a_body_held_at_a_point_refuses_every_number_that_is_not_finite() {
    let body = Body::solid_box(1.0, [0.1; 3]).unwrap();
    let good = [Vector3::x(), Vector3::y(), Vector3::z()];
    let made = |[point, w, gravity]: [Vector3<f64>; 3]| {
        held_at_a_point(body, point, Rotation::identity(), w, gravity).map(drop)
    };
    assert_eq!(made(good), Ok(()));
    for vector in 0..3 {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut vectors = good;
            vectors[vector].y = bad;
            let error = made(vectors).unwrap_err();
            assert!(matches!(error, RigidError::NonFinite { .. }), "{vector}: {error}");
        }
    }
    assert!(top_on_its_tip(f64::NAN).is_err());
}

#[test]
fn a_potential_of_other_bodies_is_refused() {
    let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.1; 3]).unwrap()]);
    let error = metric.under(Free { freedoms: 3 }).unwrap_err();
    assert_eq!((error.expected, error.got), (6, 3));
}

#[test]
fn a_step_that_fails_leaves_the_state_as_it_was() {
    let problem = tumbling_box().unwrap();
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        for h in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(integrator.step(&mut state, h), Err(StepError::Step(_))), "{method}");
        }
        assert_eq!(state, problem.initial);
        let mut short = State::new(vec![0.0; 6], Covector(vec![0.0; 6]));
        assert!(matches!(integrator.step(&mut short, 0.1), Err(StepError::Size(_))), "{method}");
        for m in [f64::INFINITY, f64::NAN] {
            let mut wild = problem.initial.clone();
            wild.p.0[4] = m;
            let before = format!("{wild:?}");
            assert!(integrator.step(&mut wild, 0.1).is_err(), "{method} at {m}");
            assert_eq!(format!("{wild:?}"), before);
        }
        integrator.step(&mut state, 0.01).unwrap();
    }
}

#[test]
fn a_momentum_beyond_all_measure_is_an_error_of_the_implicit_step() {
    let problem = tumbling_box().unwrap();
    let mut integrator = BodyMethod::VariationalRotation.integrator(&problem.system).unwrap();
    for m in [1e10, 1e160, 1e300] {
        let mut wild = problem.initial.clone();
        wild.p.0[4] = m;
        assert!(matches!(integrator.step(&mut wild, 0.1), Err(StepError::Newton(_))), "{m:e}");
    }
}

#[test]
fn a_step_allocates_nothing() {
    let problem = nodding_top().unwrap();
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        integrator.step(&mut state, 1e-3).unwrap();
        let counted = allocation_counter::measure(|| {
            for _ in 0..10 {
                integrator.step(&mut state, 1e-3).unwrap();
            }
        });
        assert_eq!(counted.count_total, 0, "{method}");
    }
}

#[test]
fn a_state_at_no_time_or_with_a_quaternion_of_another_length_is_refused_by_every_method() {
    let problem = tumbling_box().unwrap();
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut state = State { t: f64::NAN, ..problem.initial.clone() };
        let error = integrator.step(&mut state, 0.1).unwrap_err();
        assert!(matches!(error, StepError::Time(_)), "{method}: {error}");
        let mut state = State { t: f64::MAX, ..problem.initial.clone() };
        let error = integrator.step(&mut state, 1e308).unwrap_err();
        assert_eq!(error, StepError::Time(f64::INFINITY), "{method}");
        let mut state = problem.initial.clone();
        state.q[3..].iter_mut().for_each(|c| *c *= 2.0);
        let error = integrator.step(&mut state, 0.1).unwrap_err();
        assert!(matches!(error, StepError::Configuration { number: 3 }), "{method}: {error}");
    }
}

#[test]
fn what_is_asked_of_an_absent_body_is_refused() {
    let absent = [Attachment::World(Vector3::zeros()), Attachment::Body(2, Vector3::zeros())];
    let spring = BodySpring::new(Poses, 2, 1.0, absent);
    assert_eq!(spring, Err(RigidError::NoSuchBody { body: 2, bodies: 2 }));
    let spun = Spun::new(Poses, 2, 2, Vector3::z());
    assert_eq!(spun, Err(RigidError::NoSuchBody { body: 2, bodies: 2 }));
    let nobody = |body, bodies| Some(RigidError::NoSuchBody { body, bodies });
    assert_eq!(Poses::pose(&[0.0; 6], 0).err(), nobody(0, 0));
    assert_eq!(Orientations::pose(&[0.0; 8], usize::MAX).err(), nobody(usize::MAX, 2));
    assert_eq!(Orientations::pose(&[0.0; 8], 1).err(), None);
    let mut state = State::new(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], Covector(vec![0.0; 3]));
    let (point, impulse) = (Vector3::x(), Vector3::y());
    let short = apply_impulse::<Poses>(&mut state, 0, &point, impulse);
    assert!(matches!(short, Err(RigidError::Size(_))));
    assert!(spatial_angular_momentum::<Poses>(&state).is_err());
}

/// The second differential for so many multipliers, at zeros.
fn hessian(joint: &impl Constraint, numbers: usize, multipliers: usize) -> Result<(), SizeError> {
    let mut entries = [0.0; 144];
    let mut sink = DenseSink::new(1.0, 12, &mut entries).unwrap();
    joint.add_hessian(0.0, &vec![0.0; numbers], &vec![1.0; multipliers], &mut sink)
}

#[test]
fn joints_refuse_too_few_numbers_and_other_counts_of_values() {
    let ends = [JointEnd::on(0, Vector3::x()), JointEnd::on(1, Vector3::y())];
    let hinge = Joint::new(Poses, 2, JointKind::Hinge { axis: Vector3::z() }, ends).unwrap();
    let flat = |body| PlanarEnd::on(body, Vector2::x());
    let weld = PlanarJoint::new(2, PlanarJointKind::Weld, [flat(0), flat(1).turned(0.1)]).unwrap();
    let what = "the configuration's numbers";
    let short = |expected, got| Err(SizeError { what, expected, got });
    assert_eq!(hinge.value(0.0, &[0.0; 13], &mut [0.0; 5]), short(14, 13));
    assert_eq!(weld.value(0.0, &[0.0; 5], &mut [0.0; 3]), short(6, 5));
    let values = |expected, got| Err(SizeError { what: "the constraint's values", expected, got });
    assert_eq!(hinge.value(0.0, &[0.0; 14], &mut [0.0; 4]), values(5, 4));
    assert_eq!(weld.value(0.0, &[0.0; 6], &mut [0.0; 4]), values(3, 4));
    let what = "the constraint's multipliers";
    let multipliers = |expected, got| Err(SizeError { what, expected, got });
    assert_eq!(hessian(&hinge, 14, 4), multipliers(5, 4));
    assert_eq!(hessian(&hinge, 14, 6), multipliers(5, 6));
    assert_eq!(hessian(&weld, 6, 2), multipliers(3, 2));
}

#[test]
fn pins_and_welds_at_numbers_that_are_not_finite_are_refused() {
    let world = PlanarEnd::world(Vector2::zeros());
    for bad in [f64::NAN, f64::INFINITY] {
        let end = PlanarEnd::on(0, Vector2::new(1.0, bad));
        for ends in [[world, end], [end, world]] {
            let error = PlanarJoint::new(1, PlanarJointKind::Pin, ends).unwrap_err();
            let RigidError::Joint { fault, .. } = error else { panic!("{error}") };
            assert!(matches!(fault, JointFault::NotFinite { what: "its point", .. }), "{error}");
        }
        let good = PlanarEnd::on(0, Vector2::x());
        assert!(PlanarJoint::new(1, PlanarJointKind::Weld, [world, good.turned(bad)]).is_err());
    }
}

#[test]
fn bodies_have_weight_where_the_configuration_holds_them_all() {
    let masses = vec![PointMass { mass: 1.0, point: Vector3::x() }; 2];
    let weight = Weight { gravity: Vector3::z(), masses, space: Poses };
    assert!(weight.energy(&[0.0; 7]).is_nan());
    let flat = PlanarWeight { gravity: Vector2::x(), masses: vec![1.0; 2] };
    assert!(flat.energy(&[1.0, 2.0, 0.0]).is_nan());
    assert_eq!(flat.energy(&[1.0, 2.0, 0.0, 5.0, 2.0, 0.0]), -6.0);
}
