//! What the digits of an orbit cost: steps of equal length against steps of the method's own choice.
//!
//! Three motions: a planet that comes close to its sun, seven stars that come close to each other,
//! and a star that meets nothing. The error is the distance from the truth at the end.

use std::hint::black_box;
use std::ops::ControlFlow;

use stationary_calculus::{Metric, Potential};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{Problem, henon_heiles, kepler, pleiades};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Horizon, MechanicalField, Method, Moment, Nystrom, Nystrom8,
    Nystrom12, NystromPair, Pair8, Pair12, State, Tolerance, integrate, simulate,
};
use stationary_measure::{Cell, Column, Table};

use crate::studies::cheapest::{Asked, cost_at};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// Kepler's problem at e = 0.9, the Pleiades, and Henon and Heiles' star.
pub const WORK_PRECISION: Entry<'static> = Entry {
    id: "orbits-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Close encounters: error against cost, with equal and with adaptive steps",
    tested: Tested::ByReport,
    run: &study,
};

/// The method for any first-order field, by which the others are measured.
const ANY_FIELD: &str = "dormand-prince-853";
/// Errors for which the cheapest method is named.
const TARGETS: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// The cheapest method by counted work at each of them.
const EXPECTED: [(&str, [&str; 3]); 3] = [
    ("kepler", [Pair8::NAME, Pair12::NAME, Pair12::NAME]),
    ("pleiades", [Pair8::NAME, Pair8::NAME, Pair12::NAME]),
    ("henon-heiles", [ANY_FIELD, Pair12::NAME, Pair12::NAME]),
];
/// Methods with steps of equal length, and the logarithms of their fewest and most steps.
const FIXED: [(Method, u32, u32); 3] = [
    (Method::StormerVerlet, 9, 16),
    (Method::RungeKutta4, 9, 16),
    (Method::ImplicitMidpoint, 8, 12),
];
/// More halvings of the step at full size.
const FULL: u32 = 3;
/// The energy of the star: almost every orbit is regular.
const ENERGY: f64 = 1.0 / 12.0;

type Small<M, P, const N: usize> = Problem<M, P, [f64; N]>;

/// The table and the charts of all problems while they are filled.
struct Page {
    table: Table,
    charts: Vec<Lines>,
    claims: Vec<Claim>,
}

/// One method on one problem: its points by count and by time.
struct Runs {
    counted: Series,
    timed: Series,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let mut page = Page { table: columns(), charts: Vec::new(), claims: Vec::new() };
    let at = StudyError::at;
    page.measure(&kepler(0.9).map_err(at("the planet"))?, size)?;
    page.measure(&pleiades().map_err(at("the stars"))?, size)?;
    page.measure(&with_reference(henon_heiles(ENERGY).map_err(at("the star"))?)?, size)?;
    let asked = Asked {
        question: "Orbits with close encounters, to 1e-9",
        error: TARGETS[2],
        cost: "evaluations",
        rival: ANY_FIELD,
    };
    Ok(Study {
        answers: page.charts.first().and_then(|chart| asked.of(chart)).into_iter().collect(),
        conclusion: "The error at the end against what it costs, for a planet of eccentricity 0.9 \
                     over ten years, the Pleiades, and a star of Henon and Heiles over thirty \
                     turns. Steps of equal length must be short enough for the closest encounter; \
                     the adaptive methods are short there only. At small errors those that know \
                     positions and momenta need fewer evaluations than the one for any field, and \
                     the one of order 12 fewer the smaller the error. Theirs hold a tolerance \
                     above 1e-5 as 1e-5, so that none of their runs is cheaper than that."
            .into(),
        table: page.table,
        charts: page.charts.into_iter().map(Into::into).collect(),
        claims: page.claims,
        ..WORK_PRECISION.heading()
    })
}

fn columns() -> Table {
    Table::new([
        Column::exact("problem"),
        Column::exact("method"),
        Column::exact("steps or tolerance"),
        Column::exact("evaluations"),
        Column::rounded("error", 2, 1e-9),
        Column::volatile("wall [s]"),
    ])
}

