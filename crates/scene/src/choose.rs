//! Which model, method and step for a question about a scene? The ladder of a scene, for the search of
//! [`stationary_choose`].
//!
//! ```text
//! model x method x setting        a scene's text with some keys said otherwise
//! ```
//! ```
//! use std::time::Duration;
//! use stationary_choose::{MeasuredRuns, answer};
//! use stationary_scene::choose::{Question, scene_ladder};
//!
//! let text = r#"
//!     dimension = 2
//!     integrator = "stormer-verlet"
//!     step = 0.01
//!     horizon = 6
//!     newtonian_gravity = { constant = 1 }
//!     particles = [
//!         { name = "sun", mass = 1, position = [0, 0] },
//!         { name = "planet", mass = 1e-6, position = [1, 0], velocity = [0, 1] },
//!     ]
//! "#;
//! let ladder = scene_ladder("circle.toml", text, &Question::new("position=planet"))?;
//! let mut runs = MeasuredRuns::new(&ladder, Duration::from_secs(60))?;
//! let answer = answer(&mut runs, 1e-2)?;
//! assert!(answer.choice().is_some(), "{answer}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod candidate;
mod declaration;
mod emit;
mod error;
mod ladder;
mod look;
mod model;
mod observable;
mod rods;
mod run;
mod surrogate;

pub use candidate::Variation;
pub use declaration::{Change, changed};
pub use emit::{emit, emitted};
pub use error::ChooseError;
pub use ladder::SceneLadder;
pub use model::{Model, Simplification};
pub use observable::asked;
use stationary_choose::{MOMENTS, QuestionError};

use crate::model::scene::Scene;

/// What is asked of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// A word such as `energy`, or a word with names: `position=bob`, `distance=sun,pluto`.
    pub observable: String,
    /// Another horizon than the scene's.
    pub horizon: Option<f64>,
}

impl Question {
    /// What is asked over the scene's own horizon.
    pub fn new(observable: &str) -> Self {
        Question { observable: observable.to_owned(), horizon: None }
    }

    fn check(&self) -> Result<(), ChooseError> {
        match self.horizon {
            Some(horizon) if !(horizon > 0.0 && horizon.is_finite()) => {
                Err(QuestionError::Horizon(horizon).into())
            }
            _ => Ok(()),
        }
    }
}

/// The ladder of a scene for a question.
///
/// # Errors
/// [`ChooseError`].
pub fn scene_ladder(
    name: &str,
    text: &str,
    question: &Question,
) -> Result<SceneLadder, ChooseError> {
    question.check()?;
    Scene::parse_at(name, text)?;
    let text = observable::asked(name, text, &question.observable)?;
    let (text, scene) = match question.horizon {
        None => (text.clone(), Scene::parse_at(name, &text)?),
        Some(horizon) => {
            // A step that certainly divides the horizon; rungs bring their own.
            let changes = [
                Change::to("horizon", declaration::number(horizon)),
                Change::to("step", declaration::number(horizon / MOMENTS as f64)),
                Change::without("sample_every"),
            ];
            let text = changed(&text, &changes);
            (text.clone(), Scene::parse_at(name, &text)?)
        }
    };
    SceneLadder::of(name, &text, &scene)
}
