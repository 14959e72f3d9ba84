//! Mechanisms that stand still: mobility, assembly, forces at an instant, small swings.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Potential, System, assert_derivatives};
use stationary_constraints::{
    Composed, ConstrainedIntegrator, Constraint, ConstraintError, Forced, Rattle, Redundancy,
    RowLaw, SparseDiagonal, VelocityRows,
};
use stationary_integrators::{Scheme, State};
use stationary_measure::{SplitMix64, loglog_slope};
use stationary_rigid::{
    Along, AxisRotations, Body, BodyForces, BodyMetric, BodyMotion, ConstantVelocity, Drive,
    ExactRotation, FreeBodies, FreeRotation, Joint, JointEnd, JointFriction, JointKind,
    JointLimits, LieGroup, MechanismError, Mobility, PointMass, Poses, RigidMotion, Rotation,
    Schedule, Weight, assemble, instant, linearize, mobility,
};

pub(crate) type Weighed = System<BodyMetric<Poses>, Weight<Poses>, Poses>;

const HINGE: JointKind = JointKind::Hinge { axis: Vector3::new(0.0, 1.0, 0.0) };

pub(crate) fn bodies(count: usize) -> Weighed {
    let body = Body::new(1.0, [0.1, 0.2, 0.15]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; count];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    BodyMetric::new(vec![body; count]).under(weight).unwrap()
}

pub(crate) fn joint(count: usize, kind: JointKind, ends: [JointEnd; 2]) -> Joint<Poses> {
    Joint::new(Poses, count, kind, ends).unwrap()
}

fn posed(poses: &[(Vector3<f64>, f64)]) -> Vec<f64> {
    let one = |(x, angle): &(Vector3<f64>, f64)| {
        let mut q = x.as_slice().to_vec();
        q.extend(Rotation::exp(Vector3::y() * *angle).quaternion());
        q
    };
    poses.iter().flat_map(one).collect()
}

/// A parallelogram of three bars, 1 m each, on the ground, its cranks at an angle from upright.
fn parallelogram(kinds: [JointKind; 4], angle: f64) -> (Vec<Joint<Poses>>, Vec<f64>) {
    let (x, z) = (Vector3::x(), Vector3::z());
    let up = Rotation::exp(Vector3::y() * angle).rotate(&z);
    let joints = vec![
        joint(3, kinds[0], [JointEnd::world(Vector3::zeros()), JointEnd::on(0, -z * 0.5)]),
        joint(3, kinds[1], [JointEnd::on(0, z * 0.5), JointEnd::on(1, -x * 0.5)]),
        joint(3, kinds[2], [JointEnd::on(1, x * 0.5), JointEnd::on(2, z * 0.5)]),
        joint(3, kinds[3], [JointEnd::on(2, -z * 0.5), JointEnd::world(x)]),
    ];
    let q = posed(&[(up * 0.5, angle), (up + x * 0.5, 0.0), (x + up * 0.5, angle)]);
    (joints, q)
}

#[test]
fn a_loop_of_four_hinges_has_one_freedom_and_three_redundant_equations_of_its_last_joint() {
    let system = bodies(3);
    let (joints, q) = parallelogram([HINGE; 4], 0.4);
    let found = mobility(system.metric(), &joints, 0.0, &q).unwrap();
    assert_eq!((found.freedoms, found.rank), (1, 17));
    assert!(found.redundant.iter().all(|&(joint, _)| joint == 3), "{found:?}");
    assert_eq!(found.redundant.len(), 3);
    let names = found.redundant_names(|joint| joints[joint].name());
    for (name, (_, equation)) in names.iter().zip(&found.redundant) {
        let told = format!("equation {equation} of joint 3 (hinge between body 2 and the world)");
        assert_eq!(*name, told);
    }
    // Told without redundancy: a ball and a point on a line across.
    let line = JointKind::OnLine { axis: Vector3::y() };
    let (joints, q) = parallelogram([HINGE, HINGE, HINGE, line], 0.4);
    let expected = Mobility { freedoms: 1, rank: 17, redundant: vec![] };
    assert_eq!(mobility(system.metric(), &joints, 0.0, &q), Ok(expected));
}

