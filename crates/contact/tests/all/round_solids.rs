//! Capsules, cylinders, cones and ellipsoids: where they touch, stand, tip, roll and meet.

use nalgebra::Vector3;
use stationary_contact::{
    Closeness, Collider, ContactPoint, Detector, RigidPath, Shape, SpatialWorld, rigid_bodies_meet,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, BodySpace, LieGroup, PointMass, Poses, RigidMotion, Rotation,
    Weight,
};

type V = Vector3<f64>;

const G: f64 = 10.0;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

fn random_vector(random: &mut SplitMix64) -> V {
    V::from_fn(|_, _| random.symmetric())
}

fn configuration(poses: &[RigidMotion]) -> Vec<f64> {
    let numbers = |pose: &RigidMotion| {
        let t = pose.translation;
        [t.x, t.y, t.z].into_iter().chain(pose.rotation.quaternion())
    };
    poses.iter().flat_map(numbers).collect()
}

fn at(translation: V, rotation: Rotation) -> RigidMotion {
    RigidMotion { translation, rotation }
}

fn lying() -> Rotation {
    Rotation::exp(V::y() * QUARTER)
}

fn floor(normal: V) -> Collider {
    Collider::fixed(RigidMotion::identity(), Shape::half_space(normal).unwrap())
}

/// A wide box whose top looks along a direction and holds the origin.
fn table(normal: V, size: f64) -> Collider {
    let turn = match V::z().cross(&normal).try_normalize(1e-12) {
        Some(axis) => Rotation::exp(axis * V::z().dot(&normal).acos()),
        None => Rotation::identity(),
    };
    let place = at(turn.rotate(&(V::z() * -size)), turn);
    Collider::fixed(place, Shape::cuboid([50.0 * size, 50.0 * size, size]).unwrap())
}

/// The contacts of a shape at a pose with another, as parts of a size.
fn contacts(shape: Shape, pose: RigidMotion, below: Collider, margin: f64) -> Vec<ContactPoint> {
    let mut detector = Detector::new(vec![Collider::on_body(0, shape), below], 1).unwrap();
    detector.detect(&configuration(&[pose]), margin).unwrap().to_vec()
}

#[test]
fn capsules_touch_by_both_ends_where_they_lie_and_by_one_point_where_they_cross() {
    let mut random = SplitMix64::new(1);
    for size in [1e-6, 1.0, 1e6] {
        let capsule = || Shape::capsule(size, 0.3 * size).unwrap();
        for k in 0..60 {
            let tilt = [0.0, 1e-16, 1e-12, 1e-9][k % 4];
            let lean = Rotation::exp(random_vector(&mut random) * tilt);
            let yaw = Rotation::exp(V::z() * (3.0 * random.symmetric()));
            let pose = at(V::z() * (0.3 * size), lean.compose(&yaw).compose(&lying()));
            for below in [floor(V::z()), table(V::z(), size)] {
                let found = contacts(capsule(), pose, below, 1e-3 * size);
                assert_eq!(found.len(), 2, "size {size}, tilt {tilt}: {found:?}");
                assert!(found.iter().all(|c| c.gap.abs() <= (3.0 * tilt + 1e-13) * size));
                assert!((found[0].points[0] - found[1].points[0]).norm() > 1.99 * size);
            }
            // Along another one, half beside it.
            let below = Collider::fixed(at(V::zeros(), yaw.compose(&lying())), capsule());
            let shift = yaw.rotate(&V::x()) * size;
            let beside = at(V::z() * (0.6 * size) + shift, pose.rotation);
            let found = contacts(capsule(), beside, below.clone(), 1e-3 * size);
            assert_eq!(found.len(), 2, "size {size}, tilt {tilt}: {found:?}");
            let apart = (found[0].points[0] - found[1].points[0]).norm();
            assert!((apart / size - 1.0).abs() < 1e-6, "{apart}");
            let crossing = at(V::z() * (0.6 * size), Rotation::exp(V::z()).compose(&pose.rotation));
            let found = contacts(capsule(), crossing, below, 1e-3 * size);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].gap.abs() < (3.0 * tilt + 1e-13) * size);
        }
    }
}

