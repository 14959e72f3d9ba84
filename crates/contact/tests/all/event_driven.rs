//! Impacts at their instant: orders, energy, the end of bounces, and where it stops.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Metric, Potential, Sink, System};
use stationary_contact::{
    Collider, ContactError, Detector, EventDriven, EventKind, FlightOrder, Planar, PlanarCollider,
    PlanarDetector, PlanarShape, PlanarWorld, Shape, Spatial, SpatialWorld,
};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Free, LieGroup, PlanarMotion, PlanarRotation, PlanarWeight,
    PointMass, Poses, RigidMotion, Rotation, Weight,
};

const G: f64 = 9.81;
const RADIUS: f64 = 0.5;

/// Springs of 1 N/m that pull discs of 1 kg to the height zero.
struct Trap {
    discs: usize,
}

impl Potential for Trap {
    fn dim(&self) -> usize {
        3 * self.discs
    }

    fn energy(&self, q: &[f64]) -> f64 {
        q.chunks_exact(3).map(|q| 0.5 * q[1] * q[1]).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        q.chunks_exact(3).zip(dv.0.chunks_exact_mut(3)).for_each(|(q, dv)| dv[1] += q[1]);
    }

    fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
}

fn discs<P: Potential>(
    potential: P,
    count: usize,
    floor: f64,
    restitution: f64,
    order: FlightOrder,
    contact_step: f64,
) -> EventDriven<Planar, P> {
    let metric = DiagonalMetric::new([1.0, 1.0, 0.125].repeat(count)).unwrap();
    let disc = PlanarShape::disc(RADIUS).unwrap();
    let on = |body| PlanarCollider::on_body(body, disc.clone()).with_restitution(restitution);
    let mut colliders: Vec<_> = (0..count).map(on).collect();
    let place = PlanarMotion {
        translation: Vector2::new(0.0, floor),
        rotation: PlanarRotation::identity(),
    };
    colliders.push(PlanarCollider::fixed(place, PlanarShape::half_plane(Vector2::y()).unwrap()));
    let detector = PlanarDetector::new(colliders, count).unwrap();
    let system = System::new(metric, potential).unwrap();
    EventDriven::new(system, detector, order, contact_step).unwrap()
}

fn weight(count: usize) -> PlanarWeight {
    PlanarWeight { gravity: -Vector2::y() * G, masses: vec![1.0; count] }
}

/// The largest error along the way of a disc that a spring pulls to a floor at its height of rest:
/// y = |cos t|.
fn error_in_the_trap(order: FlightOrder, h: f64) -> f64 {
    let mut bodies = discs(Trap { discs: 1 }, 1, -RADIUS, 1.0, order, 1e-4);
    let mut state = State::new(vec![0.0, 1.0, 0.0], Covector(vec![0.0; 3]));
    let mut worst = 0.0_f64;
    let mut impacts = 0;
    for _ in 0..(6.0 / h).round() as usize {
        let report = bodies.step(&mut state, h).unwrap();
        impacts += report.impacts;
        assert_eq!(report.contact_steps, 0);
        for part in [0.25, 0.5, 0.75, 1.0] {
            let t = state.t - (1.0 - part) * h;
            let seen = bodies.state_at(t).unwrap();
            worst = worst.max((seen.q[1] - t.cos().abs()).abs());
        }
    }
    assert_eq!(impacts, 2);
    worst
}

#[test]
fn flights_between_impacts_are_of_order_two_and_four_all_along_the_way() {
    for (order, steps) in [
        (FlightOrder::Second, [0.2, 0.1, 0.05, 0.025]),
        (FlightOrder::Fourth, [0.5, 0.3, 0.2, 0.1]),
    ] {
        let errors = steps.map(|h| (h, error_in_the_trap(order, h)));
        let slope = loglog_slope(&errors).unwrap();
        let claimed = f64::from(order.order());
        assert!((slope - claimed).abs() < 0.3, "{order:?}: {slope} {errors:?}");
    }
}

/// Where a ball dropped from height 1 onto the ground is at a time, with restitution c.
fn bouncing(c: f64, t: f64) -> f64 {
    let fall = (2.0 / G).sqrt();
    if t <= fall {
        return 1.0 - 0.5 * G * t * t;
    }
    let (mut start, mut speed) = (fall, c * G * fall);
    for _ in 0..10_000 {
        let flight = 2.0 * speed / G;
        if t <= start + flight {
            let s = t - start;
            return speed * s - 0.5 * G * s * s;
        }
        start += flight;
        speed *= c;
    }
    0.0
}

