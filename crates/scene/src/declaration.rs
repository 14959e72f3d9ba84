//! What a scene's file may say: the vocabulary, as data. Nothing is checked here but the words.
//!
//! Every value keeps its place in the text, so that whoever finds it impossible can point at it.

use std::fmt;

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use toml::Spanned;

use crate::number::{Count, Number};

/// A vector, component by component.
pub(crate) type Components = Spanned<Vec<Spanned<Number>>>;

/// A scene's file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a scene")]
pub(crate) struct Declaration {
    pub(crate) title: Option<Spanned<String>>,
    pub(crate) dimension: Spanned<Count>,
    pub(crate) integrator: Spanned<String>,
    pub(crate) tolerance: Option<Spanned<Number>>,
    pub(crate) step: Spanned<Number>,
    pub(crate) horizon: Spanned<Number>,
    pub(crate) sample_every: Option<Spanned<Count>>,
    pub(crate) observables: Option<Vec<Spanned<ObservableDeclaration>>>,
    pub(crate) view: Option<Components>,
    #[serde(default)]
    pub(crate) units: UnitsDeclaration,
    pub(crate) uniform_gravity: Option<UniformGravityDeclaration>,
    pub(crate) newtonian_gravity: Option<NewtonianGravityDeclaration>,
    pub(crate) drag: Option<DragDeclaration>,
    #[serde(default)]
    pub(crate) particles: Vec<ParticleDeclaration>,
    #[serde(default)]
    pub(crate) springs: Vec<SpringDeclaration>,
    #[serde(default)]
    pub(crate) rods: Vec<RodDeclaration>,
    #[serde(default)]
    pub(crate) nets: Vec<NetDeclaration>,
    #[serde(default)]
    pub(crate) bodies: Vec<BodyDeclaration>,
    #[serde(default)]
    pub(crate) joints: Vec<JointDeclaration>,
}

/// `[units]`: words for headings, which change no number.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of units")]
pub(crate) struct UnitsDeclaration {
    pub(crate) length: Option<Spanned<String>>,
    pub(crate) time: Option<Spanned<String>>,
    pub(crate) mass: Option<Spanned<String>>,
}

/// `[uniform_gravity]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with an acceleration")]
pub(crate) struct UniformGravityDeclaration {
    pub(crate) acceleration: Components,
}

/// `[newtonian_gravity]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with a constant")]
pub(crate) struct NewtonianGravityDeclaration {
    pub(crate) constant: Spanned<Number>,
}

/// `[drag]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with a coefficient")]
pub(crate) struct DragDeclaration {
    pub(crate) coefficient: Spanned<Number>,
}

/// One of `[[particles]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a particle")]
pub(crate) struct ParticleDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) mass: Option<Spanned<Number>>,
    pub(crate) position: Components,
    pub(crate) velocity: Option<Components>,
    pub(crate) momentum: Option<Components>,
    pub(crate) pinned: Option<Spanned<bool>>,
}

/// One of `[[springs]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a spring")]
pub(crate) struct SpringDeclaration {
    pub(crate) between: Spanned<Vec<Spanned<String>>>,
    pub(crate) stiffness: Spanned<Number>,
    pub(crate) rest_length: Option<Spanned<Number>>,
    pub(crate) strain: Option<Spanned<String>>,
}

/// One of `[[rods]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a rod")]
pub(crate) struct RodDeclaration {
    pub(crate) between: Spanned<Vec<Spanned<String>>>,
    pub(crate) strength: Option<Spanned<Number>>,
}

/// One of `[[nets]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a net")]
pub(crate) struct NetDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) rows: Spanned<Count>,
    pub(crate) columns: Spanned<Count>,
    pub(crate) spacing: Spanned<Number>,
    pub(crate) origin: Components,
    pub(crate) across: Option<Components>,
    pub(crate) down: Option<Components>,
    pub(crate) particle_mass: Spanned<Number>,
    pub(crate) stiffness: Spanned<Number>,
    pub(crate) strain: Option<Spanned<String>>,
    pub(crate) pinned: Option<Spanned<Vec<Spanned<String>>>>,
}

/// One of `[[bodies]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a body")]
pub(crate) struct BodyDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) mass: Spanned<Number>,
    #[serde(rename = "box")]
    pub(crate) sides: Option<Components>,
    pub(crate) moments: Option<Turn>,
    pub(crate) points: Option<Vec<Components>>,
    pub(crate) position: Components,
    pub(crate) rotation: Option<Turn>,
    pub(crate) velocity: Option<Components>,
    pub(crate) angular_velocity: Option<Turn>,
}

/// One of `[[joints]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a joint")]
pub(crate) struct JointDeclaration {
    pub(crate) kind: Spanned<String>,
    pub(crate) between: Spanned<Vec<Spanned<String>>>,
    pub(crate) at: Components,
    pub(crate) axis: Option<Components>,
}

/// What belongs to turning: a number in the plane, a vector in space.
#[derive(Clone, Debug)]
pub(crate) enum Turn {
    Number(Spanned<Number>),
    Vector(Components),
}

impl<'de> Deserialize<'de> for Turn {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let either = Spanned::<NumberOrVector>::deserialize(deserializer)?;
        let span = either.span();
        Ok(match either.into_inner() {
            NumberOrVector::Number(number) => Turn::Number(Spanned::new(span, number)),
            NumberOrVector::Vector(components) => Turn::Vector(Spanned::new(span, components)),
        })
    }
}

enum NumberOrVector {
    Number(Number),
    Vector(Vec<Spanned<Number>>),
}

impl<'de> Deserialize<'de> for NumberOrVector {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = NumberOrVector;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number in the plane, a vector in space")
            }

            fn visit_f64<E: Error>(self, x: f64) -> Result<NumberOrVector, E> {
                Ok(NumberOrVector::Number(Number(x)))
            }

            fn visit_i64<E: Error>(self, x: i64) -> Result<NumberOrVector, E> {
                Ok(NumberOrVector::Number(Number(x as f64)))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<NumberOrVector, A::Error> {
                let components = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
                Ok(NumberOrVector::Vector(components))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// One of `observables`: a word alone, or a word with the particles that it is about.
#[derive(Clone, Debug)]
pub(crate) enum ObservableDeclaration {
    Word(String),
    About(ObservableTable),
}

/// `{ position = "a" }`, `{ velocity = "a" }`, `{ distance = ["a", "b"] }` or
/// `{ tension = ["a", "b"] }` or `{ angular_velocity = "a" }`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an observable")]
pub(crate) struct ObservableTable {
    pub(crate) position: Option<Spanned<String>>,
    pub(crate) velocity: Option<Spanned<String>>,
    pub(crate) distance: Option<Spanned<Vec<Spanned<String>>>>,
    pub(crate) tension: Option<Spanned<Vec<Spanned<String>>>>,
    pub(crate) angular_velocity: Option<Spanned<String>>,
}

impl<'de> Deserialize<'de> for ObservableDeclaration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WordOrTable;
        impl<'de> Visitor<'de> for WordOrTable {
            type Value = ObservableDeclaration;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an observable such as \"energy\" or { position = \"a name\" }")
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<ObservableDeclaration, E> {
                Ok(ObservableDeclaration::Word(word.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(
                self,
                map: A,
            ) -> Result<ObservableDeclaration, A::Error> {
                let table = ObservableTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(ObservableDeclaration::About(table))
            }
        }
        deserializer.deserialize_any(WordOrTable)
    }
}
