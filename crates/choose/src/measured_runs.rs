//! What was run so far, and what it cost: no rung is run twice, none is judged that was not run.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use stationary_integrators::Evaluation;

use crate::effort::{Effort, Purpose};
use crate::error::QuestionError;
use crate::experiment::Experiment;
use crate::grid::{Grid, Moments, Within};
use crate::ladder::{At, Family, Kind, Ladder};
use crate::look::Look;
use crate::measured::{End, Failure, Measured, StopRule};
use crate::watch::Watch;

/// Differentials that a method of adaptive steps takes, at least, for each that one of order 2 takes at
/// the border of its stability: 12 a step that is 3 times as long, `|h w| < 6.1` over 2.
const STAGES_A_LIMIT: u64 = 4;

/// An experiment and what was measured of it.
pub struct MeasuredRuns<'e> {
    experiment: &'e dyn Experiment,
    /// The longest run of each rung.
    runs: BTreeMap<At, Measured>,
    /// What the question has seen of them.
    used: BTreeMap<At, Measured>,
    /// Moments of grids.
    moments: BTreeMap<(Grid, Within), Arc<Moments>>,
    /// Rungs over their whole way; nothing where one cannot be looked at.
    looks: BTreeMap<(At, Grid, Within), Option<Arc<Look>>>,
    /// What the question has seen of these.
    looked: BTreeSet<(At, Grid, Within)>,
    /// Rungs run on finer meshes.
    finer: BTreeMap<(usize, At), Measured>,
    /// Errors over the whole way, where they are larger than at the moments.
    ways: BTreeMap<At, f64>,
    effort: Effort,
    purpose: Purpose,
    deadline: Instant,
    most_work: u64,
}

impl fmt::Debug for MeasuredRuns<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (title, runs) = (&self.ladder().title, self.runs.len());
        f.debug_struct("MeasuredRuns")
            .field("title", title)
            .field("runs", &runs)
            .finish_non_exhaustive()
    }
}

impl<'e> MeasuredRuns<'e> {
    /// Nothing measured yet; choosing may take so much time.
    ///
    /// # Errors
    /// [`QuestionError`] for no time, and for a ladder that cannot be searched.
    pub fn new(experiment: &'e dyn Experiment, budget: Duration) -> Result<Self, QuestionError> {
        if budget.is_zero() {
            return Err(QuestionError::Budget(budget));
        }
        QuestionError::check(experiment.ladder())?;
        let start = Instant::now();
        // A budget that reaches beyond the clock is none.
        let deadline = start.checked_add(budget).unwrap_or(start + Duration::from_secs(1 << 30));
        Ok(MeasuredRuns {
            experiment,
            runs: BTreeMap::new(),
            used: BTreeMap::new(),
            moments: BTreeMap::new(),
            looks: BTreeMap::new(),
            looked: BTreeSet::new(),
            finer: BTreeMap::new(),
            ways: BTreeMap::new(),
            effort: Effort::default(),
            purpose: Purpose::Reference,
            deadline,
            most_work: u64::MAX,
        })
    }

    /// The same, where a question may spend so much counted work at most: a bound that is the same
    /// on every machine.
    pub fn bounded(self, most_work: u64) -> Self {
        MeasuredRuns { most_work, ..self }
    }

