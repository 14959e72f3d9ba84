//! Seams between the tiles and triangles of a flat floor: what slides over them feels nothing.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{DiagonalMetric, System};
use stationary_contact::{
    Collider, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, Shape,
    SpatialWorld,
};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarRotation, PlanarWeight, PointMass,
    Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

const G: f64 = 10.0;
const SPEED: f64 = 5.0;
/// How long, and in steps of how long by turns: the last moves two of the smallest radii.
const TIME: f64 = 0.25;
const STEPS: [usize; 3] = [100, 25, 3];

/// Places in order from one end to another, random between.
fn lines(from: f64, to: f64, count: usize, random: &mut SplitMix64) -> Vec<f64> {
    let mut lines: Vec<f64> =
        (1..count).map(|_| from + (to - from) * 0.5 * (1.0 + random.symmetric())).collect();
    lines.extend([from, to]);
    lines.sort_by(f64::total_cmp);
    lines.dedup_by(|a, b| *a - *b < 1e-3);
    lines
}

/// Boxes side by side with their tops at z = 0.
fn tiles(turn: &Rotation, random: &mut SplitMix64) -> Vec<Collider> {
    let (xs, ys) = (lines(-2.0, 3.0, 8, random), lines(-2.0, 2.0, 3, random));
    let mut tiles = Vec::new();
    for x in xs.windows(2) {
        for y in ys.windows(2) {
            let half = V::new(0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 0.3);
            let middle = V::new(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), -0.3);
            let place = RigidMotion { translation: turn.rotate(&middle), rotation: *turn };
            tiles.push(Collider::fixed(place, Shape::cuboid(half.into()).unwrap()));
        }
    }
    tiles
}

/// Triangles in the plane z = 0.
fn mesh(turn: &Rotation, random: &mut SplitMix64) -> Vec<Collider> {
    let (xs, ys) = (lines(-2.0, 3.0, 8, random), lines(-2.0, 2.0, 4, random));
    let rows = ys.len() as u32;
    let vertices: Vec<V> = xs
        .iter()
        .flat_map(|&x| ys.iter().map(move |&y| V::new(x, y, 0.0)))
        .map(|v| turn.rotate(&v))
        .collect();
    let mut triangles = Vec::new();
    for i in 0..xs.len() as u32 - 1 {
        for j in 0..rows - 1 {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let [a, b, c, d] = [a, b, c, d].map(|(i, j)| i * rows + j);
            triangles.extend(match random.bits() % 2 {
                0 => [[a, b, c], [a, c, d]],
                _ => [[a, b, d], [b, c, d]],
            });
        }
    }
    let shape = Shape::mesh(&vertices, &triangles).unwrap();
    vec![Collider::fixed(RigidMotion::identity(), shape)]
}

/// Slides a solid over a floor; the largest change of its velocity as a part of its speed.
fn lost(
    shape: Shape,
    height: f64,
    turn: &Rotation,
    floor: Vec<Collider>,
    yaw: f64,
    steps: usize,
) -> f64 {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.12]).unwrap()]);
    let forwards = turn.rotate(&V::x()) * SPEED;
    let up = turn.rotate(&V::z());
    let motion = BodyMotion {
        pose: RigidMotion {
            translation: up * height,
            rotation: turn.compose(&Rotation::exp(V::z() * yaw)),
        },
        velocity: forwards,
        angular_velocity: V::zeros(),
    };
    let mut state = metric.state(&[motion]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: V::zeros() }];
    let weight = Weight { gravity: -up * G, masses, space: Poses };
    let mut colliders = floor;
    colliders.push(Collider::on_body(0, shape).with_friction(0.0));
    let detector = Detector::new(colliders, 1).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        world.step(&mut state, TIME / steps as f64).unwrap();
        let v = V::from_column_slice(&state.p.0[..3]);
        worst = worst.max((v - forwards).norm() / SPEED);
    }
    worst
}

#[test]
fn what_slides_over_flat_tiles_and_meshes_keeps_its_speed() {
    let mut random = SplitMix64::new(78);
    let mut failed = Vec::new();
    for k in 0..600 {
        let turn = match k % 3 {
            0 => Rotation::identity(),
            _ => Rotation::exp(V::from_fn(|_, _| 2.0 * random.symmetric())),
        };
        let floor = if k % 2 == 0 { tiles(&turn, &mut random) } else { mesh(&turn, &mut random) };
        let yaw = [0.0, 3.0 * random.symmetric(), 1e-9 * random.symmetric()][k / 2 % 3];
        let half = V::from_fn(|_, _| 0.25 + 0.1 * random.symmetric());
        let cube = |half: V| -> Vec<V> {
            let sign = |k: u32, i: usize| if k >> i & 1 == 0 { -1.0 } else { 1.0 };
            (0..8).map(|k| V::from_fn(|i, _| half[i] * sign(k, i))).collect()
        };
        let shape = match k / 6 % 3 {
            0 => Shape::cuboid(half.into()).unwrap(),
            1 => Shape::convex(&cube(half)).unwrap(),
            _ => Shape::ball(half.z).unwrap(),
        };
        let name = shape.name();
        let lost = lost(shape, half.z, &turn, floor, yaw, STEPS[k / 18 % 3]);
        if lost > 1e-9 {
            failed.push(format!("{k}: a {name} by {lost:e}, yaw {yaw:e}"));
        }
    }
    assert!(failed.is_empty(), "{} lose speed: {failed:#?}", failed.len());
}

