//! Noether's theorem for bodies: which motions their systems allow, and what is kept for them.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, Metric, Potential, Sink, Space, System, Vector};
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_integrators::{Asymmetry, State, Symmetry};
use stationary_rigid::problems::{nodding_top, thrown_boxes};
use stationary_rigid::{
    Attachment, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, BodySpring, Carried,
    ConstantVelocity, FourBar, FreeBodies, LieGroup, Orientations, PlanarCarried, PlanarWeight,
    PointMass, Poses, RigidMotion, Rotation, Spun, Weight, spatial_angular_momentum,
};

const ONE: Vector3<f64> = Vector3::new(0.3, -0.8, 0.5);
const OTHER: Vector3<f64> = Vector3::new(-0.6, 0.2, 0.7);

fn carried<S>(velocity: Vector3<f64>, angular_velocity: Vector3<f64>, space: S) -> Carried<S> {
    Carried { velocity, angular_velocity, space }
}

type Pair = System<BodyMetric<Poses>, BodySpring<Poses>, Poses>;

/// Two bodies on a spring, their state and their velocity.
fn pair() -> (Pair, State<Vec<f64>>, Vec<f64>) {
    let bodies = [[0.1, 0.2, 0.3], [0.2, 0.1, 0.25]].map(|h| Body::solid_box(1.5, h).unwrap());
    let metric = BodyMetric::<Poses>::new(bodies.to_vec());
    let motion = |place: Vector3<f64>, w: Vector3<f64>| BodyMotion {
        pose: RigidMotion { translation: place, rotation: Rotation::exp(w) },
        velocity: w + place,
        angular_velocity: place - w,
    };
    let state = metric.state(&[motion(ONE, OTHER), motion(OTHER, -ONE)]).unwrap();
    let ends = [Attachment::Body(0, OTHER * 0.5), Attachment::Body(1, OTHER - ONE)];
    let system = metric.under(BodySpring::new(Poses, 2, 3.0, ends).unwrap()).unwrap();
    let mut v = Vector(vec![0.0; 12]);
    system.metric().sharp(state.p.view(), v.view_mut());
    (system, state, v.0)
}

#[test]
fn the_generator_is_the_velocity_of_the_group_s_action() {
    let (_, state, _) = pair();
    let group = carried(ONE, OTHER, Poses);
    let mut xi = Vector(vec![0.0; 12]);
    group.generator(&state.q, xi.view_mut());
    for body in 0..2 {
        let pose = Poses::pose_at(&state.q, body);
        let e = 1e-6;
        let twist = nalgebra::Vector6::new(ONE.x, ONE.y, ONE.z, OTHER.x, OTHER.y, OTHER.z);
        let [ahead, behind] = [e, -e].map(|s| RigidMotion::exp(twist * s).compose(&pose));
        let moved = (ahead.translation - behind.translation) / (2.0 * e);
        let turned = behind.rotation.direction_to(&ahead.rotation) / (2.0 * e);
        let got = Vector3::from_column_slice(&xi.0[6 * body..][..3]);
        let turn = Vector3::from_column_slice(&xi.0[6 * body + 3..][..3]);
        assert!((moved - got).norm() < 1e-9 && (turned - turn).norm() < 1e-9);
    }
}

#[test]
fn what_a_symmetry_does_to_a_velocity_is_its_rate_where_the_path_is_moved() {
    // Move both ends of a short path, and read the velocity of what they become.
    let (_, state, v) = pair();
    let (e, s) = (1e-4, 1e-4);
    let velocity = |symmetry: &dyn Symmetry, s: f64| -> Vec<f64> {
        let end = |along: f64| {
            let mut q = state.q.clone();
            Poses.advance(&mut q, along, Vector(&v));
            let mut xi = Vector(vec![0.0; 12]);
            // A step of the group's own flow: the midpoint rule on its generator.
            symmetry.generator(&q, xi.view_mut());
            let mut half = q.clone();
            Poses.advance(&mut half, 0.5 * s, xi.view());
            symmetry.generator(&half, xi.view_mut());
            Poses.advance(&mut q, s, xi.view());
            q
        };
        let (ahead, behind) = (end(e), end(-e));
        let body = |k: usize| {
            let (a, b) = (Poses::pose_at(&ahead, k), Poses::pose_at(&behind, k));
            let linear = (a.translation - b.translation) / (2.0 * e);
            let turn = b.rotation.direction_to(&a.rotation) / (2.0 * e);
            linear.iter().chain(turn.iter()).copied().collect::<Vec<_>>()
        };
        [body(0), body(1)].concat()
    };
    let symmetries: [&dyn Symmetry; 2] =
        [&carried(ONE, OTHER, Poses), &Spun::new(Poses, 2, 1, ONE).unwrap()];
    for symmetry in symmetries {
        let mut dxi = Vector(vec![0.0; 12]);
        symmetry.generator_along(&state.q, Vector(&v), dxi.view_mut());
        let (ahead, behind) = (velocity(symmetry, s), velocity(symmetry, -s));
        for (k, dxi) in dxi.0.iter().enumerate() {
            let rate = (ahead[k] - behind[k]) / (2.0 * s);
            assert!((rate - dxi).abs() < 1e-5, "freedom {k}: {rate} and {dxi}");
        }
    }
}

