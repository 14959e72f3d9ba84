//! Convex solids with flat faces: every contact is certified by the corners alone.
//!
//! ```text
//! s(n) = min n.x2 - max n.x1 <= distance,    -s(n) >= depth       any unit n
//! ```
//! A gap that equals `s` along its own normal and the distance of two points of the solids is the
//! distance; one that no other direction beats is the depth.

use nalgebra::Vector3;
use stationary_contact::{Collider, ContactPoint, Detector, Shape, SpatialWorld};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

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

fn below(n: u64, random: &mut SplitMix64) -> usize {
    (random.bits() % n) as usize
}

/// A prism that stands on z, the middle of one side at -x.
fn prism(sides: u32, radius: f64, half: f64) -> Vec<V> {
    let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(sides);
    let corner = |k: u32, z: f64| V::new(-radius * angle(k).cos(), radius * angle(k).sin(), z);
    (0..sides).flat_map(|k| [corner(k, half), corner(k, -half)]).collect()
}

fn cube(half: f64) -> Vec<V> {
    (0..8_u32).map(|k| V::from_fn(|i, _| if k >> i & 1 == 0 { -half } else { half })).collect()
}

/// How far two sets of corners are apart along a direction.
fn separation(corners: &[Vec<V>; 2], n: &V) -> f64 {
    let ends = |k: usize| corners[k].iter().map(|c| c.dot(n));
    ends(1).fold(f64::INFINITY, f64::min) - ends(0).fold(f64::NEG_INFINITY, f64::max)
}

/// The turn that lays the side at -x down, towards -z.
fn lying() -> Rotation {
    Rotation::exp(V::new(0.0, -std::f64::consts::FRAC_PI_2, 0.0))
}

#[test]
fn every_corner_of_a_prism_that_is_near_to_a_half_space_touches_it_at_its_own_gap() {
    let mut random = SplitMix64::new(1);
    for size in [1e-6, 1.0, 1e6] {
        for sides in [3, 8, 32] {
            let points = prism(sides, size, 0.5 * size);
            let solid = Collider::on_body(0, Shape::convex(&points).unwrap());
            let floor = Shape::half_space(V::z()).unwrap();
            let mut detector =
                Detector::new(vec![solid, Collider::fixed(RigidMotion::identity(), floor)], 1)
                    .unwrap();
            for k in 0..200 {
                let tilt = [0.0, 1e-16, 1e-12, 1e-8, 1e-4, 1.0][k % 6];
                let rotation = Rotation::exp(random_vector(&mut random) * tilt).compose(&lying());
                let translation = V::z() * (1.0 + 0.01 * random.symmetric()) * size;
                let pose = RigidMotion { translation, rotation };
                let margin = 0.1 * size;
                let contacts = detector.detect(&configuration(&[pose]), margin).unwrap();
                let heights: Vec<f64> = points.iter().map(|p| pose.apply(p).z).collect();
                let mut near: Vec<f64> = heights.into_iter().filter(|z| *z <= margin).collect();
                let mut gaps: Vec<f64> = contacts.iter().map(|c| c.gap).collect();
                near.sort_by(f64::total_cmp);
                gaps.sort_by(f64::total_cmp);
                assert_eq!(near.len(), gaps.len(), "{sides} sides, size {size}, tilt {tilt}");
                let off = near.iter().zip(&gaps).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                let unit = contacts.iter().all(|c| (c.normal.norm() - 1.0).abs() < 4e-15);
                assert!(off <= 2e-15 * size && unit, "{off:e} of {size}, {sides} sides");
            }
        }
    }
}

/// Checks the contacts of two solids by their corners alone.
fn certify(contacts: &[ContactPoint], corners: &[Vec<V>; 2], size: f64, random: &mut SplitMix64) {
    let tolerance = 1e-12 * size;
    let least = contacts.iter().map(|c| c.gap).fold(f64::INFINITY, f64::min);
    for contact in contacts {
        assert!((contact.normal.norm() - 1.0).abs() < 1e-14);
        let [x1, x2] = contact.points;
        let across = ((x2 - x1) - contact.normal * contact.gap).norm();
        assert!(across <= 10.0 * tolerance, "{across:e} of {size:e}: {contact:?}");
        let s = separation(corners, &contact.normal);
        assert!(contact.gap >= s - tolerance, "invented: {} below {s}", contact.gap);
        if contact.gap == least {
            assert!((least - s).abs() <= tolerance, "{least} {s}");
        }
    }
    for _ in 0..100 {
        let n = random_vector(random).normalize();
        assert!(separation(corners, &n) <= least + tolerance, "a better way out");
    }
}

