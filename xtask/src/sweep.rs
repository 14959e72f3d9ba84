//! A family of a scene: every observable's end, largest and smallest value against its parameters.
//!
//! ```text
//! --set L=0.1:1.0:10 --set M=1:2:3      30 runs, the last parameter's values the fastest
//! sweep.csv                             a row a run: parameters, values, and why there are none
//! sweep.svg                             the values against the first parameter, crosses where a run failed
//! sweep.toml                            of a share, every bit of its runs, for `merge`
//! ```
//! A run that fails is a row and a cross; only what prevents the sweep itself is an error.

mod family;
mod range;
mod share;
mod show;

use std::path::{Path, PathBuf};

use stationary_scene::SceneError;
use stationary_scene::choose::ChooseError;

pub use family::{Family, MOST_RUNS, Row};
pub use range::{Range, RangeError};
pub use share::{is_share, merge, shard};

use crate::report::{Folder, Progress, ReportError};
use crate::study::StudyError;

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The file is no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene has no such observable.
    #[error(transparent)]
    Observable(#[from] ChooseError),
    /// The scene has no observable of its own to begin with.
    #[error(transparent)]
    Default(#[from] StudyError),
    /// The scene cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// No parameter was given values.
    #[error("a sweep needs a parameter with values, such as --set L=0.1:1.0:10")]
    Nothing,
    /// A parameter that the scene does not have, or that is given twice.
    #[error(transparent)]
    Parameter(#[from] RangeError),
    /// More runs than a sweep may have.
    #[error("the sweep has {} runs; it may have {MOST_RUNS}", product(counts))]
    TooMany {
        /// How many values each parameter has.
        counts: Vec<usize>,
    },
    /// The folder or a file in it cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
}

fn product(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

/// Runs the family and writes its table and its chart.
///
/// # Errors
/// [`SweepError::Report`], before the first run if the folder is to blame.
pub fn sweep(family: &Family, out: &Path, progress: Progress) -> Result<Vec<Row>, SweepError> {
    let folder = Folder::open(out)?;
    let rows = family.rows((0..family.runs()).collect(), progress);
    show::write(family, &rows, &folder)?;
    Ok(rows)
}

/// How many runs there are, and which failed, a line each.
pub fn failures(rows: &[Row]) -> Vec<String> {
    let failed = |row: &Row| row.result.as_ref().err().map(|reason| (row.run, reason.clone()));
    rows.iter().filter_map(failed).map(|(run, why)| format!("run {}: {why}", run + 1)).collect()
}
