//! Whatever the text, the readers of robots answer with a scene that can be read, or an error with words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stationary_import::{scene_of_mjcf, scene_of_urdf};
use stationary_scene::Scene;

fuzz_target!(|text: &str| {
    for read in [scene_of_urdf(text), scene_of_mjcf(text, "no-such-folder")] {
        match read {
            Ok(described) => drop(Scene::parse("robot.toml", &described.text)),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});
