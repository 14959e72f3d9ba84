//! Springs between particles.

use stationary_calculus::Stencils;
use stationary_elasticity::{Spring, SpringError, Strain};

use crate::assemble::system::{Vertices, leading};
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::model::things::Link;
use crate::run::error::AssemblyError;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::SpringDeclaration;
use crate::words::particles::Roster;

/// The potential of a scene's springs.
pub(crate) type Springs<const D: usize> = Stencils<Spring, 2, D>;

/// The strains by name.
const STRAINS: [(&str, Strain); 2] = [("cauchy", Strain::Cauchy), ("green", Strain::Green)];

/// The strain of this name, Cauchy's where there is none.
pub(crate) fn strain(name: Option<&toml::Spanned<String>>) -> Checked<Strain> {
    match name {
        Some(name) => check::word("strain", name.get_ref(), name.span(), &STRAINS),
        None => Ok(Strain::default()),
    }
}

/// The spring that is declared; its rest length is that at the start unless it is given.
pub(crate) fn declare(roster: &Roster, declared: &SpringDeclaration) -> Checked<Link> {
    let ends = roster.pair("a spring", &declared.between)?;
    let stiffness = check::positive("the stiffness", &declared.stiffness)?;
    let strain = strain(declared.strain.as_ref())?;
    let [x, y] = ends.map(|end| roster.particles[end].position);
    let start = (0..3).map(|c| (y[c] - x[c]) * (y[c] - x[c])).sum::<f64>().sqrt();
    let (rest_length, place) = match &declared.rest_length {
        Some(length) => (check::finite("the rest length", length)?, length.span()),
        None => (start, declared.between.span()),
    };
    let same = |end: usize| roster.particles[end].name.clone();
    Spring::new(ends, rest_length, stiffness, strain).map_err(|error| match error {
        SpringError::Loop(end) => at(declared.between.span(), Fault::Loop(same(end))),
        _ if declared.rest_length.is_none() => at(place.clone(), Fault::NoRestLength),
        _ => at(place.clone(), Fault::RestLength(rest_length)),
    })?;
    match (start == 0.0, strain) {
        (true, _) if declared.rest_length.is_none() => Err(at(place, Fault::NoRestLength)),
        (true, Strain::Cauchy) if rest_length > 0.0 => {
            Err(at(declared.between.span(), Fault::Spike))
        }
        _ => Ok(Link { ends, rest_length, stiffness, strain }),
    }
}

impl Scene {
    /// The scene's springs between its vertices.
    pub(crate) fn springs<const D: usize>(
        &self,
        vertices: &Vertices,
        built: &mut Built,
    ) -> Result<Springs<D>, AssemblyError> {
        let springs = self.links.iter().map(|link| {
            let ends = link.ends.map(|end| vertices.of_particle[end]);
            Spring::new(ends, link.rest_length, link.stiffness, link.strain)
        });
        let springs = springs.collect::<Result<Vec<_>, _>>()?;
        built.springs += springs.len() as u64;
        let pinned = vertices.particles[vertices.free..].iter();
        let fixed = pinned.map(|&particle| leading::<D>(self.particles[particle].position));
        Ok(Stencils::new(vertices.free, fixed.collect(), springs)?)
    }
}
