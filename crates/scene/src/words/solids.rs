//! Elastic bodies: shapes whose vertices are particles, held together by their material.
//!
//! ```text
//! V = sum over simplices  volume section W(F)           W of a material with Young's modulus E and
//! m_a = density section (length, area or volume)_a      Poisson's ratio nu
//! V += 1/2 B sum over inner edges of a sheet in space  |e|^2/A (theta - theta_rest)^2
//! ```
//! Simplices are linear elements or, where the body says `element = "quadratic"`, have nodes in the
//! middle of their edges as well. `section` is the cross-section of a bar and the thickness of a sheet,
//! `B` the `bending` of a sheet. A bar is free to thin where it is drawn out and a sheet is under plane stress. Vertices are called
//! `name.0`, `name.1`, ..., and those nearest to the `marks` by the mark's name. What is `hung` is held
//! while everything comes to rest, and is let go at the start; where it is `struck` it starts with
//! another velocity.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Marks, Number};
use crate::words::draft::Draft;
use crate::words::shape::ShapeDeclaration;
use crate::words::table::{Kind, table};
use crate::words::word::{ELASTICITY, Feature, MODAL, Of, Word};

table! {
    /// An elastic body; its vertices are called name.0, name.1 and so on, and name.mark.
    pub(crate) struct SolidDeclaration = "an elastic body" {
        /// A name.
        name: Spanned<String> = Kind::Name,
        /// A mesh: a kind with its size and cells, or a file.
        shape: Spanned<ShapeDeclaration> = Kind::Table(&ShapeDeclaration::TABLE),
        /// Mass over volume.
        density: Spanned<Number> = Kind::Positive,
        /// The cross-section of a bar.
        section: Option<Spanned<Number>> = Kind::Positive,
        /// The thickness of a sheet.
        thickness: Option<Spanned<Number>> = Kind::Positive,
        /// Quadratic ones have vertices in the middle of their edges too; linear where it is
        /// missing.
        element: Option<Spanned<String>> = Kind::OneOf(&["linear", "quadratic"]),
        /// The energy density; saint-venant-kirchhoff where it is missing.
        material: Option<Spanned<String>> = Kind::OneOf(&["saint-venant-kirchhoff", "neo-hookean", "fixed-corotated", "linear"]),
        /// Young's modulus.
        young: Spanned<Number> = Kind::Positive,
        /// Poisson's ratio; 0 where it is missing.
        poisson: Option<Spanned<Number>> = Kind::Number,
        /// The bending stiffness of a sheet in space.
        bending: Option<Spanned<Number>> = Kind::Positive,
        /// How fast all of it starts.
        velocity: Option<Components> = Kind::Vector,
        /// What starts with a velocity of its own.
        struck: Option<StrikeDeclaration> = Kind::Table(&StrikeDeclaration::TABLE),
        /// Parts of the shape that stay, such as left, top-left, rim.
        pinned: Option<Vec<Spanned<String>>> = Kind::List(&Kind::Text),
        /// Parts that are held until the start, while the rest hangs.
        hung: Option<Vec<Spanned<String>>> = Kind::List(&Kind::Text),
        /// Names for the vertices nearest to places.
        marks: Option<Marks> = Kind::Marks,
    }

    /// What starts with a velocity of its own.
    pub(crate) struct StrikeDeclaration = "a table with `at`, `radius` and `velocity`" {
        /// Where.
        at: Components = Kind::Vector,
        /// How far around.
        radius: Spanned<Number> = Kind::Positive,
        /// How fast.
        velocity: Components = Kind::Vector,
    }
}

impl Word for Vec<SolidDeclaration> {
    const FEATURE: Option<Feature> = Some(ELASTICITY);
    const OF: Of = Of::Elastic;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.name.span())
    }

    fn inner(&self) -> Option<(&'static str, Feature, Range<usize>)> {
        let hung = self.iter().flat_map(|solid| solid.hung.iter().flatten()).next()?;
        Some(("hung", MODAL, hung.span()))
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "elasticity")]
        for solid in self {
            let Draft { particles, solids, dimension, folder, .. } = draft;
            declare(particles, solids, *dimension, *folder, solid)?;
        }
        #[cfg(not(feature = "elasticity"))]
        let _ = draft;
        Ok(())
    }
}

