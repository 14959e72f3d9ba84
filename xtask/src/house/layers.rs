//! Which crate may depend on what: floors that only look down, and outside packages by name.
//!
//! Each crate states its rank in its manifest, `[package.metadata.layer] rank = 2`. A normal or a build
//! dependency points strictly downward. A dev-dependency may also point sideways, to a tool of the same
//! floor, but never upward: a crate tested with what is built on it cannot be read from below.
//! Inside, a crate may name its rooms, folders of which none imports from a later one (`rooms.rs`).
//! What may come from outside is one table here, so that a new package is a decision and not an
//! accident.

mod rooms;
mod tree;

use std::collections::BTreeMap;
use std::env;
use std::io;
use std::path::PathBuf;
use std::process::Command;

use serde::Deserialize;
pub use tree::check_tree;

/// Outside packages that a crate may use, besides those it declares for its tests and benches. A
/// crate that is not in the table is a tool and may use any; a library crate must be in it.
const ALLOWED: &[(&str, &[Outside])] = &[
    (
        "calculus",
        &[
            Always("nalgebra"),
            Always("num-dual"),
            Always("thiserror"),
            Optional("faer"),
            Optional("rayon"),
        ],
    ),
    ("chart", &[Optional("serde")]),
    ("measure", &[]),
    ("mesh", &[Always("nalgebra"), Always("thiserror"), Optional("vtkio")]),
    ("integrators", &[Always("nalgebra"), Always("thiserror"), Optional("serde")]),
    ("choose", &[Always("thiserror")]),
    ("constraints", &[Always("nalgebra"), Always("thiserror")]),
    ("rigid", &[Always("nalgebra"), Always("thiserror")]),
    (
        "contact",
        &[
            Always("nalgebra"),
            Always("thiserror"),
            Always("wide"),
            Optional("parry2d-f64"),
            Optional("parry3d-f64"),
        ],
    ),
    ("elasticity", &[Always("nalgebra"), Always("num-dual"), Always("thiserror"), Always("wide")]),
    ("modal", &[Always("nalgebra"), Always("thiserror"), Always("faer")]),
    ("laplacian", &[Always("nalgebra"), Always("thiserror"), Always("faer")]),
    (
        "scene",
        &[
            Always("base64"),
            Always("nalgebra"),
            Always("serde"),
            Always("serde_json"),
            Always("toml"),
            Always("thiserror"),
            Always("strsim"),
        ],
    ),
    (
        "import",
        &[
            Always("nalgebra"),
            Always("thiserror"),
            Optional("mjcf-rs"),
            Optional("roxmltree"),
            Optional("urdf-rs"),
        ],
    ),
    // The program's; a library that takes its crates by feature has none of them.
    (
        "stationary",
        &[
            Optional("clap"),
            Optional("indicatif"),
            Optional("serde"),
            Optional("serde_json"),
            Optional("signal-hook"),
            Optional("thiserror"),
        ],
    ),
    // The peers that timings are compared with: whoever does not compare does not build them.
    (
        "benches",
        &[
            Optional("diffsol"),
            Optional("ode_solvers"),
            Optional("rapier3d-f64"),
            Optional("sophus_lie"),
        ],
    ),
];

/// An outside package and when it may be used.
#[derive(Clone, Copy, Debug)]
enum Outside {
    /// By every build of the crate.
    Always(&'static str),
    /// Behind a feature only.
    Optional(&'static str),
}
use Outside::{Always, Optional};

impl Outside {
    fn name(self) -> &'static str {
        match self {
            Always(name) | Optional(name) => name,
        }
    }
}

/// What `cargo metadata` says, as far as it matters here.
#[derive(Clone, Debug, Deserialize)]
pub struct Metadata {
    /// The packages of the workspace.
    pub packages: Vec<Package>,
    /// The folder of the root manifest.
    pub workspace_root: PathBuf,
}

/// A package of the workspace.
#[derive(Clone, Debug, Deserialize)]
pub struct Package {
    /// Its name.
    pub name: String,
    /// Its manifest.
    pub manifest_path: PathBuf,
    /// What it depends on directly.
    pub dependencies: Vec<Dependency>,
    /// Its features, each with what it turns on.
    pub features: BTreeMap<String, Vec<String>>,
    /// What its manifest says to tools.
    pub metadata: Option<Notes>,
}

/// A direct dependency.
#[derive(Clone, Debug, Deserialize)]
pub struct Dependency {
    /// Name of the package.
    pub name: String,
    /// `None` for a normal one, else `dev` or `build`.
    pub kind: Option<String>,
    /// Whether it is behind a feature.
    pub optional: bool,
}

/// The table `[package.metadata]` of a manifest.
#[derive(Clone, Debug, Deserialize)]
pub struct Notes {
    layer: Option<Layer>,
}

#[derive(Clone, Debug, Deserialize)]
struct Layer {
    rank: Option<u32>,
    /// The folders of `src`, and the files beside them, in the order in which they may import.
    #[serde(default)]
    rooms: Vec<String>,
}

impl Metadata {
    /// Asks cargo about the workspace that holds the current folder.
    ///
    /// # Errors
    /// [`LayerError::Cargo`] and [`LayerError::Answer`].
    pub fn read() -> Result<Self, LayerError> {
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(["metadata", "--format-version", "1", "--no-deps"])
            .output()?;
        if !output.status.success() {
            let complaint = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            return Err(io::Error::other(complaint).into());
        }
        Ok(serde_json::from_slice(&output.stdout)?)
    }

