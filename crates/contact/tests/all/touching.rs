//! Rigid bodies that rest, slide, roll and bounce on each other.

use nalgebra::Vector3;
use stationary_contact::problems::{FRICTION, GRAVITY, columns_of_boxes, falling_boxes};
use stationary_contact::{
    BodiesIn, Collider, ContactError, Detector, Shape, Spatial, SpatialWorld, WorldReport,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Free, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const G: f64 = 10.0;

fn at(x: f64, y: f64, z: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::new(x, y, z), rotation: Rotation::identity() }
}

fn still(pose: RigidMotion) -> BodyMotion {
    BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() }
}

fn weighty(
    bodies: Vec<Body>,
    motions: &[BodyMotion],
) -> (BodiesIn<Spatial, Weight<Poses>>, State<Vec<f64>>) {
    let masses =
        bodies.iter().map(|b| PointMass { mass: b.mass(), point: Vector3::zeros() }).collect();
    let gravity = Weight { gravity: -Vector3::z() * G, masses, space: Poses };
    let metric = BodyMetric::new(bodies);
    let state = metric.state(motions).unwrap();
    (metric.under(gravity).unwrap(), state)
}

fn floor(normal: Vector3<f64>) -> Collider {
    Collider::fixed(at(0.0, 0.0, 0.0), Shape::half_space(normal).unwrap())
}

fn cube() -> Body {
    Body::solid_box(1.0, [0.5; 3]).unwrap()
}

fn ball(radius: f64) -> Body {
    Body::new(1.0, [0.4 * radius * radius; 3]).unwrap()
}

/// A stack of cubes on the floor, with friction.
fn stack(count: usize) -> (BodiesIn<Spatial, Weight<Poses>>, State<Vec<f64>>, Detector) {
    let motions: Vec<_> = (0..count).map(|k| still(at(0.0, 0.0, 0.5 + k as f64))).collect();
    let (system, state) = weighty(vec![cube(); count], &motions);
    let shape = Shape::cuboid([0.5; 3]).unwrap();
    let mut colliders: Vec<_> =
        (0..count).map(|body| Collider::on_body(body, shape.clone()).with_friction(0.5)).collect();
    colliders.push(floor(Vector3::z()));
    (system, state, Detector::new(colliders, count).unwrap())
}

#[test]
fn twenty_boxes_stand_for_ten_thousand_steps_and_drift_by_less_than_a_millionth_of_a_box() {
    let (system, mut state, detector) = stack(20);
    let start = state.clone();
    let mut bodies = SpatialWorld::new(system, detector).unwrap();
    let mut worst = WorldReport::default();
    for _ in 0..10_000 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
        worst.overlap = worst.overlap.max(report.overlap);
    }
    let drift = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let speed = state.p.0.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    println!("drift {drift:e}, speed {speed:e}, {worst:?}");
    assert!(drift < 1e-6 && speed < 1e-9, "{drift} {speed}");
    assert!(worst.residual < 1e-10 && worst.coulomb < 1e-10 && worst.overlap < 1e-9, "{worst:?}");
}

#[test]
fn columns_that_rest_are_only_looked_at() {
    let boxes = columns_of_boxes(4, 10).unwrap();
    let mut state = boxes.state.clone();
    let mut bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    bodies.step(&mut state, 1e-3).unwrap();
    let (mut visits, mut worst) = (0, 0.0_f64);
    for _ in 0..200 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        assert_eq!((report.islands, report.contacts), (4, 160));
        visits += report.relaxed;
        worst = worst.max(report.residual).max(report.coulomb);
    }
    println!("visits to 160 contacts in 200 steps: {visits}, residual {worst:e}");
    assert!(visits <= 160 && worst < 1e-10, "{visits} {worst}");
}

#[test]
fn columns_that_stand_do_not_move_at_all_and_a_push_moves_them() {
    let boxes = columns_of_boxes(4, 5).unwrap();
    let mut state = boxes.state.clone();
    let mut bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    bodies.step(&mut state, 1e-3).unwrap();
    for _ in 0..2_000 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        assert_eq!((report.projected, report.relaxed), (0, 0));
        assert!(report.residual < 1e-13 && report.coulomb < 1e-13, "{report:?}");
    }
    let off = state.q.iter().zip(&boxes.state.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let speed = state.p.0.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    println!("moved by {off:e}, speed {speed:e}");
    assert!(off < 1e-13 && speed < 1e-13, "{off} {speed}");
    let (top, speed, slows) = (4, 0.1, FRICTION * GRAVITY);
    state.p.0[6 * top] = speed;
    for _ in 0..100 {
        bodies.step(&mut state, 1e-3).unwrap();
    }
    let slid = state.q[7 * top] - boxes.state.q[7 * top];
    let expected = speed * speed / (2.0 * slows) - 0.5e-3 * speed;
    assert!((slid - expected).abs() < 1e-5, "{slid} {expected}");
    assert!(state.p.0.iter().all(|p| p.abs() < 1e-9));
}

