//! The motion of a system, by every method that a system alone makes.
//!
//! ```text
//! q. = M^-1 p,   p. = -dV(q),   (q, p)(0) = (q0, p0),   0 <= t <= T
//! ```
//! `M` the metric, `V` the potential, `T` the horizon. Equal steps of all methods of [`Method::ALL`], and
//! steps of their own choice by Dormand and Prince's pair, both Nystrom pairs, Radau's method and backward
//! differences. A true motion keeps its energy, and so must what choices are judged by.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

use stationary_calculus::{Covector, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{
    AdaptiveError, BackwardDifferences, ControlError, Cost, DormandPrince54, DormandPrince853,
    Evaluation, Horizon, Integrator, MechanicalField, Method, Moment, NystromMethod8,
    NystromMethod12, RadauIia5, SimulationError, State, StepControl, StepError, Tolerance,
    simulate,
};

use crate::dense_output::{self, NoStart, Own, See};
use crate::error::QuestionError;
use crate::experiment::{Experiment, Record};
use crate::flow::own_family;
use crate::grid::{Moments, inside, is_at};
use crate::ladder::{At, Family, Kind, Ladder, MOMENTS, Scale, equal_steps, samples, work_of_step};
use crate::look::Look;
use crate::measured::{Failure, counted};
use crate::samples::{Energies, Samples};
use crate::watch::Watch;

/// Freedoms up to which methods that solve equations are tried: their matrices are full.
pub const FEW: usize = 64;
/// Numbers that are compared beside the observable.
pub const PLACES: usize = 6;
/// Steps between two looks at the clock.
const CLOCK: u64 = 256;
/// The smallest size of which every tolerance is a part that has a number.
const SMALLEST: f64 = 1e-290;

/// The motion of a system from a state, and what is observed of it.
pub struct Motion<'s, M, P, O> {
    system: &'s System<M, P>,
    start: State<Vec<f64>>,
    observe: O,
    ways: Vec<Way>,
    /// The absolute tolerance of each number of (q, p), over the relative one.
    sizes: Vec<f64>,
    ladder: Ladder,
}

/// How a family steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Equal(Method),
    Own(Adaptive),
}

/// A method that chooses its own steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Adaptive {
    DormandPrince853,
    DormandPrince54,
    Nystrom8,
    Nystrom12,
    RadauIia5,
    BackwardDifferences,
}

const ADAPTIVE: [Adaptive; 6] = [
    Adaptive::DormandPrince853,
    Adaptive::DormandPrince54,
    Adaptive::Nystrom8,
    Adaptive::Nystrom12,
    Adaptive::RadauIia5,
    Adaptive::BackwardDifferences,
];

impl<M, P, O> fmt::Debug for Motion<'_, M, P, O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Motion").field("ladder", &self.ladder).finish_non_exhaustive()
    }
}