#[test]
fn a_parallelogram_is_freer_where_it_lies_flat_and_near_there_its_rank_is_named_unclear() {
    let system = bodies(3);
    let flat = std::f64::consts::FRAC_PI_2;
    let free = |angle: f64| {
        let (joints, q) = parallelogram([HINGE; 4], angle);
        mobility(system.metric(), &joints, 0.0, &q).map(|found| found.freedoms)
    };
    assert_eq!(free(0.4), Ok(1));
    assert_eq!(free(flat), Ok(2));
    assert!(matches!(free(flat + 1e-8), Err(MechanismError::RankUnclear { .. })));
}

#[test]
fn a_step_from_where_a_parallelogram_lies_flat_names_the_position_and_its_hinge() {
    let system = bodies(3);
    let (joints, q) = parallelogram([HINGE; 4], std::f64::consts::FRAC_PI_2);
    let state = State::new(q, Covector(vec![0.0; 18]));
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let motion = FreeBodies(ConstantVelocity);
    let mut rattle = Rattle::along(motion, &system, &joints, &state, shared).unwrap();
    let mut moved = state.clone();
    let error = rattle.step(&mut moved, 0.01).unwrap_err();
    let ConstraintError::SingularPosition { names, .. } = &error else { panic!("{error}") };
    assert!(names.contains("constraint ") && names.contains("hinge between"), "{names}");
    assert_eq!(moved, state);
}

#[test]
fn bennett_s_linkage_moves_although_counting_says_that_it_does_not() {
    // Four skew hinges: links a, b with twists alpha, beta, and a sin beta = b sin alpha.
    let (a, alpha, beta) = (1.0_f64, 0.6_f64, 1.1_f64);
    let b = a * beta.sin() / alpha.sin();
    let (lengths, twists) = ([a, b, a, b], [alpha, beta, alpha, beta]);
    // Its closure: tan(u/2) tan(v/2) = sin((alpha + beta)/2) / sin((beta - alpha)/2).
    let u = 1.3_f64;
    let ratio = (0.5 * (alpha + beta)).sin() / (0.5 * (beta - alpha)).sin();
    let v = 2.0 * (ratio / (0.5 * u).tan()).atan();
    let turns = [u, v, -u, -v];
    let mut frame = RigidMotion::identity();
    let mut frames = vec![frame];
    for k in 0..4 {
        let about = |axis: Vector3<f64>, angle: f64| RigidMotion {
            translation: Vector3::zeros(),
            rotation: Rotation::exp(axis * angle),
        };
        let along =
            RigidMotion { translation: Vector3::x() * lengths[k], rotation: Rotation::identity() };
        frame = frame
            .compose(&about(Vector3::z(), turns[k]))
            .compose(&along)
            .compose(&about(Vector3::x(), twists[k]));
        frames.push(frame);
    }
    let gap = frames[0].inverse().compose(&frames[4]).log().norm();
    assert!(gap < 1e-12, "it closes: {gap:e}");
    // Bodies 0 to 2 stand with their own axes along the world's; link 3 is the ground.
    let poses: Vec<_> = (0..3)
        .map(|k| RigidMotion {
            translation: frames[k + 1].translation,
            rotation: frames[k + 1].rotation,
        })
        .collect();
    let end = |k: usize, frame: &RigidMotion| match k {
        3 => JointEnd { body: None, frame: *frame },
        _ => JointEnd::where_it_stands(k, &poses[k], frame),
    };
    let kind = JointKind::Hinge { axis: Vector3::z() };
    let joints: Vec<_> = (0..4)
        .map(|k| joint(3, kind, [end((k + 3) % 4, &frames[k]), end(k, &frames[k])]))
        .collect();
    let mut q = Vec::new();
    for pose in &poses {
        q.extend(pose.translation.as_slice());
        q.extend(pose.rotation.quaternion());
    }
    let found = mobility(bodies(3).metric(), &joints, 0.0, &q).unwrap();
    assert_eq!((found.freedoms, found.redundant.len()), (1, 3), "counting says -2");
}

