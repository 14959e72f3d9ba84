//! Linkages of bodies in motion: a pendulum of two boxes and a four-bar, in the plane and in space,
//! against their reduced equations.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, System};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, BodySpace, ConstantVelocity, FourBar, FreeBodies, Joint,
    JointEnd, JointKind, LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarMass,
    PlanarWeight, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const GRAVITY: f64 = 9.81;

/// From one angle to another the short way, radians.
fn apart(to: f64, from: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}

/// Angles of a double pendulum of boxes after one second, from Lagrange's equations.
fn double_pendulum(arms: [f64; 2], moments: [f64; 2], start: [f64; 2]) -> [f64; 2] {
    let ([l, k], [first, second]) = (arms, moments);
    let rates = |[a, b, da, db]: [f64; 4]| {
        let (s, c) = (a - b).sin_cos();
        let coupling = 2.0 * l * k;
        // Unit masses; the first arm is twice as long as its centre is away.
        let (m11, m12, m22) = (first + l * l + 4.0 * l * l, coupling * c, second + k * k);
        let fa = -coupling * s * db * db - 3.0 * l * GRAVITY * a.sin();
        let fb = coupling * s * da * da - k * GRAVITY * b.sin();
        let determinant = m11 * m22 - m12 * m12;
        [da, db, (m22 * fa - m12 * fb) / determinant, (m11 * fb - m12 * fa) / determinant]
    };
    let (h, mut y) = (1e-4, [start[0], start[1], 0.0, 0.0]);
    for _ in 0..10_000 {
        let along = |k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| y[i] + h * k[i]);
        let a = rates(y);
        let b = rates(along(a, 0.5 * h));
        let c = rates(along(b, 0.5 * h));
        let d = rates(along(c, h));
        y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    [y[0], y[1]]
}

