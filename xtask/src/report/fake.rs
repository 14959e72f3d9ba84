//! Made-up studies: what the charts and the page are looked at and tested with.

use std::f64::consts::TAU;

use stationary_chart::{Axis, Chart, Lines, Map, Mark, Portrait, Series};
use stationary_measure::{Cell, Column, Table};

use crate::study::{Answer, Claim, Entry, Kind, Measure, Size, Study, StudyError, Tested};

pub(super) const STUDIES: &[Entry<'static>] = &[
    entry("fake-work-precision", "integrators", "4.3", Kind::WorkPrecision, &work_precision),
    entry("fake-long-run", "integrators", "4.3", Kind::LongRun, &long_run),
    entry("fake-portrait", "integrators", "4.2", Kind::Derivative, &portrait),
    entry("fake-map", "constraints", "5.1", Kind::StabilityMap, &map),
    entry("fake-convergence", "elasticity", "8.2", Kind::Convergence, &convergence),
    entry("fake-difference", "calculus", "2.1", Kind::Derivative, &difference),
    entry("fake-error", "calculus", "checks", Kind::Ladder, &error),
];

const fn entry(
    id: &'static str,
    krate: &'static str,
    chapter: &'static str,
    kind: Kind,
    run: &'static Measure<'static>,
) -> Entry<'static> {
    let (title, tested) = ("A made-up study", Tested::ByReport);
    Entry { id, krate, chapter, kind, title, tested, run }
}

/// A study with the entry's labels and a table of the charts' points.
fn study(id: &str, title: &str, conclusion: &str, charts: Vec<Chart>, claims: Vec<Claim>) -> Study {
    let Some(entry) = STUDIES.iter().find(|entry| entry.id == id) else { unreachable!() };
    let columns = [
        Column::exact("method"),
        Column::rounded("force evaluations a period", 4, 0.0),
        Column::rounded("error [m]", 3, 1e-14),
        Column::volatile("wall time [s]"),
    ];
    let mut table = Table::new(columns);
    for chart in &charts {
        if let Chart::Lines(lines) = chart {
            for series in &lines.series {
                for &(x, y) in series.points.iter().take(40) {
                    table.push([
                        series.name.as_str().into(),
                        x.into(),
                        y.into(),
                        (x * 3e-8).into(),
                    ]);
                }
                for (x, reason) in &series.failures {
                    table.push([
                        series.name.as_str().into(),
                        Cell::Number(*x),
                        reason.as_str().into(),
                    ]);
                }
            }
        }
    }
    Study {
        id: entry.id,
        krate: entry.krate,
        chapter: entry.chapter,
        kind: entry.kind,
        title: title.into(),
        conclusion: conclusion.into(),
        table,
        charts,
        claims,
        answers: Vec::new(),
    }
}

fn steps(count: i32) -> impl Iterator<Item = f64> {
    (0..count).map(|i| 0.5 / 2_f64.powi(i))
}

