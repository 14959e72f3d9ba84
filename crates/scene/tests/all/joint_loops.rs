//! Loops, rods and motors with a speed in the coordinates of joints: the motion, tensions and works of bodies that
//! are held by forces.

use stationary_scene::{Fault, Scene, SceneError};

use crate::checkpoints::assert_resumes;
use crate::joint_coordinates::{apart, defect};

fn scene(text: &str) -> Scene {
    Scene::parse("loops.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn head(dimension: usize, method: &str, step: f64, horizon: f64) -> String {
    let gravity = if dimension == 2 { "[0, -9.81]" } else { "[0, 0, -9.81]" };
    format!(
        "dimension = {dimension}\nintegrator = {method}\nstep = {step}\nhorizon = {horizon}\n\
         uniform_gravity = {{ acceleration = {gravity} }}\n"
    )
}

/// Crank, coupler and follower in the plane, with more that acts.
fn four_bar(more: &str) -> String {
    format!(
        "bodies = [{{ name = \"crank\", mass = 0.4, moments = 0.002, position = [0.1, 0] }},\n\
         {{ name = \"coupler\", mass = 1, moments = 0.02, position = [0.4, 0.2] }},\n\
         {{ name = \"follower\", mass = 0.8, moments = 0.02, position = [0.6, 0.2] }}]\n\
         joints = [{{ kind = \"pin\", between = [\"crank\", \"world\"], at = [0, 0] }},\n\
         {{ kind = \"pin\", between = [\"coupler\", \"crank\"], at = [0.2, 0] }},\n\
         {{ kind = \"pin\", between = [\"coupler\", \"follower\"], at = [0.6, 0.4]{more} }},\n\
         {{ kind = \"pin\", between = [\"world\", \"follower\"], at = [0.6, 0] }}]\n"
    )
}

/// A bar that hangs from the middle of the coupler, which leaves a freedom where the crank is driven.
fn with_a_bob(four_bar: &str) -> String {
    let bob = "bodies = [{ name = \"bob\", mass = 0.5, moments = 0.01, position = [0.5, 0] },\n";
    let pin = "joints = [{ kind = \"pin\", between = [\"bob\", \"coupler\"], at = [0.4, 0.2] },\n";
    four_bar.replace("bodies = [", bob).replace("joints = [", pin)
}

/// A crank that drives a slider, in the plane.
fn slider_crank(rate: &str) -> String {
    format!(
        "bodies = [{{ name = \"crank\", mass = 0.4, moments = 0.002, position = [0.1, 0] }},\n\
         {{ name = \"rod\", mass = 1, moments = 0.02, position = [0.4, 0] }},\n\
         {{ name = \"piston\", mass = 0.8, box = [0.1, 0.1], position = [0.6, 0] }}]\n\
         joints = [{{ kind = \"slider\", between = [\"world\", \"piston\"], at = [0.6, 0], axis = [1, 0] }},\n\
         {{ kind = \"pin\", between = [\"rod\", \"piston\"], at = [0.6, 0] }},\n\
         {{ kind = \"pin\", between = [\"world\", \"crank\"], at = [0, 0] }},\n\
         {{ kind = \"pin\", between = [\"rod\", \"crank\"], at = [0.2, 0] }}]\n\
         motors = [{{ between = [\"crank\", \"world\"], speed = {rate} }}]\n"
    )
}

/// A plate in space on a hinged arm, a rod to the world and one to the arm; hinges that close a loop in a tilted
/// plane beside it.
fn of_rods() -> String {
    "particles = [{ name = \"nail\", position = [0.2, 1.5, 0.1], pinned = true }]\n\
     bodies = [{ name = \"arm\", mass = 1, moments = [0.1, 0.12, 0.04], position = [0.5, 0, 0], points = [[0, 0, 0.3]] },\n\
     { name = \"plate\", mass = 2, moments = [0.2, 0.3, 0.25], position = [1.3, 0.2, 0.1],\n\
     points = [[-0.3, 0.4, 0], [0.2, 0, 0.4]] }]\n\
     joints = [{ kind = \"hinge\", between = [\"world\", \"arm\"], at = [0, 0, 0], axis = [0, 1, 1] },\n\
     { kind = \"ball\", between = [\"plate\", \"arm\"], at = [1, 0, 0] }]\n\
     rods = [{ between = [\"plate.0\", \"nail\"] }, { between = [\"arm.0\", \"plate.1\"] }]\n\
     observables = [{ tension = [\"plate.0\", \"nail\"] }, { tension = [\"arm.0\", \"plate.1\"] }]\n"
        .to_owned()
}

/// A parallelogram of hinges about a tilted axis, of which the last has five rows where the tree holds three.
fn tilted_hinges() -> String {
    "bodies = [{ name = \"a\", mass = 1, moments = [0.1, 0.12, 0.04], position = [0.5, 0, 0] },\n\
     { name = \"b\", mass = 2, moments = [0.2, 0.3, 0.25], position = [1, 0, 1], angular_velocity = [0, 0, 0] },\n\
     { name = \"c\", mass = 1.5, moments = [0.1, 0.3, 0.25], position = [2.3, 0, 0.6] }]\n\
     joints = [{ kind = \"hinge\", between = [\"world\", \"a\"], at = [0, 0, 0], axis = [0, 1, 0] },\n\
     { kind = \"hinge\", between = [\"b\", \"a\"], at = [1, 0, 0], axis = [0, 1, 0] },\n\
     { kind = \"hinge\", between = [\"c\", \"b\"], at = [2, 0.5, 1.2], axis = [0, 1, 0] },\n\
     { kind = \"hinge\", between = [\"world\", \"c\"], at = [2.5, 0, 0], axis = [0, 1, 0] }]\n"
        .to_owned()
}

const EXACT: &str = "\"dormand-prince-853\"\ntolerance = 1e-11";

#[test]
fn loops_rods_and_speeds_move_in_the_coordinates_of_joints_as_bodies_held_by_forces() {
    let driven =
        "motors = [{ between = [\"world\", \"crank\"], speed = { ramp = [0, 3], to = 0.5 } }]\n";
    let cases = [
        (2, four_bar(""), 0.002),
        (2, with_a_bob(&four_bar("")) + driven, 0.002),
        (3, of_rods(), 0.001),
        (3, tilted_hinges(), 0.001),
    ];
    for (dimension, text, step) in cases {
        let run = |method: &str, step: f64| {
            scene(&(head(dimension, method, step, 0.8) + &text))
                .run()
                .unwrap_or_else(|error| panic!("{error}\n{text}"))
        };
        let truth = run(EXACT, step);
        let held = if dimension == 2 { "\"stormer-verlet\"" } else { "\"variational-rotation\"" };
        for method in ["\"joint-coordinates\"", held] {
            let runs = [2.0 * step, step].map(|step| run(method, step));
            let [first, second] = [0, 1].map(|k| apart(&truth, &runs[k]));
            let slope = (first / second).log2();
            assert!(
                (slope - 2.0).abs() < 0.1 && second < 1e-3,
                "{method}: {first} {second}\n{text}"
            );
            assert!(defect(&runs[1]).abs() < 1e-3, "{method}: {}\n{text}", defect(&runs[1]));
        }
        // The same discrete principle: to rounding the same motion, tensions and works.
        let [ours, theirs] = ["\"joint-coordinates\"", held].map(|method| run(method, step));
        assert!(apart(&ours, &theirs) < 1e-8, "{}\n{text}", apart(&ours, &theirs));
        for ((name, ours), (_, theirs)) in ours.works().iter().zip(&theirs.works()) {
            assert!((ours - theirs).abs() < 1e-8, "{name}: {ours} {theirs}");
        }
        let last = ours.times().len() - 1;
        let observed = ours.observed(last).iter().zip(theirs.observed(last));
        observed.for_each(|(a, b)| assert!((a - b).abs() < 1e-6 * b.abs() + 1e-9, "{a} {b}"));
        let observed = truth.observed(last).iter().zip(theirs.observed(last));
        observed.for_each(|(a, b)| assert!((a - b).abs() < 0.05 * b.abs() + 1e-9, "{a} {b}"));
        assert!(defect(&truth).abs() < 1e-7, "{}\n{text}", defect(&truth));
    }
}

#[test]
fn springs_and_dampers_act_beside_loops_and_a_speed_that_jumps_gives_the_others_their_impulse() {
    let damped = four_bar(", stiffness = 3, rest = 0.2, damping = 0.05");
    let jump =
        "motors = [{ between = [\"world\", \"crank\"], speed = { step = [0, 4], at = 0.311 } }]\n";
    for (text, slope) in [(damped, 2.0), (with_a_bob(&four_bar("")) + jump, 1.0)] {
        let run =
            |method: &str, step: f64| scene(&(head(2, method, step, 0.8) + &text)).run().unwrap();
        let truth = run(EXACT, 0.001);
        assert!(defect(&truth).abs() < 1e-6, "{}", defect(&truth));
        for method in ["\"joint-coordinates\"", "\"stormer-verlet\""] {
            let [first, second] = [0.004, 0.001].map(|step| apart(&truth, &run(method, step)));
            let measured = (first / second).log2() / 2.0;
            assert!(measured > slope - 0.2 && second < 4e-3, "{method}: {first} {second}\n{text}");
        }
        let other = run("\"dormand-prince-54\"\ntolerance = 1e-9", 0.001);
        assert!(apart(&truth, &other) < 1e-6, "{}", apart(&truth, &other));
    }
}

/// A mechanism that nothing is left free of follows its crank: the piston is where the triangle has it.
#[test]
fn a_driven_slider_crank_is_where_geometry_says() {
    let text = slider_crank("{ ramp = [0, 4], to = 0.3 }");
    for method in ["\"joint-coordinates\"", EXACT, "\"stormer-verlet\""] {
        let run = scene(&(head(2, method, 0.002, 0.8) + &text)).run().unwrap();
        for (sample, &t) in run.times().iter().enumerate() {
            let turned = if t < 0.3 { 2.0 / 0.3 * t * t } else { 0.6 + 4.0 * (t - 0.3) };
            let across = 0.2 * turned.sin();
            let place = 0.2 * turned.cos() + (0.16 - across * across).sqrt();
            let found = run.positions(sample)[4];
            assert!((found - place).abs() < 1e-9, "{method} at {t}: {found} {place}");
        }
    }
}

#[test]
fn a_run_with_loops_goes_on_from_a_checkpoint_to_the_same_bits() {
    let driven =
        "motors = [{ between = [\"world\", \"crank\"], speed = { step = [0, 3], at = 0.2 } }]\n";
    for method in ["\"joint-coordinates\"", "\"dormand-prince-853\"\ntolerance = 1e-6"] {
        let scene = scene(&(head(2, method, 0.01, 1.0) + &four_bar("") + driven));
        assert_resumes(&scene, &[2, 20, 21, 57], "loops");
    }
}

#[test]
fn two_speeds_of_one_freedom_are_refused() {
    let both = "motors = [{ between = [\"world\", \"bar\"], speed = 1 }, { between = [\"bar\", \"arm\"], speed = 1 },\n\
         { between = [\"arm\", \"world\"], speed = 1 }]\n";
    let text = "bodies = [{ name = \"bar\", mass = 1, moments = 0.1, position = [1, 0] },\n\
         { name = \"arm\", mass = 1, moments = 0.1, position = [1, 1] }]\n\
         joints = [{ kind = \"pin\", between = [\"bar\", \"world\"], at = [0, 0] },\n\
         { kind = \"pin\", between = [\"bar\", \"arm\"], at = [2, 0] },\n\
         { kind = \"pin\", between = [\"world\", \"arm\"], at = [2, 2] }]\n";
    let text = head(2, "\"joint-coordinates\"", 0.1, 1.0) + text + both;
    let Err(SceneError::Invalid(error)) = Scene::parse("two.toml", &text) else { panic!() };
    assert!(matches!(error.fault, Fault::MethodCannot { .. }), "{error}");
    assert!(error.to_string().contains("motors with a speed at all joints of a loop"), "{error}");
}

#[test]
fn a_rod_to_what_is_fixed_is_told_where_steps_are_chosen() {
    let head = head(2, "\"dormand-prince-853\"\ntolerance = 1e-8", 0.02, 0.1);
    let text = "particles = [{ name = \"nail\", position = [0, 1], pinned = true }]\n\
        bodies = [{ name = \"post\", mass = 1, box = [1, 1], position = [0, 0] },\n\
        { name = \"stone\", mass = 1, box = [1, 1], position = [3, 0] }]\n\
        joints = [{ kind = \"weld\", between = [\"world\", \"post\"], at = [0, 0] }]\n\
        rods = [{ between = [\"nail\", \"post\"] }]\n";
    let told = scene(&(head + text)).run().expect_err("a rod that nothing stretches").to_string();
    assert_eq!(
        told,
        "the 1 rows of the loops depend on each other here; leave out what others hold"
    );
}
