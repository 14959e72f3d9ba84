//! The studies of a user's own scene: the long form of `choose`, and what is kept at the scene's own step.
//!
//! The first asks the same question in the same way, and then charts every method. The second runs every
//! method of equal steps at the step of the file.

use std::path::Path;
use std::time::Duration;

use stationary::program::ladder_of;
use stationary_chart::{Axis, Lines, Series};
use stationary_choose::{
    Answer, At, Experiment, Judgement, Kind as SettingKind, MeasuredRuns, Row, answer, chart,
    charted,
};
use stationary_measure::{Cell, Column, Table};
use stationary_scene::choose::{Change, Question, SceneLadder, changed};
use stationary_scene::{Run, Scene};

use crate::study::{Claim, Entry, Kind, Measure, Study, StudyError, Tested};

/// Errors for which a method is named.
const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Samples of a run whose invariants are followed.
const SAMPLES: u64 = 2000;

/// The entries of both studies, given how each is made: [`work_precision`] and [`long_run`].
pub fn entries<'a>(work_precision: &'a Measure<'a>, long_run: &'a Measure<'a>) -> Vec<Entry<'a>> {
    vec![labels(&WORK_PRECISION, work_precision), labels(&LONG_RUN, long_run)]
}

type Labels = (&'static str, Kind, &'static str);

const WORK_PRECISION: Labels =
    ("scene-work-precision", Kind::WorkPrecision, "What a digit costs in your scene");
const LONG_RUN: Labels =
    ("scene-long-run", Kind::LongRun, "Energy and momentum in your scene, at its own step");

fn labels<'a>(&(id, kind, title): &Labels, run: &'a Measure<'a>) -> Entry<'a> {
    let tested = Tested::ByReport;
    Entry { id, krate: "scene", chapter: "your scene", kind, title, tested, run }
}

/// What is asked of a scene where nothing else is said: the first observable that its file names, else
/// the place of the first thing that moves, or the Dirichlet energy of heat.
///
/// # Errors
/// Where the file is no scene.
pub fn observable(file: &Path) -> Result<String, StudyError> {
    let name = file.display().to_string();
    let text = std::fs::read_to_string(file).map_err(StudyError::at(name.as_str()))?;
    let scene = Scene::parse_at(&name, &text).map_err(StudyError::at(name.as_str()))?;
    let moves = |particle: &&stationary_scene::Particle| {
        particle.motion != stationary_scene::Motion::Pinned
    };
    let first = || match scene.particles().iter().find(moves) {
        _ if scene.heat().is_some() => "dirichlet-energy".to_owned(),
        Some(particle) => format!("position={}", particle.name),
        None => "energy".to_owned(),
    };
    Ok(named(&text).unwrap_or_else(first))
}

/// The first observable of a file, as a word of the command line: `energy`, `distance=sun,pluto`.
fn named(text: &str) -> Option<String> {
    let table: toml::Table = toml::from_str(text).ok()?;
    match table.get("observables")?.as_array()?.first()? {
        toml::Value::String(word) => Some(word.clone()),
        toml::Value::Table(declared) => {
            let (word, names) = declared.iter().next()?;
            let names = match names {
                toml::Value::Array(names) => {
                    names.iter().map(|name| name.as_str()).collect::<Option<Vec<_>>>()?.join(",")
                }
                name => name.as_str()?.to_owned(),
            };
            Some(format!("{word}={names}"))
        }
        _ => None,
    }
}

