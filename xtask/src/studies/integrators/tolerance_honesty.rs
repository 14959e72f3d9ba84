//! What a tolerance means: the error at the end against what was asked for.
//!
//! ```text
//! error at the end  ~  C tol A,      A = how far runs that start tol apart end apart, in units of tol
//! ```
//! `C` is the method's own. It is measured for every adaptive method on every problem.

use std::ops::ControlFlow;

use stationary_calculus::{Metric, Potential, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{
    Problem, StiffProblem, hires, kepler, oscillator, pendulum, pleiades, robertson, van_der_pol,
};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, DormandPrince54, DormandPrince853,
    MechanicalField, Moment, NystromMethod8, NystromMethod12, RadauIia5, StepControl, Tolerance,
    VectorField, integrate,
};
use stationary_measure::{Cell, Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// All adaptive methods on orbits, a pendulum and stiff reactions.
pub const STUDY: Entry<'static> = Entry {
    id: "tolerance-honesty",
    krate: "integrators",
    chapter: "4.3",
    kind: Kind::WorkPrecision,
    title: "Adaptive methods: error against the tolerance asked for",
    tested: Tested::ByReport,
    run: &study,
};

/// The methods, each with the exponent of the finest tolerance it is asked for.
const METHODS: [(Adaptive, i32); 7] = [
    (Adaptive::DormandPrince, 11),
    (Adaptive::DormandPrince54, 9),
    (Adaptive::Nystrom8, 11),
    (Adaptive::Nystrom12, 11),
    (Adaptive::Radau, 9),
    (Adaptive::BackwardDifferences(5), 8),
    (Adaptive::BackwardDifferences(2), 5),
];
/// The exponent of the coarsest tolerance.
const COARSEST: i32 = 2;
/// Steps that a run may try: an explicit method on a stiff problem takes more.
const MOST_STEPS: u64 = 30_000;
/// The error at the end in units of `tol A` that is still honest.
const HONEST: f64 = 100.0;
/// The same for the formulas of order 2, whose many steps add up.
const HONEST_AT_ORDER_2: f64 = 1_000.0;
/// Where `A tol` is above, errors are as large as the motion and say nothing of the tolerance.
const CHAOTIC: f64 = 0.01;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Adaptive {
    DormandPrince,
    DormandPrince54,
    Nystrom8,
    Nystrom12,
    Radau,
    BackwardDifferences(usize),
}

type Boxed<'f> = Box<dyn AdaptiveMethod<Vec<f64>> + 'f>;

impl Adaptive {
    fn on_field<'f, F: VectorField>(
        self,
        field: &'f F,
        control: StepControl,
        start: Moment<Vec<f64>>,
    ) -> Result<Boxed<'f>, AdaptiveError> {
        Ok(match self {
            Adaptive::Radau => Box::new(RadauIia5::new(field, control, start)?),
            Adaptive::BackwardDifferences(highest) => {
                Box::new(BackwardDifferences::of_order_at_most(highest, field, control, start)?)
            }
            Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field, control, start)?),
            _ => Box::new(DormandPrince853::new(field, control, start)?),
        })
    }

    fn on_system<'f, M: Metric, P: Potential>(
        self,
        (system, field): (&'f System<M, P>, &'f MechanicalField<'f, M, P>),
        control: StepControl,
        start: Moment<Vec<f64>>,
    ) -> Result<Boxed<'f>, AdaptiveError> {
        Ok(match self {
            Adaptive::Nystrom8 => Box::new(NystromMethod8::new(system, control, start)?),
            Adaptive::Nystrom12 => Box::new(NystromMethod12::new(system, control, start)?),
            _ => self.on_field(field, control, start)?,
        })
    }
}

/// What is collected of one method.
struct Measured {
    name: &'static str,
    bound: f64,
    /// The error in units of `tol A`.
    ratios: Vec<f64>,
}

