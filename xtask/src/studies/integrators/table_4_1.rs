//! The notes' table of integrators, measured, beside what the notes print.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use stationary_calculus::Covector;
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{kepler, oscillator, three_bodies};
use stationary_integrators::{
    Conservation, Convergence, ErrorGrowth, Horizon, Integrator, Method, Stability, State,
    angular_momentum, angular_momentum_scale, linear_momentum, linear_momentum_scale, simulate,
};
use stationary_measure::{Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Table 4.1.
pub const TABLE: Entry<'static> = Entry {
    id: "table-4-1",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::LongRun,
    title: "The notes' table of eight integrators, each entry measured",
    tested: Tested::Table,
    run: &study,
};

/// What the notes print: order, global error, stability, energy, momentum.
fn notes(method: Method) -> [&'static str; 5] {
    match method {
        Method::ExplicitEuler => ["1", "exponential", "unstable", "explodes", "only linear"],
        Method::ImplicitEuler => ["1", "exponential", "stable", "decays", "only linear"],
        Method::Trapezoid | Method::ImplicitMidpoint => {
            ["2", "linear", "conditional", "good", "yes"]
        }
        Method::SymplecticEulerDriftKick
        | Method::SymplecticEulerKickDrift
        | Method::StormerVerlet => ["1 or 2", "linear", "conditional", "good", "yes"],
        Method::RungeKutta4 => ["4", "exponential", "unstable", "explodes", "yes"],
        _ => ["not in it"; 5],
    }
}

/// Steps a period of the oscillator whose error is followed.
const STEPS: u64 = 200;

/// What a run says of one method.
struct Row {
    local: f64,
    global: f64,
    growth: String,
    stability: String,
    energy: f64,
    linear: f64,
    angular: f64,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let periods = match size {
        Size::Default => 2_000,
        Size::Full => 20_000,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("order, notes"),
        Column::rounded("one step", 2, 0.0),
        Column::rounded("fixed end", 2, 0.0),
        Column::exact("error, notes"),
        Column::exact("error, measured"),
        Column::exact("stability, notes"),
        Column::exact("stability, measured"),
        Column::exact("energy, notes"),
        Column::rounded("energy left", 3, 1e-12),
        Column::exact("momentum, notes"),
        Column::rounded("linear", 1, 1e-12),
        Column::rounded("angular", 1, 1e-12),
    ]);
    let mut chart = Lines::new(
        "Error of an oscillator, 200 steps a period",
        Axis::log("periods", ""),
        Axis::log("largest error so far", ""),
    );
    let mut claims = Vec::new();
    for method in Method::TABLE_4_1 {
        let (name, [order, error, stability, energy, momentum]) =
            (method.facts().name, notes(method));
        let course = oscillator_error(method, periods)?;
        let row = Row {
            local: one_step_order(method)?,
            global: fixed_end_order(method)?,
            growth: growth(method, &course),
            stability: stability_limit(method)?,
            energy: energy_left(method)?,
            linear: momentum_drift(method)?.0,
            angular: momentum_drift(method)?.1,
        };
        table.push([
            name.into(),
            order.into(),
            row.local.into(),
            row.global.into(),
            error.into(),
            row.growth.clone().into(),
            stability.into(),
            row.stability.clone().into(),
            energy.into(),
            row.energy.into(),
            momentum.into(),
            row.linear.into(),
            row.angular.into(),
        ]);
        claims.extend(claims_on(method, &row));
        chart = chart.with(Series::new(name, course));
    }
    Ok(Study {
        conclusion: "The notes' table 4.1 beside what each method does. Where they part: \
                     RK4 is stable up to h ω = 2√2, loses energy slowly, does not keep angular \
                     momentum, and the error of its oscillator grows linearly; the trapezoid rule \
                     keeps angular momentum for linear forces only; implicit Euler's error stops \
                     growing once the motion is gone; the implicit methods have no stability \
                     limit on a linear system. One step has one order \
                     more than the whole. Energy left is that of an oscillator after 100 periods; \
                     the momenta are those of a sun and two planets."
            .into(),
        table,
        charts: vec![chart.slope(1.0, (20.0, 2e-3)).into()],
        claims,
        ..TABLE.heading()
    })
}

