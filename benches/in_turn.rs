//! Two pieces of code timed in turn, so that a machine that slows down slows both.

use std::time::Instant;

/// Pairs of runs: enough for a median that the neighbours' noise does not move.
const PAIRS: usize = 41;

/// Prints the median of `ours / theirs` over many pairs of runs, with its quartiles.
pub fn ratio(name: &str, mut ours: impl FnMut(), mut theirs: impl FnMut()) {
    let time = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    ours();
    theirs();
    let mut ratios: Vec<f64> = (0..PAIRS).map(|_| time(&mut ours) / time(&mut theirs)).collect();
    ratios.sort_by(f64::total_cmp);
    let quartile = |k: usize| ratios[k * (PAIRS - 1) / 4];
    println!("{name:55} {:.3}  ({:.3} to {:.3})", quartile(2), quartile(1), quartile(3));
}
