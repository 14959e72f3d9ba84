//! How good an estimated global error is: its size over that of the true error, on every problem.

use std::ops::ControlFlow;

use stationary_calculus::{Metric, Potential};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{
    Problem, fermi_pasta_ulam, henon_heiles, kepler, oscillator, pendulum, pleiades,
    spring_pendulum, three_bodies,
};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, DormandPrince853, Estimated, Horizon, MechanicalField, Method,
    Moment, Nystrom8, Nystrom12, NystromMethod12, State, StepControl, Tolerance,
    integrate_with_error, simulate_with_error,
};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Estimates of all methods of equal steps and of two that choose theirs.
pub const STUDY: Entry<'static> = Entry {
    id: "error-estimates",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::LongRun,
    title: "Nine problems: estimated over true global error of all methods",
    tested: Tested::ByReport,
    run: &study,
};

/// Times at which estimates are judged.
const TIMES: u64 = 32;
/// Long steps between two of these times.
const BETWEEN: [u64; 6] = [1, 2, 4, 8, 16, 32];
/// Tolerances of methods that choose their steps, and those of the three runs in parts of them.
const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
const TIGHTER: [f64; 3] = [1.0, 1e-1, 1e-2];
/// The tolerance of the run that they are judged by.
const TRUTH: f64 = 1e-13;
/// True errors, relative to a problem's size, that are neither rounding nor as large as the motion.
const JUDGED: std::ops::Range<f64> = 1e-10..3e-2;
/// The same beside a run whose own error between its steps is larger.
const JUDGED_OF_OWN: std::ops::Range<f64> = 1e-8..3e-2;
/// True errors below so many times the reference's own doubt say nothing.
const DOUBTS: f64 = 10.0;
/// An estimate is good between half of the true error and twice it.
const GOOD: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// An estimate at a time.
#[derive(Clone, Copy)]
struct Judged {
    truth: f64,
    ratio: f64,
    is_sure: bool,
}

type Small<M, P, const N: usize> = Problem<M, P, [f64; N]>;

struct Page {
    table: Table,
    equal: Vec<Judged>,
    own: Vec<Judged>,
}

fn study(_: Size) -> Result<Study, StudyError> {
    let at = StudyError::at;
    let mut page = Page {
        table: Table::new([
            Column::exact("problem"),
            Column::exact("steps"),
            Column::exact("judged"),
            Column::rounded("sure", 2, 0.0),
            Column::rounded("good where sure", 3, 0.0),
            Column::rounded("good of all", 2, 0.0),
        ]),
        equal: Vec::new(),
        own: Vec::new(),
    };
    page.measure(oscillator(1.0).map_err(at("an oscillator"))?, 3.0)?;
    page.measure(pendulum(2.0).map_err(at("a pendulum"))?, 3.0)?;
    page.measure(kepler(0.3).map_err(at("a planet"))?, 3.0)?;
    page.measure(kepler(0.8).map_err(at("a comet"))?, 1.0)?;
    page.measure(spring_pendulum(100.0).map_err(at("a mass on a spring"))?, 5.0)?;
    page.measure(fermi_pasta_ulam(10.0).map_err(at("springs"))?, 5.0)?;
    page.measure(henon_heiles(0.1).map_err(at("a star"))?, 3.0)?;
    page.measure(three_bodies().map_err(at("planets"))?, 1.0)?;
    page.measure(pleiades().map_err(at("stars"))?, 1.0)?;
    let claims = vec![
        claim("equal steps, where the estimate is said to be sure", sure(&page.equal)),
        claim("steps of a method's own, where the estimate is said to be sure", sure(&page.own)),
    ];
    Ok(Study {
        conclusion: "From three runs in steps of h, h/2 and h/4 comes how far the finest is from the \
                     truth, and how far that estimate may itself be off; it is sure where the runs \
                     converge with the method's order and the doubt is at most a quarter of the \
                     estimate. Then it is good to a few per cent. Where it is not sure, steps are too \
                     long or the error passes zero, and it is often much too large but seldom too \
                     small. Of methods that choose their steps the estimate is the distance to a run of a \
                     hundredth of the tolerance, sure where one of a tenth is near to that."
            .into(),
        charts: vec![
            quantiles("Equal steps, where sure", &sure(&page.equal)).into(),
            quantiles("Equal steps, all estimates", &page.equal).into(),
            quantiles("Steps of a method's own, where sure", &sure(&page.own)).into(),
        ],
        table: page.table,
        claims,
        ..STUDY.heading()
    })
}