#[test]
fn hulls_of_any_size_and_pose_keep_their_contacts_and_invent_none() {
    let mut random = SplitMix64::new(77);
    let mut seen = [0; 2];
    for k in 0..1500 {
        let size = [1e-6, 1e-3, 1.0, 1e6][k % 4];
        // Round, needle-thin and flat.
        let shrink = [V::new(1.0, 1.0, 1.0), V::new(1.0, 0.01, 0.01), V::new(1.0, 1.0, 0.01)];
        let solid = |shape: usize, random: &mut SplitMix64| match shape {
            0 => cube(0.5 * size),
            1 => prism(8, 0.5 * size, 0.4 * size),
            _ => {
                let shrink = shrink[below(3, random)];
                (0..12).map(|_| random_vector(random).component_mul(&shrink) * size).collect()
            }
        };
        let kinds = [below(3, &mut random), 1 + below(2, &mut random)];
        let shapes = kinds.map(|kind| solid(kind, &mut random));
        let tilt = [0.0, 1e-15, 1e-9, 1e-4, 3.0][below(5, &mut random)];
        let pose = |shift: f64, random: &mut SplitMix64| RigidMotion {
            translation: random_vector(random) * (0.7 * size) + V::z() * (shift * size),
            rotation: Rotation::exp(random_vector(random) * tilt),
        };
        let poses = [pose(0.0, &mut random), pose(0.5, &mut random)];
        let colliders =
            (0..2).map(|b| Collider::on_body(b, Shape::convex(&shapes[b]).unwrap())).collect();
        let mut detector = Detector::new(colliders, 2).unwrap();
        let contacts = detector.detect(&configuration(&poses), size).unwrap();
        let corners = [0, 1].map(|b: usize| shapes[b].iter().map(|p| poses[b].apply(p)).collect());
        if contacts.is_empty() {
            // Nothing within the margin: directions must say so.
            let apart =
                (0..3000).map(|_| separation(&corners, &random_vector(&mut random).normalize()));
            assert!(apart.fold(f64::NEG_INFINITY, f64::max) > 0.5 * size, "lost");
            continue;
        }
        certify(contacts, &corners, size, &mut random);
        seen[usize::from(contacts[0].gap > 0.0)] += 1;
    }
    assert!(seen[0] > 200 && seen[1] > 200, "{seen:?}");
}

#[test]
fn a_cube_given_as_a_hull_rests_on_a_box_by_four_corners_whatever_rounding_does() {
    let mut random = SplitMix64::new(3);
    for size in [1e-6, 3e-5, 1.0, 1e6] {
        let solid = Collider::on_body(0, Shape::convex(&cube(0.5 * size)).unwrap());
        let table = Shape::cuboid([0.5 * size; 3]).unwrap();
        let below = RigidMotion { translation: V::z() * -size, rotation: Rotation::identity() };
        let mut detector = Detector::new(vec![solid, Collider::fixed(below, table)], 1).unwrap();
        for k in 0..300 {
            let off = [0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8][k % 6];
            let pose = RigidMotion {
                translation: random_vector(&mut random) * (off * size),
                rotation: Rotation::exp(random_vector(&mut random) * off),
            };
            let contacts = detector.detect(&configuration(&[pose]), 1e-3 * size).unwrap();
            for (x, y) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                let corner = |p: &V| (p.x / size - x).hypot(p.y / size - y) < 1e-5;
                assert!(contacts.iter().any(|c| corner(&c.points[0])), "{size} {off} {x} {y}");
            }
            assert!(contacts.iter().all(|c| c.gap.abs() <= (4.0 * off + 1e-15) * size));
        }
    }
}

/// Runs one solid of 1 kg for two seconds and gives its largest energy and the last, over the first.
fn energies(points: &[V], pose: RigidMotion, spin: V, below: Collider) -> [f64; 3] {
    const G: f64 = 10.0;
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.12]).unwrap()]);
    let still = BodyMotion { pose, velocity: V::zeros(), angular_velocity: spin };
    let mut state = metric.state(&[still]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: V::zeros() }];
    let weight = Weight { gravity: -V::z() * G, masses, space: Poses };
    let solid = Collider::on_body(0, Shape::convex(points).unwrap()).with_friction(0.3);
    let detector = Detector::new(vec![solid, below.with_friction(0.3)], 1).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    let moments = [0.1, 0.1, 0.12];
    let mut most = f64::NEG_INFINITY;
    let energy = |q: &[f64], p: &[f64]| {
        let turning: f64 = (0..3).map(|k| p[3 + k] * p[3 + k] / moments[k]).sum();
        let moving: f64 = p[..3].iter().map(|p| p * p).sum();
        0.5 * (turning + moving) + G * q[2]
    };
    let start = energy(&state.q, &state.p.0);
    for _ in 0..200 {
        world.step(&mut state, 1e-2).unwrap();
        most = most.max(energy(&state.q, &state.p.0));
    }
    [start, most, energy(&state.q, &state.p.0)]
}

