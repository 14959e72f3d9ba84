//! The answer: the choice with its error and its cost, what else would do, and what failed and how.

use std::fmt;
use std::time::Duration;

use stationary_measure::{Cell, Column, Table};

use crate::effort::Effort;
use crate::ladder::{At, Ladder, MOMENTS};
use crate::ladder_search::{Judgement, judge};
use crate::measured::{End, Failure};
use crate::measured_runs::MeasuredRuns;
use crate::reference::{Extrapolated, Reference};
use crate::refinement::MeshError;
use crate::seen::{PlaceOff, Seen};
use crate::verify::Doubt;

/// What is recommended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// This rung.
    Chosen(At),
    /// This rung, by a reference that no run of another kind agrees with.
    Unconfirmed(At),
    /// No rung that was run meets the tolerance.
    NoneMeets,
    /// The reference is too uncertain to judge by.
    Uncertain,
    /// The reference is not trusted.
    Doubtful(Doubt),
    /// The observable hardly moves: its scale is rounding.
    Still,
}

/// A rung that was run.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its place.
    pub at: At,
    /// The method, and the model where that is not what was asked about itself.
    pub method: String,
    /// `step = 0.5`, `tolerance = 1e-3` or `modes = 4`.
    pub setting: String,
    /// Counted work.
    pub work: u64,
    /// Wall time of the one run.
    pub wall: Duration,
    /// The last moment to which it was run.
    pub moment: usize,
    /// What the reference says of it; nothing where there is none.
    pub judgement: Option<Judgement>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The observable in words, and what its errors are relative to.
    pub heading: String,
    /// The error that may be made.
    pub tolerance: f64,
    /// What is recommended.
    pub verdict: Verdict,
    /// Every rung that was run, by increasing work.
    pub rows: Vec<Row>,
    /// What rungs were judged by.
    pub reference: Option<Reference>,
    /// How the reference was made, in words.
    pub made: String,
    /// What the choice is over its whole way.
    pub seen: Option<Seen>,
    /// Names of the things whose places were looked at.
    pub placed: Vec<String>,
    /// What is known of the mesh's own error; nothing where there is none.
    pub mesh: Option<MeshError>,
    /// The work of all runs.
    pub spent: Effort,
}

impl Answer {
    pub(super) fn without_reference(runs: &MeasuredRuns<'_>, tolerance: f64) -> Self {
        Answer {
            heading: heading(runs, None),
            tolerance,
            verdict: Verdict::Uncertain,
            rows: rows(runs, None, tolerance),
            reference: None,
            made: "no method came to a reference: none ran to the end at two rungs".to_owned(),
            seen: None,
            placed: runs.ladder().placed.clone(),
            mesh: None,
            spent: runs.effort(),
        }
    }

    pub(super) fn of(
        runs: &MeasuredRuns<'_>,
        reference: Reference,
        tolerance: f64,
        verdict: Verdict,
    ) -> Self {
        Answer {
            heading: heading(runs, Some(&reference)),
            tolerance,
            verdict,
            rows: rows(runs, Some(&reference), tolerance),
            made: made(runs, &reference),
            seen: None,
            placed: runs.ladder().placed.clone(),
            mesh: None,
            reference: Some(reference),
            spent: runs.effort(),
        }
    }

    /// The same with what the choice was seen to be over its whole way, which is its error.
    pub(super) fn seen(mut self, seen: Seen) -> Self {
        if let Verdict::Chosen(at) | Verdict::Unconfirmed(at) = self.verdict {
            for row in self.rows.iter_mut().filter(|row| row.at == at) {
                if let Some(Judgement::Meets(error)) = &mut row.judgement {
                    *error = error.max(seen.error);
                }
            }
        }
        self.seen = Some(seen);
        self
    }

