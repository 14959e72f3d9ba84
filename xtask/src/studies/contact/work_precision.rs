//! Error against work of three ways to step bodies in contact.

mod scenes;
mod ways;

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::ContactError;
use stationary_measure::{Cell, Column, Table, loglog_slope};

use self::scenes::{Scene, scenes};
use self::ways::{MOMENTS, SHORT, Way, apart, limit, run};
use crate::studies::cheapest::cost_at;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Fixed steps, steps chosen by error, impacts at the instant.
pub const CONTACT_WORK_PRECISION: Entry<'static> = Entry {
    id: "contact-work-precision",
    krate: "contact",
    chapter: "11.4",
    kind: Kind::WorkPrecision,
    title: "Bodies in contact: error against work of fixed steps, chosen steps, and impacts at the instant",
    tested: Tested::ByReport,
    run: &study,
};

/// The accuracies that are asked about.
const ASKED: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Where they should be, and how well that is known, m.
struct Truth {
    places: Vec<Vec<Vector3<f64>>>,
    bar: f64,
}

fn truth(scene: &Scene) -> Result<Truth, ContactError> {
    if let Some(known) = scene.known {
        let bodies = scene.start()?.q.len() / 7;
        let moment = |k: usize| {
            let t = scene.duration * k as f64 / MOMENTS as f64;
            let points = |body| [known(body, t), known(body, t) + Vector3::x() * scene.size];
            (0..bodies).flat_map(points).collect()
        };
        return Ok(Truth { places: (1..=MOMENTS).map(moment).collect(), bar: 1e-15 });
    }
    // Two ways to the limit of small steps: their distance is how well it is known.
    let both = |(fine, coarse)| Ok::<_, ContactError>((run(scene, fine)?, run(scene, coarse)?));
    let (fine, coarse) = both(limit(scene)).or_else(|_| both(SHORT))?;
    let bar = apart(&fine.places, &coarse.places);
    Ok(Truth { places: fine.places, bar })
}

fn ways(scene: &Scene, size: Size) -> Vec<Way> {
    let full = size == Size::Full;
    let steps: &[f64] = match (scene.name, full) {
        ("pile", false) => &[1e-2, 3e-3],
        (_, false) => &[3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4],
        (_, true) => &[3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5],
    };
    let accuracies: &[f64] = match (scene.name, full) {
        // What slips a little in every other step takes steps without number.
        ("pile" | "Euler's disc", false) => &[1e-1],
        ("pile", true) => &[1e-1, 3e-2, 1e-2, 3e-3],
        _ => &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5],
    };
    let contact_steps: &[f64] = match (scene.name, full) {
        ("pile", false) => &[3e-3],
        ("pile", true) => &[1e-2, 3e-3, 1e-3],
        ("rocking block", false) => &[1e-2, 1e-3],
        _ => &[1e-2, 1e-3, 1e-4],
    };
    let fixed = steps.iter().map(|&h| Way::Fixed(h));
    let chosen = accuracies.iter().map(|&a| Way::Chosen(a * scene.size));
    let instant = contact_steps.iter().map(|&r| Way::AtTheInstant(r));
    fixed.chain(chosen).chain(instant).collect()
}

/// Each way's work against its errors on one scene, in the order of the settings.
struct Measured {
    scene: &'static str,
    curves: [Vec<(f64, f64)>; 3],
    failures: [Vec<(f64, String)>; 3],
    bar: f64,
}

impl Measured {
    fn chart(&self) -> Lines {
        let axes = (Axis::log("detections and solves", ""), Axis::log("error", "of the size"));
        let mut chart = Lines::new(self.scene, axes.0, axes.1);
        for ((name, curve), failures) in Way::NAMES.iter().zip(&self.curves).zip(&self.failures) {
            let mut series = Series::new(name, curve.iter().copied());
            for (x, reason) in failures {
                series = series.failed(*x, reason.clone());
            }
            chart = chart.with(series);
        }
        chart
    }

