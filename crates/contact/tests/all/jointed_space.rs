//! Joints and contacts of space, solved together: momentum and energy of free jointed bodies that collide, a
//! door that hits its frame, and where it ends: steps in which a joint turns too far, joints twice over,
//! joints that contradict each other.

use nalgebra::Vector3;
use stationary_calculus::Metric;
use stationary_constraints::Constraint;
use stationary_contact::{Collider, Detector, Kept, Shape, SpatialWorld, WorldReport};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Joint, JointEnd, JointKind, LieGroup, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;
type Joints = Vec<Joint<Poses>>;

/// Bodies with their joints.
pub(crate) struct Scene {
    world: SpatialWorld<Weight<Poses>>,
    metric: BodyMetric<Poses>,
    joints: Joints,
    state: State<Vec<f64>>,
}

fn at(x: f64, y: f64, z: f64) -> RigidMotion {
    RigidMotion { translation: V::new(x, y, z), rotation: Rotation::identity() }
}

impl Scene {
    fn new(bodies: Vec<Body>, motions: &[BodyMotion], detector: Detector, joints: Joints) -> Self {
        Scene::under(0.0, bodies, motions, detector, joints)
    }

    fn under(
        gravity: f64,
        bodies: Vec<Body>,
        motions: &[BodyMotion],
        detector: Detector,
        joints: Joints,
    ) -> Self {
        let point = |body: &Body| PointMass { mass: body.mass(), point: V::zeros() };
        let masses = bodies.iter().map(point).collect();
        let metric = BodyMetric::<Poses>::new(bodies);
        let state = metric.state(motions).unwrap();
        let weight = Weight { gravity: V::z() * -gravity, masses, space: Poses };
        let world = SpatialWorld::new(metric.clone().under(weight).unwrap(), detector).unwrap();
        Scene { world, metric, joints, state }
    }

    fn kinetic(&self) -> f64 {
        self.metric.kinetic_energy(self.state.p.view())
    }

    /// Momentum, and angular momentum about the origin.
    fn momenta(&self) -> [V; 2] {
        let mut sums = [V::zeros(); 2];
        for (q, p) in self.state.q.chunks(7).zip(self.state.p.0.chunks(6)) {
            let rotation = Rotation::from_quaternion([q[3], q[4], q[5], q[6]]).unwrap();
            let [x, linear, own] = [&q[..3], &p[..3], &p[3..]].map(V::from_column_slice);
            sums[0] += linear;
            sums[1] += x.cross(&linear) + rotation.rotate(&own);
        }
        sums
    }

    fn open(&self) -> f64 {
        let mut values = vec![0.0; self.joints.count()];
        self.joints.value(0.0, &self.state.q, &mut values).unwrap();
        values.iter().fold(0.0, |most, value| value.abs().max(most))
    }

    pub(crate) fn step(&mut self, h: f64) -> WorldReport {
        self.world.step_with(&mut self.state, h, &Kept(&self.joints)).unwrap()
    }
}

fn end(body: usize, x: f64) -> JointEnd {
    JointEnd::on(body, V::x() * x)
}

/// Boxes on ball joints that hang from the origin, at first along a line, so far above a floor.
pub(crate) fn hung_chain(links: usize, above: f64) -> Scene {
    hung_chain_of_size(1.0, links, above)
}

/// The same, where a metre is so long.
fn hung_chain_of_size(metre: f64, links: usize, above: f64) -> Scene {
    let sides = [0.2, 0.05, 0.05].map(|side| side * metre);
    let bodies = vec![Body::solid_box(metre.powi(3), sides).unwrap(); links];
    let motions: Vec<_> = (0..links)
        .map(|link| BodyMotion {
            pose: at((0.2 + 0.4 * link as f64) * metre, 0.0, 0.0),
            velocity: V::zeros(),
            angular_velocity: V::zeros(),
        })
        .collect();
    let shape = Shape::cuboid([0.15, 0.05, 0.05].map(|half| half * metre)).unwrap();
    let mut colliders: Vec<_> =
        (0..links).map(|body| Collider::on_body(body, shape.clone()).with_friction(0.5)).collect();
    let floor = Shape::cuboid([9.0, 9.0, 1.0].map(|half| half * metre)).unwrap();
    let below = at(0.0, 0.0, (-1.0 - above) * metre);
    colliders.push(Collider::fixed(below, floor).with_friction(0.5));
    let joints = (0..links)
        .map(|link| {
            let before = match link.checked_sub(1) {
                None => JointEnd::world(V::zeros()),
                Some(before) => end(before, 0.2 * metre),
            };
            Joint::new(Poses, links, JointKind::Ball, [before, end(link, -0.2 * metre)]).unwrap()
        })
        .collect();
    let detector = Detector::new(colliders, links).unwrap();
    Scene::under(9.81 * metre, bodies, &motions, detector, joints)
}

