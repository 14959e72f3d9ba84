//! What a scene's file may say: the vocabulary, as data. Nothing is checked here but the words.
//!
//! Every value keeps its place in the text, so that whoever finds it impossible can point at it.

use std::fmt;
use std::ops::Range;

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use toml::Spanned;

use crate::text::diagnostic::{Located, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Count, Marks, Number};

/// A scene's file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a scene")]
pub(crate) struct Declaration {
    pub(crate) title: Option<Spanned<String>>,
    pub(crate) dimension: Spanned<Count>,
    pub(crate) integrator: Spanned<String>,
    pub(crate) tolerance: Option<Spanned<Number>>,
    pub(crate) modes: Option<Spanned<Count>>,
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
    pub(crate) contact: Option<ContactDeclaration>,
    #[serde(default)]
    pub(crate) particles: Vec<ParticleDeclaration>,
    #[serde(default)]
    pub(crate) springs: Vec<SpringDeclaration>,
    #[serde(default)]
    pub(crate) rods: Vec<RodDeclaration>,
    #[serde(default)]
    pub(crate) nets: Vec<NetDeclaration>,
    #[serde(default)]
    pub(crate) solids: Vec<SolidDeclaration>,
    pub(crate) heat: Option<HeatDeclaration>,
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

/// `[contact]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of how things touch")]
pub(crate) struct ContactDeclaration {
    pub(crate) restitution: Option<Spanned<Number>>,
    pub(crate) friction: Option<Spanned<Number>>,
    pub(crate) law: Option<Spanned<String>>,
    pub(crate) when: Option<Spanned<String>>,
    pub(crate) stiffness: Option<Spanned<Number>>,
    pub(crate) walls: Option<Vec<WallDeclaration>>,
    pub(crate) balls: Option<Vec<FixedBallDeclaration>>,
}

/// One of `walls`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a wall with `normal` and `at`")]
pub(crate) struct WallDeclaration {
    pub(crate) normal: Components,
    pub(crate) at: Components,
}

/// One of `balls`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a fixed ball with `at` and `radius`")]
pub(crate) struct FixedBallDeclaration {
    pub(crate) at: Components,
    pub(crate) radius: Spanned<Number>,
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
    pub(crate) radius: Option<Spanned<Number>>,
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

/// One of `[[solids]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an elastic body")]
pub(crate) struct SolidDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) shape: Spanned<ShapeDeclaration>,
    pub(crate) density: Spanned<Number>,
    pub(crate) section: Option<Spanned<Number>>,
    pub(crate) thickness: Option<Spanned<Number>>,
    pub(crate) element: Option<Spanned<String>>,
    pub(crate) material: Option<Spanned<String>>,
    pub(crate) young: Spanned<Number>,
    pub(crate) poisson: Option<Spanned<Number>>,
    pub(crate) bending: Option<Spanned<Number>>,
    pub(crate) velocity: Option<Components>,
    pub(crate) struck: Option<StrikeDeclaration>,
    pub(crate) pinned: Option<Vec<Spanned<String>>>,
    pub(crate) hung: Option<Vec<Spanned<String>>>,
    pub(crate) marks: Option<Marks>,
}

/// What `struck` says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with `at`, `radius` and `velocity`")]
pub(crate) struct StrikeDeclaration {
    pub(crate) at: Components,
    pub(crate) radius: Spanned<Number>,
    pub(crate) velocity: Components,
}

/// `[heat]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of heat on a shape")]
pub(crate) struct HeatDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) shape: Spanned<ShapeDeclaration>,
    pub(crate) diffusivity: Spanned<Number>,
    pub(crate) warm: Option<Vec<WarmDeclaration>>,
    pub(crate) held: Option<Vec<HeldDeclaration>>,
    pub(crate) marks: Option<Marks>,
}

/// One of `warm`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with `at`, `radius` and `temperature`")]
pub(crate) struct WarmDeclaration {
    pub(crate) at: Components,
    pub(crate) radius: Spanned<Number>,
    pub(crate) temperature: Spanned<Number>,
}

/// One of `held`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with `part` and `temperature`")]
pub(crate) struct HeldDeclaration {
    pub(crate) part: Spanned<String>,
    pub(crate) temperature: Spanned<Number>,
}

/// A `shape`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a shape")]
pub(crate) struct ShapeDeclaration {
    pub(crate) kind: Option<Spanned<String>>,
    pub(crate) size: Option<Components>,
    pub(crate) cells: Option<Spanned<Vec<Spanned<Count>>>>,
    pub(crate) file: Option<Spanned<String>>,
    pub(crate) origin: Option<Components>,
    pub(crate) across: Option<Components>,
    pub(crate) up: Option<Components>,
}

/// One of `[[bodies]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a body")]
pub(crate) struct BodyDeclaration {
    pub(crate) name: Spanned<String>,
    pub(crate) mass: Spanned<Number>,
    #[serde(rename = "box")]
    pub(crate) sides: Option<Components>,
    pub(crate) ball: Option<Spanned<Number>>,
    pub(crate) polygon: Option<Spanned<Vec<Components>>>,
    pub(crate) moments: Option<Turn>,
    pub(crate) points: Option<Vec<Components>>,
    pub(crate) position: Option<Components>,
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

impl Turn {
    /// The fault of a number where a vector belongs, or the other way round.
    pub(crate) fn wrong_kind(&self, what: &'static str, dimension: usize) -> Box<Located> {
        let place = match self {
            Turn::Number(number) => number.span(),
            Turn::Vector(components) => components.span(),
        };
        at(place, Fault::Turn { what, dimension })
    }
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

            fn visit_i128<E: Error>(self, x: i128) -> Result<NumberOrVector, E> {
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
    About(Box<ObservableTable>),
}

/// `{ position = "a" }`, `{ velocity = "a" }`, `{ distance = ["a", "b"] }` or
/// `{ tension = ["a", "b"] }`, `{ angular_velocity = "a" }` or `{ temperature = "a" }`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an observable")]
pub(crate) struct ObservableTable {
    pub(crate) position: Option<Spanned<String>>,
    pub(crate) velocity: Option<Spanned<String>>,
    pub(crate) distance: Option<Spanned<Vec<Spanned<String>>>>,
    pub(crate) tension: Option<Spanned<Vec<Spanned<String>>>>,
    pub(crate) angular_velocity: Option<Spanned<String>>,
    pub(crate) temperature: Option<Spanned<String>>,
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
                Ok(ObservableDeclaration::About(Box::new(table)))
            }
        }
        deserializer.deserialize_any(WordOrTable)
    }
}

impl BodyDeclaration {
    /// Where the text places the body.
    pub(crate) fn place(&self) -> Range<usize> {
        self.position.as_ref().map_or(self.name.span(), |position| position.span())
    }
}

impl ContactDeclaration {
    /// Where the text speaks of contact, for faults of all of it.
    pub(crate) fn place(&self) -> Option<Range<usize>> {
        let wall = self.walls.iter().flatten().next().map(|wall| wall.normal.span());
        let ball = self.balls.iter().flatten().next().map(|ball| ball.at.span());
        let word = self.law.as_ref().or(self.when.as_ref()).map(|word| word.span());
        let number = self.restitution.as_ref().or(self.friction.as_ref()).map(|n| n.span());
        number.or(word).or(wall).or(ball)
    }
}