fn work_precision(_: Size) -> Result<Study, StudyError> {
    let methods: [(&str, f64, f64, f64); 8] = [
        ("explicit Euler", 1.0, 1.0, 40.0),
        ("symplectic Euler", 1.0, 1.0, 2.0),
        ("Störmer-Verlet", 2.0, 1.0, 0.6),
        ("implicit midpoint", 2.0, 6.0, 0.9),
        ("RK4", 4.0, 4.0, 0.8),
        ("symplectic 4", 4.0, 3.0, 0.05),
        ("Gauss 6", 6.0, 20.0, 0.02),
        ("symplectic 8", 8.0, 15.0, 0.3),
    ];
    let chart = methods.iter().fold(
        Lines::new(
            "",
            Axis::log("force evaluations a period", ""),
            Axis::log("largest position error over 100 periods", "m"),
        )
        .slope(-2.0, (2000.0, 3e-3)),
        |chart, &(name, order, stages, factor)| {
            let points = steps(11).map(|h| {
                let wobble = 1.0 + 0.12 * (37.0 * h + order).sin();
                (stages * TAU / h, (wobble * factor * h.powf(order)).max(3e-14))
            });
            let unstable = order == 1.0 && factor > 2.0;
            let mut series = Series::new(name, points.skip(if unstable { 3 } else { 0 }));
            if unstable {
                for (h, t) in steps(3).zip([3, 11, 40]) {
                    series = series.failed(TAU / h, format!("diverged at t = {t} s"));
                }
            }
            if name == "RK4" {
                series = series.failed(13.0, "left the plane at t = 71 s");
            }
            chart.with(series)
        },
    );
    let claims = vec![
        Claim::number("Störmer-Verlet has order 2", "2", 2.0031, (1.9, 2.1)),
        Claim::number("its energy error stays below a millijoule", "bounded", 3.1e-5, (0.0, 1e-3)),
        Claim::words("RK4 is cheapest at 1e-4", "RK4", "symplectic 4"),
    ];
    let answer = Answer {
        question: "Orbits to <1e-4>".into(),
        method: "symplectic 4".into(),
        figure: "at 0.30 of the evaluations of RK4".into(),
    };
    let study = study(
        "fake-work-precision",
        "Which method is cheapest for a Kepler orbit?",
        "Down to a millimetre Störmer-Verlet costs least; below that, each order pays for itself two \
         decades later. Explicit Euler is never on the front, and leaves the orbit at large steps. \
         Escaped: <b>bold</b>.",
        vec![chart.mark_front().into()],
        claims,
    );
    Ok(Study { answers: vec![answer], ..study })
}

fn long_run(_: Size) -> Result<Study, StudyError> {
    let time = || (0..20_000).map(|i| 0.05 * f64::from(i));
    let chart = Lines::new("Energy", Axis::linear("time", "s"), Axis::linear("energy drift", "J"))
        .with(Series::new("Störmer-Verlet", time().map(|t| (t, 2e-6 * (1.3 * t).sin()))))
        .with(Series::new("RK4", time().map(|t| (t, -9e-9 * t))))
        .with(Series::new("implicit midpoint", time().map(|t| (t, 8e-7 * (0.9 * t).cos() + 4e-6))));
    let log = Lines::new(
        "Growth of the error",
        Axis::log("time", "s"),
        Axis::log("distance from the reference", "m"),
    )
    .with(Series::new("Störmer-Verlet", time().map(|t| (t, 1e-7 * t))))
    .with(Series::new("RK4", time().map(|t| (t, 1e-9 * t * t))))
    .with(Series::new(
        "explicit Euler",
        time().map(|t| (t, if t < 60.0 { 1e-6 * (0.3 * t).exp() } else { f64::NAN })),
    ))
    .slope(1.0, (3.0, 3e-8))
    .slope(2.0, (3.0, 3e-10));
    Ok(study(
        "fake-long-run",
        "Does the energy drift?",
        "Symplectic methods keep the energy in a band for as long as one looks; Runge-Kutta loses it \
         at a constant rate.",
        vec![chart.into(), log.into()],
        vec![Claim::number("no drift", "0", -1.2e-12, (f64::NEG_INFINITY, 1e-10))],
    ))
}

fn portrait(_: Size) -> Result<Study, StudyError> {
    let grid = || (-7..=7).map(|i| 0.22 * f64::from(i));
    let field = grid().flat_map(|q| grid().map(move |p| ((q, p), (p, -q))));
    let circle = (0..=120).map(|i| f64::from(i) * 0.05236).map(|a| (a.cos(), a.sin()));
    let (start, h) = ((0.6, 0.8), 0.7);
    let explicit = (start.0 + h * start.1, start.1 - h * start.0);
    let d = 1.0 + h * h;
    let implicit = ((start.0 + h * start.1) / d, (start.1 - h * start.0) / d);
    let k = 1.0 + 0.25 * h * h;
    let (a, b) = ((1.0 - 0.25 * h * h) / k, h / k);
    let midpoint = (a * start.0 + b * start.1, a * start.1 - b * start.0);
    let portrait =
        Portrait::new("", Axis::linear("position q", "m"), Axis::linear("momentum p", "kg m/s"))
            .field(field)
            .curve(Series::new("exact orbit", circle).marked(Mark::Line))
            .step("explicit Euler", start, explicit)
            .step("implicit Euler", start, implicit)
            .step("implicit midpoint", start, midpoint);
    Ok(study(
        "fake-portrait",
        "One step on an oscillator",
        "Explicit Euler leaves the orbit outwards, implicit Euler inwards; implicit midpoint stays.",
        vec![portrait.into()],
        Vec::new(),
    ))
}

