//! Impacts in time: when is an impulse given?
//!
//! ```text
//! after overlap      step, then: g <= 0 and dg v < 0  ->  impact                         (11.4, 1)
//! at the instant     step to g = 0, impact, go on with what is left of the step          (11.4, 2)
//! velocity filter  v~ = v - h M^-1 dV,  if q + h v~ would overlap: impact, then q + h v  (11.4, 3)
//! ```
//! The first overlaps by up to h u, the third turns back before it touches: heights are off by
//! order h. The second hits the moment to rounding; a step of Stormer-Verlet in a uniform field is
//! the exact parabola, so the rebound of a ball is exact too.
//!
//! Zeno: bounces lower than [`REST_HEIGHT`] of the size of things are rest, and what is left of the step
//! is a filtered step, in which what rests has no restitution.
//!
//! The filter is a step of symplectic Euler. Its impact acts on the velocity before the step's own
//! increment, so that no bounce gains energy, and where all approach is of the order of an increment there is no
//! restitution, so that what rests does not rattle. What would still overlap ahead is held by the
//! projection with `dg v >= -g/h`: gaps are used up, not crossed; and where even that overlaps, bodies
//! stay where they were proved free. Paths are judged by the smallest gap on them, parabolas on chords that
//! are halved until they tell, so that nothing is passed through. Source: notes 10.3, 11.4.

use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{Integrator, State, StepError, StormerVerlet};

use crate::error::{check_finite, check_time};
use crate::impact::projection::project_biased;
use crate::{ContactError, Impact, ImpactLaw, Inequality, InverseMass, Swept};

/// When an impulse is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum When {
    /// At the end of a step at which things overlap.
    AfterOverlap,
    /// At the moment within the step at which they touch.
    AtTheInstant,
    /// Before a step that would make them overlap.
    VelocityFilter,
}

impl When {
    /// All three, in the order of the notes.
    pub const ALL: &'static [When] =
        &[When::AfterOverlap, When::AtTheInstant, When::VelocityFilter];

    /// Its name, lower case and with hyphens.
    pub fn name(self) -> &'static str {
        match self {
            When::AfterOverlap => "after-overlap",
            When::AtTheInstant => "at-the-instant",
            When::VelocityFilter => "velocity-filter",
        }
    }
}

/// What a step with impacts took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImpactingReport {
    /// Impacts in this step.
    pub impacts: usize,
    /// The time of the last of them, s.
    pub last_impact: f64,
    /// Whether bodies came to rest against each other in this step.
    pub rested: bool,
    /// Whether the step was refused: bodies stay where they were proved free.
    pub held: bool,
}

/// The impulses that a step gives at one moment.
#[derive(Clone, Copy, Debug)]
pub struct GapImpulses<'a> {
    /// The moment, s.
    pub time: f64,
    /// The configuration at which the gaps are looked at.
    pub q: &'a [f64],
    /// The gaps, in ascending order.
    pub gaps: &'a [usize],
    /// The impulse of each along its differential: momenta change by `sum impulse dg`.
    pub impulses: &'a [f64],
}

type Seen<'a> = &'a mut dyn FnMut(GapImpulses<'_>);

/// Bounces lower than this part of the largest coordinate (or of 1 m) are rest.
pub const REST_HEIGHT: f64 = 1e-12;
/// More impacts in a step are an error.
const IMPACTS: usize = 10_000;
/// Rounds in which the filter looks for contacts that its own impacts bring about.
const ROUNDS: usize = 100;
/// By how much a path may leave its chord more than in the middle: gaps are no straight functions of places.
const BEYOND: f64 = 1.5;
/// Halvings of the time of an impact: all digits of it.
const HALVINGS: usize = 70;

/// Stormer-Verlet on a flat space, with impacts at gaps.
#[derive(Debug)]
pub struct Impacting<'s, M, P, K> {
    system: &'s System<M, P>,
    gaps: &'s Inequality<K>,
    verlet: StormerVerlet<'s, M, P, Vec<f64>>,
    mass: InverseMass,
    restitution: f64,
    law: ImpactLaw,
    when: When,
}

