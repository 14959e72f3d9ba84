//! Jointed bodies in motion, against bodies about a point and closed forms; what their motion keeps.

use std::f64::consts::{PI, TAU};

use nalgebra::{SMatrix, SVector, Vector3};
use stationary_calculus::Potential;
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, Dense, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::problems::{
    JointedProblem, TOP, held_at_a_point, thrown_boxes, top_on_its_tip,
};
use stationary_rigid::{
    AxisRotations, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, ConstantVelocity,
    ExactRotation, FreeBodies, FreeRotation, FreeTop, LieGroup, Orientations, PointMass, Poses,
    RigidMotion, Rotation, Weight, right_jacobian, spatial_angular_momentum, tilt,
};

const GRAVITY: f64 = 9.81;
const BOX: [f64; 3] = [0.1, 0.2, 0.3];

/// Runs jointed bodies for `steps` steps of `h`, turned by the map `R`, and shows every state with
/// the multipliers of the step before it.
fn run<R: FreeRotation + Clone, P: Potential>(
    map: R,
    problem: &JointedProblem<P>,
    (h, steps): (f64, u32),
    mut see: impl FnMut(&State<Vec<f64>>, &[f64]),
) -> State<Vec<f64>> {
    let JointedProblem { system, joints, initial, .. } = problem;
    let motion = FreeBodies(map);
    let mut rattle =
        Rattle::along(motion, system, joints, initial, SparseDiagonal::default()).unwrap();
    let mut state = initial.clone();
    for _ in 0..steps {
        rattle.step(&mut state, h).unwrap();
        see(&state, rattle.multipliers());
    }
    state
}

/// From one angle to another the short way, radians.
fn apart(to: f64, from: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}

fn attitude(state: &State<Vec<f64>>) -> Rotation {
    Poses::pose_at(&state.q, 0).rotation
}

#[test]
fn a_box_held_at_its_centre_turns_as_the_free_top() {
    let (body, w) = (Body::solid_box(1.0, BOX).unwrap(), Vector3::new(1.0, 2.0, 3.0));
    let origin = Vector3::zeros();
    let start = Rotation::exp(Vector3::new(0.5, -0.2, 1.1));
    let problem = held_at_a_point(body, origin, start, w, origin).unwrap();
    let top = FreeTop::new(body, start, w).unwrap();
    fn error<R: FreeRotation + Clone>(
        map: R,
        problem: &JointedProblem<Weight<Poses>>,
        top: &FreeTop,
        steps: u32,
    ) -> f64 {
        let end = run(map, problem, (4.0 / f64::from(steps), steps), |_, lambda| {
            assert!(lambda.iter().all(|f| f.abs() < 1e-12), "no force holds it: {lambda:?}");
        });
        attitude(&end).direction_to(&top.orientation(4.0).unwrap()).norm()
    }
    let order = |error: &dyn Fn(u32) -> f64| (error(2_000) / error(4_000)).log2();
    let variational = order(&|steps| error(ConstantVelocity, &problem, &top, steps));
    let split = order(&|steps| error(AxisRotations, &problem, &top, steps));
    assert!((variational - 2.0).abs() < 0.05 && (split - 2.0).abs() < 0.05);
    assert!(error(ExactRotation, &problem, &top, 100) < 1e-12);
}

/// A box hung from a corner: no axis of it is a symmetry of the motion.
fn box_on_its_corner() -> (JointedProblem<Weight<Poses>>, Vector3<f64>) {
    let body = Body::solid_box(1.0, BOX).unwrap();
    let (corner, w) = (Vector3::from(BOX), Vector3::new(4.0, -3.0, 8.0));
    let start = Rotation::exp(Vector3::new(0.5, -0.2, 1.1));
    let gravity = Vector3::z() * -GRAVITY;
    (held_at_a_point(body, corner, start, w, gravity).unwrap(), w)
}

/// The attitude of the same box as a body about a fixed point, by another method, after one second.
fn about_the_corner() -> Rotation {
    let (problem, w) = box_on_its_corner();
    let centre = problem.system.metric().bodies()[0];
    let mass = stationary_rigid::SpatialMass {
        mass: 1.0,
        centre: -Vector3::from(BOX),
        inertia: nalgebra::Matrix3::from_diagonal(&centre.moments()),
    };
    let frame = stationary_rigid::PrincipalFrame::of(&mass.about(&Vector3::zeros())).unwrap();
    let body = Body::new(1.0, frame.moments).unwrap();
    let metric = BodyMetric::<Orientations>::new(vec![body]);
    let rotation = attitude(&problem.initial).compose(&frame.rotation);
    let pose = RigidMotion { translation: Vector3::zeros(), rotation };
    let angular_velocity = frame.rotation.rotate_back(&w);
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity };
    let mut state = metric.state(&[motion]).unwrap();
    let load = PointMass { mass: 1.0, point: frame.rotation.rotate_back(&mass.centre) };
    let gravity = Vector3::z() * -GRAVITY;
    let weight = Weight { gravity, masses: vec![load], space: Orientations };
    let system = metric.under(weight).unwrap();
    let mut method = BodyMethod::MuntheKaas4.integrator(&system).unwrap();
    for _ in 0..20_000 {
        method.step(&mut state, 5e-5).unwrap();
    }
    Orientations::pose_at(&state.q, 0).rotation.compose(&frame.rotation.inverse())
}