fn sure(all: &[Judged]) -> Vec<Judged> {
    all.iter().copied().filter(|judged| judged.is_sure).collect()
}

fn share(all: &[Judged], is: impl Fn(&Judged) -> bool) -> f64 {
    all.iter().filter(|judged| is(judged)).count() as f64 / all.len() as f64
}

fn claim(what: &str, judged: Vec<Judged>) -> Claim {
    let good = share(&judged, |judged| GOOD.contains(&judged.ratio));
    Claim::number(
        format!("{what}: the part of estimates within a factor of two of the true error"),
        "at least 0.9",
        good,
        (0.9, 1.0),
    )
}

/// The estimate over the true error against the true error: the middle and where most are.
fn quantiles(title: &str, all: &[Judged]) -> Lines {
    let axes = (
        Axis::log("true error, relative to the problem's size", ""),
        Axis::log("estimate over true error", ""),
    );
    let mut chart = Lines::new(title, axes.0, axes.1);
    for (name, part) in [("95 in 100 below", 0.95), ("median", 0.5), ("5 in 100 below", 0.05)] {
        let mut points = Vec::new();
        for decade in -10..-1 {
            let range = 10.0_f64.powi(decade)..10.0_f64.powi(decade + 1);
            let within = all.iter().filter(|judged| range.contains(&judged.truth));
            let mut ratios: Vec<f64> = within.map(|judged| judged.ratio).collect();
            ratios.sort_by(f64::total_cmp);
            if let Some(&ratio) = ratios.get((part * ratios.len() as f64) as usize) {
                points.push((10.0_f64.powf(f64::from(decade) + 0.5), ratio));
            }
        }
        chart = chart.with(Series::new(name, points));
    }
    let ends = |y: f64| [(JUDGED.start, y), (JUDGED.end, y)];
    chart.curve("half", ends(0.5)).curve("twice", ends(2.0))
}

impl Page {
    fn measure<M: Metric, P: Potential, const N: usize>(
        &mut self,
        problem: Small<M, P, N>,
        periods: f64,
    ) -> Result<(), StudyError> {
        let end = periods * problem.period;
        let end = if problem.name == "pleiades" { problem.horizon } else { end };
        let truth = Truth::of(&problem, end)?;
        let mut equal = Vec::new();
        for &method in Method::ALL {
            for between in BETWEEN {
                equal.extend(truth.of_equal_steps(&problem, method, between)?);
            }
        }
        let field = MechanicalField::new(&problem.system);
        let start = [problem.initial.q.as_slice(), problem.initial.p.components()].concat();
        let at = |tolerance| -> Result<_, StudyError> {
            let control = Tolerance::new(tolerance, tolerance).map(StepControl::from);
            let control = control.map_err(StudyError::at("a tolerance"))?;
            Ok((control, Moment::new(0.0, start.clone())))
        };
        let failed = || StudyError::at::<AdaptiveError>(problem.name);
        let explicit = |(control, start)| -> Result<Box<dyn AdaptiveMethod<Vec<f64>>>, StudyError> {
            let method = DormandPrince853::new(&field, control, start).map_err(failed())?;
            Ok(Box::new(method))
        };
        let nystrom = |(control, start)| -> Result<Box<dyn AdaptiveMethod<Vec<f64>>>, StudyError> {
            let method = NystromMethod12::new(&problem.system, control, start);
            Ok(Box::new(method.map_err(failed())?))
        };
        let mut own = Vec::new();
        for tolerance in TOLERANCES {
            let [loose, middle, tight] = TIGHTER.map(|part| at(part * tolerance));
            let (loose, middle, tight) = (loose?, middle?, tight?);
            let all = (loose.clone(), middle.clone(), tight.clone());
            let runs = [explicit(all.0)?, explicit(all.1)?, explicit(all.2)?];
            own.extend(of_own_steps(&problem, runs, explicit(at(TRUTH)?)?, end)?);
            let runs = [nystrom(loose)?, nystrom(middle)?, nystrom(tight)?];
            own.extend(of_own_steps(&problem, runs, explicit(at(TRUTH)?)?, end)?);
        }
        for (steps, judged) in [("equal", &equal), ("own", &own)] {
            let good = |judged: &Judged| GOOD.contains(&judged.ratio);
            self.table.push([
                problem.name.into(),
                steps.into(),
                (judged.len() as u64).into(),
                share(judged, |judged| judged.is_sure).into(),
                share(&sure(judged), good).into(),
                share(judged, good).into(),
            ]);
        }
        self.equal.extend(equal);
        self.own.extend(own);
        Ok(())
    }
}