    /// The way of the least work at an error.
    fn cheapest(&self, error: f64) -> Option<(&'static str, f64)> {
        let of = |k: usize| Some((Way::NAMES[k], cost_at(error, &self.curves[k])?));
        let found = (0..3).filter_map(of);
        found.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn measure(scene: &Scene, size: Size, table: &mut Table) -> Result<Measured, StudyError> {
    let truth = truth(scene).map_err(StudyError::at(scene.name))?;
    let bar = truth.bar / scene.size;
    let mut measured = Measured {
        scene: scene.name,
        curves: Default::default(),
        failures: Default::default(),
        bar,
    };
    for way in ways(scene, size) {
        let kind = Way::NAMES.iter().position(|name| *name == way.name()).unwrap_or_default();
        let head = [scene.name.into(), way.name().into(), Cell::from(way.setting())];
        let cells: [Cell; 5] = match run(scene, way) {
            Ok(run) => {
                // What is closer to the limit than that is known counts as that close.
                let error = (apart(&run.places, &truth.places) / scene.size).max(bar);
                measured.curves[kind].push((run.work as f64, error));
                let settled = if run.settled { "yes" } else { "no" };
                [
                    error.into(),
                    bar.into(),
                    (run.work as u64).into(),
                    settled.into(),
                    run.seconds.into(),
                ]
            }
            Err(error) => {
                let last = measured.curves[kind].last().map_or(1e3, |point| point.0);
                measured.failures[kind].push((3.0 * last, error.to_string()));
                let words = match error {
                    ContactError::StepTooShort { .. } => "step too short",
                    ContactError::TooManyImpacts { .. } => "too many impacts",
                    ContactError::TooManySteps { .. } => "too many steps",
                    _ => "failed",
                };
                let none = || Cell::from("-");
                [words.into(), bar.into(), none(), none(), none()]
            }
        };
        table.push(head.into_iter().chain(cells));
    }
    Ok(measured)
}

fn claims(measured: &[Measured]) -> Vec<Claim> {
    let of = |name: &str, way: usize| {
        measured.iter().find(|m| m.scene == name).map_or(&[][..], |m| &m.curves[way][..])
    };
    let last = |curve: &[(f64, f64)]| curve.last().map_or(f64::NAN, |point| point.1);
    let worst = of("block", 1).iter().zip(ASKED).map(|(point, asked)| point.1 / asked);
    let slope = |curve: &[(f64, f64)]| loglog_slope(curve).map_or(f64::NAN, |slope| -slope);
    vec![
        Claim::number(
            "block: the largest error of chosen steps over the accuracy asked for",
            "below 1",
            worst.fold(0.0, f64::max),
            (0.0, 1.0),
        ),
        Claim::number(
            "corner: the largest error at the instant",
            "below 1e-8",
            of("corner", 2).iter().map(|point| point.1).fold(0.0, f64::max),
            (0.0, 1e-8),
        ),
        Claim::number(
            "cradle: error at the instant",
            "below 1e-8",
            last(of("cradle", 2)),
            (0.0, 1e-8),
        ),
        Claim::number(
            "block: order of fixed steps, by work",
            "1",
            slope(of("block", 0)),
            (0.7, 1.6),
        ),
        Claim::number(
            "corner: the largest error of chosen steps over the accuracy asked for",
            "below 1",
            of("corner", 1)
                .iter()
                .zip(ASKED)
                .map(|(point, asked)| point.1 / asked)
                .fold(0.0, f64::max),
            (0.0, 1.0),
        ),
    ]
}

fn study(size: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("scene"),
        Column::exact("way"),
        Column::rounded("setting [s or m]", 2, 1e-12),
        Column::rounded("error [of the size]", 1, 1e-8),
        Column::rounded("error bar [of the size]", 1, 1e-8),
        Column::rounded("detections and solves", 1, 1.0),
        Column::exact("settled"),
        Column::volatile("wall [s]"),
    ]);
    let scenes = scenes().map_err(StudyError::at("the scenes"))?;
    let measured: Vec<Measured> =
        scenes.iter().map(|scene| measure(scene, size, &mut table)).collect::<Result<_, _>>()?;
    let mut cheapest = Vec::new();
    for asked in ASKED {
        let wins = |name: &str| {
            let won = |m: &&Measured| {
                m.bar <= asked && m.cheapest(asked).is_some_and(|(way, _)| way == name)
            };
            let scenes: Vec<&str> = measured.iter().filter(won).map(|m| m.scene).collect();
            match scenes.len() {
                0 => format!("{name} nowhere"),
                _ => format!("{name} on {}", scenes.join(", ")),
            }
        };
        cheapest.push(format!("{asked:.0e}: {}", Way::NAMES.map(wins).join("; ")));
    }
    Ok(Study {
        conclusion: format!(
            "Eight scenes, the largest error of centres, and of points a size away from them, at ten moments, against closed forms or the limit \
             of small steps, whose own error bar is in the table; below it nothing is claimed. Least work \
             by the error that is allowed. {}. Where a way fails its reason stands on the chart.",
            cheapest.join(". ")
        ),
        table,
        charts: measured.iter().map(|m| m.chart().into()).collect(),
        claims: claims(&measured),
        ..CONTACT_WORK_PRECISION.heading()
    })
}