#[cfg(feature = "elasticity")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "elasticity")]
mod compiled {
    use super::*;
    use crate::words::laid_shape::Solids;
    use crate::words::laid_shape::mark;
    use crate::words::laid_shape::within;
    use stationary_elasticity::{ElasticityError, Lame};
    use std::path::Path;

    use crate::model::elastic_body::{ElasticBody, ElasticMaterial};
    use crate::model::particle::{Motion, Particle};
    use crate::model::simplices::Simplices;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::text::{check, limits};
    use crate::words::laid_shape::{Element, Shape};
    use crate::words::node_shares::node_shares;
    use crate::words::particle_table::ParticleTable;
    use crate::words::shape;

    const MATERIALS: [(&str, ElasticMaterial); 4] = [
        ("saint-venant-kirchhoff", ElasticMaterial::SaintVenantKirchhoff),
        ("neo-hookean", ElasticMaterial::NeoHookean),
        ("fixed-corotated", ElasticMaterial::FixedCorotated),
        ("linear", ElasticMaterial::Linear),
    ];

    const ELEMENTS: [(&str, Element); 2] =
        [("linear", Element::Linear), ("quadratic", Element::Quadratic)];

    /// Adds the particles of a solid to the table, and the solid to the others.
    pub(crate) fn declare(
        table: &mut ParticleTable,
        solids: &mut Solids,
        dimension: usize,
        folder: Option<&Path>,
        declared: &SolidDeclaration,
    ) -> Checked<()> {
        let name = check::name(&declared.name)?;
        let element = element(declared)?;
        let mut shape = shape::declare(dimension, element, folder, &declared.shape)?;
        if element == Element::Quadratic {
            shape.shares = node_shares(&shape).map_err(|fault| at(declared.shape.span(), fault))?;
        }
        let (material, lame) = material(dimension, &shape.simplices, declared)?;
        let section = section(&shape.simplices, declared)?;
        let bending = bending(dimension, element, &shape.simplices, declared)?;
        let first = table.particles.len();
        let count = (first + shape.places.len()) as u64;
        if count > limits::PARTICLES {
            let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
            return Err(at(declared.shape.span(), fault));
        }
        add_vertices(table, dimension, &name, &shape, section, declared)?;
        let hung = within(&shape, declared.hung.as_deref().unwrap_or_default())?;
        solids.hung.extend((0..hung.len()).filter(|&v| hung[v]).map(|v| first + v));
        mark(table, dimension, first, &name, &shape, declared.marks.as_ref())?;
        solids.edges.extend(shape.edges.iter().map(|ends| ends.map(|end| first + end)));
        solids.faces.extend(shape.faces.iter().map(|corners| corners.map(|corner| first + corner)));
        let simplices = shape.simplices.shifted(first);
        let middles =
            shape.middles.iter().map(|(ends, node)| (ends.map(|end| first + end), first + node));
        let middles = middles.collect();
        let rest = shape.places;
        solids.bodies.push(ElasticBody {
            name,
            material,
            lame,
            section,
            bending,
            first,
            rest,
            simplices,
            middles,
        });
        Ok(())
    }

    fn element(declared: &SolidDeclaration) -> Checked<Element> {
        match &declared.element {
            Some(word) => check::word("element", word.get_ref(), word.span(), &ELEMENTS),
            None => Ok(Element::Linear),
        }
    }

    fn material(
        dimension: usize,
        simplices: &Simplices,
        declared: &SolidDeclaration,
    ) -> Checked<(ElasticMaterial, Lame<3>)> {
        let young = check::positive("Young's modulus", &declared.young)?;
        let (poisson, place) = match &declared.poisson {
            Some(poisson) => (check::finite("Poisson's ratio", poisson)?, poisson.span()),
            None => (0.0, declared.young.span()),
        };
        let fault =
            |place, error: &dyn std::error::Error| at(place, Fault::Solid(error.to_string()));
        let lame = lame(young, poisson).map_err(|e| fault(place, &e))?;
        let Some(word) = &declared.material else {
            return Ok((ElasticMaterial::SaintVenantKirchhoff, lame));
        };
        let material = check::word("material", word.get_ref(), word.span(), &MATERIALS)?;
        let fills = match simplices {
            Simplices::Segments(_) => false,
            Simplices::Triangles(_) => dimension == 2,
            Simplices::Tetrahedra(_) => true,
        };
        if material != ElasticMaterial::SaintVenantKirchhoff && !fills {
            return Err(at(word.span(), Fault::MaterialOfBlocks(word.get_ref().clone())));
        }
        Ok((material, lame))
    }

