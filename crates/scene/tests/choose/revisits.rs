//! A run that was made once is looked at again without its steps: what is seen is the same.

use std::time::Instant;

use stationary_choose::{At, Experiment, Kind, Look, MOMENTS, MeasuredRuns, Moments, own_parts};

use stationary_scene::choose::{Question, SceneLadder};

use super::LONG;

const SPRINGS: &str = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.01
horizon = 2
uniform_gravity = { acceleration = [0, -9.81] }
particles = [
    { name = "hook", position = [0, 0], pinned = true },
    { name = "bob", position = [1, 0.2], mass = 1, velocity = [0, 1] },
]
springs = [{ between = ["hook", "bob"], stiffness = 50, rest_length = 1, damping = 0.2 }]
"#;

const ROD: &str = r#"
dimension = 2
integrator = "rattle"
step = 0.01
horizon = 2
uniform_gravity = { acceleration = [0, -9.81] }
particles = [
    { name = "hook", position = [0, 0], pinned = true },
    { name = "bob", position = [1, 0], mass = 1 },
]
rods = [{ between = ["hook", "bob"] }]
"#;

const BLOCK: &str = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.01
horizon = 1
uniform_gravity = { acceleration = [0, -9.81] }
contact = { restitution = 0.5, friction = 0.4, walls = [{ normal = [0, 1], at = [0, 0] }] }
bodies = [{ name = "block", mass = 2, box = [0.2, 0.1], position = [0, 0.4], velocity = [2, 0], angular_velocity = 3 }]
"#;

const HOT: &str = r#"
dimension = 3
integrator = "crank-nicolson"
step = 0.01
horizon = 0.5
[heat]
name = "sphere"
shape = { kind = "sphere", size = [1], cells = [2] }
diffusivity = 0.5
warm = [{ at = [0, 0, 1], radius = 0.7, temperature = 1 }]
marks = { pole = [0, 0, 1] }
"#;

/// Every part of a step that the chooser looks into, and every end.
fn moments(parts: u64, horizon: f64) -> Moments {
    let (thetas, h) = ([0.236, 0.414, 0.732, 1.0], horizon / parts as f64);
    let times = (0..parts).flat_map(|k| thetas.map(|theta| (k as f64 + theta) * h)).collect();
    Moments { times, parts: Some(parts), every: 1, within: 3 }
}

fn ladder(text: &str, observable: &str) -> &'static SceneLadder {
    super::ladder(text, &Question::new(observable))
}

fn later() -> Instant {
    Instant::now() + LONG
}

fn assert_same(name: &str, one: &Look, other: &Look) {
    assert_eq!(one.values, other.values, "{name}");
    assert_eq!(one.energies, other.energies, "{name}");
    assert_eq!(one.places, other.places, "{name}");
    assert_eq!((one.kinetic, one.told, &one.is_own), (other.kinetic, other.told, &other.is_own));
}

#[test]
fn equal_steps_are_looked_into_again_to_the_same_bits_for_the_work_of_their_parts_alone() {
    for (text, observable) in [
        (SPRINGS, "position=bob"),
        (SPRINGS, "angular-momentum"),
        (ROD, "tension=hook,bob"),
        (ROD, "position=bob"),
        (BLOCK, "position=block"),
    ] {
        let (fresh, known) = (ladder(text, observable), ladder(text, observable));
        let mut runs = MeasuredRuns::new(known, LONG).unwrap();
        let families = known.ladder().families.iter().enumerate();
        let mut looked = 0;
        for (family, of) in families.filter(|(_, of)| of.kind == Kind::EqualSteps) {
            let at = At { family, rung: 2 };
            let whole = runs.measure(at).clone();
            if whole.whole().is_none() {
                continue;
            }
            let moments = moments(MOMENTS << at.rung, known.ladder().horizon);
            let looks = [known, fresh].map(|ladder| ladder.look(at, &moments, later()));
            let [Some(again), Some(anew)] = looks else {
                panic!("{observable}: {}: {looks:?}", of.name);
            };
            assert_same(&format!("{observable}: {}", of.name), &again, &anew);
            // Three parts of every step, without the steps.
            assert_eq!(again.work, 3 * whole.work, "{}", of.name);
            assert!(anew.work >= 4 * whole.work, "{}: {} {}", of.name, anew.work, whole.work);
            looked += 1;
        }
        assert!(looked > 0, "{observable}");
    }
}

#[test]
fn what_an_adaptive_method_did_within_its_own_steps_is_kept_from_its_one_run() {
    let (fresh, known) = (ladder(SPRINGS, "position=bob"), ladder(SPRINGS, "position=bob"));
    let mut runs = MeasuredRuns::new(known, LONG).unwrap();
    let families = known.ladder().families.iter().enumerate();
    let mut looked = 0;
    for (family, of) in families.filter(|(_, of)| of.kind == Kind::Adaptive) {
        let at = At { family, rung: 2 };
        let run = runs.measure(at).clone();
        let kept = run.own.expect("a short run keeps its own steps");
        let (mut times, mut from) = (Vec::new(), 0.0);
        for &to in run.accepted.iter() {
            times.extend(own_parts().map(|part| from + part * (to - from)));
            times.push(to);
            from = to;
        }
        let moments = Moments { times, parts: None, every: 1, within: own_parts().len() };
        let anew = fresh.look(at, &moments, later()).unwrap();
        assert_eq!(kept.values.len(), anew.values.len());
        let pairs = kept.values.iter().flatten().zip(anew.values.iter().flatten());
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12, "{}: {apart:e}", of.name);
        looked += 1;
    }
    assert_eq!(looked, 4);
}

#[test]
fn lines_between_kept_ends_cost_nothing() {
    let (fresh, known) =
        (ladder(HOT, "temperature=sphere.pole"), ladder(HOT, "temperature=sphere.pole"));
    let mut runs = MeasuredRuns::new(known, LONG).unwrap();
    let family = known.ladder().families.iter().position(|of| of.name == "crank-nicolson").unwrap();
    let at = At { family, rung: 2 };
    assert!(runs.measure(at).whole().is_some());
    let moments = moments(MOMENTS << at.rung, known.ladder().horizon);
    let again = known.look(at, &moments, later()).unwrap();
    assert_same("heat", &again, &fresh.look(at, &moments, later()).unwrap());
    assert_eq!(again.work, 0);
}