#[test]
fn a_four_bar_is_assembled_from_a_rough_guess_and_one_that_cannot_close_is_refused() {
    let system = bodies(3);
    let (joints, q) = parallelogram([HINGE; 4], 0.4);
    let mut guess = q.clone();
    guess.iter_mut().enumerate().for_each(|(k, q)| *q += 0.1 * (1.7 * k as f64).sin());
    for body in 0..3 {
        let quaternion = &mut guess[7 * body + 3..][..4];
        let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
        quaternion.iter_mut().for_each(|c| *c /= length);
    }
    let closed = assemble(system.metric(), &joints, 0.0, &guess).unwrap();
    let mut g = vec![0.0; joints.count()];
    joints.value(0.0, &closed.q, &mut g).unwrap();
    assert!(g.iter().all(|g| g.abs() < 1e-12) && closed.iterations < 30, "{}", closed.iterations);
    // The ground is longer than what the bars reach.
    let far = joint(
        3,
        HINGE,
        [JointEnd::on(2, -Vector3::z() * 0.5), JointEnd::world(Vector3::x() * 4.0)],
    );
    let open = [&joints[..3], &[far]].concat();
    let error = assemble(system.metric(), &open, 0.0, &guess).unwrap_err();
    assert!(
        error.to_string().contains("of constraint ") && error.to_string().contains("hinge between")
    );
    let MechanismError::NotAssembled { gap, .. } = error else { panic!("{error}") };
    assert!(gap > 0.1 && gap < 1.0, "{gap}");
    let error = assemble(system.metric(), &joints, 0.0, &guess[..20]).unwrap_err();
    assert!(matches!(error, MechanismError::Size(_)));
}

/// A turn that is not steady.
#[derive(Debug)]
struct Swing;
impl Schedule for Swing {
    fn at<R: stationary_calculus::Number>(&self, t: R) -> R {
        (t * 1.7).sin() * 0.8
    }
}

fn swinging(angle: f64, speed: f64) -> BodyMotion {
    let rotation = Rotation::exp(Vector3::y() * angle);
    let arm = rotation.rotate(&(Vector3::z() * 0.5));
    BodyMotion {
        pose: RigidMotion { translation: -arm, rotation },
        velocity: (Vector3::y() * speed).cross(&-arm),
        angular_velocity: Vector3::y() * speed,
    }
}

fn hung() -> [JointEnd; 2] {
    [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)]
}

#[test]
fn a_pendulum_at_an_instant_has_the_acceleration_and_the_pull_of_the_closed_form() {
    let system = bodies(1);
    let hinge = joint(1, HINGE, hung());
    let (angle, speed, inertia) = (0.7_f64, 1.3, 0.2 + 0.25);
    let state = system.metric().state(&[swinging(angle, speed)]).unwrap();
    let mut v = stationary_calculus::Vector(vec![0.0; 6]);
    stationary_calculus::Metric::sharp(system.metric(), state.p.view(), v.view_mut());
    let mut forces = BodyForces::new(Poses, 1);
    forces.about_axis(hung(), Vector3::y(), |_, _, rate| 2.0 - 0.3 * rate).unwrap();
    let found = instant(&system, &hinge, &forces, (0.0, &state.q, &v.0)).unwrap();
    let expected = (2.0 - 0.3 * speed - 9.81 * 0.5 * angle.sin()) / inertia;
    assert!((found.accelerations[4] - expected).abs() < 1e-12);
    // The pull along the bar: weight and what turns the centre about the hinge.
    let pull = Vector3::from_column_slice(&found.multipliers[..3]);
    let along = Rotation::exp(Vector3::y() * angle).rotate(&Vector3::z());
    let along_bar = 9.81 * angle.cos() + 0.5 * speed * speed;
    assert!((pull.dot(&along).abs() - along_bar).abs() < 1e-11, "{pull}");
}

