//! Rods between particles.

use crate::model::items::Rod;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::RodDeclaration;
use crate::words::particles::Roster;

/// The rod that is declared.
pub(crate) fn declare(roster: &Roster, earlier: &[Rod], declared: &RodDeclaration) -> Checked<Rod> {
    let between = &declared.between;
    let ends = roster.pair("a rod", between)?;
    let fault = |fault| Err(at(between.span(), fault));
    let name = |end: usize| roster.particles[end].name.clone();
    if ends[0] == ends[1] {
        return fault(Fault::RodLoop(name(ends[0])));
    }
    if ends.iter().all(|&end| roster.particles[end].motion == Motion::Pinned) {
        return fault(Fault::RodBetweenPins);
    }
    let same = |rod: &&Rod| rod.ends == ends || rod.ends == [ends[1], ends[0]];
    if earlier.iter().any(|rod| same(&rod)) {
        return fault(Fault::RepeatedRod { first: name(ends[0]), second: name(ends[1]) });
    }
    let [x, y] = ends.map(|end| roster.particles[end].position);
    let length = (0..3).map(|c| (y[c] - x[c]) * (y[c] - x[c])).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return fault(Fault::RodLength(length));
    }
    let strength = declared.strength.as_ref();
    let strength = strength.map(|given| check::positive("the strength", given)).transpose()?;
    Ok(Rod { ends, length, strength: strength.unwrap_or(f64::INFINITY) })
}
