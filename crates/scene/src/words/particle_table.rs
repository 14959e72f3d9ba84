//! The particles of a scene, found by name, while its words are declared.

use std::collections::HashMap;
use std::ops::Range;

use toml::Spanned;

use crate::model::particle::{Motion, Particle};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;

/// The particles of a scene in order, found by name, and the place of each in the text.
#[derive(Debug, Default)]
pub(crate) struct ParticleTable {
    pub(crate) particles: Vec<Particle>,
    /// Where the text places each particle: its position, or the net's origin.
    pub(crate) places: Vec<Range<usize>>,
    /// The first pinned particle and where the text pins it.
    pub(crate) first_pin: Option<(usize, Range<usize>)>,
    /// Pinned particles that are given a mass, and that mass.
    pub(crate) pinned_masses: Vec<(usize, f64)>,
    by_name: HashMap<String, usize>,
}

impl ParticleTable {
    /// Adds a particle unless one of its name is there.
    pub(crate) fn add(&mut self, particle: Particle, place: Range<usize>) -> Option<usize> {
        let index = self.particles.len();
        if self.by_name.contains_key(&particle.name) {
            return None;
        }
        self.by_name.insert(particle.name.clone(), index);
        self.particles.push(particle);
        self.places.push(place);
        Some(index)
    }

    /// Gives a particle another name unless one of that name is there; its old name still finds it.
    pub(crate) fn rename(&mut self, index: usize, name: String) -> Option<()> {
        if self.by_name.contains_key(&name) {
            return None;
        }
        self.particles[index].name.clone_from(&name);
        self.by_name.insert(name, index);
        Some(())
    }

    /// The particle of this name.
    pub(crate) fn find(&self, name: &Spanned<String>) -> Checked<usize> {
        if let Some(&index) = self.by_name.get(name.get_ref()) {
            return Ok(index);
        }
        let names = self.particles.iter().map(|particle| particle.name.as_str());
        let fault = check::unknown("particle", name.get_ref(), names, check::LISTED);
        Err(at(name.span(), fault))
    }

    /// An error where both of a pair are points of one body, whose distance nothing changes.
    pub(crate) fn check_apart(
        &self,
        ends: [usize; 2],
        names: &Spanned<Vec<Spanned<String>>>,
    ) -> Checked<()> {
        let body = |end: usize| match self.particles[end].motion {
            Motion::Carried { body, .. } => Some(body),
            _ => None,
        };
        let name = |end: usize| self.particles[end].name.clone();
        match ends.map(body) {
            [Some(a), Some(b)] if a == b && ends[0] != ends[1] => {
                Err(at(names.span(), Fault::SameBody(name(ends[0]), name(ends[1]))))
            }
            _ => Ok(()),
        }
    }

    /// The two particles of a pair.
    pub(crate) fn pair(
        &self,
        what: &'static str,
        names: &Spanned<Vec<Spanned<String>>>,
    ) -> Checked<[usize; 2]> {
        match names.get_ref().as_slice() {
            [first, second] => Ok([self.find(first)?, self.find(second)?]),
            others => Err(at(names.span(), Fault::NotAPair { what, got: others.len() })),
        }
    }
}