fn claims_on(method: Method, row: &Row) -> Vec<Claim> {
    let facts = method.facts();
    let (name, order) = (facts.name, f64::from(facts.order));
    let band = |centre: f64, half: f64| (centre - half, centre + half);
    let growth = match facts.error_growth {
        ErrorGrowth::Linear => "linear",
        ErrorGrowth::Exponential => "exponential",
        ErrorGrowth::Saturates => "saturates",
    };
    let stability = match facts.stability {
        Stability::Below(limit) => format!("h ω < {limit:.2}"),
        Stability::Always => "to h ω = 1000".to_owned(),
        Stability::Never => "never".to_owned(),
    };
    let angular = match facts.angular_momentum {
        Conservation::Exact => ("rounding", (0.0, 1e-12)),
        _ => ("more than rounding", (1e-12, 1.0)),
    };
    vec![
        Claim::number(
            format!("{name}: order of one step"),
            format!("{}", order + 1.0),
            row.local,
            band(order + 1.0, 0.15),
        ),
        Claim::number(
            format!("{name}: order at a fixed end time"),
            format!("{order}"),
            row.global,
            band(order, 0.1),
        ),
        Claim::words(format!("{name}: growth of the error"), growth, row.growth.clone()),
        Claim::words(format!("{name}: stable"), stability, row.stability.clone()),
        Claim::number(
            format!("{name}: drift of linear momentum"),
            "rounding",
            row.linear,
            (0.0, 1e-12),
        ),
        Claim::number(
            format!("{name}: drift of angular momentum"),
            angular.0,
            row.angular,
            angular.1,
        ),
    ]
}

/// The slope of the error of one step, from a state in general position.
fn one_step_order(method: Method) -> Result<f64, StudyError> {
    let problem = kepler(0.3).map_err(StudyError::at("the orbit"))?;
    let start = State::new([0.4, -0.7], Covector([0.9, 0.5]));
    let stepped = |method: Method, h: f64, steps: u32| -> Result<[f64; 4], StudyError> {
        let mut state = start.clone();
        let mut integrator =
            method.integrator(&problem.system).map_err(StudyError::at("one step"))?;
        for _ in 0..steps {
            integrator.step(&mut state, h).map_err(StudyError::at("one step"))?;
        }
        Ok([state.q[0], state.q[1], state.p.0[0], state.p.0[1]])
    };
    let mut points = Vec::new();
    for h in [0.04, 0.02, 0.01] {
        let (one, exact) = (stepped(method, h, 1)?, stepped(Method::RungeKutta4, h / 64.0, 64)?);
        let square: f64 = one.iter().zip(exact).map(|(a, b)| (a - b) * (a - b)).sum();
        points.push((h, square.sqrt()));
    }
    Ok(loglog_slope(&points).unwrap_or(f64::NAN))
}

/// The slope of the largest error over half an orbit.
fn fixed_end_order(method: Method) -> Result<f64, StudyError> {
    let mut problem = kepler(0.3).map_err(StudyError::at("the orbit"))?;
    problem.horizon = 0.5 * problem.period;
    let coarsest = if method.facts().order == 1 { 3200 } else { 200 };
    let steps = (0..5).map(|k| coarsest << k);
    let measured =
        Convergence::measure(&problem, method, steps).map_err(StudyError::at("the orbit"))?;
    Ok(measured.order().unwrap_or(f64::NAN))
}

/// The largest error of an oscillator up to a number of periods.
fn oscillator_error(method: Method, periods: u64) -> Result<Vec<(f64, f64)>, StudyError> {
    let problem = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at("the oscillator"))?;
    let mut state = problem.initial.clone();
    let (mut worst, mut course, mut next) = (0.0_f64, Vec::new(), 1);
    for period in 1..=periods {
        for step in 1..=STEPS {
            integrator
                .step(&mut state, TAU / STEPS as f64)
                .map_err(StudyError::at("the oscillator"))?;
            let angle = TAU * step as f64 / STEPS as f64;
            worst = worst.max((state.q[0] - angle.cos()).abs());
        }
        if period == next || period == periods {
            course.push((period as f64, worst));
            next = (period * 5 / 4).max(period + 1);
        }
        if worst > 1e12 {
            break;
        }
    }
    Ok(course)
}

