//! A frame that turns: what is free flies straight in the frame that does not.
//!
//! ```text
//! x(t) = R(-W t) (x0 + (v0 + W x x0) t)          seen in the frame, of a particle on which nothing acts
//! ```

use nalgebra::{Rotation3, Vector3};
use stationary_measure::loglog_slope;
use stationary_scene::{BodyFault, Fault, Run, Scene, SceneError};

const TURNING: [f64; 3] = [0.2, -0.5, 0.9];
const PLACE: [f64; 3] = [0.7, 0.1, -0.4];
const VELOCITY: [f64; 3] = [0.3, 0.8, 0.2];
const TIME: f64 = 4.0;

fn free(method: &str, step: f64) -> Run {
    let text = format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = {TIME}\n\
         frame = {{ angular_velocity = {TURNING:?} }}\n\
         particles = [{{ name = \"stone\", mass = 2, position = {PLACE:?}, velocity = {VELOCITY:?} }}]"
    );
    Scene::parse("free", &text).unwrap().run().unwrap()
}

/// How far it ends from the straight line.
fn off(run: &Run) -> f64 {
    let [w, x, v] = [TURNING, PLACE, VELOCITY].map(Vector3::from);
    let straight = x + (v + w.cross(&x)) * TIME;
    let seen = Rotation3::new(-w * TIME) * straight;
    let end = run.positions(run.times().len() - 1);
    (Vector3::from_column_slice(end) - seen).norm()
}

#[test]
fn what_is_free_flies_straight_in_the_frame_that_does_not_turn() {
    let steps = [0.04, 0.02, 0.01, 0.005];
    let errors = steps.map(|step| (step, off(&free("\"stormer-verlet\"", step))));
    let order = loglog_slope(&errors).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order}: {errors:?}");
    for adaptive in ["dormand-prince-853", "radau-iia-5", "bdf-5"] {
        let run = free(&format!("\"{adaptive}\"\ntolerance = 1e-9"), 0.5);
        assert!(off(&run) < 1e-6, "{adaptive}: {}", off(&run));
    }
}

#[test]
fn the_work_of_the_frame_is_the_change_of_the_energy_seen_in_it() {
    let run = free("\"stormer-verlet\"", 0.001);
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    let works = run.works();
    assert_eq!(works[0].0, "frame");
    assert!((works[0].1 / change - 1.0).abs() < 1e-5, "{works:?} {change}");
}

#[test]
fn in_the_plane_a_frame_turns_by_a_number() {
    let text = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.001\nhorizon = 1\n\
                frame = { angular_velocity = 2 }\n\
                particles = [{ name = \"stone\", mass = 1, position = [1, 0], velocity = [0, -2] }]";
    // It stands still in the frame that does not turn.
    let run = Scene::parse("still", text).unwrap().run().unwrap();
    let end = run.positions(run.times().len() - 1);
    let expected = [2.0_f64.cos(), -2.0_f64.sin()];
    assert!((end[0] - expected[0]).hypot(end[1] - expected[1]) < 1e-5, "{end:?}");
}

#[test]
fn frames_that_cannot_be_are_refused() {
    let fault = |dimension: usize, method: &str, rest: &str| {
        let text = format!(
            "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.1\nhorizon = 1\n{rest}"
        );
        match Scene::parse("bad", &text) {
            Err(SceneError::Invalid(diagnostic)) => diagnostic.fault.clone(),
            other => panic!("{other:?}"),
        }
    };
    let particle = "particles = [{ name = \"a\", mass = 1, position = [0, 0] }]\n";
    let frame = "frame = { angular_velocity = 1 }\n";
    let bodies = "bodies = [{ name = \"a\", mass = 1, ball = 1, position = [0, 0] }]\n";
    assert_eq!(fault(2, "stormer-verlet", &format!("{frame}{bodies}")), Fault::FrameOfBodies);
    let vector = format!("frame = {{ angular_velocity = [0, 0, 1] }}\n{particle}");
    assert!(matches!(fault(2, "stormer-verlet", &vector), Fault::Bodies(BodyFault::Turn { .. })));
    let order = fault(2, "runge-kutta-4", &format!("{frame}{particle}"));
    assert!(matches!(order, Fault::MethodCannot { .. }), "{order}");
    let modes = format!("modes = 1\n{frame}{particle}");
    assert!(matches!(fault(2, "linear-modes", &modes), Fault::MethodCannot { .. }));
    let empty = fault(2, "stormer-verlet", &format!("frame = {{}}\n{particle}")).to_string();
    assert!(empty.contains("angular_velocity"), "{empty}");
}
