//! Particles: the ones that are written out, and their names.

use std::collections::HashMap;
use std::ops::Range;

use toml::Spanned;

use crate::model::particle::{Motion, Particle};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::source::shortened;
use crate::text::suggestion::nearest;
use crate::words::declaration::ParticleDeclaration;

/// The particles of a scene in order, found by name, and the place of each in the text.
#[derive(Debug, Default)]
pub(crate) struct Roster {
    pub(crate) particles: Vec<Particle>,
    /// Where the text places each particle: its position, or the net's origin.
    pub(crate) places: Vec<Range<usize>>,
    /// The first pinned particle and where the text pins it.
    pub(crate) first_pin: Option<(usize, Range<usize>)>,
    by_name: HashMap<String, usize>,
}

impl Roster {
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
        /// Names listed in an error; more would not help.
        const LISTED: usize = 12;
        if let Some(&index) = self.by_name.get(name.get_ref()) {
            return Ok(index);
        }
        let names = self.particles.iter().map(|particle| particle.name.as_str());
        let nearest = nearest(name.get_ref(), names.clone()).map(str::to_owned);
        let few = if names.len() <= LISTED { names.len() } else { 0 };
        let fault = Fault::UnknownWord {
            kind: "particle",
            word: shortened(name.get_ref()),
            nearest,
            allowed: names.take(few).map(str::to_owned).collect(),
        };
        Err(at(name.span(), fault))
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

/// Adds a particle that is written out.
pub(crate) fn declare(
    roster: &mut Roster,
    dimension: usize,
    declared: &ParticleDeclaration,
) -> Checked<()> {
    let name = check::name(&declared.name)?;
    let place = declared.position.span();
    let position = check::vector("the position", dimension, &declared.position)?;
    let motion = motion(dimension, declared)?;
    let radius = declared.radius.as_ref();
    let radius = radius.map(|radius| check::positive("the radius", radius)).transpose()?;
    let radius = radius.unwrap_or_default();
    let particle = Particle { name: name.clone(), position, motion, radius };
    let Some(index) = roster.add(particle, place) else {
        return Err(at(declared.name.span(), Fault::DuplicateName(name)));
    };
    if let (Motion::Pinned, None, Some(pinned)) = (motion, &roster.first_pin, &declared.pinned) {
        roster.first_pin = Some((index, pinned.span()));
    }
    Ok(())
}

fn motion(dimension: usize, declared: &ParticleDeclaration) -> Checked<Motion> {
    let name = || declared.name.get_ref().clone();
    let mass = declared.mass.as_ref().map(|mass| check::positive("the mass", mass)).transpose()?;
    let given = |what, x: &Option<_>| match x {
        Some(x) => check::vector(what, dimension, x).map(Some),
        None => Ok(None),
    };
    let velocity = given("the velocity", &declared.velocity)?;
    let momentum = given("the momentum", &declared.momentum)?;
    if let (Some(_), Some(momentum)) = (&declared.velocity, &declared.momentum) {
        return Err(at(momentum.span(), Fault::VelocityAndMomentum(name())));
    }
    let moving = declared.velocity.as_ref().or(declared.momentum.as_ref());
    if declared.pinned.as_ref().is_some_and(|pinned| *pinned.get_ref()) {
        return match moving {
            Some(moving) => Err(at(moving.span(), Fault::PinnedMoves(name()))),
            None => Ok(Motion::Pinned),
        };
    }
    let Some(mass) = mass else {
        return Err(at(declared.name.span(), Fault::NoMass(name())));
    };
    let momentum = momentum.or(velocity.map(|v| v.map(|v| mass * v))).unwrap_or_default();
    match (momentum.iter().find(|p| !p.is_finite()), moving) {
        (Some(&value), Some(moving)) => {
            Err(at(moving.span(), Fault::NotFinite { what: "the momentum", value }))
        }
        _ => Ok(Motion::Free { mass, momentum }),
    }
}
