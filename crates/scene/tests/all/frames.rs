//! A frame that turns: what is seen in it is what is seen in the frame that does not, turned back.
//!
//! ```text
//! x(t) = R(-W t) (x0 + (v0 + W x x0) t)          of a particle on which nothing acts
//! x(t) = R(-W t) y(t),    y' = v0 + W x x0, w0 + W at the start      of every point of a body
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

/// A free box, and a trunk on a ball joint at the origin that carries a vane; `turning` is what the frame is seen
/// to turn by where these are told in the one that does not.
fn bodies(method: &str, step: f64, turning: [f64; 3], more: &str) -> Run {
    let w = Vector3::from(turning);
    let moving = |place: [f64; 3], velocity: [f64; 3], spin: [f64; 3]| {
        let v = Vector3::from(velocity) + w.cross(&Vector3::from(place));
        let spin = Vector3::from(spin) + w;
        let [v, spin]: [[f64; 3]; 2] = [v.into(), spin.into()];
        format!("position = {place:?}, velocity = {v:?}, angular_velocity = {spin:?}")
    };
    let trunk = Vector3::new(0.7, -0.4, 0.3);
    let on_trunk = |place: [f64; 3]| trunk.cross(&Vector3::from(place)).into();
    let [low, vane] = [[0.0, 0.0, -0.4], [0.4, 0.0, -0.8]];
    let vane_spin = trunk + Vector3::new(0.0, 0.5, 0.5);
    let hinge = Vector3::new(0.0, 0.0, -0.8);
    let vane_velocity = trunk.cross(&hinge) + vane_spin.cross(&(Vector3::from(vane) - hinge));
    let text = format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = 0.8\n{more}\
         bodies = [{{ name = \"free\", mass = 2, box = [1, 2, 3], {} }},\n\
         {{ name = \"trunk\", mass = 1, box = [0.2, 0.3, 0.8], {} }},\n\
         {{ name = \"vane\", mass = 0.5, box = [0.5, 0.2, 0.1], {} }}]\n\
         joints = [{{ kind = \"ball\", between = [\"world\", \"trunk\"], at = [0, 0, 0] }},\n\
         {{ kind = \"hinge\", between = [\"trunk\", \"vane\"], at = [0, 0, -0.8], axis = [0, 1, 1] }}]\n",
        moving([9.0, 0.2, -0.1], [0.1, 0.3, -0.2], [0.5, 1.5, -0.8]),
        moving(low, on_trunk(low), trunk.into()),
        moving(vane, vane_velocity.into(), vane_spin.into()),
    );
    Scene::parse("bodies", &text).unwrap_or_else(|error| panic!("{error}")).run().unwrap()
}

const FRAME: &str = "frame = { angular_velocity = [0.2, -0.5, 0.9] }\n";

#[test]
fn bodies_and_their_joints_move_as_in_the_frame_that_does_not_turn() {
    let still = bodies("\"joint-coordinates\"", 0.0005, TURNING, "");
    let back = Rotation3::new(-Vector3::from(TURNING) * 0.8);
    let end = |run: &Run| run.positions(run.times().len() - 1).to_vec();
    let seen: Vec<f64> = end(&still)
        .chunks_exact(3)
        .flat_map(|x| (back * Vector3::from_column_slice(x)).iter().copied().collect::<Vec<_>>())
        .collect();
    // A wall that nothing reaches has joints solved together with gaps, by steps of order 1.
    let wall = "contact = { walls = [{ normal = [0, 0, 1], at = [0, 0, -90] }] }\n";
    for (method, contact, order) in [
        ("\"variational-rotation\"", "", 2.0),
        ("\"joint-coordinates\"", "", 2.0),
        ("\"variational-rotation\"", wall, 1.0),
    ] {
        let errors = [0.02, 0.01, 0.005, 0.0025].map(|step| {
            let run = bodies(method, step, [0.0; 3], &format!("{FRAME}{contact}"));
            let apart = end(&run).iter().zip(&seen).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            (step, apart)
        });
        let slope = loglog_slope(&errors).unwrap();
        assert!((slope - order).abs() < 0.15, "{method} {contact}: {slope}: {errors:?}");
    }
}

#[test]
fn a_body_that_is_free_in_space_is_seen_alike_by_every_method() {
    let body = |method: &str, step: f64, frame: &str, spin: [f64; 3], velocity: [f64; 3]| {
        let text = format!(
            "dimension = 3\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1\n{frame}\
             bodies = [{{ name = \"a\", box = [1, 2, 3], mass = 2, position = {PLACE:?}, \
             velocity = {velocity:?}, angular_velocity = {spin:?} }}]\n"
        );
        Scene::parse("body", &text).unwrap_or_else(|error| panic!("{error}")).run().unwrap()
    };
    let [w, x, v] = [TURNING, PLACE, VELOCITY].map(Vector3::from);
    let spin = Vector3::new(0.5, 1.5, -0.8);
    let [all, moved] = [spin + w, v + w.cross(&x)].map(<[f64; 3]>::from);
    let still = body("exact-rotation", 0.01, "", all, moved);
    let back = Rotation3::new(-w);
    let end = |run: &Run| run.positions(run.times().len() - 1).to_vec();
    let seen: Vec<Vector3<f64>> =
        end(&still).chunks_exact(3).map(|x| back * Vector3::from_column_slice(x)).collect();
    for method in ["exact-rotation", "axis-rotations", "variational-rotation"] {
        let errors = [0.04, 0.02, 0.01].map(|step| {
            let run = body(method, step, FRAME, spin.into(), VELOCITY);
            let off = end(&run)
                .chunks_exact(3)
                .zip(&seen)
                .map(|(x, seen)| (Vector3::from_column_slice(x) - seen).norm())
                .fold(0.0, f64::max);
            (step, off)
        });
        let order = loglog_slope(&errors).unwrap();
        assert!((order - 2.0).abs() < 0.15, "{method}: {order}: {errors:?}");
    }
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
    let vector = format!("frame = {{ angular_velocity = [0, 0, 1] }}\n{particle}");
    assert!(matches!(fault(2, "stormer-verlet", &vector), Fault::Bodies(BodyFault::Turn { .. })));
    let order = fault(2, "runge-kutta-4", &format!("{frame}{particle}"));
    assert!(matches!(order, Fault::MethodCannot { .. }), "{order}");
    let modes = format!("modes = 1\n{frame}{particle}");
    assert!(matches!(fault(2, "linear-modes", &modes), Fault::MethodCannot { .. }));
    let empty = fault(2, "stormer-verlet", &format!("frame = {{}}\n{particle}")).to_string();
    assert!(empty.contains("angular_velocity"), "{empty}");
}