struct Page {
    table: Table,
    charts: Vec<Lines>,
    methods: Vec<Option<Measured>>,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let at = StudyError::at;
    let mut page = Page {
        table: Table::new([
            Column::exact("problem"),
            Column::exact("method"),
            Column::rounded("tolerance", 2, 0.0),
            Column::rounded("A", 2, 0.0),
            Column::exact("evaluations"),
            Column::rounded("error at the end", 1, 1e-12),
            Column::rounded("in units of tol max(1, A)", 1, 1e-2),
        ]),
        charts: Vec::new(),
        methods: METHODS.iter().map(|_| None).collect(),
    };
    page.mechanics(&oscillator(1.0).map_err(at("an oscillator"))?, size)?;
    page.mechanics(&pendulum(2.0).map_err(at("a pendulum"))?, size)?;
    page.mechanics(&kepler(0.6).map_err(at("a planet"))?, size)?;
    page.mechanics(&kepler(0.95).map_err(at("a comet"))?, size)?;
    page.mechanics(&pleiades().map_err(at("stars"))?, size)?;
    page.stiff(&van_der_pol(1000.0).map_err(at("an oscillator"))?, size)?;
    page.stiff(&hires(), size)?;
    page.stiff(&robertson(), size)?;
    let claims = page.methods.iter().flatten().map(claim).collect();
    Ok(Study {
        conclusion:
            "The error at the end against the tolerance, the same for all components or in \
                     their own sizes. A tolerance holds the error of a step. The error at the end \
                     is what the flow makes of all of them: A says by how much it amplifies what \
                     is wrong at the start. The Nystrom pairs hold a tolerance above 1e-5 as 1e-5, \
                     DOP853, DOPRI5 and Radau one above 1e-4 as 1e-4, BDF one above 1e-3 as 1e-3. An \
                     explicit method on a stiff problem ends at its bound on the number of steps and \
                     says so."
                .into(),
        table: page.table,
        charts: page.charts.into_iter().map(Into::into).collect(),
        claims,
        ..STUDY.heading()
    })
}

fn claim(method: &Measured) -> Claim {
    let worst = method.ratios.iter().copied().fold(0.0, f64::max);
    let mut ratios = method.ratios.clone();
    ratios.sort_by(f64::total_cmp);
    let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
    let Measured { name, bound, .. } = method;
    Claim::number(
        format!(
            "{name}: the largest error at the end in units of tol max(1, A); the median of {} runs \
             is {median:.1e}",
            ratios.len()
        ),
        format!("below {bound}"),
        worst,
        (0.0, *bound),
    )
}

/// The part of its size by which each component of a start is moved to measure A.
const APART: f64 = 1e-7;

fn finest(exponent: i32, size: Size) -> i32 {
    match size {
        Size::Default => exponent - 1,
        Size::Full => exponent,
    }
}

/// How a method is made on a problem, from a moment.
type Make<'a, 'f> =
    dyn Fn(Adaptive, StepControl, Moment<Vec<f64>>) -> Result<Boxed<'f>, AdaptiveError> + 'a;

/// A problem of either kind.
struct Case<'a, 'f> {
    name: &'static str,
    start: Vec<f64>,
    sizes: Vec<f64>,
    end: f64,
    error: &'a dyn Fn(&[f64]) -> f64,
    make: &'a Make<'a, 'f>,
    /// The method of the runs that measure A.
    reference: Adaptive,
}

impl Case<'_, '_> {
    /// A run of a method from a start.
    fn run(&self, method: Adaptive, tolerance: f64, start: Vec<f64>) -> Result<Run, StudyError> {
        let absolute = self.sizes.iter().map(|size| tolerance * size).collect();
        let control = Tolerance::componentwise(tolerance, absolute).map(StepControl::from);
        let control = control.and_then(|control| control.most_steps(MOST_STEPS));
        let control = control.map_err(StudyError::at("a tolerance"))?;
        let method = (self.make)(method, control, Moment::new(0.0, start));
        let mut method = method.map_err(StudyError::at(self.name))?;
        let outcome = integrate(&mut *method, self.end, |_| ControlFlow::Continue(()));
        Ok(Run {
            name: method.facts().name,
            evaluations: method.work().evaluations,
            error: outcome.is_ok().then(|| (self.error)(&method.moment().y)),
        })
    }

