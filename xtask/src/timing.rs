//! Wall time: the median of several runs, with their spread.

use std::time::{Duration, Instant};

/// Below this a clock does not resolve a call well; the call is repeated inside one measurement.
const RESOLVED: Duration = Duration::from_millis(1);
const RUNS: usize = 5;
/// A call that takes longer is run less often, and one that takes much longer once.
const LONG: Duration = Duration::from_millis(5);
const LONG_RUNS: usize = 3;
const LONGEST: Duration = Duration::from_millis(20);

/// Wall time of one call, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// The middle run.
    pub median: f64,
    /// The fastest run.
    pub min: f64,
    /// The slowest run.
    pub max: f64,
}

/// Times `call`: one warm-up, then the median of five runs. Of a call longer than five
/// milliseconds there are three runs and no warm-up, and longer than twenty a single one: what is
/// long is disturbed less. A call shorter than a millisecond is repeated within a run, and its share is
/// reported.
pub fn median_wall(mut call: impl FnMut()) -> Wall {
    let first = elapsed(1, &mut call);
    let (mut walls, runs, repeats) = match first {
        longest if longest > LONGEST => (vec![longest.as_secs_f64()], 1, 1),
        long if long > LONG => (vec![first.as_secs_f64()], LONG_RUNS, 1),
        _ => (Vec::new(), RUNS, repeats_to_resolve(&mut call)),
    };
    while walls.len() < runs {
        walls.push(elapsed(repeats, &mut call).as_secs_f64() / f64::from(repeats));
    }
    walls.sort_by(f64::total_cmp);
    Wall { median: walls[runs / 2], min: walls[0], max: walls[runs - 1] }
}

fn repeats_to_resolve(call: &mut impl FnMut()) -> u32 {
    let mut repeats = 1;
    while elapsed(repeats, call) < RESOLVED && repeats < 1 << 24 {
        repeats *= 2;
    }
    repeats
}

fn elapsed(repeats: u32, call: &mut impl FnMut()) -> Duration {
    let start = Instant::now();
    for _ in 0..repeats {
        call();
    }
    start.elapsed()
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use super::*;

    #[test]
    fn the_median_lies_between_the_fastest_and_the_slowest_run() {
        let wall = median_wall(|| {
            black_box((0..1000_u64).map(black_box).sum::<u64>());
        });
        assert!(wall.min <= wall.median && wall.median <= wall.max);
    }

    #[test]
    fn a_call_too_short_for_the_clock_still_has_a_time() {
        let wall = median_wall(|| {
            black_box(black_box(1.0_f64).sqrt());
        });
        assert!(wall.min > 0.0 && wall.median < 1e-4);
    }

    #[test]
    fn a_call_is_run_at_least_five_times_after_its_warm_up() {
        let mut calls = 0;
        median_wall(|| {
            calls += 1;
            std::thread::sleep(Duration::from_millis(2));
        });
        assert!(calls > RUNS);
    }
}
