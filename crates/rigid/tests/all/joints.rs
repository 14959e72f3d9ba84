//! Joints on poses: their derivatives, their ranks, and bodies that hang from them.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, Space, Vector, assert_derivatives_on};
use stationary_constraints::problems::pendulum;
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, Dense, FreeMotion, Pairing, Rattle,
    Redundancy, Rows, SparseDiagonal,
};
use stationary_integrators::{State, StepError};
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, BodySpace, ConstantVelocity, Free, FreeBodies, FreeTop, Joint,
    JointEnd, JointFault, JointKind, LieGroup, Orientations, PointMass, Poses, RigidError,
    RigidMotion, Rotation, Weight, null_space, spatial_angular_momentum,
};

pub(crate) const POINT: Vector3<f64> = Vector3::new(0.1, 0.4, -0.3);
pub(crate) const OTHER: Vector3<f64> = Vector3::new(-0.2, 0.3, 0.6);

const A: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);
const B: Vector3<f64> = Vector3::new(0.3, 1.0, -0.2);

pub(crate) const KINDS: [JointKind; 11] = [
    JointKind::Weld,
    JointKind::Hinge { axis: A },
    JointKind::Slider { axis: A },
    JointKind::Screw { axis: A, pitch: 0.3 },
    JointKind::Cylinder { axis: A },
    JointKind::Universal { axes: [A, B] },
    JointKind::Planar { axes: [A, B] },
    JointKind::Ball,
    JointKind::Rod { length: 0.7 },
    JointKind::OnLine { axis: A },
    JointKind::OnCircle { axis: A, radius: 0.4 },
];

/// Two ends, on two bodies or on one and the world, with frames of their own.
pub(crate) fn ends() -> [[JointEnd; 2]; 3] {
    let (turn, other) = (Rotation::exp(POINT), Rotation::exp(-OTHER));
    let hung = JointEnd::world(OTHER).turned(turn);
    let second = JointEnd::on(1, OTHER).turned(other);
    [[JointEnd::on(0, POINT).turned(turn), second], [hung, second], [second, hung]]
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
    for kind in KINDS {
        for ends in ends() {
            let joint = Joint::new(Poses, 2, kind, ends).unwrap();
            let own = multipliers[..joint.count()].to_vec();
            assert_derivatives_on(&Poses, &Pairing::new(joint, own, 0.0).unwrap(), &poses);
            let joint = Joint::new(Orientations, 2, kind, ends).unwrap();
            let own = multipliers[..joint.count()].to_vec();
            let pairing = Pairing::new(joint, own, 0.0).unwrap();
            assert_derivatives_on(&Orientations, &pairing, &orientations);
        }
    }
}

struct Entries(nalgebra::DMatrix<f64>);
impl Rows for Entries {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.0[(row, freedom)] += value;
    }
}

/// Poses of two bodies whose ends stand a motion apart: the second's frame, as the first's sees it.
pub(crate) fn apart(ends: &[JointEnd; 2], motion: &RigidMotion) -> [RigidMotion; 2] {
    let first = RigidMotion { translation: OTHER, rotation: Rotation::exp(POINT) };
    let frame = first.compose(&ends[0].frame).compose(motion);
    [first, frame.compose(&ends[1].frame.inverse())]
}

pub(crate) fn numbers(poses: [RigidMotion; 2]) -> Vec<f64> {
    let one = |pose: &RigidMotion| {
        let [w, x, y, z] = pose.rotation.quaternion();
        let t = pose.translation;
        [t.x, t.y, t.z, w, x, y, z]
    };
    poses.iter().flat_map(one).collect()
}

/// Motions that the kind leaves free.
pub(crate) fn left_free(kind: &JointKind) -> Vec<RigidMotion> {
    let across = A.cross(&B).normalize();
    let moved = |translation, turn| RigidMotion { translation, rotation: Rotation::exp(turn) };
    let rest = Vector3::zeros();
    let some = [0.0, 0.4, -2.9, 3.5, 40.0];
    let motion = |s: f64| match kind {
        JointKind::Weld | JointKind::Free => RigidMotion::identity(),
        JointKind::Hinge { axis } => moved(rest, axis * s),
        JointKind::Slider { axis } => moved(axis * s, rest),
        JointKind::Screw { axis, pitch } => moved(axis * (pitch * s), axis * s),
        JointKind::Cylinder { axis } => moved(axis * s, axis * (2.0 * s)),
        JointKind::Universal { axes: [a, b] } => {
            moved(rest, a * s).compose(&moved(rest, b.normalize() * (0.3 * s)))
        }
        JointKind::Planar { axes: [a, b] } => moved(a * s + b * (0.2 * s), across * s),
        JointKind::Ball => moved(rest, POINT * s),
        JointKind::Rod { length } => moved(POINT.normalize() * *length, OTHER * s),
        JointKind::OnLine { axis } => moved(axis * s, OTHER * s),
        JointKind::OnCircle { radius, .. } => {
            moved(Rotation::exp(A * s).rotate(&(across * *radius)), OTHER * s)
        }
    };
    some.map(motion).to_vec()
}