impl Page {
    /// Every method on a problem.
    fn measure<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: &Small<M, P, N>,
        size: Size,
    ) -> Result<(), StudyError> {
        let error = || Axis::log("error at the end", "");
        let heading = |by: &str| format!("{}, by {by}", problem.name);
        let count = Axis::log("evaluations of the force and its derivative", "");
        let mut counted = Lines::new(&heading("counted work"), count, error()).mark_front();
        let time = Axis::log("wall time", "s");
        let mut timed = Lines::new(&heading("wall time"), time, error());
        let mut all = Vec::new();
        for (method, fewest, most) in FIXED {
            let most = if size == Size::Full { most + FULL } else { most };
            all.push(self.in_equal_steps(problem, method, fewest..=most)?);
        }
        all.push(self.in_own_steps::<Pair8, _, _, N, 9>(problem)?);
        all.push(self.in_own_steps::<Pair12, _, _, N, 17>(problem)?);
        all.push(self.as_first_order(problem)?);
        self.claim(problem, &all);
        for runs in all {
            counted = counted.with(runs.counted);
            timed = timed.with(runs.timed);
        }
        self.charts.extend([counted, timed]);
        Ok(())
    }

    fn in_equal_steps<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: &Small<M, P, N>,
        method: Method,
        powers: std::ops::RangeInclusive<u32>,
    ) -> Result<Runs, StudyError> {
        let name = method.facts().name;
        let mut runs = Runs::new(name);
        for steps in powers.map(|power| 1_u64 << power) {
            let horizon = Horizon::divided(problem.horizon, steps).map_err(StudyError::at(name))?;
            let mut integrator =
                method.integrator(&problem.system).map_err(StudyError::at(name))?;
            let mut run = || {
                let mut state = problem.initial.clone();
                let on = |_: stationary_integrators::Observation<'_, _>| ControlFlow::Continue(());
                let cost = simulate(&mut *integrator, &mut state, horizon, on).ok()?;
                Some((state, cost.differentials + cost.hessians))
            };
            self.record(problem, &mut runs, steps.into(), &mut run);
        }
        Ok(runs)
    }

    fn in_own_steps<T: NystromPair<S>, M: Metric, P: Potential, const N: usize, const S: usize>(
        &mut self,
        problem: &Small<M, P, N>,
    ) -> Result<Runs, StudyError> {
        let mut runs = Runs::new(T::NAME);
        for power in 2..=12 {
            let given = 0.1_f64.powi(power);
            let tolerance = Tolerance::new(given, given).map_err(StudyError::at(T::NAME))?;
            let mut nystrom = Nystrom::<T, M, P, _, S>::new(&problem.system, tolerance.into())
                .map_err(StudyError::at(T::NAME))?;
            let mut run = || {
                let mut state = problem.initial.clone();
                let on =
                    |_: stationary_integrators::NystromStep<'_, _, _>| ControlFlow::Continue(());
                let work = nystrom.run(&mut state, problem.horizon, on).ok()?;
                Some((state, work.evaluations))
            };
            self.record(problem, &mut runs, format!("1e-{power}").into(), &mut run);
        }
        Ok(runs)
    }

    /// The explicit method for any field, which knows nothing of positions and momenta.
    fn as_first_order<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: &Small<M, P, N>,
    ) -> Result<Runs, StudyError> {
        let mut runs = Runs::new(ANY_FIELD);
        let field = MechanicalField::new(&problem.system);
        let start = [problem.initial.q.as_slice(), problem.initial.p.components()].concat();
        for power in 2..=12 {
            let given = 0.1_f64.powi(power);
            let tolerance = Tolerance::new(given, given).map_err(StudyError::at(ANY_FIELD))?;
            let mut run = || {
                let moment = Moment::new(0.0, start.clone());
                let mut method =
                    DormandPrince853::new(&field, tolerance.clone().into(), moment).ok()?;
                integrate(&mut method, problem.horizon, |_| ControlFlow::Continue(())).ok()?;
                let mut state = problem.initial.clone();
                state.t = method.moment().t;
                let (q, p) = method.moment().y.split_at(N);
                state.q.copy_from_slice(q);
                state.p.components_mut().copy_from_slice(p);
                Some((state, method.work().evaluations))
            };
            self.record(problem, &mut runs, format!("1e-{power}").into(), &mut run);
        }
        Ok(runs)
    }

    /// Runs once for the error and the count, then for the time. A run that fails has no error.
    fn record<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: &Small<M, P, N>,
        runs: &mut Runs,
        setting: Cell,
        run: &mut dyn FnMut() -> Option<(State<[f64; N]>, u64)>,
    ) {
        let mut cells = vec![problem.name.into(), runs.counted.name.as_str().into(), setting];
        let outcome = run();
        let error = outcome.as_ref().and_then(|(end, _)| problem.error(end.t, &end.q));
        if let (Some((_, evaluations)), Some(error)) = (outcome, error) {
            let wall = median_wall(|| {
                black_box(run());
            });
            runs.counted.points.push((evaluations as f64, error));
            runs.timed.points.push((wall.median, error));
            cells.extend([evaluations.into(), error.into(), wall.median.into()]);
        } else {
            cells.extend(["-".into(), "failed".into()]);
        }
        self.table.push(cells);
    }

    fn claim<M, P, const N: usize>(&mut self, problem: &Small<M, P, N>, all: &[Runs]) {
        let expected = EXPECTED.iter().find(|(name, _)| *name == problem.name);
        let expected = expected.map_or(["no method"; 3], |(_, methods)| *methods);
        for (target, expected) in TARGETS.into_iter().zip(expected) {
            let costs =
                all.iter().filter_map(|runs| Some((cost_at(target, &runs.counted.points)?, runs)));
            let cheapest = costs.min_by(|a, b| a.0.total_cmp(&b.0));
            let cheapest = cheapest.map_or("no method", |best| best.1.counted.name.as_str());
            let text = format!("{}: cheapest by counted work at {target:e}", problem.name);
            self.claims.push(Claim::words(text, expected, cheapest));
        }
        self.claims.push(Claim::number(
            format!("{}: the truth is known far better than the smallest target", problem.name),
            "below 0.1",
            problem.solution_error / TARGETS[2],
            (0.0, 0.1),
        ));
    }
}

