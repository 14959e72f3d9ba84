//! Limits and dry friction of joints as rows of a world, against closed forms, in the plane and in space.
//!
//! ```text
//! I phi'' = -m g l sin phi      to the stop at phi_s, and there it rests:  sum of impulses = I w_s + m g l sin phi_s t
//! I phi'' = -b sign phi'        phi = I w^2/(2 b) at last
//! b > m g l sin phi             stays
//! ```
//! `I` about the hinge, `b` the bound of friction (N m).

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::Constraint;
use stationary_contact::{Detector, Kept, PlanarDetector, PlanarWorld, SpatialWorld, WorldReport};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Along, Body, BodyMetric, BodyMotion, Joint, JointEnd, JointFriction, JointKind, JointLimits,
    LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarWeight, PointMass, Poses, RigidMotion,
    Rotation, Weight,
};

const GRAVITY: f64 = 9.81;
const MASS: f64 = 2.0;
/// From the hinge to the centre, m, and the moment about the centre, kg m^2.
const ARM: f64 = 0.5;
const MOMENT: f64 = 0.3;

fn about_the_hinge() -> f64 {
    MOMENT + MASS * ARM * ARM
}

/// What is seen of a step: the angle from where it hangs, rad, its rate, rad/s, and the report.
type Seen = (f64, f64, WorldReport);

/// A pendulum in the plane or in space, which hangs at angle 0, with limits or friction of its hinge.
struct Pendulum {
    limits: Option<[f64; 2]>,
    friction: Option<f64>,
    gravity: f64,
    angle: f64,
    spin: f64,
}

impl Pendulum {
    /// Steps until `seen` says that it is enough; how open the hinge is at most.
    fn run(&self, flat: bool, h: f64, time: f64, seen: impl FnMut(Seen)) -> f64 {
        if flat { self.run_in_plane(h, time, seen) } else { self.run_in_space(h, time, seen) }
    }

    fn run_in_plane(&self, h: f64, time: f64, mut seen: impl FnMut(Seen)) -> f64 {
        let weight = PlanarWeight { gravity: Vector2::y() * -self.gravity, masses: vec![MASS] };
        let metric = DiagonalMetric::new(vec![MASS, MASS, MOMENT]).unwrap();
        let detector = PlanarDetector::new(Vec::new(), 1).unwrap();
        let mut world = PlanarWorld::new(System::new(metric, weight).unwrap(), detector).unwrap();
        let ends = [PlanarEnd::world(Vector2::zeros()), PlanarEnd::on(0, Vector2::new(0.0, ARM))];
        let pin = PlanarJoint::new(1, PlanarJointKind::Pin, ends).unwrap();
        let limits: Vec<_> =
            self.limits.iter().map(|&l| JointLimits::in_plane(1, ends, l).unwrap()).collect();
        let friction: Vec<_> =
            self.friction.iter().map(|&b| JointFriction::in_plane(1, ends, b).unwrap()).collect();
        let (s, c) = self.angle.sin_cos();
        let [vx, vy] = [c, s].map(|along| ARM * self.spin * along);
        let p = vec![MASS * vx, MASS * vy, MOMENT * self.spin];
        let mut state = State::new(vec![ARM * s, -ARM * c, self.angle], Covector(p));
        let joints = (Kept(&pin), limits, friction);
        let mut open = 0.0_f64;
        while state.t < time {
            let report = world.step_with(&mut state, h, &joints).unwrap();
            let mut values = [0.0; 2];
            pin.value(0.0, &state.q, &mut values).unwrap();
            open = values.iter().fold(open, |most, value| value.abs().max(most));
            seen((state.q[2], state.p.0[2] / MOMENT, report));
        }
        open
    }

