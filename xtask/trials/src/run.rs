//! Runs many cases of one kind: on all cores, with panics caught and hangs noticed, the same result
//! for any number of threads.

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Once};
use std::thread;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::draw::split_mix;
use crate::processor_time::ProcessorTime;
use crate::shrink::shrink;
use crate::{Draw, Kind, Verdict};

/// A case that takes longer on a processor of its own hangs.
const HANG: Duration = Duration::from_secs(300);

/// Between two looks at the clock.
const LOOK: Duration = Duration::from_secs(1);

/// At most this many wrong cases of a kind are shrunk, and none after so long.
const SHRUNK: usize = 8;
const SHRINKING: Duration = Duration::from_secs(60);

/// Which cases to run.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Other seeds, other cases.
    pub seed: u64,
    /// How many cases, before they are shared out.
    pub cases: u64,
    /// This share, counted from 0, and of how many: every so manieth case.
    pub shard: (u64, u64),
    /// No case is begun after this much processor time.
    pub limit: Duration,
}

/// What came of the cases of a kind.
#[derive(Clone, Debug, Serialize)]
pub struct Tally {
    /// The kind's name.
    pub kind: &'static str,
    /// The seed.
    pub seed: u64,
    /// How many were run.
    pub tried: u64,
    /// How many kept the promise, refusals that were due included.
    pub right: u64,
    /// How many were refused though they have an answer.
    pub refused: u64,
    /// How many the referee could not judge.
    pub not_judged: u64,
    /// How many were another promise's, neither right nor wrong here.
    pub apart: u64,
    /// How many were wrong.
    pub wrong: u64,
    /// The largest error over what was promised; `null` in JSON where infinite.
    pub worst: f64,
    /// Seconds of processor.
    pub seconds: f64,
    /// The error over what was promised of each right case and each wrong one, in the cases' order.
    #[serde(skip)]
    pub ratios: Vec<f64>,
    /// The wrong ones, the first of them shrunk.
    #[serde(skip)]
    pub faults: Vec<Fault>,
    /// What was apart, by the cases' own seeds.
    #[serde(skip)]
    pub listed: Vec<(u64, String)>,
    /// What refusals and cases not judged said, and how often.
    #[serde(skip)]
    pub reasons: BTreeMap<String, u64>,
}

/// A wrong case.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Its own seed, for `--case`.
    pub case: u64,
    /// What is wrong.
    pub what: String,
    /// What the case is after shrinking, and what is wrong with it then.
    pub shrunk: Option<(Vec<String>, String)>,
}

impl Tally {
    /// Whether more than a tenth of the cases had no answer: the generator is too wild, or the code
    /// too shy.
    pub fn is_shy(&self) -> bool {
        10 * (self.refused + self.not_judged) > self.tried
    }
}

impl Plan {
    /// Runs the cases of a kind.
    pub fn run(&self, kind: &'static Kind) -> Tally {
        let (share, shares) = self.shard;
        let cases = Arc::new(Cases {
            kind,
            seed: self.seed ^ fingerprint(kind.name),
            next: AtomicU64::new(share),
            stride: shares,
            end: self.cases,
            stop: AtomicBool::new(false),
        });
        let mut tally = Tally::new(kind, self.seed);
        let mut wrong = BTreeMap::new();
        let clock = ProcessorTime::begin();
        for (index, verdict) in self.verdicts(&cases, clock) {
            tally.count(&verdict);
            match verdict {
                Verdict::Wrong { what, .. } => _ = wrong.insert(index, what),
                Verdict::Apart { what } => tally.listed.push((cases.case(index), what)),
                _ => {}
            }
        }
        tally.seconds = clock.passed().as_secs_f64();
        let begun = Instant::now();
        let told = |(number, (index, what)): (usize, (u64, String))| {
            if number < SHRUNK && begun.elapsed() < SHRINKING {
                return cases.explain(index, what);
            }
            Fault { case: cases.case(index), what, shrunk: None }
        };
        tally.faults = wrong.into_iter().enumerate().map(told).collect();
        tally
    }