impl<'s, M: Metric, P: Potential, K: Swept> Impacting<'s, M, P, K> {
    /// Impacts of one restitution at all gaps, by a law, at a time of choice.
    ///
    /// # Errors
    /// [`ContactError::Size`] where gaps and system have different freedoms;
    /// [`ContactError::Restitution`] outside of 0 to 1; [`ContactError::Mass`] where the metric is
    /// not positive definite.
    pub fn new(
        system: &'s System<M, P>,
        gaps: &'s Inequality<K>,
        restitution: f64,
        law: ImpactLaw,
        when: When,
    ) -> Result<Self, ContactError> {
        SizeError::check("the gaps' freedoms", system.dim(), gaps.0.dim())?;
        if !(0.0..=1.0).contains(&restitution) {
            return Err(ContactError::Restitution { contact: 0, value: restitution });
        }
        let verlet = StormerVerlet::new(system)?;
        let mass = InverseMass::of(system.metric())?;
        Ok(Impacting { system, gaps, verlet, mass, restitution, law, when })
    }

    /// Moves a state by `h` seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for `h`, and of Stormer-Verlet; [`ContactError::Size`]; [`ContactError::TooManyImpacts`] at the instant;
    /// those of [`Impact::new`] and [`ImpactLaw::apply`] for gaps that close;
    /// [`ContactError::NonFinite`] after a filtered step. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<ImpactingReport, ContactError> {
        self.step_seen(state, h, &mut |_| ())
    }

    /// The same step, shown the impulses that it gives; those of a step that fails are of no worth.
    ///
    /// # Errors
    /// Those of [`Impacting::step`].
    pub fn step_seen(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        seen: &mut dyn FnMut(GapImpulses<'_>),
    ) -> Result<ImpactingReport, ContactError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h).into());
        }
        SizeError::check("the configuration's numbers", self.system.dim(), state.q.len())?;
        SizeError::check("the momentum's components", self.system.dim(), state.p.0.len())?;
        check_time(state.t + h)?;
        let mut next = state.clone();
        let report = match self.when {
            When::AfterOverlap => self.after_overlap(&mut next, h, seen),
            When::AtTheInstant => self.at_the_instant(&mut next, h, seen),
            When::VelocityFilter => {
                let mut report = ImpactingReport::default();
                self.filtered(&mut next, h, &mut report, seen).map(|()| report)
            }
        }?;
        next.t = state.t + h;
        *state = next;
        Ok(report)
    }

    fn after_overlap(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        seen: Seen<'_>,
    ) -> Result<ImpactingReport, ContactError> {
        self.verlet.step(state, h)?;
        let touching = self.closed(state.t, &state.q, 0.0);
        let mut report = ImpactingReport::default();
        if self.impact(state, &touching, seen)? {
            report.impacts = 1;
            report.last_impact = state.t;
        }
        Ok(report)
    }

    fn at_the_instant(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        seen: Seen<'_>,
    ) -> Result<ImpactingReport, ContactError> {
        let mut report = ImpactingReport::default();
        let (end, start) = (state.t + h, state.t);
        for _ in 0..IMPACTS {
            let left = end - state.t;
            if left <= 0.0 {
                return Ok(report);
            }
            let Some(free) = self.free_time(state, left)? else {
                self.verlet.step(state, left)?;
                return Ok(report);
            };
            if !self.arrives(state, left) && self.bounces_low(state, free)? {
                report.rested = true;
                self.filtered(state, left, &mut report, seen)?;
                return Ok(report);
            }
            self.verlet.step(state, free)?;
            let touching = self.closed(state.t, &state.q, TOUCHING * size(&state.q));
            if self.impact(state, &touching, seen)? {
                report.impacts += 1;
                report.last_impact = state.t;
            }
        }
        Err(ContactError::TooManyImpacts { bound: IMPACTS, time: start })
    }

    /// Whether something that touches comes on faster than what holds it there would make it.
    fn arrives(&self, state: &State<Vec<f64>>, left: f64) -> bool {
        let touching = self.closed(state.t, &state.q, TOUCHING * size(&state.q));
        let rows = self.gaps.rows(state.t, &state.q, &touching);
        let (v, increment) = (self.velocity(&state.p), self.increment(state, left));
        let still = TOUCHING * size(&v.0);
        (0..rows.len()).any(|i| {
            let by_increment = rows.along(i, increment.view()).abs();
            rows.along(i, v.view()) < -(2.0 * by_increment).max(still)
        })
    }

    /// Whether gaps that are closed now hardly open until they close again, and no other closes.
    fn bounces_low(&mut self, state: &State<Vec<f64>>, free: f64) -> Result<bool, ContactError> {
        if free <= 0.0 {
            return Ok(true);
        }
        let low = REST_HEIGHT * size(&state.q);
        let touching = self.closed(state.t, &state.q, low);
        let mut middle = state.clone();
        self.verlet.step(&mut middle, 0.5 * free)?;
        let gaps = self.gaps.gaps(middle.t, &middle.q);
        let mut end = state.clone();
        self.verlet.step(&mut end, free)?;
        let arrives = |i: &usize| !touching.contains(i);
        if self.closed(end.t, &end.q, TOUCHING * size(&end.q)).iter().any(arrives) {
            return Ok(false);
        }
        Ok(!touching.is_empty() && touching.iter().all(|&i| gaps[i] <= low))
    }

    /// How long the state moves freely, if it does not all the time: no gap is negative then.
    fn free_time(
        &mut self,
        state: &State<Vec<f64>>,
        left: f64,
    ) -> Result<Option<f64>, ContactError> {
        let slack = TOUCHING * size(&state.q);
        let before = self.gaps.gaps(state.t, &state.q);
        // What touches moves together but for rounding, and what starts on the wrong side is free
        // while it does not sink.
        let least: Vec<f64> = before.iter().map(|g| g.min(-slack)).collect();
        let mut pieces = vec![[0.0, left]];
        while let Some([from, to]) = pieces.pop() {
            let middle = 0.5 * (from + to);
            let [start, halfway, end] =
                [self.place(state, from)?, self.place(state, middle)?, self.place(state, to)?];
            let lowest = self.lowest(&start, &end);
            let chord: Vec<f64> = start.iter().zip(&end).map(|(a, b)| 0.5 * (a + b)).collect();
            let [on_path, on_chord] =
                [&halfway, &chord].map(|q| self.gaps.gaps(state.t + middle, q));
            // How far the path leaves its chord: most in the middle.
            let off = |i: usize| BEYOND * (on_path[i] - on_chord[i]).abs();
            let near = |i: &usize| lowest[*i] - off(*i) < least[*i];
            if !(0..least.len()).any(|i| near(&i)) {
                continue;
            }
            if (0..least.len()).filter(near).any(|i| off(i) > slack) && from < middle && middle < to
            {
                pieces.extend([[middle, to], [from, middle]]);
                continue;
            }
            if !lowest.iter().zip(&least).any(|(g, least)| g < least) {
                continue;
            }
            let (mut free, mut closed) = (from, to);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (free + closed);
                let reached = self.place(state, middle)?;
                let lowest = self.lowest(&start, &reached);
                let overlaps = lowest.iter().zip(&least).any(|(g, least)| g < least);
                *(if overlaps { &mut closed } else { &mut free }) = middle;
            }
            return Ok(Some(free));
        }
        Ok(None)
    }

    /// Where a step of `s` seconds leads.
    fn place(&mut self, state: &State<Vec<f64>>, s: f64) -> Result<Vec<f64>, ContactError> {
        let mut moved = state.clone();
        if s > 0.0 {
            self.verlet.step(&mut moved, s)?;
        }
        Ok(moved.q)
    }

    /// The smallest gaps on the straight way between two configurations.
    fn lowest(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let way: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        self.gaps.lowest(from, Vector(&way))
    }

    /// One step of the velocity filter.
    fn filtered(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        report: &mut ImpactingReport,
        seen: Seen<'_>,
    ) -> Result<(), ContactError> {
        let mut before = self.velocity(&state.p);
        let increment = self.increment(state, h);
        let mut contacts = Vec::new();
        for _ in 0..ROUNDS {
            let ahead = self.ahead(state, h, &sum(&before, &increment));
            if ahead.is_empty() || !unite(&mut contacts, ahead) {
                break;
            }
            let rows = self.gaps.rows(state.t, &state.q, &contacts);
            // What rests passes an impact on with all its restitution.
            let bounces = |i: usize| {
                let by_increment = rows.along(i, increment.view()).abs();
                rows.along(i, before.view()).abs() > 2.0 * by_increment
            };
            let own = if (0..rows.len()).any(bounces) { self.restitution } else { 0.0 };
            let impact = Impact::new(rows.clone(), &self.mass, vec![own; rows.len()])?;
            let done = self.law.apply(&impact, before.view_mut())?;
            report.impacts += usize::from(done.passes > 0);
            report.last_impact = state.t;
            let (time, q, gaps) = (state.t, &state.q, &contacts);
            seen(GapImpulses { time, q, gaps, impulses: &done.impulses });
        }
        let mut v = sum(&before, &increment);
        let mut held = Vec::new();
        for _ in 0..ROUNDS {
            let ahead = self.ahead(state, h, &v);
            if ahead.is_empty() {
                break;
            }
            unite(&mut contacts, ahead);
            v = sum(&before, &increment);
            let gaps = self.gaps.gaps(state.t, &state.q);
            let bias: Vec<f64> = contacts.iter().map(|&i| gaps[i].max(0.0) / h).collect();
            let rows = self.gaps.rows(state.t, &state.q, &contacts);
            let impact = Impact::new(rows, &self.mass, vec![0.0; contacts.len()])?;
            held = project_biased(&impact, &bias, v.view_mut())?.impulses;
        }
        if !held.is_empty() {
            let (time, q, gaps) = (state.t, &state.q, &contacts);
            seen(GapImpulses { time, q, gaps, impulses: &held });
        }
        self.system.metric().flat(v.view(), state.p.view_mut());
        report.held = !self.ahead(state, h, &v).is_empty();
        if !report.held {
            Vector(&mut state.q[..]).add_scaled(h, v.view());
        }
        check_finite("the configuration", &state.q)
    }

    /// The velocity that the potential gives in a step.
    fn increment(&self, state: &State<Vec<f64>>, h: f64) -> Vector<Vec<f64>> {
        let mut differential = Covector(vec![0.0; self.system.dim()]);
        self.system.potential().add_differential(&state.q, differential.view_mut());
        differential.0.iter_mut().for_each(|dv| *dv *= -h);
        self.velocity(&differential)
    }

    /// The gaps that a step along v would close.
    fn ahead(&self, state: &State<Vec<f64>>, h: f64, v: &Vector<Vec<f64>>) -> Vec<usize> {
        let way: Vec<f64> = v.0.iter().map(|v| h * v).collect();
        let now = self.gaps.gaps(state.t, &state.q);
        let lowest = self.gaps.lowest(&state.q, Vector(&way));
        let farthest = state.q.iter().zip(&way).fold(1.0_f64, |m, (q, d)| m.max((q + d).abs()));
        let slack = TOUCHING * farthest;
        (0..now.len()).filter(|&i| lowest[i] < now[i].min(0.0) - slack).collect()
    }

    fn closed(&self, t: f64, q: &[f64], slack: f64) -> Vec<usize> {
        let gaps = self.gaps.gaps(t, q);
        (0..gaps.len()).filter(|&i| gaps[i] <= slack).collect()
    }

    fn velocity(&self, p: &Covector<Vec<f64>>) -> Vector<Vec<f64>> {
        let mut v = Vector(vec![0.0; self.system.dim()]);
        self.system.metric().sharp(p.view(), v.view_mut());
        v
    }

    /// Gives touching contacts their impulses; says whether any approached.
    fn impact(
        &self,
        state: &mut State<Vec<f64>>,
        touching: &[usize],
        seen: Seen<'_>,
    ) -> Result<bool, ContactError> {
        let rows = self.gaps.rows(state.t, &state.q, touching);
        let impact = Impact::new(rows, &self.mass, vec![self.restitution; touching.len()])?;
        let mut v = self.velocity(&state.p);
        let report = self.law.apply(&impact, v.view_mut())?;
        if report.passes > 0 {
            self.system.metric().flat(v.view(), state.p.view_mut());
            let (time, q, impulses) = (state.t, &state.q, &report.impulses);
            seen(GapImpulses { time, q, gaps: touching, impulses });
        }
        Ok(report.passes > 0)
    }
}

/// Gaps below this part of the largest coordinate are closed: rounding.
const TOUCHING: f64 = 1e-14;

fn sum(a: &Vector<Vec<f64>>, b: &Vector<Vec<f64>>) -> Vector<Vec<f64>> {
    let mut sum = a.clone();
    sum.add_scaled(1.0, b.view());
    sum
}

/// Adds to a sorted list what is not in it; says whether anything was.
fn unite(list: &mut Vec<usize>, more: Vec<usize>) -> bool {
    let before = list.len();
    list.extend(more);
    list.sort_unstable();
    list.dedup();
    list.len() > before
}

fn size(q: &[f64]) -> f64 {
    q.iter().fold(1.0_f64, |size, x| size.max(x.abs()))
}
