//! Joints on poses: their derivatives, their ranks, and bodies that hang from them.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, Space, Vector, assert_derivatives_on};
use stationary_constraints::problems::pendulum;
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, Few, FreeMotion, Pairing, Rattle,
    Redundancy, Rows, Scale,
};
use stationary_integrators::{State, StepError};
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Attachment, Body, BodyMetric, BodyMotion, BodySpace, ConstantVelocity, Free, FreeBodies,
    FreeTop, Joint, LieGroup, Orientations, PointMass, Poses, RigidError, RigidMotion, Rotation,
    Weight, null_space, spatial_angular_momentum,
};

const POINT: Vector3<f64> = Vector3::new(0.1, 0.4, -0.3);
const OTHER: Vector3<f64> = Vector3::new(-0.2, 0.3, 0.6);

fn all<S: BodySpace>(space: S) -> [Joint<S>; 4] {
    let between = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    let hung = [Attachment::World(OTHER), Attachment::Body(1, POINT)];
    let frames = [Rotation::exp(POINT), Rotation::exp(-OTHER)];
    [
        Joint::ball(space, 2, between).unwrap(),
        Joint::hinge(space, 2, between, [POINT, OTHER]).unwrap(),
        Joint::hinge(space, 2, hung, [POINT, OTHER]).unwrap(),
        Joint::fixed(space, 2, between, frames).unwrap(),
    ]
}

#[test]
fn the_derivatives_of_every_joint_are_right() {
    let multipliers = [0.7, -1.3, 2.0, 0.4, -0.9, 1.1];
    let turns = [Vector3::new(0.3, -0.8, 1.1), Vector3::new(-1.0, 0.2, 0.5)].map(Rotation::exp);
    let orientations: Vec<f64> = turns.iter().flat_map(|r| r.quaternion()).collect();
    let mut poses = vec![0.4, -0.2, 0.9];
    poses.extend(turns[0].quaternion());
    poses.extend([-0.5, 0.1, 0.3]);
    poses.extend(turns[1].quaternion());
    for joint in all(Poses) {
        let multipliers = multipliers[..joint.count()].to_vec();
        assert_derivatives_on(&Poses, &Pairing::new(joint, multipliers, 0.0).unwrap(), &poses);
    }
    for joint in all(Orientations) {
        let multipliers = multipliers[..joint.count()].to_vec();
        let pairing = Pairing::new(joint, multipliers, 0.0).unwrap();
        assert_derivatives_on(&Orientations, &pairing, &orientations);
    }
}

struct Dense(nalgebra::DMatrix<f64>);
impl Rows for Dense {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.0[(row, freedom)] += value;
    }
}

#[test]
fn closed_joints_have_full_rank_and_leave_three_one_or_no_freedom_between_the_bodies() {
    // Bodies put together so that each joint is closed.
    let closed = |joint: &Joint<Poses>, poses: [RigidMotion; 2]| {
        let mut q = Vec::new();
        for pose in poses {
            q.extend_from_slice(pose.translation.as_slice());
            q.extend(pose.rotation.quaternion());
        }
        let mut g = vec![0.0; joint.count()];
        joint.value(0.0, &q, &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-15), "{g:?}");
        let mut rows = Dense(nalgebra::DMatrix::zeros(joint.count(), 12));
        joint.differential(0.0, &q, &mut rows).unwrap();
        null_space(&rows.0).unwrap().ncols()
    };
    let same = RigidMotion { translation: OTHER, rotation: Rotation::exp(POINT) };
    let ends = [Attachment::Body(0, POINT), Attachment::Body(1, POINT)];
    let axes = [OTHER, OTHER];
    assert_eq!(closed(&Joint::ball(Poses, 2, ends).unwrap(), [same; 2]), 6 + 3);
    assert_eq!(closed(&Joint::hinge(Poses, 2, ends, axes).unwrap(), [same; 2]), 6 + 1);
    let frames = [Rotation::identity(); 2];
    assert_eq!(closed(&Joint::fixed(Poses, 2, ends, frames).unwrap(), [same; 2]), 6);
}