/// Corners on one plane share their forces in many ways, and joints between the boxes tie them together: pivots and
/// Newton's method find some of them in every step, of the landing, of the sliding after it and at rest.
#[test]
fn a_chain_that_lands_on_a_floor_is_settled_in_every_step() {
    let mut scene = hung_chain(5, 0.5);
    let (mut touched, mut most) = (0, 0);
    for step in 0..400 {
        let report = scene.step(2e-3);
        assert!(report.settled, "{step}: {report:?}");
        touched += usize::from(report.contacts > 0);
        most = most.max(report.solved);
    }
    assert!(touched > 200 && scene.open() < 1e-13, "{touched} {}", scene.open());
    assert!(most < 200, "{most}");
}

#[test]
fn a_chain_of_any_size_lands_as_that_of_metres_with_its_joints_closed() {
    let mut metres = hung_chain(3, 0.5);
    let sizes = [1e-12, 1e-9, 1e-6, 1e3, 1e6];
    let mut scaled = sizes.map(|metre| (metre, hung_chain_of_size(metre, 3, 0.5)));
    let mut touched = 0;
    for step in 0..250 {
        touched += metres.step(2e-3).contacts;
        for (metre, scene) in &mut scaled {
            let report = scene.step(2e-3);
            assert!(report.settled, "{step} at {metre:e}: {report:?}");
            assert!(scene.open() < 1e-13 * *metre, "{step} at {metre:e}: {:e}", scene.open());
            for (q, expected) in scene.state.q.chunks(7).zip(metres.state.q.chunks(7)) {
                let place = |k: usize| (q[k] / *metre - expected[k]).abs();
                let off = (0..3).map(place).fold(0.0, f64::max);
                assert!(off < 1e-6, "{step} at {metre:e}: off by {off:e}");
            }
        }
    }
    assert!(touched > 100, "{touched}");
}

/// Three boxes on a ball joint and a hinge fly, turn, and are hit by a ball.
fn struck_chain(restitution: f64, friction: f64) -> Scene {
    let half = [0.5, 0.1, 0.12];
    let mut bodies: Vec<_> =
        [2.0, 1.0, 3.0].map(|mass| Body::solid_box(mass, half).unwrap()).into();
    bodies.push(Body::new(1.5, [0.4 * 1.5 * 0.04; 3]).unwrap());
    let turn = V::new(0.3, -0.2, 0.5);
    let flies = V::new(0.1, 0.2, -0.1);
    // Turning as one, about the middle of the chain.
    let box_at = |k: f64| {
        let x = V::x() * (k - 1.0) * 1.2;
        BodyMotion {
            pose: RigidMotion { translation: x, rotation: Rotation::identity() },
            velocity: flies + turn.cross(&x),
            angular_velocity: turn,
        }
    };
    let mut motions = [0.0, 1.0, 2.0].map(box_at).to_vec();
    motions.push(BodyMotion {
        pose: at(0.25, 0.8, 0.05),
        velocity: V::new(0.4, -2.0, 0.3),
        angular_velocity: V::new(3.0, 1.0, -2.0),
    });
    let shape = Shape::cuboid(half).unwrap();
    let colliders = (0..3)
        .map(|k| Collider::on_body(k, shape.clone()))
        .chain([Collider::on_body(3, Shape::ball(0.2).unwrap())])
        .map(|c| c.with_restitution(restitution).with_friction(friction))
        .collect();
    let mut detector = Detector::new(colliders, 4).unwrap();
    for pair in [[0, 1], [0, 2], [1, 2]] {
        detector = detector.without_pair(pair).unwrap();
    }
    let joints = vec![
        Joint::new(Poses, 4, JointKind::Ball, [end(0, 0.6), end(1, -0.6)]).unwrap(),
        Joint::new(Poses, 4, JointKind::Hinge { axis: V::z() }, [end(1, 0.6), end(2, -0.6)])
            .unwrap(),
    ];
    Scene::new(bodies, &motions, detector, joints)
}

/// Momentum to rounding; angular momentum to the order of the step, as contacts act at a gap and joints are
/// closed by moving bodies. The report's balance holds but for what free turns change of the energy, which
/// is of third order in a step; beyond that energy never grows.
#[test]
fn free_jointed_bodies_that_collide_keep_momentum_and_angular_momentum_to_first_order() {
    for (restitution, friction) in [(0.0, 0.0), (0.5, 0.4), (1.0, 0.0), (1.0, 0.4)] {
        let (mut turned, mut balance) = (Vec::new(), Vec::new());
        for h in [8e-3, 4e-3, 2e-3, 1e-3] {
            let mut scene = struck_chain(restitution, friction);
            let [p, l] = scene.momenta();
            let (first, mut hit, mut open, mut off) = (scene.kinetic(), false, 0.0_f64, 0.0_f64);
            while scene.state.t < 1.0 - 0.5 * h {
                let before = scene.kinetic();
                let report = scene.step(h);
                assert!(report.settled, "{h}: {report:?}");
                let change = (scene.kinetic() - before) / first;
                assert!(change <= 0.5 * h * h * h, "{h}: {change} {report:?}");
                let took = report.impact_energy + report.friction_energy + report.joint_energy;
                off = off.max((change + took / first).abs());
                hit |= scene.world.touches().any(|touch| touch.normal + touch.impact > 0.1);
                open = open.max(scene.open());
            }
            assert!(hit && open < 1e-13, "{open}");
            let [p_end, l_end] = scene.momenta();
            assert!((p_end - p).norm() < 1e-12 * p.norm(), "{h}: {p} {p_end}");
            turned.push((h, (l_end - l).norm() / l.norm()));
            balance.push((h, off));
        }
        println!("{restitution} {friction}: {turned:?} {balance:?}");
        let slopes = [&turned, &balance].map(|points| loglog_slope(points).unwrap());
        assert!(turned[3].1 < 2e-3, "{turned:?}");
        assert!((slopes[0] - 1.0).abs() < 0.2, "{slopes:?} {turned:?}");
        assert!((slopes[1] - 3.0).abs() < 0.3, "{slopes:?} {balance:?}");
    }
}