#[test]
fn forces_at_an_instant_are_the_limit_of_rattle_s_with_a_drive_and_with_redundant_equations() {
    let system = bodies(1);
    let hinge = joint(1, HINGE, hung());
    let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), hung(), Swing).unwrap();
    let held = (hinge.clone(), hinge, drive);
    let start = system.metric().state(&[swinging(0.0, 0.8 * 1.7)]).unwrap();
    let mut forces = BodyForces::new(Poses, 1);
    forces.about_axis(hung(), Vector3::y(), |_, _, rate| -0.3 * rate).unwrap();
    let motion = Forced::new(FreeBodies(ConstantVelocity), forces.clone());
    let equations = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = Rattle::along(motion, &system, &held, &start, equations).unwrap();
    let (mut state, h) = (start, 1e-3);
    for _ in 0..500 {
        rattle.step(&mut state, h).unwrap();
    }
    let before = rattle.multipliers().to_vec();
    let mut v = stationary_calculus::Vector(vec![0.0; 6]);
    stationary_calculus::Metric::sharp(system.metric(), state.p.view(), v.view_mut());
    let found = instant(&system, &held, &forces, (state.t, &state.q, &v.0)).unwrap();
    rattle.step(&mut state, h).unwrap();
    for (k, lambda) in found.multipliers.iter().enumerate() {
        let mean = 0.5 * (before[k] + rattle.multipliers()[k]);
        assert!((lambda - mean).abs() < 2e-5, "{k}: {lambda} {mean}");
    }
    let acceleration = -0.8 * 1.7 * 1.7 * (1.7_f64 * 0.5).sin();
    assert!((found.accelerations[4] - acceleration).abs() < 1e-9);
}

#[test]
fn a_hanging_pendulum_is_linearized_to_its_frequency_and_upside_down_to_its_rate_of_fall() {
    let system = bodies(1);
    let hinge = joint(1, HINGE, hung());
    let square = 9.81 * 0.5 / (0.2 + 0.25);
    for (angle, expected) in [(0.0, square), (std::f64::consts::PI, -square)] {
        let state = system.metric().state(&[swinging(angle, 0.0)]).unwrap();
        let found = linearize(&system, &hinge, 0.0, &state.q).unwrap();
        assert_eq!(found.dim(), 1);
        assert!((found.stiffness[(0, 0)] - expected).abs() < 1e-9, "{}", found.stiffness);
        assert_derivatives(&found, &[0.3]);
        assert!(found.metric().is_ok());
    }
    let state = system.metric().state(&[swinging(0.5, 0.0)]).unwrap();
    let error = linearize(&system, &hinge, 0.0, &state.q).unwrap_err();
    assert!(matches!(error, MechanismError::NotAtRest { .. }));
}

#[test]
fn rattle_is_composed_to_orders_four_and_six_with_joints_that_are_driven_and_free_along_every_map()
{
    composed_along(ExactRotation);
    composed_along(AxisRotations);
    composed_along(ConstantVelocity);
}

fn composed_along<R: FreeRotation + Copy + std::fmt::Debug>(map: R) {
    let system = bodies(2);
    let z = Vector3::z();
    let hinge = joint(2, HINGE, hung());
    let ball = joint(2, JointKind::Ball, [JointEnd::on(0, -z * 0.5), JointEnd::on(1, z * 0.5)]);
    let drive = Drive::new(Poses, 2, Along::Turn, Vector3::y(), hung(), Swing).unwrap();
    let held = (vec![hinge, ball], drive);
    let first = swinging(0.0, 0.8 * 1.7);
    let second = BodyMotion {
        pose: RigidMotion { translation: -z * 1.5, rotation: Rotation::identity() },
        velocity: first.velocity * 2.0 + Vector3::new(0.4, 0.5, 0.0).cross(&(-z * 0.5)),
        angular_velocity: Vector3::new(0.4, 0.5, 0.3),
    };
    let initial = system.metric().state(&[first, second]).unwrap();
    let run = |scheme: Scheme, steps: u32| {
        let equations = SparseDiagonal(Redundancy::Refuse);
        let motion = FreeBodies(map);
        let rattle = Rattle::along(motion, &system, &held, &initial, equations).unwrap();
        let mut method = Composed::new(rattle, scheme, &initial).unwrap();
        let (mut state, mut seen) = (initial.clone(), Vec::new());
        for step in 1..=steps {
            method.step(&mut state, 1.0 / f64::from(steps)).unwrap();
            if step % (steps / 4) == 0 {
                seen.extend(state.q.iter().chain(&state.p.0).copied());
            }
        }
        let mut g = [0.0; 9];
        held.value(state.t, &state.q, &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-12));
        seen
    };
    let truth = run(Scheme::KahanLi8, 160);
    for (scheme, steps) in [(Scheme::Suzuki4, [16_u32, 32, 64]), (Scheme::KahanLi6, [12, 20, 32])] {
        let points = steps.map(|steps| {
            let seen = run(scheme, steps);
            let error = seen.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            (1.0 / f64::from(steps), error)
        });
        let (slope, order) = (loglog_slope(&points).unwrap(), scheme.facts().order);
        assert!((slope - f64::from(order)).abs() < 0.3, "{map:?}: {slope} {points:?}");
    }
    let equations = SparseDiagonal(Redundancy::Refuse);
    let rattle = Rattle::along(FreeBodies(map), &system, &held, &initial, equations).unwrap();
    let error = Composed::new(rattle, Scheme::BlanesMoan4, &initial).unwrap_err();
    assert!(matches!(error, ConstraintError::NotOfSteps { scheme: "blanes-moan-4" }));
}