/// Rim beside rim a point alone has as good a gap along many directions; what lies side by side has one.
#[test]
fn cylinders_side_by_side_have_normals_across_their_axis_at_both_ends() {
    let mut random = SplitMix64::new(29);
    for case in 0..3_000 {
        let turn = Rotation::exp(random_vector(&mut random) * 3.0);
        let spin = |random: &mut SplitMix64| {
            turn.compose(&Rotation::exp(V::z() * 3.0 * random.symmetric()))
        };
        let turns = [spin(&mut random), spin(&mut random)];
        let [r1, r2] = [(); 2].map(|()| 10_f64.powf(2.0 * random.symmetric() - 2.0));
        let origin = random_vector(&mut random) * 20.0;
        let side = turns[1].rotate(&V::x());
        let first = at(origin - side * (r1 + r2), turns[0]);
        let cylinders = [r1, r2].map(|radius| Shape::cylinder(1.0, radius).unwrap());
        let [one, other] = cylinders;
        let below = Collider::fixed(at(origin, turns[1]), other);
        let met = contacts(one, first, below, 1e-3 * r1.min(r2));
        assert!(!met.is_empty(), "case {case}");
        for contact in met {
            let lean = contact.normal.dot(&turns[1].rotate(&V::z())).abs();
            assert!(lean < 1e-10, "case {case}: leans by {lean:e}, gap {:e}", contact.gap);
            assert!(contact.gap.abs() < 1e-12, "case {case}: {:e}", contact.gap);
        }
    }
}

#[test]
fn flat_faces_of_cylinders_and_cones_touch_by_points_all_around() {
    let mut random = SplitMix64::new(2);
    for size in [1e-6, 1.0, 1e6] {
        for (shape, height) in [
            (Shape::cylinder(0.8 * size, 0.5 * size).unwrap(), 0.8 * size),
            (Shape::cone(1.2 * size, 0.5 * size).unwrap(), 0.3 * size),
        ] {
            for k in 0..60 {
                let tilt = [0.0, 1e-16, 1e-12, 1e-9][k % 4];
                let lean = Rotation::exp(random_vector(&mut random) * tilt);
                let yaw = Rotation::exp(V::z() * (3.0 * random.symmetric()));
                let pose = at(V::z() * height, lean.compose(&yaw));
                for below in [floor(V::z()), table(V::z(), size)] {
                    let found = contacts(shape.clone(), pose, below, 1e-3 * size);
                    let mut angles: Vec<f64> =
                        found.iter().map(|c| c.points[0].y.atan2(c.points[0].x)).collect();
                    angles.sort_by(f64::total_cmp);
                    angles.push(angles[0] + 4.0 * QUARTER);
                    let widest = angles.windows(2).map(|a| a[1] - a[0]).fold(0.0, f64::max);
                    assert!(widest < 0.51 * QUARTER, "{}: {found:?}", shape.name());
                    let worst = found.iter().map(|c| c.gap.abs()).fold(0.0, f64::max);
                    assert!(worst <= (4.0 * tilt + 1e-13) * size, "{worst:e}, {tilt:e}: {found:?}");
                }
            }
        }
    }
}

type SteppedWorld = SpatialWorld<Weight<Poses>>;

fn world(
    body: Body,
    shape: Shape,
    pose: RigidMotion,
    below: Collider,
    friction: f64,
) -> (SteppedWorld, State<Vec<f64>>) {
    let masses = vec![PointMass { mass: body.mass(), point: V::zeros() }];
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let still = BodyMotion { pose, velocity: V::zeros(), angular_velocity: V::zeros() };
    let state = metric.state(&[still]).unwrap();
    let weight = Weight { gravity: -V::z() * G, masses, space: Poses };
    let solid = Collider::on_body(0, shape).with_friction(friction);
    let detector = Detector::new(vec![solid, below.with_friction(friction)], 1).unwrap();
    (SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap(), state)
}