#[test]
fn joints_that_join_nothing_are_refused() {
    let body = |k| Attachment::Body(k, POINT);
    let same = Joint::ball(Poses, 2, [body(1), body(1)]);
    assert!(matches!(same, Err(RigidError::JoinedToItself { .. })));
    let absent = Joint::ball(Poses, 2, [body(0), body(2)]);
    assert!(matches!(absent, Err(RigidError::NoSuchBody { body: 2, bodies: 2 })));
    let axisless = Joint::hinge(Poses, 2, [body(0), body(1)], [POINT, Vector3::zeros()]);
    assert!(matches!(axisless, Err(RigidError::NoAxis(_))));
    let nowhere = Attachment::World(Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(Joint::ball(Poses, 2, [nowhere, body(0)]), Err(RigidError::NonFinite { .. })));
}

#[test]
fn a_box_on_a_hinge_swings_as_a_physical_pendulum_with_order_two() {
    const ARM: f64 = 0.3;
    const GRAVITY: f64 = 9.81;
    let body = Body::solid_box(2.0, [0.1, 0.2, ARM]).unwrap();
    let about = body.moments().y + body.mass() * ARM * ARM;
    let omega = (body.mass() * GRAVITY * ARM / about).sqrt();
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let exact = pendulum(1.5).unwrap();
    let rate = Vector3::y() * (-1.5 * omega);
    let motion = BodyMotion {
        pose: RigidMotion { translation: Vector3::z() * -ARM, rotation: Rotation::identity() },
        velocity: rate.cross(&(Vector3::z() * -ARM)),
        angular_velocity: rate,
    };
    let initial = metric.state(&[motion]).unwrap();
    let load = PointMass { mass: body.mass(), point: Vector3::zeros() };
    let gravity = Vector3::z() * -GRAVITY;
    let system = metric.under(Weight { gravity, masses: vec![load], space: Poses }).unwrap();
    let tip = Attachment::Body(0, Vector3::z() * ARM);
    let ends = [Attachment::World(Vector3::zeros()), tip];
    let hinge = Joint::hinge(Poses, 1, ends, [Vector3::y(); 2]).unwrap();
    let mut points = Vec::new();
    for steps in [200_u32, 400, 800] {
        let h = exact.period / omega / f64::from(steps);
        let choice = Few::<5>(Redundancy::Refuse);
        let mut rattle =
            Rattle::along(FreeBodies(ConstantVelocity), &system, hinge.clone(), &initial, choice)
                .unwrap();
        let mut state = initial.clone();
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            rattle.step(&mut state, h).unwrap();
            let [x, y] = exact.place(omega * state.t);
            worst = worst.max((state.q[0] - ARM * x).hypot(state.q[2] - ARM * y));
            assert!(state.q[1].abs() < 1e-12);
        }
        points.push((h, worst));
    }
    let order = loglog_slope(&points).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}: {points:?}");
}

