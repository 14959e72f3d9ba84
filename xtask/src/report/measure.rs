//! The studies of a plan, measured: those that time one after the other, then the others side by side.
//!
//! A wall time is that of an idle machine. What is counted or computed is the same on any number of
//! threads.

use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::{Outcome, Plan, Progress};
use crate::study::Kind;

/// The outcomes in the plan's order.
pub(super) fn measure<'a>(plan: &Plan<'a>) -> Vec<Outcome<'a>> {
    let bar = bar(plan.entries.len(), plan.progress);
    let places = 0..plan.entries.len();
    let one = |place: usize| {
        let entry = plan.entries[place];
        bar.set_message(entry.id);
        let start = Instant::now();
        let result = entry.measure(plan.size);
        bar.inc(1);
        (place, Outcome { entry, wall: start.elapsed(), result })
    };
    let (alone, mut others): (Vec<usize>, Vec<usize>) =
        places.partition(|&place| plan.entries[place].kind == Kind::WorkPrecision);
    let mut outcomes: Vec<_> = alone.into_iter().map(one).collect();
    // The longest stand last in the list: begun last, one core would wait for them.
    others.reverse();
    outcomes.extend(side_by_side(&others, one));
    bar.finish_and_clear();
    outcomes.sort_by_key(|&(place, _)| place);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}

/// What becomes of these places, in their order, each core taking the next.
pub(crate) fn side_by_side<T: Send>(places: &[usize], one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let left = Mutex::new(places.iter().enumerate());
    // One that panics ends them all, as it does alone; so no lock is poisoned that is looked at.
    let next = || left.lock().ok()?.next();
    let work =
        || std::iter::from_fn(next).map(|(i, &place)| (i, one(place))).collect::<Vec<(usize, T)>>();
    let mut done = Vec::with_capacity(places.len());
    thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            match worker.join() {
                Ok(some) => done.extend(some),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    done.sort_by_key(|&(i, _)| i);
    done.into_iter().map(|(_, one)| one).collect()
}

/// A bar over so many.
pub(crate) fn bar(count: usize, progress: Progress) -> ProgressBar {
    let bar = match progress {
        // indicatif itself draws nothing where standard error is not a terminal.
        Progress::Shown => ProgressBar::new(count as u64),
        Progress::Hidden => ProgressBar::hidden(),
    };
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len}  {elapsed}  {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