    /// How far a run that starts `APART` from the problem's ends from the truth, in units of that.
    fn amplification(&self) -> Result<f64, StudyError> {
        let parts = self.start.iter().zip(&self.sizes).enumerate();
        let moved = parts.map(|(i, (y, size))| {
            let up = *y == 0.0 || i.is_multiple_of(3);
            y + APART * (size + y.abs()) * if up { 1.0 } else { -1.0 }
        });
        let run = self.run(self.reference, 1e-12, moved.collect())?;
        Ok(run.error.unwrap_or(f64::NAN) / APART)
    }

    fn has(&self, method: Adaptive) -> bool {
        let is_pair = matches!(method, Adaptive::Nystrom8 | Adaptive::Nystrom12);
        !is_pair || self.reference == Adaptive::Nystrom12
    }
}

/// What came of a run; no error where it was refused.
struct Run {
    name: &'static str,
    evaluations: u64,
    error: Option<f64>,
}

impl Page {
    fn mechanics<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: &Problem<M, P, [f64; N]>,
        size: Size,
    ) -> Result<(), StudyError> {
        let field = MechanicalField::new(&problem.system);
        let end = problem.horizon;
        let error = |y: &[f64]| {
            let q: [f64; N] = std::array::from_fn(|i| y[i]);
            problem.error(end, &q).unwrap_or(f64::NAN)
        };
        let make = |method: Adaptive, control, start| {
            method.on_system((&problem.system, &field), control, start)
        };
        let case = Case {
            name: problem.name,
            start: [problem.initial.q.as_slice(), problem.initial.p.components()].concat(),
            sizes: vec![1.0; 2 * N],
            end,
            error: &error,
            make: &make,
            reference: Adaptive::Nystrom12,
        };
        self.measure(&case, size)
    }

    fn stiff<F: VectorField, const N: usize>(
        &mut self,
        problem: &StiffProblem<F, N>,
        size: Size,
    ) -> Result<(), StudyError> {
        let error = |y: &[f64]| {
            let y: [f64; N] = std::array::from_fn(|i| y[i]);
            problem.error(&y).unwrap_or(f64::NAN)
        };
        let make =
            |method: Adaptive, control, start| method.on_field(&problem.field, control, start);
        let case = Case {
            name: problem.name,
            start: problem.initial.y.to_vec(),
            sizes: problem.scale.to_vec(),
            end: problem.end,
            error: &error,
            make: &make,
            reference: Adaptive::Radau,
        };
        self.measure(&case, size)
    }

    fn measure(&mut self, case: &Case<'_, '_>, size: Size) -> Result<(), StudyError> {
        let amplified = case.amplification()?;
        let axes = (Axis::log("tolerance", ""), Axis::log("error at the end", ""));
        let title = format!("{}, A = {amplified:.0}", case.name);
        let mut chart = Lines::new(&title, axes.0, axes.1);
        for (place, (method, exponent)) in METHODS.into_iter().enumerate() {
            if !case.has(method) {
                continue;
            }
            let mut points = Vec::new();
            let mut name = "";
            for digits in COARSEST..=finest(exponent, size) {
                let tolerance = 10.0_f64.powi(-digits);
                let run = case.run(method, tolerance, case.start.clone())?;
                name = run.name;
                let mut cells: Vec<Cell> = vec![case.name.into(), name.into(), tolerance.into()];
                cells.extend([amplified.into(), Cell::from(run.evaluations)]);
                if let Some(error) = run.error {
                    let ratio = error / (tolerance * amplified.max(1.0));
                    cells.extend([error.into(), ratio.into()]);
                    points.push((tolerance, error));
                    let measured = self.methods[place].get_or_insert(Measured::new(method, name));
                    if tolerance * amplified < CHAOTIC {
                        measured.ratios.push(ratio);
                    }
                } else {
                    cells.extend(["refused".into(), "-".into()]);
                }
                self.table.push(cells);
            }
            chart = chart.with(Series::new(name, points));
        }
        self.charts.push(chart);
        Ok(())
    }
}

impl Measured {
    fn new(method: Adaptive, name: &'static str) -> Self {
        let bound = match method {
            Adaptive::BackwardDifferences(2) => HONEST_AT_ORDER_2,
            _ => HONEST,
        };
        Measured { name, bound, ratios: Vec::new() }
    }
}
