//! The key `strength`: a number, or a table that says how strong something is in time.

use std::fmt;
use std::path::Path;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::model::strength::{Pieces, Strength};
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::DriveFault;
use crate::text::number::Number;
use crate::text::{check, csv_table};
use crate::words::table::{Kind, table};

table! {
    /// How strong something is in time: one of `step`, `ramp`, `sine` and `table`.
    pub(crate) struct StrengthTable = "a strength in time" {
        /// The values before and after the time `at`.
        step: Option<Spanned<Vec<Spanned<Number>>>> = Kind::List(&Kind::Number),
        /// When it steps; 0 where it is missing.
        at: Option<Spanned<Number>> = Kind::Number,
        /// The values before the time `from` and after the time `to`, with a straight line between.
        ramp: Option<Spanned<Vec<Spanned<Number>>>> = Kind::List(&Kind::Number),
        /// When the ramp begins; 0 where it is missing.
        from: Option<Spanned<Number>> = Kind::Number,
        /// When the ramp ends.
        to: Option<Spanned<Number>> = Kind::Number,
        /// The amplitude of a sine.
        sine: Option<Spanned<Number>> = Kind::Number,
        /// Swings in a unit of time.
        frequency: Option<Spanned<Number>> = Kind::Positive,
        /// The angle of the sine at the start, in radians; 0 where it is missing.
        phase: Option<Spanned<Number>> = Kind::Number,
        /// The mean of the sine; 0 where it is missing.
        offset: Option<Spanned<Number>> = Kind::Number,
        /// A CSV file beside the scene's, with times in its first column and values in its second.
        table: Option<Spanned<String>> = Kind::Text,
    }
}

/// A strength: a number, or one that changes.
#[derive(Clone, Debug)]
pub(crate) enum StrengthDeclaration {
    Constant(Number),
    InTime(Box<StrengthTable>),
}

impl<'de> Deserialize<'de> for StrengthDeclaration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrTable;
        impl<'de> Visitor<'de> for NumberOrTable {
            type Value = StrengthDeclaration;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a table such as { ramp = [0, 1], to = 2 }")
            }

            fn visit_f64<E: Error>(self, x: f64) -> Result<StrengthDeclaration, E> {
                Ok(StrengthDeclaration::Constant(Number(x)))
            }

            fn visit_i64<E: Error>(self, x: i64) -> Result<StrengthDeclaration, E> {
                Ok(StrengthDeclaration::Constant(Number(x as f64)))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<StrengthDeclaration, A::Error> {
                let table = StrengthTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(StrengthDeclaration::InTime(Box::new(table)))
            }
        }
        deserializer.deserialize_any(NumberOrTable)
    }
}

/// The strength that is declared; 1 where none is.
pub(crate) fn declare(
    folder: Option<&Path>,
    declared: Option<&Spanned<StrengthDeclaration>>,
) -> Checked<Strength> {
    let Some(declared) = declared else { return Ok(Strength::constant(1.0)) };
    let place = declared.span();
    let table = match declared.get_ref() {
        StrengthDeclaration::Constant(number) => {
            let value = check::finite("the strength", &Spanned::new(place, *number))?;
            return Ok(Strength::constant(value));
        }
        StrengthDeclaration::InTime(table) => table,
    };
    table.check_keys(declared)?;
    let finite = |what, number: &Option<Spanned<Number>>| match number {
        Some(number) => check::finite(what, number),
        None => Ok(0.0),
    };
    if let Some(file) = &table.table {
        return Ok(Strength::Pieces(Pieces::new(csv_table::read(folder, file)?)));
    }
    if let Some(values) = &table.step {
        let [before, after] = two("`step`", values)?;
        let at = finite("the time of the step", &table.at)?;
        return Ok(Strength::Pieces(Pieces::new(vec![[at, before], [at, after]])));
    }
    if let Some(values) = &table.ramp {
        let [before, after] = two("`ramp`", values)?;
        let from = finite("the start of the ramp", &table.from)?;
        let Some(end) = &table.to else {
            return Err(at(place, DriveFault::StrengthKey("ramp", "to")));
        };
        let to = check::finite("the end of the ramp", end)?;
        if to <= from {
            return Err(at(end.span(), DriveFault::Backwards { from, to }));
        }
        return Ok(Strength::Pieces(Pieces::new(vec![[from, before], [to, after]])));
    }
    let Some(frequency) = &table.frequency else {
        return Err(at(place, DriveFault::StrengthKey("sine", "frequency")));
    };
    Ok(Strength::Sine {
        amplitude: finite("the amplitude", &table.sine)?,
        frequency: check::positive("the frequency", frequency)?,
        phase: finite("the phase", &table.phase)?,
        offset: finite("the offset", &table.offset)?,
    })
}

/// Two values.
fn two(key: &'static str, values: &Spanned<Vec<Spanned<Number>>>) -> Checked<[f64; 2]> {
    match values.get_ref().as_slice() {
        [a, b] => Ok([check::finite("the strength", a)?, check::finite("the strength", b)?]),
        others => Err(at(values.span(), DriveFault::TwoValues { key, got: others.len() })),
    }
}

impl StrengthTable {
    /// An error unless it has one of the four, and only the keys of that one.
    fn check_keys(&self, declared: &Spanned<StrengthDeclaration>) -> Checked<()> {
        let place = |number: &Option<Spanned<Number>>| number.as_ref().map(Spanned::span);
        let kinds = [
            ("step", self.step.is_some()),
            ("ramp", self.ramp.is_some()),
            ("sine", self.sine.is_some()),
            ("table", self.table.is_some()),
        ];
        let mut said = kinds.into_iter().filter(|(_, said)| *said).map(|(kind, _)| kind);
        let (Some(kind), None) = (said.next(), said.next()) else {
            return Err(at(declared.span(), DriveFault::NotOneStrength));
        };
        let keys = [
            ("step", "at", place(&self.at)),
            ("ramp", "from", place(&self.from)),
            ("ramp", "to", place(&self.to)),
            ("sine", "frequency", place(&self.frequency)),
            ("sine", "phase", place(&self.phase)),
            ("sine", "offset", place(&self.offset)),
        ];
        for (of, key, place) in keys {
            if let (true, Some(place)) = (of != kind, place) {
                return Err(at(place, DriveFault::KeyOfAnother { key, of, kind }));
            }
        }
        Ok(())
    }
}
