//! What a word of the vocabulary is: which cargo feature it needs, where a file says it, and what it
//! adds to a scene.

use std::ops::Range;

use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::draft::Draft;

/// A table of a scene's file, or several of them.
pub(crate) trait Word {
    /// The feature without which it is not compiled.
    const FEATURE: Option<Feature> = None;

    /// What it belongs to.
    const OF: Of = Of::Anything;

    /// Where the text says it, if it does.
    fn place(&self) -> Option<Range<usize>>;

    /// A word in it that needs a feature of its own.
    fn inner(&self) -> Option<(&'static str, Feature, Range<usize>)> {
        None
    }

    /// Checks it, and adds what it says.
    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()>;
}

/// What a word belongs to: not everything goes together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    Anything,
    Particles,
    /// Elastic bodies.
    Elastic,
    /// Attraction, of particles alone.
    Attraction,
    Bodies,
    Joints,
    Load,
    Weight,
    Heat,
}

/// A cargo feature, and whether it is on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feature {
    pub(crate) name: &'static str,
    on: bool,
}

pub(crate) const CONSTRAINTS: Feature =
    Feature { name: "constraints", on: cfg!(feature = "constraints") };
pub(crate) const RIGID: Feature = Feature { name: "rigid", on: cfg!(feature = "rigid") };
pub(crate) const CONTACT: Feature = Feature { name: "contact", on: cfg!(feature = "contact") };
pub(crate) const ELASTICITY: Feature =
    Feature { name: "elasticity", on: cfg!(feature = "elasticity") };
pub(crate) const MODAL: Feature = Feature { name: "modal", on: cfg!(feature = "modal") };
pub(crate) const LAPLACIAN: Feature =
    Feature { name: "laplacian", on: cfg!(feature = "laplacian") };

impl Feature {
    /// An error where the feature of a word is not on.
    pub(crate) fn check(self, word: &'static str) -> Result<(), Fault> {
        match self.on {
            true => Ok(()),
            false => Err(Fault::NotCompiled { word, feature: self.name }),
        }
    }
}

/// An error where the feature of a word is not on that a file says.
pub(crate) fn check_feature<W: Word>(name: &'static str, word: &W) -> Checked<()> {
    let needed = W::FEATURE.zip(word.place()).map(|(feature, place)| (name, feature, place));
    for (name, feature, place) in needed.into_iter().chain(word.inner()) {
        feature.check(name).map_err(|fault| at(place, fault))?;
    }
    Ok(())
}