    fn section(simplices: &Simplices, declared: &SolidDeclaration) -> Checked<f64> {
        let (key, given, other) = match simplices {
            Simplices::Segments(_) => ("section", &declared.section, &declared.thickness),
            Simplices::Triangles(_) => ("thickness", &declared.thickness, &declared.section),
            Simplices::Tetrahedra(_) => {
                let given = declared.section.as_ref().or(declared.thickness.as_ref());
                return match given {
                    Some(given) => Err(at(given.span(), Fault::SectionOfBlock)),
                    None => Ok(1.0),
                };
            }
        };
        match (given, other) {
            (_, Some(other)) => Err(at(other.span(), Fault::Section(key))),
            (Some(given), None) => check::positive("the section", given),
            (None, None) => Err(at(declared.name.span(), Fault::Section(key))),
        }
    }

    fn bending(
        dimension: usize,
        element: Element,
        simplices: &Simplices,
        declared: &SolidDeclaration,
    ) -> Checked<Option<f64>> {
        let bends = dimension == 3 && matches!(simplices, Simplices::Triangles(_));
        match &declared.bending {
            Some(given) if !bends => Err(at(given.span(), Fault::Bending)),
            Some(given) if element == Element::Quadratic => {
                Err(at(given.span(), Fault::BendingOfQuadratic))
            }
            Some(given) => check::positive("the bending stiffness", given).map(Some),
            None => Ok(None),
        }
    }

    fn add_vertices(
        table: &mut ParticleTable,
        dimension: usize,
        name: &str,
        shape: &Shape,
        section: f64,
        declared: &SolidDeclaration,
    ) -> Checked<()> {
        let density = check::positive("the density", &declared.density)?;
        let velocity = match &declared.velocity {
            Some(velocity) => check::vector("the velocity", dimension, velocity)?,
            None => [0.0; 3],
        };
        let pinned = within(shape, declared.pinned.as_deref().unwrap_or_default())?;
        let struck = struck(dimension, shape, declared)?;
        let place = declared.shape.span();
        for (vertex, (&position, share)) in shape.places.iter().zip(&shape.shares).enumerate() {
            let mass = share * section * density;
            let momentum = struck[vertex].unwrap_or(velocity).map(|v| mass * v);
            let sound = mass > 0.0 && mass.is_finite() && mass.recip().is_finite();
            if !(sound && momentum.iter().all(|p| p.is_finite())) {
                let fault = Fault::NotPositive { what: "the mass of a vertex", value: mass };
                return Err(at(declared.density.span(), fault));
            }
            let motion =
                if pinned[vertex] { Motion::Pinned } else { Motion::Free { mass, momentum } };
            let particle =
                Particle { name: format!("{name}.{vertex}"), position, motion, radius: 0.0 };
            let Some(index) = table.add(particle, place.clone()) else {
                return Err(at(declared.name.span(), Fault::DuplicateSolid(name.to_owned())));
            };
            if let (Motion::Pinned, None, Some(words)) =
                (motion, &table.first_pin, &declared.pinned)
            {
                let place = words.first().map_or(place.clone(), |word| word.span());
                table.first_pin = Some((index, place));
            }
        }
        Ok(())
    }

    /// The velocity of each vertex that is struck.
    fn struck(
        dimension: usize,
        shape: &Shape,
        declared: &SolidDeclaration,
    ) -> Checked<Vec<Option<[f64; 3]>>> {
        let Some(strike) = &declared.struck else {
            return Ok(vec![None; shape.places.len()]);
        };
        let place = check::vector("the place of the strike", dimension, &strike.at)?;
        let radius = check::positive("the radius of the strike", &strike.radius)?;
        let velocity = check::vector("the velocity", dimension, &strike.velocity)?;
        let struck = shape.distances(place).map(|far| (far <= radius).then_some(velocity));
        let struck: Vec<_> = struck.collect();
        if struck.iter().all(Option::is_none) {
            return Err(at(strike.radius.span(), Fault::StruckNothing));
        }
        Ok(struck)
    }

    /// The parameters of a material with this Young's modulus and this Poisson's ratio.
    pub(crate) fn lame(young: f64, poisson: f64) -> Result<Lame<3>, ElasticityError> {
        Lame::from_young_poisson(young, poisson)
    }
}