#[test]
fn bodies_on_a_spring_have_every_motion_of_space_and_no_spin() {
    let (system, state, v) = pair();
    let off = |symmetry: &dyn Symmetry| {
        let off = Asymmetry::of_system(&system, &symmetry, &state.q, Vector(&v)).unwrap();
        assert!(off.scale > 0.0);
        off.relative()
    };
    for axis in [Vector3::x(), Vector3::y(), Vector3::z(), ONE] {
        assert!(off(&carried(axis, Vector3::zeros(), Poses)) < 1e-14);
        assert!(off(&carried(Vector3::zeros(), axis, Poses)) < 1e-14);
        assert!(off(&Spun::new(Poses, 2, 0, axis).unwrap()) > 1e-2);
    }
}

#[test]
fn their_momentum_maps_are_linear_and_spatial_angular_momentum() {
    let (_, state, _) = pair();
    let linear: Vector3<f64> =
        [0, 6].map(|k| Vector3::from_column_slice(&state.p.0[k..][..3])).iter().sum();
    let along = carried(ONE, Vector3::zeros(), Poses).momentum(&state.q, state.p.view());
    let about = carried(Vector3::zeros(), ONE, Poses).momentum(&state.q, state.p.view());
    let angular = spatial_angular_momentum::<Poses>(&state).unwrap();
    assert!((along - linear.dot(&ONE)).abs() < 1e-14);
    assert!((about - angular.dot(&ONE)).abs() < 1e-14);
}

#[test]
fn a_heavy_symmetric_top_has_two_symmetries_and_keeps_both_momenta() {
    let top = nodding_top().unwrap();
    let upright = carried(Vector3::zeros(), Vector3::z(), Orientations);
    let own = Spun::new(Orientations, 1, 0, Vector3::z()).unwrap();
    let tilted = carried(Vector3::zeros(), Vector3::x(), Orientations);
    let across = Spun::new(Orientations, 1, 0, Vector3::x()).unwrap();
    let symmetries: [(&dyn Symmetry, bool); 4] =
        [(&upright, true), (&own, true), (&tilted, false), (&across, false)];
    let mut v = Vector(vec![0.0; 3]);
    let after = |method: BodyMethod| {
        let mut state = top.initial.clone();
        let mut integrator = method.integrator(&top.system).unwrap();
        (0..100).for_each(|_| _ = integrator.step(&mut state, 1e-3).unwrap());
        state
    };
    let state = after(BodyMethod::VariationalRotation);
    top.system.metric().sharp(state.p.view(), v.view_mut());
    for (symmetry, holds) in symmetries {
        let off = Asymmetry::of_system(&top.system, &symmetry, &state.q, v.view()).unwrap();
        assert_eq!(off.relative() < 1e-14, holds, "{off:?}");
        let momentum = |s: &State<Vec<f64>>| symmetry.momentum(&s.q, s.p.view());
        let drift = (momentum(&state) - momentum(&top.initial)).abs();
        assert_eq!(drift < 1e-13, holds, "{drift:e}");
    }
    // Turns about one axis after the other do not know that two of them are alike.
    let split = after(BodyMethod::AxisRotations);
    let drift = |symmetry: &dyn Symmetry| {
        let momentum = |s: &State<Vec<f64>>| symmetry.momentum(&s.q, s.p.view());
        (momentum(&split) - momentum(&top.initial)).abs()
    };
    assert!(drift(&upright) < 1e-13 && drift(&own) > 1e-12);
}

