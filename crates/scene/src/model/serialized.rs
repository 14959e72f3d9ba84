//! The parts of a scene that are types of other crates, as they are serialized: by name and by number.

use serde::{Serialize, Serializer};

use crate::model::simplices::Middles;
use crate::model::stepping::Stepping;
#[cfg(feature = "contact")]
use stationary_contact::{ImpactLaw, When};
#[cfg(feature = "elasticity")]
use stationary_elasticity::{Lame, Strain};

/// Its name, and its number where it has one.
impl Serialize for Stepping {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let number = match *self {
            Stepping::LinearModes { count } => Some(count as f64),
            stepping => stepping.tolerance(),
        };
        (self.name(), number).serialize(out)
    }
}

#[cfg(feature = "elasticity")]
pub(super) fn strain<S: Serializer>(strain: &Strain, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(match strain {
        Strain::Cauchy => "cauchy",
        Strain::Green => "green",
    })
}

#[cfg(feature = "contact")]
pub(super) fn law<S: Serializer>(law: &ImpactLaw, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(law.facts().name)
}

#[cfg(feature = "contact")]
pub(super) fn when<S: Serializer>(when: &When, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(when.name())
}

#[cfg(feature = "elasticity")]
pub(super) fn lame<S: Serializer>(lame: &Lame<3>, out: S) -> Result<S::Ok, S::Error> {
    [lame.lambda(), lame.mu()].serialize(out)
}

/// Pairs in their order: the keys are no texts.
pub(super) fn middles<S: Serializer>(middles: &Middles, out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(middles)
}
