//! Particles: the ones that are written out, and their names.

use std::ops::Range;

use toml::Spanned;

use crate::model::particle::{Motion, Particle};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Number};
use crate::words::draft::Draft;
use crate::words::particle_table::ParticleTable;
use crate::words::table::{Kind, table};
use crate::words::word::{Of, Word};

table! {
    /// A point mass.
    pub(crate) struct ParticleDeclaration = "a particle" {
        /// A name.
        name: Spanned<String> = Kind::Name,
        /// Its mass; a pinned particle needs none, and attracts with the one that it is given.
        mass: Option<Spanned<Number>> = Kind::Positive,
        /// Where it starts.
        position: Components = Kind::Vector,
        /// How fast it starts; at rest where neither velocity nor momentum is given.
        velocity: Option<Components> = Kind::Vector,
        /// Its momentum at the start, instead of a velocity.
        momentum: Option<Components> = Kind::Vector,
        /// Whether it stays where it is.
        pinned: Option<Spanned<bool>> = Kind::Flag,
        /// Its radius, where it touches others.
        radius: Option<Spanned<Number>> = Kind::NotNegative,
    }
}

impl Word for Vec<ParticleDeclaration> {
    const OF: Of = Of::Particles;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.name.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        for particle in self {
            declare(&mut draft.particles, draft.dimension, particle)?;
        }
        draft.written_out = match draft.bodies.len() {
            0 => draft.particles.particles.len(),
            bodies => bodies,
        };
        Ok(())
    }
}

/// Adds a particle that is written out.
pub(crate) fn declare(
    table: &mut ParticleTable,
    dimension: usize,
    declared: &ParticleDeclaration,
) -> Checked<()> {
    let name = check::name(&declared.name)?;
    let place = declared.position.span();
    let position = check::vector("the position", dimension, &declared.position)?;
    let (motion, mass) = motion(dimension, declared)?;
    let radius = declared.radius.as_ref();
    let radius = radius.map(|radius| check::positive("the radius", radius)).transpose()?;
    let radius = radius.unwrap_or_default();
    let particle = Particle { name: name.clone(), position, motion, radius };
    let Some(index) = table.add(particle, place) else {
        return Err(at(declared.name.span(), Fault::DuplicateName(name)));
    };
    if let (Motion::Pinned, None, Some(pinned)) = (motion, &table.first_pin, &declared.pinned) {
        table.first_pin = Some((index, pinned.span()));
    }
    if let (Motion::Pinned, Some(mass)) = (motion, mass) {
        table.pinned_masses.push((index, mass));
    }
    Ok(())
}

/// How a particle starts, and the mass that it is given.
fn motion(dimension: usize, declared: &ParticleDeclaration) -> Checked<(Motion, Option<f64>)> {
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
            None => Ok((Motion::Pinned, mass)),
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
        _ => Ok((Motion::Free { mass, momentum }, Some(mass))),
    }
}