#[test]
fn prisms_given_as_hulls_gain_no_energy_beyond_a_step_and_fall_through_nothing() {
    let floor = || Collider::fixed(RigidMotion::identity(), Shape::half_space(V::z()).unwrap());
    let table = || {
        let place = RigidMotion { translation: V::z() * -1.0, rotation: Rotation::identity() };
        Collider::fixed(place, Shape::cuboid([3.0, 3.0, 1.0]).unwrap())
    };
    let both: [&dyn Fn() -> Collider; 2] = [&floor, &table];
    for below in both {
        for sides in [4, 8, 32] {
            let points = prism(sides, 0.5, 0.4);
            for rotation in [lying(), Rotation::identity()] {
                let pose = RigidMotion { translation: V::z() * 0.5, rotation };
                let [start, most, end] = energies(&points, pose, V::new(0.1, 0.2, 0.3), below());
                // A step of free fall is worth G^2 h^2/2 = 5e-3 J.
                assert!(most <= start + 5e-3, "{sides} sides: {start} J, then {most} J");
                assert!(end > 0.0, "{sides} sides fell through: {end} J");
            }
        }
    }
}

#[test]
fn sixty_drops_of_a_cube_given_as_a_hull_come_to_rest_and_gain_no_energy() {
    let floor = || Collider::fixed(RigidMotion::identity(), Shape::half_space(V::z()).unwrap());
    let table = || {
        let place = RigidMotion { translation: -V::z(), rotation: Rotation::identity() };
        Collider::fixed(place, Shape::cuboid([3.0, 3.0, 1.0]).unwrap())
    };
    let mut random = SplitMix64::new(24);
    for k in 0..60 {
        let tilt = random_vector(&mut random) * [0.0, 1e-16, 1e-12, 1e-8][k % 4];
        let yaw = Rotation::exp(V::z() * (3.0 * random.symmetric()));
        let translation = V::new(
            random.symmetric(),
            random.symmetric(),
            0.5 + [0.0, 0.2][k / 4 % 2] * (1.0 + random.symmetric()),
        );
        let pose = RigidMotion { translation, rotation: Rotation::exp(tilt).compose(&yaw) };
        let below = if k % 2 == 0 { table() } else { floor() };
        let [start, most, end] = energies(&cube(0.5), pose, V::zeros(), below);
        // A step of free fall is worth G^2 h^2/2 = 5e-3 J.
        assert!(most <= start + 5e-3, "drop {k}: {start} J, then {most} J");
        // At rest its centre is half an edge high.
        assert!((end - 5.0).abs() < 1e-2, "drop {k} ends with {end} J");
    }
}

#[test]
fn hulls_of_very_many_edges_lie_on_each_other_by_many_corners() {
    // Pairs of edges that are too many to be looked at one by one.
    let solid = Shape::convex(&prism(100, 1.0, 0.5)).unwrap();
    let gap = 1e-3;
    let pose = |z: f64, turn: f64| RigidMotion {
        translation: V::z() * z,
        rotation: Rotation::exp(V::z() * turn),
    };
    let colliders = [0, 1].map(|body| Collider::on_body(body, solid.clone()));
    let mut detector = Detector::new(colliders.into(), 2).unwrap();
    for turn in [0.0, 0.01, 1.0] {
        let q = configuration(&[pose(0.0, 0.0), pose(1.0 + gap, turn)]);
        let contacts = detector.detect(&q, 0.1).unwrap();
        assert!(contacts.len() >= 100, "{} contacts at {turn}", contacts.len());
        for contact in contacts {
            assert!((contact.gap - gap).abs() < 1e-13 && (contact.normal - V::z()).norm() < 1e-13);
            assert!(contact.points.iter().all(|point| point.xy().norm() < 1.0 + 1e-12));
        }
    }
}

