//! `stationary new FILE --like NAME`: a scene to begin with, one of those that ship, with its comments.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use stationary_scene::shipped::SCENES;

/// Writes a scene to begin with, commented.
#[derive(Debug, clap::Args)]
pub struct New {
    /// Where to write; it must not exist yet.
    file: PathBuf,
    /// Which scene to begin with.
    #[arg(long, value_name = "NAME", default_value = "pendulum-chain")]
    like: String,
}

/// A scene that was not written.
#[derive(Debug, thiserror::Error)]
pub enum NewSceneError {
    /// There is no such scene.
    #[error("no scene is called `{name}`; there are\n{all}")]
    Name {
        /// The name asked for.
        name: String,
        /// The names, each with what it is.
        all: String,
    },
    /// The file exists, or cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// Writes the scene that ships by this name.
///
/// # Errors
/// [`NewSceneError`]; a file that exists is left as it is.
pub fn new_scene(file: &Path, like: &str) -> Result<(), NewSceneError> {
    let Some(scene) = SCENES.iter().find(|scene| scene.name == like) else {
        let mut all = String::new();
        for scene in SCENES {
            let _ = writeln!(all, "  {:20}{}", scene.name, scene.summary());
        }
        return Err(NewSceneError::Name { name: like.to_owned(), all });
    };
    // An editor finds the schema beside the shipped scenes alone.
    let text = scene.text.lines().filter(|line| !line.starts_with("#:schema"));
    let text = text.collect::<Vec<_>>().join("\n");
    let failed = |source| NewSceneError::Write { path: file.to_owned(), source };
    let mut out = fs::File::create_new(file).map_err(failed)?;
    writeln!(out, "{}", text.trim_start()).map_err(failed)
}

impl New {
    pub(super) fn run(&self) -> Result<ExitCode, Box<dyn std::error::Error>> {
        new_scene(&self.file, &self.like)?;
        println!("{}", self.file.display());
        Ok(ExitCode::SUCCESS)
    }
}
