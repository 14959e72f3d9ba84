//! What the program can be told: a scene to begin with, the words of a scene, to run one, and to choose how.

mod choose;
#[cfg(feature = "import")]
mod import;
mod new;
mod run;
mod words;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::SIGPIPE;
use signal_hook::flag;

pub use choose::{Choose, TimeError, json, ladder_of, time};
#[cfg(feature = "import")]
pub use import::{Import, ImportFileError, import_file};
pub use new::{New, NewSceneError, new_scene};
pub use run::{Ending, Job, Progress, Run, RunSceneError, Series, Start, run_job, run_scene};
pub use words::{Word, Words, words};

/// A command of the program.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Runs a scene file and writes its trajectory, observables and picture.
    Run(Run),
    /// Finds the cheapest model, method and step, or tolerance, for an observable of a scene.
    Choose(Choose),
    /// Finds the words of a scene file: what they mean, and what they may be.
    Words(Words),
    /// Writes a scene to begin with, commented.
    New(New),
    /// Prints a description of a robot, URDF or MJCF, as a scene.
    #[cfg(feature = "import")]
    Import(Import),
}

impl Command {
    /// Does what it says.
    ///
    /// # Errors
    /// What keeps it from that, in words for the terminal.
    pub fn run(&self) -> Result<ExitCode, Box<dyn std::error::Error>> {
        match self {
            Command::Run(run) => run.run(),
            Command::Choose(choose) => choose.run(),
            Command::Words(words) => Ok(words.run()),
            Command::New(new) => new.run(),
            #[cfg(feature = "import")]
            Command::Import(import) => import.run(),
        }
    }
}

/// Says what failed, with one `error:` at its head: what a scene's file has wrong begins with that word
/// too, as a compiler's message does.
pub fn failed(message: &str) -> ExitCode {
    let lines = message.lines().map(|line| line.strip_prefix("error: ").unwrap_or(line));
    eprintln!("error: {}", lines.collect::<Vec<_>>().join("\n"));
    ExitCode::FAILURE
}

/// Ends the program without a word where nobody reads any more what it prints, as in `... | head -1`:
/// Rust ignores that signal, and every `println!` would panic.
///
/// # Errors
/// Where the system does not take it.
#[cfg(unix)]
pub fn end_with_the_reader() -> std::io::Result<()> {
    let always = Arc::new(AtomicBool::new(true));
    flag::register_conditional_default(SIGPIPE, always).map(|_| ())
}

/// Elsewhere there is no such signal.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn end_with_the_reader() -> std::io::Result<()> {
    Ok(())
}