/// Names the growth of an error, over the last decade of time in which it is small.
fn growth(method: Method, course: &[(f64, f64)]) -> String {
    let small: Vec<_> = course.iter().copied().filter(|&(_, error)| error < 0.5).collect();
    let until = small.last().map_or(0.0, |x| x.0);
    let late: Vec<_> = small.into_iter().filter(|&(t, _)| t * 10.0 >= until).collect();
    let (end, last) = course.last().copied().unwrap_or_default();
    // A phase error comes to 2, the motion's width; a motion that is gone leaves an error of 1.
    let gone =
        course.iter().filter(|&&(t, _)| 2.0 * t >= end).all(|&(_, e)| (0.9..1.1).contains(&e));
    match loglog_slope(&late) {
        _ if last > 1e6 => "exponential".to_owned(),
        _ if gone => "saturates".to_owned(),
        Some(power) if (power - 1.0).abs() < 0.15 => "linear".to_owned(),
        Some(power) => format!("t^{power:.2}"),
        None => format!("{method} has no growth"),
    }
}

/// The part of an oscillator's energy that is left after 100 periods.
fn energy_left(method: Method) -> Result<f64, StudyError> {
    let problem = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let mut state = problem.initial.clone();
    let horizon = Horizon::divided(100.0 * TAU, 6400).map_err(StudyError::at("100 periods"))?;
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at("100 periods"))?;
    simulate(&mut *integrator, &mut state, horizon, |_| ControlFlow::Continue(()))
        .map_err(StudyError::at("100 periods"))?;
    Ok(problem.energy(&state) / problem.energy(&problem.initial))
}

/// True where an oscillator of frequency 1 stays bounded over thousands of steps of size h.
fn survives(method: Method, h: f64) -> Result<bool, StudyError> {
    let problem = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let mut integrator: Box<dyn Integrator<[f64; 1]>> =
        method.integrator(&problem.system).map_err(StudyError::at("stability"))?;
    let mut state = State::new([1.0], Covector([0.3]));
    for _ in 0..4000 {
        if integrator.step(&mut state, h).is_err() || state.q[0].abs() > 1e4 {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The largest stable h omega by bisection, in words.
fn stability_limit(method: Method) -> Result<String, StudyError> {
    if !survives(method, 0.1)? {
        return Ok("never".to_owned());
    }
    let mut all = true;
    for h in [0.5, 1.0, 2.0, 5.0, 10.0, 100.0, 1000.0] {
        all &= survives(method, h)?;
    }
    if all {
        return Ok("to h ω = 1000".to_owned());
    }
    let (mut stable, mut unstable) = (0.1, 1000.0);
    while unstable - stable > 1e-4 {
        let middle = 0.5 * (stable + unstable);
        if survives(method, middle)? {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    Ok(format!("h ω < {stable:.2}"))
}

/// Largest drifts of linear and angular momentum, relative to the sums of magnitudes.
fn momentum_drift(method: Method) -> Result<(f64, f64), StudyError> {
    let problem = three_bodies().map_err(StudyError::at("three bodies"))?;
    let mut state = problem.initial.clone();
    let (linear, angular) = (linear_momentum::<2>(&state), angular_momentum::<2>(&state)[2]);
    let mut drift = (0.0_f64, 0.0_f64);
    // Half a turn: in longer runs implicit Euler drops the inner planet into the sun.
    let horizon =
        Horizon::divided(0.5 * problem.period, 200).map_err(StudyError::at("three bodies"))?;
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at("three bodies"))?;
    simulate(&mut *integrator, &mut state, horizon, |now| {
        let p = linear_momentum::<2>(now.state);
        let off = (p[0] - linear[0]).hypot(p[1] - linear[1]);
        drift.0 = drift.0.max(off / linear_momentum_scale::<2>(now.state));
        let off = (angular_momentum::<2>(now.state)[2] - angular).abs();
        drift.1 = drift.1.max(off / angular_momentum_scale::<2>(now.state));
        ControlFlow::Continue(())
    })
    .map_err(StudyError::at("three bodies"))?;
    Ok(drift)
}
