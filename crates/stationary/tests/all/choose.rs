//! `choose` on a scene.

use std::path::Path;
use std::time::Duration;

use stationary::choose::{MeasuredRuns, answer};
use stationary::program::{json, ladder_of};
use stationary::scene::choose::Question;

/// A bar between a cold and a warm end.
const BAR: &str = r#"
dimension = 1
integrator = "implicit-euler"
step = 0.005
horizon = 0.5

[heat]
name = "bar"
shape = { kind = "bar", size = [1], cells = [8] }
diffusivity = 1
held = [{ part = "left", temperature = 0 }, { part = "right", temperature = 20 }]
marks = { middle = [0.5] }
"#;

#[test]
fn the_answer_as_json_says_the_same() {
    let file = std::env::temp_dir().join(format!("stationary-bar-{}.toml", std::process::id()));
    std::fs::write(&file, BAR).unwrap();
    let ladder = ladder_of(&file, &Question::new("temperature=bar.middle")).unwrap();
    let mut runs = MeasuredRuns::new(&ladder, Duration::from_secs(600)).unwrap();
    let answer = answer(&mut runs, 1e-3).unwrap();
    std::fs::remove_file(&file).unwrap();
    let told: serde_json::Value = serde_json::from_str(&json(&answer).unwrap()).unwrap();
    let row = answer.choice().unwrap();
    assert_eq!(told["verdict"], "chosen");
    assert_eq!(told["choice"]["method"], row.method.as_str());
    assert_eq!(told["choice"]["work"], row.work);
    assert_eq!(told["reference"]["confirmed"], true);
    assert_eq!(told["cost"]["search"], answer.spent.total());
    assert!(told["mesh"]["error"].as_f64().unwrap() > 0.0);
    let rejected = told["rejected"].as_array().unwrap();
    assert_eq!(rejected.len(), answer.failed().len());
    assert!(rejected.iter().all(|run| !run["reason"].as_str().unwrap().is_empty()));
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let question = Question::new("energy");
    let missing = ladder_of(Path::new("/nowhere/a.toml"), &question).unwrap_err();
    assert!(missing.to_string().contains("/nowhere/a.toml"), "{missing}");
}
