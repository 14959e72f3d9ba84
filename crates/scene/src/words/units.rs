//! The word `units`.

use toml::Spanned;

use crate::model::units::Units;
use crate::text::check;
use crate::text::diagnostic::Checked;
use crate::words::table::{Kind, Presence, table};

table! {
    /// Words for headings; they change no number. Without them m, s and kg.
    pub(crate) struct UnitsDeclaration [Default] = "a table of units" {
        /// The unit of length.
        length: Option<Spanned<String>> = Kind::Text,
        /// The unit of time.
        time: Option<Spanned<String>> = Kind::Text,
        /// The unit of mass.
        mass: Option<Spanned<String>> = Kind::Text,
    }
}

/// The words that are declared, those of the SI where none are.
pub(crate) fn declare(declared: &UnitsDeclaration) -> Checked<Units> {
    Ok(Units {
        length: check::title("a unit", declared.length.as_ref(), "m")?,
        time: check::title("a unit", declared.time.as_ref(), "s")?,
        mass: check::title("a unit", declared.mass.as_ref(), "kg")?,
    })
}

/// Each unit has its usual word.
impl Presence for UnitsDeclaration {
    const REQUIRED: bool = false;
}
