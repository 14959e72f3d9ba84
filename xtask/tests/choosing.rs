//! Random questions to the chooser, and those that it once answered wrongly.

use std::collections::BTreeSet;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use stationary_trials::{Draw, Plan, Verdict};
use xtask::choosing::KINDS;

#[test]
fn no_random_question_is_answered_wrongly() {
    let kind = &KINDS[0];
    let plan = Plan { seed: 77, cases: kind.in_tests, shard: (0, 1), limit: Duration::MAX };
    let tally = plan.run(kind);
    assert_eq!(tally.wrong, 0, "{:#?}", tally.faults);
    assert!(tally.right >= tally.tried * 3 / 4, "{:?}", tally.reasons);
}

#[test]
fn what_was_answered_wrongly_is_answered_rightly_or_refused() {
    let found = include_str!("../found/choosing.tsv");
    let mut kinds = BTreeSet::new();
    // One of each kind of fault: a family of scenes, and what was wrongly said of which method.
    let is_first = |line: &&'static str| {
        let what = line.split('\t').nth(2).unwrap_or_default();
        kinds.insert(what.split(" at ").next().unwrap_or_default())
    };
    let lines = found.lines().filter(|line| !line.starts_with('#')).filter(is_first);
    let lines: Vec<&str> = lines.collect();
    let next = AtomicUsize::new(0);
    let ask = || {
        while let Some(line) = lines.get(next.fetch_add(1, Ordering::Relaxed)) {
            let case = line.split('\t').nth(1).and_then(|case| case.parse().ok());
            let case = case.unwrap_or_else(|| panic!("{line}"));
            let said = (KINDS[0].trial)(&mut Draw::new(case));
            assert!(!matches!(said, Verdict::Wrong { .. }), "{line}\n{said:?}");
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, NonZero::get) {
            scope.spawn(ask);
        }
    });
}
