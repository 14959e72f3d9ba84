//! Gaps, their differentials and their names, on every pair of shapes.

use nalgebra::Vector3;
use stationary_calculus::{Space, Vector};
use stationary_contact::{Collider, ContactError, ContactPoint, Detector, Shape, gap_rows};
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, Poses, RigidMotion, Rotation};

fn random_vector(random: &mut SplitMix64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.symmetric())
}

fn configuration(poses: &[RigidMotion]) -> Vec<f64> {
    poses
        .iter()
        .flat_map(|pose| {
            let t = pose.translation;
            [t.x, t.y, t.z].into_iter().chain(pose.rotation.quaternion())
        })
        .collect()
}

fn at(x: f64, y: f64, z: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::new(x, y, z), rotation: Rotation::identity() }
}

fn octahedron() -> Shape {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let points: Vec<_> = axes.iter().flat_map(|a| [a * 0.5, a * -0.6]).collect();
    Shape::convex(&points).unwrap()
}

fn tent() -> Shape {
    let vertices =
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.1], [0.0, -0.2, 0.3]].map(Vector3::from);
    Shape::mesh(&vertices, &[[0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

fn shapes() -> Vec<Shape> {
    let cuboid = Shape::cuboid([0.3, 0.4, 0.5]).unwrap();
    let [capsule, cylinder] = [Shape::capsule(0.4, 0.2), Shape::cylinder(0.4, 0.3)];
    let [cone, ellipsoid] = [Shape::cone(0.9, 0.4), Shape::ellipsoid([0.2, 0.3, 0.5])];
    let round = [Shape::ball(0.4), capsule, cylinder, cone, ellipsoid].map(Result::unwrap);
    round.into_iter().chain([cuboid, octahedron(), tent()]).collect()
}

/// The contact with the smallest gap at a configuration.
fn nearest(detector: &mut Detector, q: &[f64]) -> Option<ContactPoint> {
    let contacts = detector.detect(q, 1.0).unwrap();
    contacts.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).copied()
}

/// At every pose at which the nearest features do not switch: there the normal jumps.
#[test]
fn the_differential_of_the_gap_is_its_rate_for_every_pair_of_shapes() {
    let mut random = SplitMix64::new(5);
    for first in shapes() {
        for second in shapes().into_iter().chain([Shape::half_space(Vector3::z()).unwrap()]) {
            let names = (first.name(), second.name());
            // Two meshes have none.
            if names == ("mesh", "mesh") {
                continue;
            }
            let convex = ![names.0, names.1].contains(&"mesh");
            let (colliders, bodies) = match second.plane_like() {
                true => (
                    vec![
                        Collider::on_body(0, first.clone()),
                        Collider::fixed(at(0.0, 0.0, -0.5), second),
                    ],
                    1,
                ),
                false => {
                    (vec![Collider::on_body(0, first.clone()), Collider::on_body(1, second)], 2)
                }
            };
            let mut detector = Detector::new(colliders, bodies).unwrap();
            let (mut seen, mut apart, mut switches) = (0, 0, 0);
            for _ in 0..1000 {
                let pose = |k: f64, random: &mut SplitMix64| RigidMotion {
                    translation: random_vector(random) * 0.3 + Vector3::x() * (1.0 * k),
                    rotation: Rotation::exp(random_vector(random) * 2.0),
                };
                let poses: Vec<_> = (0..bodies).map(|k| pose(k as f64, &mut random)).collect();
                let q = configuration(&poses);
                let v: Vec<f64> = (0..6 * bodies).map(|_| random.symmetric()).collect();
                let Some(contact) = nearest(&mut detector, &q) else { continue };
                // A surface has no depth, and what overlaps it has more than one way out.
                let deepest = if convex { -0.1 } else { 1e-3 };
                if !(deepest..0.1).contains(&contact.gap) || contact.gap.abs() < 1e-3 {
                    continue;
                }
                let rate = gap_rows(&[contact], &q).along(0, Vector(&v));
                let moved = |h: f64| {
                    let mut q = q.clone();
                    Poses.advance(&mut q, h, Vector(&v));
                    q
                };
                let h = 1e-6;
                let ahead = nearest(&mut detector, &moved(h)).unwrap();
                let behind = nearest(&mut detector, &moved(-h)).unwrap();
                if (ahead.normal - behind.normal).norm() > 0.02 {
                    switches += 1;
                    continue;
                }
                seen += 1;
                apart += usize::from(contact.gap > 0.0);
                let slope = (ahead.gap - behind.gap) / (2.0 * h);
                assert!((slope - rate).abs() < 1e-5, "{names:?}: {slope} {rate}, {contact:?}");
            }
            assert!(apart > 15 && switches * 25 < seen, "{names:?}: {apart} {seen} {switches}");
        }
    }
}

trait PlaneLike {
    fn plane_like(&self) -> bool;
}

impl PlaneLike for Shape {
    fn plane_like(&self) -> bool {
        self.name() == "half-space"
    }
}

#[test]
fn a_box_on_a_box_touches_in_four_named_points_that_keep_their_names() {
    let cuboid = Shape::cuboid([0.5; 3]).unwrap();
    let colliders = (0..2).map(|body| Collider::on_body(body, cuboid.clone())).collect();
    let mut detector = Detector::new(colliders, 2).unwrap();
    let ids = |detector: &mut Detector, shift: f64| {
        let q = configuration(&[at(0.0, 0.0, 0.0), at(0.1 + shift, 0.07, 1.0 - 1e-9)]);
        let contacts = detector.detect(&q, 1e-3).unwrap();
        assert!(contacts.iter().all(|c| (c.gap + 1e-9).abs() < 1e-15 && c.normal.z > 0.999));
        contacts.iter().map(|contact| contact.id).collect::<Vec<_>>()
    };
    let first = ids(&mut detector, 0.0);
    assert_eq!(first.len(), 4);
    assert!(first.windows(2).all(|pair| pair[0] < pair[1]), "distinct and sorted");
    assert_eq!(ids(&mut detector, 1e-4), first);
}

#[test]
fn boxes_that_face_each_other_but_for_rounding_touch_at_every_corner() {
    let cuboid = Shape::cuboid([0.5; 3]).unwrap();
    let colliders = (0..2).map(|body| Collider::on_body(body, cuboid.clone())).collect();
    let mut detector = Detector::new(colliders, 2).unwrap();
    let mut random = SplitMix64::new(3);
    for size in [1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-6] {
        for _ in 0..500 {
            let mut near = |z: f64| RigidMotion {
                translation: random_vector(&mut random) * size + Vector3::z() * z,
                rotation: Rotation::exp(random_vector(&mut random) * size),
            };
            let q = configuration(&[near(0.0), near(1.0)]);
            let contacts = detector.detect(&q, 1e-3).unwrap();
            for (x, y) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                let corner = |point: &Vector3<f64>| (point.x - x).hypot(point.y - y) < 1e-5;
                assert!(contacts.iter().any(|c| corner(&c.points[0])), "{size} {x} {y}");
            }
            assert!(contacts.iter().all(|c| c.gap.abs() < 5.0 * size + 1e-15), "{size}");
        }
    }
}

#[test]
fn the_broad_phase_misses_no_pair_and_leaves_few_more() {
    let mut random = SplitMix64::new(2);
    let n = 300;
    let radius = 0.12;
    let colliders =
        (0..n).map(|body| Collider::on_body(body, Shape::ball(radius).unwrap())).collect();
    let mut detector = Detector::new(colliders, n).unwrap();
    for _ in 0..5 {
        let centres: Vec<_> = (0..n).map(|_| random_vector(&mut random)).collect();
        let poses: Vec<_> = centres.iter().map(|c| at(c.x, c.y, c.z)).collect();
        let q = configuration(&poses);
        let found: Vec<_> =
            detector.detect(&q, 0.0).unwrap().iter().map(|c| c.id.colliders).collect();
        let mut expected = Vec::new();
        for a in 0..n {
            for b in a + 1..n {
                if (centres[a] - centres[b]).norm() < 2.0 * radius {
                    expected.push([a as u32, b as u32]);
                }
            }
        }
        assert_eq!(found, expected);
        // A ball fills pi/6 of its box: of overlapping boxes about half hold overlapping balls.
        assert!(detector.candidates().len() < 3 * expected.len());
    }
}

#[test]
fn bodies_that_overlap_are_reported_with_their_depth() {
    let ball = Shape::ball(0.5).unwrap();
    let mut colliders: Vec<_> = (0..3).map(|body| Collider::on_body(body, ball.clone())).collect();
    colliders.push(Collider::fixed(at(0.0, 0.0, -0.5), Shape::half_space(Vector3::z()).unwrap()));
    let mut detector = Detector::new(colliders, 3).unwrap();
    let q = configuration(&[at(0.0, 0.0, 0.0), at(0.75, 0.0, 0.0), at(3.0, 0.0, -0.125)]);
    let overlaps = detector.overlaps(&q, 1e-6).unwrap();
    let found: Vec<_> = overlaps.iter().map(|o| (o.colliders, o.depth)).collect();
    assert_eq!(found, [([0, 1], 0.25), ([2, 3], 0.125)]);
    let error = detector.check_free(&q, 1e-6).unwrap_err();
    assert_eq!(error, ContactError::Overlap { count: 2, first: 0, second: 1, depth: 0.25 });
    assert!(detector.check_free(&q, 0.3).is_ok());
}

#[test]
fn colliders_that_make_no_sense_are_refused_by_name() {
    let ball = || Collider::on_body(0, Shape::ball(1.0).unwrap());
    let refused = |collider: Collider| Detector::new(vec![collider], 1).unwrap_err();
    let error = refused(ball().with_restitution(1.5));
    assert!(matches!(error, ContactError::Restitution { value: 1.5, .. }));
    let error = refused(ball().with_friction(-0.1));
    assert!(matches!(error, ContactError::Friction { value: -0.1, .. }));
    let error = refused(Collider::on_body(1, Shape::ball(1.0).unwrap()));
    assert!(matches!(error, ContactError::Size(_)), "{error}");
    let nowhere = Collider { place: at(0.0, f64::NAN, 0.0), ..ball() };
    assert!(matches!(refused(nowhere), ContactError::NonFinite { index: 1, .. }));
    let mut detector = Detector::new(vec![ball()], 1).unwrap();
    let q = configuration(&[at(0.0, 0.0, 0.0)]);
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        assert!(matches!(detector.detect(&q, bad), Err(ContactError::Margin(_))));
        assert!(matches!(detector.check_free(&q, bad), Err(ContactError::Depth(_))));
    }
    let mut q = configuration(&[at(0.0, 0.0, f64::NAN)]);
    assert!(matches!(detector.detect(&q, 0.0), Err(ContactError::Rigid(_))));
    q.pop();
    assert!(matches!(detector.detect(&q, 0.0), Err(ContactError::Size(_))));
}
