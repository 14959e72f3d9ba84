//! The observable as a word on the command line, and as the scene says it.
//!
//! ```text
//! energy                "energy"
//! position=bob          { position = "bob" }
//! distance=sun,pluto    { distance = ["sun", "pluto"] }
//! ```

use stationary_choose::Scale;
use toml::Value;

use super::ChooseError;
use super::declaration::{Change, changed, without_claims};
use crate::model::observable::Observable;
use crate::model::scene::Scene;

/// The scene's text, asked for this observable only: what it claims of others is left out.
///
/// # Errors
/// [`ChooseError::Observable`] with what the scene says to it, and [`ChooseError::NoNumbers`].
pub fn asked(name: &str, text: &str, observable: &str) -> Result<String, ChooseError> {
    let declared = declared(observable);
    let text = without_claims(text);
    let text = changed(&text, &[Change::to("observables", format!("[{declared}]"))]);
    let scene = Scene::parse_at(name, &text).map_err(|error| ChooseError::Observable {
        asked: observable.to_owned(),
        reason: error.to_string(),
    })?;
    match scene.observables().first() {
        Some(observable) if !observable.headings(&scene).is_empty() => Ok(text),
        _ => Err(ChooseError::NoNumbers(observable.to_owned())),
    }
}

/// What the scene's first observable is called.
pub fn in_words(scene: &Scene) -> String {
    let observable = scene.observables().first().copied().unwrap_or(Observable::Energy);
    observable.headings(scene).join(", ")
}

/// What its errors are relative to: for energies the largest kinetic energy, for momenta the sum of the
/// parts' magnitudes, for a place the way from its start, else the largest value.
pub fn scale(scene: &Scene) -> Scale {
    match scene.observables().first() {
        None
        | Some(Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy) => {
            Scale::Kinetic
        }
        Some(Observable::LinearMomentum) => Scale::Told("the sum of |p|"),
        Some(Observable::AngularMomentum) => Scale::Told("the sum of |q| |p|"),
        Some(Observable::Position(_)) => Scale::Way,
        _ => Scale::Largest,
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

/// The particles that the first observable is about.
pub(super) fn observed(scene: &Scene) -> Vec<usize> {
    match scene.observables().first() {
        Some(
            Observable::Position(particle)
            | Observable::Velocity(particle)
            | Observable::Temperature(particle),
        ) => vec![*particle],
        Some(Observable::Distance(pair)) => pair.to_vec(),
        _ => Vec::new(),
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
