//! The report's folder: each file is written whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use super::ReportError;

/// A folder that can be written to.
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// Makes the folder where it is missing and proves that a file can be written, so that minutes
    /// of measuring are not lost to a folder that cannot be used.
    pub(crate) fn open(path: &Path) -> Result<Self, ReportError> {
        fs::create_dir_all(path).map_err(unwritable(path))?;
        let folder = Folder(path.to_owned());
        let probe = path.join(".probe");
        fs::write(&probe, "").and_then(|()| fs::remove_file(&probe)).map_err(unwritable(path))?;
        Ok(folder)
    }

    /// Writes beside the file and moves it into place, so that a reader never sees half a file.
    pub(crate) fn write(&self, name: &str, content: &str) -> Result<(), ReportError> {
        let (path, draft) = (self.0.join(name), self.0.join(format!(".{name}.draft")));
        fs::write(&draft, content).map_err(unwritable(&path))?;
        fs::rename(&draft, &path).map_err(unwritable(&path))
    }
}

fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::Unwritable { path, source }
}