#[test]
fn what_slides_over_flat_tiles_of_the_plane_keeps_its_speed() {
    let mut random = SplitMix64::new(79);
    let mut failed = Vec::new();
    for k in 0..400 {
        let angle = if k % 3 == 0 { 0.0 } else { 3.0 * random.symmetric() };
        let turn = PlanarRotation::exp(angle);
        let xs = lines(-2.0, 3.0, 8, &mut random);
        let mut colliders: Vec<_> = if k % 2 == 0 {
            let tile = |x: &[f64]| {
                let middle = Vector2::new(0.5 * (x[0] + x[1]), -0.3);
                let place = PlanarMotion { translation: turn.rotate(&middle), rotation: turn };
                let half = [0.5 * (x[1] - x[0]), 0.3];
                PlanarCollider::fixed(place, PlanarShape::cuboid(half).unwrap())
            };
            xs.windows(2).map(tile).collect()
        } else {
            // Tiles that are not upright, so that seams slant.
            let slant = random.symmetric();
            let tile = |x: &[f64]| {
                let corners =
                    [[x[0], 0.0], [x[1], 0.0], [x[1] + slant, -0.5], [x[0] + slant, -0.5]];
                let corners = corners.map(|[x, y]| turn.rotate(&Vector2::new(x, y)));
                let shape = PlanarShape::polygon(&corners).unwrap();
                PlanarCollider::fixed(PlanarMotion::identity(), shape)
            };
            xs.windows(2).map(tile).collect()
        };
        let half = [0.25 + 0.1 * random.symmetric(), 0.25 + 0.1 * random.symmetric()];
        let shape = match k / 2 % 2 {
            0 => PlanarShape::cuboid(half).unwrap(),
            _ => PlanarShape::disc(half[1]).unwrap(),
        };
        let name = shape.name();
        colliders.push(PlanarCollider::on_body(0, shape));
        let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.1]).unwrap();
        let up = turn.rotate(&Vector2::y());
        let weight = PlanarWeight { gravity: -up * G, masses: vec![1.0] };
        let system = System::new(metric, weight).unwrap();
        let detector = PlanarDetector::new(colliders, 1).unwrap();
        let mut world = PlanarWorld::new(system, detector).unwrap();
        let (start, forwards) = (up * half[1], turn.rotate(&Vector2::x()) * SPEED);
        let mut state = stationary_integrators::State::new(
            vec![start.x, start.y, angle],
            stationary_calculus::Covector(vec![forwards.x, forwards.y, 0.0]),
        );
        let steps = STEPS[k / 4 % 3];
        for _ in 0..steps {
            world.step(&mut state, TIME / steps as f64).unwrap();
            let lost = Vector2::new(state.p.0[0], state.p.0[1]) - forwards;
            if lost.norm() > 1e-9 * SPEED {
                failed.push(format!("{k}: a {name} by {:e}", lost.norm() / SPEED));
                break;
            }
        }
    }
    assert!(failed.is_empty(), "{} lose speed: {failed:#?}", failed.len());
}

/// A flat needle of a hull lies with one corner on a corner of a sheet: every direction between both is as good, and
/// each triangle's may lean onto the next.
#[test]
fn what_touches_a_corner_of_a_sheet_is_found_whatever_its_turn() {
    let corners = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 1.0], [1.0, 1.0]];
    let vertices = corners.map(|[x, y]| Vector3::new(x, y, 0.0));
    let triangles = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]];
    let sheet =
        Collider::fixed(RigidMotion::identity(), Shape::mesh(&vertices, &triangles).unwrap());
    let flake = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 1e-6]];
    let flake = Shape::convex(&flake.map(Vector3::from)).unwrap();
    let colliders = vec![Collider::on_body(0, flake), sheet];
    let mut detector = Detector::new(colliders, 1).unwrap();
    for k in 0..2000 {
        let turn = 1e-3 * f64::from(k);
        for tilt in [0.0, 1e-3, -1e-3] {
            let rotation =
                Rotation::exp(Vector3::z() * turn).compose(&Rotation::exp(Vector3::x() * tilt));
            let [w, x, y, z] = rotation.quaternion();
            for at in vertices {
                let q = [at.x, at.y, at.z, w, x, y, z];
                let found = detector.detect(&q, 1e-3).unwrap();
                assert!(!found.is_empty(), "{turn} {tilt} {at:?}");
            }
        }
    }
}

/// A wall, and in front of it a curtain through which a disc passes by what it was told of the pair.
#[test]
fn what_a_disc_passes_through_does_not_hide_the_wall_behind_it() {
    let at =
        |x: f64| PlanarMotion { translation: Vector2::new(x, 0.0), ..PlanarMotion::identity() };
    let shape = |half: f64| PlanarShape::cuboid([half, 1.0]).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::disc(0.2).unwrap()),
        PlanarCollider::fixed(at(0.5), shape(0.5)),
        PlanarCollider::fixed(at(-0.05), shape(0.1)),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    let mut detector = detector.without_pair([0, 2]).unwrap();
    let found = detector.detect(&[-0.2001, 0.0, 0.0], 0.01).unwrap();
    assert_eq!(found.len(), 1);
    assert!((found[0].gap - 1e-4).abs() < 1e-12, "{}", found[0].gap);
}
