//! Rods between particles.

use std::ops::Range;

use toml::Spanned;

use crate::model::items::Rod;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::Number;
use crate::words::draft::Draft;
use crate::words::particle_table::ParticleTable;
use crate::words::table::{Kind, table};
use crate::words::word::{CONSTRAINTS, Feature, Of, Word};

table! {
    /// A rod.
    pub(crate) struct RodDeclaration = "a rod" {
        /// Two names.
        between: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// The tension or thrust beyond which it breaks: between particles with rattle, beside bodies in steps of order 1.
        strength: Option<Spanned<Number>> = Kind::Positive,
    }
}

impl Word for Vec<RodDeclaration> {
    const FEATURE: Option<Feature> = Some(CONSTRAINTS);
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.between.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        for rod in self {
            let rod = declare(&draft.particles, &draft.rods, rod)?;
            draft.rods.push(rod);
        }
        Ok(())
    }
}

/// The rod that is declared.
pub(crate) fn declare(
    table: &ParticleTable,
    earlier: &[Rod],
    declared: &RodDeclaration,
) -> Checked<Rod> {
    let between = &declared.between;
    let ends = table.pair("a rod", between)?;
    let fault = |fault| Err(at(between.span(), fault));
    let name = |end: usize| table.particles[end].name.clone();
    table.check_apart(ends, between)?;
    if ends[0] == ends[1] {
        return fault(Fault::RodLoop(name(ends[0])));
    }
    if ends.iter().all(|&end| table.particles[end].motion == Motion::Pinned) {
        return fault(Fault::RodBetweenPins);
    }
    let same = |rod: &&Rod| rod.ends == ends || rod.ends == [ends[1], ends[0]];
    if earlier.iter().any(|rod| same(&rod)) {
        return fault(Fault::RepeatedRod { first: name(ends[0]), second: name(ends[1]) });
    }
    let [x, y] = ends.map(|end| table.particles[end].position);
    let length = (0..3).map(|c| (y[c] - x[c]) * (y[c] - x[c])).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return fault(Fault::RodLength(length));
    }
    let strength = declared.strength.as_ref();
    let strength = strength.map(|given| check::positive("the strength", given)).transpose()?;
    Ok(Rod { ends, length, strength: strength.unwrap_or(f64::INFINITY) })
}