#[test]
fn a_ball_rolls_down_the_gentlest_slope() {
    let angle = 1e-7_f64;
    let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
    let (system, mut state) = weighty(vec![ball(0.5)], &[still(at(0.0, 0.0, 0.5))]);
    let round = Collider::on_body(0, Shape::ball(0.5).unwrap()).with_friction(0.5);
    let detector = Detector::new(vec![round, floor(normal).with_friction(0.5)], 1).unwrap();
    let mut bodies = SpatialWorld::new(system, detector).unwrap();
    for _ in 0..1_000 {
        bodies.step(&mut state, 1e-3).unwrap();
    }
    let expected = 5.0 / 7.0 * G * angle.sin();
    assert!((state.p.0[0] / expected - 1.0).abs() < 1e-6, "{} {expected}", state.p.0[0]);
}

/// Housner 1963: a block that rocks keeps its angular momentum about the corner that it lands on,
/// and so 1 - 3/2 sin^2 of its slope of what turns it.
#[test]
fn a_block_that_rocks_loses_what_housner_says_at_each_landing() {
    let half = [0.25_f64, 0.5, 1.0];
    let tilt = Rotation::exp(Vector3::y() * 0.05);
    let corner = tilt.rotate(&Vector3::new(half[0], 0.0, -half[2]));
    let pose = RigidMotion { translation: Vector3::new(0.0, 0.0, -corner.z), rotation: tilt };
    let body = Body::solid_box(1.0, half).unwrap();
    let (system, mut state) = weighty(vec![body], &[still(pose)]);
    let block = Collider::on_body(0, Shape::cuboid(half).unwrap()).with_friction(1.0);
    let detector = Detector::new(vec![block, floor(Vector3::z())], 1).unwrap();
    let mut bodies = SpatialWorld::new(system, detector).unwrap();
    let mut turning = Vec::new();
    for _ in 0..20_000 {
        bodies.step(&mut state, 1e-4).unwrap();
        turning.push(state.p.0[4] / body.moments().y);
    }
    let slope = (half[0] / half[2]).atan();
    let expected = 1.0 - 1.5 * slope.sin().powi(2);
    // A landing takes the step in which the gap closes, and the next.
    let mut kept = Vec::new();
    let mut step = 0;
    while step + 3 < turning.len() {
        let (before, next, after) = (turning[step], turning[step + 1], turning[step + 3]);
        if before.abs() > 0.1 && (next - before).abs() > 0.01 * before.abs() {
            kept.push(after / before);
            step += 3;
        }
        step += 1;
    }
    println!("kept at each landing: {kept:?}, {expected}");
    assert!(kept.len() >= 3, "{kept:?}");
    assert!(kept.iter().all(|part| (part - expected).abs() < 0.01), "{kept:?} {expected}");
}

#[test]
fn a_heap_that_has_come_to_rest_is_only_looked_at() {
    let boxes = falling_boxes(27).unwrap();
    let mut state = boxes.state.clone();
    let bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    let mut bodies = bodies.with_tolerance(3e-4).unwrap();
    for _ in 0..2_500 {
        bodies.step(&mut state, 1e-3).unwrap();
    }
    let (mut visits, start) = (0, state.clone());
    for _ in 0..200 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        visits += report.relaxed;
        assert!(report.residual < 1e-5 && report.coulomb < 1e-5, "{report:?}");
    }
    let off = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("visits {visits}, moved by {off:e}");
    assert!(visits < 200 && off < 1e-6, "{visits} {off}");
}

#[test]
fn a_pile_in_motion_is_settled_as_far_as_asked_and_hardly_farther() {
    let boxes = falling_boxes(125).unwrap();
    let mut state = boxes.state.clone();
    let bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    let mut bodies = bodies.with_tolerance(3e-2).unwrap();
    let (mut relaxed, mut solved, mut contacts, mut left) = (0, 0, 0, 0.0_f64);
    for _ in 0..1_000 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        relaxed += report.relaxed;
        solved += report.solved;
        contacts += report.contacts;
        left = left.max(report.residual).max(report.coulomb);
    }
    let sweeps = relaxed as f64 / contacts as f64;
    println!("{sweeps} sweeps and {solved} systems in a thousand steps leave {left:e} m/s");
    assert!(left < 1e-2 && sweeps < 13.0 && solved < 100_000, "{left} {sweeps} {solved}");
}