impl Runs {
    fn new(name: &str) -> Self {
        Runs { counted: Series::new(name, []), timed: Series::new(name, []) }
    }
}

/// A problem with a tight run as its truth at the end, and the distance to another method's as its
/// error.
fn with_reference<M, P, const N: usize>(
    mut problem: Small<M, P, N>,
) -> Result<Small<M, P, N>, StudyError>
where
    M: Metric,
    P: Potential,
{
    let tight = || Tolerance::new(1e-14, 1e-14).map_err(StudyError::at("the reference"));
    let (mut best, mut other) = (problem.initial.clone(), problem.initial.clone());
    Nystrom12::new(&problem.system, tight()?.into())
        .map_err(StudyError::at("the reference"))?
        .run(&mut best, problem.horizon, |_| ControlFlow::Continue(()))
        .map_err(StudyError::at("the reference"))?;
    Nystrom8::new(&problem.system, tight()?.into())
        .map_err(StudyError::at("the reference"))?
        .run(&mut other, problem.horizon, |_| ControlFlow::Continue(()))
        .map_err(StudyError::at("the reference"))?;
    let squares = best.q.iter().zip(&other.q).map(|(a, b)| (a - b) * (a - b));
    problem.solution_error = squares.sum::<f64>().sqrt() / problem.scale;
    let end = problem.horizon;
    problem.solution =
        Box::new(move |t| if (t - end).abs() < 1e-9 * end { Some(best.q) } else { None });
    Ok(problem)
}