#[test]
fn limits_and_friction_are_rows_along_the_joint_and_limits_in_the_wrong_order_are_refused() {
    let system = bodies(1);
    let limits = |limits| JointLimits::new(Poses, 1, (Along::Turn, Vector3::y()), hung(), limits);
    let state = system.metric().state(&[swinging(0.7, 1.3)]).unwrap();
    let bound = limits([-0.2, 1.0]).unwrap();
    assert!((bound.coordinate(&state.q).unwrap() - 0.7).abs() < 1e-14);
    let mut rows = VelocityRows::default();
    bound.push_rows(&state.q, 0.5, &mut rows).unwrap();
    let friction = JointFriction::new(Poses, 1, (Along::Turn, Vector3::y()), hung(), 0.5).unwrap();
    friction.push_rows(&state.q, 0.5, &mut rows).unwrap();
    let laws: Vec<_> = rows.blocks().map(|(law, _)| law).collect();
    assert_eq!(laws, [RowLaw::Limit, RowLaw::Limit, RowLaw::Bounded(0.25)]);
    // Along the motion the lower gap opens at the hinge's rate, and the upper one closes; each may close
    // within the step.
    let mut v = stationary_calculus::Vector(vec![0.0; 6]);
    stationary_calculus::Metric::sharp(system.metric(), state.p.view(), v.view_mut());
    for (row, [rate, gap]) in [[1.3, 0.9], [-1.3, 0.3], [1.3, 0.0]].into_iter().enumerate() {
        let own: f64 = rows.row(row).map(|(freedom, value)| value * v.0[freedom]).sum();
        assert!((own - rate).abs() < 1e-14, "{row}: {own}");
        assert!((rows.lack(row, v.view()) - rate - gap / 0.5).abs() < 1e-14, "{row}");
    }
    let short = bound.push_rows(&state.q[..3], 0.5, &mut rows).unwrap_err();
    assert!(matches!(short, ConstraintError::Size(_)) && rows.rows() == 3, "{short}");
    // Nothing holds a shift that has no limits.
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    let free = JointLimits::new(Poses, 1, (Along::Shift, Vector3::y()), hung(), free).unwrap();
    free.push_rows(&state.q, 0.5, &mut rows).unwrap();
    assert_eq!(rows.rows(), 3);
    for wrong in [[1.0, -0.2], [0.5, 0.5], [f64::NAN, 1.0], [-4.0, 0.0]] {
        let error = limits(wrong).unwrap_err().to_string();
        assert!(
            error.starts_with("limits between the world and body 0: the limits are"),
            "{error}"
        );
    }
    let error =
        JointFriction::new(Poses, 1, (Along::Turn, Vector3::y()), hung(), -0.5).unwrap_err();
    assert!(error.to_string().contains("the friction's bound is -0.5"), "{error}");
}