/// A pile of more than a hundred contacts shares its work: what moves is settled to a quarter of a step's weight, or
/// to 3e-4 of the fastest box, no more.
#[test]
fn a_pile_in_motion_leaves_a_quarter_of_a_steps_weight_where_nothing_is_asked_for() {
    let boxes = falling_boxes(64).unwrap();
    let mut state = boxes.state.clone();
    let mut world = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    let gain = GRAVITY * 1e-3;
    let (mut of_piles, mut unsettled, mut deepest) = (0, 0, 0.0_f64);
    for step in 0..1_000 {
        // Boxes of 1 kg and of moments of 1/6 kg m^2, in balls of a radius of 0.87 m.
        let speed = |p: &[f64]| {
            let [v, w] = [&p[..3], &p[3..]].map(|p| p.iter().map(|p| p * p).sum::<f64>().sqrt());
            v + 0.87 * 6.0 * w
        };
        let fastest = state.p.0.chunks_exact(6).map(speed).fold(0.0, f64::max) + gain;
        let report = world.step(&mut state, 1e-3).unwrap();
        if report.contacts <= 100 {
            continue;
        }
        of_piles += 1;
        unsettled += usize::from(!report.settled);
        // All have landed.
        deepest = if step < 700 { 0.0 } else { deepest.max(report.overlap) };
        let asked = (0.25 * gain).max(3e-4 * fastest);
        let left = report.residual.max(report.coulomb);
        assert!(!report.settled || left <= 1.01 * asked, "{left} {asked}");
    }
    println!("{unsettled} of {of_piles} steps of a pile are not settled, {deepest:e} m overlap");
    // A step gives back a fifth of an overlap, as far as that is faster than three times what velocities may leave.
    assert!(deepest < 1.3 * 5.0 * 3.0 * 0.25 * gain * 1e-3, "{deepest}");
    assert!(of_piles > 300 && unsettled < 5, "{of_piles} {unsettled}");
}

#[test]
fn a_falling_pile_comes_to_rest_and_its_conditions_are_settled_as_far_as_asked() {
    let boxes = falling_boxes(27).unwrap();
    let mut state = boxes.state.clone();
    let tolerance = 3e-8;
    let bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    let mut bodies = bodies.with_tolerance(tolerance).unwrap();
    let (start, mut resting) = (boxes.energy(&state), 0.0_f64);
    for step in 0..1_000 {
        let report = bodies.step(&mut state, 2e-3).unwrap();
        if step >= 600 {
            resting = resting.max(report.residual).max(report.coulomb);
        }
        assert!(boxes.energy(&state) < start, "{step}");
    }
    let speed =
        state.p.0.chunks_exact(6).flat_map(|p| &p[..3]).fold(0.0_f64, |m, p| m.max(p.abs()));
    println!("left at rest {resting:e}, speed {speed:e}");
    assert!(resting < tolerance && speed < 1e-6, "{resting} {speed}");
}

/// A block on an incline whose friction is mu: its speed after a second, and its largest gap.
fn slide(angle: f64, mu: f64) -> (f64, f64) {
    let tilt = Rotation::exp(Vector3::y() * angle);
    let normal = tilt.rotate(&Vector3::z());
    let pose = RigidMotion { translation: normal * 0.25, rotation: tilt };
    let body = Body::solid_box(2.0, [0.5, 0.5, 0.25]).unwrap();
    let (system, mut state) = weighty(vec![body], &[still(pose)]);
    let block = Collider::on_body(0, Shape::cuboid([0.5, 0.5, 0.25]).unwrap());
    // The pair's friction is the geometric mean.
    let colliders = vec![block.with_friction(mu), floor(normal).with_friction(mu)];
    let mut bodies = SpatialWorld::new(system, Detector::new(colliders, 1).unwrap()).unwrap();
    let mut gap = 0.0_f64;
    for _ in 0..1000 {
        let report = bodies.step(&mut state, 1e-3).unwrap();
        assert!(report.coulomb < 1e-10 && report.residual < 1e-10, "{report:?}");
        let contacts = bodies.detector().detect(&state.q, 1e-3).unwrap();
        assert_eq!(contacts.len(), 4);
        gap = contacts.iter().map(|c| c.gap.abs()).fold(gap, f64::max);
    }
    let v = Vector3::new(state.p.0[0], state.p.0[1], state.p.0[2]) / 2.0;
    (v.norm(), gap)
}

