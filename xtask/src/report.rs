//! The report: runs the studies, writes the page, the numbers and the charts, and says what broke.

mod csv;
mod files;
mod inline;
mod json;
mod machine;
mod measure;
mod merge;
mod page;
mod shard;
mod summary;

#[cfg(test)]
mod fake;

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use stationary_chart::{ChartError, Layout, Medium, Styles};

use crate::study::{Entry, Size, Study, StudyError};
pub(crate) use csv::csv;
pub(crate) use files::Folder;
pub use machine::Machine;
use measure::measure;
pub(crate) use measure::{bar, side_by_side};
pub use merge::{MergeError, merge};
pub(crate) use merge::{Shared, gather};
pub use shard::{Shard, ShardError, shard};
pub(crate) use summary::aligned;
pub use summary::{catalogue, summary};

/// What to run, and where to write it.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The studies, in the order of the page.
    pub entries: Vec<Entry<'a>>,
    /// Names that keep their look whatever is run.
    pub methods: Vec<&'static str>,
    /// How much of each study to run.
    pub size: Size,
    /// The folder to write to; made if it is missing.
    pub out: PathBuf,
    /// Whether a person watches.
    pub progress: Progress,
}

/// Whether a progress bar is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// On standard error, where that is a terminal.
    Shown,
    /// Never.
    Hidden,
}

/// A study that was run.
#[derive(Debug)]
pub struct Outcome<'a> {
    /// Which study.
    pub entry: Entry<'a>,
    /// How long it ran.
    pub wall: Duration,
    /// Its numbers, or why there are none.
    pub result: Result<Study, StudyError>,
}

impl Outcome<'_> {
    /// What went wrong, a line each: claims that do not hold, or the study's error.
    pub fn failures(&self) -> Vec<String> {
        let id = self.entry.id;
        match &self.result {
            Err(error) => vec![format!("{id}: {error}")],
            Ok(study) => {
                let broken = study.claims.iter().filter(|claim| !claim.holds());
                broken
                    .map(|claim| {
                        let (measured, expected) = (claim.evidence.words(), &claim.expected);
                        format!("{id}: {}: measured {measured}, expected {expected}", claim.text)
                    })
                    .collect()
            }
        }
    }

    /// How many claims hold, of how many.
    pub fn held(&self) -> (usize, usize) {
        let claims = self.result.as_ref().map_or(&[][..], |study| &study.claims);
        (claims.iter().filter(|claim| claim.holds()).count(), claims.len())
    }
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A study was asked for that is not in the list.
    #[error("there is no study `{asked}`{}", hint(nearest))]
    UnknownStudy {
        /// The name asked for.
        asked: String,
        /// The most similar name in the list.
        nearest: Option<String>,
    },
    /// A file or folder of the report cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Unwritable {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A chart says what no drawing can show.
    #[error("{file}: {source}")]
    Chart {
        /// The file in which it would be.
        file: String,
        /// What is wrong with it.
        source: ChartError,
    },
    /// A share of the report has no TOML form.
    #[error("shard.toml: {0}")]
    Toml(#[from] toml::ser::Error),
    /// The numbers have no JSON form.
    #[error("report.json: {0}")]
    Json(#[from] serde_json::Error),
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or(String::new(), |name| format!("; did you mean `{name}`?"))
}

/// The entries with these ids, in the order of the list; all of them where none is named.
///
/// # Errors
/// [`ReportError::UnknownStudy`] with the most similar name.
pub fn select<'a>(entries: &[Entry<'a>], only: &[String]) -> Result<Vec<Entry<'a>>, ReportError> {
    if let Some(asked) = only.iter().find(|id| entries.iter().all(|entry| entry.id != **id)) {
        let similarity = |entry: &&Entry| strsim::jaro_winkler(asked, entry.id);
        let nearest = entries
            .iter()
            .max_by(|a, b| similarity(a).total_cmp(&similarity(b)))
            .map(|entry| entry.id.to_owned());
        return Err(ReportError::UnknownStudy { asked: asked.clone(), nearest });
    }
    let wanted = |entry: &&Entry| only.is_empty() || only.iter().any(|id| id == entry.id);
    Ok(entries.iter().filter(wanted).copied().collect())
}

/// Runs every study of the plan and writes the report. A study that fails is in the report with its
/// reason; only what prevents the report itself is an error.
///
/// # Errors
/// [`ReportError::Unwritable`], before the first study is run if the folder is to blame.
pub fn report<'a>(plan: &Plan<'a>) -> Result<Vec<Outcome<'a>>, ReportError> {
    let folder = Folder::open(&plan.out)?;
    let outcomes = measure(plan);
    write(&folder, &Machine::read(), plan, &outcomes)?;
    Ok(outcomes)
}

