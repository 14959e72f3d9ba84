//! Heat on a shape: what is warm where at the start, and what is held at its temperature.
//!
//! ```text
//! df/dt = alpha Lap f          f temperatures of the vertices, alpha `diffusivity`             (15.3)
//! ```
//! Vertices within the `radius` of a warm place start with its `temperature`, the others with zero.
//! Parts that are `held` keep theirs; through what is left of a boundary no heat flows. Vertices are
//! particles of the scene that stay where they are.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Marks, Number};
use crate::words::draft::Draft;
use crate::words::shape::ShapeDeclaration;
use crate::words::strength::StrengthDeclaration;
use crate::words::table::{Kind, table};
use crate::words::word::{Feature, LAPLACIAN, Of, Word};

table! {
    /// Heat that flows through a shape.
    pub(crate) struct HeatDeclaration = "a table of heat on a shape" {
        /// A name.
        name: Spanned<String> = Kind::Name,
        /// A mesh: a kind with its size and cells, or a file.
        shape: Spanned<ShapeDeclaration> = Kind::Table(&ShapeDeclaration::TABLE),
        /// Length squared over time.
        diffusivity: Spanned<Number> = Kind::Positive,
        /// What is warm at the start; the rest is at zero.
        warm: Option<Vec<WarmDeclaration>> = Kind::List(&Kind::Table(&WarmDeclaration::TABLE)),
        /// What is held at its temperature.
        held: Option<Vec<HeldDeclaration>> = Kind::List(&Kind::Table(&HeldDeclaration::TABLE)),
        /// Where heat flows in.
        sources: Option<Vec<SourceDeclaration>> = Kind::List(&Kind::Table(&SourceDeclaration::TABLE)),
        /// Names for the vertices nearest to places.
        marks: Option<Marks> = Kind::Marks,
    }

    /// A warm place.
    pub(crate) struct WarmDeclaration = "a table with `at`, `radius` and `temperature`" {
        /// Where.
        at: Components = Kind::Vector,
        /// How far around.
        radius: Spanned<Number> = Kind::Positive,
        /// How warm.
        temperature: Spanned<Number> = Kind::Number,
    }

    /// A place where heat flows in.
    pub(crate) struct SourceDeclaration = "a table with `at`, `radius` and `rate`" {
        /// Where.
        at: Components = Kind::Vector,
        /// How far around.
        radius: Spanned<Number> = Kind::Positive,
        /// How fast it is warmed there, temperature over time, where the strength is 1.
        rate: Spanned<Number> = Kind::Number,
        /// How strong it is in time; 1 where it is missing.
        strength: Option<Spanned<StrengthDeclaration>> = Kind::Strength,
    }

    /// A part that is held.
    pub(crate) struct HeldDeclaration = "a table with `part` and `temperature`" {
        /// The part, such as left, rim.
        part: Spanned<String> = Kind::Text,
        /// How warm.
        temperature: Spanned<Number> = Kind::Number,
    }
}

impl Word for Option<HeatDeclaration> {
    const FEATURE: Option<Feature> = Some(LAPLACIAN);
    const OF: Of = Of::Heat;

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().map(|heat| heat.name.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "laplacian")]
        if let Some(heat) = self {
            let (body, sources, edges, faces) =
                declare(&mut draft.particles, draft.dimension, draft.folder, heat)?;
            (draft.solids.edges, draft.solids.faces) = (edges, faces);
            draft.heat = Some(body);
            draft.drives.sources = sources;
        }
        #[cfg(not(feature = "laplacian"))]
        let _ = draft;
        Ok(())
    }
}

#[cfg(feature = "laplacian")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "laplacian")]
mod compiled {
    use super::*;
    use crate::model::drives::HeatSource;
    use std::path::Path;

    use crate::model::elastic_body::HeatedBody;
    use crate::model::particle::{Motion, Particle};
    use crate::text::check;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::words::laid_shape::{Element, Shape};
    use crate::words::laid_shape::{mark, within};
    use crate::words::particle_table::ParticleTable;
    use crate::words::shape;
    use crate::words::strength;

    /// The body that is declared, its vertices added to the table.
    pub(crate) fn declare(
        table: &mut ParticleTable,
        dimension: usize,
        folder: Option<&Path>,
        declared: &HeatDeclaration,
    ) -> Checked<Declared> {
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
            table.add(particle, declared.shape.span());
        }
        mark(table, dimension, 0, &name, &shape, declared.marks.as_ref())?;
        let sources = sources(dimension, folder, &shape, declared)?;
        let (start, held) = temperatures(dimension, &shape, declared)?;
        if held.iter().all(|&held| held) {
            return Err(at(declared.name.span(), Fault::AllHeld));
        }
        let body = HeatedBody { name, diffusivity, simplices: shape.simplices, start, held };
        Ok((body, sources, shape.edges, shape.faces))
    }

    /// The body, where heat flows into it, its edges and its faces.
    type Declared = (HeatedBody, Vec<HeatSource>, Vec<[usize; 2]>, Vec<[usize; 3]>);

    /// Where heat flows in: the vertices within the radius of each place.
    fn sources(
        dimension: usize,
        folder: Option<&Path>,
        shape: &Shape,
        declared: &HeatDeclaration,
    ) -> Checked<Vec<HeatSource>> {
        let source = |source: &SourceDeclaration| {
            let place = check::vector("a source", dimension, &source.at)?;
            let radius = check::positive("the radius", &source.radius)?;
            let rate = check::finite("the rate", &source.rate)?;
            let rates = shape.distances(place).map(|far| if far <= radius { rate } else { 0.0 });
            let rates: Vec<f64> = rates.collect();
            if rate != 0.0 && rates.iter().all(|&rate| rate == 0.0) {
                return Err(at(source.radius.span(), Fault::Nowhere));
            }
            let strength = strength::declare(folder, source.strength.as_ref())?;
            Ok(HeatSource { rates, strength })
        };
        declared.sources.iter().flatten().map(source).collect()
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
}
