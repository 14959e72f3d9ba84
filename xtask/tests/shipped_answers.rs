//! What is chosen on shipped scenes: method and setting, and what is said beside them.

use std::fs;
use std::path::Path;
use std::time::Duration;

use stationary_choose::{MeasuredRuns, Verdict, answer};
use stationary_scene::choose::{Question, scene_ladder};

/// A scene, what is asked of it, and the horizon.
const ASKED: [(&str, &str, f64); 7] = [
    ("outer-solar-system", "position=jupiter", 20_000.0),
    ("pendulum-chain", "position=j10", 0.3),
    ("thrown-racket", "angular_velocity=racket", 2.0),
    ("heavy-top", "position=top.1", 1.0),
    ("newtons-cradle", "position=ball5", 1.5),
    ("block-on-incline", "position=block", 1.5),
    ("warm-sphere", "temperature=sphere.pole", 0.2),
];

#[test]
fn the_answers_on_shipped_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let mut said = String::new();
    for (scene, observable, horizon) in ASKED {
        let text = fs::read_to_string(folder.join(format!("{scene}.toml"))).unwrap();
        for tolerance in [1e-1, 1e-3] {
            let question = Question { observable: observable.to_owned(), horizon: Some(horizon) };
            let ladder = scene_ladder("shipped.toml", &text, &question).unwrap();
            let runs = MeasuredRuns::new(&ladder, Duration::from_secs(24 * 3600)).unwrap();
            let mut runs = runs.bounded(50_000_000);
            let answer = answer(&mut runs, tolerance).unwrap();
            let choice = answer.choice().map(|row| format!("{}, {}", row.method, row.setting));
            let choice = choice.unwrap_or_else(|| format!("{:?}", answer.verdict));
            let word = if matches!(answer.verdict, Verdict::Unconfirmed(_)) {
                ", not confirmed"
            } else {
                ""
            };
            let mesh = if answer.mesh.is_some() { ", and the mesh's error" } else { "" };
            said += &format!("{scene} at {tolerance:e}: {choice}{word}{mesh}\n");
        }
    }
    insta::assert_snapshot!(said);
}
