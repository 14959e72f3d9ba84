//! Gaps in the plane, their differentials and their names, on every pair of shapes.

use nalgebra::Vector2;
use stationary_calculus::Vector;
use stationary_contact::{
    Carrier, ContactError, PlanarCollider, PlanarContactPoint, PlanarDetector, PlanarShape,
    gap_rows,
};
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation};

fn places(corners: &[[f64; 2]]) -> Vec<Vector2<f64>> {
    corners.iter().map(|&[x, y]| Vector2::new(x, y)).collect()
}

fn disc() -> PlanarShape {
    PlanarShape::disc(0.3).unwrap()
}

fn cuboid() -> PlanarShape {
    PlanarShape::cuboid([0.4, 0.25]).unwrap()
}

fn capsule() -> PlanarShape {
    PlanarShape::capsule(0.35, 0.15).unwrap()
}

fn kite() -> PlanarShape {
    PlanarShape::polygon(&places(&[[0.5, 0.0], [0.1, 0.4], [-0.3, 0.1], [0.0, -0.5]])).unwrap()
}

fn angle_iron() -> PlanarShape {
    let corners = [[-0.4, -0.4], [0.5, -0.4], [0.5, -0.1], [-0.1, -0.1], [-0.1, 0.5], [-0.4, 0.5]];
    PlanarShape::polygon(&places(&corners)).unwrap()
}

fn ground() -> PlanarShape {
    PlanarShape::half_plane(Vector2::new(0.3, 1.0)).unwrap()
}

fn at(x: f64, y: f64) -> PlanarMotion {
    PlanarMotion { translation: Vector2::new(x, y), rotation: PlanarRotation::identity() }
}

fn nearest(detector: &mut PlanarDetector, q: &[f64]) -> Option<PlanarContactPoint> {
    let contacts = detector.detect(q, 0.5).unwrap();
    contacts.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).copied()
}

/// Of every pair of shapes the nearest contact's gap against its finite differences along each
/// coordinate, away from poses at which the nearest features switch.
#[test]
fn the_differential_of_the_gap_is_its_derivative_along_every_coordinate() {
    let mut random = SplitMix64::new(5);
    for first in [disc(), capsule(), cuboid(), kite(), angle_iron()] {
        for second in [disc(), capsule(), cuboid(), kite(), angle_iron(), ground()] {
            let names = (first.name(), second.name());
            let convex = first.pieces().count().max(second.pieces().count()) < 2;
            let (mut seen, mut switches) = (0, 0);
            for _ in 0..1500 {
                let fixed = second.name() == "half-plane";
                let other = match fixed {
                    true => PlanarCollider::fixed(at(0.2, -0.4), second.clone()),
                    false => PlanarCollider::on_body(1, second.clone()),
                };
                let own = PlanarCollider::on_body(0, first.clone());
                let bodies = if fixed { 1 } else { 2 };
                let mut detector = PlanarDetector::new(vec![own, other], bodies).unwrap();
                let mut q = vec![0.0, 0.1, 0.0, 0.7, 0.0, 0.0];
                q.iter_mut().for_each(|x| *x += 0.4 * random.symmetric());
                (q[2], q[5]) = (q[2] * 8.0, q[5] * 8.0);
                q.truncate(3 * bodies);
                let Some(contact) = nearest(&mut detector, &q) else { continue };
                let deepest = if convex { -0.1 } else { 1e-3 };
                if !(deepest..0.2).contains(&contact.gap) || contact.gap.abs() < 1e-3 {
                    continue;
                }
                let rows = gap_rows(&[contact], &q);
                seen += 1;
                for freedom in 0..q.len() {
                    let moved = |h: f64, detector: &mut PlanarDetector| {
                        let mut q = q.clone();
                        q[freedom] += h;
                        nearest(detector, &q).unwrap()
                    };
                    let h = 1e-6;
                    let (ahead, behind) = (moved(h, &mut detector), moved(-h, &mut detector));
                    if (ahead.normal - behind.normal).norm() > 0.01 {
                        switches += 1;
                        continue;
                    }
                    let mut v = vec![0.0; q.len()];
                    v[freedom] = 1.0;
                    let rate = rows.along(0, Vector(&v[..]));
                    let slope = (ahead.gap - behind.gap) / (2.0 * h);
                    assert!((slope - rate).abs() < 1e-6, "{names:?} {freedom}: {slope} {rate}");
                }
            }
            assert!(seen > 100 && switches < seen / 20, "{names:?}: {seen}, {switches}");
        }
    }
}

