//! The trials alone, for whoever changes one crate and need not build the other tools:
//! `cargo run -p stationary-trials --no-default-features --features modal -- --only spectra`.

use std::process::ExitCode;

use clap::Parser;
use stationary_trials::Arguments;

/// Tests promises on random problems.
#[derive(Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

fn main() -> ExitCode {
    match Command::parse().arguments.run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
