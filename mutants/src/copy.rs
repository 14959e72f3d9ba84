//! A copy of the workspace in the target folder, in which one crate is mutated.
//!
//! All but that crate's `src` are links, so that what is compiled already stays compiled. The crate has
//! a version of its own: its artefacts are not taken for those of the workspace.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use crate::draw::Drawn;
use crate::error::MutantsError;
use crate::schemata::{self, Placed};
use crate::sources::Source;

/// The copied crate.
pub struct Copy {
    /// Its folder.
    pub root: PathBuf,
    /// Where its artefacts go.
    pub target: PathBuf,
}

impl Copy {
    /// Copies the workspace for the crate in its folder `crates/name`.
    pub fn new(workspace: &Path, target: &Path, name: &str) -> Result<Self, MutantsError> {
        let folder = target.join("mutants").join(name);
        if folder.exists() {
            fs::remove_dir_all(&folder).map_err(MutantsError::file(&folder))?;
        }
        let root = folder.join("crates").join(name);
        make(&root)?;
        link_all(workspace, &folder, &["crates", "Cargo.lock", "target", ".git", "mutants"])?;
        link_all(&workspace.join("crates"), &folder.join("crates"), &[name])?;
        let original = workspace.join("crates").join(name);
        link_all(&original, &root, &["src", "Cargo.toml"])?;
        let lock = workspace.join("Cargo.lock");
        fs::copy(&lock, folder.join("Cargo.lock")).map_err(MutantsError::file(&lock))?;
        copy_all(&original.join("src"), &root.join("src"))?;

        let manifest = original.join("Cargo.toml");
        let text = fs::read_to_string(&manifest).map_err(MutantsError::file(&manifest))?;
        let versioned = text.replace("\nversion.workspace = true", "\nversion = \"0.1.0+mutants\"");
        if versioned == text {
            return Err(MutantsError::Version(manifest));
        }
        write(&root.join("Cargo.toml"), &versioned)?;
        Ok(Self { root, target: target.to_path_buf() })
    }

    /// Writes the mutants into the files, and tells for each file where they stand.
    pub fn plant(
        &self,
        sources: &[Source],
        mutants: &[Drawn],
    ) -> Result<Vec<Vec<Placed>>, MutantsError> {
        let mut places = Vec::new();
        for (file, source) in sources.iter().enumerate() {
            let here: Vec<&Drawn> =
                mutants.iter().filter(|drawn| drawn.mutant.file == file).collect();
            let (mut text, placed) = schemata::write(&source.text, &here);
            if file == 0 {
                text.push_str(schemata::SWITCH);
            }
            write(&self.root.join(&source.path), &text)?;
            places.push(placed);
        }
        Ok(places)
    }

    /// Switches one mutant on, or none with 0.
    pub fn switch(&self, number: u32) -> Result<(), MutantsError> {
        write(&self.root.join("mutant"), &number.to_string())
    }
}

fn make(folder: &Path) -> Result<(), MutantsError> {
    fs::create_dir_all(folder).map_err(MutantsError::file(folder))
}

fn write(path: &Path, text: &str) -> Result<(), MutantsError> {
    fs::write(path, text).map_err(MutantsError::file(path))
}

/// The entries of a folder.
fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, MutantsError> {
    let entries = fs::read_dir(folder).and_then(|entries| entries.collect());
    entries.map_err(MutantsError::file(folder))
}

/// Links each entry of a folder but some.
fn link_all(from: &Path, to: &Path, but: &[&str]) -> Result<(), MutantsError> {
    for entry in entries(from)? {
        if but.iter().any(|name| entry.file_name() == *name) {
            continue;
        }
        let link = to.join(entry.file_name());
        symlink(entry.path(), &link).map_err(MutantsError::file(&link))?;
    }
    Ok(())
}

/// Copies a folder with all that is in it.
fn copy_all(from: &Path, to: &Path) -> Result<(), MutantsError> {
    make(to)?;
    for entry in entries(from)? {
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_all(&path, &copy)?;
        } else {
            fs::copy(&path, &copy).map_err(MutantsError::file(&path))?;
        }
    }
    Ok(())
}
