//! One run of the tests: it ends with the first that fails.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::MutantsError;

/// What the tests say.
pub enum Outcome {
    /// All pass.
    Passed,
    /// This one fails.
    Failed(String),
    /// They do not end.
    Hung,
}

/// Memory that a run may take, in KiB: a loop that fills it is a mutant found, not a machine lost.
const MEMORY: u32 = 8 << 20;

/// Runs one program after the other in `folder`, for as long as `limit` in all.
pub fn run(programs: &[PathBuf], folder: &Path, limit: Duration) -> Result<Outcome, MutantsError> {
    let end = Instant::now() + limit;
    for program in programs {
        match run_one(program, folder, end)? {
            Outcome::Passed => {}
            other => return Ok(other),
        }
    }
    Ok(Outcome::Passed)
}

fn run_one(program: &Path, folder: &Path, end: Instant) -> Result<Outcome, MutantsError> {
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\"")])
        .arg(program)
        .current_dir(folder)
        .env("CARGO_MANIFEST_DIR", folder)
        // A failure that is written down would be tried first with the next mutant.
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
        .env("PROPTEST_MAX_SHRINK_ITERS", "0")
        .env("INSTA_UPDATE", "no")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(MutantsError::file(program))?;
    let (sender, lines) = mpsc::channel();
    if let Some(output) = child.stdout.take() {
        thread::spawn(move || {
            let lines = BufReader::new(output).lines();
            lines.map_while(Result::ok).try_for_each(|line| sender.send(line))
        });
    }
    let outcome = loop {
        match lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
            Ok(line) => {
                let name = line.strip_prefix("test ").and_then(|l| l.strip_suffix(" ... FAILED"));
                if let Some(name) = name {
                    break Outcome::Failed(name.to_string());
                }
            }
            Err(RecvTimeoutError::Timeout) => break Outcome::Hung,
            Err(RecvTimeoutError::Disconnected) => {
                let status = child.wait().map_err(MutantsError::file(program))?;
                let outcome = Outcome::Failed(status.to_string());
                return Ok(if status.success() { Outcome::Passed } else { outcome });
            }
        }
    };
    child.kill().and_then(|()| child.wait()).map_err(MutantsError::file(program))?;
    Ok(outcome)
}