/// The torque of a weight about an axis, through the generator, is the change of angular momentum.
#[test]
fn a_symmetry_that_weight_breaks_is_measured_as_its_torque() {
    let body = Body::solid_box(2.0, [0.1, 0.2, 0.3]).unwrap();
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let pose = RigidMotion { translation: ONE, rotation: Rotation::exp(OTHER) };
    let motion = BodyMotion { pose, velocity: OTHER, angular_velocity: ONE };
    let state = metric.state(&[motion]).unwrap();
    let load = PointMass { mass: 2.0, point: Vector3::zeros() };
    let gravity = Vector3::z() * -10.0;
    let system = metric.under(Weight { gravity, masses: vec![load], space: Poses }).unwrap();
    let mut v = Vector(vec![0.0; 6]);
    system.metric().sharp(state.p.view(), v.view_mut());
    let about = carried(Vector3::zeros(), Vector3::x(), Poses);
    let off = Asymmetry::of_system(&system, &about, &state.q, v.view()).unwrap();
    let torque = ONE.cross(&(gravity * 2.0)).x;
    assert!((off.change - torque).abs() < 1e-13 && off.relative() > 0.1, "{off:?}");
}

#[test]
fn joints_between_bodies_keep_the_momenta_of_all_motions_of_space() {
    let boxes = thrown_boxes().unwrap();
    let motion = FreeBodies(ConstantVelocity);
    let choice = SparseDiagonal::default();
    let (system, joints) = (&boxes.system, &boxes.joints);
    let mut rattle = Rattle::along(motion, system, joints, &boxes.initial, choice).unwrap();
    let mut state = boxes.initial.clone();
    (0..500).for_each(|_| _ = rattle.step(&mut state, 1e-2).unwrap());
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        for group in
            [carried(axis, Vector3::zeros(), Poses), carried(Vector3::zeros(), axis, Poses)]
        {
            let momentum = |s: &State<Vec<f64>>| group.momentum(&s.q, s.p.view());
            assert!((momentum(&state) - momentum(&boxes.initial)).abs() < 1e-13);
        }
    }
}

/// Bars that attract each other's centres, and nothing else.
struct Attracting;

impl Potential for Attracting {
    fn dim(&self) -> usize {
        9
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * ((q[3] - q[0]).powi(2) + (q[4] - q[1]).powi(2))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for c in 0..2 {
            dv.0[3 + c] += q[3 + c] - q[c];
            dv.0[c] -= q[3 + c] - q[c];
        }
    }

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}

#[test]
fn in_the_plane_weight_breaks_what_attraction_does_not() {
    let gravity = Vector2::new(0.0, -9.81);
    let bars = FourBar { lengths: [0.2, 0.5, 0.4, 0.5], density: 2.0, gravity };
    let (q, v) = (bars.configuration(0.7), Vector(bars.slope(0.7)));
    let group = PlanarCarried { velocity: Vector2::new(0.3, 0.4), angular_velocity: 0.7 };
    let free = System::new(bars.metric().unwrap(), Attracting).unwrap();
    let kept = Asymmetry::of_system(&free, &group, &q, v.view()).unwrap();
    assert!(kept.scale > 0.0 && kept.relative() < 1e-15, "{kept:?}");
    let PlanarWeight { masses, .. } = bars.weight();
    let heavy = System::new(bars.metric().unwrap(), bars.weight()).unwrap();
    let broken = Asymmetry::of_system(&heavy, &group, &q, v.view()).unwrap();
    let rise = |bar: usize| masses[bar] * (0.4 + 0.7 * q[3 * bar]);
    let power = (0..3).map(rise).sum::<f64>() * gravity.y;
    assert!((broken.change - power).abs() < 1e-13, "{broken:?} {power}");
}

#[test]
fn a_turn_of_the_world_leaves_the_angular_velocities_of_bare_orientations() {
    // Body axes turn along: nothing is left to change.
    let turn = carried(ONE, OTHER, Orientations);
    let q = [Rotation::exp(ONE).quaternion(), Rotation::exp(OTHER).quaternion()].concat();
    let mut dxi = Vector(vec![7.0; 6]);
    turn.generator_along(&q, Vector(&[0.4, -1.0, 0.3, 2.0, 0.1, -0.6]), dxi.view_mut());
    assert_eq!(dxi.0, vec![0.0; 6]);
}
