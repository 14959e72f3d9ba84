//! Why nothing was chosen before anything was run.

use std::path::PathBuf;

use stationary_choose::QuestionError;

use crate::text::file_error::{SceneError, WriteError};

/// A question that has no answer.
#[derive(Debug, thiserror::Error)]
pub enum ChooseError {
    /// The file is no scene.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The scene has nothing of this name to observe.
    #[error("there is no observable `{asked}` in this scene\n{reason}")]
    Observable {
        /// What was asked for.
        asked: String,
        /// What the scene says to it.
        reason: String,
    },
    /// The observable has no number in this scene, as an angular momentum on a line.
    #[error("`{0}` has no numbers in this scene")]
    NoNumbers(String),
    /// It cannot be asked.
    #[error(transparent)]
    Question(#[from] QuestionError),
    /// The scene has no method: no rung of the ladder can be tried.
    #[error("no method takes what this scene has; the scene's own is refused as well: {0}")]
    NoSetting(String),
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// The file changed between reading it twice.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}
