//! The word `units`.

use crate::model::units::Units;
use crate::text::check;
use crate::text::diagnostic::Checked;
use crate::words::declaration::UnitsDeclaration;

/// The words that are declared, those of the SI where none are.
pub(crate) fn declare(declared: &UnitsDeclaration) -> Checked<Units> {
    Ok(Units {
        length: check::title("a unit", declared.length.as_ref(), "m")?,
        time: check::title("a unit", declared.time.as_ref(), "s")?,
        mass: check::title("a unit", declared.mass.as_ref(), "kg")?,
    })
}
