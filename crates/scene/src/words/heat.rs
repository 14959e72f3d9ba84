//! Heat on a shape: what is warm where at the start, and what is held at its temperature.
//!
//! ```text
//! df/dt = alpha Lap f          f temperatures of the vertices, alpha `diffusivity`             (15.3)
//! ```
//! Vertices within the `radius` of a warm place start with its `temperature`, the others with zero.
//! Parts that are `held` keep theirs; through what is left of a boundary no heat flows. Vertices are
//! particles of the scene that stay where they are.

use crate::model::elastic_body::Heated;
use std::path::Path;

use crate::model::elastic_body::HeatedBody;
use crate::model::particle::{Motion, Particle};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::HeatDeclaration;
use crate::words::laid_shape::{Element, Shape};
use crate::words::laid_shape::{mark, within};
use crate::words::particles::Roster;
use crate::words::shape;

/// The body that is declared, its vertices added to the roster.
pub(crate) fn declare(
    roster: &mut Roster,
    dimension: usize,
    folder: Option<&Path>,
    declared: &HeatDeclaration,
) -> Checked<Heated> {
    let name = check::name(&declared.name)?;
    let shape = shape::declare(dimension, Element::Linear, folder, &declared.shape)?;
    let diffusivity = check::positive("the diffusivity", &declared.diffusivity)?;
    for (vertex, &position) in shape.places.iter().enumerate() {
        let particle = Particle {
            name: format!("{name}.{vertex}"),
            position,
            motion: Motion::Pinned,
            radius: 0.0,
        };
        // There is nothing else in the scene that could have this name.
        roster.add(particle, declared.shape.span());
    }
    mark(roster, dimension, 0, &name, &shape, declared.marks.as_ref())?;
    let (start, held) = temperatures(dimension, &shape, declared)?;
    if held.iter().all(|&held| held) {
        return Err(at(declared.name.span(), Fault::AllHeld));
    }
    let body = HeatedBody { name, diffusivity, simplices: shape.simplices, start, held };
    Ok((body, shape.edges, shape.faces))
}

/// The temperature of each vertex at the start, and whether it keeps it.
fn temperatures(
    dimension: usize,
    shape: &Shape,
    declared: &HeatDeclaration,
) -> Checked<(Vec<f64>, Vec<bool>)> {
    let mut start = vec![0.0; shape.places.len()];
    let mut held = vec![false; start.len()];
    for warm in declared.warm.iter().flatten() {
        let place = check::vector("a warm place", dimension, &warm.at)?;
        let radius = check::positive("the radius", &warm.radius)?;
        let temperature = check::finite("the temperature", &warm.temperature)?;
        let mut none = true;
        for (start, far) in start.iter_mut().zip(shape.distances(place)) {
            if far <= radius {
                (*start, none) = (temperature, false);
            }
        }
        if none {
            return Err(at(warm.radius.span(), Fault::Nowhere));
        }
    }
    for hold in declared.held.iter().flatten() {
        let temperature = check::finite("the temperature", &hold.temperature)?;
        for (vertex, there) in
            within(shape, std::slice::from_ref(&hold.part))?.into_iter().enumerate()
        {
            if there {
                (start[vertex], held[vertex]) = (temperature, true);
            }
        }
    }
    Ok((start, held))
}
