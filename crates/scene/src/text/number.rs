//! Numbers as a scene's file writes them, with errors that speak of numbers and not of types.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Unexpected, Visitor};
use toml::Spanned;

/// A real number: `2`, `2.0` and `2e0` are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Number(pub(crate) f64);

/// A whole number, zero or more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Count(pub(crate) u64);

/// A vector, component by component.
pub(crate) type Components = Spanned<Vec<Spanned<Number>>>;

/// Names for places on a shape.
pub(crate) type Marks = BTreeMap<Spanned<String>, Components>;

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reals;
        impl Visitor<'_> for Reals {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E: Error>(self, x: f64) -> Result<Number, E> {
                Ok(Number(x))
            }

            fn visit_i64<E: Error>(self, x: i64) -> Result<Number, E> {
                Ok(Number(x as f64))
            }

            // What is beyond 64 bits with a sign.
            fn visit_u64<E: Error>(self, x: u64) -> Result<Number, E> {
                Ok(Number(x as f64))
            }

            fn visit_i128<E: Error>(self, x: i128) -> Result<Number, E> {
                Ok(Number(x as f64))
            }
        }
        deserializer.deserialize_f64(Reals)
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Naturals;
        impl Visitor<'_> for Naturals {
            type Value = Count;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number")
            }

            fn visit_i64<E: Error>(self, n: i64) -> Result<Count, E> {
                let negative = |_| E::invalid_value(Unexpected::Signed(n), &self);
                u64::try_from(n).map(Count).map_err(negative)
            }

            fn visit_u64<E: Error>(self, n: u64) -> Result<Count, E> {
                self.visit_i128(n.into())
            }

            fn visit_i128<E: Error>(self, n: i128) -> Result<Count, E> {
                let most = i64::MAX;
                Err(E::custom(format_args!("expected a whole number up to {most}, got {n}")))
            }
        }
        deserializer.deserialize_u64(Naturals)
    }
}