    fn run_in_space(&self, h: f64, time: f64, mut seen: impl FnMut(Seen)) -> f64 {
        let metric = BodyMetric::<Poses>::new(vec![Body::new(MASS, [0.4, 0.5, MOMENT]).unwrap()]);
        let rotation = Rotation::exp(Vector3::z() * self.angle);
        let pose = RigidMotion { translation: rotation.rotate(&(Vector3::y() * -ARM)), rotation };
        let spin = Vector3::z() * self.spin;
        let motion =
            BodyMotion { pose, velocity: spin.cross(&pose.translation), angular_velocity: spin };
        let mut state = metric.state(&[motion]).unwrap();
        let masses = vec![PointMass { mass: MASS, point: Vector3::zeros() }];
        let gravity = Vector3::y() * -self.gravity;
        let system = metric.under(Weight { gravity, masses, space: Poses }).unwrap();
        let detector = Detector::new(Vec::new(), 1).unwrap();
        let mut world = SpatialWorld::new(system, detector).unwrap();
        let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::y() * ARM)];
        let axis = Vector3::z();
        let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis }, ends).unwrap();
        let turn = (Along::Turn, axis);
        let limits: Vec<_> = self
            .limits
            .iter()
            .map(|&limits| JointLimits::new(Poses, 1, turn, ends, limits).unwrap())
            .collect();
        let friction: Vec<_> = self
            .friction
            .iter()
            .map(|&bound| JointFriction::new(Poses, 1, turn, ends, bound).unwrap())
            .collect();
        let joints = (Kept(&hinge), limits, friction);
        let mut open = 0.0_f64;
        while state.t < time {
            let report = world.step_with(&mut state, h, &joints).unwrap();
            let mut values = [0.0; 5];
            hinge.value(0.0, &state.q, &mut values).unwrap();
            open = values.iter().fold(open, |most, value| value.abs().max(most));
            let q = &state.q;
            let turn = Rotation::from_quaternion([q[3], q[4], q[5], q[6]]).unwrap().log();
            seen((turn.z, state.p.0[5] / MOMENT, report));
        }
        open
    }
}