#[test]
fn two_cubes_fixed_to_each_other_keep_their_pose_and_their_angular_momentum() {
    let cube = Body::solid_box(1.0, [0.2; 3]).unwrap();
    let metric = BodyMetric::<Poses>::new(vec![cube, cube]);
    let (w, half) = (Vector3::new(0.5, 1.0, -0.3), Vector3::x() * 0.2);
    let motion = |side: f64| BodyMotion {
        pose: RigidMotion { translation: half * side, rotation: Rotation::identity() },
        velocity: w.cross(&(half * side)),
        angular_velocity: w,
    };
    let initial: State<Vec<f64>> = metric.state(&[motion(-1.0), motion(1.0)]).unwrap();
    let system = metric.under(Free { freedoms: 12 }).unwrap();
    let ends = [Attachment::Body(0, half), Attachment::Body(1, -half)];
    let fixed = Joint::fixed(Poses, 2, ends, [Rotation::identity(); 2]).unwrap();
    let choice = Few::<6>(Redundancy::Refuse);
    let mut rattle =
        Rattle::along(FreeBodies(ConstantVelocity), &system, fixed, &initial, choice).unwrap();
    let mut state = initial.clone();
    let momentum = spatial_angular_momentum::<Poses>(&initial).unwrap();
    for _ in 0..1_000 {
        rattle.step(&mut state, 0.01).unwrap();
        let (a, b) = (Poses::pose_at(&state.q, 0), Poses::pose_at(&state.q, 1));
        assert!(a.rotation.direction_to(&b.rotation).norm() < 1e-11);
        assert!((a.apply(&half) - b.apply(&-half)).norm() < 1e-11);
    }
    let drift = spatial_angular_momentum::<Poses>(&state).unwrap() - momentum;
    assert!(drift.norm() < 1e-12, "{drift}");
    // Velocities agree, too: neither cube moves against the other.
    let mut v = Vector(vec![0.0; 12]);
    stationary_calculus::Metric::sharp(system.metric(), Covector(&state.p.0[..]), v.view_mut());
    let mut moved = state.q.clone();
    Poses.advance(&mut moved, 1e-6, v.view());
    let (a, b) = (Poses::pose_at(&moved, 0), Poses::pose_at(&moved, 1));
    assert!(a.rotation.direction_to(&b.rotation).norm() < 1e-11);
}

/// Straight motions, taken for bodies all the same.
#[derive(Clone)]
struct Careless;

impl FreeMotion<BodyMetric<Poses>, Poses> for Careless {
    fn advance(
        &self,
        metric: &BodyMetric<Poses>,
        space: &Poses,
        h: f64,
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        mut room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        metric.drift(h, p.view(), room.view_mut());
        space.advance(q, 1.0, room.view());
        Ok(())
    }
}

#[test]
fn along_straight_motions_bodies_of_unequal_moments_would_lose_their_gyroscopic_torque() {
    // A tumbling body held at its centre by a ball joint takes no force: it must turn as a free top.
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let w = Vector3::new(1.0, 2.0, 3.0);
    let pose = RigidMotion::identity();
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: w };
    let initial = metric.state(&[motion]).unwrap();
    let system = metric.under(Free { freedoms: 6 }).unwrap();
    let ends = [Attachment::World(Vector3::zeros()), Attachment::Body(0, Vector3::zeros())];
    let joint = Joint::ball(Poses, 1, ends).unwrap();
    let top = FreeTop::new(body, Rotation::identity(), w).unwrap();
    let few = || Few::<3>(Redundancy::Refuse);
    let off = |rattle: &mut dyn ConstrainedIntegrator<Vec<f64>>| {
        let mut state = initial.clone();
        (0..1_000).for_each(|_| _ = rattle.step(&mut state, 1e-3).unwrap());
        Poses::pose_at(&state.q, 0).rotation.direction_to(&top.orientation(1.0).unwrap()).norm()
    };
    let mut careless = Rattle::along(Careless, &system, joint.clone(), &initial, few()).unwrap();
    assert!(off(&mut careless) > 0.1);
    let motion = FreeBodies(ConstantVelocity);
    let mut right = Rattle::along(motion, &system, joint.clone(), &initial, few()).unwrap();
    assert!(off(&mut right) < 1e-5);
    // The notes' 6.5 as well.
    let mut first = ConstrainedHamilton::along(motion, &system, joint, &initial, few()).unwrap();
    assert!(off(&mut first) < 1e-5);
}

#[test]
fn a_point_that_is_off_is_measured_by_the_longer_arm() {
    let length = POINT.norm().max(OTHER.norm());
    for joint in all(Poses) {
        let hung = joint == all(Poses)[2];
        let arm = if hung { POINT.norm() } else { length };
        for row in 0..joint.count() {
            let expected = Scale { slope: 1.0, length: if row < 3 { arm } else { 1.0 } };
            assert_eq!(joint.scale(row), expected, "{joint:?} {row}");
        }
    }
}
