//! One run of the tests: it ends with the first that fails.
//!
//! Its time is that of the processor, so that what else the machine does finds no mutants.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

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

/// Memory that a program may take, in KiB: a loop that fills it is a mutant found, not a machine lost.
const MEMORY: u32 = 8 << 20;
/// A program that says nothing for so long, seconds, waits for something that never comes.
const SILENCE: Duration = Duration::from_secs(600);
/// The signal for too much time of the processor.
const SIGXCPU: i32 = 24;

/// Runs one program after the other in `folder`, each for as long as `limit` seconds of a processor.
pub fn run(programs: &[PathBuf], folder: &Path, limit: u64) -> Result<Outcome, MutantsError> {
    for program in programs {
        let mut child = start(program, folder, limit).map_err(MutantsError::file(program))?;
        let lines = lines(&mut child);
        let outcome = watch(&mut child, &lines).map_err(MutantsError::file(program))?;
        if !matches!(outcome, Outcome::Passed) {
            return Ok(outcome);
        }
    }
    Ok(Outcome::Passed)
}

/// Seconds of a processor that all programs have taken that were waited for.
pub fn processor_seconds() -> f64 {
    let status = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name in parentheses; children's user and system time, in hundredths.
    let fields = status.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn start(program: &Path, folder: &Path, limit: u64) -> std::io::Result<Child> {
    Command::new("sh")
        .args(["-c", &format!("ulimit -v {MEMORY}; ulimit -S -t {limit}; exec \"$0\"")])
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
}

/// What the program writes, line by line.
fn lines(child: &mut Child) -> Receiver<String> {
    let (sender, lines) = mpsc::channel();
    if let Some(output) = child.stdout.take() {
        thread::spawn(move || {
            let lines = BufReader::new(output).lines();
            lines.map_while(Result::ok).try_for_each(|line| sender.send(line))
        });
    }
    lines
}

/// Waits for the end, or ends the program at the first test that fails.
fn watch(child: &mut Child, lines: &Receiver<String>) -> std::io::Result<Outcome> {
    let outcome = loop {
        match lines.recv_timeout(SILENCE) {
            Ok(line) => {
                let name = line.strip_prefix("test ").and_then(|l| l.strip_suffix(" ... FAILED"));
                if let Some(name) = name {
                    break Outcome::Failed(name.to_string());
                }
            }
            Err(RecvTimeoutError::Timeout) => break Outcome::Hung,
            Err(RecvTimeoutError::Disconnected) => return child.wait().map(ended),
        }
    };
    child.kill()?;
    child.wait()?;
    Ok(outcome)
}

fn ended(status: ExitStatus) -> Outcome {
    match status.signal() {
        Some(SIGXCPU) => Outcome::Hung,
        _ if status.success() => Outcome::Passed,
        _ => Outcome::Failed(status.to_string()),
    }
}