impl<'s, M, P, O> Motion<'s, M, P, O>
where
    M: Metric,
    P: Potential,
    O: Fn(&State<Vec<f64>>) -> Vec<f64>,
{
    /// The motion from a state over `horizon` seconds. Errors of what is observed are relative to its
    /// largest way from the start, unless said otherwise. Methods that solve equations are for at most
    /// 64 freedoms.
    ///
    /// # Errors
    /// [`QuestionError`] for a start of another size, for numbers that are not finite there, dV among
    /// them, and for a horizon that is not positive.
    pub fn new(
        system: &'s System<M, P>,
        start: State<Vec<f64>>,
        horizon: f64,
        observe: O,
    ) -> Result<Self, QuestionError> {
        let n = system.dim();
        check_horizon(horizon)?;
        check("the configuration", &start.q, n)?;
        check("the momentum", start.p.components(), n)?;
        check("the time", &[start.t], 1)?;
        check_observed(&observe(&start))?;
        check("the energy", &[system.energy(&start.q, start.p.view())], 1)?;
        let sizes = sizes(system, &start, horizon)?;
        let mut motion = Motion {
            system,
            start,
            observe,
            ways: Vec::new(),
            sizes,
            ladder: Ladder {
                title: "the motion".to_owned(),
                observable: "the observable".to_owned(),
                scale: Scale::Way,
                horizon,
                time: "s".to_owned(),
                keeps_energy: true,
                is_smooth: true,
                is_joined: false,
                placed: (0..n.min(PLACES)).map(|k| format!("q[{k}]")).collect(),
                is_constrained: false,
                asks: None,
                families: Vec::new(),
                finer: Vec::new(),
            },
        };
        motion.add_families()?;
        Ok(motion)
    }

    /// With other headings.
    #[must_use]
    pub fn named(mut self, title: &str, observable: &str) -> Self {
        (self.ladder.title, self.ladder.observable) = (title.to_owned(), observable.to_owned());
        self
    }

    /// Errors are relative to the observable's largest value.
    #[must_use]
    pub fn relative_to_largest(mut self) -> Self {
        self.ladder.scale = Scale::Largest;
        self
    }

    /// Errors are relative to the largest kinetic energy: of energies, which hardly move.
    #[must_use]
    pub fn relative_to_kinetic_energy(mut self) -> Self {
        self.ladder.scale = Scale::Kinetic;
        self
    }

    fn add_families(&mut self) -> Result<(), QuestionError> {
        let n = self.system.dim();
        for &method in Method::ALL {
            let facts = method.facts();
            if facts.evaluation == Evaluation::Implicit && n > FEW {
                continue;
            }
            let step = work_of_step(facts.evaluation, facts.stages.into(), n as u64);
            self.ladder.families.push(Family {
                name: facts.name.to_owned(),
                model: 0,
                simplicity: 0,
                on_mesh: false,
                kind: Kind::EqualSteps,
                order: facts.order,
                evaluation: facts.evaluation,
                holds_constraints: false,
                is_closed: false,
                rungs: equal_steps(self.ladder.horizon, 0, step).collect(),
            });
            self.ways.push(Way::Equal(method));
        }
        for method in ADAPTIVE {
            let made = self.adaptive(method, 0.1);
            let facts = made.map_err(|error| not_begun(&error, n))?.facts();
            if facts.evaluation == Evaluation::Implicit && n > FEW {
                continue;
            }
            self.ladder.families.push(own_family(&facts, n));
            self.ways.push(Way::Own(method));
        }
        Ok(())
    }

    fn adaptive(&self, method: Adaptive, tolerance: f64) -> Result<Own<'_>, NoStart> {
        let absolute = self.sizes.iter().map(|size| tolerance * size).collect();
        let control = StepControl::from(Tolerance::componentwise(tolerance, absolute)?);
        let y = self.start.q.iter().chain(self.start.p.components()).copied().collect();
        let start = Moment::new(self.start.t, y);
        let (system, field) = (self.system, MechanicalField::new(self.system));
        Ok(match method {
            Adaptive::DormandPrince853 => Box::new(DormandPrince853::new(field, control, start)?),
            Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field, control, start)?),
            Adaptive::Nystrom8 => Box::new(NystromMethod8::new(system, control, start)?),
            Adaptive::Nystrom12 => Box::new(NystromMethod12::new(system, control, start)?),
            Adaptive::RadauIia5 => Box::new(RadauIia5::new(field, control, start)?),
            Adaptive::BackwardDifferences => {
                Box::new(BackwardDifferences::new(field, control, start)?)
            }
        })
    }

    /// Adds what is seen of a state.
    fn see(&self, samples: &mut Samples, state: &State<Vec<f64>>) {
        let total = self.system.energy(&state.q, state.p.view());
        let kinetic = total - self.system.potential().energy(&state.q);
        let places = &state.q[..state.q.len().min(PLACES)];
        samples.push(&(self.observe)(state), Some(Energies { total, kinetic }), places);
    }

    /// The same of the numbers (q, p).
    fn see_numbers(&self, samples: &mut Samples, t: f64, y: &[f64]) {
        let (q, p) = y.split_at(self.system.dim());
        let mut state = State::new(q.to_vec(), Covector(p.to_vec()));
        state.t = t;
        self.see(samples, &state);
    }

    fn setting(&self, at: At) -> f64 {
        self.ladder.families[at.family].rungs[at.rung].setting
    }

    fn hessian(&self) -> u64 {
        self.system.dim() as u64
    }

    fn run_equal(&self, method: Method, rung: usize, watch: &mut Watch<'_>) -> Record {
        let steps = MOMENTS << rung;
        let a_moment = steps / MOMENTS;
        let a_sample = (a_moment / samples(self.system.dim())).max(1);
        let each = (a_moment / a_sample) as usize;
        let mut record = Record { each, is_smooth: true, ..Record::default() };
        let made = method.integrator(self.system);
        let horizon = Horizon::divided(self.ladder.horizon, steps);
        let (Ok(mut integrator), Ok(horizon)) = (made, horizon) else {
            record.failure = Some(Failure::NotConverged("its steps cannot be made".to_owned()));
            return record;
        };
        let mut state = self.start.clone();
        self.see(&mut record.samples, &state);
        let mut cost = Cost::default();
        let horizon = horizon.starting(self.start.t);
        let run = simulate(&mut integrator, &mut state, horizon, |now| {
            cost.add(now.report);
            watch.stepped()?;
            if now.step.is_multiple_of(a_sample) {
                self.see(&mut record.samples, now.state);
            }
            if now.step.is_multiple_of(a_moment) {
                let observed = record.samples.observed(record.samples.len() - 1);
                watch.moment(observed, counted(cost, self.hessian()))?;
            }
            ControlFlow::Continue(())
        });
        record.work = counted(cost, self.hessian());
        record.failure = run.err().map(|error| failure(&error));
        record
    }

    fn look_equal(
        &self,
        method: Method,
        rung: usize,
        (moments, deadline): (&Moments, Instant),
    ) -> Option<Look> {
        let steps = MOMENTS << rung;
        let h = self.ladder.horizon / steps as f64;
        let make = || method.integrator::<M, P, Vec<f64>>(self.system).ok();
        let (mut integrator, mut within) = (make()?, make()?);
        let mut state = self.start.clone();
        let (mut part, mut samples) = (state.clone(), Samples::default());
        self.see(&mut samples, &state);
        let (mut cost, mut taken, mut next) = (Cost::default(), 0_u64, 0);
        let times = &moments.times;
        for step in 0..steps {
            let (from, end) = (step as f64 * h, (step + 1) as f64 * h);
            for theta in inside(&times[next..], from, h) {
                within.load(&integrator.save()).ok()?;
                part.clone_from(&state);
                within.step(&mut part, theta * h).ok()?;
                self.see(&mut samples, &part);
                (taken, next) = (taken + 1, next + 1);
            }
            cost.add(&integrator.step(&mut state, h).ok()?);
            if times.get(next).is_some_and(|&t| is_at(t, end, h)) {
                self.see(&mut samples, &state);
                next += 1;
            }
            if step.is_multiple_of(CLOCK) && Instant::now() >= deadline {
                return None;
            }
        }
        let own = counted(cost, self.hessian()) as f64;
        Some(Look::of(&samples, (own * (1.0 + taken as f64 / steps as f64)) as u64))
    }
}

