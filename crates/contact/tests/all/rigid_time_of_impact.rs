//! Times of impact of rigid bodies against dense sampling of their distance.

use nalgebra::{Vector2, Vector3};
use stationary_contact::{
    Closeness, Collider, ContactError, Detector, PlanarPath, PlanarShape, RigidHit, RigidPath,
    Shape, rigid_bodies_meet, rigid_bodies_that_meet,
};
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation, RigidMotion, Rotation};

fn vector(random: &mut SplitMix64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.symmetric())
}

fn shape(random: &mut SplitMix64) -> Shape {
    let size = |random: &mut SplitMix64| 0.2 + 0.3 * random.symmetric().abs();
    match (3.0 * random.symmetric().abs()) as usize {
        0 => Shape::ball(size(random)).unwrap(),
        1 => Shape::cuboid([size(random), size(random), size(random)]).unwrap(),
        _ => {
            let points: Vec<_> = (0..8).map(|_| vector(random) * 0.5).collect();
            Shape::convex(&points).unwrap()
        }
    }
}

fn path(random: &mut SplitMix64, turn: f64) -> RigidPath {
    let rotation = Rotation::exp(vector(random) * 2.0);
    let start = RigidMotion { translation: vector(random) * 1.5, rotation };
    // Towards the middle, and beyond it.
    let (way, turn) = (vector(random) - start.translation * 1.5, vector(random) * turn);
    RigidPath::straight(start, way, turn).unwrap()
}

/// The distance of two shapes along their paths; negative where they overlap.
struct Distance {
    detector: Detector,
    paths: [RigidPath; 2],
}

impl Distance {
    fn new(shapes: &[Shape; 2], paths: [RigidPath; 2]) -> Self {
        let on_body = |body: usize| Collider::on_body(body, shapes[body].clone());
        Distance { detector: Detector::new(vec![on_body(0), on_body(1)], 2).unwrap(), paths }
    }

    fn at(&mut self, s: f64) -> f64 {
        let q: Vec<f64> = self
            .paths
            .iter()
            .flat_map(|path| {
                let RigidMotion { translation: t, rotation } = path.at(s);
                [t.x, t.y, t.z].into_iter().chain(rotation.quaternion())
            })
            .collect();
        let contacts = self.detector.detect(&q, 10.0).unwrap();
        contacts.iter().map(|contact| contact.gap).fold(f64::INFINITY, f64::min)
    }

    /// The time of the least of some samples up to a time, refined about it.
    fn least(&mut self, until: f64, samples: u32) -> (f64, f64) {
        let step = until / f64::from(samples);
        let sampled = (0..=samples).map(|k| (self.at(step * f64::from(k)), step * f64::from(k)));
        let (_, near) = sampled.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let (mut low, mut high) = ((near - step).max(0.0), (near + step).min(until));
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            match self.at(low + third) < self.at(high - third) {
                true => high -= third,
                false => low += third,
            }
        }
        let middle = 0.5 * (low + high);
        let (refined, sampled) = (self.at(middle), self.at(near));
        if refined < sampled { (refined, middle) } else { (sampled, near) }
    }
}

const TOLERANCE: f64 = 1e-6;

fn meet(shapes: &[Shape; 2], paths: &[RigidPath; 2], thickness: f64) -> Option<RigidHit> {
    let close = Closeness { thickness, tolerance: TOLERANCE };
    rigid_bodies_meet((&shapes[0], &paths[0]), (&shapes[1], &paths[1]), close).unwrap()
}

#[test]
fn no_meeting_of_rigid_bodies_is_missed_and_none_is_invented() {
    let mut random = SplitMix64::new(21);
    let (mut hits, mut never, mut most) = (0, 0, 0);
    for query in 0..1_000 {
        let shapes = [shape(&mut random), shape(&mut random)];
        let turn = if query % 2 == 0 { 1.0 } else { 6.0 };
        let paths = [path(&mut random, turn), path(&mut random, turn)];
        let mut distance = Distance::new(&shapes, paths);
        match meet(&shapes, &paths, 0.0) {
            None => {
                never += 1;
                let (least, when) = distance.least(1.0, 200);
                assert!(least > 0.0, "{query}: {least} at {when}");
            }
            Some(hit) => {
                hits += 1;
                most = most.max(hit.intervals);
                assert!(hit.settled, "{query}: {hit:?}");
                assert!(distance.at(hit.time) <= TOLERANCE * 1.01, "{query}: {hit:?}");
                if hit.time > 0.0 {
                    let (least, when) = distance.least(hit.time, 200);
                    assert!(least > 0.0, "{query}: {least} at {when}, {hit:?}");
                    let apart = hit.points[1] - hit.points[0];
                    // Points half a tolerance apart show the direction to their rounding over that.
                    let off = (apart.normalize() - hit.normal).norm();
                    assert!(off < 1e-7, "{query}: {off:e}");
                }
            }
        }
    }
    println!("{hits} hits, {never} never, at most {most} intervals");
    assert!(hits > 150 && never > 150 && most < 200, "{hits} {never} {most}");
}