    /// What was looked at beside the observable's error at the moments, in words.
    pub fn beside(&self) -> Vec<String> {
        let (Some(seen), Some(row)) = (&self.seen, self.choice()) else { return Vec::new() };
        let steps = match row.setting.starts_with("modes") {
            true => "parts of the horizon",
            false => "its steps",
        };
        let which = match (seen.steps, seen.every) {
            (Some(count), _) => format!("at the end of {steps} and within {count} of them"),
            (None, 1) => format!("in and at the end of each of {steps}"),
            (None, every) => format!("in and at the end of every {every}th of {steps}"),
        };
        let mut said = vec![format!(
            "over its whole way the error is at most {:.1e}, sampled at {} moments, {which}",
            seen.error, seen.moments
        )];
        let off = [
            seen.energy.map(|off| format!("the energy by {off:.1e} of the largest kinetic energy")),
            seen.places.map(|off| {
                format!("positions by {off:.1e} of the largest way{}", self.farthest(seen.place))
            }),
        ];
        let off: Vec<String> = off.into_iter().flatten().collect();
        if !off.is_empty() {
            said.push(format!("besides what was asked it is off: {}", off.join(", ")));
        }
        said.extend(self.mesh.as_ref().map(ToString::to_string));
        said
    }

    /// The name of the thing whose place is off the most, with its own way, in words.
    pub fn farthest(&self, place: Option<PlaceOff>) -> String {
        let named = place.and_then(|place| Some((self.placed.get(place.thing)?, place)));
        named.map_or(String::new(), |(name, PlaceOff { off, way, .. })| {
            format!(" (`{name}` the most, by {off:.1e} on a way of {way:.1e})")
        })
    }

    /// The recommended rung.
    pub fn choice(&self) -> Option<&Row> {
        let (Verdict::Chosen(at) | Verdict::Unconfirmed(at)) = self.verdict else { return None };
        self.rows.iter().find(|row| row.at == at)
    }

    /// The cheapest rung of each other method that meets the tolerance, by increasing work.
    pub fn runners_up(&self) -> Vec<&Row> {
        let mut seen: Vec<usize> = self.choice().map(|row| row.at.family).into_iter().collect();
        let mut meeting = |row: &&Row| {
            let meets = matches!(row.judgement, Some(Judgement::Meets(_)));
            let first = meets && !seen.contains(&row.at.family);
            seen.extend(first.then_some(row.at.family));
            first
        };
        self.rows.iter().filter(|row| meeting(row)).collect()
    }

    /// The last rung of each method that does not meet the tolerance.
    pub fn failed(&self) -> Vec<&Row> {
        let missing = |row: &&Row| !matches!(row.judgement, Some(Judgement::Meets(_)));
        let finer = |row: &Row| {
            self.rows
                .iter()
                .filter(missing)
                .any(|other| other.at.family == row.at.family && other.at.rung > row.at.rung)
        };
        self.rows.iter().filter(missing).filter(|row| !finer(row)).collect()
    }

    /// Every rung that was run, as a table: wall times are in no snapshot of it.
    pub fn table(&self) -> Table {
        let mut table = Table::new([
            Column::exact("method"),
            Column::exact("setting"),
            Column::rounded("work", 2, 0.0),
            Column::rounded("error", 2, 1e-11),
            Column::exact("verdict"),
            Column::volatile("wall [s]"),
        ]);
        for row in &self.rows {
            let error: Cell = row.error().map_or("".into(), Cell::from);
            table.push([
                row.method.as_str().into(),
                row.setting.as_str().into(),
                (row.work as f64).into(),
                error,
                row.word().into(),
                row.wall.as_secs_f64().into(),
            ]);
        }
        table
    }

