//! What belongs to turning: a number in the plane, a vector in space.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::text::diagnostic::{Located, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Number};

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
