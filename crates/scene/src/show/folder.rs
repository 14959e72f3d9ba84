//! The folder of a run's files, made and tried before the run: an answer that took hours must not find
//! that it has nowhere to go.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::{fs, io};

use crate::run::samples::Run;
use crate::text::file_error::WriteError;

/// A file that is made to see whether files can be, and removed.
const TRIED: &str = ".writable";

/// Makes the folder where it is missing, and tries to write there: a new file, and over each of
/// [`Run::FILES`] that is there already, of which not a byte is changed.
///
/// # Errors
/// [`WriteError`] at the folder or the file that cannot be written.
pub fn make_folder(folder: impl AsRef<Path>) -> Result<(), WriteError> {
    let folder = folder.as_ref();
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| WriteError { path, source }
    };
    if fs::metadata(folder).is_ok_and(|found| !found.is_dir()) {
        let source = io::Error::new(io::ErrorKind::NotADirectory, "it is a file; name a folder");
        return Err(at(folder)(source));
    }
    fs::create_dir_all(folder).map_err(at(folder))?;
    let tried = folder.join(TRIED);
    File::create(&tried).map_err(at(folder))?;
    fs::remove_file(&tried).map_err(at(&tried))?;
    for name in Run::FILES {
        let path = folder.join(name);
        if path.exists() {
            OpenOptions::new().append(true).open(&path).map_err(at(&path))?;
        }
    }
    Ok(())
}
