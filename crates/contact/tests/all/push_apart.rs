//! What overlaps at the start may be pushed apart.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{DiagonalMetric, System};
use stationary_contact::problems::falling_boxes;
use stationary_contact::{ContactError, PlanarCollider, PlanarDetector, PlanarShape, push_apart};
use stationary_measure::SplitMix64;
use stationary_rigid::PlanarWeight;

#[test]
fn two_discs_that_overlap_part_by_their_depth_the_lighter_by_more() {
    let disc = PlanarShape::disc(0.5).unwrap();
    let colliders = (0..2).map(|body| PlanarCollider::on_body(body, disc.clone())).collect();
    let mut detector = PlanarDetector::new(colliders, 2).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0, 3.0] };
    let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.1, 3.0, 3.0, 0.3]).unwrap();
    let system = System::new(metric, weight).unwrap();
    let mut q = vec![0.0, 0.0, 0.0, 0.6, 0.0, 0.0];
    assert!(matches!(detector.check_free(&q, 1e-9), Err(ContactError::Overlap { .. })));
    push_apart(&system, &mut detector, &mut q, 1e-9).unwrap();
    let expected = [-0.3, 0.0, 0.0, 0.7, 0.0, 0.0];
    assert!(q.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-9), "{q:?}");
    detector.check_free(&q, 1e-9).unwrap();
    assert_eq!(push_apart(&system, &mut detector, &mut q, 1e-9).unwrap(), 0);
}

#[test]
fn boxes_thrown_together_are_freed_and_move_by_about_as_much_as_they_overlapped() {
    let boxes = falling_boxes(27).unwrap();
    let mut detector = boxes.detector().unwrap();
    let mut random = SplitMix64::new(9);
    let mut q = boxes.state.q.clone();
    for pose in q.chunks_exact_mut(7) {
        let shift = Vector3::from_fn(|_, _| 0.05 * random.symmetric());
        // Closer together: the gaps of the grid were 0.2 m.
        (0..3).for_each(|k| pose[k] = pose[k] / 1.2 + shift[k]);
    }
    let start = q.clone();
    let deepest = |detector: &mut stationary_contact::Detector, q: &[f64]| {
        let overlaps = detector.overlaps(q, 0.0).unwrap();
        overlaps.iter().map(|overlap| overlap.depth).fold(0.0, f64::max)
    };
    let before = deepest(&mut detector, &q);
    let rounds = push_apart(&boxes.system, &mut detector, &mut q, 1e-6).unwrap();
    let (after, moved) = (
        deepest(&mut detector, &q),
        q.iter().zip(&start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
    );
    println!("overlap {before:e} to {after:e} in {rounds} rounds, moved by {moved:e}");
    assert!(before > 0.05 && after <= 1e-6 && moved < 10.0 * before, "{before} {after} {moved}");
}

#[test]
fn a_depth_that_is_none_is_refused_by_name_and_the_poses_stay() {
    let boxes = falling_boxes(2).unwrap();
    let mut detector = boxes.detector().unwrap();
    let mut q = boxes.state.q.clone();
    q[2] = 0.4;
    let start = q.clone();
    let none =
        [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (f64::NEG_INFINITY, "-inf"), (-1e-9, "-1e-9")];
    for (depth, shown) in none {
        let refused = push_apart(&boxes.system, &mut detector, &mut q, depth).unwrap_err();
        assert!(matches!(refused, ContactError::Depth(_)), "{refused}");
        assert!(refused.to_string().contains(&format!("is {shown} m")), "{refused}");
        assert_eq!(q, start);
    }
    assert!(push_apart(&boxes.system, &mut detector, &mut q, 0.0).unwrap() > 0);
    assert!(q[2] >= 0.5 - 1e-12, "{}", q[2]);
}