#[test]
fn universal_joints_of_every_size_close_from_near_to_a_part_in_a_million_million() {
    let mut noise = SplitMix64::new(1);
    let mut draw = || Vector3::from_fn(|_, _| noise.symmetric());
    for unit in [1e-5, 1e-2, 1.0, 1e4] {
        let body = Body::solid_box(1.0, [unit; 3]).unwrap();
        let metric = BodyMetric::<Poses>::new(vec![body]);
        for _ in 0..1000 {
            let kind = JointKind::Universal { axes: [draw(), draw()] };
            let pose = RigidMotion { translation: draw() * unit, rotation: Rotation::exp(draw()) };
            let frame = RigidMotion { translation: draw() * unit, rotation: Rotation::exp(draw()) };
            let own = JointEnd::where_it_stands(0, &pose, &frame);
            let held = joint(1, kind, [JointEnd { body: None, frame }, own]);
            let translation = pose.translation + draw() * (0.05 * unit);
            let rotation = pose.rotation.compose(&Rotation::exp(draw() * 0.1));
            let guess = [translation.as_slice(), &rotation.quaternion()].concat();
            let closed = assemble(&metric, &held, 0.0, &guess).unwrap();
            let mut gaps = [0.0; 4];
            held.value(0.0, &closed.q, &mut gaps).unwrap();
            let parts =
                gaps.iter().zip([unit, unit, unit, 1.0]).map(|(gap, length)| gap.abs() / length);
            let worst = parts.fold(0.0, f64::max);
            assert!(worst < 1e-12, "{unit}: {gaps:?}");
        }
    }
}

#[test]
fn neither_the_unit_of_length_nor_of_mass_changes_what_is_free_and_what_closes() {
    for unit in [1e-7, 1e-4, 1.0, 1e4, 1e7] {
        for mass in [1e-9, 1.0, 1e9] {
            let body = Body::solid_box(mass, [unit; 3]).unwrap();
            let metric = BodyMetric::<Poses>::new(vec![body]);
            let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * unit)];
            let held = vec![joint(1, HINGE, ends)];
            let tilt = Rotation::exp(Vector3::x() * 0.1).quaternion();
            let guess = [&[0.3 * unit, 0.0, -unit][..], &tilt].concat();
            let closed = assemble(&metric, &held, 0.0, &guess).unwrap();
            assert!(closed.iterations < 20, "{unit} {mass}: {}", closed.iterations);
            let mut gaps = [0.0; 5];
            held.value(0.0, &closed.q, &mut gaps).unwrap();
            assert!(
                gaps[..3].iter().all(|gap| gap.abs() < 1e-12 * unit),
                "{unit} {mass}: {gaps:?}"
            );
            assert!(gaps[3..].iter().all(|gap| gap.abs() < 1e-12), "{unit} {mass}: {gaps:?}");
            assert_eq!(mobility(&metric, &held, 0.0, &closed.q).unwrap().freedoms, 1);
        }
    }
}

#[test]
fn bodies_that_are_not_there_and_numbers_that_are_not_finite_are_errors_of_every_question() {
    let none = BodyMetric::<Poses>::new(Vec::new());
    let held = vec![joint(1, HINGE, hung())];
    let state = bodies(1).metric().state(&[swinging(0.0, 0.0)]).unwrap();
    assert!(matches!(mobility(&none, &held, 0.0, &state.q), Err(MechanismError::Size(_))));
    let mut open = state.q.clone();
    open[1] += 0.1;
    assert!(matches!(assemble(&none, &held, 0.0, &open), Err(MechanismError::Size(_))));
    let free: Vec<Joint<Poses>> = Vec::new();
    assert_eq!(mobility(&none, &free, 0.0, &[]).unwrap().freedoms, 0);
    assert_eq!(assemble(&none, &free, 0.0, &[]).unwrap().q, Vec::<f64>::new());
    let mut q = state.q;
    q[0] = f64::NAN;
    let error = mobility(bodies(1).metric(), &held, 0.0, &q).unwrap_err();
    assert!(matches!(error, MechanismError::NonFinite { index: 0, .. }), "{error}");
}
