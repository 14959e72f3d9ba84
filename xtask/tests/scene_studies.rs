//! The report on a user's own scene, as a library.

use stationary_integrators::{Conservation, Method};
use stationary_scene::Scene;
use xtask::studies::scene::{long_run, work_precision};
use xtask::study::Size;

const TWO_MASSES: &str = r#"
title = "Two masses on a spring"
dimension = 2
integrator = "stormer-verlet"
step = 0.05
horizon = 4

[[particles]]
name = "left"
mass = 1
position = [-1, 0]
velocity = [0, -0.5]

[[particles]]
name = "right"
mass = 2
position = [1, 0]
velocity = [0, 0.25]

[[springs]]
between = ["left", "right"]
rest_length = 1.5
stiffness = 10
"#;

#[test]
fn a_scene_is_told_which_method_and_step_to_write_into_its_file() {
    let scene = Scene::parse("two.toml", TWO_MASSES).unwrap();
    let study = work_precision(&scene, Size::Default).unwrap();
    assert!(study.claims.iter().all(xtask::study::Claim::holds), "{:?}", study.claims);
    let (_, advice) = study.conclusion.split_once("for 1e-6: ").unwrap();
    let word = |text: &str, key: &str| {
        let (_, rest) = text.split_once(&format!("{key} = ")).unwrap();
        rest.split([' ', ';', '.']).next().unwrap().trim_matches('"').to_owned()
    };
    let method: Method = word(advice, "integrator").parse().unwrap();
    // What it advises can be done, and does what it says.
    let (_, step) = advice.split_once("step = ").unwrap();
    let step: f64 = step.split([';', ' ']).next().unwrap().trim_end_matches('.').parse().unwrap();
    let advised = scene.with_method(method).unwrap().with_step(step).unwrap().run().unwrap();
    let far_finer = Scene::parse("two.toml", TWO_MASSES).unwrap();
    let far_finer =
        far_finer.with_method(method).unwrap().with_step(step / 16.0).unwrap().run().unwrap();
    let last = |run: &stationary_scene::Run| run.positions(run.times().len() - 1)[..2].to_vec();
    let off: f64 = last(&advised).iter().zip(last(&far_finer)).map(|(a, b)| (a - b).abs()).sum();
    assert!(off < 2e-6, "{off}");
}

#[test]
fn momenta_of_a_free_scene_are_kept_by_the_methods_that_promise_it() {
    let scene = Scene::parse("two.toml", TWO_MASSES).unwrap();
    let table = long_run(&scene, Size::Default).unwrap().table.to_string();
    for method in Method::ALL {
        let facts = method.facts();
        let row = table.lines().find(|line| line.split(' ').next() == Some(facts.name)).unwrap();
        let [.., linear, angular, _] = row.split_whitespace().collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        assert_eq!(linear, "<1e-12", "{row}");
        let exact = facts.angular_momentum == Conservation::Exact;
        assert_eq!(angular == "<1e-12", exact, "{row}");
    }
}

#[test]
fn particles_that_touch_by_impulses_are_refused_by_name() {
    let touching = "[contact]\nwalls = [{ normal = [0, 1], at = [0, -1] }]\n";
    let scene = TWO_MASSES.replace("velocity = [0, -0.5]", "velocity = [0, -0.5]\nradius = 0.1");
    let scene = Scene::parse("touching.toml", &(scene + touching)).unwrap();
    for error in [work_precision(&scene, Size::Default), long_run(&scene, Size::Default)] {
        assert!(error.unwrap_err().to_string().ends_with("the scene has contact by impulses"));
    }
}
