//! What belongs to turning: a number in the plane, a vector in space.

use std::fmt;
use std::ops::Range;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::text::check;
use crate::text::diagnostic::{Checked, Located, at};
use crate::text::fault::BodyFault;
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
        at(self.span(), BodyFault::Turn { what, dimension })
    }

    /// Where the text says it.
    pub(crate) fn span(&self) -> Range<usize> {
        match self {
            Turn::Number(number) => number.span(),
            Turn::Vector(components) => components.span(),
        }
    }

    /// A rotation, a rate of turn or a torque: about the third axis in the plane.
    pub(crate) fn components(&self, what: &'static str, dimension: usize) -> Checked<[f64; 3]> {
        match (dimension, self) {
            (2, Turn::Number(number)) => Ok([0.0, 0.0, check::finite(what, number)?]),
            (3, Turn::Vector(components)) => check::vector(what, 3, components),
            _ => Err(self.wrong_kind(what, dimension)),
        }
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