    /// The crates in `crates/`, from the ground up.
    pub fn libraries(&self) -> Vec<&Package> {
        let libraries = self.workspace_root.join("crates");
        let mut packages: Vec<&Package> =
            self.packages.iter().filter(|p| p.manifest_path.starts_with(&libraries)).collect();
        packages.sort_by_key(|package| package.rank());
        packages
    }
}

impl Package {
    /// The name without the project's prefix.
    pub fn short_name(&self) -> &str {
        self.name.strip_prefix("stationary-").unwrap_or(&self.name)
    }

    fn rank(&self) -> Option<u32> {
        self.metadata.as_ref()?.layer.as_ref()?.rank
    }

    /// Its rooms, none where the manifest names none.
    fn rooms(&self) -> &[String] {
        let layer = self.metadata.as_ref().and_then(|notes| notes.layer.as_ref());
        layer.map_or(&[], |layer| &layer.rooms)
    }
}

/// A rule of the house that is broken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Violation {
    /// The manifest does not say on which floor the crate is.
    #[error("{krate}: the manifest has no rank in [package.metadata.layer]")]
    MissingRank {
        /// Which crate.
        krate: String,
    },
    /// A crate depends on one above it.
    #[error("{from} (rank {from_rank}) depends upward on {to} (rank {to_rank})")]
    Upward {
        /// Who depends.
        from: String,
        /// Its rank.
        from_rank: u32,
        /// On whom.
        to: String,
        /// The rank of that.
        to_rank: u32,
    },
    /// A crate depends on one beside it.
    #[error("{from} depends sideways on {to}, both of rank {rank}")]
    Sideways {
        /// Who depends.
        from: String,
        /// On whom.
        to: String,
        /// The rank of both.
        rank: u32,
    },
    /// A library crate has no row in the table of allowed packages.
    #[error("{krate}: no row says which outside packages it may use")]
    Unlisted {
        /// Which crate.
        krate: String,
    },
    /// A crate uses an outside package that it is not allowed.
    #[error("{krate} may not use {package}")]
    Forbidden {
        /// Which crate.
        krate: String,
        /// Which package.
        package: String,
    },
    /// A crate always builds a package that it may use behind a feature only.
    #[error("{krate} may use {package} only as an optional dependency")]
    NotOptional {
        /// Which crate.
        krate: String,
        /// Which package.
        package: String,
    },
    /// A file imports from a room after its own.
    #[error("{krate}: src/{file} imports {import}, which is in a later room")]
    UpperRoom {
        /// Which crate.
        krate: String,
        /// Which file.
        file: String,
        /// What it imports.
        import: String,
    },
    /// Files that cannot be read one after the other.
    #[error("{krate}: {} import each other in a circle", files.join(", "))]
    Circle {
        /// Which crate.
        krate: String,
        /// Which files.
        files: Vec<String>,
    },
    /// A file of a crate with rooms that is in none of them.
    #[error("{krate}: src/{file} is in none of the rooms of the manifest")]
    NoRoom {
        /// Which crate.
        krate: String,
        /// Which file.
        file: String,
    },
    /// The docs name a file or folder that is gone.
    #[error("{file}:{line}: `{path}` does not exist")]
    GonePath {
        /// The document.
        file: String,
        /// Its line.
        line: usize,
        /// What it names.
        path: String,
    },
    /// A source file is named after nothing.
    #[error("{path}: name the file after its idea")]
    NamelessFile {
        /// Which file.
        path: String,
    },
    /// Unsafe code is not forbidden.
    #[error("{manifest}: {missing}, so unsafe code is not forbidden")]
    UnsafeAllowed {
        /// The manifest.
        manifest: String,
        /// What it lacks.
        missing: &'static str,
    },
}