/// The question of `choose`, answered in the same way, with every method charted.
///
/// # Errors
/// Where the question cannot be asked.
pub fn work_precision(
    file: &Path,
    question: &Question,
    tolerance: f64,
    budget: Duration,
) -> Result<Study, StudyError> {
    let name = file.display().to_string();
    let ladder = ladder_of(file, question).map_err(StudyError::at(name.as_str()))?;
    let mut runs = MeasuredRuns::new(&ladder, budget).map_err(StudyError::at(name.as_str()))?;
    let answer = answer(&mut runs, tolerance).map_err(StudyError::at(name.as_str()))?;
    let answer = charted(&mut runs, answer);
    let confirmed = answer.reference.as_ref().is_some_and(|reference| reference.is_confirmed);
    Ok(Study {
        id: WORK_PRECISION.0,
        krate: "scene",
        chapter: "your scene",
        kind: WORK_PRECISION.1,
        title: format!("{}: what a digit costs", runs.ladder().title),
        conclusion: advice(&answer, &runs),
        table: answer.table(),
        charts: vec![chart(&answer), by_time(&answer).into()],
        claims: vec![Claim::words(
            "another method confirms the reference that errors are taken against",
            "yes",
            if confirmed { "yes" } else { "no" }.to_owned(),
        )],
        answers: Vec::new(),
    })
}

/// What was chosen, and what to write into the scene's file for other errors.
fn advice(answer: &Answer, runs: &MeasuredRuns<'_>) -> String {
    let uncertainty = answer.reference.as_ref().map_or(f64::INFINITY, |made| made.uncertainty);
    let meets = |row: &&Row, tolerance: f64| {
        let errs = match row.judgement {
            Some(
                Judgement::Meets(error) | Judgement::Unclear(error) | Judgement::Misses(error),
            ) => error,
            _ => return false,
        };
        // What was stopped has no error of the whole way; models are not what the file says.
        row.is_whole() && runs.family(row.at.family).model == 0 && errs + uncertainty <= tolerance
    };
    let lines = TOLERANCES.into_iter().filter_map(|tolerance| {
        // Rows are sorted by work.
        let row = answer.rows.iter().find(|row| meets(row, tolerance))?;
        Some(format!("for {tolerance:e}: integrator = \"{}\" and {}", row.method, row.setting))
    });
    let chosen = match answer.choice() {
        Some(row) => format!(
            "Within {:e} the cheapest is {} with {}, at {} differentials. ",
            answer.tolerance, row.method, row.setting, row.work
        ),
        None => format!("Nothing is recommended within {:e}. ", answer.tolerance),
    };
    let lines: Vec<String> = lines.collect();
    let lines = if lines.is_empty() { "nothing".to_owned() } else { lines.join("; ") };
    let beside = answer.beside();
    let beside = beside.iter().map(|line| format!("{}. ", capital(line)));
    format!(
        "{}. {chosen}{}By their errors at the moments, in the scene's file: {lines}. Reference: {}.",
        answer.heading,
        beside.collect::<String>(),
        answer.made
    )
}