impl<M, P, O> Experiment for Motion<'_, M, P, O>
where
    M: Metric,
    P: Potential,
    O: Fn(&State<Vec<f64>>) -> Vec<f64>,
{
    fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn run(&self, at: At, _: Option<usize>, watch: &mut Watch<'_>) -> Record {
        let mut record = match self.ways[at.family] {
            Way::Equal(method) => self.run_equal(method, at.rung, watch),
            Way::Own(method) => match self.adaptive(method, self.setting(at)) {
                Ok(method) => {
                    let see = |s: &mut Samples, t: f64, y: &[f64]| self.see_numbers(s, t, y);
                    let (horizon, hessian) = (self.ladder.horizon, self.hessian());
                    dense_output::run(method, horizon, hessian, &see, watch)
                }
                Err(error) => dense_output::refused(&error),
            },
        };
        record.size = record.samples.largest_observed();
        record
    }

    fn look(&self, at: At, moments: &Moments, deadline: Instant) -> Option<Look> {
        match self.ways[at.family] {
            Way::Equal(method) => self.look_equal(method, at.rung, (moments, deadline)),
            Way::Own(method) => {
                let method = self.adaptive(method, self.setting(at)).ok()?;
                let see = |s: &mut Samples, t: f64, y: &[f64]| self.see_numbers(s, t, y);
                let how: (See<'_>, &Moments, Instant) = (&see, moments, deadline);
                dense_output::look(method, self.ladder.horizon, self.hessian(), how)
            }
        }
    }
}

/// Why a method of n freedoms does not begin: it counts configurations first, then momenta.
fn not_begun(error: &NoStart, n: usize) -> QuestionError {
    let of_one = |whats: [&'static str; 2], place: usize| {
        let (what, place) = match place.checked_sub(n) {
            Some(place) => (whats[1], place),
            None => (whats[0], place),
        };
        QuestionError::NotFinite { what, place }
    };
    match error {
        NoStart::Start(AdaptiveError::NonFinite { what: "f", component, .. }) => {
            of_one(["the velocity", "dV"], *component)
        }
        NoStart::Start(AdaptiveError::NonFinite { what, component, .. }) => {
            QuestionError::NotFinite { what, place: *component }
        }
        NoStart::Tolerance(ControlError::Absolute { component, .. }) => {
            of_one(["the size of the configuration", "the size of the momentum"], *component)
        }
        // Sizes, orders and tolerances are this file's own.
        NoStart::Start(_) | NoStart::Tolerance(_) => {
            QuestionError::NotFinite { what: "the start", place: 0 }
        }
    }
}

fn failure(error: &SimulationError) -> Failure {
    let said = error.to_string();
    let said = said.lines().next().unwrap_or_default().to_owned();
    match error.source {
        StepError::NonFiniteConfiguration { .. } | StepError::NonFiniteMomentum { .. } => {
            Failure::Unstable(said)
        }
        _ => Failure::NotConverged(said),
    }
}

/// An error unless a horizon is one.
pub fn check_horizon(horizon: f64) -> Result<(), QuestionError> {
    let positive = horizon > 0.0 && horizon.is_finite();
    if positive { Ok(()) } else { Err(QuestionError::Horizon(horizon)) }
}

/// What is observed at the start, checked.
pub fn check_observed(observed: &[f64]) -> Result<(), QuestionError> {
    if observed.is_empty() {
        return Err(QuestionError::NothingObserved);
    }
    check("the observable", observed, observed.len())
}

/// An error unless there are so many numbers, and all are finite.
pub fn check(what: &'static str, numbers: &[f64], n: usize) -> Result<(), QuestionError> {
    SizeError::check(what, n, numbers.len())?;
    match numbers.iter().position(|x| !x.is_finite()) {
        Some(place) => Err(QuestionError::NotFinite { what, place }),
        None => Ok(()),
    }
}

/// The largest magnitude.
pub fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

/// How large each number of (q, p) is: configurations as at the start, or as far as they get from there
/// by what moves them; momenta by the fastest of them.
fn sizes<M: Metric, P: Potential>(
    system: &System<M, P>,
    start: &State<Vec<f64>>,
    horizon: f64,
) -> Result<Vec<f64>, QuestionError> {
    let n = system.dim();
    let sharp = |p: &[f64]| {
        let mut v = vec![0.0; n];
        system.metric().sharp(Covector(p), Vector(v.as_mut_slice()));
        largest(&v)
    };
    let mut dv = vec![0.0; n];
    system.potential().add_differential(&start.q, Covector(dv.as_mut_slice()));
    check("dV", &dv, n)?;
    let (speed, acceleration) = (sharp(start.p.components()), sharp(&dv));
    let positive = |x: &f64| *x > SMALLEST && x.is_finite();
    let lengths = [largest(&start.q), speed * horizon, acceleration * horizon * horizon, 1.0];
    let length = lengths.into_iter().find(positive).unwrap_or(1.0);
    let speed = [speed.max(length / horizon)].into_iter().find(positive).unwrap_or(1.0);
    let mut p = vec![0.0; n];
    system.metric().flat(Vector(vec![speed; n].as_slice()), Covector(p.as_mut_slice()));
    let heaviest = [largest(&p)].into_iter().find(positive).unwrap_or(1.0);
    let momentum = |p: &f64| if positive(&p.abs()) { p.abs() } else { heaviest };
    Ok(std::iter::repeat_n(length, n).chain(p.iter().map(momentum)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_that_does_not_begin_names_the_number_that_is_wrong() {
        let start =
            |what, component| NoStart::Start(AdaptiveError::NonFinite { what, t: 0.0, component });
        let size = NoStart::Tolerance(ControlError::Absolute { component: 4, value: 0.0 });
        for (error, what, place) in [
            (start("f", 1), "the velocity", 1),
            (start("f", 3), "dV", 1),
            (start("dV", 1), "dV", 1),
            (size, "the size of the momentum", 2),
        ] {
            assert_eq!(not_begun(&error, 2), QuestionError::NotFinite { what, place });
        }
    }
}
