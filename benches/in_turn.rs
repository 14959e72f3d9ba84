//! Two pieces of code timed in turn, so that a machine that slows down slows both.

use std::time::{Duration, Instant};

/// Pairs of runs: at least so many, and as many as fit into this time. The shorter a run, the fewer
/// of them are interrupted, and the less the neighbours' noise moves the median.
const PAIRS: usize = 41;
const TIME: Duration = Duration::from_secs(1);

/// Prints the median of `ours / theirs` over many pairs of runs, with its quartiles, and the ratio of
/// the least times, which a machine's other guests disturb the least; and returns the median.
pub fn ratio(name: &str, mut ours: impl FnMut(), mut theirs: impl FnMut()) -> f64 {
    let time = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    ours();
    theirs();
    let (mut ratios, mut least) = (Vec::new(), [f64::INFINITY; 2]);
    let start = Instant::now();
    while ratios.len() < PAIRS || start.elapsed() < TIME {
        let times = [time(&mut ours), time(&mut theirs)];
        ratios.push(times[0] / times[1]);
        least = [least[0].min(times[0]), least[1].min(times[1])];
    }
    ratios.sort_by(f64::total_cmp);
    let quartile = |k: usize| ratios[k * (ratios.len() - 1) / 4];
    let least = least[0] / least[1];
    println!(
        "{name:55} {:.3}  ({:.3} to {:.3}), of the least {least:.3}",
        quartile(2),
        quartile(1),
        quartile(3)
    );
    quartile(2)
}