#[test]
fn cylinders_and_cones_stand_on_their_ends_and_do_not_move() {
    let cylinder = (Body::solid_cylinder(1.0, 0.6, 0.3), Shape::cylinder(0.6, 0.3), 0.6);
    let cone = (Body::solid_cone(1.0, 1.0, 0.3), Shape::cone(1.0, 0.3), 0.25);
    for (body, shape, height) in [cylinder, cone] {
        let (body, shape) = (body.unwrap(), shape.unwrap());
        for below in [floor(V::z()), table(V::z(), 1.0)] {
            let pose = at(V::z() * height, Rotation::exp(V::z() * 0.7));
            let (mut world, mut state) = world(body, shape.clone(), pose, below, 0.5);
            let start = state.clone();
            for _ in 0..2_000 {
                world.step(&mut state, 1e-3).unwrap();
            }
            let moved = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs());
            let moved = moved.fold(0.0, f64::max);
            assert!(moved < 1e-9, "a {} moves by {moved:e}", shape.name());
        }
    }
}

#[test]
fn a_cylinder_and_a_capsule_roll_down_a_slope_as_without_slip() {
    let angle = 0.3_f64;
    let normal = V::new(angle.sin(), 0.0, angle.cos());
    let down = V::new(angle.cos(), 0.0, -angle.sin());
    let cylinder = (Body::solid_cylinder(1.0, 0.5, 0.2), Shape::cylinder(0.5, 0.2));
    let capsule = (Body::solid_capsule(1.0, 0.5, 0.2), Shape::capsule(0.5, 0.2));
    for (body, shape) in [cylinder, capsule] {
        let (body, shape) = (body.unwrap(), shape.unwrap());
        for below in [floor(normal), table(normal, 1.0)] {
            // Its axis across the slope.
            let pose = at(normal * 0.2, Rotation::exp(V::x() * QUARTER));
            let (mut world, mut state) = world(body, shape.clone(), pose, below, 0.8);
            for _ in 0..500 {
                world.step(&mut state, 1e-3).unwrap();
            }
            let v = V::from_column_slice(&state.p.0[..3]).dot(&down);
            let expected = 0.5 * G * angle.sin() / (1.0 + body.moments().z / 0.04);
            println!("a {} at {v}, {expected} expected", shape.name());
            assert!((v / expected - 1.0).abs() < 1e-5, "a {}: {v} {expected}", shape.name());
        }
    }
}

/// It stands where its weight passes within its circle: up to tan a = r/half length.
#[test]
fn an_upright_cylinder_on_a_slope_stands_below_its_angle_and_tips_beyond_it() {
    let (half, radius) = (0.6_f64, 0.2_f64);
    let critical = (radius / half).atan();
    for yaw in [0.0, 0.2, 0.39, 1.0] {
        for part in [0.97, 1.03] {
            let angle = part * critical;
            let turn = Rotation::exp(V::y() * angle);
            let normal = turn.rotate(&V::z());
            let pose = at(normal * half, turn.compose(&Rotation::exp(V::z() * yaw)));
            let body = Body::solid_cylinder(1.0, half, radius).unwrap();
            let shape = Shape::cylinder(half, radius).unwrap();
            let (mut world, mut state) = world(body, shape, pose, floor(normal), 2.0);
            for _ in 0..2_000 {
                world.step(&mut state, 1e-3).unwrap();
            }
            let up = Poses::pose(&state.q, 0).unwrap().rotation.rotate(&V::z()).dot(&normal);
            let tips = up < 0.99;
            assert_eq!(tips, part > 1.0, "yaw {yaw}, {part} of the angle: {up}");
        }
    }
}

