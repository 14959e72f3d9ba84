//! Cargo as a child: what it prints, or why it does not.

use std::env;
use std::io;
use std::process::{Command, Stdio};

/// Why cargo has not answered.
#[derive(Debug, thiserror::Error)]
pub enum CargoError {
    /// Cargo, or what it has built, is not to be had.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// What the system says.
        source: io::Error,
    },
    /// The command has failed.
    #[error("{what}: {complaint}")]
    Failed {
        /// The command.
        what: String,
        /// What it says.
        complaint: String,
    },
}

/// What cargo prints.
///
/// # Errors
/// Cargo that is not found, and what it complains of.
pub fn cargo(arguments: &[&str]) -> Result<String, CargoError> {
    let program = env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    printed(&program, arguments).map_err(|error| match error {
        CargoError::Failed { complaint, .. } => {
            CargoError::Failed { what: format!("cargo {}", arguments.join(" ")), complaint }
        }
        other => other,
    })
}

/// What a program prints.
///
/// # Errors
/// Those of [`cargo`].
pub fn printed(program: &str, arguments: &[&str]) -> Result<String, CargoError> {
    let what = || format!("{program} {}", arguments.join(" "));
    let output = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .map_err(|source| CargoError::System { what: what(), source })?;
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(CargoError::Failed { what: what(), complaint });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
