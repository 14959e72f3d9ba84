//! The family of a scene, and one run of it.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use stationary_scene::choose::asked;
use stationary_scene::{Fault, Parameters, Run, Scene, SceneError};

use super::{Range, SweepError};
use crate::report::{Progress, bar, side_by_side};
use crate::studies::scene::observable;

/// Runs that a sweep may have.
pub const MOST_RUNS: usize = 100_000;

/// A scene whose parameters take several values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Family {
    /// Beside it are the meshes and tables. Shares may have it elsewhere.
    #[serde(skip)]
    file: PathBuf,
    pub(super) title: String,
    /// The scene, asked for the one observable.
    text: String,
    /// The headings of its columns.
    pub(super) headings: Vec<String>,
    pub(super) axes: Vec<Axis>,
}

/// A parameter with its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Axis {
    pub(super) name: String,
    pub(super) values: Vec<f64>,
}

/// A run of the family.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which, from 0: the last parameter's values change fastest.
    pub run: usize,
    /// What each column of the observable came to, or why the run failed.
    pub result: Result<Vec<Seen>, String>,
}

/// What a column of the observable came to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seen {
    /// At the horizon.
    pub end: f64,
    /// The largest of all samples.
    pub largest: f64,
    /// The smallest of all samples.
    pub smallest: f64,
}

impl Family {
    /// The family of the scene in `file`, asked for an observable as `choose` is; for the first of
    /// the file where none is named.
    ///
    /// # Errors
    /// [`SweepError`], before anything is run.
    pub fn read(
        file: &Path,
        ranges: &[Range],
        asked_for: Option<&str>,
    ) -> Result<Self, SweepError> {
        if ranges.is_empty() {
            return Err(SweepError::Nothing);
        }
        let counts: Vec<usize> = ranges.iter().map(|range| range.count).collect();
        if !are_few(&counts) {
            return Err(SweepError::TooMany { counts });
        }
        Scene::read(file)?;
        let unreadable = |source| SweepError::Unreadable { path: file.to_owned(), source };
        let text = fs::read_to_string(file).map_err(unreadable)?;
        for (i, range) in ranges.iter().enumerate() {
            if ranges[..i].iter().any(|other| other.name == range.name) {
                return Err(range.misnamed(format!("`{}` is given twice", range.name)).into());
            }
            known(file, &text, range)?;
        }
        let asked_for = asked_for.map_or_else(|| observable(file), |name| Ok(name.to_owned()))?;
        let text = asked(&file.display().to_string(), &text, &asked_for)?;
        let scene = Scene::parse_at(file, &text)?;
        let axis = |range: &Range| Axis {
            name: range.name.clone(),
            values: (0..range.count).map(|i| range.value(i)).collect(),
        };
        Ok(Family {
            file: file.to_owned(),
            title: scene.title().to_owned(),
            text,
            headings: headings(&scene),
            axes: ranges.iter().map(axis).collect(),
        })
    }

    /// Whether it has runs and columns, and not too many of them, as one that was read has.
    pub(super) fn is_sound(&self) -> bool {
        let counts: Vec<usize> = self.axes.iter().map(|axis| axis.values.len()).collect();
        !self.headings.is_empty() && !counts.is_empty() && !counts.contains(&0) && are_few(&counts)
    }

    /// How many runs it has.
    pub fn runs(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// The values of the parameters in a run, in their order.
    pub fn values(&self, run: usize) -> Vec<f64> {
        let mut left = run;
        let mut values = Vec::with_capacity(self.axes.len());
        for axis in self.axes.iter().rev() {
            values.push(axis.values[left % axis.values.len()]);
            left /= axis.values.len();
        }
        values.reverse();
        values
    }

    /// These runs, side by side.
    pub(super) fn rows(&self, runs: Vec<usize>, progress: Progress) -> Vec<Row> {
        let bar = bar(runs.len(), progress);
        let rows = side_by_side(&runs, |run| {
            let result = self.run(run);
            bar.inc(1);
            Row { run, result }
        });
        bar.finish_and_clear();
        rows
    }

    fn run(&self, run: usize) -> Result<Vec<Seen>, String> {
        let values = self.axes.iter().zip(self.values(run));
        let parameters =
            values.fold(Parameters::new(), |all, (axis, value)| all.with(&axis.name, value));
        let scene = Scene::parse_with(&self.file, &self.text, &parameters).map_err(first_line)?;
        let columns = headings(&scene).len();
        if columns != self.headings.len() {
            let own = self.headings.len();
            return Err(format!("the observable has {columns} numbers, in the file's own {own}"));
        }
        let run = scene.run().map_err(first_line)?;
        (0..columns).map(|column| seen(&run, column)).collect()
    }
}

/// Whether so many values of each parameter make at most [`MOST_RUNS`] runs.
fn are_few(counts: &[usize]) -> bool {
    let runs = counts.iter().try_fold(1_usize, |runs, &count| runs.checked_mul(count));
    runs.is_some_and(|runs| runs <= MOST_RUNS)
}

fn seen(run: &Run, column: usize) -> Result<Seen, String> {
    let values = (0..run.times().len()).filter_map(|sample| run.observed(sample).get(column));
    let mut seen: Option<Seen> = None;
    for &value in values {
        let before = seen.unwrap_or(Seen { end: value, largest: value, smallest: value });
        let (largest, smallest) = (before.largest.max(value), before.smallest.min(value));
        seen = Some(Seen { end: value, largest, smallest });
    }
    seen.ok_or_else(|| "the run has no samples".to_owned())
}

fn headings(scene: &Scene) -> Vec<String> {
    scene.observables().iter().flat_map(|observable| observable.headings(scene)).collect()
}

/// Whether the scene has the parameter. What its values come to is found by the runs.
fn known(file: &Path, text: &str, range: &Range) -> Result<(), SweepError> {
    let value = Parameters::new().with(&range.name, range.from);
    let Err(SceneError::Invalid(wrong)) = Scene::parse_with(file, text, &value) else {
        return Ok(());
    };
    let Fault::UnknownWord { kind: "parameter", nearest, allowed, .. } = &wrong.fault else {
        return Ok(());
    };
    let hint = match (nearest, allowed.as_slice()) {
        (Some(name), _) => format!("; did you mean `{name}`?"),
        (None, []) => "; the file has no [parameters]".to_owned(),
        (None, names) => format!("; the file has `{}`", names.join("`, `")),
    };
    let reason = format!("the scene has no parameter `{}`{hint}", range.name);
    Err(range.misnamed(reason).into())
}

/// What an error says first: the rest shows the place in the file, which is the same for all runs.
fn first_line(error: impl Display) -> String {
    let said = error.to_string();
    let line = said.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_owned()
}