/// A problem's configurations at the times, and how far they may themselves be off.
struct Truth<const N: usize> {
    every: f64,
    at: Vec<[f64; N]>,
    doubt: f64,
}

impl<const N: usize> Truth<N> {
    /// By the Nystrom pair of order 12, compared with that of order 8.
    fn of<M: Metric, P: Potential>(problem: &Small<M, P, N>, end: f64) -> Result<Self, StudyError> {
        let control =
            || Tolerance::new(1e-13, 1e-13).map_err(StudyError::at("the reference's tolerance"));
        let every = end / TIMES as f64;
        let (mut best, mut other) = (problem.initial.clone(), problem.initial.clone());
        let mut twelve = Nystrom12::new(&problem.system, control()?.into())
            .map_err(StudyError::at("the reference"))?;
        let mut eight = Nystrom8::new(&problem.system, control()?.into())
            .map_err(StudyError::at("the reference"))?;
        let (mut all, mut doubt) = (Vec::new(), 0.0_f64);
        for time in 1..=TIMES {
            let to = time as f64 * every;
            twelve
                .run(&mut best, to, |_| ControlFlow::Continue(()))
                .map_err(StudyError::at("the reference"))?;
            eight
                .run(&mut other, to, |_| ControlFlow::Continue(()))
                .map_err(StudyError::at("the reference"))?;
            doubt = doubt.max(distance(&best.q, &other.q));
            all.push(best.q);
        }
        Ok(Truth { every, at: all, doubt })
    }

    fn judge<M, P>(
        &self,
        problem: &Small<M, P, N>,
        time: u64,
        now: &Estimated<'_, [f64; N]>,
    ) -> Option<Judged> {
        let off = distance(&self.at[time as usize - 1], &now.state.q);
        let truth = off / problem.scale;
        let known = JUDGED.contains(&truth) && off > DOUBTS * self.doubt;
        known.then(|| Judged { truth, ratio: now.distance() / off, is_sure: now.is_sure() })
    }

    /// A run that fails says nothing.
    fn of_equal_steps<M: Metric, P: Potential>(
        &self,
        problem: &Small<M, P, N>,
        method: Method,
        between: u64,
    ) -> Result<Vec<Judged>, StudyError> {
        let horizon = Horizon::divided(self.every * TIMES as f64, TIMES * between);
        let horizon = horizon.map_err(StudyError::at("the horizon"))?;
        let mut state: State<[f64; N]> = problem.initial.clone();
        let mut judged = Vec::new();
        let make = || method.integrator::<_, _, [f64; N]>(&problem.system);
        let _ = simulate_with_error(make, &mut state, horizon, |now| {
            if now.step % between == 0 {
                judged.extend(self.judge(problem, now.step / between, &now));
            }
            ControlFlow::Continue(())
        });
        Ok(judged)
    }
}

/// At each of the method's own steps, beside a run of the smallest tolerance.
fn of_own_steps<M, P, const N: usize>(
    problem: &Small<M, P, N>,
    mut runs: [Box<dyn AdaptiveMethod<Vec<f64>> + '_>; 3],
    mut truth: Box<dyn AdaptiveMethod<Vec<f64>> + '_>,
    end: f64,
) -> Result<Vec<Judged>, StudyError> {
    let (mut judged, mut there, mut broken) = (Vec::new(), vec![0.0; 2 * N], None);
    let [loose, middle, tight] = runs.each_mut().map(|run| &mut **run);
    let run = integrate_with_error([loose, middle, tight], end, |now| {
        let t = now.moment.t;
        let mut reach = || {
            while truth.moment().t < t {
                truth.step(end)?;
            }
            truth.interpolate(t, &mut there)
        };
        if let Err(error) = reach() {
            broken = Some(error);
            return ControlFlow::Break(());
        }
        let truth = distance(&there, &now.moment.y);
        if JUDGED_OF_OWN.contains(&(truth / problem.scale)) {
            let ratio = now.distance() / truth;
            judged.push(Judged { truth: truth / problem.scale, ratio, is_sure: now.is_sure() });
        }
        ControlFlow::Continue(())
    });
    run.map_err(StudyError::at(problem.name))?;
    match broken {
        Some(error) => Err(StudyError::at("the reference")(error)),
        None => Ok(judged),
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
