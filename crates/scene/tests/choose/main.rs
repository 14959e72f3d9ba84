//! The chooser on scenes.

mod models;
mod revisits;
mod searches;
mod truth;

use std::time::Duration;

use stationary_choose::{Answer, MeasuredRuns, answer};
use stationary_scene::choose::{Question, SceneLadder, scene_ladder};

/// Time that is never over.
const LONG: Duration = Duration::from_secs(600);

/// The ladder of a scene, which lives as long as its test.
fn ladder(text: &str, question: &Question) -> &'static SceneLadder {
    Box::leak(Box::new(scene_ladder("a.toml", text, question).unwrap()))
}

fn bounded_runs(text: &str, observable: &str) -> MeasuredRuns<'static> {
    MeasuredRuns::new(ladder(text, &Question::new(observable)), LONG).unwrap()
}

fn asked(text: &str, observable: &str, tolerance: f64) -> (Answer, MeasuredRuns<'static>) {
    let mut runs = bounded_runs(text, observable).bounded(20_000_000);
    (answer(&mut runs, tolerance).unwrap(), runs)
}