#[test]
fn bounces_that_grow_shorter_follow_the_closed_form_and_end() {
    for c in [0.3, 0.5, 0.8] {
        for contact_step in [1e-2, 1e-3, 1e-4] {
            let mut bodies = discs(weight(1), 1, 0.0, c, FlightOrder::Second, contact_step);
            let mut state = State::new(vec![0.0, 1.0 + RADIUS, 0.0], Covector(vec![0.0; 3]));
            let (mut worst, mut starts) = (0.0_f64, Vec::new());
            for _ in 0..60 {
                bodies.step(&mut state, 0.1).unwrap();
                worst = worst.max((state.q[1] - RADIUS - bouncing(c, state.t)).abs());
                let starting =
                    bodies.events().iter().filter(|e| e.kind == EventKind::ContactStarts);
                starts.extend(starting.map(|event| event.time));
            }
            let bound = 8.0 * G * contact_step * contact_step + 1e-9;
            assert!(worst < bound, "{c} {contact_step}: {worst}");
            // It comes to rest within a few contact steps of the end of the series, and stays.
            let end = (2.0 / G).sqrt() * (1.0 + c) / (1.0 - c);
            for start in &starts {
                let off = (end - start).abs();
                assert!(off < 8.0 * contact_step / (1.0 - c), "{c} {contact_step}: {starts:?}");
            }
            assert!((1..4).contains(&starts.len()), "{c} {contact_step}: {starts:?}");
            assert!(state.p.0[1].abs() < 1e-12);
        }
    }
}

type Falling = System<BodyMetric<Poses>, Weight<Poses>, Poses>;

/// A box that tumbles: its colliders, its system, and where it starts.
fn tumbling() -> (impl Fn() -> Detector, impl Fn() -> Falling, State<Vec<f64>>) {
    let half = [0.3, 0.2, 0.1];
    let body = Body::solid_box(1.0, half).unwrap();
    let motion = BodyMotion {
        pose: RigidMotion {
            translation: Vector3::new(0.0, 0.0, 1.0),
            rotation: Rotation::exp(Vector3::new(0.3, -0.2, 0.5)),
        },
        velocity: Vector3::new(0.3, 0.1, 0.0),
        angular_velocity: Vector3::new(2.0, 5.0, -1.0),
    };
    let state = BodyMetric::<Poses>::new(vec![body]).state(&[motion]).unwrap();
    let detector = move || {
        let cuboid = Shape::cuboid(half).unwrap();
        let floor = Shape::half_space(Vector3::z()).unwrap();
        let colliders = vec![
            Collider::on_body(0, cuboid).with_restitution(1.0),
            Collider::fixed(RigidMotion::identity(), floor),
        ];
        Detector::new(colliders, 1).unwrap()
    };
    let system = move || {
        let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }];
        let weight = Weight { gravity: -Vector3::z() * G, masses, space: Poses };
        BodyMetric::new(vec![body]).under(weight).unwrap()
    };
    (detector, system, state)
}

#[test]
fn an_elastic_tumbling_box_keeps_its_energy_which_a_fixed_step_does_not() {
    let (detector, system, start) = tumbling();
    let energy = |state: &State<Vec<f64>>| system().energy(&state.q, state.p.view());
    let first = energy(&start);
    let mut bodies =
        EventDriven::<Spatial, _>::new(system(), detector(), FlightOrder::Second, 1e-4).unwrap();
    let (mut state, mut worst, mut impacts) = (start.clone(), 0.0_f64, 0);
    for _ in 0..500 {
        let report = bodies.step(&mut state, 1e-2).unwrap();
        impacts += report.impacts;
        assert_eq!(report.contact_steps, 0, "{}", state.t);
        worst = worst.max((energy(&state) / first - 1.0).abs());
    }
    assert!(impacts >= 5, "{impacts}");
    assert!(worst < 1e-9, "{worst}");
    let mut world = SpatialWorld::new(system(), detector()).unwrap();
    let mut state = start.clone();
    for _ in 0..500 {
        world.step(&mut state, 1e-2).unwrap();
    }
    let lost = 1.0 - energy(&state) / first;
    assert!(lost.abs() > 0.05, "{lost}");
}

