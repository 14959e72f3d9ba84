//! Joints of the plane: their derivatives, what they leave free, and a wheel that rolls.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System, assert_derivatives};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, Dense, Pairing, Projection, Rattle,
    Redundancy,
};
use stationary_integrators::State;
use stationary_rigid::{
    JointFault, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarWeight, RigidError,
};

const POINT: Vector2<f64> = Vector2::new(0.3, -0.7);
const AXIS: Vector2<f64> = Vector2::new(1.2, 0.5);

const KINDS: [PlanarJointKind; 6] = [
    PlanarJointKind::Pin,
    PlanarJointKind::Weld,
    PlanarJointKind::Slider { axis: AXIS },
    PlanarJointKind::PinInSlot { axis: AXIS },
    PlanarJointKind::Rod { length: 0.8 },
    PlanarJointKind::Rolling { axis: AXIS, radius: 0.4 },
];

#[test]
fn the_derivatives_of_every_joint_of_the_plane_are_right() {
    let q = [0.4, -0.2, 0.9, -0.5, 0.1, 2.3];
    let on = |body, scale: f64| PlanarEnd::on(body, POINT * scale).turned(0.3 * scale);
    let world = PlanarEnd::world(POINT).turned(-0.8);
    for kind in KINDS {
        for ends in [[on(0, 1.0), on(1, -2.0)], [world, on(1, 1.0)], [on(1, 1.0), world]] {
            let joint = PlanarJoint::new(2, kind, ends).unwrap();
            let multipliers = [0.7, -1.3, 2.0][..joint.count()].to_vec();
            assert_derivatives(&Pairing::new(joint, multipliers, 0.0).unwrap(), &q);
        }
    }
}

#[test]
fn a_wheel_rolls_down_an_incline_at_two_thirds_of_the_acceleration_of_what_slides() {
    // A homogeneous disc: s = g sin(slope) t^2 / 3, and the force along the incline is a third of
    // the weight's.
    const G: f64 = 9.81;
    let (slope, radius) = (0.4_f64, 0.3);
    let along = Vector2::new(slope.cos(), -slope.sin());
    let across = Vector2::new(slope.sin(), slope.cos());
    let (mass, moment) = (2.0, radius * radius);
    let metric = DiagonalMetric::new(vec![mass, mass, moment]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::new(0.0, -G), masses: vec![mass] };
    let system = System::new(metric, weight).unwrap();
    let kind = PlanarJointKind::Rolling { axis: along, radius };
    let ends = [PlanarEnd::world(Vector2::zeros()), PlanarEnd::on(0, Vector2::zeros())];
    let wheel = PlanarJoint::new(1, kind, ends).unwrap();
    let start = across * radius;
    let mut state = State::new(vec![start.x, start.y, 0.0], Covector(vec![0.0; 3]));
    let few = Dense::<2>(Redundancy::Refuse);
    let mut rattle = Rattle::new(&system, wheel, &state, few).unwrap();
    for _ in 0..100 {
        rattle.step(&mut state, 0.01).unwrap();
    }
    let distance = G * slope.sin() * state.t * state.t / 3.0;
    let expected = start + along * distance;
    assert!((state.q[0] - expected.x).hypot(state.q[1] - expected.y) < 1e-12);
    assert!((state.q[2] + distance / radius).abs() < 1e-12);
    // Upwards on the wheel, along the incline: m g sin / 3, which turns it.
    let [normal, rolling] = [rattle.multipliers()[0], rattle.multipliers()[1]];
    assert!((normal.abs() - mass * G * slope.cos()).abs() < 1e-10, "{normal}");
    assert!((rolling.abs() - mass * G * slope.sin() / 3.0).abs() < 1e-10, "{rolling}");
}

#[test]
fn a_slider_crank_has_the_closed_form_s_places() {
    // x = r cos(a) + sqrt(l^2 - r^2 sin^2(a)) where the slider's axis passes through the crank's pin.
    let (r, l) = (0.2, 0.7);
    let (x, y) = (Vector2::x(), Vector2::zeros());
    let (crank, rod, slide) = (0, 1, 2);
    let on = |body, point: Vector2<f64>| PlanarEnd::on(body, point);
    let pin = |ends| PlanarJoint::new(3, PlanarJointKind::Pin, ends).unwrap();
    let joints = vec![
        pin([PlanarEnd::world(y), on(crank, -x * (r / 2.0))]),
        pin([on(crank, x * (r / 2.0)), on(rod, -x * (l / 2.0))]),
        pin([on(rod, x * (l / 2.0)), on(slide, y)]),
        PlanarJoint::new(
            3,
            PlanarJointKind::Slider { axis: x },
            [PlanarEnd::world(y), on(slide, y)],
        )
        .unwrap(),
    ];
    for angle in [0.0_f64, 0.7, 2.0, -2.5] {
        let tilt = -(r * angle.sin() / l).asin();
        let knee = Vector2::new(angle.cos(), angle.sin()) * r;
        let along = Vector2::new(tilt.cos(), tilt.sin()) * l;
        let (half, middle, end) = (knee / 2.0, knee + along / 2.0, knee + along);
        assert!((end.x - r * angle.cos() - (l * l - knee.y * knee.y).sqrt()).abs() < 1e-15);
        let q = [half.x, half.y, angle, middle.x, middle.y, tilt, end.x, end.y, 0.0];
        let mut g = vec![1.0; joints.count()];
        joints.value(0.0, &q, &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-15), "{g:?}");
        assert_eq!(joints.count(), 8);
    }
}

