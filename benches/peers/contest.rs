//! Equal final error: each solver is given the loosest tolerance that reaches it, then timed.
//!
//! A tolerance is what a solver allows itself in a step, and no two solvers mean the same by it; the
//! error at the end is what its user gets.

use std::hint::black_box;
use std::time::Instant;

use crate::in_turn;

/// What a run gives.
pub struct Outcome {
    /// The configuration at the end.
    pub end: Vec<f64>,
    /// Evaluations of the force, or of the right-hand side.
    pub evaluations: u64,
}

/// A solver with a problem.
pub struct Contestant<'a> {
    /// Its name.
    pub name: &'static str,
    /// Whose it is: ours come first and are compared with all that follow.
    pub ours: bool,
    /// A run at a tolerance; `None` where the solver gives up.
    pub run: Box<dyn Fn(f64) -> Option<Outcome> + 'a>,
}

/// A solver tuned to an error.
struct Tuned<'c, 'a> {
    contestant: &'c Contestant<'a>,
    tolerance: f64,
    /// Runs that take a few milliseconds together: a clock does not resolve one.
    repeats: u32,
}

/// Halvings of the logarithm of the tolerance.
const HALVINGS: u32 = 30;
/// The loosest and the tightest tolerance tried, as powers of ten.
const POWERS: (f64, f64) = (-1.0, -15.5);
/// Seconds that the runs of one measurement take together.
const RESOLVED: f64 = 4e-3;

impl<'c, 'a> Tuned<'c, 'a> {
    /// Bisects the tolerance until the error lies just below the target.
    fn new(
        contestant: &'c Contestant<'a>,
        error: &dyn Fn(&[f64]) -> f64,
        target: f64,
    ) -> Option<Self> {
        let reaches = |power: f64| {
            (contestant.run)(10_f64.powf(power)).is_some_and(|run| error(&run.end) <= target)
        };
        let (mut loose, mut tight) = POWERS;
        if !reaches(tight) {
            // Rounding may spoil the tightest; the first that reaches the target will do.
            let powers = (2..32).map(|i| -0.5 * f64::from(i));
            tight = powers.into_iter().find(|&power| reaches(power))?;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (loose + tight);
            *(if reaches(middle) { &mut tight } else { &mut loose }) = middle;
        }
        let tolerance = 10_f64.powf(tight);
        let start = Instant::now();
        black_box((contestant.run)(tolerance));
        let repeats = (RESOLVED / start.elapsed().as_secs_f64()).ceil().max(1.0) as u32;
        Some(Tuned { contestant, tolerance, repeats })
    }

    fn time(&self, repeats: u32) {
        for _ in 0..repeats {
            black_box((self.contestant.run)(self.tolerance));
        }
    }
}

/// Prints what each solver needs for this error, and the ratios of times of ours to all that follow.
pub fn contest(
    problem: &str,
    target: f64,
    error: &dyn Fn(&[f64]) -> f64,
    contestants: &[Contestant<'_>],
) {
    println!("\n{problem}, final error {target:e}");
    let mut tuned = Vec::new();
    for contestant in contestants {
        let Some(entry) = Tuned::new(contestant, error, target) else {
            println!("  {:28} does not reach it", contestant.name);
            continue;
        };
        if let Some(run) = (contestant.run)(entry.tolerance) {
            let (name, tolerance) = (contestant.name, entry.tolerance);
            let (error, count) = (error(&run.end), run.evaluations);
            println!(
                "  {name:28} tolerance {tolerance:.1e} error {error:.2e} {count:8} evaluations"
            );
        }
        tuned.push(entry);
    }
    println!("  ratios of times, median of pairs (quartiles)");
    for (place, ours) in tuned.iter().enumerate().filter(|(_, entry)| entry.contestant.ours) {
        for theirs in &tuned[place + 1..] {
            let repeats = ours.repeats.max(theirs.repeats);
            let name = format!("  {} / {}", ours.contestant.name, theirs.contestant.name);
            in_turn::ratio(&name, || ours.time(repeats), || theirs.time(repeats));
        }
    }
}
