//! The shipped scenes end to end: from the file to the summary and the files written.

use std::path::PathBuf;

use stationary::program::{Progress, run_scene};
use stationary_scene::Scene;

/// Runs a shipped scene into a fresh folder and returns its summary.
fn run(name: &str) -> (String, PathBuf) {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let summary = run_scene(&scenes.join(format!("{name}.toml")), &out, Progress::Hidden);
    let summary = summary.expect("a scene that runs");
    assert_eq!(summary.broken_claims, 0, "{summary}");
    (summary.to_string(), out)
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

/// The summary of a shipped scene that is run for a shorter time, before chaos reaches its digits.
fn run_until(name: &str, horizon: f64) -> String {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let scene = Scene::read(scenes.join(format!("{name}.toml"))).expect("a scene");
    let run = scene.with_horizon(horizon).expect("a horizon").run();
    run.unwrap_or_else(|error| panic!("{error}")).summary().to_string()
}

#[test]
fn two_balls_of_the_cradle_come_in_and_two_go_out() {
    insta::assert_snapshot!(run("newtons-cradle").0);
}

#[test]
fn the_slider_crank_comes_back_from_its_stop() {
    insta::assert_snapshot!(run("slider-crank-with-stop").0);
}

#[test]
fn the_bar_swings_up_when_the_ball_strikes_it() {
    insta::assert_snapshot!(run("ball-strikes-a-pendulum").0);
}

#[test]
fn one_ball_of_the_cradle_on_rods_comes_in_and_one_goes_out() {
    insta::assert_snapshot!(run("newtons-cradle-on-rods").0);
}

#[test]
fn the_four_bar_leaves_the_crate_where_its_rocker_turns_back() {
    insta::assert_snapshot!(run("four-bar-pushes-a-crate").0);
}

#[test]
fn the_plunger_shoots_the_ball_as_two_masses_have_it() {
    insta::assert_snapshot!(run("plunger-shoots-a-ball").0);
}

#[test]
fn the_closer_shuts_the_door_that_met_its_stop() {
    insta::assert_snapshot!(run("sprung-door").0);
}

#[test]
fn the_wheel_rolls_over_the_bump_and_the_body_comes_to_rest() {
    insta::assert_snapshot!(run("wheel-over-a-bump").0);
}

#[test]
fn the_nine_balls_leave_as_symmetric_as_they_lay() {
    insta::assert_snapshot!(run("nine-ball-break").0);
}

#[test]
fn the_block_slides_down_its_slope() {
    insta::assert_snapshot!(run("block-on-incline").0);
}

#[test]
fn the_stack_stands_while_a_box_falls_towards_it() {
    insta::assert_snapshot!(run_until("box-stack", 0.3));
}

#[test]
fn the_arch_of_stones_stands() {
    // At rest a drift of the energy is relative to no motion: its digits are noise.
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let scene = Scene::read(scenes.join("masonry-arch.toml")).expect("a scene");
    let run = scene.run().unwrap_or_else(|error| panic!("{error}"));
    let last = run.times().len() - 1;
    let said = [0, last / 2, last].map(|sample| {
        let observed = run.observed(sample);
        format!("energy {:.0}, keystone at {:.3}", observed[0], observed[4])
    });
    insta::assert_snapshot!(said.join("; "), @"energy 2177, keystone at 1.076; energy 2177, keystone at 1.076; energy 2177, keystone at 1.076");
}

#[test]
fn the_wrench_tumbles_about_its_centre_of_mass() {
    insta::assert_snapshot!(run("tumbling-wrench").0);
}

#[test]
fn the_lower_end_of_the_slinky_waits() {
    insta::assert_snapshot!(run("slinky-release").0);
}

#[test]
fn the_cantilever_swings_about_its_sag() {
    insta::assert_snapshot!(run("cantilever").0);
}

#[test]
fn the_cloth_falls_onto_the_ball() {
    insta::assert_snapshot!(run_until("cloth-on-a-ball", 0.2));
}

#[test]
fn the_bell_rings_in_closed_form() {
    insta::assert_snapshot!(run("struck-bell").0);
}

#[test]
fn the_warm_cap_evens_out_over_the_sphere() {
    insta::assert_snapshot!(run("warm-sphere").0);
}

#[test]
fn a_ball_with_draw_comes_back_and_a_masse_shot_turns_aside() {
    let (summary, _) = run("billiard-with-spin");
    insta::assert_snapshot!(summary);
}

/// Their claims say how it ends; how they meet on the way has digits that another processor does not reproduce.
#[test]
fn dominoes_fall_discs_come_to_rest_in_bins_and_the_tippe_top_stands_on_its_head() {
    for name in ["domino-row", "galton-board", "tippe-top"] {
        let (summary, out) = run(name);
        assert!(summary.matches("  holds  ").count() >= 4, "{summary}");
        let picture = std::fs::read_to_string(out.join("picture.svg")).expect("a picture");
        assert!(picture.contains("opacity=\"0.16\""), "what moves is drawn with its size");
    }
}

#[test]
fn the_plane_of_foucaults_pendulum_turns_by_a_right_angle() {
    let (summary, _) = run("foucault-pendulum");
    insta::assert_snapshot!(summary);
}