#[test]
fn joints_of_the_plane_that_cannot_be_are_refused_by_name() {
    let body = |k| PlanarEnd::on(k, POINT);
    let fault = |kind, ends: [PlanarEnd; 2]| match PlanarJoint::new(2, kind, ends) {
        Err(error @ RigidError::Joint { joint, fault }) => {
            assert_eq!(joint.bodies, ends.map(|end| end.body));
            assert!(error.to_string().starts_with(&format!("{joint}: ")), "{error}");
            fault
        }
        other => panic!("{other:?}"),
    };
    let (pin, two) = (PlanarJointKind::Pin, [body(0), body(1)]);
    assert_eq!(fault(pin, [body(1), body(1)]), JointFault::ToItself);
    let absent = JointFault::NoSuchBody { body: 2, bodies: 2 };
    assert_eq!(fault(pin, [body(0), body(2)]), absent);
    let turned = fault(PlanarJointKind::Weld, [body(0), body(1).turned(f64::NAN)]);
    assert!(matches!(turned, JointFault::NotFinite { what: "its angle", .. }));
    let axis = Vector2::zeros();
    assert!(matches!(fault(PlanarJointKind::Slider { axis }, two), JointFault::NoAxis(_)));
    let kind = PlanarJointKind::Rolling { axis: AXIS, radius: -1.0 };
    assert_eq!(fault(kind, two), JointFault::NotPositive { what: "the radius", value: -1.0 });
    let kind = PlanarJointKind::Rod { length: f64::NAN };
    assert!(matches!(fault(kind, two), JointFault::NotFinite { what: "the length", .. }));
}

/// A pin at the centre of body 0 and the centre of body 1 in a slot of it, all lengths times `unit`: places after a
/// second in it, and how much is left of the slot's equation.
fn ball_in_a_turning_tube(unit: f64) -> ([f64; 3], f64) {
    let inertia = [0.3, 0.1].map(|moment| moment * unit * unit);
    let masses = vec![1.0, 1.0, inertia[0], 0.7, 0.7, inertia[1]];
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0, 0.7] };
    let system = System::new(DiagonalMetric::new(masses).unwrap(), weight).unwrap();
    let centre = Vector2::zeros();
    let joints = [
        (PlanarJointKind::Pin, [PlanarEnd::world(centre), PlanarEnd::on(0, centre)]),
        (
            PlanarJointKind::PinInSlot { axis: Vector2::x() },
            [PlanarEnd::on(0, centre), PlanarEnd::on(1, centre)],
        ),
    ];
    let joints: Vec<_> = joints.map(|(kind, ends)| PlanarJoint::new(2, kind, ends).unwrap()).into();
    let (r, v, w) = (0.4 * unit, 0.1 * unit, 2.0);
    let p = vec![0.0, 0.0, inertia[0] * w, 0.7 * v, 0.7 * w * r, 0.3 * inertia[1]];
    let mut state = State::new(vec![0.0, 0.0, 0.0, r, 0.0, 0.0], Covector(p));
    let mut rattle = Rattle::new(&system, joints, &state, Dense::<3>(Redundancy::Refuse)).unwrap();
    for _ in 0..100 {
        rattle.step(&mut state, 0.01).unwrap();
    }
    let (sine, cosine) = state.q[2].sin_cos();
    let left = (cosine * state.q[4] - sine * state.q[3]) / unit;
    ([state.q[3] / unit, state.q[4] / unit, state.q[2]], left)
}

#[test]
fn the_unit_of_length_changes_nothing_where_joints_have_no_arms() {
    let (expected, _) = ball_in_a_turning_tube(1.0);
    for exponent in [-60, -30, 30, 60] {
        let (found, left) = ball_in_a_turning_tube(2.0_f64.powi(exponent));
        assert_eq!(found, expected, "2^{exponent}");
        assert!(left.abs() < 1e-15, "2^{exponent}: {left:e}");
    }
}

#[test]
fn the_unit_of_time_changes_nothing_of_which_velocities_may_start() {
    for exponent in [-60, -20, 0, 20, 60] {
        let second = 2.0_f64.powi(exponent);
        let gravity = Vector2::new(0.0, -9.81) / second / second;
        let metric = DiagonalMetric::new(vec![2.0, 2.0, 0.3]).unwrap();
        let system = System::new(metric, PlanarWeight { gravity, masses: vec![2.0] }).unwrap();
        let stands = [0.4, -0.2, 0.9];
        let ends = [PlanarEnd::world(POINT), PlanarEnd::where_it_stands(0, stands, POINT)];
        let weld = PlanarJoint::new(1, PlanarJointKind::Weld, ends).unwrap();
        let p = [1.1, -0.7, 0.3].map(|p| p / second);
        let mut state = State::new(stands.to_vec(), Covector(p.to_vec()));
        let few = || Dense::<3>(Redundancy::Refuse);
        let refused = Rattle::new(&system, weld.clone(), &state, few()).unwrap_err();
        assert!(matches!(refused, ConstraintError::InfeasibleVelocity { .. }), "{refused}");
        // What is left of the velocity of a body that cannot move is rounding.
        Projection::new(&system, &weld, &state, few()).unwrap().project(&mut state).unwrap();
        Rattle::new(&system, weld, &state, few()).unwrap();
    }
}
