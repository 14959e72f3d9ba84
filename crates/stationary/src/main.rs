//! The program `stationary`.

use std::process::ExitCode;

use clap::Parser;
use stationary::program::{Command, end_with_the_reader, failed};

/// Physical simulation from geometric first principles.
#[derive(Parser)]
#[command(name = "stationary", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    if let Err(error) = end_with_the_reader() {
        return failed(&error.to_string());
    }
    command.run().unwrap_or_else(|error| failed(&error.to_string()))
}
