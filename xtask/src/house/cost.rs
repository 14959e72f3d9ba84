//! What one crate costs its user: how many packages it pulls in, and how long a clean build takes.

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::io;
use std::time::{Duration, Instant};

use crate::cargo::{CargoError, cargo};
use crate::layers::{LayerError, Metadata, Package};
use crate::report::aligned;

/// Packages that a crate may pull in. `sparse` brings a solver and has the budget of the rest.
const BUDGETS: [(&str, usize); 11] = [
    ("measure", 0),
    ("chart", 5),
    ("calculus", 30),
    ("integrators", 30),
    ("choose", 35),
    ("constraints", 30),
    ("rigid", 30),
    ("contact", 95),
    ("scene", 120),
    ("import", 30),
    ("stationary", 140),
];
const BUDGET: usize = 80;
/// The feature that is counted in a row of its own.
const SPARSE: &str = "sparse";

/// Whether crates are built to be timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// Each in an empty folder, in release.
    Timed,
    /// Not at all.
    Skipped,
}

/// What a crate costs with one choice of features.
#[derive(Clone, Debug)]
pub struct Cost {
    /// The crate, and the feature if one is on.
    pub name: String,
    /// Packages that it pulls in, itself not counted.
    pub packages: usize,
    /// How many it may pull in.
    pub budget: usize,
    /// How long a clean release build takes, where it was timed.
    pub build: Option<Duration>,
}

impl Cost {
    /// What to say if it is over its budget.
    pub fn complaint(&self) -> Option<String> {
        let Cost { name, packages, budget, .. } = self;
        (packages > budget)
            .then(|| format!("{name} pulls in {packages} packages, allowed are {budget}"))
    }
}

/// Why a cost is unknown.
#[derive(Debug, thiserror::Error)]
pub enum CostError {
    /// The workspace cannot be read.
    #[error(transparent)]
    Metadata(#[from] LayerError),
    /// A crate cannot be built, or a folder for it not be cleared.
    #[error(transparent)]
    Cargo(#[from] CargoError),
}

/// The cost of every library crate, and of those with a feature `sparse` a second time with it.
///
/// # Errors
/// What keeps cargo from answering.
pub fn cost(build: Build) -> Result<Vec<Cost>, CostError> {
    let metadata = Metadata::read()?;
    let mut costs = Vec::new();
    for library in metadata.libraries() {
        costs.push(cost_of(library, None, build)?);
        if library.features.contains_key(SPARSE) {
            costs.push(cost_of(library, Some(SPARSE), build)?);
        }
    }
    Ok(costs)
}

/// The costs as a table.
pub fn table(costs: &[Cost]) -> String {
    let rows: Vec<Vec<String>> = costs
        .iter()
        .map(|cost| {
            let build = cost.build.map_or("-".into(), |wall| format!("{:.1}", wall.as_secs_f64()));
            vec![cost.name.clone(), cost.packages.to_string(), cost.budget.to_string(), build]
        })
        .collect();
    aligned(&["crate", "packages", "budget", "release build [s]"], &rows)
}

fn cost_of(library: &Package, feature: Option<&str>, build: Build) -> Result<Cost, CostError> {
    let mut selection = vec!["--package", &library.name];
    selection.extend(feature.iter().flat_map(|feature| ["--features", feature]));
    let tree =
        cargo(&[&["tree", "--edges", "normal", "--prefix", "none"], &selection[..]].concat())?;
    let short = library.short_name();
    let own_budget = BUDGETS.iter().find(|(name, _)| *name == short && feature.is_none());
    Ok(Cost {
        name: feature.map_or(short.to_owned(), |feature| format!("{short} + {feature}")),
        packages: packages_of(&tree),
        budget: own_budget.map_or(BUDGET, |(_, budget)| *budget),
        build: match build {
            Build::Timed => Some(clean_build(&selection)?),
            Build::Skipped => None,
        },
    })
}

/// Different packages of a `cargo tree`, whose first line is the crate itself.
fn packages_of(tree: &str) -> usize {
    let name_and_version = |line: &str| {
        let mut words = line.split_whitespace();
        Some((words.next()?.to_owned(), words.next()?.to_owned()))
    };
    tree.lines().skip(1).filter_map(name_and_version).collect::<BTreeSet<_>>().len()
}

fn clean_build(selection: &[&str]) -> Result<Duration, CostError> {
    let target = env::temp_dir().join(format!("stationary-cost-{}", std::process::id()));
    let folder = target.display().to_string();
    let clear = || match fs::remove_dir_all(&target) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(CargoError::System { what: folder.clone(), source })
        }
        _ => Ok(()),
    };
    clear()?;
    let start = Instant::now();
    cargo(&[&["build", "--quiet", "--release", "--target-dir", &folder], selection].concat())?;
    let wall = start.elapsed();
    clear()?;
    Ok(wall)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_counts_once_and_the_crate_itself_not_at_all() {
        let tree =
            "own v0.1.0 (/here)\na v1.0.0\nb v1.0.0 (proc-macro)\na v1.0.0 (*)\n\na v2.0.0\n";
        assert_eq!(packages_of(tree), 3);
    }

    #[test]
    fn only_what_is_over_its_budget_is_complained_of() {
        let cost = |packages| Cost { name: "rigid".into(), packages, budget: 30, build: None };
        assert_eq!(cost(30).complaint(), None);
        let said = "rigid pulls in 31 packages, allowed are 30";
        assert_eq!(cost(31).complaint().as_deref(), Some(said));
    }
}