    /// Which tolerance to set for this true error: for each method that takes one, the loosest that
    /// was run and keeps to it, and what others gave.
    pub fn tolerances(&self) -> Vec<String> {
        let own: Vec<&Row> =
            self.rows.iter().filter(|row| row.setting.starts_with("tol")).collect();
        let mut names: Vec<&str> = own.iter().map(|row| row.method.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter().map(|name| self.advice(name, &own)).collect()
    }

    fn advice(&self, name: &str, rows: &[&Row]) -> String {
        let of_name = || rows.iter().filter(|row| row.method == name);
        let gave = |row: &Row| {
            let beyond = if row.moment < MOMENTS as usize { "more than " } else { "" };
            Some(format!("{} gives {beyond}{:.1e}", row.value(), row.error()?))
        };
        // Rows are sorted by work: the loosest tolerance first.
        let keeps = of_name().find(|row| matches!(row.judgement, Some(Judgement::Meets(_))));
        let others = of_name().filter(|row| keeps.is_none_or(|keeps| keeps.at != row.at));
        let others: Vec<String> = others.filter_map(|row| gave(row)).collect();
        let others =
            if others.is_empty() { String::new() } else { format!(" ({})", others.join(", ")) };
        let asked = self.tolerance;
        match keeps.and_then(|row| Some((row.value(), row.error()?))) {
            Some((set, error)) => format!(
                "for a true error of at most {asked:e}, {name} needs `tolerance = {set}`: it gives \
                 {error:.1e}{others}"
            ),
            None if of_name().any(|row| row.judgement == Some(Judgement::CostLimit)) => format!(
                "{name} was stopped at the cost limit before it showed which tolerance keeps to \
                 {asked:e}{others}"
            ),
            None => format!("no tolerance that {name} was run with keeps to {asked:e}{others}"),
        }
    }
}

impl Row {
    /// Its error, where it has one.
    pub fn error(&self) -> Option<f64> {
        match &self.judgement {
            Some(
                Judgement::Meets(error) | Judgement::Misses(error) | Judgement::Unclear(error),
            ) => Some(*error),
            _ => None,
        }
    }

    /// Whether it was run to the horizon.
    pub fn is_whole(&self) -> bool {
        self.moment == MOMENTS as usize
    }

    fn value(&self) -> &str {
        self.setting.rsplit(' ').next().unwrap_or_default()
    }

