//! A table of bad scenes, of the words for shapes, parts, limits, friction, frames, motors, strengths in time,
//! parameters and methods: what is said of each, with its line and column, as a snapshot to be read.
//!
//! In `bad_scenes.txt` a case begins with `# ` and its title; below stands the head that it has, and what it says.
//! `PIN` and `HINGE` stand for a body on such a joint, which says what follows.

use std::collections::BTreeSet;
use std::fmt::Write;

use stationary_scene::{Scene, SceneError};

const CASES: &str = include_str!("bad_scenes.txt");

fn head(word: &str) -> String {
    let (dimension, method) = match word {
        "space" => (3, "variational-rotation"),
        "space-particles" => (3, "stormer-verlet"),
        "event-driven" => (2, "event-driven-2"),
        "dormand-prince-54" => (2, "dormand-prince-54"),
        "plane" => (2, "stormer-verlet"),
        other => panic!("{other}"),
    };
    format!("dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.1\nhorizon = 1\n")
}

fn line(said: &str) -> String {
    let on = |kind: &str, place: &str, axis: &str, rest: &str| {
        format!(
            "bodies = [{{ name = \"a\", mass = 1, ball = 1, position = {place} }}]\n\
             joints = [{{ kind = \"{kind}\", between = [\"a\", \"world\"], at = {place}, {axis}{rest} }}]\n"
        )
    };
    if let Some(rest) = said.strip_prefix("PIN ") {
        on("pin", "[0, 0]", "", rest)
    } else if let Some(rest) = said.strip_prefix("HINGE ") {
        on("hinge", "[0, 0, 0]", "axis = [0, 0, 1], ", rest)
    } else {
        format!("{said}\n")
    }
}

#[test]
fn every_bad_scene_is_refused_at_a_place_with_words_of_its_own() {
    let (mut page, mut titles, mut said) = (String::new(), BTreeSet::new(), BTreeSet::new());
    for case in CASES.split("# ").skip(1) {
        let mut lines = case.lines();
        let [title, word] = [lines.next(), lines.next()].map(Option::unwrap);
        let text = head(word) + &lines.map(line).collect::<String>();
        let Err(SceneError::Invalid(error)) = Scene::parse("scene.toml", &text) else {
            panic!("{title}: the scene is taken\n{text}")
        };
        let place = error.place.as_ref().unwrap_or_else(|| panic!("{title}: {error}"));
        let message = error.fault.to_string();
        writeln!(page, "{title}\n    {}:{}: {message}", place.line, place.column).unwrap();
        assert!(titles.insert(title), "{title}");
        said.insert(message);
    }
    assert!(titles.len() >= 60 && said.len() >= 60, "{} {}", titles.len(), said.len());
    insta::assert_snapshot!(page);
}