/// The thickness is set next to the least distance of the whole motion.
#[test]
fn what_grazes_within_the_tolerance_is_told_from_what_passes() {
    let mut random = SplitMix64::new(4);
    let (mut seen, mut most) = (0, 0);
    while seen < 100 {
        let shapes = [shape(&mut random), shape(&mut random)];
        let paths = [path(&mut random, 4.0), path(&mut random, 4.0)];
        let (least, when) = Distance::new(&shapes, paths).least(1.0, 400);
        if least < 1e-2 {
            continue;
        }
        seen += 1;
        let hit = meet(&shapes, &paths, least + 1e-9).expect("the bodies come that close");
        assert!(hit.settled && hit.time <= when + 1e-9, "{hit:?} {when}");
        most = most.max(hit.intervals);
        if let Some(hit) = meet(&shapes, &paths, least - 1.1 * TOLERANCE) {
            panic!("{hit:?}: never closer than {least}");
        }
    }
    println!("at most {most} intervals");
    assert!(most < 10_000, "{most}");
}

#[test]
fn a_rod_that_sweeps_round_hits_what_stands_beside_it_although_both_ends_of_the_turn_are_free() {
    let rod = Shape::cuboid([1.0, 0.05, 0.05]).unwrap();
    let post = Shape::ball(0.1).unwrap();
    let turning = RigidPath::straight(
        RigidMotion::identity(),
        Vector3::zeros(),
        Vector3::z() * std::f64::consts::PI,
    );
    let place = RigidMotion { translation: Vector3::y() * 0.8, rotation: Rotation::identity() };
    let paths = [turning.unwrap(), RigidPath::still(place).unwrap()];
    let hit = meet(&[rod, post], &paths, 0.0).unwrap();
    // The line at 0.05 m in front of the rod's axis meets the ball of 0.1 m at 0.8 sin a = 0.15.
    let angle = std::f64::consts::FRAC_PI_2 - (0.15_f64 / 0.8).asin();
    assert!((hit.time * std::f64::consts::PI - angle).abs() < 1e-5, "{hit:?}");
    let stepped = RigidPath::straight(
        RigidMotion::identity(),
        Vector3::z(),
        Vector3::z() * std::f64::consts::PI,
    );
    let paths = [stepped.unwrap(), paths[1]];
    let rod = Shape::cuboid([1.0, 0.05, 0.05]).unwrap();
    assert_eq!(meet(&[rod, Shape::ball(0.1).unwrap()], &paths, 0.0), None, "it has risen past");
}

#[test]
fn the_swept_broad_phase_misses_no_pair() {
    let mut random = SplitMix64::new(7);
    let shapes: Vec<_> = (0..40).map(|_| shape(&mut random)).collect();
    let start = |random: &mut SplitMix64| {
        let rotation = Rotation::exp(vector(random) * 2.0);
        RigidMotion { translation: vector(random) * 2.0, rotation }
    };
    let paths: Vec<_> = (0..40)
        .map(|_| {
            let (v, w) = (vector(&mut random), vector(&mut random) * 3.0);
            RigidPath::straight(start(&mut random), v, w).unwrap()
        })
        .collect();
    let movers: Vec<_> = shapes.iter().zip(&paths).collect();
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    let found = rigid_bodies_that_meet(&movers, close).unwrap();
    let mut expected = Vec::new();
    for i in 0..40 {
        for j in i + 1..40 {
            if let Some(hit) = rigid_bodies_meet(movers[i], movers[j], close).unwrap() {
                expected.push(([i, j], hit));
            }
        }
    }
    assert!(expected.len() > 10);
    assert_eq!(found, expected);
}