#[test]
fn a_pendulum_of_two_boxes_swings_as_lagranges_equations_say_in_space_and_in_the_plane() {
    let (halves, start) = ([[0.1, 0.05, 0.3], [0.05, 0.1, 0.2]], [1.2_f64, -0.4]);
    let bodies = halves.map(|half| Body::solid_box(1.0, half).unwrap());
    let arms = [halves[0][2], halves[1][2]];
    let exact = double_pendulum(arms, bodies.map(|b| b.moments().y), start);
    // Down the plane x, z: an angle about -y leads from hanging to the side of +x.
    let down = |angle: f64| Vector3::new(angle.sin(), 0.0, -angle.cos());
    let knee = down(start[0]) * (2.0 * arms[0]);
    let centres = [down(start[0]) * arms[0], knee + down(start[1]) * arms[1]];
    let motion = |k: usize| BodyMotion {
        pose: RigidMotion {
            translation: centres[k],
            rotation: Rotation::exp(Vector3::y() * -start[k]),
        },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let metric = BodyMetric::<Poses>::new(bodies.to_vec());
    let initial = metric.state(&[motion(0), motion(1)]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; 2];
    let gravity = Vector3::z() * -GRAVITY;
    let system = metric.under(Weight { gravity, masses, space: Poses }).unwrap();
    let up = |k: usize| JointEnd::on(k, Vector3::z() * arms[k]);
    let foot = JointEnd::on(0, Vector3::z() * -arms[0]);
    let hinge = |ends| Joint::new(Poses, 2, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let joints = vec![hinge([JointEnd::world(Vector3::zeros()), up(0)]), hinge([foot, up(1)])];
    let in_space = |steps: u32| {
        let motion = FreeBodies(ConstantVelocity);
        let mut rattle =
            Rattle::along(motion, &system, &joints, &initial, SparseDiagonal::default()).unwrap();
        let mut state = initial.clone();
        (0..steps).for_each(|_| _ = rattle.step(&mut state, 1.0 / f64::from(steps)).unwrap());
        let angle = |k| {
            let axis = Poses::pose_at(&state.q, k).rotation.rotate(&Vector3::z());
            (-axis.x).atan2(axis.z)
        };
        apart(angle(0), exact[0]).hypot(apart(angle(1), exact[1]))
    };
    // The same in the plane, where the vertical is y and a body's arm lies along its own y.
    let polar =
        bodies.map(|b| PlanarMass { mass: 1.0, centre: Vector2::zeros(), inertia: b.moments().y });
    let masses = polar.iter().flat_map(|p| [p.mass, p.mass, p.inertia]).collect::<Vec<_>>();
    let metric = stationary_calculus::DiagonalMetric::new(masses).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -GRAVITY, masses: vec![1.0; 2] };
    let flat = System::new(metric, weight).unwrap();
    let q = (0..2).flat_map(|k| [centres[k].x, centres[k].z, start[k]]).collect::<Vec<_>>();
    let start = State::new(q, Covector(vec![0.0; 6]));
    let body = |k: usize, side: f64| PlanarEnd::on(k, Vector2::y() * (side * arms[k]));
    let pins = vec![
        PlanarJoint::new(
            2,
            PlanarJointKind::Pin,
            [PlanarEnd::world(Vector2::zeros()), body(0, 1.0)],
        )
        .unwrap(),
        PlanarJoint::new(2, PlanarJointKind::Pin, [body(0, -1.0), body(1, 1.0)]).unwrap(),
    ];
    let in_the_plane = |steps: u32| {
        let mut rattle = Rattle::new(&flat, &pins, &start, SparseDiagonal::default()).unwrap();
        let mut state = start.clone();
        (0..steps).for_each(|_| _ = rattle.step(&mut state, 1.0 / f64::from(steps)).unwrap());
        apart(state.q[2], exact[0]).hypot(apart(state.q[5], exact[1]))
    };
    for error in [&in_space as &dyn Fn(u32) -> f64, &in_the_plane] {
        let points: Vec<_> = [500, 1_000, 2_000].map(|n| (1.0 / f64::from(n), error(n))).to_vec();
        let order = loglog_slope(&points).unwrap();
        assert!((order - 2.0).abs() < 0.05, "{order}: {points:?}");
    }
}

const LINKAGE: FourBar =
    FourBar { lengths: [0.2, 0.5, 0.4, 0.5], density: 2.0, gravity: Vector2::new(0.0, -GRAVITY) };
/// The rate of its crank at the start, where it points along the ground.
const RATE: f64 = 12.0;

#[test]
fn the_slope_of_a_four_bar_s_configuration_is_its_derivative_and_keeps_it_closed() {
    let joints = LINKAGE.joints().unwrap();
    for k in 0..12 {
        let (u, e) = (0.5 * f64::from(k), 1e-6);
        let (ahead, behind) = (LINKAGE.configuration(u + e), LINKAGE.configuration(u - e));
        let slope = LINKAGE.slope(u);
        assert!((0..9).all(|i| ((ahead[i] - behind[i]) / (2.0 * e) - slope[i]).abs() < 1e-8));
        let mut g = [1.0; 8];
        joints.value(0.0, &LINKAGE.configuration(u), &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-15), "{g:?}");
    }
}

/// The time at which the crank's angle has grown by a whole turn, between two steps by its rate.
fn revolution<C: ConstrainedIntegrator<Vec<f64>>>(
    method: &mut C,
    initial: &State<Vec<f64>>,
    h: f64,
    angle_and_rate: impl Fn(&State<Vec<f64>>) -> [f64; 2],
) -> f64 {
    let mut state = initial.clone();
    let (mut turned, mut before) = (0.0, angle_and_rate(&state)[0]);
    loop {
        method.step(&mut state, h).unwrap();
        let [angle, rate] = angle_and_rate(&state);
        turned += apart(angle, before);
        before = angle;
        let left = TAU - turned;
        if left.abs() < 1.5 * h * rate {
            // The crank's acceleration over a fraction of a step is of order h^2.
            let acceleration = {
                let mut next = state.clone();
                method.step(&mut next, h).unwrap();
                (angle_and_rate(&next)[1] - rate) / h
            };
            let guess = left / rate;
            return state.t + guess - 0.5 * acceleration * guess * guess / rate;
        }
        assert!(state.t < 10.0, "the crank does not get round");
    }
}

