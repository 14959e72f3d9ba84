//! Boxes placed at random overlap; the least motion that frees them, and then they fall.
//!
//! `cargo run --example crowded_start -p stationary-contact`

use stationary_contact::problems::falling_boxes;
use stationary_contact::{SpatialWorld, push_apart};
use stationary_measure::SplitMix64;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let boxes = falling_boxes(27)?;
    let mut detector = boxes.detector()?;
    let mut state = boxes.state.clone();
    let mut random = SplitMix64::new(9);
    for pose in state.q.chunks_exact_mut(7) {
        // The gaps of the grid were a fifth of a box.
        pose[..3].iter_mut().for_each(|x| *x = *x / 1.2 + 0.05 * random.symmetric());
    }
    let deepest = |overlaps: &[stationary_contact::Overlap]| {
        overlaps.iter().map(|overlap| overlap.depth).fold(0.0, f64::max)
    };
    let overlaps = detector.overlaps(&state.q, 1e-6)?;
    println!("{} pairs overlap, by up to {:.3} m", overlaps.len(), deepest(&overlaps));
    let rounds = push_apart(&boxes.system, &mut detector, &mut state.q, 1e-6)?;
    println!("free to 1e-6 m after {rounds} rounds");
    let mut world = SpatialWorld::new(boxes.system, detector)?;
    for step in 0..100 {
        let report = world.step(&mut state, 1e-2)?;
        if step % 20 == 0 {
            let (touching, overlap) = (world.touches().count(), report.overlap);
            println!("{:4.2} s: {touching} contact points, overlap {overlap:.1e} m", state.t);
        }
    }
    Ok(())
}