#[test]
fn an_elastic_box_that_tumbles_in_a_box_keeps_its_energy() {
    let half = [0.3, 0.2, 0.1];
    let body = Body::solid_box(1.0, half).unwrap();
    let motion = BodyMotion {
        pose: RigidMotion { translation: Vector3::zeros(), rotation: Rotation::identity() },
        velocity: Vector3::new(1.0, 0.7, -0.4),
        angular_velocity: Vector3::new(1.0, -3.0, 2.0),
    };
    let mut state = BodyMetric::<Poses>::new(vec![body]).state(&[motion]).unwrap();
    let mut colliders =
        vec![Collider::on_body(0, Shape::cuboid(half).unwrap()).with_restitution(1.0)];
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut inwards = Vector3::zeros();
            inwards[axis] = -sign;
            let place = RigidMotion { translation: inwards * -0.7, rotation: Rotation::identity() };
            colliders.push(Collider::fixed(place, Shape::half_space(inwards).unwrap()));
        }
    }
    let detector = Detector::new(colliders, 1).unwrap();
    let system = BodyMetric::new(vec![body]).under(Free { freedoms: 6 }).unwrap();
    let energy = |system: &System<_, Free, Poses>, state: &State<Vec<f64>>| {
        system.energy(&state.q, state.p.view())
    };
    let first = energy(&system, &state);
    let mut bodies =
        EventDriven::<Spatial, _>::new(system, detector, FlightOrder::Fourth, 1e-4).unwrap();
    let mut impacts = 0;
    for _ in 0..50 {
        impacts += bodies.step(&mut state, 0.1).unwrap().impacts;
        let gained = energy(bodies.system(), &state) / first - 1.0;
        assert!(gained.abs() < 1e-9, "{gained} at {}", state.t);
    }
    assert!(impacts >= 10, "{impacts}");
}

#[test]
fn too_many_events_and_steps_that_are_none_are_errors_and_leave_the_state() {
    // Bounces of 1e-5 s are no rest at a contact step of 2e-7 s: 15,000 of them.
    let mut bodies = discs(weight(1), 1, 0.0, 1.0, FlightOrder::Second, 2e-7);
    let mut state = State::new(vec![0.0, RADIUS + 1e-10, 0.0], Covector(vec![0.0, 5e-5, 0.0]));
    let before = state.clone();
    let refused = bodies.step(&mut state, 0.15);
    assert!(matches!(refused, Err(ContactError::TooManyImpacts { .. })), "{refused:?}");
    assert_eq!((&state, bodies.events().len()), (&before, 0));
    assert!(bodies.state_at(0.0).is_err());
    for h in [0.0, -1.0, f64::NAN, 1.0] {
        let refused = bodies.step(&mut state, h);
        assert!(matches!(refused, Err(ContactError::Step(_))), "{refused:?}");
        assert_eq!(state, before);
    }
}

/// Two boxes that hit each other off their centres far from anything, with friction and restitution.
pub(crate) fn two_boxes() -> (Detector, BodyMetric<Poses>, State<Vec<f64>>) {
    let halves = [[0.3, 0.2, 0.1], [0.15, 0.25, 0.2]];
    let bodies =
        [1.0, 3.0].into_iter().zip(halves).map(|(m, half)| Body::solid_box(m, half).unwrap());
    let metric = BodyMetric::<Poses>::new(bodies.collect());
    let motion = |x: f64, v: f64, turn: [f64; 3], spin: [f64; 3]| BodyMotion {
        pose: RigidMotion {
            translation: Vector3::new(x, 0.05 * x, -0.04 * x),
            rotation: Rotation::exp(turn.into()),
        },
        velocity: Vector3::new(v, 0.1, 0.0),
        angular_velocity: spin.into(),
    };
    let motions = [
        motion(-1.0, 2.0, [0.3, -0.2, 0.5], [1.0, 2.0, -1.0]),
        motion(1.0, -1.0, [0.1, 0.7, 0.2], [-2.0, 0.5, 1.0]),
    ];
    let collider = |body: usize| {
        let cuboid = Shape::cuboid(halves[body]).unwrap();
        Collider::on_body(body, cuboid).with_restitution(0.8).with_friction(0.4)
    };
    let state = metric.state(&motions).unwrap();
    (Detector::new(vec![collider(0), collider(1)], 2).unwrap(), metric, state)
}

/// The linear and the angular momentum of bodies in space.
pub(crate) fn momenta(state: &State<Vec<f64>>) -> [Vector3<f64>; 2] {
    let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
    for (q, p) in state.q.chunks_exact(7).zip(state.p.0.chunks_exact(6)) {
        let (x, p, m) = (
            Vector3::from_column_slice(&q[..3]),
            Vector3::from_column_slice(&p[..3]),
            Vector3::from_column_slice(&p[3..]),
        );
        let turned = Rotation::from_quaternion([q[3], q[4], q[5], q[6]]).unwrap();
        linear += p;
        angular += x.cross(&p) + turned.rotate(&m);
    }
    [linear, angular]
}

