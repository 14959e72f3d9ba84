//! `stationary choose FILE --observable NAME --tolerance 1e-3`: the cheapest way to run a scene.

mod json;
mod time;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use json::json;
use stationary_choose::{Answer, MeasuredRuns, Verdict, answer, picture};
use stationary_scene::Scene;
use stationary_scene::choose::{ChooseError, Question, SceneLadder, emit, emitted, scene_ladder};
pub use time::{TimeError, time};

/// What `choose` is told.
#[derive(Debug, clap::Args)]
pub struct Choose {
    /// The scene, a TOML file.
    file: PathBuf,
    /// What to keep to the tolerance: `energy`, `position=bob`, `distance=sun,pluto`.
    #[arg(long, value_name = "NAME")]
    observable: String,
    /// The error that may be made, relative to the observable's scale.
    #[arg(long, value_name = "ERROR")]
    tolerance: f64,
    /// The time that choosing may take.
    #[arg(long, value_name = "TIME", default_value = "60s")]
    budget: String,
    /// Chooses for this horizon instead of the scene's.
    #[arg(long, value_name = "TIME")]
    horizon: Option<f64>,
    /// Where to write the chart of error against work.
    #[arg(long, value_name = "FILE", default_value = "choice.svg")]
    chart: PathBuf,
    /// Writes the scene with the choice filled in.
    #[arg(long, value_name = "FILE")]
    emit: Option<PathBuf>,
    /// Writes the answer with all that was run, for programs.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The ladder of the scene in a file, for a question.
///
/// # Errors
/// [`ChooseError`], before anything is run.
pub fn ladder_of(file: &Path, question: &Question) -> Result<SceneLadder, ChooseError> {
    Scene::read(file)?;
    let text = fs::read_to_string(file)
        .map_err(|source| ChooseError::Read { path: file.to_owned(), source })?;
    scene_ladder(&file.display().to_string(), &text, question)
}

impl Choose {
    /// Answers, and fails where nothing is recommended without a reserve.
    pub(super) fn run(&self) -> Result<ExitCode, Box<dyn std::error::Error>> {
        let file = &self.file;
        let question = Question { observable: self.observable.clone(), horizon: self.horizon };
        let budget = time(&self.budget)?;
        let ladder = ladder_of(file, &question)?;
        let answer = answer(&mut MeasuredRuns::new(&ladder, budget)?, self.tolerance)?;
        print!("{answer}");
        emit(&self.chart, &picture(&answer)?)?;
        println!("\n{}", self.chart.display());
        if let Some(path) = &self.json {
            emit(path, &json(&answer)?)?;
            println!("{}", path.display());
        }
        if let Some(path) = &self.emit {
            self.write(path, &answer, &ladder)?;
        }
        Ok(match answer.verdict {
            Verdict::Chosen(_) => ExitCode::SUCCESS,
            _ => ExitCode::FAILURE,
        })
    }

    /// Writes the scene with the choice filled in, where there is one.
    fn write(
        &self,
        path: &Path,
        answer: &Answer,
        ladder: &SceneLadder,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let text = fs::read_to_string(&self.file)?;
        if let Some(text) = emitted(&self.file.display().to_string(), &text, answer, ladder)? {
            emit(path, &text)?;
            println!("{}", path.display());
        }
        Ok(())
    }
}