#[test]
fn a_disc_meets_planes_and_polygons_that_are_not_convex_when_the_closed_form_says() {
    let disc = PlanarShape::disc(0.5).unwrap();
    let floor = PlanarShape::half_plane(Vector2::new(0.6, 0.8)).unwrap();
    let corners = [[-2.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0], [-2.0, 1.0]];
    let bracket = PlanarShape::polygon(&corners.map(Vector2::from)).unwrap();
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    let still = |x, y, angle| {
        let rotation = PlanarRotation::exp(angle);
        PlanarPath::still(PlanarMotion { translation: Vector2::new(x, y), rotation }).unwrap()
    };
    let thrown = |from: [f64; 2], way: [f64; 2], turn: f64| {
        let start = PlanarMotion { translation: from.into(), rotation: PlanarRotation::exp(0.3) };
        PlanarPath::straight(start, way.into(), turn).unwrap()
    };
    let time = |ground: &PlanarShape, at: &PlanarPath, path: &PlanarPath| {
        let hit = rigid_bodies_meet((ground, at), (&disc, path), close).unwrap();
        hit.map(|hit| hit.time)
    };
    for turn in [0.0, 3.0] {
        // The half-plane is level once turned back by its slope, and 1 m up.
        let slope = 0.6_f64.atan2(0.8);
        let hit = time(&floor, &still(0.0, 1.0, slope), &thrown([3.0, 3.5], [9.0, -4.0], turn));
        assert!((hit.unwrap() - 0.5).abs() < TOLERANCE, "{hit:?}");
        let parallel = thrown([-300.0, 1.5 + 1e-3], [600.0, 0.0], turn);
        assert_eq!(time(&floor, &still(0.0, 1.0, slope), &parallel), None);
        // Into the inner corner of the bracket: its wall at x = 1 is the first.
        let hit = time(&bracket, &still(0.0, 0.0, 0.0), &thrown([-1.0, 1.501], [3.0, 0.0], turn));
        assert!((hit.unwrap() - 0.5).abs() < TOLERANCE, "{hit:?}");
        let above = thrown([-300.0, 2.501], [600.0, 0.0], turn);
        assert_eq!(time(&bracket, &still(0.0, 0.0, 0.0), &above), None);
    }
}

#[test]
fn a_ball_over_a_mesh_meets_the_triangle_that_rises_in_its_way() {
    let corners = [[-9.0, -1.0, 0.0], [9.0, -1.0, 0.0], [9.0, 1.0, 0.0], [-9.0, 1.0, 0.0]];
    let fin = [[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 1.0]];
    let vertices: Vec<_> = corners.iter().chain(&fin).map(|&v| Vector3::from(v)).collect();
    let mesh = Shape::mesh(&vertices, &[[0, 1, 2], [0, 2, 3], [4, 5, 6]]).unwrap();
    let rotation = Rotation::exp(Vector3::new(0.3, -0.2, 0.5));
    let at = |x: f64, z: f64| Vector3::new(x, 0.0, z);
    let ground = RigidPath::still(RigidMotion { translation: Vector3::zeros(), rotation }).unwrap();
    let ball = Shape::ball(0.25).unwrap();
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    let time = |from: Vector3<f64>, way: Vector3<f64>| {
        let start = RigidMotion { translation: rotation.rotate(&from), rotation };
        let path = RigidPath::straight(start, rotation.rotate(&way), Vector3::x() * 2.0).unwrap();
        rigid_bodies_meet((&ball, &path), (&mesh, &ground), close).unwrap().map(|hit| hit.time)
    };
    let hit = time(at(-2.25, 0.251), at(8.0, 0.0));
    assert!((hit.unwrap() - 0.5).abs() < TOLERANCE, "{hit:?}");
    assert_eq!(time(at(-2.25, 1.251), at(8.0, 0.0)), None);
    assert_eq!(time(at(2.26, 0.251), at(5.0, 0.0)), None);
}

