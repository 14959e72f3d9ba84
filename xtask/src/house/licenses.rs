//! Which licences the dependencies carry: each must let anyone use the crates under MIT or Apache-2.0.

use std::env;
use std::io;
use std::process::Command;

use serde::Deserialize;

/// Licences that ask for no more than a notice.
const ACCEPTED: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// A package whose licence is not accepted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{package} {version} is licensed `{license}`, which is not on the list")]
pub struct Unlicensed {
    /// The package.
    pub package: String,
    /// Its version.
    pub version: String,
    /// What its manifest says; empty where it says nothing.
    pub license: String,
}

/// Cargo did not say what the dependencies are.
#[derive(Debug, thiserror::Error)]
pub enum LicenseError {
    /// Cargo could not be run.
    #[error("cargo metadata could not be run: {0}")]
    Cargo(#[from] io::Error),
    /// Its answer could not be read.
    #[error("cargo metadata gave an answer that cannot be read: {0}")]
    Answer(#[from] serde_json::Error),
}

#[derive(Deserialize)]
struct Answer {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
    license: Option<String>,
}

/// Every package that any feature of the workspace builds and whose licence is not accepted.
///
/// # Errors
/// Where cargo does not answer.
pub fn unlicensed() -> Result<Vec<Unlicensed>, LicenseError> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--all-features"])
        .output()?;
    let answer: Answer = serde_json::from_slice(&output.stdout)?;
    let refused = answer.packages.into_iter().filter_map(|package| {
        let license = package.license.unwrap_or_default();
        let Package { name, version, .. } = package;
        (!accepts(&license)).then_some(Unlicensed { package: name, version, license })
    });
    Ok(refused.collect())
}

/// Whether a licence expression can be met with accepted licences: OR binds weaker than AND, and
/// parentheses are followed.
fn accepts(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    alternatives(&expression, " OR ").iter().any(|alternative| {
        alternatives(alternative, " AND ").iter().all(|part| {
            let part = part.trim();
            match part.strip_prefix('(').and_then(|part| part.strip_suffix(')')) {
                Some(inner) => accepts(inner),
                None => ACCEPTED.contains(&part),
            }
        })
    })
}

/// The parts of an expression between a word that stands outside all parentheses.
fn alternatives(expression: &str, word: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut depth = 0_usize;
    let mut rest = expression;
    while let Some(next) = rest.chars().next() {
        if depth == 0 && rest.starts_with(word) {
            parts.push(String::new());
            rest = &rest[word.len()..];
            continue;
        }
        match next {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if let Some(part) = parts.last_mut() {
            part.push(next);
        }
        rest = &rest[next.len_utf8()..];
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expression_is_accepted_where_one_alternative_is() {
        for accepted in [
            "MIT",
            "MIT/Apache-2.0",
            "GPL-3.0 OR MIT",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception OR GPL-2.0",
        ] {
            assert!(accepts(accepted), "{accepted}");
        }
        for refused in ["", "GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Apache-2.0) AND GPL-3.0"] {
            assert!(!accepts(refused), "{refused}");
        }
    }
}
