//! Towers of boxes that lean: they stand, as far as asked, and where they do not.

use stationary_contact::SpatialWorld;
use stationary_contact::problems::{Boxes, leaning_tower};
use stationary_measure::SplitMix64;

/// What a tower did whose boxes are off from each other.
struct Leaning {
    /// How far a box has gone, m.
    gone: f64,
    unsettled: usize,
    /// The most that a step left, m/s.
    left: f64,
    /// Whether the last step solved nothing.
    rests: bool,
}

/// Some steps of a tower, to a tolerance.
fn lean(boxes: &Boxes, (steps, tolerance): (usize, Option<f64>)) -> Leaning {
    let mut state = boxes.state.clone();
    let mut world = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    if let Some(tolerance) = tolerance {
        world = world.with_tolerance(tolerance).unwrap();
    }
    let mut leaning = Leaning { gone: 0.0, unsettled: 0, left: 0.0, rests: false };
    for _ in 0..steps {
        let report = world.step(&mut state, 1e-3).unwrap();
        leaning.unsettled += usize::from(!report.settled);
        leaning.left = leaning.left.max(report.residual).max(report.coulomb);
        leaning.rests = report.solved + report.relaxed == 0;
    }
    let gone = |(a, b): (&[f64], &[f64])| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let poses = state.q.chunks_exact(7).zip(boxes.state.q.chunks_exact(7));
    leaning.gone = poses.map(gone).fold(0.0, f64::max);
    leaning
}

/// At the default tolerance. The more they lean, the more corners push nothing.
#[test]
fn towers_of_up_to_a_thousand_boxes_stand_where_statics_says_so_and_else_fall() {
    let mut random = SplitMix64::new(20271201);
    let [mut stood, mut fell] = [0; 2];
    for high in [10, 20, 30, 100, 150, 400, 1000] {
        for off in [0.0, 1e-3, 3e-2, 0.1, 0.2, 0.3, 0.4, 0.45] {
            let boxes = leaning_tower(high, off, &mut random).unwrap();
            let margin = boxes.margin();
            let Leaning { gone, unsettled, rests, .. } = lean(&boxes, (30, None));
            println!("{high} high, off by {off}: {margin:.4} {gone:e}");
            if margin > 1e-3 {
                let most = if high > 400 { 1e-8 } else { 1e-9 };
                assert!(rests && unsettled == 0 && gone < most, "{high} {off}: {gone:e}");
                stood += 1;
            } else if margin < -1e-3 {
                assert!(gone > 1e-7, "{high} {off}: {margin} {gone:e}");
                fell += 1;
            }
        }
    }
    println!("{stood} stood, {fell} fell");
    assert!(stood > 30 && fell > 5, "{stood} {fell}");
}

/// A tower is settled as far as asked, whatever is asked.
#[test]
fn a_tower_that_leans_is_settled_as_far_as_asked() {
    let mut random = SplitMix64::new(20281128);
    for high in [60, 100, 200] {
        for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
            let asked = (50, Some(tolerance));
            let Leaning { gone, unsettled, left, .. } =
                lean(&leaning_tower(high, 1e-3, &mut random).unwrap(), asked);
            println!("{high} high to {tolerance}: {gone:e} {left:e}");
            assert!(
                unsettled == 0 && left <= tolerance,
                "{high} {tolerance}: {left:e} {unsettled}"
            );
        }
    }
}