/// Two bodies that stay apart, of any size, by a distance that is known.
#[test]
fn small_hulls_and_meshes_that_stay_apart_never_meet() {
    let mut random = SplitMix64::new(12);
    for case in 0..2_000 {
        let size = 10.0_f64.powf(9.0 * random.symmetric());
        let mut corners = || -> Vec<_> { (0..8).map(|_| vector(&mut random) * size).collect() };
        let [first, second] = [corners(), corners()];
        let faces = [[0, 1, 2], [1, 2, 3], [2, 3, 4]];
        let mesh = |corners: &[Vector3<f64>]| Shape::mesh(&corners[..5], &faces).unwrap();
        let (a, b) = match case % 3 {
            0 => (mesh(&first), mesh(&second)),
            1 => (Shape::ball(0.5 * size).unwrap(), Shape::convex(&second).unwrap()),
            _ => (Shape::convex(&first).unwrap(), Shape::ball(0.5 * size).unwrap()),
        };
        let [one, other] = [0, 1].map(|_| Rotation::exp(vector(&mut random) * 3.0));
        let direction = vector(&mut random).normalize();
        // Farther apart along the direction than both reach along it.
        let reach =
            |shape: &Shape, corners: &[Vector3<f64>], turn: &Rotation, way: Vector3<f64>| {
                let far = corners.iter().map(|x| turn.rotate(x).dot(&way)).fold(f64::MIN, f64::max);
                if shape.name() == "ball" { 0.5 * size } else { far }
            };
        let apart = reach(&a, &first, &one, direction) + reach(&b, &second, &other, -direction);
        let start = RigidMotion { translation: Vector3::zeros(), rotation: one };
        let way = direction * (apart + 1e-3 * size);
        let there = RigidMotion { translation: way, rotation: other };
        let [start, there] = [start, there].map(|pose| RigidPath::still(pose).unwrap());
        let close = Closeness { thickness: 0.0, tolerance: 1e-6 * size };
        let hit = rigid_bodies_meet((&a, &start), (&b, &there), close).unwrap();
        assert_eq!(hit, None, "{case}: {} and {} of {size:e}", a.name(), b.name());
    }
}

#[test]
fn the_normal_of_a_hit_far_from_the_origin_has_length_1_and_leads_from_centre_to_centre() {
    let mut random = SplitMix64::new(5);
    let ball = Shape::ball(0.5).unwrap();
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    for far in [0.0, 1e2, 1e4] {
        for _ in 0..100 {
            let translation = vector(&mut random) * far;
            let direction = vector(&mut random).normalize();
            let at = |along: f64| {
                let rotation = Rotation::exp(direction);
                RigidMotion { translation: translation + direction * along, rotation }
            };
            let paths = [
                RigidPath::still(at(0.0)).unwrap(),
                RigidPath::straight(at(3.0), direction * -3.0, Vector3::zeros()).unwrap(),
            ];
            let hit = rigid_bodies_meet((&ball, &paths[0]), (&ball, &paths[1]), close).unwrap();
            let normal = hit.expect("the balls meet").normal;
            assert!((normal.norm() - 1.0).abs() < 1e-14, "{far}: {}", normal.norm());
            // The second ball's place is rounded far from the origin.
            let off = (normal - direction).norm();
            assert!(off < 1e-9 + 1e-15 * far / TOLERANCE, "{far}: {off:e}");
        }
    }
}

#[test]
fn paths_that_are_none_and_shapes_without_a_hull_are_refused_by_name() {
    let nowhere = Vector3::repeat(f64::NAN);
    let path = RigidPath::straight(RigidMotion::identity(), nowhere, Vector3::zeros());
    assert!(matches!(path, Err(ContactError::NonFinite { .. })));
    let (ball, plane) = (Shape::ball(1.0).unwrap(), Shape::half_space(Vector3::z()).unwrap());
    let still = RigidPath::still(RigidMotion::identity()).unwrap();
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    let turning = RigidPath::straight(RigidMotion::identity(), Vector3::zeros(), Vector3::x());
    let refused = rigid_bodies_meet((&ball, &still), (&plane, &turning.unwrap()), close);
    assert!(matches!(refused, Err(ContactError::NoQuery { .. })));
    let refused = rigid_bodies_meet((&plane, &still), (&plane, &still), close);
    assert!(matches!(refused, Err(ContactError::NoQuery { .. })));
    let refused = rigid_bodies_that_meet(&[(&ball, &still), (&plane, &still)], close);
    assert!(matches!(refused, Err(ContactError::NoQuery { .. })));
    let fine = Closeness { tolerance: 1e-16, ..close };
    let refused = rigid_bodies_meet((&ball, &still), (&ball, &still), fine);
    assert!(matches!(refused, Err(ContactError::Tolerance(_))));
    for tolerance in [f64::NAN, -1.0] {
        let movers = [(&ball, &still), (&ball, &still)];
        let refused = rigid_bodies_that_meet(&movers, Closeness { tolerance, ..close });
        assert!(matches!(refused, Err(ContactError::Tolerance(_))));
    }
}
