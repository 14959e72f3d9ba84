//! The cargo feature that a word of a scene needs, and what a file hears that says the word without.

use std::ops::Range;

use crate::model::stepping::Stepping;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::Declaration;

/// A cargo feature, and whether it is on.
#[derive(Clone, Copy)]
struct Feature {
    name: &'static str,
    on: bool,
}

const CONSTRAINTS: Feature = Feature { name: "constraints", on: cfg!(feature = "constraints") };
const RIGID: Feature = Feature { name: "rigid", on: cfg!(feature = "rigid") };
const CONTACT: Feature = Feature { name: "contact", on: cfg!(feature = "contact") };
const ELASTICITY: Feature = Feature { name: "elasticity", on: cfg!(feature = "elasticity") };
const MODAL: Feature = Feature { name: "modal", on: cfg!(feature = "modal") };
const LAPLACIAN: Feature = Feature { name: "laplacian", on: cfg!(feature = "laplacian") };

/// A word, what it needs, and where a file says it.
type Word = (&'static str, Feature, fn(&Declaration) -> Option<Range<usize>>);

const WORDS: [Word; 9] = [
    ("springs", ELASTICITY, |said| said.springs.first().map(|spring| spring.between.span())),
    ("nets", ELASTICITY, |said| said.nets.first().map(|net| net.name.span())),
    ("solids", ELASTICITY, |said| said.solids.first().map(|solid| solid.name.span())),
    ("hung", MODAL, |said| {
        let hung = said.solids.iter().flat_map(|solid| solid.hung.iter().flatten());
        hung.map(|part| part.span()).next()
    }),
    ("rods", CONSTRAINTS, |said| said.rods.first().map(|rod| rod.between.span())),
    ("bodies", RIGID, |said| said.bodies.first().map(|body| body.name.span())),
    ("joints", CONSTRAINTS, |said| said.joints.first().map(|joint| joint.kind.span())),
    ("contact", CONTACT, |said| {
        said.contact.as_ref().map(|contact| contact.place().unwrap_or(said.step.span()))
    }),
    ("heat", LAPLACIAN, |said| said.heat.as_ref().map(|heat| heat.name.span())),
];

/// An error at the first word whose feature is not on.
pub(crate) fn check(declared: &Declaration) -> Checked<()> {
    for (word, feature, place) in WORDS {
        if let (Err(fault), Some(place)) = (feature.check(word), place(declared)) {
            return Err(at(place, fault));
        }
    }
    Ok(())
}

/// An error where the feature of a method is not on.
pub(crate) fn check_stepping(stepping: Stepping) -> Result<(), Fault> {
    match stepping {
        Stepping::Constrained(_) => CONSTRAINTS.check(stepping.name()),
        Stepping::LinearModes { .. } => MODAL.check(stepping.name()),
        // Whoever has one of the others has its crate.
        _ => Ok(()),
    }
}

impl Feature {
    fn check(self, word: &'static str) -> Result<(), Fault> {
        match self.on {
            true => Ok(()),
            false => Err(Fault::NotCompiled { word, feature: self.name }),
        }
    }
}
