//! The shipped scenes end to end: from the file to the summary and the files written.

use std::path::PathBuf;

use xtask::report::Progress;
use xtask::run::run_scene;

/// Runs a shipped scene into a fresh folder and returns its summary.
fn run(name: &str) -> (String, PathBuf) {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let summary = run_scene(&scenes.join(format!("{name}.toml")), &out, Progress::Hidden);
    (summary.expect("a scene that runs").to_string(), out)
}

#[test]
fn the_outer_solar_system_keeps_its_energy_and_momenta() {
    let (summary, out) = run("outer-solar-system");
    insta::assert_snapshot!(summary);
    for file in ["trajectory.csv", "observables.csv", "picture.svg"] {
        assert!(out.join(file).metadata().expect("a file").len() > 100, "{file}");
    }
}

#[test]
fn the_spring_net_hangs_from_its_corners() {
    let (summary, _) = run("spring-net");
    insta::assert_snapshot!(summary);
}

#[test]
fn the_chain_of_rods_cracks_like_a_whip() {
    let (summary, _) = run("pendulum-chain");
    insta::assert_snapshot!(summary);
}

#[test]
fn the_bridge_breaks_under_its_load() {
    let (summary, out) = run("breaking-bridge");
    insta::assert_snapshot!(summary);
    let events = std::fs::read_to_string(out.join("events.csv")).expect("the events");
    assert!(
        events.lines().nth(1).is_some_and(|first| first.starts_with("0.114,t3,t4")),
        "{events}"
    );
}

#[test]
fn the_thrown_racket_turns_over_and_keeps_its_momenta() {
    let (summary, out) = run("thrown-racket");
    insta::assert_snapshot!(summary);
    let picture = std::fs::read_to_string(out.join("picture.svg")).expect("a picture");
    assert!(picture.contains(">bodies<"));
}

#[test]
fn the_heavy_top_nods_on_its_tip() {
    let (summary, _) = run("heavy-top");
    insta::assert_snapshot!(summary);
}
