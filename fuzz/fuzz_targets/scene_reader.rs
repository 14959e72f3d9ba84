//! Whatever the text, the scene reader answers with a scene within bounds or an error with words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stationary_scene::{Scene, limits};

fuzz_target!(|text: &str| {
    match Scene::parse("any.toml", text) {
        Ok(scene) => assert!(scene.particles().len() as u64 <= limits::PARTICLES),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
