//! What was run so far, and what it cost: no rung is run twice, none is judged that was not run.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Instant;

use stationary_integrators::Evaluation;

use super::grid::{Grid, Moments, Within};
use super::ladder::{Family, Kind, Ladder};
use super::look::{Look, accepted, look};
use super::run::{End, Failure, Measured, Trial, measure};

/// Differentials that a method of own steps takes, at least, for each that one of order 2 takes at
/// the border of its stability: 12 a step that is 3 times as long, `|h w| < 6.1` over 2.
const STAGES_A_LIMIT: u64 = 4;

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
    /// The longest run of each rung.
    runs: BTreeMap<At, Measured>,
    /// What the question has seen of them.
    used: BTreeMap<At, Measured>,
    /// Moments of grids; nothing where a run does not come to its end.
    moments: BTreeMap<Grid, Option<Arc<Moments>>>,
    /// For which of them the question has paid.
    read: BTreeSet<Grid>,
    /// Rungs over their whole way; nothing where one cannot be looked at.
    looks: BTreeMap<(At, Grid, Within), Option<Arc<Look>>>,
    /// What the question has seen of these.
    looked: BTreeSet<(At, Grid, Within)>,
    /// Rungs run on finer meshes than that of the scene.
    finer: BTreeMap<(usize, At), Measured>,
    /// Errors over the whole way, where they are larger than at the moments.
    ways: BTreeMap<At, f64>,
    spent: u64,
    deadline: Instant,
    most_work: u64,
}

impl Lab {
    /// Nothing measured yet; runs end at the deadline.
    pub fn new(ladder: Ladder, deadline: Instant) -> Self {
        Lab {
            ladder,
            runs: BTreeMap::new(),
            used: BTreeMap::new(),
            moments: BTreeMap::new(),
            read: BTreeSet::new(),
            looks: BTreeMap::new(),
            looked: BTreeSet::new(),
            finer: BTreeMap::new(),
            ways: BTreeMap::new(),
            spent: 0,
            deadline,
            most_work: u64::MAX,
        }
    }

    /// The same, where a question may spend so much counted work at most: a bound that is the same
    /// on every machine.
    pub fn bounded(self, most_work: u64) -> Self {
        Lab { most_work, ..self }
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
        self.looked.clear();
        self.read.clear();
        self.ways.clear();
        self.spent = 0;
    }

    /// The rung at the moments of a grid; nothing where it fails there or the budget is over.
    pub fn look(&mut self, at: At, grid: Grid) -> Option<Arc<Look>> {
        self.look_within(at, grid, Within::Parts)
    }

    /// The same at the ends of the grid's steps alone, or also within them.
    pub fn look_within(&mut self, at: At, grid: Grid, within: Within) -> Option<Arc<Look>> {
        let moments = self.moments(grid)?;
        let key = (at, grid, within);
        if !self.looks.contains_key(&key) {
            let moments = match within {
                Within::Parts => moments,
                Within::Ends => Arc::new(moments.ends()),
            };
            let family = &self.ladder.families[at.family];
            let rung = &family.rungs[at.rung];
            let model = self.ladder.model(family);
            let seen = look(&self.ladder.name, model, (family.kind, rung), &moments, self.deadline);
            self.looks.insert(key, seen.map(Arc::new));
        }
        let seen = self.looks[&key].clone();
        if self.looked.insert(key) {
            let known = self.used.get(&at).map_or(0, |run| run.work);
            self.spent += seen.as_ref().map_or(known, |look| look.work.max(known));
        }
        seen.filter(|_| self.spent <= self.most_work)
    }

    /// The moments of a grid; nothing where its run does not come to its end.
    pub fn moments(&mut self, grid: Grid) -> Option<Arc<Moments>> {
        if !self.moments.contains_key(&grid) {
            let horizon = self.ladder.written().scene.timing().horizon();
            let moments = match grid {
                Grid::Equal { halvings } => Some(Moments::equal(halvings, horizon)),
                Grid::Accepted(at) => {
                    let family = &self.ladder.families[at.family];
                    let (model, rung) = (self.ladder.model(family), &family.rungs[at.rung]);
                    accepted(&self.ladder.name, model, rung, self.deadline)
                        .map(|ends| Moments::accepted(ends.len(), ends.into_iter()))
                }
            };
            self.moments.insert(grid, moments.map(Arc::new));
        }
        if let Grid::Accepted(at) = grid
            && self.read.insert(grid)
        {
            self.spent += self.used.get(&at).map_or(0, |run| run.work);
        }
        self.moments[&grid].clone()
    }

    /// Keeps the error of a rung over its whole way, where the moments have shown a smaller one.
    pub fn overrule(&mut self, at: At, error: f64) {
        self.ways.insert(at, error);
    }

    /// Forgets those errors: another reference says others.
    pub fn forget_ways(&mut self) {
        self.ways.clear();
    }

    /// The error over the whole way, where it was found to be larger than at the moments.
    pub fn way(&self, at: At) -> Option<f64> {
        self.ways.get(&at).copied()
    }

    /// The rung's run to its end, which is made where it is missing.
    pub fn measure(&mut self, at: At) -> &Measured {
        self.run(at, None)
    }

    /// The rung's run, to the moment at which the trial is lost; where that was seen already, as it
    /// was seen.
    pub fn attempt(&mut self, at: At, trial: &Trial<'_>) -> &Measured {
        self.run(at, Some(trial))
    }