/// A door about the axis z through the origin, 1 m wide, and a post that it reaches after a quarter turn or so.
fn door(restitution: f64, friction: f64, hinges: &[f64]) -> Scene {
    let half = [0.5, 0.025, 1.0];
    let bodies = vec![Body::solid_box(8.0, half).unwrap()];
    let spin = 2.0;
    let motion = BodyMotion {
        pose: at(0.5, 0.0, 0.0),
        velocity: V::y() * (0.5 * spin),
        angular_velocity: V::z() * spin,
    };
    let colliders = vec![
        Collider::on_body(0, Shape::cuboid(half).unwrap()),
        Collider::fixed(at(0.9, 0.6, 0.0), Shape::ball(0.1).unwrap()),
    ];
    let colliders =
        colliders.into_iter().map(|c| c.with_restitution(restitution).with_friction(friction));
    let detector = Detector::new(colliders.collect(), 1).unwrap();
    let hinge = |&z: &f64| {
        let ends = [JointEnd::world(V::z() * z), JointEnd::on(0, V::new(-0.5, 0.0, z))];
        Joint::new(Poses, 1, JointKind::Hinge { axis: V::z() }, ends).unwrap()
    };
    Scene::new(bodies, &[motion], detector, hinges.iter().map(hinge).collect())
}

#[test]
fn a_door_of_space_rebounds_by_the_restitution_on_one_hinge_as_on_two() {
    for restitution in [0.0, 0.5, 1.0] {
        for hinges in [&[0.0][..], &[-0.8, 0.8]] {
            let mut scene = door(restitution, 0.0, hinges);
            let first = scene.kinetic();
            for _ in 0..500 {
                let before = scene.kinetic();
                let report = scene.step(1e-3);
                assert!(report.settled, "{report:?}");
                assert!(scene.kinetic() <= before + 1e-12 * first);
                assert!(scene.open() < 1e-10, "{}", scene.open());
            }
            let moment = 8.0 * (0.25 + 0.025 * 0.025) / 3.0;
            let left = scene.state.p.0[5] / moment;
            assert!((left + restitution * 2.0).abs() < 4e-3, "{restitution} {hinges:?}: {left}");
        }
    }
}

/// A joint's impulses act where its bodies were when the step started: what turns by `h w` in it loses
/// `(h w)^2` of its energy each step, so a part of `T h w^2` over a time, and all but everything where it turns
/// by a radian. The hinge stays closed, and the report says what joints took.
#[test]
fn a_door_loses_energy_in_proportion_to_the_step_and_most_of_it_where_it_turns_by_a_radian() {
    let run = |h: f64, steps: usize| {
        let mut scene = door(0.0, 0.0, &[0.0]);
        // Out of the reach of the post.
        scene.state.p.0.iter_mut().for_each(|p| *p = -*p);
        let (first, mut taken) = (scene.kinetic(), 0.0);
        for _ in 0..steps {
            let report = scene.step(h);
            assert!(report.settled && report.joint_violation < 1e-12, "{h}: {report:?}");
            assert!(report.joint_energy > -1e-12 * first, "{h}: {report:?}");
            taken += report.joint_energy;
        }
        let lost = first - scene.kinetic();
        assert!((lost - taken).abs() < 1e-9 * first && scene.open() < 1e-12, "{h}: {lost} {taken}");
        lost / first
    };
    let lost = [(4e-3, 100), (2e-3, 200), (1e-3, 400)].map(|(h, steps)| (h, run(h, steps)));
    let slope = loglog_slope(&lost).unwrap();
    assert!((slope - 1.0).abs() < 0.1, "{slope} {lost:?}");
    let [far] = [run(0.5, 8)];
    println!("{lost:?} {far}");
    assert!(far > 0.5, "{far}");
}

/// Two joints that hold a body at points that it does not have: the step is not settled.
#[test]
fn joints_that_contradict_each_other_stay_open_and_the_step_is_not_settled() {
    let mut scene = door(0.0, 0.0, &[0.0]);
    let ends = [JointEnd::world(V::x() * 1.3), JointEnd::on(0, V::x() * 0.5)];
    scene.joints.push(Joint::new(Poses, 1, JointKind::Ball, ends).unwrap());
    let report = scene.step(1e-3);
    assert!(!report.settled && report.joint_violation > 0.1, "{report:?}");
    assert!((report.joint_violation - scene.open()).abs() < 1e-6, "{report:?} {}", scene.open());
}