#[test]
fn a_joint_stays_closed_along_the_motions_that_it_leaves_free_and_has_full_rank_there() {
    for kind in KINDS {
        for ends in ends().into_iter().take(1) {
            let joint = Joint::new(Poses, 2, kind, ends).unwrap();
            assert_eq!(joint.count() + kind.freedoms(), 6, "{kind:?}");
            for motion in left_free(&kind) {
                let q = numbers(apart(&ends, &motion));
                let mut g = vec![0.0; joint.count()];
                joint.value(0.0, &q, &mut g).unwrap();
                let reach = 1.0 + motion.translation.norm();
                assert!(g.iter().all(|g| g.abs() < 4e-15 * reach), "{kind:?} {motion:?}: {g:?}");
                let mut rows = Entries(nalgebra::DMatrix::zeros(joint.count(), 12));
                joint.differential(0.0, &q, &mut rows).unwrap();
                let free = null_space(&rows.0).unwrap().ncols();
                assert_eq!(free, 6 + kind.freedoms(), "{kind:?} {motion:?}");
            }
        }
    }
}

#[test]
fn a_joint_is_open_beside_the_motions_that_it_leaves_free() {
    for kind in KINDS {
        let ends = ends()[0];
        let joint = Joint::new(Poses, 2, kind, ends).unwrap();
        // Six small motions away from a closed place: as many of them open it as it has rows, at least.
        let closed = left_free(&kind)[1];
        let opened = (0..6).filter(|&k| {
            let mut by = nalgebra::Vector6::zeros();
            by[k] = 1e-3;
            let q = numbers(apart(&ends, &closed.compose(&RigidMotion::exp(by))));
            let mut g = vec![0.0; joint.count()];
            joint.value(0.0, &q, &mut g).unwrap();
            g.iter().any(|g| g.abs() > 1e-7)
        });
        assert!(opened.count() >= joint.count(), "{kind:?}");
    }
}

#[test]
fn a_joint_that_cannot_be_is_refused_by_its_name_and_its_bodies() {
    let fault = |kind: JointKind, ends: [JointEnd; 2]| {
        let error = Joint::new(Poses, 2, kind, ends).unwrap_err();
        let RigidError::Joint { joint, fault } = error else { panic!("{error}") };
        assert_eq!(joint.bodies, ends.map(|end| end.body));
        assert!(error.to_string().starts_with(&format!("{joint}: ")), "{error}");
        fault
    };
    let body = |k| JointEnd::on(k, POINT);
    let ball = JointKind::Ball;
    assert_eq!(fault(ball, [body(1), body(1)]), JointFault::ToItself);
    assert_eq!(fault(ball, [JointEnd::world(POINT); 2]), JointFault::ToItself);
    let absent = JointFault::NoSuchBody { body: 2, bodies: 2 };
    assert_eq!(fault(ball, [body(0), body(2)]), absent);
    let two = [body(0), body(1)];
    let axisless = fault(JointKind::Hinge { axis: Vector3::zeros() }, two);
    assert_eq!(axisless, JointFault::NoAxis([0.0; 3]));
    let parallel = fault(JointKind::Planar { axes: [A, A * -2.0] }, two);
    assert!(matches!(parallel, JointFault::Parallel(_)));
    let endless = fault(JointKind::Screw { axis: A, pitch: f64::INFINITY }, two);
    assert!(matches!(endless, JointFault::NotFinite { what: "the pitch", .. }));
    let short = fault(JointKind::Rod { length: -0.1 }, two);
    assert_eq!(short, JointFault::NotPositive { what: "the length", value: -0.1 });
    let point = fault(JointKind::OnCircle { axis: A, radius: 0.0 }, two);
    assert_eq!(point, JointFault::NotPositive { what: "the radius", value: 0.0 });
    let nowhere = JointEnd::world(Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(fault(ball, [nowhere, body(0)]), JointFault::NotFinite { .. }));
    let hinge = Joint::new(Poses, 2, JointKind::Hinge { axis: A }, ends()[1]).unwrap();
    assert_eq!(hinge.name().to_string(), "hinge between the world and body 1");
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
    let tip = JointEnd::on(0, Vector3::z() * ARM);
    let ends = [JointEnd::world(Vector3::zeros()), tip];
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let mut points = Vec::new();
    for steps in [200_u32, 400, 800] {
        let h = exact.period / omega / f64::from(steps);
        let choice = SparseDiagonal::default();
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
    let ends = [JointEnd::on(0, half), JointEnd::on(1, -half)];
    let fixed = Joint::new(Poses, 2, JointKind::Weld, ends).unwrap();
    let choice = SparseDiagonal::default();
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
        &mut self,
        metric: &BodyMetric<Poses>,
        space: &Poses,
        (_, h): (f64, f64),
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
    let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::zeros())];
    let joint = Joint::new(Poses, 1, JointKind::Ball, ends).unwrap();
    let top = FreeTop::new(body, Rotation::identity(), w).unwrap();
    let few = || Dense::<3>(Redundancy::Refuse);
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
fn a_point_that_is_off_is_measured_by_the_longer_arm_and_an_angle_by_its_cosine() {
    let longer = POINT.norm().max(OTHER.norm());
    for (ends, arm) in ends().into_iter().zip([longer, OTHER.norm(), OTHER.norm()]) {
        let scales = |kind: JointKind| {
            let joint = Joint::new(Poses, 2, kind, ends).unwrap();
            (0..joint.count()).map(|row| joint.scale(row).length).collect::<Vec<_>>()
        };
        assert_eq!(scales(JointKind::Hinge { axis: A }), [arm, arm, arm, 1.0, 1.0]);
        assert_eq!(scales(JointKind::Rod { length: 9.0 }), [9.0]);
        assert_eq!(scales(JointKind::Screw { axis: A, pitch: -5.0 })[4], 5.0);
        assert_eq!(scales(JointKind::OnLine { axis: A }), [arm, arm]);
    }
}