fn map(_: Size) -> Result<Study, StudyError> {
    let mut map = Map::new(
        "",
        Axis::log("stiffness", "N/m"),
        Axis::log("step", "s"),
        ["survived", "diverged", "Newton failed"],
    )
    .border(
        "predicted: h ω = 2",
        (0..60).map(|i| 10_f64.powf(0.1 * f64::from(i))).map(|k| (k, 2.0 / k.sqrt())),
    );
    for i in 0..40 {
        for j in 0..24 {
            let (k, h) =
                (10_f64.powf(0.15 * f64::from(i)), 10_f64.powf(-3.0 + 0.14 * f64::from(j)));
            let x = h * k.sqrt();
            let outcome = match x {
                _ if x > 2.1 && h > 0.5 => "Newton failed",
                _ if x > 2.02 => "diverged",
                _ => "survived",
            };
            map.cell(k, h, outcome);
        }
    }
    Ok(study(
        "fake-map",
        "How large may a step be?",
        "The measured border is the predicted one: a step is stable while it is shorter than two over \
         the fastest frequency.",
        vec![map.into()],
        vec![Claim::number("border", "2", 2.01, (1.95, 2.05))],
    ))
}

fn convergence(_: Size) -> Result<Study, StudyError> {
    let sizes = || (0..6).map(|i| 0.4 / 2_f64.powi(i));
    let chart = Lines::new("Displacement", Axis::log("mesh size", "m"), Axis::log("error", "m"))
        .with(Series::new("linear triangles", sizes().map(|h| (h, 0.3 * h * h))))
        .with(Series::new("quadratic triangles", sizes().map(|h| (h, 0.29 * h * h * h))))
        .with(Series::new("linear quadrilaterals", sizes().map(|h| (h, 0.28 * h * h))))
        .with(Series::new("reduced integration", sizes().map(|h| (h, 0.27 * h * h))))
        .with(Series::new("F-bar", sizes().map(|h| (h, 0.26 * h * h))))
        .slope(2.0, (0.1, 1e-2))
        .slope(3.0, (0.1, 5e-5));
    let locking = Lines::new(
        "Locking",
        Axis::linear("Poisson's ratio", ""),
        Axis::linear("deflection relative to the reference", ""),
    )
    .with(
        Series::new(
            "linear triangles",
            (0..10).map(|i| (0.05 * f64::from(i), 0.97 - 0.003 * f64::from(i * i))),
        )
        .failed(0.5, "singular matrix"),
    )
    .with(Series::new("F-bar", (0..10).map(|i| (0.05 * f64::from(i), 0.99))))
    .curve("exact", [(0.0, 1.0), (0.5, 1.0)]);
    Ok(study(
        "fake-convergence",
        "Does the error fall as fast as promised?",
        "Linear elements fall with the square of the mesh size, quadratic ones with its cube.",
        vec![chart.into(), locking.into()],
        vec![Claim::number("order", "2", 2.0, (1.9, 2.1))],
    ))
}

fn difference(_: Size) -> Result<Study, StudyError> {
    let steps = || (0..33).map(|i| 10_f64.powf(-0.5 * f64::from(i)));
    let chart = Lines::new(
        "",
        Axis::log("difference step", ""),
        Axis::log("error of the differential", ""),
    )
    .with(Series::new("one-sided difference", steps().map(|h| (h, 0.7 * h + 1e-16 / h))))
    .with(Series::new("central difference", steps().map(|h| (h, 0.2 * h * h + 6e-17 / h))))
    .slope(1.0, (1e-3, 2e-2))
    .slope(2.0, (1e-3, 5e-9));
    Ok(study(
        "fake-difference",
        "How small may a difference step be?",
        "The error falls with slope 1 or 2 until cancellation takes over, and then grows again.",
        vec![chart.into()],
        vec![Claim::number("slope", "1", 1.0, (0.95, 1.05))],
    ))
}

fn error(_: Size) -> Result<Study, StudyError> {
    let source = std::io::Error::other("no convergence");
    Err(StudyError::at("the reference orbit")(source))
}