    /// The verdicts, by number of the case.
    fn verdicts(&self, cases: &Arc<Cases>, clock: ProcessorTime) -> BTreeMap<u64, Verdict> {
        let (sender, receiver) = mpsc::channel();
        let mut working = thread::available_parallelism().map_or(1, |n| n.get());
        let hang = HANG * working as u32;
        for _ in 0..working {
            cases.clone().work(sender.clone());
        }
        let mut begun = BTreeMap::new();
        let mut verdicts = BTreeMap::new();
        let (mut spent, mut looked) = (Duration::ZERO, Instant::now());
        while working > 0 {
            match receiver.recv_timeout(LOOK) {
                Ok(Word::Begun(index)) => {
                    begun.insert(index, spent);
                }
                Ok(Word::Judged(index, verdict)) => {
                    // One that was given up as hanging and came to an end after all is out.
                    if begun.remove(&index).is_some() {
                        verdicts.insert(index, verdict);
                    }
                }
                Ok(Word::Done) => working -= 1,
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
            }
            if looked.elapsed() < LOOK {
                continue;
            }
            (spent, looked) = (clock.passed(), Instant::now());
            if spent > self.limit {
                cases.stop.store(true, Ordering::Relaxed);
            }
            // The thread of a case that hangs cannot be stopped; another takes its place.
            while let Some((&index, _)) = begun.iter().find(|&(_, &since)| spent > since + hang) {
                begun.remove(&index);
                verdicts.insert(index, Verdict::wrong("hangs"));
                cases.clone().work(sender.clone());
                working = working.max(1);
            }
        }
        verdicts
    }
}

impl Tally {
    fn new(kind: &'static Kind, seed: u64) -> Self {
        Tally {
            kind: kind.name,
            seed,
            tried: 0,
            right: 0,
            refused: 0,
            not_judged: 0,
            apart: 0,
            wrong: 0,
            worst: 0.0,
            seconds: 0.0,
            ratios: Vec::new(),
            faults: Vec::new(),
            listed: Vec::new(),
            reasons: BTreeMap::new(),
        }
    }

    fn count(&mut self, verdict: &Verdict) {
        self.tried += 1;
        if let Verdict::Right { ratio } | Verdict::Wrong { ratio, .. } = verdict {
            self.worst = self.worst.max(*ratio);
            self.ratios.push(*ratio);
        }
        match verdict {
            Verdict::Right { .. } => self.right += 1,
            Verdict::Apart { .. } => self.apart += 1,
            Verdict::Wrong { .. } => self.wrong += 1,
            Verdict::Refused { why } => {
                self.refused += 1;
                *self.reasons.entry(format!("refused: {why}")).or_default() += 1;
            }
            Verdict::NotJudged { why } => {
                self.not_judged += 1;
                *self.reasons.entry(format!("not judged: {why}")).or_default() += 1;
            }
        }
    }
}

/// What a thread tells.
enum Word {
    Begun(u64),
    Judged(u64, Verdict),
    Done,
}

/// The cases that threads share.
struct Cases {
    kind: &'static Kind,
    seed: u64,
    next: AtomicU64,
    stride: u64,
    end: u64,
    stop: AtomicBool,
}

impl Cases {
    fn case(&self, index: u64) -> u64 {
        let mut state = self.seed.wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        split_mix(&mut state)
    }

    /// Begins a thread that runs cases until none is left.
    fn work(self: Arc<Self>, sender: Sender<Word>) {
        // Deep recursion in a hostile case is to be an answer, not an abort.
        let builder = thread::Builder::new().stack_size(64 << 20);
        let spawned = builder.spawn(move || {
            loop {
                let index = self.next.fetch_add(self.stride, Ordering::Relaxed);
                if index >= self.end || self.stop.load(Ordering::Relaxed) {
                    break;
                }
                let told = sender.send(Word::Begun(index)).is_ok();
                let verdict = judge(self.kind, &mut Draw::new(self.case(index)));
                if !told || sender.send(Word::Judged(index, verdict)).is_err() {
                    break;
                }
            }
            sender.send(Word::Done).ok();
        });
        spawned.expect("a thread");
    }

