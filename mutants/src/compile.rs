//! One compilation of the crate's tests, and which mutants the compiler objects to.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::copy::Copy;
use crate::error::MutantsError;
use crate::schemata::Placed;
use crate::sources::Source;

/// What came of it.
pub enum Compiled {
    /// The programs that run the tests.
    Tests(Vec<PathBuf>),
    /// The numbers of mutants that are no Rust.
    Refused(HashSet<u32>),
}

/// Compiles the unit tests and the integration tests of the copy with all features.
pub fn compile(
    copy: &Copy,
    sources: &[Source],
    places: &[Vec<Placed>],
) -> Result<Compiled, MutantsError> {
    let run = Command::new("cargo")
        .args(["test", "--no-run", "--lib", "--tests", "--all-features", "--message-format=json"])
        .current_dir(&copy.root)
        .env("CARGO_TARGET_DIR", &copy.target)
        .output()
        .map_err(MutantsError::file("cargo"))?;
    let text = String::from_utf8_lossy(&run.stdout);
    let messages: Vec<Value> =
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if run.status.success() {
        return Ok(Compiled::Tests(messages.iter().filter_map(test_program).collect()));
    }
    let mut refused = HashSet::new();
    let mut unexplained = String::new();
    for message in messages.iter().map(|message| &message["message"]) {
        let spans = message["spans"].as_array().map_or(&[][..], Vec::as_slice);
        if message["level"] != "error" || spans.is_empty() {
            continue;
        }
        let primary = spans.iter().filter(|span| span["is_primary"] == true);
        let mut known: Vec<u32> = primary.flat_map(|span| blamed(span, sources, places)).collect();
        if known.is_empty() {
            known = spans.iter().flat_map(|span| blamed(span, sources, places)).collect();
        }
        if known.is_empty() {
            unexplained.push_str(message["rendered"].as_str().unwrap_or_default());
        }
        refused.extend(known);
    }
    if refused.is_empty() {
        unexplained.push_str(&String::from_utf8_lossy(&run.stderr));
        return Err(MutantsError::Compile(unexplained));
    }
    Ok(Compiled::Refused(refused))
}

fn test_program(message: &Value) -> Option<PathBuf> {
    let tests = message["profile"]["test"].as_bool()?;
    let program = message["executable"].as_str()?;
    tests.then(|| program.into())
}

/// The mutants at a place that the compiler names: those whose own text it is, else the innermost
/// around it, else those within.
fn blamed(span: &Value, sources: &[Source], places: &[Vec<Placed>]) -> Vec<u32> {
    let path = Path::new(span["file_name"].as_str().unwrap_or_default());
    let Some(file) = sources.iter().position(|source| path.ends_with(&source.path)) else {
        return Vec::new();
    };
    let byte = |name: &str| span[name].as_u64().unwrap_or_default() as usize;
    let (begin, end) = (byte("byte_start"), byte("byte_end"));
    let placed = &places[file];
    let own = placed.iter().filter(|p| p.mutated.start <= begin && end <= p.mutated.end);
    let around = placed.iter().filter(|p| p.whole.start <= begin && end <= p.whole.end);
    let innermost = around.min_by_key(|p| p.whole.len()).map(|p| p.whole.clone());
    let within = placed.iter().filter(|p| begin <= p.whole.start && p.whole.end <= end);
    let own: Vec<u32> = own.map(|p| p.number).collect();
    match (own.is_empty(), innermost) {
        (false, _) => own,
        (true, Some(whole)) => {
            placed.iter().filter(|p| p.whole == whole).map(|p| p.number).collect()
        }
        (true, None) => within.map(|p| p.number).collect(),
    }
}
