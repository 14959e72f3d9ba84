//! The flow of a first-order field, by every method that chooses its own steps.
//!
//! ```text
//! M y' = f(t, y),   y(t0) = y0,   t0 <= t <= t0 + T
//! ```
//! `y` the state (n), `T` the horizon. Nothing is known to be kept, so another kind of method must come
//! to the same.

use std::fmt;
use std::time::Instant;

use stationary_integrators::{
    BackwardDifferences, DormandPrince54, DormandPrince853, FirstOrderFacts, Moment, RadauIia5,
    StepControl, Tolerance, VectorField,
};

use crate::dense_output::{self, NoStart, Own};
use crate::error::QuestionError;
use crate::experiment::{Experiment, Record};
use crate::grid::Moments;
use crate::ladder::{At, Family, Kind, Ladder, Scale, adaptive_steps, work_of_step};
use crate::look::Look;
use crate::motion::{FEW, PLACES, check, check_horizon, check_observed, largest};
use crate::samples::Samples;
use crate::watch::Watch;

/// A component below this part of the largest at the start matters no more, unless it is said to.
const LEAST: f64 = 1e-3;

/// The flow of a field from a moment, and what is observed of it.
pub struct Flow<F, O> {
    field: F,
    start: Moment<Vec<f64>>,
    observe: O,
    methods: Vec<Adaptive>,
    least: f64,
    ladder: Ladder,
}

/// A method that chooses its own steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Adaptive {
    DormandPrince853,
    DormandPrince54,
    RadauIia5,
    BackwardDifferences,
}

const ALL: [Adaptive; 4] = [
    Adaptive::DormandPrince853,
    Adaptive::DormandPrince54,
    Adaptive::RadauIia5,
    Adaptive::BackwardDifferences,
];

impl<F, O> fmt::Debug for Flow<F, O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Flow").field("ladder", &self.ladder).finish_non_exhaustive()
    }
}

impl<F: VectorField, O: Fn(&Moment<Vec<f64>>) -> Vec<f64>> Flow<F, O> {
    /// The flow from a moment over `horizon` seconds. Errors of what is observed are relative to its largest
    /// way from the start, unless said otherwise. Methods that solve equations are for at most 64
    /// unknowns; a mass matrix is for them alone.
    ///
    /// # Errors
    /// [`QuestionError`] for a start of another size, for numbers that are not finite, and for a horizon that
    /// is not positive; where no method takes the field.
    pub fn new(
        field: F,
        start: Moment<Vec<f64>>,
        horizon: f64,
        observe: O,
    ) -> Result<Self, QuestionError> {
        let n = field.dim();
        check_horizon(horizon)?;
        check("the time", &[start.t], 1)?;
        check("the state", &start.y, n)?;
        check_observed(&observe(&start))?;
        let methods = ALL.into_iter().filter(|method| match method {
            Adaptive::DormandPrince853 | Adaptive::DormandPrince54 => field.mass().is_none(),
            _ => n <= FEW,
        });
        let methods: Vec<Adaptive> = methods.collect();
        let families = methods.iter().map(|method| method.family(n)).collect();
        let ladder = Ladder {
            title: "the flow".to_owned(),
            observable: "the observable".to_owned(),
            scale: Scale::Way,
            horizon,
            time: "s".to_owned(),
            keeps_energy: false,
            is_smooth: false,
            is_joined: false,
            placed: (0..n.min(PLACES)).map(|k| format!("y[{k}]")).collect(),
            is_constrained: false,
            asks: None,
            families,
            finer: Vec::new(),
        };
        QuestionError::check(&ladder)?;
        let least = LEAST * largest(&start.y);
        Ok(Flow { field, start, observe, methods, least, ladder })
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

    /// Components matter down to this size, as those of a reaction that are far smaller than others.
    #[must_use]
    pub fn down_to(self, least: f64) -> Self {
        Flow { least, ..self }
    }

    fn method(&self, at: At) -> Result<Own<'_>, NoStart> {
        let tolerance = self.ladder.families[at.family].rungs[at.rung].setting;
        let least = if self.least > 0.0 { self.least } else { 1.0 };
        let control = StepControl::from(Tolerance::new(tolerance, tolerance * least)?);
        let (field, start) = (&self.field, self.start.clone());
        Ok(match self.methods[at.family] {
            Adaptive::DormandPrince853 => Box::new(DormandPrince853::new(field, control, start)?),
            Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field, control, start)?),
            Adaptive::RadauIia5 => Box::new(RadauIia5::new(field, control, start)?),
            Adaptive::BackwardDifferences => {
                Box::new(BackwardDifferences::new(field, control, start)?)
            }
        })
    }

    fn see(&self, samples: &mut Samples, t: f64, y: &[f64]) {
        let observed = (self.observe)(&Moment::new(t, y.to_vec()));
        samples.push(&observed, None, &y[..y.len().min(PLACES)]);
    }
}

impl Adaptive {
    fn family(self, n: usize) -> Family {
        let name = match self {
            Adaptive::DormandPrince853 => "dormand-prince-853",
            Adaptive::DormandPrince54 => "dormand-prince-54",
            Adaptive::RadauIia5 => "radau-iia-5",
            Adaptive::BackwardDifferences => "bdf-5",
        };
        let facts = FirstOrderFacts::all().into_iter().find(|facts| facts.name == name);
        own_family(&facts.unwrap_or(FirstOrderFacts::all()[0]), n)
    }
}

/// The family of a method that chooses its own steps, of n unknowns.
pub fn own_family(facts: &FirstOrderFacts, n: usize) -> Family {
    let step = work_of_step(facts.evaluation, facts.stages.into(), n as u64);
    Family {
        name: facts.name.to_owned(),
        model: 0,
        simplicity: 0,
        on_mesh: false,
        kind: Kind::Adaptive,
        order: facts.order,
        evaluation: facts.evaluation,
        holds_constraints: false,
        is_closed: false,
        rungs: adaptive_steps(facts.loosest, step).collect(),
    }
}

impl<F: VectorField, O: Fn(&Moment<Vec<f64>>) -> Vec<f64>> Experiment for Flow<F, O> {
    fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn run(&self, at: At, _: Option<usize>, watch: &mut Watch<'_>) -> Record {
        let method = match self.method(at) {
            Ok(method) => method,
            Err(error) => return dense_output::refused(&error),
        };
        let (horizon, hessian) = (self.ladder.horizon, self.field.dim() as u64);
        let see = |samples: &mut Samples, t: f64, y: &[f64]| self.see(samples, t, y);
        let mut record = dense_output::run(method, horizon, hessian, &see, watch);
        record.size = record.samples.largest_observed();
        record
    }

    fn look(&self, at: At, moments: &Moments, deadline: Instant) -> Option<Look> {
        let (horizon, hessian) = (self.ladder.horizon, self.field.dim() as u64);
        let see = |samples: &mut Samples, t: f64, y: &[f64]| self.see(samples, t, y);
        let how: (dense_output::See<'_>, &Moments, Instant) = (&see, moments, deadline);
        dense_output::look(self.method(at).ok()?, horizon, hessian, how)
    }
}
