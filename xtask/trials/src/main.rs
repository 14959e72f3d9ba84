//! The trials alone, for whoever changes one crate and need not build the other tools:
//! `cargo run -p stationary-trials --no-default-features --features modal -- --only spectra`.

use std::process::ExitCode;
#[cfg(unix)]
use std::sync::{Arc, atomic::AtomicBool};

use clap::Parser;
#[cfg(unix)]
use signal_hook::flag;
use stationary_trials::Arguments;

/// Tests promises on random problems.
#[derive(Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

fn main() -> ExitCode {
    #[cfg(unix)]
    if let Err(error) = end_with_the_reader() {
        eprintln!("error: {error}");
        return ExitCode::from(2);
    }
    match Command::parse().arguments.run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Ends the program without a word where nobody reads any more what it prints, as in `... | head -1`:
/// Rust ignores that signal, and every `println!` would panic.
#[cfg(unix)]
fn end_with_the_reader() -> std::io::Result<()> {
    let always = Arc::new(AtomicBool::new(true));
    flag::register_conditional_default(signal_hook::consts::SIGPIPE, always).map(|_| ())
}