    /// What became of it.
    pub fn word(&self) -> String {
        match &self.judgement {
            Some(Judgement::Meets(_)) => "meets it".to_owned(),
            Some(Judgement::Misses(_)) if self.moment < MOMENTS as usize => {
                format!("misses it, stopped at {} of {MOMENTS}", self.moment)
            }
            Some(Judgement::Misses(_)) => "misses it".to_owned(),
            Some(Judgement::Unclear(_)) => "too close to tell".to_owned(),
            Some(Judgement::CostLimit) => {
                format!("stopped at {} of {MOMENTS}: cost limit", self.moment)
            }
            Some(Judgement::Failed(failure)) => failure.to_string(),
            None => "not judged".to_owned(),
        }
    }
}

fn rows(runs: &MeasuredRuns<'_>, reference: Option<&Reference>, tolerance: f64) -> Vec<Row> {
    let mut rows: Vec<Row> = runs
        .used()
        .map(|(at, run)| Row {
            at,
            method: runs.family(at.family).name.clone(),
            setting: runs.family(at.family).setting(at.rung),
            work: run.work,
            wall: run.wall,
            moment: run.course.values.len().saturating_sub(1),
            judgement: reference.and_then(|reference| {
                let said = judge(runs, reference, tolerance, at)?;
                Some(if reference.is_confirmed { said } else { unconfirmed(said, &run.end) })
            }),
        })
        .collect();
    rows.sort_by_key(|row| (row.work, row.at));
    rows
}

/// What is said against a reference that nothing confirms: a run that came to its end differs from it.
fn unconfirmed(said: Judgement, end: &End) -> Judgement {
    match (said, end) {
        (
            Judgement::Failed(Failure::WrongPhysics(how) | Failure::Unstable(how)),
            End::Whole | End::Stopped,
        ) => Judgement::Failed(Failure::Differs(how)),
        (said, _) => said,
    }
}

fn heading(runs: &MeasuredRuns<'_>, reference: Option<&Reference>) -> String {
    let Ladder { title, observable, scale, horizon, time, .. } = runs.ladder();
    let size = reference.map_or(String::new(), |r| format!(" ({:.3e})", r.course.scale));
    format!(
        "{title}: {observable}, relative to {}{size}, at {MOMENTS} moments up to {horizon} {time}",
        scale.words()
    )
    .trim_end()
    .to_owned()
}

fn made(runs: &MeasuredRuns<'_>, reference: &Reference) -> String {
    let finest = At { family: reference.family, rung: reference.finest };
    let how = match reference.extrapolated {
        Extrapolated::Yes => ", extrapolated to a step of zero",
        Extrapolated::No => "",
    };
    let agreement = runs
        .used()
        .filter(|(at, _)| at.family != reference.family)
        .filter_map(|(at, run)| {
            let error = reference.error(run.whole()?).ok()?;
            Some((error, at))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let others = match agreement {
        Some((error, at)) => format!(
            "; the nearest of another kind, {} at {}, differs from it by {error:.1e}",
            runs.family(at.family).name,
            runs.family(at.family).setting(at.rung)
        ),
        None => "; no run of another kind to compare it with".to_owned(),
    };
    format!(
        "{} at {}{how}, uncertain by {:.1e}{others}",
        runs.family(reference.family).name,
        runs.family(finest.family).setting(finest.rung),
        reference.uncertainty,
    )
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.heading)?;
        let tolerance = self.tolerance;
        match (self.verdict, self.choice()) {
            (Verdict::Chosen(_), Some(row)) => {
                writeln!(f, "cheapest within {tolerance:e}:\n\n{}", shown(&[row]))?
            }
            (Verdict::Unconfirmed(_), Some(row)) => writeln!(
                f,
                "cheapest within {tolerance:e}, if the reference is right, which no run of another \
                 kind confirmed:\n\n{}",
                shown(&[row])
            )?,
            (Verdict::NoneMeets, _) => {
                writeln!(f, "No setting that was run meets {tolerance:e} within the budget.\n")?;
            }
            (Verdict::Still, _) => writeln!(
                f,
                "This observable hardly moves: its scale is rounding, and no error relative to it has \
                 a meaning.\n"
            )?,
            (Verdict::Doubtful(doubt), _) => writeln!(
                f,
                "The reference is not confirmed, and nothing is recommended: {doubt}.\n"
            )?,
            _ => writeln!(f, "The reference is too uncertain to decide at {tolerance:e}.\n")?,
        }
        for line in self.beside() {
            writeln!(f, "{line}")?;
        }
        if self.seen.is_some() {
            writeln!(f)?;
        }
        let moments = format!("runners-up, compared at {MOMENTS} moments");
        for (title, rows) in [(moments.as_str(), self.runners_up()), ("rejected", self.failed())] {
            if !rows.is_empty() {
                writeln!(f, "{title}:\n\n{}", shown(&rows))?;
            }
        }
        for line in self.tolerances() {
            writeln!(f, "{line}")?;
        }
        writeln!(f, "reference: {}", self.made)?;
        match self.choice() {
            Some(row) => writeln!(
                f,
                "search cost: {:.1} x the chosen run ({})",
                self.spent.total() as f64 / row.work.max(1) as f64,
                self.spent.in_runs(row.work)
            ),
            None => writeln!(f, "{} differentials were spent", self.spent.total()),
        }
    }
}

fn shown(rows: &[&Row]) -> Table {
    let names = ["method", "setting", "error", "work", "ms", "verdict"];
    let mut table = Table::new(names.map(Column::exact));
    for row in rows {
        table.push([
            row.method.as_str().into(),
            row.setting.as_str().into(),
            row.error().map_or("-".to_owned(), |error| format!("{error:.1e}")).into(),
            row.work.to_string().into(),
            format!("{:.1}", 1e3 * row.wall.as_secs_f64()).into(),
            row.word().into(),
        ]);
    }
    table
}
