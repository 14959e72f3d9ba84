//! Mutation testing: how many small mistakes in a crate do its own tests find?
//!
//! ```text
//! cargo run --manifest-path mutants/Cargo.toml -- calculus
//! cargo run --manifest-path mutants/Cargo.toml -- calculus --only 3,17
//! ```
//!
//! All mistakes that can be planted in `crates/calculus/src` are listed ([`operators`]), 60 are drawn by
//! a seed ([`draw`]), written behind switches into a copy ([`schemata`], [`copy`]) that is compiled once
//! ([`compile`]), and switched on one after the other while the crate's unit and integration tests run
//! ([`run`]). Those that do not compile are replaced by the next of the draw. A test that fails, a
//! program that breaks off and one that takes three times as long as it should have found the mutant.

mod error;
mod sources;
mod operators;
mod draw;
mod schemata;
mod copy;
mod compile;
mod run;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use compile::Compiled;
use copy::Copy;
use draw::Drawn;
use error::MutantsError;
use run::Outcome;
use sources::Source;

/// Decides the draw.
const SEED: u64 = 1;
/// Mutants that are judged.
const WANTED: usize = 60;
/// Mutants that are planted at first: some do not compile.
const PLANTED: usize = 80;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match read(&words).and_then(|(name, only)| judge(&name, &only)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the crate, and the mutants that are to be judged: all, where none is named.
fn read(words: &[String]) -> Result<(String, Vec<u32>), MutantsError> {
    let usage = || MutantsError::Usage(words.join(" "));
    match words {
        [name] => Ok((name.clone(), Vec::new())),
        [name, only, list] if only == "--only" => {
            let numbers: Result<_, _> = list.split(',').map(str::parse).collect();
            Ok((name.clone(), numbers.map_err(|_| usage())?))
        }
        _ => Err(usage()),
    }
}

/// Prints the table of a crate.
fn judge(name: &str, only: &[u32]) -> Result<(), MutantsError> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let workspace = workspace.canonicalize().map_err(MutantsError::file(&workspace))?;
    let target = std::env::var_os("CARGO_TARGET_DIR");
    let target = target.map_or_else(|| workspace.join("target"), PathBuf::from);
    let target = std::path::absolute(&target).map_err(MutantsError::file(&target))?;
    let sources = sources::read(&workspace.join("crates").join(name))?;
    let copy = Copy::new(&workspace, &target, name)?;
    let (mut mutants, tests) = plant(&copy, &sources)?;
    let limit = time_limit(&copy, &tests)?;
    mutants.retain(|drawn| only.is_empty() || only.contains(&drawn.number));
    mutants.sort_by_key(|drawn| (drawn.mutant.file, drawn.mutant.range.start, drawn.number));

    println!("| mutant | where | what | seconds | found by |\n| --- | --- | --- | --- | --- |");
    let mut found = 0;
    for Drawn { number, mutant } in &mutants {
        copy.switch(*number)?;
        let before = run::processor_seconds();
        let outcome = run::run(&tests, &copy.root, limit)?;
        let seconds = run::processor_seconds() - before;
        found += usize::from(!matches!(outcome, Outcome::Passed));
        let by = match outcome {
            Outcome::Failed(test) => test,
            Outcome::Hung => "the time limit".into(),
            Outcome::Passed => "none".into(),
        };
        let source = &sources[mutant.file];
        let line = 1 + source.text[..mutant.range.start].matches('\n').count();
        let place = format!("{}:{line}", source.path.display());
        println!("| {number} | {place} | `{}` | {seconds:.1} | {by} |", mutant.change);
    }
    println!("\n{} mutants, {found} found, {} not", mutants.len(), mutants.len() - found);
    Ok(())
}

/// The first of the draw that compile, and the programs of the tests with all of them in place.
fn plant(copy: &Copy, sources: &[Source]) -> Result<(Vec<Drawn>, Vec<PathBuf>), MutantsError> {
    let listed = sources.iter().enumerate();
    let mutants: Vec<_> =
        listed.flat_map(|(file, source)| operators::mutants(file, source)).collect();
    eprintln!("{} mutants in {} files", mutants.len(), sources.len());
    let mut planted = draw::order(SEED, sources, mutants);
    planted.truncate(PLANTED);
    loop {
        let places = copy.plant(sources, &planted)?;
        match compile::compile(copy, sources, &places)? {
            Compiled::Refused(refused) => {
                planted.retain(|drawn| !refused.contains(&drawn.number));
            }
            Compiled::Tests(_) if planted.len() < WANTED => {
                let found = planted.len();
                return Err(MutantsError::TooFew { found, wanted: WANTED });
            }
            Compiled::Tests(tests) => {
                planted.truncate(WANTED);
                return Ok((planted, tests));
            }
        }
    }
}

/// Three times what the tests take without a mutant, and ten seconds more.
fn time_limit(copy: &Copy, tests: &[PathBuf]) -> Result<u64, MutantsError> {
    copy.switch(0)?;
    let before = run::processor_seconds();
    match run::run(tests, &copy.root, 3600)? {
        Outcome::Passed => {}
        Outcome::Failed(test) => return Err(MutantsError::Unmutated(test)),
        Outcome::Hung => return Err(MutantsError::Unmutated("the time limit".into())),
    }
    let seconds = run::processor_seconds() - before;
    eprintln!("without a mutant {seconds:.1} s of a processor");
    Ok((3.0 * seconds) as u64 + 10)
}
