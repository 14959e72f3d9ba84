//! A run that cannot begin or go on says so in the names of its scene.

use stationary_scene::Scene;

fn words(text: &str) -> String {
    let scene = Scene::parse("a.toml", text).unwrap_or_else(|error| panic!("{error}"));
    scene.run().expect_err("the run fails").to_string()
}

/// Rows, freedoms and whatever else is counted below a scene.
fn assert_names(words: &str, names: &[&str]) {
    for name in names {
        assert!(words.contains(name), "{name} is missing in: {words}");
    }
    for counted in ["equation", "freedom", "row", "unknown ", "collider", "number "] {
        assert!(!words.contains(counted), "{counted} in: {words}");
    }
}

const RODS: &str = r#"
    dimension = 2
    integrator = "rattle"
    step = 0.01
    horizon = 1
    particles = [
        { name = "left", position = [-1, 0], pinned = true },
        { name = "right", position = [1, 0], pinned = true },
        { name = "bob", position = [0, 0], mass = 0.5, velocity = [0, 0] },
    ]
    rods = [{ between = ["left", "bob"] }, { between = ["bob", "right"] }]
"#;

#[test]
fn rods_that_hold_the_same_motion_and_starts_against_them_are_told_by_their_ends() {
    let said = words(RODS);
    assert_names(&said, &["the rod from `", "leave one of them out"]);
    let against =
        RODS.replace("[0, 0] },", "[1, 0] },").replace("position = [0, 0]", "position = [0, 0.5]");
    let said = words(&against.replace("velocity = [0, 0]", "velocity = [1, 0]"));
    assert_names(&said, &["against the rod from `"]);
}

#[test]
fn a_rod_that_is_turned_too_far_in_a_step_is_told_by_its_ends() {
    let one = RODS.replace(", { between = [\"bob\", \"right\"] }", "");
    let fast = one.replace("velocity = [0, 0]", "velocity = [0, 400]");
    assert_names(&words(&fast), &["the rod from `left` to `bob`", "smaller step"]);
}

#[test]
fn bodies_that_overlap_at_the_start_are_named() {
    let text = r#"
        dimension = 3
        integrator = "variational-rotation"
        step = 0.01
        horizon = 1
        bodies = [
            { name = "low", mass = 1, box = [1, 1, 1], position = [0, 0, 0.4] },
            { name = "high", mass = 1, ball = 0.5, position = [0, 0, 5] },
        ]
        contact = { walls = [{ normal = [0, 0, 1], at = [0, 0, 0] }] }
    "#;
    assert_names(&words(text), &["`low` and wall 1 overlap by", "at the start"]);
    let plane =
        text.replace("[1, 1, 1]", "[1, 1]").replace("variational-rotation", "stormer-verlet");
    let plane = plane.replace("dimension = 3", "dimension = 2").replace("[0, 0, 0.4]", "[0, 0.5]");
    let plane = plane.replace("[0, 0, 5]", "[0, 1.2]").replace("[0, 0, 1]", "[0, 1]");
    let plane = plane.replace("at = [0, 0, 0]", "at = [0, 0]");
    assert_names(&words(&plane), &["`low` and `high` overlap by"]);
}