fn write(
    folder: &Folder,
    machine: &Machine,
    plan: &Plan<'_>,
    outcomes: &[Outcome<'_>],
) -> Result<(), ReportError> {
    let charts = outcomes.iter().filter_map(|o| o.result.as_ref().ok()).flat_map(|s| &s.charts);
    let names: Vec<Vec<String>> = charts.map(|chart| chart.names()).collect();
    let styles = Styles::assign(&plan.methods, &names);
    for study in outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()) {
        folder.write(&format!("{}.csv", study.id), &csv(&study.table))?;
        for (i, chart) in study.charts.iter().enumerate() {
            let file = chart_file(study.id, i);
            match chart.svg(Layout::Wide, Medium::File, &styles, &study.conclusion) {
                Ok(svg) => folder.write(&file, &svg)?,
                Err(source) => return Err(ReportError::Chart { file, source }),
            }
        }
    }
    folder.write("report.json", &json::json(machine, outcomes)?)?;
    folder.write("index.html", &page::page(machine, plan.size, outcomes, &styles))
}

/// `kepler.svg`, `kepler-2.svg`, ...
fn chart_file(id: &str, i: usize) -> String {
    if i == 0 { format!("{id}.svg") } else { format!("{id}-{}.svg", i + 1) }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// A new empty folder in the system's temporary folder.
    fn empty_folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("xtask-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        path
    }

    fn fake_report(out: &Path, only: &[&str]) -> Vec<Outcome<'static>> {
        let only: Vec<String> = only.iter().map(|id| (*id).to_owned()).collect();
        let entries = select(fake::STUDIES, &only).unwrap();
        let (size, progress) = (Size::Default, Progress::Hidden);
        report(&Plan { entries, methods: Vec::new(), size, out: out.into(), progress }).unwrap()
    }

    #[test]
    fn a_report_has_a_page_its_numbers_and_a_file_for_each_chart() {
        let out = empty_folder("files");
        fake_report(&out, &["fake-convergence", "fake-portrait"]);
        let mut files: Vec<String> = fs::read_dir(&out)
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        files.sort();
        let expected = [
            "fake-convergence-2.svg",
            "fake-convergence.csv",
            "fake-convergence.svg",
            "fake-portrait.csv",
            "fake-portrait.svg",
            "index.html",
            "report.json",
        ];
        assert_eq!(files, expected);
        fs::remove_dir_all(&out).unwrap();
    }

    #[test]
    fn a_study_without_a_table_is_in_the_report_with_its_reason() {
        let out = empty_folder("error");
        let outcomes = fake_report(&out, &["fake-error"]);
        let reason = "the reference orbit: no convergence";
        assert_eq!(outcomes[0].failures(), [format!("fake-error: {reason}")]);
        for file in ["index.html", "report.json"] {
            let text = fs::read_to_string(out.join(file)).unwrap();
            assert!(text.contains(reason), "{file}");
        }
        fs::remove_dir_all(&out).unwrap();
    }

    #[test]
    fn a_claim_that_does_not_hold_is_one_line() {
        let out = empty_folder("claim");
        let outcomes = fake_report(&out, &["fake-work-precision"]);
        let line =
            "fake-work-precision: RK4 is cheapest at 1e-4: measured symplectic 4, expected RK4";
        assert_eq!(outcomes[0].failures(), [line]);
        assert_eq!(outcomes[0].held(), (2, 3));
        fs::remove_dir_all(&out).unwrap();
    }

    #[test]
    fn an_unknown_study_is_answered_with_the_nearest_one() {
        let error = select(fake::STUDIES, &["fake-convergense".into()]).unwrap_err();
        let said = "there is no study `fake-convergense`; did you mean `fake-convergence`?";
        assert_eq!(error.to_string(), said);
        let error = select(&[], &["any".into()]).unwrap_err();
        assert_eq!(error.to_string(), "there is no study `any`");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named_before_anything_runs() {
        let file = empty_folder("taken");
        fs::write(&file, "a file, not a folder").unwrap();
        let out = file.join("report");
        let plan = Plan {
            entries: fake::STUDIES.to_vec(),
            methods: Vec::new(),
            size: Size::Default,
            out: out.clone(),
            progress: Progress::Hidden,
        };
        let error = report(&plan).unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot write {}", out.display())), "{error}");
        fs::remove_file(&file).unwrap();
    }

    #[test]
    #[ignore = "writes target/fake-report, to look at the charts without running a study"]
    fn fake_report_for_the_eye() {
        let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fake-report");
        fake_report(&target, &[]);
    }
}
