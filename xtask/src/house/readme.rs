//! The README of a crate: the front page that stands at the head of its `lib.rs`, and its features.

use std::fs;
use std::path::PathBuf;

use crate::layers::{LayerError, Metadata, Package};

/// A README with its path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readme {
    /// Where it belongs.
    pub path: PathBuf,
    /// What it must say.
    pub text: String,
}

impl Readme {
    /// Whether the file says so.
    pub fn is_written(&self) -> bool {
        fs::read_to_string(&self.path).is_ok_and(|text| text == self.text)
    }
}

/// The READMEs of all library crates.
///
/// # Errors
/// A workspace that cannot be read.
pub fn readmes() -> Result<Vec<Readme>, LayerError> {
    Metadata::read()?.libraries().into_iter().map(of).collect()
}

fn of(library: &Package) -> Result<Readme, LayerError> {
    let read = |path: PathBuf| {
        fs::read_to_string(&path).map_err(|source| LayerError::File { path, source })
    };
    let manifest = read(library.manifest_path.clone())?;
    let source = read(library.manifest_path.with_file_name("src").join("lib.rs"))?;
    let name = library.short_name();
    let text = format!(
        "# {}\n\n{}{}\nOne of the crates of [Stationary](../../README.md); [its page](../../docs/src/{name}.md) \
         says what it promises and where it fails. Licensed under either of MIT or Apache-2.0 at your \
         option.\n",
        library.name,
        front_page(&source),
        features(&manifest),
    );
    Ok(Readme { path: library.manifest_path.with_file_name("README.md"), text })
}

/// Whether a block of this language is a program: of Rust, with or without what its test is told.
fn is_rust(language: &str) -> bool {
    !matches!(language, "text" | "toml")
}

/// The module's comment as a page: links to items become code, hidden lines of programs go.
fn front_page(source: &str) -> String {
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    let lines = lines.map(|line| line.strip_prefix(' ').unwrap_or(line));
    let (mut page, mut fence) = (String::new(), None);
    for line in lines {
        match (line.strip_prefix("```"), fence) {
            (Some(language), None) => {
                fence = Some(language);
                page.push_str("```");
                page.push_str(if is_rust(language) { "rust" } else { language });
            }
            (Some(_), Some(_)) => {
                fence = None;
                page.push_str("```");
            }
            (None, Some(language)) if is_rust(language) && line.starts_with("# ") => continue,
            (None, Some(_)) => page.push_str(line),
            (None, None) if line.starts_with('#') => {
                page.push('#');
                page.push_str(line);
            }
            (None, None) => page.push_str(&without_item_links(line)),
        }
        page.push('\n');
    }
    page
}

/// Links to items, ``[`A`]`` and ``[`A`](path)``, as code; other links stay.
fn without_item_links(line: &str) -> String {
    let (mut text, mut rest) = (String::new(), line);
    while let Some((before, after)) = rest.split_once("[`") {
        text.push_str(before);
        let Some((code, after)) = after.split_once("`]") else {
            text.push_str("[`");
            rest = after;
            continue;
        };
        text.push_str(&format!("`{code}`"));
        rest = match after.strip_prefix('(').and_then(|target| target.split_once(')')) {
            Some((_, after)) => after,
            None => after,
        };
    }
    text + rest
}

/// The features that a manifest lists, each with the comment above it.
fn features(manifest: &str) -> String {
    let lines = manifest.lines().skip_while(|line| *line != "[features]").skip(1);
    let (mut rows, mut comment) = (String::new(), Vec::new());
    for line in lines.take_while(|line| !line.starts_with('[')) {
        if let Some(words) = line.strip_prefix("# ") {
            comment.push(words);
        } else if let Some((name, _)) = line.split_once(" = ") {
            rows.push_str(&format!("- `{name}`: {}\n", comment.join(" ")));
            comment.clear();
        }
    }
    if rows.is_empty() { rows } else { format!("\n## Features\n\n{rows}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_page_keeps_its_programs_and_drops_what_only_rustdoc_reads() {
        let source = "//! How far?\n//!\n//! ```text\n//! # a\n//! ```\n//! ```\n//! # use a;\n\
                      //! f();\n//! ```\n//! # More\n//! See [`F`](crate::F) and [`G`], [x](y).\n\nmod a;\n//! no\n";
        let page = "How far?\n\n```text\n# a\n```\n```rust\nf();\n```\n## More\nSee `F` and `G`, [x](y).\n";
        assert_eq!(front_page(source), page);
    }

    #[test]
    fn features_are_listed_with_their_comments() {
        let manifest = "[features]\n# One and\n# two.\na = []\nb = [\"a\"]\n\n[lints]\nc = 1\n";
        assert_eq!(features(manifest), "\n## Features\n\n- `a`: One and two.\n- `b`: \n");
    }
}
