//! A wrong case made small: words of its list are left out or made smaller while it stays wrong.

use std::time::{Duration, Instant};

use crate::run::judge;
use crate::{Draw, Kind, Verdict};

/// How long shrinking may take.
const PATIENCE: Duration = Duration::from_secs(20);

/// The simplest case near this one that is still wrong, with its notes and what is wrong with it.
pub(crate) fn shrink(kind: &Kind, words: Vec<u64>) -> Option<(Vec<String>, Verdict)> {
    let start = Instant::now();
    let mut search = Search { kind, best: words, found: None, deadline: start + PATIENCE };
    search.attempt(search.best.clone());
    // Large parts go first; then single words, each to zero or to half.
    let mut progress = true;
    while progress && !search.is_late() {
        progress = false;
        let mut part = search.best.len().next_power_of_two();
        while part >= 1 {
            progress |= search.pass(part, |words, range| {
                words.drain(range);
            });
            progress |= search.pass(part, |words, range| words[range].fill(0));
            part /= 2;
        }
        progress |= search.pass(1, |words, range| {
            for word in &mut words[range] {
                *word /= 2;
            }
        });
    }
    search.found
}

struct Search<'a> {
    kind: &'a Kind,
    best: Vec<u64>,
    found: Option<(Vec<String>, Verdict)>,
    deadline: Instant,
}

impl Search<'_> {
    fn is_late(&self) -> bool {
        Instant::now() > self.deadline
    }

    /// Tries a change at each part of the list, from its end; says whether any was kept.
    fn pass(
        &mut self,
        part: usize,
        change: impl Fn(&mut Vec<u64>, std::ops::Range<usize>),
    ) -> bool {
        let mut progress = false;
        let mut end = self.best.len();
        while end > 0 && !self.is_late() {
            let begin = end.saturating_sub(part);
            let mut words = self.best.clone();
            change(&mut words, begin..end);
            strip(&mut words);
            let simpler = (words.len(), sum(&words)) < (self.best.len(), sum(&self.best));
            if simpler && self.attempt(words) {
                progress = true;
                end = end.min(self.best.len());
            }
            end = end.saturating_sub(part);
        }
        progress
    }

    /// Keeps the case if it is wrong.
    fn attempt(&mut self, words: Vec<u64>) -> bool {
        let mut draw = Draw::again(words);
        let verdict = judge(self.kind, &mut draw);
        let is_wrong = matches!(verdict, Verdict::Wrong { .. });
        if is_wrong {
            let (mut words, notes) = draw.into_parts();
            strip(&mut words);
            self.best = words;
            self.found = Some((notes, verdict));
        }
        is_wrong
    }
}

/// Zeros at the end are drawn anyway.
fn strip(words: &mut Vec<u64>) {
    let kept = words.iter().rposition(|&word| word != 0).map_or(0, |last| last + 1);
    words.truncate(kept);
}

fn sum(words: &[u64]) -> u128 {
    words.iter().map(|&word| u128::from(word)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn no_large_sum(draw: &mut Draw) -> Verdict {
        let n = draw.between(0, 20);
        let numbers: Vec<usize> = (0..n).map(|_| draw.between(0, 1000)).collect();
        draw.note(format!("{numbers:?}"));
        Verdict::of(numbers.iter().sum::<usize>() as f64, 500.0, "the sum")
    }

    #[test]
    fn a_wrong_case_is_shrunk_to_a_simple_one() {
        let kind = Kind { name: "sums", krate: "none", rule: "", in_tests: 0, trial: no_large_sum };
        let mut draw = Draw::new(3);
        assert!(matches!(no_large_sum(&mut draw), Verdict::Wrong { .. }));
        let (notes, verdict) = shrink(&kind, draw.into_parts().0).expect("a wrong case");
        let Verdict::Wrong { ratio, .. } = verdict else { panic!("still wrong") };
        // One or two numbers remain, no larger than it takes.
        assert!(notes[0].matches(',').count() <= 1, "{notes:?}");
        assert!(ratio < 2.0, "{ratio}");
    }
}