#[test]
fn a_block_sticks_below_the_friction_angle_and_slides_above_it_as_coulomb_says() {
    let mu = 0.5_f64;
    for angle in [0.1, 0.3, mu.atan() - 1e-3] {
        let (speed, _) = slide(angle, mu);
        assert!(speed < 1e-9, "{angle}: {speed}");
    }
    for angle in [mu.atan() + 1e-3, 0.6, 0.9] {
        let (speed, gap) = slide(angle, mu);
        let expected = G * (angle.sin() - mu * angle.cos());
        assert!((speed - expected).abs() < 1e-6, "{angle}: {speed} against {expected}");
        assert!(gap < 1e-9, "{angle}: {gap}");
    }
}

/// What friction leaves is the angular momentum about the ground, `m (v + 2/5 r w)`, in both.
#[test]
fn a_ball_that_slides_comes_to_roll_at_five_sevenths_of_its_speed_and_one_that_spins_at_two() {
    let (radius, mu, speed) = (0.3, 0.2, 2.0);
    for (slides, spins, part) in [(speed, 0.0, 5.0 / 7.0), (0.0, speed / radius, 2.0 / 7.0)] {
        let (velocity, angular_velocity) = (Vector3::x() * slides, Vector3::y() * spins);
        let motion = BodyMotion { velocity, angular_velocity, ..still(at(0.0, 0.0, radius)) };
        let (system, mut state) = weighty(vec![ball(radius)], &[motion]);
        let round = Collider::on_body(0, Shape::ball(radius).unwrap()).with_friction(mu);
        let colliders = vec![round, floor(Vector3::z()).with_friction(mu)];
        let detector = Detector::new(colliders, 1).unwrap();
        let mut bodies = SpatialWorld::new(system, detector).unwrap();
        let rolls = 2.0 * speed / (7.0 * mu * G);
        let mut began = None;
        for _ in 0..1000 {
            bodies.step(&mut state, 1e-3).unwrap();
            let spin = state.p.0[4] / ball(radius).moments().y;
            if began.is_none() && (state.p.0[0] - radius * spin).abs() < 1e-9 {
                began = Some(state.t);
            }
        }
        assert!((state.p.0[0] - part * speed).abs() < 1e-9, "{part}: {}", state.p.0[0]);
        assert!((began.unwrap() - rolls).abs() <= 2e-3, "{part}: {began:?} {rolls}");
    }
}

#[test]
fn zero_restitution_does_not_rebound_body_on_ground_and_body_on_body() {
    let motions = [still(at(0.0, 0.0, 0.5)), still(at(0.0, 0.0, 2.0))];
    let (system, mut state) = weighty(vec![ball(0.5), ball(0.5)], &motions);
    let round = |body| Collider::on_body(body, Shape::ball(0.5).unwrap());
    let colliders = vec![round(0), round(1), floor(Vector3::z())];
    let mut bodies = SpatialWorld::new(system, Detector::new(colliders, 2).unwrap()).unwrap();
    let mut landed = false;
    for _ in 0..1000 {
        bodies.step(&mut state, 1e-3).unwrap();
        if landed {
            assert!(state.q[9] < 1.5 + 1e-9 && state.p.0[8] < 1e-9, "{}", state.q[9]);
        }
        landed |= state.q[9] < 1.5 + 1e-9;
    }
    assert!(landed && state.p.0[8].abs() < 1e-9 && (state.q[9] - 1.5).abs() < 1e-9);
}

#[test]
fn a_bouncing_ball_rebounds_to_c_squared_of_its_height() {
    let (system, mut state) = weighty(vec![ball(0.25)], &[still(at(0.0, 0.0, 1.25))]);
    let round = Collider::on_body(0, Shape::ball(0.25).unwrap()).with_restitution(0.8);
    let colliders = vec![round, floor(Vector3::z())];
    let mut bodies = SpatialWorld::new(system, Detector::new(colliders, 1).unwrap()).unwrap();
    let (mut bounced, mut top) = (false, 0.0_f64);
    for _ in 0..800 {
        bounced |= bodies.step(&mut state, 1e-3).unwrap().impacts > 0;
        top = if bounced { top.max(state.q[2] - 0.25) } else { 0.0 };
    }
    assert!((top - 0.64).abs() < 0.01, "{top}");
}

