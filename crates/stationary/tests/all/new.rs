//! A scene to begin with is one that runs, and overwrites nothing.

use std::fs;
use std::path::{Path, PathBuf};

use stationary::program::{NewSceneError, new_scene};
use stationary_scene::{Scene, shipped::SCENES};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new").join(name);
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn every_shipped_scene_can_be_begun_with_from_any_folder() {
    let folder = folder("all");
    for scene in SCENES {
        let file = folder.join(format!("{}.toml", scene.name));
        new_scene(&file, scene.name).unwrap();
        Scene::read(&file).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.starts_with("# "), "{}", scene.name);
    }
}

#[test]
fn every_file_that_ships_and_needs_no_other_is_among_them() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scene/scenes");
    for entry in fs::read_dir(scenes).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let is_scene = path.extension().is_some_and(|ending| ending == "toml");
        if is_scene && !fs::read_to_string(&path).unwrap().contains("file = ") {
            assert!(SCENES.iter().any(|scene| scene.name == name), "{name}");
        }
    }
}

#[test]
fn a_file_that_exists_is_left_as_it_is() {
    let file = folder("exists").join("mine.toml");
    fs::write(&file, "mine").unwrap();
    let refused = new_scene(&file, "heavy-top").unwrap_err();
    assert!(matches!(refused, NewSceneError::Write { .. }), "{refused}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn a_name_that_is_none_is_told_with_those_that_are() {
    let file = folder("none").join("mine.toml");
    let refused = new_scene(&file, "perpetual-motion").unwrap_err().to_string();
    assert!(refused.contains("heavy-top") && refused.contains("A spinning top"), "{refused}");
    assert!(!file.exists());
}