/// Why the rules cannot be checked.
#[derive(Debug, thiserror::Error)]
pub enum LayerError {
    /// cargo cannot be asked.
    #[error("cargo metadata: {0}")]
    Cargo(#[from] io::Error),
    /// cargo's answer is not what it used to be.
    #[error("cargo metadata: {0}")]
    Answer(#[from] serde_json::Error),
    /// A file or folder of the workspace cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A manifest is not TOML.
    #[error("{}: {source}", path.display())]
    Manifest {
        /// Which one.
        path: PathBuf,
        /// What is wrong with it.
        source: toml::de::Error,
    },
}

/// The rules on dependencies that a workspace breaks.
pub fn check(metadata: &Metadata) -> Vec<Violation> {
    let ranks: BTreeMap<&str, Option<u32>> =
        metadata.packages.iter().map(|p| (p.name.as_str(), p.rank())).collect();
    let libraries: Vec<&str> = metadata.libraries().iter().map(|p| p.name.as_str()).collect();
    let mut violations = Vec::new();
    for package in &metadata.packages {
        let krate = package.name.clone();
        let row = ALLOWED.iter().find(|(name, _)| *name == package.short_name());
        if package.rank().is_none() {
            violations.push(Violation::MissingRank { krate: krate.clone() });
        }
        if row.is_none() && libraries.contains(&package.name.as_str()) {
            violations.push(Violation::Unlisted { krate });
        }
        for dependency in package.dependencies.iter().filter(|d| d.name != package.name) {
            violations.extend(match (ranks.get(dependency.name.as_str()), row) {
                (Some(&rank), _) => edge(package, dependency, rank),
                (None, Some((_, allowed))) => outside(package, dependency, allowed),
                (None, None) => None,
            });
        }
    }
    violations
}

fn edge(package: &Package, dependency: &Dependency, to_rank: Option<u32>) -> Option<Violation> {
    // A missing rank is a violation of its own.
    let (from_rank, to_rank) = (package.rank()?, to_rank?);
    let (from, to) = (package.name.clone(), dependency.name.clone());
    if to_rank > from_rank {
        Some(Violation::Upward { from, from_rank, to, to_rank })
    } else if to_rank == from_rank && dependency.kind.as_deref() != Some("dev") {
        Some(Violation::Sideways { from, to, rank: from_rank })
    } else {
        None
    }
}

fn outside(package: &Package, dependency: &Dependency, allowed: &[Outside]) -> Option<Violation> {
    if dependency.kind.as_deref() == Some("dev") {
        return None;
    }
    let (krate, package) = (package.name.clone(), dependency.name.clone());
    match allowed.iter().find(|outside| outside.name() == dependency.name) {
        None => Some(Violation::Forbidden { krate, package }),
        Some(Optional(_)) if !dependency.optional => {
            Some(Violation::NotOptional { krate, package })
        }
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn package(name: &str, rank: Value, dependencies: Value) -> Value {
        json!({
            "name": format!("stationary-{name}"),
            "manifest_path": format!("/house/crates/{name}/Cargo.toml"),
            "dependencies": dependencies,
            "features": {},
            "metadata": { "layer": { "rank": rank } },
        })
    }

    fn needs(name: &str) -> Value {
        json!({ "name": name, "kind": null, "optional": false })
    }

    fn tests_with(name: &str) -> Value {
        json!({ "name": name, "kind": "dev", "optional": false })
    }

    fn violations(packages: &[Value]) -> Vec<String> {
        let metadata = json!({ "packages": packages, "workspace_root": "/house" });
        let metadata: Metadata = serde_json::from_value(metadata).unwrap();
        check(&metadata).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn floors_that_look_down_are_in_order() {
        let packages = [
            package("calculus", json!(0), json!([needs("nalgebra"), tests_with("proptest")])),
            package("integrators", json!(2), json!([needs("stationary-calculus")])),
        ];
        assert!(violations(&packages).is_empty());
    }

    #[test]
    fn an_upward_edge_is_named() {
        let said = ["stationary-calculus (rank 0) depends upward on stationary-rigid (rank 4)"];
        for edge in [needs("stationary-rigid"), tests_with("stationary-rigid")] {
            let packages = [
                package("calculus", json!(0), json!([edge])),
                package("rigid", json!(4), json!([])),
            ];
            assert_eq!(violations(&packages), said);
        }
    }

    #[test]
    fn a_sideways_edge_is_named_and_allowed_to_tests() {
        let packages = |edge: Value| {
            [package("modal", json!(7), json!([edge])), package("laplacian", json!(7), json!([]))]
        };
        let said = ["stationary-modal depends sideways on stationary-laplacian, both of rank 7"];
        assert_eq!(violations(&packages(needs("stationary-laplacian"))), said);
        assert!(violations(&packages(tests_with("stationary-laplacian"))).is_empty());
    }

    #[test]
    fn a_forbidden_package_is_named() {
        let packages = [package("integrators", json!(2), json!([needs("rand")]))];
        assert_eq!(violations(&packages), ["stationary-integrators may not use rand"]);
    }

    #[test]
    fn a_package_behind_a_feature_must_stay_there() {
        let packages = [package("calculus", json!(0), json!([needs("faer")]))];
        let said = ["stationary-calculus may use faer only as an optional dependency"];
        assert_eq!(violations(&packages), said);
    }

    #[test]
    fn a_missing_rank_is_named() {
        let packages = [package("calculus", Value::Null, json!([]))];
        let said = ["stationary-calculus: the manifest has no rank in [package.metadata.layer]"];
        assert_eq!(violations(&packages), said);
    }

    #[test]
    fn a_library_crate_without_a_row_is_named_and_a_tool_is_free() {
        let packages = [package("graphics", json!(3), json!([needs("wgpu")]))];
        let said = ["stationary-graphics: no row says which outside packages it may use"];
        assert_eq!(violations(&packages), said);
        let mut tool = package("bench", json!(10), json!([needs("criterion")]));
        tool["manifest_path"] = json!("/house/benches/Cargo.toml");
        assert!(violations(&[tool]).is_empty());
    }
}
