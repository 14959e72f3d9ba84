//! `cargo xtask run FILE --out DIR`: a scene file to a trajectory, with a bar while it runs.

use std::ops::ControlFlow;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use stationary_scene::{RunError, Scene, SceneError, Summary, WriteError};

use crate::report::Progress;

/// A scene that was not run to its end, or whose results were not written.
#[derive(Debug, thiserror::Error)]
pub enum RunSceneError {
    /// The file is no scene.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The run stopped early. What it had computed is in the folder.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The folder cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// How many times the bar moves over a run: redrawing costs more than a step.
const MOVES: u64 = 200;

/// Runs the scene in `file` and writes its trajectory, observables and picture into `out`.
///
/// # Errors
/// [`RunSceneError`]. Of a run that stopped early, what was computed is written all the same.
pub fn run_scene(file: &Path, out: &Path, progress: Progress) -> Result<Summary, RunSceneError> {
    let scene = Scene::read(file)?;
    let steps = scene.timing().steps();
    let bar = match progress {
        Progress::Shown => ProgressBar::new(steps),
        Progress::Hidden => ProgressBar::hidden(),
    };
    if let Ok(style) =
        ProgressStyle::with_template("{bar:40} {percent}% of {len} steps, {eta} left")
    {
        bar.set_style(style);
    }
    let every = steps.div_ceil(MOVES).max(1);
    let run = scene.run_watched(|now| {
        if now.step % every == 0 {
            bar.set_position(now.step);
        }
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    match run {
        Ok(run) => {
            run.write(out)?;
            Ok(run.summary())
        }
        Err(error) => {
            if let Some(partial) = error.partial() {
                partial.write(out)?;
            }
            Err(error.into())
        }
    }
}