#[test]
fn a_box_on_its_corner_moves_as_a_body_about_a_fixed_point_with_order_two() {
    let ((problem, _), exact) = (box_on_its_corner(), about_the_corner());
    fn errors<R: FreeRotation + Clone>(
        map: R,
        problem: &JointedProblem<Weight<Poses>>,
        exact: &Rotation,
    ) -> Vec<(f64, f64)> {
        let one = |steps: u32| {
            let h = 1.0 / f64::from(steps);
            let end = run(map.clone(), problem, (h, steps), |_, _| ());
            (h, attitude(&end).direction_to(exact).norm())
        };
        [500, 1_000, 2_000].map(one).to_vec()
    }
    let all = [
        errors(ConstantVelocity, &problem, &exact),
        errors(AxisRotations, &problem, &exact),
        errors(ExactRotation, &problem, &exact),
    ];
    for points in all {
        let order = loglog_slope(&points).unwrap();
        assert!((order - 2.0).abs() < 0.05, "{order}: {points:?}");
        assert!(points[2].1 < 1e-3, "{points:?}");
    }
}

#[test]
fn a_precessing_top_on_a_ball_joint_keeps_its_tilt_and_rate_and_its_support_carries_it() {
    let [slow, _] = TOP.steady_precession(0.5, 60.0).unwrap();
    let problem = top_on_its_tip(slow).unwrap();
    let arm = TOP.weight_moment / GRAVITY * 0.5_f64.sin();
    let (h, steps) = (1e-4, 10_000);
    let start = attitude(&problem.initial).rotate(&Vector3::z());
    let (mut azimuth, mut turned) = (start.y.atan2(start.x), 0.0);
    run(ConstantVelocity, &problem, (h, steps), |state, lambda| {
        let axis = attitude(state).rotate(&Vector3::z());
        assert!((tilt(&attitude(state)) - 0.5).abs() < 1e-5);
        let now = axis.y.atan2(axis.x);
        turned += apart(now, azimuth);
        azimuth = now;
        // The support carries the weight, and pulls the centre round its circle.
        let [x, y, z] = [lambda[0], lambda[1], lambda[2]];
        assert!((z - GRAVITY).abs() < 2e-3, "{lambda:?}");
        assert!((x.hypot(y) - arm * slow * slow).abs() < 2e-3, "{lambda:?}");
        assert!(x * axis.x + y * axis.y < 0.0);
    });
    let rate = turned / (f64::from(steps) * h);
    assert!((rate / slow - 1.0).abs() < 1e-4, "{rate} against {slow}");
}

#[test]
fn a_nodding_top_on_a_ball_joint_stays_between_its_bounds_and_reaches_both() {
    let problem = top_on_its_tip(0.0).unwrap();
    // About the tip: the moment of the centre's momentum adds to the spin.
    let m = {
        let pose = Poses::pose_at(&problem.initial.q, 0);
        pose.rotation.rotate_back(&spatial_angular_momentum::<Poses>(&problem.initial).unwrap())
    };
    let [low, high] = TOP.nutation(&attitude(&problem.initial), &m);
    assert!((low - 0.5).abs() < 1e-7 && high > 0.55, "{low} {high}");
    let reach = |h: f64, steps: u32| {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        run(ConstantVelocity, &problem, (h, steps), |state, _| {
            let angle = tilt(&attitude(state));
            (least, most) = (least.min(angle), most.max(angle));
        });
        (least - low, most - high)
    };
    let (coarse, fine) = (reach(1e-3, 5_000), reach(2.5e-4, 20_000));
    assert!(coarse.0.abs() < 5e-4 && coarse.1.abs() < 5e-4, "{coarse:?}");
    assert!(fine.1.abs() < 0.1 * coarse.1.abs() + 1e-6, "{coarse:?} {fine:?}");
}

#[test]
fn thrown_jointed_boxes_keep_their_momenta_over_100_000_steps_and_their_energy_has_no_trend() {
    let problem = thrown_boxes().unwrap();
    let angular = |state: &State<Vec<f64>>| spatial_angular_momentum::<Poses>(state).unwrap();
    let linear = |state: &State<Vec<f64>>| {
        state.p.0.chunks(6).map(|p| Vector3::new(p[0], p[1], p[2])).sum::<Vector3<f64>>()
    };
    let (start, energy) = (&problem.initial, problem.energy(&problem.initial));
    let (mut drift, mut worst, mut mean, mut step) = ([0.0_f64; 2], 0.0_f64, [0.0_f64; 2], 0);
    run(ConstantVelocity, &problem, (2e-3, 100_000), |state, _| {
        drift[0] = drift[0].max((linear(state) - linear(start)).norm());
        drift[1] = drift[1].max((angular(state) - angular(start)).norm());
        let off = problem.energy(state) / energy - 1.0;
        worst = worst.max(off.abs());
        mean[usize::from(step >= 50_000)] += off / 50_000.0;
        step += 1;
    });
    assert!(drift.iter().all(|drift| *drift < 1e-12), "{drift:?}");
    // The motion is chaotic: how far energy swings depends on where it leads, its mean does not.
    assert!(worst < 1e-5 && (mean[1] - mean[0]).abs() < 1e-6, "{worst:e} {mean:?}");
    let end = run(ConstantVelocity, &problem, (2e-3, 1_000), |_, _| ());
    let mut g = vec![0.0; problem.joints.count()];
    problem.joints.value(0.0, &end.q, &mut g).unwrap();
    assert!(g.iter().all(|g| g.abs() < 1e-12), "{g:?}");
}

