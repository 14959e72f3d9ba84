//! What the files of the workspace must show: docs that name what exists, names that mean something,
//! and no unsafe code.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::{LayerError, Metadata, Violation, rooms};

/// First folders of what looks like a path of this repository.
const ROOTS: [&str; 5] = ["crates/", "xtask/", "docs/", "tests/", "benches/"];
/// Names of files that hold what nobody found a place for.
const NAMELESS: [&str; 7] = ["utils", "util", "common", "helpers", "helper", "prelude", "misc"];

/// The rules on files that a workspace breaks.
///
/// # Errors
/// What cannot be read.
pub fn check_tree(metadata: &Metadata) -> Result<Vec<Violation>, LayerError> {
    let root = &metadata.workspace_root;
    let mut violations = Vec::new();
    let docs =
        files(&root.join("docs"))?.into_iter().filter(|f| f.extension() == Some("md".as_ref()));
    for document in docs.chain([root.join("README.md")]).filter(|document| document.exists()) {
        let text = read(&document)?;
        let exists = |path: &str| root.join(path).exists();
        violations.extend(gone_paths(&shown(root, &document), &text, exists));
    }
    for library in metadata.libraries() {
        let folder = library.manifest_path.with_file_name("src");
        let nameless = files(&folder)?.into_iter().map(|file| shown(root, &file));
        violations.extend(
            nameless.filter(|f| is_nameless(f)).map(|path| Violation::NamelessFile { path }),
        );
        if !library.rooms().is_empty() {
            let sources =
                files(&folder)?.into_iter().filter(|f| f.extension() == Some("rs".as_ref()));
            let sources = sources.map(|file| Ok((shown(&folder, &file), read(&file)?)));
            let sources = sources.collect::<Result<Vec<_>, LayerError>>()?;
            violations.extend(rooms::check(&library.name, library.rooms(), &sources));
        }
    }
    violations.extend(unsafe_allowed(metadata)?);
    Ok(violations)
}

/// Paths in backticks that do not exist. Fenced blocks are programs and drawings, not prose.
fn gone_paths(file: &str, text: &str, exists: impl Fn(&str) -> bool) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut fenced = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if fenced {
            continue;
        }
        let in_backticks = line.split('`').skip(1).step_by(2);
        for path in in_backticks.filter_map(repository_path).filter(|path| !exists(path)) {
            let (file, path) = (file.to_owned(), path.to_owned());
            violations.push(Violation::GonePath { file, line: i + 1, path });
        }
    }
    violations
}

/// The path that a piece of code is, without a line number; patterns are not paths.
fn repository_path(code: &str) -> Option<&str> {
    let path = code.split_once(':').map_or(code, |(path, _)| path);
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    (ROOTS.iter().any(|root| path.starts_with(root)) && path.chars().all(plain)).then_some(path)
}

fn is_nameless(path: &str) -> bool {
    let inside = path.split_once("/src/").map_or(path, |(_, inside)| inside);
    inside.split('/').any(|part| NAMELESS.contains(&part.strip_suffix(".rs").unwrap_or(part)))
}

/// Each crate takes the workspace's lints, and those forbid unsafe code.
fn unsafe_allowed(metadata: &Metadata) -> Result<Vec<Violation>, LayerError> {
    let root = &metadata.workspace_root;
    let mut violations = Vec::new();
    let mut demand = |manifest: &Path, keys: &[&str], value: toml::Value, missing| {
        let found = lookup(&manifest_table(manifest)?, keys) == Some(value);
        if !found {
            let manifest = shown(root, manifest);
            violations.push(Violation::UnsafeAllowed { manifest, missing });
        }
        Ok::<(), LayerError>(())
    };
    let keys = ["workspace", "lints", "rust", "unsafe_code"];
    let missing = "the workspace's lints lack unsafe_code = \"forbid\"";
    demand(&root.join("Cargo.toml"), &keys, "forbid".into(), missing)?;
    for package in &metadata.packages {
        let missing = "it lacks [lints] workspace = true";
        demand(&package.manifest_path, &["lints", "workspace"], true.into(), missing)?;
    }
    Ok(violations)
}

fn manifest_table(path: &Path) -> Result<toml::Table, LayerError> {
    let text = read(path)?;
    text.parse().map_err(|source| LayerError::Manifest { path: path.to_owned(), source })
}

fn lookup(table: &toml::Table, keys: &[&str]) -> Option<toml::Value> {
    let (first, rest) = keys.split_first()?;
    let value = table.get(*first)?.clone();
    rest.iter().try_fold(value, |value, key| value.get(key).cloned())
}

fn read(path: &Path) -> Result<String, LayerError> {
    fs::read_to_string(path).map_err(at(path))
}

/// Every file under a folder, in order; none where there is no folder.
fn files(folder: &Path) -> Result<Vec<PathBuf>, LayerError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(at(folder))? {
        let path = entry.map_err(at(folder))?.path();
        if path.is_dir() {
            found.extend(files(&path)?);
        } else {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn at(path: &Path) -> impl Fn(io::Error) -> LayerError {
    let path = path.to_owned();
    move |source| LayerError::File { path: path.clone(), source }
}

/// A path as a reader of the repository knows it.
fn shown(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).display().to_string().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_is_gone_is_named_with_its_line() {
        let text = "See `crates/calculus/src`.\n\nAnd `crates/gone/src/lib.rs:12`, `tests/x_y.rs`.";
        let said: Vec<String> = gone_paths("docs/a.md", text, |path| path == "crates/calculus/src")
            .iter()
            .map(ToString::to_string)
            .collect();
        let expected = [
            "docs/a.md:3: `crates/gone/src/lib.rs` does not exist",
            "docs/a.md:3: `tests/x_y.rs` does not exist",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn programs_patterns_and_commands_are_not_paths() {
        let text =
            "```sh\ncat `tests/gone`\n```\n`crates/*/src`, `cargo test crates/gone`, tests/gone";
        assert!(gone_paths("README.md", text, |_| false).is_empty());
    }

    #[test]
    fn a_file_named_after_nothing_is_found_at_any_depth() {
        assert!(is_nameless("crates/mesh/src/utils.rs"));
        assert!(is_nameless("crates/mesh/src/helpers/read.rs"));
        assert!(!is_nameless("crates/common/src/topology.rs"));
        assert!(!is_nameless("crates/mesh/src/commonality.rs"));
    }
}