    fn explain(&self, index: u64, what: String) -> Fault {
        explain(self.kind, self.case(index), what)
    }
}

/// A wrong case by its own seed, shrunk unless it hangs.
pub(crate) fn explain(kind: &Kind, case: u64, what: String) -> Fault {
    let shrunk = (what != "hangs")
        .then(|| {
            let mut draw = Draw::new(case);
            judge(kind, &mut draw);
            shrink(kind, draw.into_parts().0)
        })
        .flatten()
        .map(|(notes, verdict)| match verdict {
            Verdict::Wrong { what, .. } => (notes, what),
            _ => (notes, String::new()),
        });
    Fault { case, what, shrunk }
}

thread_local! {
    /// Whether this thread's panics are verdicts and not news.
    static JUDGING: Cell<bool> = const { Cell::new(false) };
}

/// The verdict on a case; a panic is wrong.
pub(crate) fn judge(kind: &Kind, draw: &mut Draw) -> Verdict {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let loud = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !JUDGING.get() {
                loud(info);
            }
        }));
    });
    JUDGING.set(true);
    let verdict = panic::catch_unwind(AssertUnwindSafe(|| (kind.trial)(draw)));
    JUDGING.set(false);
    verdict.unwrap_or_else(|panic| Verdict::wrong(format!("panics: {}", message(&*panic))))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<String>(), panic.downcast_ref::<&str>()) {
        (Some(words), _) => words,
        (None, Some(words)) => words,
        (None, None) => "no message",
    }
}

/// FNV-1a of a name, so that kinds with one seed draw different cases.
fn fingerprint(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mixed(draw: &mut Draw) -> Verdict {
        match draw.below(4) {
            0 => Verdict::of(draw.unit(), 1.0, "x"),
            1 => Verdict::refused("shy"),
            2 => Verdict::not_judged("chaotic"),
            _ if draw.chance(0.5) => panic!("{}", 42),
            _ => Verdict::of(draw.uniform(2.0, 3.0), 1.0, "x"),
        }
    }

    static MIXED: Kind = Kind { name: "mixed", krate: "none", rule: "", in_tests: 0, trial: mixed };

    fn plan(shard: (u64, u64)) -> Plan {
        Plan { seed: 5, cases: 400, shard, limit: Duration::MAX }
    }

    #[test]
    fn all_verdicts_are_counted_and_panics_are_wrong() {
        let tally = plan((0, 1)).run(&MIXED);
        assert_eq!(tally.tried, 400);
        let parts = [tally.right, tally.refused, tally.not_judged, tally.wrong];
        assert_eq!(parts.iter().sum::<u64>(), 400);
        assert!(parts.iter().all(|&n| n > 70), "{parts:?}");
        assert!(tally.is_shy());
        assert_eq!(tally.faults.len() as u64, tally.wrong);
        assert_eq!(tally.faults.iter().filter(|fault| fault.shrunk.is_some()).count(), SHRUNK);
        assert!(tally.faults.iter().any(|fault| fault.what == "panics: 42"));
    }

    #[test]
    fn shares_make_up_the_whole() {
        let whole = plan((0, 1)).run(&MIXED);
        let shares: Vec<Tally> = (0..3).map(|i| plan((i, 3)).run(&MIXED)).collect();
        let sum = |count: fn(&Tally) -> u64| shares.iter().map(count).sum::<u64>();
        assert_eq!(sum(|t| t.wrong), whole.wrong);
        assert_eq!(sum(|t| t.refused), whole.refused);
        assert_eq!(sum(|t| t.tried), whole.tried);
    }
}