#[test]
fn a_ball_faces_the_closest_place_of_what_has_flat_faces_wherever_its_centre_is() {
    let mut random = SplitMix64::new(27);
    let half = [0.4, 0.3, 1e-4];
    let corners: Vec<V> = (0..8)
        .map(|k| V::from_fn(|c, _| if k >> c & 1 == 0 { half[c] } else { -half[c] }))
        .collect();
    let lid: Vec<V> = corners.iter().filter(|c| c.z > 0.0).copied().collect();
    let triangles = [[0, 1, 2], [1, 3, 2]];
    let flat = Shape::mesh(&lid, &triangles).unwrap();
    for (shape, thick) in [
        (Shape::cuboid(half).unwrap(), true),
        (Shape::convex(&corners).unwrap(), true),
        (flat, false),
    ] {
        for k in 0..2000 {
            let place = RigidMotion {
                translation: random_vector(&mut random),
                rotation: Rotation::exp(random_vector(&mut random)),
            };
            // The centre on a face, an edge or a corner, or near to it.
            let near =
                |random: &mut SplitMix64| [0.0, 1e-15, 1e-9, 0.1][k % 4] * random.symmetric();
            let mut own = V::new(0.4 * random.symmetric(), 0.3 * random.symmetric(), 1e-4);
            own.z += near(&mut random);
            if k % 3 > 0 {
                own.x = 0.4 + near(&mut random);
            }
            if k % 3 > 1 {
                own.y = 0.3 + near(&mut random);
            }
            let colliders = vec![
                Collider::fixed(place, shape.clone()),
                Collider::on_body(0, Shape::ball(1.0).unwrap()),
            ];
            let mut detector = Detector::new(colliders, 1).unwrap();
            let rotation = Rotation::exp(random_vector(&mut random));
            let q = configuration(&[RigidMotion { translation: place.apply(&own), rotation }]);
            let found = detector.detect(&q, 3.0).unwrap();
            let least = found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).unwrap();
            let off = V::from_fn(|c, _| own[c].abs() - half[c]);
            let over = off.map(|x| x.max(0.0));
            let sheet = V::new(over.x, over.y, own.z - half[2]).norm();
            let solid = if off.max() < 0.0 { off.max() } else { over.norm() };
            let distance = if thick { solid } else { sheet };
            assert!((least.gap + 1.0 - distance).abs() < 2e-13, "{own:?}: {}", least.gap);
            // Along the normal the centre is as far outside as the gap says; of a short way to a corner the
            // direction is rounded.
            let normal = place.rotation.inverse().rotate(&least.normal);
            let low = if thick { -half[2] } else { half[2] };
            let up = (half[2] * normal.z).max(low * normal.z);
            let reach = 0.4 * normal.x.abs() + 0.3 * normal.y.abs() + up;
            let short = (own.dot(&normal) - reach - distance).min(0.0);
            let rounding = 2e-13 + 1e-15 / distance.abs().max(1e-13);
            assert!(-short < rounding, "{own:?}: {normal:?}");
        }
    }
}

/// The lines of two edges that end in the tips of pyramids may cross a hair beside them, closer than the tips are.
#[test]
fn a_tip_that_faces_a_tip_a_hair_apart_is_as_far_as_they_are() {
    let mut random = SplitMix64::new(29);
    let mut tried = 0;
    for k in 0..100_000 {
        let size = [1e-6, 1.0, 1e6][k % 3];
        let gap = size * 10.0_f64.powf(-11.0 + random.symmetric());
        let turn = Rotation::exp(random_vector(&mut random) * 3.0);
        let start = below(7, &mut random) as f64;
        let solids = [-1.0, 1.0].map(|side| {
            let start = start + below(4, &mut random) as f64 * std::f64::consts::FRAC_PI_3;
            let around = |j: u32| start + (f64::from(j) + 0.3 * random.symmetric()) * 2.1;
            let mut corners = vec![V::zeros()];
            corners.extend([0, 1, 2].map(around).map(|angle| {
                let along = 10.0_f64.powf(-2.0 * random.symmetric().abs());
                V::new(angle.cos(), angle.sin(), side * along) * size
            }));
            corners
        });
        // Where every plane across the way parts the solids, the tips are closest.
        let way = (V::z() + random_vector(&mut random)).normalize();
        let ahead = |c: &V| c.dot(&way) > 1e-3 * size;
        let behind = |c: &V| c.dot(&way) < -1e-3 * size;
        if !solids[0][1..].iter().all(behind) || !solids[1][1..].iter().all(ahead) {
            continue;
        }
        tried += 1;
        let collider = |body: usize| Collider::on_body(body, Shape::convex(&solids[body]).unwrap());
        let mut detector = Detector::new(vec![collider(0), collider(1)], 2).unwrap();
        let place = |translation: V| RigidMotion { translation, rotation: turn };
        let poses = [place(V::zeros()), place(turn.rotate(&(way * gap)))];
        let found = detector.detect(&configuration(&poses), size).unwrap();
        let least = found.iter().map(|c| c.gap).fold(f64::INFINITY, f64::min);
        assert!((least - gap).abs() < 1e-12 * size, "{k}: {least:e} {gap:e} of {size:e}");
    }
    assert!(tried > 2_000, "{tried}");
}