/// The distance of a point from an edge.
fn from_edge(x: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let along = ((x - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
    (x - a - (b - a) * along).norm()
}

/// A box of half sizes a and b: how far outside of it a point of its own axes is, negative inside.
fn outside([a, b]: [f64; 2], x: &Vector2<f64>) -> f64 {
    let off = Vector2::new(x.x.abs() - a, x.y.abs() - b);
    let over = Vector2::new(off.x.max(0.0), off.y.max(0.0));
    if off.max() < 0.0 { off.max() } else { over.norm() }
}

#[test]
fn a_disc_beside_a_box_a_thousand_times_smaller_or_thinner_has_the_gap_of_the_closed_form() {
    let mut random = SplitMix64::new(27);
    for half in [[1e-3_f64, 1e-3], [1.0, 1e-4], [1e-4, 1.0], [0.3, 0.2]] {
        for k in 0..2000 {
            let place = PlanarMotion {
                translation: Vector2::new(random.symmetric(), random.symmetric()),
                rotation: PlanarRotation::exp(3.0 * random.symmetric()),
            };
            // The centre on the border or near to it, or as far off as the box is wide.
            let scale = [0.0, 1e-15, 1e-9, 1.0][k % 4] * half[0].min(half[1]);
            let mut own = Vector2::new(half[0] * random.symmetric(), half[1]);
            own.y += scale * random.symmetric();
            if k % 3 == 0 {
                own.x = half[0] + scale * random.symmetric();
            }
            let centre = place.apply(&own);
            let colliders = vec![
                PlanarCollider::fixed(place, PlanarShape::cuboid(half).unwrap()),
                PlanarCollider::on_body(0, PlanarShape::disc(1.0).unwrap()),
            ];
            let mut detector = PlanarDetector::new(colliders, 1).unwrap();
            let found = detector.detect(&[centre.x, centre.y, 0.4], 3.0).unwrap();
            let [contact] = found else { panic!("{} points", found.len()) };
            let gap = outside(half, &own) - 1.0;
            assert!((contact.gap - gap).abs() < 1e-13, "{half:?} {own:?}: {} {gap}", contact.gap);
            let normal = place.inverse().rotation.rotate(&contact.normal);
            // Along the normal the centre is as far outside as the gap says; of a short way to a corner the
            // direction is rounded.
            let reach = half[0] * normal.x.abs() + half[1] * normal.y.abs();
            let short = (own.dot(&normal) - reach - gap - 1.0).min(0.0);
            let rounding = 1e-13 + 1e-15 / (gap + 1.0).abs().max(1e-13);
            assert!(-short < rounding, "{half:?} {own:?}: {normal:?}");
        }
    }
}

#[test]
fn the_gap_of_polygons_that_are_apart_is_the_least_distance_of_their_corners_and_edges() {
    let mut random = SplitMix64::new(9);
    let outline = |shape: &PlanarShape, pose: &PlanarMotion| -> Vec<Vec<Vector2<f64>>> {
        shape.pieces().map(|piece| piece.iter().map(|x| pose.apply(x)).collect()).collect()
    };
    let mut seen = 0;
    for _ in 0..4000 {
        let shapes = [angle_iron(), kite()];
        let mut pose = |x: f64| PlanarMotion {
            translation: Vector2::new(x, 0.0) + Vector2::from_fn(|_, _| 0.3 * random.symmetric()),
            rotation: PlanarRotation::exp(3.0 * random.symmetric()),
        };
        let poses = [pose(0.0), pose(0.9)];
        let colliders =
            (0..2).map(|k| PlanarCollider::on_body(k, shapes[k].clone())).collect::<Vec<_>>();
        let mut detector = PlanarDetector::new(colliders, 2).unwrap();
        let q: Vec<f64> = poses
            .iter()
            .flat_map(|p| [p.translation.x, p.translation.y, p.rotation.angle()])
            .collect();
        let Some(gap) = nearest(&mut detector, &q).map(|c| c.gap).filter(|gap| *gap > 0.0) else {
            continue;
        };
        let [a, b] = [0, 1].map(|k| outline(&shapes[k], &poses[k]));
        let mut least = f64::INFINITY;
        for (own, other) in [(&a, &b), (&b, &a)] {
            for piece in own {
                for edge in 0..piece.len() {
                    let (from, to) = (piece[edge], piece[(edge + 1) % piece.len()]);
                    let corners = other.iter().flatten();
                    least = corners.map(|x| from_edge(x, &from, &to)).fold(least, f64::min);
                }
            }
        }
        seen += 1;
        assert!((gap - least).abs() < 1e-12, "{gap} {least}");
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn matching_edges_keep_both_ends_and_their_names_whatever_rounding_does() {
    let square =
        PlanarShape::polygon(&places(&[[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]]));
    let square = square.unwrap();
    let colliders = (0..2).map(|body| PlanarCollider::on_body(body, square.clone())).collect();
    let mut detector = PlanarDetector::new(colliders, 2).unwrap();
    let mut random = SplitMix64::new(3);
    for size in [0.0, 1e-16, 1e-15, 1e-13, 1e-10, 1e-6] {
        for _ in 0..500 {
            let mut q = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            q.iter_mut().for_each(|x| *x += size * random.symmetric());
            let contacts = detector.detect(&q, 1e-3).unwrap();
            assert_eq!(contacts.len(), 2, "{size}");
            for x in [-0.5, 0.5] {
                assert!(contacts.iter().any(|c| (c.points[0].x - x).abs() < 1e-5), "{size} {x}");
            }
            assert!(contacts.iter().all(|c| c.gap.abs() < 5.0 * size + 1e-15), "{size}");
        }
    }
    let ids = |detector: &mut PlanarDetector, shift: f64| -> Vec<_> {
        let contacts = detector.detect(&[0.0, 0.0, 0.0, 0.2 + shift, 1.0, 0.0], 1e-3).unwrap();
        contacts.iter().map(|contact| contact.id).collect()
    };
    let first = ids(&mut detector, 0.0);
    assert!(first.len() == 2 && first[0] < first[1], "distinct and sorted");
    assert_eq!(ids(&mut detector, 1e-4), first);
}

#[test]
fn a_polygon_that_is_not_convex_holds_what_lies_in_its_hollow() {
    let colliders =
        vec![PlanarCollider::on_body(0, angle_iron()), PlanarCollider::on_body(1, disc())];
    let mut detector = PlanarDetector::new(colliders, 2).unwrap();
    // A disc of 0.3 m rests in the corner at (-0.1, -0.1), and touches both legs.
    let contacts = detector.detect(&[0.0, 0.0, 0.0, 0.2, 0.2, 0.0], 1e-6).unwrap();
    let mut normals: Vec<_> = contacts.iter().map(|c| (c.normal.x, c.normal.y)).collect();
    normals.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(contacts.len(), 2, "{contacts:?}");
    assert!(contacts.iter().all(|c| c.gap.abs() < 1e-12));
    assert!(normals[0].1 > 0.999 && normals[1].0 > 0.999, "{normals:?}");
    assert!(detector.detect(&[0.0, 0.0, 0.0, 0.5, 0.5, 0.0], 0.0).unwrap().is_empty());
}

#[test]
fn a_pair_of_surfaces_may_have_its_own_restitution_and_friction() {
    let on = |body| PlanarCollider::on_body(body, disc()).with_friction(0.4).with_restitution(0.2);
    let of = |detector: PlanarDetector| {
        let mut detector = detector;
        let contact = detector.detect(&[0.0, 0.0, 0.0, 0.59, 0.0, 0.0], 0.0).unwrap()[0];
        (contact.restitution, contact.friction)
    };
    let plain = || PlanarDetector::new(vec![on(0), on(1)], 2).unwrap();
    let (c, mu) = of(plain());
    assert!(c == 0.2 && (mu - 0.4).abs() < 1e-15);
    assert_eq!(of(plain().with_pair([1, 0], 0.9, 0.0).unwrap()), (0.9, 0.0));
    assert!(matches!(plain().with_pair([0, 2], 0.9, 0.0), Err(ContactError::Size(_))));
    assert!(matches!(plain().without_pair([2, 0]), Err(ContactError::Size(_))));
    let refused = plain().with_pair([0, 1], 1.1, 0.0).unwrap_err();
    assert!(matches!(refused, ContactError::Restitution { .. }));
    assert_eq!(on(1).carrier, Carrier::Body(1));
}

#[test]
fn colliders_at_places_that_are_no_numbers_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let turned = PlanarMotion { rotation: PlanarRotation::exp(bad), ..at(0.0, 0.0) };
        for place in [at(bad, 0.0), at(0.0, bad), turned] {
            let error = PlanarDetector::new(vec![PlanarCollider::fixed(place, ground())], 0);
            let error = error.unwrap_err();
            assert!(matches!(error, ContactError::NonFinite { .. }), "{error}");
        }
    }
}

#[test]
fn capsules_of_the_plane_touch_by_both_ends_where_they_lie() {
    let mut random = SplitMix64::new(14);
    for size in [1e-6, 1.0, 1e6] {
        let capsule = || PlanarShape::capsule(size, 0.3 * size).unwrap();
        let plane = PlanarShape::half_plane(Vector2::y()).unwrap();
        let slab = PlanarShape::cuboid([3.0 * size, size]).unwrap();
        for (below, height) in [(plane, 0.0), (slab, -size), (capsule(), -0.3 * size)] {
            let half = if below.name() == "capsule" { 0.5 } else { 1.0 };
            for k in 0..40 {
                let tilt = [0.0, 1e-16, 1e-12, 1e-9][k % 4] * random.symmetric();
                let fixed = PlanarCollider::fixed(at(0.0, height), below.clone());
                let own = PlanarCollider::on_body(0, capsule());
                let mut detector = PlanarDetector::new(vec![own, fixed], 1).unwrap();
                let x = if half < 1.0 { size } else { 0.0 };
                let found = detector.detect(&[x, 0.3 * size, tilt], 1e-3 * size).unwrap();
                assert_eq!(found.len(), 2, "{} {size} {tilt}: {found:?}", below.name());
                let apart = (found[0].points[0] - found[1].points[0]).norm();
                assert!((apart / size - 2.0 * half).abs() < 1e-6, "{apart}");
                for contact in found {
                    assert!(contact.gap.abs() <= (2.0 * tilt.abs() + 1e-15) * size, "{contact:?}");
                    assert!((contact.normal.norm() - 1.0).abs() < 1e-15);
                }
            }
        }
    }
}

#[test]
fn capsules_on_one_line_are_apart_by_their_ends() {
    for gap in [-0.1, 0.0, 0.2] {
        let colliders = (0..2).map(|body| PlanarCollider::on_body(body, capsule())).collect();
        let mut detector = PlanarDetector::new(colliders, 2).unwrap();
        let apart = 2.0 * (0.35 + 0.15) + gap;
        for turn in [0.0_f64, std::f64::consts::FRAC_PI_2, 1.0] {
            let q = [0.0, 0.0, turn, apart * turn.cos(), apart * turn.sin(), turn];
            let closest = nearest(&mut detector, &q).unwrap();
            assert!((closest.gap - gap).abs() < 1e-12, "{gap} {turn}: {closest:?}");
        }
    }
}
