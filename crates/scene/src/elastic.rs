//! The potential of a scene's elastic bodies: each of its own elements and material.
//!
//! ```text
//! V(q) = sum over bodies  V_body(q)        q all free particles of the scene
//! ```
//! The elements are numbered by the scene's vertices, so that springs, rods and several bodies may
//! hold one another by shared particles. What the elements are is known only when a file is read: a
//! body stands behind a pointer, and a Hessian's block passes one call that cannot be foreseen.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::SVector;
use stationary_calculus::{Covector, Potential, Sink, Stencils};
use stationary_elasticity::{
    ElasticityError, FixedCorotated, Freedoms, Held, Linear, LinearSegment, LinearTetrahedron,
    LinearTriangle, Material, NeoHookean, Reference, SaintVenantKirchhoff, Solid, hinges,
};
use stationary_mesh::Mesh;

use crate::shape::Simplices;
use crate::system::{Vertices, leading};
use crate::{AssemblyError, ElasticBody, ElasticMaterial, Scene};

/// A potential behind a pointer.
pub(crate) trait Elastic: Debug + Send + Sync {
    fn energy(&self, q: &[f64]) -> f64;
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>);
    fn add_hessian(&self, q: &[f64], hessian: &mut dyn Sink);
}

/// A sink behind a pointer.
struct Behind<'a>(&'a mut dyn Sink);

impl Sink for Behind<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        self.0.add_symmetric(freedoms, block);
    }
}

impl<P: Potential + Debug + Send + Sync> Elastic for P {
    fn energy(&self, q: &[f64]) -> f64 {
        Potential::energy(self, q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        Potential::add_differential(self, q, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut dyn Sink) {
        Potential::add_hessian(self, q, &mut Behind(hessian));
    }
}

/// All elastic bodies of a scene; there may be none.
#[derive(Clone, Debug)]
pub(crate) struct ElasticBodies {
    freedoms: usize,
    bodies: Vec<Arc<dyn Elastic>>,
}

impl Potential for ElasticBodies {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.bodies.iter().map(|body| body.energy(q)).sum()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        for body in &self.bodies {
            body.add_differential(q, dv.view_mut());
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for body in &self.bodies {
            body.add_hessian(q, hessian);
        }
    }
}

type Bodies = Result<Vec<Arc<dyn Elastic>>, AssemblyError>;

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
        let bodies = match D {
            _ if self.solids.is_empty() => Vec::new(),
            1 => self.laid(vertices, on_a_line)?,
            2 => self.laid(vertices, in_the_plane)?,
            _ => self.laid(vertices, in_space)?,
        };
        Ok(ElasticBodies { freedoms: D * vertices.free, bodies })
    }

    fn laid<const D: usize>(
        &self,
        vertices: &Vertices,
        make: fn(&Laid<'_, D>) -> Bodies,
    ) -> Bodies {
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
    ) -> Bodies
    where
        F: Reference<N, R, Q>,
        M: Material<D, R> + Debug + Send + Sync + 'static,
    {
        let solid = Solid::new(family, mesh, self.body.section, material, self.freedoms.clone())?;
        Ok(vec![Arc::new(solid)])
    }

    /// Segments, free to thin where they are drawn out.
    fn bar(&self, segments: &[[usize; 2]]) -> Bodies {
        let material = SaintVenantKirchhoff::new(self.body.lame.uniaxial_stress());
        self.solid(LinearSegment, &self.mesh(segments)?, material)
    }
}

fn on_a_line(laid: &Laid<'_, 1>) -> Bodies {
    match &laid.body.simplices {
        Simplices::Segments(segments) => laid.bar(segments),
        _ => Err(AssemblyError::Dimension { scene: 1, asked: 2 }),
    }
}

fn in_the_plane(laid: &Laid<'_, 2>) -> Bodies {
    let triangles = match &laid.body.simplices {
        Simplices::Segments(segments) => return laid.bar(segments),
        Simplices::Triangles(triangles) => triangles,
        Simplices::Tetrahedra(_) => return Err(AssemblyError::Dimension { scene: 2, asked: 3 }),
    };
    let (mesh, lame) = (laid.mesh(triangles)?, laid.body.lame.plane_stress());
    match laid.body.material {
        ElasticMaterial::SaintVenantKirchhoff => {
            laid.solid(LinearTriangle, &mesh, SaintVenantKirchhoff::new(lame))
        }
        ElasticMaterial::NeoHookean => laid.solid(LinearTriangle, &mesh, NeoHookean::new(lame)?),
        ElasticMaterial::FixedCorotated => {
            laid.solid(LinearTriangle, &mesh, FixedCorotated::new(lame)?)
        }
        ElasticMaterial::Linear => laid.solid(LinearTriangle, &mesh, Linear::new(lame)),
    }
}

fn in_space(laid: &Laid<'_, 3>) -> Bodies {
    let tetrahedra = match &laid.body.simplices {
        Simplices::Segments(segments) => return laid.bar(segments),
        Simplices::Triangles(triangles) => return membrane(laid, triangles),
        Simplices::Tetrahedra(tetrahedra) => tetrahedra,
    };
    let (mesh, lame) = (laid.mesh(tetrahedra)?, laid.body.lame);
    match laid.body.material {
        ElasticMaterial::SaintVenantKirchhoff => {
            laid.solid(LinearTetrahedron, &mesh, SaintVenantKirchhoff::new(lame))
        }
        ElasticMaterial::NeoHookean => laid.solid(LinearTetrahedron, &mesh, NeoHookean::new(lame)?),
        ElasticMaterial::FixedCorotated => {
            laid.solid(LinearTetrahedron, &mesh, FixedCorotated::new(lame)?)
        }
        ElasticMaterial::Linear => laid.solid(LinearTetrahedron, &mesh, Linear::new(lame)),
    }
}

/// A sheet in space, which stretches, and bends where that costs something.
fn membrane(laid: &Laid<'_, 3>, triangles: &[[usize; 3]]) -> Bodies {
    let mesh = laid.mesh(triangles)?;
    let material = SaintVenantKirchhoff::new(laid.body.lame.plane_stress());
    let mut parts = laid.solid(LinearTriangle, &mesh, material)?;
    if let Some(bending) = laid.body.bending {
        let fixed = laid.rest[laid.vertices.free..].iter().map(|&x| x.into()).collect();
        let folds = hinges(&mesh, bending)?;
        parts.push(Arc::new(Stencils::<_, 4, 3>::new(laid.vertices.free, fixed, folds)?));
    }
    Ok(parts)
}