#[test]
fn an_obstacle_pushes_and_reports_its_work() {
    let pusher = BodyMotion { velocity: Vector3::x() * 0.5, ..still(at(0.0, 0.0, 0.0)) };
    let (_, state) = weighty(vec![cube(), cube()], &[pusher, still(at(1.2, 0.0, 0.0))]);
    let metric = BodyMetric::<Poses>::new(vec![cube(), cube()]);
    let system = metric.under(stationary_rigid::Free { freedoms: 12 }).unwrap();
    let mut state = state;
    let shape = Shape::cuboid([0.5; 3]).unwrap();
    let colliders = (0..2).map(|body| Collider::on_body(body, shape.clone())).collect();
    let mut bodies = SpatialWorld::new(system, Detector::new(colliders, 2).unwrap())
        .unwrap()
        .with_obstacles(vec![0])
        .unwrap();
    let mut work = 0.0;
    for _ in 0..1000 {
        work += bodies.step(&mut state, 1e-3).unwrap().work;
    }
    assert_eq!(state.p.0[0], 0.5, "nothing slows it down");
    assert!((state.p.0[6] - 0.5).abs() < 1e-12);
    // The force moves with the obstacle's speed: m v^2, half of it lost in the inelastic impact.
    assert!((work - 0.25).abs() < 1e-12, "{work}");
}

#[test]
fn bad_steps_leave_the_state() {
    let (system, mut state, detector) = stack(2);
    let start = state.clone();
    let mut bodies = SpatialWorld::new(system, detector).unwrap();
    assert!(matches!(bodies.step(&mut state, -1.0), Err(ContactError::Step(_))));
    state.p.0[3] = f64::NAN;
    assert!(matches!(bodies.step(&mut state, 1e-3), Err(ContactError::NonFinite { .. })));
    assert_eq!(state.q, start.q);
}

#[test]
fn as_many_balls_leave_a_row_that_touches_as_arrive() {
    for moving in 1..=3 {
        let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1; 3]).unwrap(); 5]);
        let motion = |k: usize| BodyMotion {
            velocity: if k < moving { Vector3::x() } else { Vector3::zeros() },
            ..still(at(k as f64, 0.0, 0.0))
        };
        let mut state = metric.state(&(0..5).map(motion).collect::<Vec<_>>()).unwrap();
        let ball = Shape::ball(0.5).unwrap();
        let on = |body| Collider::on_body(body, ball.clone()).with_restitution(1.0);
        let detector = Detector::new((0..5).map(on).collect(), 5).unwrap();
        let free = metric.under(Free { freedoms: 30 }).unwrap();
        let mut touching = SpatialWorld::new(free, detector).unwrap();
        for _ in 0..100 {
            touching.step(&mut state, 1e-3).unwrap();
        }
        for (ball, p) in state.p.0.chunks_exact(6).enumerate() {
            let expected = if ball >= 5 - moving { 1.0 } else { 0.0 };
            assert!((p[0] - expected).abs() < 1e-12, "{ball} {p:?}");
        }
    }
}

#[test]
fn the_impulses_of_what_touched_and_the_weight_are_the_change_of_momentum() {
    let (system, mut state, detector) = stack(3);
    // The upper one falls onto the others, which are not alike in where they stand.
    state.q[2 * 7 + 2] += 0.4;
    state.q[2 * 7] += 0.1;
    state.p.0[2 * 6] = 0.5;
    let (mut bodies, h) = (SpatialWorld::new(system, detector).unwrap(), 2e-3);
    let mut pushed = 0.0_f64;
    for _ in 0..400 {
        let before = state.clone();
        bodies.step(&mut state, h).unwrap();
        let mut given = [-Vector3::z() * G * h; 3];
        for touch in bodies.touches() {
            let contact = touch.contact;
            let whole = contact.normal * (touch.impact + touch.normal) + touch.friction;
            assert!(touch.friction.dot(&contact.normal).abs() < 1e-12);
            for (body, sign) in contact.bodies.into_iter().zip([-1.0, 1.0]) {
                body.into_iter().for_each(|body| given[body] += whole * sign);
            }
            pushed = pushed.max(whole.norm());
        }
        for (body, given) in given.iter().enumerate() {
            let change: Vec<f64> =
                (0..3).map(|c| state.p.0[6 * body + c] - before.p.0[6 * body + c]).collect();
            let off = (Vector3::from_column_slice(&change) - given).norm();
            assert!(off < 1e-10, "{off:e}");
        }
    }
    assert!(pushed > 1.0, "{pushed}: it hits");
}
