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
//! Zeno: bounces lower than [`REST_HEIGHT`](crate::REST_HEIGHT) of the size of things are rest. What rests is
//! kept from closing, without restitution, while all else flies on to its own instant. Where not even that moves
//! without closing a gap, what is left of the step is a filtered one.

use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{Integrator, State, StepError, StormerVerlet};

use crate::error::check_time;
use crate::when::rest::Resting;
use crate::{ContactError, Impact, ImpactLaw, Inequality, InverseMass, Swept, When};

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

pub(super) type Seen<'a> = &'a mut dyn FnMut(GapImpulses<'_>);

/// Gaps below this part of the length that they are a difference of ([`Swept::sizes`]) are closed: rounding.
pub(super) const TOUCHING: f64 = 1e-14;
/// More impacts in a step are an error.
const IMPACTS: usize = 10_000;

/// Stormer-Verlet on a flat space, with impacts at gaps.
#[derive(Debug)]
pub struct Impacting<'s, M, P, K> {
    pub(super) system: &'s System<M, P>,
    pub(super) gaps: &'s Inequality<K>,
    pub(super) verlet: StormerVerlet<'s, M, P, Vec<f64>>,
    pub(super) mass: InverseMass,
    pub(super) restitution: f64,
    pub(super) law: ImpactLaw,
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
    /// [`ContactError::Step`] for `h`, and of Stormer-Verlet; [`ContactError::Size`];
    /// [`ContactError::TooManyImpacts`] at the instant;
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
        let gaps = self.gaps.gaps(state.t, &state.q);
        let touching: Vec<usize> = (0..gaps.len()).filter(|&gap| gaps[gap] <= 0.0).collect();
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
            let none = Resting::none();
            let way = self.way(state, left, &none)?;
            let bounds = self.bounds(state, &way);
            let Some(mut piece) = self.closing(state, way, &bounds, &none)? else {
                self.verlet.step(state, left)?;
                return Ok(report);
            };
            let (resting, arrives) = self.at_rest(state, left, &bounds.sizes)?;
            // What touches and comes on meets where it is, before anything moves.
            if !arrives {
                if !resting.gaps.is_empty() {
                    report.rested = true;
                    let way = self.way(state, left, &resting)?;
                    let Some(closing) = self.closing(state, way, &bounds, &resting)? else {
                        self.free_step(state, left, &resting, &bounds.sizes, seen)?;
                        return Ok(report);
                    };
                    piece = closing;
                }
                let free = self.instant(state, &piece, &bounds, &resting)?;
                if free <= 0.0 {
                    report.rested = true;
                    self.filtered(state, left, &mut report, seen)?;
                    return Ok(report);
                }
                self.free_step(state, free, &resting, &bounds.sizes, seen)?;
            }
            let touching = self.near(state, &bounds.sizes);
            if self.impact(state, &touching, seen)? {
                report.impacts += 1;
                report.last_impact = state.t;
            }
        }
        Err(ContactError::TooManyImpacts { bound: IMPACTS, time: start })
    }

    /// The smallest gaps on the straight way between two configurations.
    pub(super) fn lowest(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let way: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        self.gaps.lowest(from, Vector(&way))
    }

    /// The velocity that the potential gives in a step.
    pub(super) fn increment(&self, state: &State<Vec<f64>>, h: f64) -> Vector<Vec<f64>> {
        let mut differential = Covector(vec![0.0; self.system.dim()]);
        self.system.potential().add_differential(&state.q, differential.view_mut());
        differential.0.iter_mut().for_each(|dv| *dv *= -h);
        self.velocity(&differential)
    }

    /// An impact of gaps at a configuration.
    pub(super) fn impact_at(
        &self,
        state: &State<Vec<f64>>,
        gaps: &[usize],
        restitution: f64,
    ) -> Result<Impact, ContactError> {
        let rows = self.gaps.rows(state.t, &state.q, gaps);
        Impact::new(rows, &self.mass, vec![restitution; gaps.len()])
    }

    pub(super) fn velocity(&self, p: &Covector<Vec<f64>>) -> Vector<Vec<f64>> {
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
        let impact = self.impact_at(state, touching, self.restitution)?;
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

pub(super) fn sum(a: &Vector<Vec<f64>>, b: &Vector<Vec<f64>>) -> Vector<Vec<f64>> {
    let mut sum = a.clone();
    sum.add_scaled(1.0, b.view());
    sum
}
