//! The potential of a scene's elastic bodies: each of its own elements and material.
//!
//! ```text
//! V(q) = sum over bodies  V_body(q)        q all free particles of the scene
//! ```
//! The elements are numbered by the scene's vertices, so that springs, rods and several bodies may
//! hold one another by shared particles. What the elements are is known only when a file is read: each
//! kind has a word of its own here, so that its loops are compiled for it.

use nalgebra::SVector;
use stationary_calculus::{Covector, Potential, Sink, Stencils};
use stationary_elasticity::{
    ElasticityError, FixedCorotated, Freedoms, Held, Hinge, Lame, Linear, LinearSegment,
    LinearTetrahedron, LinearTriangle, Material, NeoHookean, Reference, SaintVenantKirchhoff,
    Solid, hinges,
};
use stationary_mesh::Mesh;

use crate::shape::Simplices;
use crate::system::{Vertices, leading};
use crate::{AssemblyError, Built, ElasticBody, ElasticMaterial, Scene};

type Bar<const D: usize> = Solid<SaintVenantKirchhoff<1>, 2, D, 1, 1>;
type Sheet<M> = Solid<M, 3, 2, 2, 1>;
type Block<M> = Solid<M, 4, 3, 3, 1>;

/// Elements of one kind.
#[derive(Clone, Debug)]
enum Part {
    BarOnALine(Bar<1>),
    BarInThePlane(Bar<2>),
    BarInSpace(Bar<3>),
    Sheet(Sheet<SaintVenantKirchhoff<2>>),
    NeoHookeanSheet(Sheet<NeoHookean<2>>),
    CorotatedSheet(Sheet<FixedCorotated<2>>),
    LinearSheet(Sheet<Linear<2>>),
    Membrane(Solid<SaintVenantKirchhoff<2>, 3, 3, 2, 1>),
    Folds(Stencils<Hinge, 4, 3>),
    Block(Block<SaintVenantKirchhoff<3>>),
    NeoHookeanBlock(Block<NeoHookean<3>>),
    CorotatedBlock(Block<FixedCorotated<3>>),
    LinearBlock(Block<Linear<3>>),
}

/// The same for elements of every kind.
macro_rules! each {
    ($part:expr, $elements:ident => $same:expr) => {
        match $part {
            Part::BarOnALine($elements) => $same,
            Part::BarInThePlane($elements) => $same,
            Part::BarInSpace($elements) => $same,
            Part::Sheet($elements) => $same,
            Part::NeoHookeanSheet($elements) => $same,
            Part::CorotatedSheet($elements) => $same,
            Part::LinearSheet($elements) => $same,
            Part::Membrane($elements) => $same,
            Part::Folds($elements) => $same,
            Part::Block($elements) => $same,
            Part::NeoHookeanBlock($elements) => $same,
            Part::CorotatedBlock($elements) => $same,
            Part::LinearBlock($elements) => $same,
        }
    };
}

/// The parameters of a material with this Young's modulus and this Poisson's ratio.
pub(crate) fn lame(young: f64, poisson: f64) -> Result<Lame<3>, ElasticityError> {
    Lame::from_young_poisson(young, poisson)
}

/// All elastic bodies of a scene; there may be none.
#[derive(Clone, Debug)]
pub(crate) struct ElasticBodies {
    freedoms: usize,
    parts: Vec<Part>,
}

/// Elements that are counted where they are made.
trait Counted {
    fn count(&self, built: &mut Built);
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Counted
    for Solid<M, N, D, R, Q>
{
    fn count(&self, built: &mut Built) {
        built.elements += self.elements() as u64;
    }
}

impl Counted for Stencils<Hinge, 4, 3> {
    fn count(&self, built: &mut Built) {
        built.hinges += self.stencils().len() as u64;
    }
}

impl ElasticBodies {
    /// Counts the elements.
    pub(crate) fn count(&self, built: &mut Built) {
        for part in &self.parts {
            each!(part, elements => elements.count(built));
        }
    }
}

impl Potential for ElasticBodies {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.parts.iter().map(|part| each!(part, elements => elements.energy(q))).sum()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        for part in &self.parts {
            each!(part, elements => elements.add_differential(q, dv.view_mut()));
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for part in &self.parts {
            each!(part, elements => elements.add_hessian(q, hessian));
        }
    }
}

type Parts = Result<Vec<Part>, AssemblyError>;

/// A body and what it is laid into.
struct Laid<'a, const D: usize> {
    body: &'a ElasticBody,
    freedoms: &'a Freedoms<D>,
    /// Where every vertex of the scene is when the body is at rest.
    rest: Vec<SVector<f64, D>>,
    vertices: &'a Vertices,
}

impl Scene {
    /// The elastic bodies of the scene.
    pub(crate) fn elastic_bodies<const D: usize>(
        &self,
        vertices: &Vertices,
    ) -> Result<ElasticBodies, AssemblyError> {
        let parts = match D {
            _ if self.solids.is_empty() => Vec::new(),
            1 => self.laid(vertices, on_a_line)?,
            2 => self.laid(vertices, in_the_plane)?,
            _ => self.laid(vertices, in_space)?,
        };
        Ok(ElasticBodies { freedoms: D * vertices.free, parts })
    }