fn capital(line: &str) -> String {
    let mut letters = line.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn by_time(answer: &Answer) -> Lines {
    let mut lines = Lines::new("By wall time", Axis::log("wall time", "s"), Axis::log("error", ""));
    let mut names: Vec<&str> = answer.rows.iter().map(|row| row.method.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let own = answer.rows.iter().filter(|row| row.method == name && row.is_whole());
        let points = own.filter_map(|row| Some((row.wall.as_secs_f64(), row.error()?.max(1e-16))));
        lines = lines.with(Series::new(name, points));
    }
    lines
}

/// Energy and momenta of every method of equal steps at the scene's own step.
///
/// # Errors
/// Where the file is no scene, or no method takes it.
pub fn long_run(file: &Path) -> Result<Study, StudyError> {
    let name = file.display().to_string();
    let text = std::fs::read_to_string(file).map_err(StudyError::at(name.as_str()))?;
    let written = Scene::parse_at(&name, &text).map_err(StudyError::at(name.as_str()))?;
    let text = changed(&text, &[Change::to("observables", asked(&written))]);
    let scene = Scene::parse_at(&name, &text).map_err(StudyError::at(name.as_str()))?;
    let ladder = SceneLadder::of(&name, &text, &scene).map_err(StudyError::at(name.as_str()))?;
    let mut chart = Lines::new(
        "Energy",
        Axis::log("time", &scene.units().time),
        Axis::log("largest energy error", ""),
    );
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("energy error", 2, 1e-12),
        Column::rounded("linear momentum drift", 2, 1e-12),
        Column::rounded("angular momentum drift", 2, 1e-12),
        Column::exact("evaluations"),
    ]);
    let every = scene.timing().steps().div_ceil(SAMPLES).max(1);
    for (place, family) in ladder.ladder().families.iter().enumerate() {
        if family.model != 0 || family.kind != SettingKind::EqualSteps {
            continue;
        }
        // The method of the family, at the step of the file.
        let own = |change: &&Change| change.key != "step" && change.key != "sample_every";
        let says = &ladder.setting(At { family: place, rung: 0 }).changes;
        let mut changes: Vec<Change> = says.iter().filter(own).cloned().collect();
        changes.push(Change::to("sample_every", every.to_string()));
        let Ok(scene) = Scene::parse_at(&name, &changed(&text, &changes)) else { continue };
        let run = scene.run();
        let (part, end) = match &run {
            Ok(run) => (Some(run), None),
            Err(error) => (error.partial(), Some(error.to_string())),
        };
        let Some(part) = part else { continue };
        let (course, drift) = followed(part);
        let mut series = Series::new(&family.name, course);
        let mut cells: Vec<Cell> = vec![family.name.as_str().into()];
        cells.extend(drift.map(Cell::from));
        let time = part.times().last().copied().unwrap_or_default();
        match end {
            None => cells.push((part.cost().differentials + part.cost().hessians).into()),
            Some(reason) => {
                cells.push(format!("failed after t = {time:.3}").into());
                let first = reason.lines().next().unwrap_or_default().to_owned();
                series = series.failed(time.max(scene.timing().step()), first);
            }
        }
        table.push(cells);
        chart = chart.with(series);
    }
    Ok(Study {
        id: LONG_RUN.0,
        krate: "scene",
        chapter: "your scene",
        kind: LONG_RUN.1,
        title: format!("{}: energy and momentum at its own step", scene.title()),
        conclusion: format!(
            "The scene at its own step of {}, with every method of equal steps. Energy is relative to \
             the kinetic energy at its largest, momenta to the sums of the parts' magnitudes. Drag, \
             friction and heat take energy rightly, gravity towards a floor and pinned particles change \
             momenta rightly; then they say nothing of a method.",
            scene.timing().step()
        ),
        table,
        charts: vec![chart.into()],
        claims: Vec::new(),
        answers: Vec::new(),
    })
}

/// The momenta, where the scene has them.
fn asked(scene: &Scene) -> &'static str {
    match scene.dimension() {
        _ if scene.heat().is_some() => "[\"heat\"]",
        1 => "[\"linear-momentum\"]",
        _ => "[\"linear-momentum\", \"angular-momentum\"]",
    }
}

/// The largest change of energy up to each sample, and that of the energy and of both momenta in all.
fn followed(run: &Run) -> (Vec<(f64, f64)>, [f64; 3]) {
    let energies = run.energies();
    let kinetic = run.kinetic_energies().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let scales = run.momentum_scales().map(|scale| scale.max(f64::MIN_POSITIVE));
    let (mut course, mut drift) = (Vec::new(), [0.0_f64; 3]);
    let heat = run.scene().heat().is_some();
    let linear = run.scene().dimension();
    for (sample, &time) in run.times().iter().enumerate() {
        let energy = energies.get(sample).zip(energies.first());
        let energy = energy.map_or(0.0, |(now, start)| (now - start).abs());
        drift[0] = drift[0].max(if heat { 0.0 } else { energy / kinetic });
        let off = |from: usize, to: usize| {
            let (now, start) = (run.observed(sample), run.observed(0));
            let pairs = now.iter().zip(start).take(to).skip(from);
            pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        if !heat {
            drift[1] = drift[1].max(off(0, linear) / scales[0]);
            drift[2] = drift[2].max(off(linear, usize::MAX) / scales[1]);
        }
        if sample > 0 {
            course.push((time, drift[0]));
        }
    }
    (course, drift)
}
