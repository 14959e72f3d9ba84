//! A file that cannot be read, or written.

use std::io;
use std::path::PathBuf;

use crate::text::diagnostic::Diagnostic;
use crate::text::limits;

/// A scene that cannot be had from a file or a text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is missing, or may not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("{}: is not a file", path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
    },
    /// More bytes than a scene may have.
    #[error("{name}: has {bytes} bytes; a scene has at most {}", limits::FILE_BYTES)]
    TooLarge {
        /// The file or the text.
        name: String,
        /// Its size, or what was seen of it before giving up.
        bytes: u64,
    },
    /// Bytes that are no text.
    #[error("{}:{line}:{column}: the bytes here are not UTF-8 text", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// The line of the first such byte, counted from 1.
        line: usize,
        /// The column of the first such byte, in characters from 1.
        column: usize,
    },
    /// A text that says something which cannot be.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
}

/// A folder or a file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct WriteError {
    /// The folder or the file.
    pub path: PathBuf,
    /// What the system says.
    pub source: io::Error,
}