/// Two boxes that turn hit each other off their centres: at the instant, however long a contact step would be.
#[test]
fn impacts_of_solids_that_turn_keep_both_momenta_and_gain_no_energy() {
    let orders = [FlightOrder::Second, FlightOrder::Fourth];
    for (order, contact_step) in
        orders.into_iter().flat_map(|order| [(order, 1e-2), (order, 1e-3), (order, 1e-5)])
    {
        let (detector, metric, mut state) = two_boxes();
        let system = metric.under(Free { freedoms: 12 }).unwrap();
        let kinetic = |state: &State<Vec<f64>>| system.metric().kinetic_energy(state.p.view());
        let (first, before) = (momenta(&state), kinetic(&state));
        let bodies = system.clone();
        let mut bodies =
            EventDriven::<Spatial, _>::new(bodies, detector, order, contact_step).unwrap();
        let (mut impacts, mut contact_steps) = (0, 0);
        for _ in 0..150 {
            let report = bodies.step(&mut state, 1e-2).unwrap();
            impacts += report.impacts;
            contact_steps += report.contact_steps;
        }
        assert!(impacts > 0);
        assert_eq!(contact_steps, 0, "{order:?} {contact_step}");
        let off = [0, 1].map(|k| (momenta(&state)[k] - first[k]).norm());
        // Boxes are clipped 4e-9 wider than they are: so far beside the gap a contact's points may lie.
        assert!(off[0] < 1e-12 && off[1] < 1e-9, "{contact_step}: {off:?}");
        assert!(kinetic(&state) < before * (1.0 - 1e-3), "{} {before}", kinetic(&state));
    }
}

/// Speeds in rad/s and of what is elsewhere are nothing beside which an approach is slow.
#[test]
fn a_spin_does_not_hide_how_fast_a_small_disc_comes() {
    let (r, speed) = (1e-6, 5e-7);
    let detector = || {
        let disc = PlanarShape::disc(r).unwrap();
        let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
        let colliders = vec![
            PlanarCollider::on_body(0, disc.clone()).with_restitution(1.0),
            PlanarCollider::on_body(1, disc),
            PlanarCollider::fixed(PlanarMotion::identity(), ground),
        ];
        PlanarDetector::new(colliders, 2).unwrap()
    };
    let moment = 0.5 * r * r;
    let system = || {
        let metric = DiagonalMetric::new([1.0, 1.0, moment].repeat(2)).unwrap();
        let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0; 2] };
        System::new(metric, weight).unwrap()
    };
    let start = || {
        let p = vec![0.0, -speed, 1e3 * moment, 0.0, 1e3, 0.0];
        State::new(vec![0.0, 1.5 * r, 0.0, 1.0, 1.0, 0.0], Covector(p))
    };
    let mut state = start();
    let restitution = detector().with_pair([0, 2], 1.0, 0.0).unwrap();
    let mut events = EventDriven::new(system(), restitution, FlightOrder::Second, 1e-3).unwrap();
    events.step(&mut state, 2.0).unwrap();
    assert!((state.p.0[1] - speed).abs() < 1e-9 * speed, "at its instant: {:?}", state.p.0);
    let mut state = start();
    let restitution = detector().with_pair([0, 2], 1.0, 0.0).unwrap();
    let mut world = PlanarWorld::new(system(), restitution).unwrap();
    for _ in 0..100 {
        world.step(&mut state, 0.02).unwrap();
    }
    assert!((state.p.0[1] - speed).abs() < 1e-9 * speed, "in steps: {:?}", state.p.0);
}

/// A bar that turns and moves as it is told hits a disc at rest: what the disc gains is the bar's work, and an
/// elastic impact takes nothing.
#[test]
fn an_obstacle_that_turns_gives_what_its_work_says() {
    let bar = PlanarShape::cuboid([1.0, 0.1]).unwrap();
    let disc = PlanarShape::disc(0.2).unwrap();
    let shapes = [bar, disc].into_iter().enumerate();
    let colliders = shapes.map(|(body, shape)| PlanarCollider::on_body(body, shape));
    let elastic = colliders.map(|collider| collider.with_restitution(1.0)).collect();
    let metric = DiagonalMetric::new(vec![3.0, 3.0, 2.0, 1.0, 1.0, 0.02]).unwrap();
    let system = System::new(metric, Free { freedoms: 6 }).unwrap();
    let detector = PlanarDetector::new(elastic, 2).unwrap();
    let bodies: EventDriven<Planar, _> =
        EventDriven::new(system, detector, FlightOrder::Fourth, 1e-3).unwrap();
    let mut bodies = bodies.with_obstacles(vec![0]).unwrap();
    let p = vec![0.3, 0.0, 4.0, 0.0, 0.0, 0.0];
    let mut state = State::new(vec![0.0, 0.0, 0.0, 0.8, 0.5, 0.0], Covector(p));
    let report = bodies.step(&mut state, 0.3).unwrap();
    let gained = 0.5 * (state.p.0[3] * state.p.0[3] + state.p.0[4] * state.p.0[4]);
    assert!(report.impacts == 1 && gained > 1.0, "{report:?}");
    assert!((report.work - gained).abs() < 1e-12 * gained, "{gained} {report:?}");
    assert!(report.impact_energy.abs() < 1e-12 * gained, "{report:?}");
}