#[test]
fn a_four_bar_linkage_of_bodies_takes_the_time_of_a_revolution_that_energy_gives() {
    let expected = LINKAGE.revolution(0.0, RATE);
    let (q, slope) = (LINKAGE.configuration(0.0), LINKAGE.slope(0.0));
    let (masses, moments) = (LINKAGE.masses(), LINKAGE.moments());
    // In the plane: three freedoms a bar, four pins.
    let system = System::new(LINKAGE.metric().unwrap(), LINKAGE.weight()).unwrap();
    let inertia = |k: usize| if k % 3 == 2 { moments[k / 3] } else { masses[k / 3] };
    let p = (0..9).map(|k| inertia(k) * slope[k] * RATE).collect::<Vec<_>>();
    let flat = State::new(q.to_vec(), Covector(p));
    let pins = LINKAGE.joints().unwrap();
    let in_the_plane = |h: f64| {
        let mut rattle = Rattle::new(&system, &pins, &flat, SparseDiagonal::default()).unwrap();
        revolution(&mut rattle, &flat, h, |s| [s.q[2], s.p.0[2] / moments[0]])
    };
    // In space: six freedoms a bar, four hinges, of whose twenty equations three are redundant.
    let bars = (0..3).map(|k| Body::new(masses[k], [0.01 * moments[k], moments[k], moments[k]]));
    let metric = BodyMetric::<Poses>::new(bars.collect::<Result<Vec<_>, _>>().unwrap());
    let motion = |k: usize| BodyMotion {
        pose: RigidMotion {
            translation: Vector3::new(q[3 * k], q[3 * k + 1], 0.0),
            rotation: Rotation::exp(Vector3::z() * q[3 * k + 2]),
        },
        velocity: Vector3::new(slope[3 * k], slope[3 * k + 1], 0.0) * RATE,
        angular_velocity: Vector3::z() * (slope[3 * k + 2] * RATE),
    };
    let initial = metric.state(&[motion(0), motion(1), motion(2)]).unwrap();
    let loads = masses.map(|mass| PointMass { mass, point: Vector3::zeros() }).to_vec();
    let gravity = Vector3::y() * -GRAVITY;
    let system = metric.under(Weight { gravity, masses: loads, space: Poses }).unwrap();
    let [a, b, c, d] = LINKAGE.lengths.map(|length| Vector3::x() * length);
    let body = |k: usize, point: Vector3<f64>| JointEnd::on(k, point / 2.0);
    let hinge = |ends| Joint::new(Poses, 3, JointKind::Hinge { axis: Vector3::z() }, ends).unwrap();
    let hinges = vec![
        hinge([JointEnd::world(Vector3::zeros()), body(0, -a)]),
        hinge([body(0, a), body(1, -b)]),
        hinge([body(1, b), body(2, c)]),
        hinge([body(2, -c), JointEnd::world(d)]),
    ];
    let in_space = |h: f64| {
        let choice = SparseDiagonal(Redundancy::LeastNorm);
        let motion = FreeBodies(ConstantVelocity);
        let mut rattle = Rattle::along(motion, &system, &hinges, &initial, choice).unwrap();
        revolution(&mut rattle, &initial, h, |s| {
            let along = Poses::pose_at(&s.q, 0).rotation.rotate(&Vector3::x());
            [along.y.atan2(along.x), s.p.0[5] / moments[0]]
        })
    };
    for time in [&in_the_plane as &dyn Fn(f64) -> f64, &in_space] {
        let error = |h: f64| (time(h) - expected).abs();
        let points: Vec<_> = [2e-3, 1e-3, 5e-4].map(|h| (h, error(h))).to_vec();
        let order = loglog_slope(&points).unwrap();
        assert!((order - 2.0).abs() < 0.2, "{order}: {points:?} of {expected}");
    }
    assert!((in_space(1e-3) - in_the_plane(1e-3)).abs() < 1e-6);
}

#[test]
fn the_bars_of_a_four_bar_weigh_their_length_times_the_density() {
    for (mass, expected) in LINKAGE.masses().into_iter().zip([0.4, 1.0, 0.8]) {
        assert!((mass - expected).abs() < 1e-15);
    }
    // A thin rod about its centre.
    for (moment, expected) in LINKAGE.moments().into_iter().zip([0.016, 0.25, 0.128]) {
        assert!((moment - expected / 12.0).abs() < 1e-16);
    }
}
