//! The real workspace keeps its own rules.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use xtask::cargo::cargo;
use xtask::layers::{Metadata, check, check_tree};
use xtask::mentions::mentions;
use xtask::readme::{Readme, readmes};
use xtask::studies::FILES;

#[test]
fn the_workspace_breaks_no_rule() {
    let metadata = Metadata::read().unwrap();
    let violations: Vec<String> = check(&metadata)
        .iter()
        .chain(&check_tree(&metadata).unwrap())
        .map(ToString::to_string)
        .collect();
    assert!(violations.is_empty(), "\n{}", violations.join("\n"));
}

#[test]
fn the_readme_of_each_crate_is_its_front_page() {
    assert_written(&readmes().unwrap());
}

#[test]
fn the_page_of_each_crate_names_its_studies() {
    assert_written(&mentions().unwrap());
}

fn assert_written(readmes: &[Readme]) {
    let stale: Vec<String> = readmes
        .iter()
        .filter(|readme| !readme.is_written())
        .map(|readme| format!("{}: run `cargo xtask readmes`", readme.path.display()))
        .collect();
    assert!(stale.is_empty(), "\n{}", stale.join("\n"));
}

/// The features of every package that is compiled for a choice of packages.
fn features(selection: &[&str]) -> BTreeMap<String, String> {
    let tree = [&["tree", "--prefix", "none", "--format", "{p}|{f}"], selection].concat();
    let tree = cargo(&tree).unwrap();
    let packages = tree.lines().filter_map(|line| line.trim_end_matches(" (*)").split_once('|'));
    packages.map(|(package, features)| (package.to_owned(), features.to_owned())).collect()
}

#[test]
fn the_tests_compile_nothing_of_the_report_again() {
    let report = features(&["--package", "xtask", "--edges", "normal,build"]);
    let tests = features(&["--workspace", "--edges", "normal,build,dev"]);
    let other: Vec<_> =
        report.iter().filter(|(package, f)| tests.get(*package) != Some(*f)).collect();
    assert!(other.is_empty(), "give xtask the features that tests have: {other:#?}");
}

/// What of a choice of packages is from outside and compiled otherwise than for the whole workspace.
fn compiled_again(selection: &[&str]) -> Vec<(String, String)> {
    let whole = features(&["--workspace", "--edges", "normal,build,dev"]);
    let chosen = features(selection).into_iter();
    let outside = chosen.filter(|(package, _)| !package.starts_with("stationary"));
    outside.filter(|(package, f)| whole.get(package) != Some(f)).collect()
}

#[test]
fn what_is_built_beside_the_package_alike_compiles_nothing_from_outside_again() {
    for part in ["stationary-calculus", "stationary-scene", "stationary-trials"] {
        let beside = ["--package", "stationary-alike", "--package", part];
        let bare = ["--no-default-features", "--edges", "normal,build,dev"];
        let other = compiled_again(&[&beside[..], &bare].concat());
        assert!(other.is_empty(), "give `stationary-alike` the features of all: {other:#?}");
    }
}

#[test]
fn tests_of_robots_compile_nothing_again_on_which_scenes_stand() {
    let readers = "stationary-import/urdf,stationary-import/mjcf";
    let robots = ["--package", "stationary-import", "--package", "xtask", "--features", readers];
    let mut other = compiled_again(&[&robots[..], &["--edges", "normal,build,dev"]].concat());
    let scenes = features(&["--package", "stationary-scene", "--edges", "normal,build"]);
    other.retain(|(package, _)| scenes.contains_key(package));
    assert!(other.is_empty(), "give `stationary-alike` the features of all: {other:#?}");
}

/// `cargo fmt` follows `mod` lines, and those of the studies are made by their list.
#[test]
fn the_studies_are_formatted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/studies");
    let files = FILES.iter().map(|file| folder.join(file));
    let mut rustfmt = Command::new("rustfmt");
    let output = rustfmt.args(["--check", "--edition", "2024"]).args(files).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "run `rustfmt xtask/src/studies/*/*.rs`\n{said}");
}