#[test]
fn ellipsoids_cones_and_cylinders_thrown_on_a_floor_never_gain_energy() {
    let mut random = SplitMix64::new(4);
    let bodies = [
        (Body::solid_ellipsoid(1.0, [0.5, 0.3, 0.2]), Shape::ellipsoid([0.5, 0.3, 0.2])),
        (Body::solid_cone(1.0, 0.8, 0.3), Shape::cone(0.8, 0.3)),
        (Body::solid_cylinder(1.0, 0.4, 0.3), Shape::cylinder(0.4, 0.3)),
        (Body::solid_capsule(1.0, 0.4, 0.2), Shape::capsule(0.4, 0.2)),
    ];
    for k in 0..32 {
        let (body, shape) = &bodies[k % 4];
        let (body, shape) = ((*body).unwrap(), shape.clone().unwrap());
        let name = shape.name();
        let below = if k / 4 % 2 == 0 { floor(V::z()) } else { table(V::z(), 1.0) };
        let pose = at(V::z() * 0.8, Rotation::exp(random_vector(&mut random) * 2.0));
        let (mut world, mut state) = world(body, shape, pose, below, 0.4);
        state.p.0.iter_mut().take(3).for_each(|p| *p = random.symmetric());
        state.p.0.iter_mut().skip(3).for_each(|p| *p = 0.1 * random.symmetric());
        let energy = |state: &State<Vec<f64>>| {
            let (p, moments) = (&state.p.0, body.moments());
            let turning: f64 = (0..3).map(|k| p[3 + k] * p[3 + k] / moments[k]).sum();
            0.5 * (turning + p[..3].iter().map(|p| p * p).sum::<f64>()) + G * state.q[2]
        };
        let (start, mut least, mut rise) = (energy(&state), f64::INFINITY, 0.0_f64);
        for step in 0..2_000 {
            world.step(&mut state, 1e-3).unwrap();
            let now = energy(&state);
            least = least.min(now);
            rise = rise.max(now - least);
            // A step of free fall is worth G^2 h^2/2 = 5e-5 J.
            assert!(now <= start + 5e-5, "{k}, a {name}: {step} {now}");
        }
        // What turns by h w in a step may be R (h w)^2 too deep, and is lifted.
        println!("{k}, a {name}: {start} J, then up by {rise:e} J");
        assert!(rise < 1e-2, "{k}, a {name}: {start} J, then up by {rise} J");
        assert!(state.q[2] > 0.1, "a {name} fell through: {}", state.q[2]);
    }
}

fn round(random: &mut SplitMix64) -> Shape {
    let mut size = || 0.2 + 0.3 * random.symmetric().abs();
    let [a, b, c] = [size(), size(), size()];
    match (6.0 * random.symmetric().abs()) as usize {
        0 => Shape::capsule(a, b),
        1 => Shape::cylinder(a, b),
        2 => Shape::cone(2.0 * a, b),
        3 => Shape::ellipsoid([a, b, c]),
        4 => Shape::cuboid([a, b, c]),
        _ => Shape::ball(a),
    }
    .unwrap()
}

#[test]
fn no_meeting_of_round_solids_is_missed_and_none_is_invented() {
    const TOLERANCE: f64 = 1e-6;
    let mut random = SplitMix64::new(6);
    let (mut met, mut passed) = (0, 0);
    for _ in 0..600 {
        let shapes = [round(&mut random), round(&mut random)];
        let paths = [0, 1].map(|_| {
            let rotation = Rotation::exp(random_vector(&mut random) * 2.0);
            let start = at(random_vector(&mut random) * 1.5, rotation);
            let way = random_vector(&mut random) - start.translation * 1.5;
            RigidPath::straight(start, way, random_vector(&mut random)).unwrap()
        });
        let close = Closeness { thickness: 1e-3, tolerance: TOLERANCE };
        let movers = [(&shapes[0], &paths[0]), (&shapes[1], &paths[1])];
        let hit = rigid_bodies_meet(movers[0], movers[1], close).unwrap();
        let colliders = (0..2).map(|k| Collider::on_body(k, shapes[k].clone())).collect();
        let mut detector = Detector::new(colliders, 2).unwrap();
        let mut distance = |s: f64| {
            let q = configuration(&[paths[0].at(s), paths[1].at(s)]);
            let found = detector.detect(&q, 10.0).unwrap();
            found.iter().map(|c| c.gap).fold(f64::INFINITY, f64::min)
        };
        let until = hit.map_or(1.0, |hit| hit.time);
        let samples = if until > 0.0 { 200 } else { 0 };
        for k in 0..samples {
            let s = until * f64::from(k) / 200.0;
            let there = distance(s);
            assert!(there > close.thickness - 1e-12, "missed at {s}: {there}, {shapes:?}");
        }
        match hit {
            Some(hit) => {
                let there = distance(hit.time);
                assert!(hit.settled && there <= close.thickness + TOLERANCE, "invented: {there}");
                met += 1;
            }
            None => passed += 1,
        }
    }
    assert!(met > 100 && passed > 100, "{met} {passed}");
}