    /// The ladder.
    pub fn ladder(&self) -> &'e Ladder {
        self.experiment.ladder()
    }

    /// A family of the ladder.
    pub fn family(&self, family: usize) -> &'e Family {
        &self.ladder().families[family]
    }

    /// Forgets what was asked, not what was measured: the next question pays for its own runs
    /// again, in counted work, without running them again.
    pub fn forget(&mut self) {
        self.used.clear();
        self.looked.clear();
        self.ways.clear();
        self.effort = Effort::default();
    }

    /// The rung at the moments of a grid; nothing where it fails there or the budget is over.
    pub fn look(&mut self, at: At, grid: &Grid, within: Within) -> Option<Arc<Look>> {
        let moments = self.moments(grid, within)?;
        if let Some(own) = self.own(at, (grid, within), moments.times.len()) {
            return Some(own);
        }
        let key = (at, grid.clone(), within);
        if !self.looks.contains_key(&key) {
            let seen = self.experiment.look(at, &moments, self.deadline);
            // What has not all of the moments, or no numbers, has not been followed.
            let seen = seen.filter(|look| look.is_whole(moments.times.len()));
            self.looks.insert(key.clone(), seen.map(Arc::new));
        }
        let seen = self.looks[&key].clone();
        if self.looked.insert(key) {
            let known = self.used.get(&at).map_or(0, |run| run.work);
            self.spend(seen.as_ref().map_or(known, |look| look.work));
        }
        seen.filter(|_| self.spent() <= self.most_work)
    }

    /// What a run kept of all its own steps, which are so many moments.
    fn own(&self, at: At, (grid, within): (&Grid, Within), moments: usize) -> Option<Arc<Look>> {
        let run = self.used.get(&at).filter(|_| *grid == Grid::Accepted(at))?;
        let own = run.own.clone().filter(|_| within == Within::Parts)?;
        own.is_whole(moments).then_some(own)
    }

    /// The same, read off where the run's samples tell it to within so much of the observable, which
    /// costs nothing; and how far it may then be off.
    pub fn read(
        &mut self,
        at: At,
        (grid, within): (&Grid, Within),
        allowed: f64,
    ) -> Option<(Arc<Look>, f64)> {
        match self.read_off(at, (grid, within), allowed) {
            None => Some((self.look(at, grid, within)?, 0.0)),
            read => read,
        }
    }

    /// The same, where that costs nothing.
    pub fn read_off(
        &mut self,
        at: At,
        (grid, within): (&Grid, Within),
        allowed: f64,
    ) -> Option<(Arc<Look>, f64)> {
        let moments = self.moments(grid, within)?;
        let reading = self.used.get(&at)?.track.as_ref()?.read(&moments.times);
        (reading.off <= allowed).then(|| (Arc::new(reading.look), reading.off))
    }

    /// The moments of a grid, all or the ends of its steps; nothing where its run did not come to its end.
    pub fn moments(&mut self, grid: &Grid, within: Within) -> Option<Arc<Moments>> {
        let key = (grid.clone(), within);
        if !self.moments.contains_key(&key) {
            let horizon = self.ladder().horizon;
            let all = match grid {
                Grid::Equal { halvings } if self.ladder().is_joined => {
                    Moments::joined(*halvings, horizon)
                }
                Grid::Equal { halvings } => Moments::equal(*halvings, horizon),
                Grid::Closely { halvings } => Moments::closely(*halvings, horizon),
                Grid::Some { halvings, parts } => Moments::some(*halvings, parts, horizon),
                Grid::SomeClosely { halvings, parts } => {
                    Moments::some_closely(*halvings, parts, horizon)
                }
                Grid::Accepted(at) => {
                    let ends = self.used.get(at).filter(|run| run.end == End::Whole)?;
                    let ends = &ends.accepted;
                    Moments::accepted(ends.len(), ends.iter().copied())
                }
            };
            let moments = if within == Within::Ends { all.ends() } else { all };
            self.moments.insert(key.clone(), Arc::new(moments));
        }
        self.moments.get(&key).cloned()
    }

    /// Whether straight lines join the ends of a rung's steps.
    pub(crate) fn is_joined(&self, at: At) -> bool {
        self.ladder().is_joined && self.family(at.family).kind == Kind::EqualSteps
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
    pub fn attempt(&mut self, at: At, trial: &StopRule<'_>) -> &Measured {
        self.run(at, Some(trial))
    }

    fn run(&mut self, at: At, trial: Option<&StopRule<'_>>) -> &Measured {
        let enough = |seen: &Measured| seen.seen_by(trial).is_some();
        if !self.used.get(&at).is_some_and(enough) {
            let seen = self.runs.get(&at).and_then(|run| run.seen_by(trial));
            let seen = seen.unwrap_or_else(|| {
                let run = self.made(at, None, trial);
                self.runs.insert(at, run.clone());
                run
            });
            self.spend(seen.work);
            self.used.insert(at, seen);
        }
        &self.used[&at]
    }

    fn made(&self, at: At, finer: Option<usize>, trial: Option<&StopRule<'_>>) -> Measured {
        let start = Instant::now();
        let mut watch = Watch::new(trial, self.deadline);
        let record = self.experiment.run(at, finer, &mut watch);
        Measured::of(record, watch, start.elapsed(), self.ladder())
    }

    /// A rung run on a finer mesh, of at most so much work more; nothing where that is too little,
    /// or the budget is over.
    pub fn measure_finer(&mut self, finer: usize, at: At, most: u64) -> Option<&Measured> {
        let grown = self.ladder().finer.get(finer)?.work;
        if self.late() || self.predicted(at) as f64 * grown > most.min(self.left()) as f64 {
            return None;
        }
        let key = (finer, at);
        if !self.finer.contains_key(&key) {
            let run = self.made(at, Some(finer), None);
            self.finer.insert(key, run);
        }
        self.spend(self.finer[&key].work);
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
        self.effort.total()
    }

    /// The same, by what it was spent on.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Says what the next runs are for, and returns what the last ones were for.
    pub fn turn_to(&mut self, purpose: Purpose) -> Purpose {
        std::mem::replace(&mut self.purpose, purpose)
    }

    fn spend(&mut self, work: u64) {
        self.effort.add(self.purpose, work);
    }

    /// Whether the time is over, or the work that may be done.
    pub fn late(&self) -> bool {
        self.spent() >= self.most_work || Instant::now() >= self.deadline
    }

    /// Whether there is work left for a rung.
    pub fn affords(&self, at: At) -> bool {
        self.predicted(at) <= self.left()
    }

    /// Work that may still be spent.
    pub fn left(&self) -> u64 {
        self.most_work.saturating_sub(self.spent())
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
            Kind::Adaptive => 10_f64.powf(1.0 / f64::from(family.order + 1)),
            // The factor is made once; a few more vectors cost little beside it.
            Kind::Modes => 1.0,
        };
        let grown = run.expected() as f64 * f64::powi(ratio, at.rung as i32 - other.rung as i32);
        // The least of an adaptive method is a guess, which a run that is known replaces.
        if family.kind == Kind::Adaptive { grown as u64 } else { least.max(grown as u64) }
    }

    /// The least work of explicit steps of one's own choice that are stable: those of equal steps
    /// of the same model that were not are too long.
    fn least_stable(&self, like: &Family) -> u64 {
        if like.kind != Kind::Adaptive || like.evaluation != Evaluation::Explicit {
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
        // What holds constraints solves the same equations, whatever its order.
        let held = self.ladder().is_constrained;
        let alike = || {
            self.used().filter(|(at, run)| {
                let family = self.family(at.family);
                // The first of the moments has the work of the start in it.
                let is_telling = run.works.len() > 2 || family.evaluation == Evaluation::Implicit;
                run.expected() > 0
                    && is_telling
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