/// From rest at 1.2 rad a pendulum falls onto a stop at 0.3 rad, and stays there from the first touch: the time
/// by the integral of its rate, the energy that it loses that of its fall.
#[test]
fn a_pendulum_that_falls_onto_a_stop_rests_there_after_the_time_of_the_closed_form() {
    let (from, stop) = (1.2_f64, 0.3_f64);
    let pendulum = Pendulum {
        limits: Some([stop, 2.0]),
        friction: None,
        gravity: GRAVITY,
        angle: from,
        spin: 0.0,
    };
    // t = int dphi/sqrt(2 k (cos phi - cos from)), with phi = from - s^2 in the place of the root.
    let k = MASS * GRAVITY * ARM / about_the_hinge();
    let rate = |s: f64| {
        let fall = (from - s * s).cos() - from.cos();
        if s == 0.0 {
            2.0 / (2.0 * k * from.sin()).sqrt()
        } else {
            2.0 * s / (2.0 * k * fall).sqrt()
        }
    };
    let (parts, end) = (2_000, (from - stop).sqrt());
    let ds = end / f64::from(parts);
    let weight = |i: u32| match i {
        0 => 1.0,
        _ if i == parts => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let simpson = |i: u32| weight(i) * rate(ds * f64::from(i));
    let time = ds / 3.0 * (0..=parts).map(simpson).sum::<f64>();
    let lost = MASS * GRAVITY * ARM * (stop.cos() - from.cos());
    for flat in [true, false] {
        let mut points = Vec::new();
        for h in [4e-3, 2e-3, 1e-3] {
            let (mut rested, mut steps, mut taken) = (f64::NAN, 0, 0.0);
            let open = pendulum.run(flat, h, 1.5, |(angle, spin, report)| {
                steps += 1;
                assert!(report.settled, "{report:?}");
                assert!(angle > stop - 1e-12, "{angle} at step {steps}");
                taken += report.joint_energy;
                if rested.is_nan() && spin.abs() < 1e-9 && angle < stop + 1e-9 {
                    rested = h * f64::from(steps);
                }
                if !rested.is_nan() {
                    // It stays, to the bits of rounding, and the stop gives what the weight asks for.
                    assert!((angle - stop).abs() < 1e-12 && spin.abs() < 1e-9, "{angle} {spin}");
                }
            });
            assert!(open < 1e-10, "{open}");
            points.push((h, (taken / lost - 1.0).abs()));
            assert!((rested - time).abs() < 3.0 * h, "{flat} {h}: {rested} {time}");
        }
        println!("{flat}: energy taken off by {points:?}");
        assert!(loglog_slope(&points).unwrap() > 0.8, "{points:?}");
    }
}

/// A hinge with friction alone: the body stops after `I w^2/(2 b)`, off by less than a step's way.
#[test]
fn a_hinge_with_friction_stops_at_the_angle_of_the_closed_form_to_first_order() {
    let (spin, bound) = (1.6, 0.9);
    let expected = about_the_hinge() * spin * spin / (2.0 * bound);
    let pendulum = Pendulum { limits: None, friction: Some(bound), gravity: 0.0, angle: 0.0, spin };
    for flat in [true, false] {
        let mut points = Vec::new();
        for h in [8e-3, 4e-3, 2e-3, 1e-3] {
            let (mut at, mut still) = (0.0, false);
            let open = pendulum.run(flat, h, 2.0, |(angle, spin, report)| {
                assert!(
                    report.settled && report.joint_energy > -1e-14,
                    "{angle:e} {spin:e} {report:?}"
                );
                // What has stopped stays.
                assert!(!still || angle == at, "{angle} {at}");
                (at, still) = (angle, spin.abs() < 1e-12);
            });
            assert!(still && open < 1e-10, "{open}");
            points.push((h, (at - expected).abs()));
            assert!((at - expected).abs() < spin * h, "{at} {expected}");
        }
        println!("{flat}: {points:?}");
        let slope = loglog_slope(&points).unwrap();
        assert!(slope > 0.7, "{slope} {points:?}");
    }
}

#[test]
fn a_hinge_holds_a_pendulum_up_to_its_friction_and_lets_it_go_beyond() {
    let angle = 0.7_f64;
    let weight = MASS * GRAVITY * ARM * angle.sin();
    for flat in [true, false] {
        for (part, holds) in [(1.001, true), (0.999, false)] {
            let pendulum = Pendulum {
                limits: None,
                friction: Some(part * weight),
                gravity: GRAVITY,
                angle,
                spin: 0.0,
            };
            let mut at = angle;
            pendulum.run(flat, 1e-3, 2.0, |(angle, _, report)| {
                assert!(report.settled, "{report:?}");
                at = angle;
            });
            // What is let go swings about the angle that the friction would hold, a thousandth of the
            // weight's moment away, and is held where it turns back.
            let falls = if holds { 0.0 } else { 2.0 * (1.0 - part) * angle.tan() };
            let off = (at - angle + falls).abs();
            assert!(off < 1e-12 + 0.01 * falls, "{flat} {part}: {at} {falls}");
        }
    }
}

/// Limits that no angle meets say so, whatever the laws leave.
#[test]
fn two_hinges_whose_limits_exclude_each_other_are_not_settled() {
    let ends = [PlanarEnd::world(Vector2::zeros()), PlanarEnd::on(0, Vector2::new(0.0, ARM))];
    let limits = |limits| JointLimits::in_plane(1, ends, limits).unwrap();
    let both = vec![limits([0.1, 0.5]), limits([-0.5, -0.1])];
    let metric = DiagonalMetric::new(vec![MASS, MASS, MOMENT]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![MASS] };
    let detector = PlanarDetector::new(Vec::new(), 1).unwrap();
    let mut world = PlanarWorld::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let mut state = State::new(vec![0.0; 3], Covector(vec![0.0; 3]));
    let report = world.step_with(&mut state, 1e-2, &both).unwrap();
    assert!(!report.settled && report.residual > 1.0, "{report:?}");
    assert!(state.q.iter().chain(&state.p.0).all(|x| x.is_finite()), "{state:?}");
}
