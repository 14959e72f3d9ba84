//! The observable as a word on the command line, and as the scene says it.
//!
//! ```text
//! energy                "energy"
//! position=bob          { position = "bob" }
//! distance=sun,pluto    { distance = ["sun", "pluto"] }
//! ```

use stationary_scene::Scene;
use toml::Value;

use super::ChooseError;
use super::declaration::{Change, changed};

/// The scene's text, asked for this observable only.
///
/// # Errors
/// [`ChooseError::Observable`] with what the scene says to it, and [`ChooseError::NoNumbers`].
pub fn asked(name: &str, text: &str, observable: &str) -> Result<String, ChooseError> {
    let declared = declared(observable);
    let text = changed(text, &[Change::to("observables", format!("[{declared}]"))]);
    let scene = Scene::parse_at(name, &text).map_err(|error| ChooseError::Observable {
        asked: observable.to_owned(),
        reason: error.to_string(),
    })?;
    match scene.observables().first() {
        Some(observable) if !observable.headings(&scene).is_empty() => Ok(text),
        _ => Err(ChooseError::NoNumbers(observable.to_owned())),
    }
}

fn declared(observable: &str) -> String {
    let quoted = |word: &str| Value::from(word.trim()).to_string();
    let Some((word, names)) = observable.split_once('=') else { return quoted(observable) };
    // A bare key: what is not one is an unknown word, and the scene says which it knows.
    let word: String = word.trim().chars().filter(|c| c.is_alphanumeric() || *c == '_').collect();
    match names.split(',').collect::<Vec<_>>().as_slice() {
        [one] => format!("{{ {word} = {} }}", quoted(one)),
        more => {
            let names: Vec<String> = more.iter().map(|name| quoted(name)).collect();
            format!("{{ {word} = [{}] }}", names.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_become_what_a_scene_says() {
        assert_eq!(declared("energy"), "\"energy\"");
        assert_eq!(declared("position = bob"), "{ position = \"bob\" }");
        assert_eq!(declared("distance=sun,pluto"), "{ distance = [\"sun\", \"pluto\"] }");
        assert!(!declared("a\"]\nstep = [\"").contains('\n'));
    }
}
