//! `stationary import FILE`: a description of a robot as a scene.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use stationary_import::{Description, ImportError, scene_of_mjcf, scene_of_urdf};

/// Prints a description of a robot, URDF or MJCF, as a scene.
#[derive(Debug, clap::Args)]
pub struct Import {
    /// The description: `.urdf`, or `.xml` or `.mjcf` of MuJoCo.
    file: PathBuf,
}

/// A description that was not imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportFileError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is no scene.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ImportError,
    },
    /// Its name does not say what it is.
    #[error("{}: the name must end in .urdf, .xml or .mjcf", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
    },
}

/// Reads a description as a scene.
///
/// # Errors
/// [`ImportFileError`] with the file.
pub fn import_file(file: &Path) -> Result<Description, ImportFileError> {
    let path = file.to_owned();
    let kind = file.extension().and_then(|kind| kind.to_str()).unwrap_or_default();
    if !["urdf", "xml", "mjcf"].contains(&kind) {
        return Err(ImportFileError::Kind { path });
    }
    let text = match fs::read_to_string(file) {
        Ok(text) => text,
        Err(source) => return Err(ImportFileError::Read { path, source }),
    };
    let folder = file.parent().unwrap_or(Path::new("."));
    let scene = if kind == "urdf" { scene_of_urdf(&text) } else { scene_of_mjcf(&text, folder) };
    scene.map_err(|source| ImportFileError::Scene { path, source })
}

impl Import {
    pub(super) fn run(&self) -> Result<ExitCode, Box<dyn std::error::Error>> {
        let scene = import_file(&self.file)?;
        for left in &scene.left_out {
            eprintln!("left out: {left}");
        }
        print!("{}", scene.text);
        Ok(ExitCode::SUCCESS)
    }
}
