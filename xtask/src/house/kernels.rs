//! The hot kernels of the crates, as this workspace tunes its benches and as Cargo's own release
//! profile builds them, run in turn.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::cargo::{CargoError, cargo, printed};
use crate::report::aligned;

/// The profiles of the workspace's manifest: the tuned one first.
const PROFILES: [&str; 2] = ["bench", "defaults"];
/// How often each build is run; the least times count.
const ROUNDS: usize = 3;

/// What is read of a message of cargo.
#[derive(Deserialize)]
struct Message {
    executable: Option<String>,
}

/// Nanoseconds of each kernel, in the order of the profiles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kernels(BTreeMap<String, [f64; 2]>);

/// Builds the kernels in both profiles and times them in turn.
///
/// # Errors
/// What keeps cargo from building them, or them from running.
pub fn kernels() -> Result<Kernels, CargoError> {
    let [tuned, defaults] = PROFILES.map(build);
    let programs = [tuned?, defaults?];
    let mut kernels = Kernels::default();
    for _ in 0..ROUNDS {
        for (k, program) in programs.iter().enumerate() {
            kernels.take(k, &printed(program, &["--bench"])?);
        }
    }
    Ok(kernels)
}

/// The path of the built kernels.
fn build(profile: &str) -> Result<String, CargoError> {
    let package = ["bench", "--package", "stationary-benches", "--bench", "kernels", "--no-run"];
    let arguments = [&package[..], &["--profile", profile, "--message-format", "json"]].concat();
    let messages = cargo(&arguments)?;
    let built = messages.lines().filter_map(|line| serde_json::from_str::<Message>(line).ok());
    built.filter_map(|message| message.executable).next_back().ok_or_else(|| CargoError::Failed {
        what: format!("cargo {}", arguments.join(" ")),
        complaint: "no program was built".into(),
    })
}

impl Kernels {
    /// Takes the times that a run has printed where they are less than those before.
    fn take(&mut self, profile: usize, output: &str) {
        for (name, time) in output.lines().filter_map(|line| line.split_once('\t')) {
            if let Ok(time) = time.parse::<f64>() {
                let times = self.0.entry(name.to_owned()).or_insert([f64::INFINITY; 2]);
                times[profile] = times[profile].min(time);
            }
        }
    }

    /// The times and their ratios as a table.
    pub fn table(&self) -> String {
        let row = |(name, [tuned, defaults]): (&String, &[f64; 2])| {
            let ratio = defaults / tuned;
            vec![
                name.clone(),
                format!("{tuned:.1}"),
                format!("{defaults:.1}"),
                format!("{ratio:.2}"),
            ]
        };
        let rows: Vec<Vec<String>> = self.0.iter().map(row).collect();
        aligned(&["kernel [ns]", "tuned", "defaults", "ratio"], &rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_times_of_all_rounds_count() {
        let mut kernels = Kernels::default();
        kernels.take(0, "a step\t12.0\nnoise\n");
        kernels.take(1, "a step\t15.0\n");
        kernels.take(0, "a step\t10.0\n");
        let table = kernels.table();
        let row: Vec<&str> = table.lines().last().unwrap_or("").split_whitespace().collect();
        assert_eq!(row, ["a", "step", "10.0", "15.0", "1.50"]);
    }
}