    fn run(&mut self, at: At, trial: Option<&Trial<'_>>) -> &Measured {
        let enough = |seen: &Measured| seen.seen_by(trial).is_some();
        if !self.used.get(&at).is_some_and(enough) {
            let family = &self.ladder.families[at.family];
            let (rung, model) = (&family.rungs[at.rung], self.ladder.model(family));
            let seen = self.runs.get(&at).and_then(|run| run.seen_by(trial));
            let seen = seen.unwrap_or_else(|| {
                let run = measure(&self.ladder.name, model, rung, trial, self.deadline);
                self.runs.insert(at, run.clone());
                run
            });
            self.spent += seen.work;
            self.used.insert(at, seen);
        }
        &self.used[&at]
    }

    /// A rung run on a finer mesh, of at most so much work more; nothing where that is too little,
    /// or the budget is over.
    pub fn measure_finer(&mut self, finer: usize, at: At, most: u64) -> Option<&Measured> {
        let (family, own) = (&self.ladder.families[at.family], &self.ladder.finer[finer]);
        let mut pieces = own.pieces as f64 / self.ladder.model(family).pieces as f64;
        if family.kind == Kind::EqualSteps && family.evaluation == Evaluation::Explicit {
            // A wave crosses shorter cells in shorter steps.
            pieces *= f64::from(2 << finer);
        }
        if self.late() || self.predicted(at) as f64 * pieces > most.min(self.left()) as f64 {
            return None;
        }
        let key = (finer, at);
        if !self.finer.contains_key(&key) {
            let rung = &family.rungs[at.rung];
            let run = measure(&self.ladder.name, own, rung, None, self.deadline);
            self.finer.insert(key, run);
        }
        self.spent += self.finer[&key].work;
        self.finer.get(&key)
    }

    /// What the question has seen of a rung.
    pub fn seen(&self, at: At) -> Option<&Measured> {
        self.used.get(&at)
    }

    /// What was asked so far, in the order of places.
    pub fn used(&self) -> impl Iterator<Item = (At, &Measured)> {
        self.used.iter().map(|(at, run)| (*at, run))
    }

    /// The counted work of all that was asked.
    pub fn spent(&self) -> u64 {
        self.spent
    }

    /// Whether the time is over, or the work that may be done.
    pub fn late(&self) -> bool {
        self.spent >= self.most_work || Instant::now() >= self.deadline
    }

    /// Whether there is work left for a rung.
    pub fn affords(&self, at: At) -> bool {
        self.predicted(at) <= self.left()
    }

    fn left(&self) -> u64 {
        self.most_work - self.spent.min(self.most_work)
    }

    /// The work that a rung will take: its own where it was run, else by the nearest of its family
    /// that was. Of a family of which none was run, what others of its sort took at least, beside
    /// the least that they can take.
    pub fn predicted(&self, at: At) -> u64 {
        let family = self.family(at.family);
        let least = family.rungs[at.rung].least_work;
        let nearest = self
            .used()
            .filter(|(other, run)| other.family == at.family && run.expected() > 0)
            .min_by_key(|(other, _)| other.rung.abs_diff(at.rung));
        let Some((other, run)) = nearest else {
            let least = least.max(self.least_stable(family));
            return (least as f64 * self.least_excess(family, at.rung)).min(1e18) as u64;
        };
        let ratio = match family.kind {
            Kind::EqualSteps => 2.0,
            // The error of a step is its power order + 1, and proportional to the tolerance.
            Kind::OwnSteps => 10_f64.powf(1.0 / f64::from(family.order + 1)),
            // The factor is made once; a few more vectors cost little beside it.
            Kind::Modes => 1.0,
        };
        let grown = run.expected() as f64 * f64::powi(ratio, at.rung as i32 - other.rung as i32);
        least.max(grown as u64)
    }

    /// The least work of explicit steps of one's own choice that are stable: those of equal steps
    /// of the same model that were not are too long.
    fn least_stable(&self, like: &Family) -> u64 {
        if like.kind != Kind::OwnSteps || like.evaluation != Evaluation::Explicit {
            return 0;
        }
        let unstable = self.used().filter(|(at, run)| {
            let family = self.family(at.family);
            let order_two = family.order == 2 && family.evaluation == Evaluation::Explicit;
            let failed = matches!(run.end, End::Failed(Failure::Unstable(_)));
            family.kind == Kind::EqualSteps && family.model == like.model && order_two && failed
        });
        let works = unstable.map(|(at, _)| self.family(at.family).rungs[at.rung].least_work);
        STAGES_A_LIMIT * works.max().unwrap_or(0)
    }

    /// The least factor by which runs of families like this one exceeded what they could take, at
    /// the rung nearest to this.
    fn least_excess(&self, like: &Family, rung: usize) -> f64 {
        // What holds rods solves the same equations, whatever its order.
        let held = !self.ladder.written().scene.rods().is_empty();
        let alike = || {
            self.used().filter(|(at, run)| {
                let family = self.family(at.family);
                run.expected() > 0
                    && family.kind == like.kind
                    && (held || family.order == like.order)
                    && family.evaluation == like.evaluation
            })
        };
        let nearest = alike().map(|(at, _)| at.rung.abs_diff(rung)).min();
        let excess =
            alike().filter(|(at, _)| Some(at.rung.abs_diff(rung)) == nearest).map(|(at, run)| {
                let least = self.family(at.family).rungs[at.rung].least_work;
                run.expected() as f64 / least.max(1) as f64
            });
        let least = excess.fold(f64::INFINITY, f64::min);
        if least.is_finite() { least.max(1.0) } else { 1.0 }
    }
}