#[test]
fn jointed_bodies_return_when_their_momenta_are_reversed() {
    let problem = thrown_boxes().unwrap();
    let JointedProblem { system, joints, initial, .. } = &problem;
    let motion = FreeBodies(AxisRotations);
    let mut rattle =
        Rattle::along(motion, system, joints, initial, SparseDiagonal::default()).unwrap();
    let mut state = initial.clone();
    for _ in 0..2 {
        for _ in 0..50 {
            rattle.step(&mut state, 0.01).unwrap();
        }
        state.p.0.iter_mut().for_each(|p| *p = -*p);
    }
    let off =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off(&state.q, &initial.q) < 1e-11, "{:e}", off(&state.q, &initial.q));
    assert!(off(&state.p.0, &initial.p.0) < 1e-11, "{:e}", off(&state.p.0, &initial.p.0));
}

#[test]
fn jointed_motion_preserves_the_symplectic_form_of_what_the_joint_leaves_free() {
    let (problem, _) = box_on_its_corner();
    let body = problem.system.metric().bodies()[0];
    let corner = Vector3::from(BOX);
    let JointedProblem { system, joints, initial, .. } = &problem;
    // A step in the chart R = exp(theta) of the body about its corner.
    let stepped = |y: &SVector<f64, 6>| {
        let theta: Vector3<f64> = y.fixed_rows::<3>(0).into();
        let momentum: Vector3<f64> = y.fixed_rows::<3>(3).into();
        let m = right_jacobian(&theta).transpose().lu().solve(&momentum).unwrap();
        let square =
            nalgebra::Matrix3::identity() * corner.norm_squared() - corner * corner.transpose();
        let inertia = nalgebra::Matrix3::from_diagonal(&body.moments()) + square * body.mass();
        let w = inertia.lu().solve(&m).unwrap();
        let rotation = Rotation::exp(theta);
        let gravity = Vector3::z() * -GRAVITY;
        let mut state = held_at_a_point(body, corner, rotation, w, gravity).unwrap().initial;
        let motion = FreeBodies(ConstantVelocity);
        let mut rattle =
            Rattle::along(motion, system, joints, &state, Dense::<3>(Redundancy::Refuse)).unwrap();
        rattle.step(&mut state, 0.05).unwrap();
        let theta = attitude(&state).log();
        let m = attitude(&state).rotate_back(&spatial_angular_momentum::<Poses>(&state).unwrap());
        let p = right_jacobian(&theta).transpose() * m;
        SVector::<f64, 6>::from_iterator(theta.iter().chain(p.iter()).copied())
    };
    let theta = attitude(initial).log();
    let m = attitude(initial).rotate_back(&spatial_angular_momentum::<Poses>(initial).unwrap());
    let p = right_jacobian(&theta).transpose() * m;
    let at = SVector::<f64, 6>::from_iterator(theta.iter().chain(p.iter()).copied());
    let mut form = SMatrix::<f64, 6, 6>::zeros();
    for i in 0..3 {
        form[(i, i + 3)] = 1.0;
        form[(i + 3, i)] = -1.0;
    }
    let mut d = SMatrix::<f64, 6, 6>::zeros();
    for j in 0..6 {
        let moved = |by: f64| {
            let mut y = at;
            y[j] += by;
            stepped(&y)
        };
        let e = 1e-3;
        let (near, far) = (moved(e) - moved(-e), moved(2.0 * e) - moved(-2.0 * e));
        d.set_column(j, &((near * 8.0 - far) / (12.0 * e)));
    }
    let off = (d.transpose() * form * d - form).amax();
    assert!(off < 1e-8, "{off:e}");
}

#[test]
fn a_step_of_jointed_bodies_allocates_nothing() {
    let problem = thrown_boxes().unwrap();
    let JointedProblem { system, joints, initial, .. } = &problem;
    let motion = FreeBodies(ConstantVelocity);
    let mut rattle =
        Rattle::along(motion, system, joints, initial, SparseDiagonal::default()).unwrap();
    let mut state = initial.clone();
    rattle.step(&mut state, 1e-3).unwrap();
    let steps = || (0..10).for_each(|_| _ = rattle.step(&mut state, 1e-3).unwrap());
    assert_eq!(allocation_counter::measure(steps).count_total, 0);
}
