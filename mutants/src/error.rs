//! What can go wrong before a mutant is judged.

use std::path::PathBuf;

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum MutantsError {
    /// The command line names no crate, or something that is no number.
    #[error("cannot read `{0}`: give the folder of a crate, and mutants as `--only 3,17`")]
    Usage(String),
    /// A file cannot be read or written, or a program not started.
    #[error("{path}: {source}")]
    File {
        /// The file, folder or program.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file is no Rust.
    #[error("{path}: cannot parse: {source}")]
    Parse {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: syn::Error,
    },
    /// `mod name;` has no file.
    #[error("{path}: module `{module}` has no file")]
    Module {
        /// The file that declares the module.
        path: PathBuf,
        /// Its name.
        module: String,
    },
    /// The manifest inherits no version from the workspace, so that the copy would share its artefacts.
    #[error("{0}: expected the line `version.workspace = true`")]
    Version(PathBuf),
    /// The compiler objects to something that is no mutant.
    #[error("the copy does not compile, and not for a mutant:\n{0}")]
    Compile(String),
    /// The crate has fewer mutants than are to be drawn.
    #[error("only {found} mutants compile, {wanted} are asked for")]
    TooFew {
        /// Mutants that compile.
        found: usize,
        /// Mutants asked for.
        wanted: usize,
    },
    /// A test fails where no mutant is on.
    #[error("`{0}` fails without any mutant: mend it first")]
    Unmutated(String),
}

impl MutantsError {
    /// A closure for `map_err` that names the file.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::File { path, source }
    }
}
