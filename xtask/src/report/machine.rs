//! The machine that measured.

use std::process::Command;
use std::{env, fs, thread};

use serde::{Deserialize, Serialize};

/// What is known of the machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Operating system.
    pub os: String,
    /// Instruction set.
    pub arch: String,
    /// Threads that run at once.
    pub cores: usize,
    /// Compiler, where it can be asked.
    pub rustc: Option<String>,
    /// Processor, where the system tells.
    pub cpu: Option<String>,
}

impl Machine {
    /// Asks the system.
    pub fn read() -> Self {
        Machine {
            os: env::consts::OS.to_owned(),
            arch: env::consts::ARCH.to_owned(),
            cores: thread::available_parallelism().map_or(1, usize::from),
            rustc: output(&env::var("RUSTC").unwrap_or_else(|_| "rustc".into()), &["--version"]),
            cpu: linux_cpu().or_else(|| output("sysctl", &["-n", "machdep.cpu.brand_string"])),
        }
    }

    /// One line for a reader.
    pub fn words(&self) -> String {
        let cores = if self.cores == 1 { "1 core".into() } else { format!("{} cores", self.cores) };
        let known = [self.cpu.clone(), Some(cores), Some(format!("{} {}", self.os, self.arch))];
        known.into_iter().chain([self.rustc.clone()]).flatten().collect::<Vec<_>>().join(", ")
    }
}

fn linux_cpu() -> Option<String> {
    let facts = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = facts.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}
