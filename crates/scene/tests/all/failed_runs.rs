//! A run that cannot begin or go on says so in the names of its scene.

use std::time::Instant;

use stationary_scene::{Checkpoint, Control, Observer, Progress, RunError, Scene, StepFailure};

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

/// A rod from a pin to a point of a body, and what else a test says.
fn rod_of_a_body(velocity: &str, more: &str) -> String {
    format!(
        r#"
        dimension = 2
        integrator = "stormer-verlet"
        step = 0.01
        horizon = 1
        particles = [{{ name = "left", position = [-1, 0], pinned = true }}]
        bodies = [{{ name = "bob", mass = 1, box = [0.1, 0.1], position = [0, 0], velocity = {velocity} }}]
        rods = [{{ between = ["left", "bob"] }}]
        {more}
        "#
    )
}

#[test]
fn rods_of_bodies_are_told_by_their_ends_with_contact_and_without() {
    let contact = "contact = { restitution = 0.5 }";
    for more in ["", contact] {
        let against = words(&rod_of_a_body("[1, 0]", more));
        assert_names(&against, &["against the rod from `left` to `bob`"]);
    }
    let fast = words(&rod_of_a_body("[0, 400]", ""));
    assert_names(&fast, &["the rod from `left` to `bob`", "smaller step"]);
}

#[test]
fn motors_and_starts_against_them_are_told_by_their_ends() {
    let text = |more: &str| {
        format!(
            r#"
            dimension = 2
            integrator = "stormer-verlet"
            step = 0.01
            horizon = 1
            bodies = [{{ name = "arm", mass = 1, box = [1, 0.1], position = [0.5, 0] }}]
            joints = [{{ kind = "pin", between = ["world", "arm"], at = [0, 0] }}]
            motors = [{{ between = ["world", "arm"], speed = 3 }}]
            {more}
            "#
        )
    };
    for more in ["", "contact = { restitution = 0.5 }"] {
        assert_names(&words(&text(more)), &["against the motor between `world` and `arm`"]);
    }
}

/// The shipped top with a step in which it turns several times.
#[test]
fn a_top_that_turns_too_far_in_a_step_is_named() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/heavy-top.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.replace("step = 0.0005", "step = 0.25").replace("horizon = 2", "horizon = 50");
    let said = words(&text.replace("sample_every = 4", ""));
    assert!(said.contains("top"), "{said}");
    assert_names(&said, &["step"]);
}

#[test]
fn a_rotation_that_is_not_found_is_told_as_that_of_the_body_that_turns_the_most() {
    let text = "dimension = 3\nintegrator = \"variational-rotation\"\nstep = 1\nhorizon = 2\n\
        bodies = [\n\
        { name = \"slow\", mass = 1, box = [1, 2, 3], position = [9, 0, 0] },\n\
        { name = \"fast\", mass = 1, box = [1, 2, 3], position = [0, 0, 0], \
        angular_velocity = [1, 90, 1] }]";
    assert_names(&words(text), &["`fast` turns the most in it, by 90.01 radians"]);
}

/// Its time is over from the start.
struct Late;

impl Observer for Late {
    fn stepped(&mut self, _: Progress<'_>) -> Control {
        Control::Continue
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn deadline(&self) -> Option<Instant> {
        Some(Instant::now())
    }
}

/// A hundred million own steps lie between two of the scene.
#[test]
fn a_method_that_chooses_its_steps_breaks_off_where_the_time_is_over() {
    for method in ["dormand-prince-853", "dormand-prince-54", "radau-iia-5", "bdf-5"] {
        let text = format!(
            "dimension = 1\nintegrator = \"{method}\"\ntolerance = 1e-6\nstep = 1e5\nhorizon = 1e6\n\
             observables = [\"energy\"]\n\
             particles = [{{ name = \"pin\", pinned = true, position = [0] }},\n\
             {{ name = \"it\", mass = 1, position = [1], velocity = [1] }}]\n\
             springs = [{{ between = [\"pin\", \"it\"], stiffness = 1e7 }}]\n"
        );
        let scene = Scene::parse("a.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let error = scene.run_from(None, &mut Late).unwrap_err();
        let over = matches!(&error, RunError::Interrupted(stop) if matches!(stop.source, StepFailure::TimeIsOver));
        assert!(over && error.partial().is_some_and(|run| run.times() == [0.0]), "{error:?}");
    }
}
