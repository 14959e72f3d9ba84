//! What was run so far, and what it cost: no rung is run twice, none is judged that was not run.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

use super::ladder::{Family, Kind, Ladder};
use super::run::{Measured, measure};

/// A rung's place: its family and its place in that, from coarse to fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct At {
    /// The family.
    pub family: usize,
    /// The rung.
    pub rung: usize,
}

/// The ladder and what was measured on it.
#[derive(Debug)]
pub struct Lab {
    ladder: Ladder,
    runs: BTreeMap<At, Measured>,
    used: BTreeSet<At>,
    deadline: Instant,
}

impl Lab {
    /// Nothing measured yet; runs end at the deadline.
    pub fn new(ladder: Ladder, deadline: Instant) -> Self {
        Lab { ladder, runs: BTreeMap::new(), used: BTreeSet::new(), deadline }
    }

    /// The ladder.
    pub fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    /// A family of the ladder.
    pub fn family(&self, family: usize) -> &Family {
        &self.ladder.families[family]
    }

    /// Forgets what was asked, not what was measured: the next question pays for its own runs
    /// again, in counted work, without running them again.
    pub fn forget(&mut self) {
        self.used.clear();
    }

    /// The rung's run, which is made where it is missing.
    pub fn measure(&mut self, at: At) -> &Measured {
        self.used.insert(at);
        let rung = &self.ladder.families[at.family].rungs[at.rung];
        self.runs.entry(at).or_insert_with(|| measure(&self.ladder, rung, self.deadline))
    }

    /// What was asked so far, in the order of places.
    pub fn used(&self) -> impl Iterator<Item = (At, &Measured)> {
        self.used.iter().filter_map(|at| Some((*at, self.runs.get(at)?)))
    }

    /// The counted work of all that was asked.
    pub fn spent(&self) -> u64 {
        self.used().map(|(_, run)| run.work).sum()
    }

    /// Whether the time is over.
    pub fn late(&self) -> bool {
        Instant::now() >= self.deadline
    }

    /// The work that a rung will take: its own where it was run, else by the nearest of its family
    /// that was. Of a family of which none was run, what others of its sort took at least, beside
    /// the least that they can take.
    pub fn predicted(&self, at: At) -> u64 {
        let family = self.family(at.family);
        let least = family.rungs[at.rung].least_work;
        let nearest = self
            .used()
            .filter(|(other, run)| other.family == at.family && run.outcome.is_ok())
            .min_by_key(|(other, _)| other.rung.abs_diff(at.rung));
        let Some((other, run)) = nearest else {
            return (least as f64 * self.least_excess(family, at.rung)).min(1e18) as u64;
        };
        let ratio = match family.kind {
            Kind::EqualSteps => 2.0,
            // The error of a step is its power order + 1, and proportional to the tolerance.
            Kind::OwnSteps => 10_f64.powf(1.0 / f64::from(family.order + 1)),
        };
        let grown = run.work as f64 * f64::powi(ratio, at.rung as i32 - other.rung as i32);
        least.max(grown as u64)
    }

    /// The least factor by which runs of families like this one exceeded what they could take, at
    /// the rung nearest to this.
    fn least_excess(&self, like: &Family, rung: usize) -> f64 {
        let alike = || {
            self.used().filter(|(at, run)| {
                let family = self.family(at.family);
                run.outcome.is_ok()
                    && family.kind == like.kind
                    && family.evaluation == like.evaluation
            })
        };
        let nearest = alike().map(|(at, _)| at.rung.abs_diff(rung)).min();
        let excess =
            alike().filter(|(at, _)| Some(at.rung.abs_diff(rung)) == nearest).map(|(at, run)| {
                let least = self.family(at.family).rungs[at.rung].least_work;
                run.work as f64 / least.max(1) as f64
            });
        let least = excess.fold(f64::INFINITY, f64::min);
        if least.is_finite() { least.max(1.0) } else { 1.0 }
    }
}