    fn laid<const D: usize>(&self, vertices: &Vertices, make: fn(&Laid<'_, D>) -> Parts) -> Parts {
        let place = |&particle: &usize| leading::<D>(self.particles[particle].position);
        let places: Vec<[f64; D]> = vertices.particles.iter().map(place).collect();
        let pinned = places.iter().enumerate().skip(vertices.free);
        let held = pinned.flat_map(|(vertex, place)| {
            place.iter().enumerate().map(move |(component, &place)| Held {
                vertex,
                component,
                place,
            })
        });
        let freedoms = Freedoms::<D>::new(places.len(), &held.collect::<Vec<_>>())?;
        let mut all = Vec::new();
        for body in &self.solids {
            let mut rest: Vec<SVector<f64, D>> = places.iter().map(|&x| x.into()).collect();
            for (vertex, &x) in body.rest.iter().enumerate() {
                rest[vertices.of_particle[body.first + vertex]] = leading::<D>(x).into();
            }
            all.extend(make(&Laid { body, freedoms: &freedoms, rest, vertices })?);
        }
        Ok(all)
    }
}

impl<const D: usize> Laid<'_, D> {
    fn mesh<const K: usize>(&self, simplices: &[[usize; K]]) -> Result<Mesh<D, K>, AssemblyError> {
        let of_particle = &self.vertices.of_particle;
        let corners = simplices.iter().map(|corners| corners.map(|corner| of_particle[corner]));
        Ok(Mesh::new(self.rest.clone(), corners.collect()).map_err(ElasticityError::from)?)
    }

    /// The body of these elements and this material.
    fn solid<F, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        family: F,
        mesh: &Mesh<D, N>,
        material: M,
    ) -> Result<Solid<M, N, D, R, Q>, AssemblyError>
    where
        F: Reference<N, R, Q>,
        M: Material<D, R>,
    {
        Ok(Solid::new(family, mesh, self.body.section, material, self.freedoms.clone())?)
    }

    /// Segments, free to thin where they are drawn out.
    fn bar(&self, segments: &[[usize; 2]]) -> Result<Bar<D>, AssemblyError> {
        let material = SaintVenantKirchhoff::new(self.body.lame.uniaxial_stress());
        self.solid(LinearSegment, &self.mesh(segments)?, material)
    }
}

fn on_a_line(laid: &Laid<'_, 1>) -> Parts {
    match &laid.body.simplices {
        Simplices::Segments(segments) => Ok(vec![Part::BarOnALine(laid.bar(segments)?)]),
        _ => Err(AssemblyError::Dimension { scene: 1, asked: 2 }),
    }
}

fn in_the_plane(laid: &Laid<'_, 2>) -> Parts {
    let triangles = match &laid.body.simplices {
        Simplices::Segments(segments) => return Ok(vec![Part::BarInThePlane(laid.bar(segments)?)]),
        Simplices::Triangles(triangles) => triangles,
        Simplices::Tetrahedra(_) => return Err(AssemblyError::Dimension { scene: 2, asked: 3 }),
    };
    let (mesh, lame) = (laid.mesh(triangles)?, laid.body.lame.plane_stress());
    Ok(vec![match laid.body.material {
        ElasticMaterial::SaintVenantKirchhoff => {
            Part::Sheet(laid.solid(LinearTriangle, &mesh, SaintVenantKirchhoff::new(lame))?)
        }
        ElasticMaterial::NeoHookean => {
            Part::NeoHookeanSheet(laid.solid(LinearTriangle, &mesh, NeoHookean::new(lame)?)?)
        }
        ElasticMaterial::FixedCorotated => {
            Part::CorotatedSheet(laid.solid(LinearTriangle, &mesh, FixedCorotated::new(lame)?)?)
        }
        ElasticMaterial::Linear => {
            Part::LinearSheet(laid.solid(LinearTriangle, &mesh, Linear::new(lame))?)
        }
    }])
}

fn in_space(laid: &Laid<'_, 3>) -> Parts {
    let tetrahedra = match &laid.body.simplices {
        Simplices::Segments(segments) => return Ok(vec![Part::BarInSpace(laid.bar(segments)?)]),
        Simplices::Triangles(triangles) => return membrane(laid, triangles),
        Simplices::Tetrahedra(tetrahedra) => tetrahedra,
    };
    let (mesh, lame) = (laid.mesh(tetrahedra)?, laid.body.lame);
    Ok(vec![match laid.body.material {
        ElasticMaterial::SaintVenantKirchhoff => {
            Part::Block(laid.solid(LinearTetrahedron, &mesh, SaintVenantKirchhoff::new(lame))?)
        }
        ElasticMaterial::NeoHookean => {
            Part::NeoHookeanBlock(laid.solid(LinearTetrahedron, &mesh, NeoHookean::new(lame)?)?)
        }
        ElasticMaterial::FixedCorotated => Part::CorotatedBlock(laid.solid(
            LinearTetrahedron,
            &mesh,
            FixedCorotated::new(lame)?,
        )?),
        ElasticMaterial::Linear => {
            Part::LinearBlock(laid.solid(LinearTetrahedron, &mesh, Linear::new(lame))?)
        }
    }])
}

/// A sheet in space, which stretches, and bends where that costs something.
fn membrane(laid: &Laid<'_, 3>, triangles: &[[usize; 3]]) -> Parts {
    let mesh = laid.mesh(triangles)?;
    let material = SaintVenantKirchhoff::new(laid.body.lame.plane_stress());
    let mut parts = vec![Part::Membrane(laid.solid(LinearTriangle, &mesh, material)?)];
    if let Some(bending) = laid.body.bending {
        let fixed = laid.rest[laid.vertices.free..].iter().map(|&x| x.into()).collect();
        parts.push(Part::Folds(Stencils::new(laid.vertices.free, fixed, hinges(&mesh, bending)?)?));
    }
    Ok(parts)
}
