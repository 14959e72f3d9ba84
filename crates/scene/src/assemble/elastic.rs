//! The potential of a scene's elastic bodies: each of its own elements and material.
//!
//! ```text
//! V(q) = sum over bodies  V_body(q)        q all free particles of the scene
//! ```
//! The elements are numbered by the scene's vertices, so that springs, rods and several bodies may
//! hold one another by shared particles. What the elements are is known only when a file is read: each
//! kind has a word of its own here, so that its loops are compiled for it.

use std::borrow::Cow;

use nalgebra::SVector;
use stationary_calculus::{Covector, Potential, Sink, Stencil, Stencils};
use stationary_elasticity::{
    ElasticityError, Elements, FixedCorotated, Freedoms, Held, Hinge, Lame, Linear, LinearSegment,
    LinearTetrahedron, LinearTriangle, Material, NeoHookean, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle, Reference, SaintVenantKirchhoff, Solid, hinges,
};
use stationary_mesh::{Mesh, Quadratic, Simplex};

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::{Vertices, leading};
use crate::model::built::Built;
use crate::model::elastic_body::{ElasticBody, ElasticMaterial};
use crate::model::items::Stress;
use crate::model::scene::Scene;
use crate::model::simplices::{Simplices, with_middles};

type Bar<const D: usize> = Solid<SaintVenantKirchhoff<1>, 2, D, 1, 1>;
type QuadraticBar<const D: usize> = Solid<SaintVenantKirchhoff<1>, 3, D, 1, 2>;

/// Elements that fill their space, of one material.
#[derive(Clone, Debug)]
enum Filling<const N: usize, const D: usize, const Q: usize> {
    SaintVenantKirchhoff(Solid<SaintVenantKirchhoff<D>, N, D, D, Q>),
    NeoHookean(Solid<NeoHookean<D>, N, D, D, Q>),
    FixedCorotated(Solid<FixedCorotated<D>, N, D, D, Q>),
    Linear(Solid<Linear<D>, N, D, D, Q>),
}

/// The same for elements of every material.
macro_rules! of_each_material {
    ($filling:expr, $elements:ident => $same:expr) => {
        match $filling {
            Filling::SaintVenantKirchhoff($elements) => $same,
            Filling::NeoHookean($elements) => $same,
            Filling::FixedCorotated($elements) => $same,
            Filling::Linear($elements) => $same,
        }
    };
}

impl<const N: usize, const D: usize, const Q: usize> Potential for Filling<N, D, Q> {
    fn dim(&self) -> usize {
        of_each_material!(self, elements => elements.dim())
    }

    fn energy(&self, q: &[f64]) -> f64 {
        of_each_material!(self, elements => elements.energy(q))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        of_each_material!(self, elements => elements.add_differential(q, dv));
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        of_each_material!(self, elements => elements.add_hessian(q, hessian));
    }
}

/// Elements of one kind.
#[derive(Clone, Debug)]
enum Part {
    BarOnALine(Bar<1>),
    BarInThePlane(Bar<2>),
    BarInSpace(Bar<3>),
    QuadraticBarOnALine(QuadraticBar<1>),
    QuadraticBarInThePlane(QuadraticBar<2>),
    QuadraticBarInSpace(QuadraticBar<3>),
    Sheet(Filling<3, 2, 1>),
    QuadraticSheet(Filling<6, 2, 3>),
    Membrane(Solid<SaintVenantKirchhoff<2>, 3, 3, 2, 1>),
    QuadraticMembrane(Solid<SaintVenantKirchhoff<2>, 6, 3, 2, 3>),
    Folds(Stencils<Hinge, 4, 3>),
    Block(Filling<4, 3, 1>),
    QuadraticBlock(Filling<10, 3, 4>),
}

/// The same for elements of every kind.
macro_rules! each {
    ($part:expr, $elements:ident => $same:expr) => {
        match $part {
            Part::BarOnALine($elements) => $same,
            Part::BarInThePlane($elements) => $same,
            Part::BarInSpace($elements) => $same,
            Part::QuadraticBarOnALine($elements) => $same,
            Part::QuadraticBarInThePlane($elements) => $same,
            Part::QuadraticBarInSpace($elements) => $same,
            Part::Sheet($elements) => $same,
            Part::QuadraticSheet($elements) => $same,
            Part::Membrane($elements) => $same,
            Part::QuadraticMembrane($elements) => $same,
            Part::Folds($elements) => $same,
            Part::Block($elements) => $same,
            Part::QuadraticBlock($elements) => $same,
        }
    };
}

/// All elastic bodies of a scene; there may be none.
#[derive(Clone, Debug)]
pub(crate) struct ElasticBodies {
    freedoms: usize,
    parts: Vec<Part>,
}

/// Elements that are counted where they are made, and asked for their stress.
trait Counted {
    fn count(&self, built: &mut Built);

    /// Appends the stress of each of them; NaN for a configuration of another size.
    fn append_stresses(&self, q: &[f64], stresses: &mut Vec<Stress>);
}

/// The components of a symmetric matrix of up to three dimensions.
fn components<const D: usize>(sigma: &[[f64; D]; D]) -> Stress {
    let entry = |i: usize, j: usize| sigma.get(j).and_then(|column| column.get(i)).copied();
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|(i, j)| entry(i, j).unwrap_or(0.0))
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Counted
    for Solid<M, N, D, R, Q>
{
    fn count(&self, built: &mut Built) {
        built.elements += self.elements() as u64;
    }

    fn append_stresses(&self, q: &[f64], stresses: &mut Vec<Stress>) {
        match self.stresses(q) {
            Ok(all) => stresses.extend(all.iter().map(components)),
            Err(_) => stresses.resize(stresses.len() + self.elements(), [f64::NAN; 6]),
        }
    }
}

impl<const N: usize, const D: usize, const Q: usize> Counted for Filling<N, D, Q> {
    fn count(&self, built: &mut Built) {
        of_each_material!(self, elements => elements.count(built));
    }

    fn append_stresses(&self, q: &[f64], stresses: &mut Vec<Stress>) {
        of_each_material!(self, elements => elements.append_stresses(q, stresses));
    }
}

impl Counted for Stencils<Hinge, 4, 3> {
    fn count(&self, built: &mut Built) {
        built.hinges += self.stencils().len() as u64;
    }

    fn append_stresses(&self, _: &[f64], _: &mut Vec<Stress>) {}
}

impl ElasticBodies {
    /// Counts the elements.
    pub(crate) fn count(&self, built: &mut Built) {
        for part in &self.parts {
            each!(part, elements => elements.count(built));
        }
    }

    /// Cauchy's stress of every element, body after body.
    pub(crate) fn stresses(&self, q: &[f64]) -> Vec<Stress> {
        let mut stresses = Vec::new();
        for part in &self.parts {
            each!(part, elements => elements.append_stresses(q, &mut stresses));
        }
        stresses
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

/// Which elements of a body are laid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    All,
    /// Those without vertices that move as they are told.
    Still,
    /// Those with such vertices.
    Moved,
}

/// A body and what it is laid into.
struct Laid<'a, const D: usize> {
    body: &'a ElasticBody,
    /// The same with all elements.
    whole: &'a ElasticBody,
    /// Whether what has these vertices belongs to it.
    keeps: &'a dyn Fn(&[usize]) -> bool,
    freedoms: &'a Freedoms<D>,
    /// Where every vertex of the scene is when the body is at rest.
    rest: Vec<SVector<f64, D>>,
    vertices: &'a Vertices,
}

impl Scene {
    /// The elastic bodies of the scene.
    pub(crate) fn elastic_bodies<const D: usize>(
        &self,
        which: Which,
        vertices: &Vertices,
    ) -> Result<ElasticBodies, AssemblyError> {
        let of = (self.solids.as_slice(), which);
        let parts = match D {
            _ if self.solids.is_empty() => Vec::new(),
            1 => self.laid(of, vertices, on_a_line)?,
            2 => self.laid(of, vertices, in_the_plane)?,
            _ => self.laid(of, vertices, in_space)?,
        };
        Ok(ElasticBodies { freedoms: D * vertices.free, parts })
    }

    /// The elements of a body that have moving vertices, where there are any.
    pub(crate) fn moved_part(
        &self,
        body: &ElasticBody,
        vertices: &Vertices,
    ) -> Result<Option<ElasticBodies>, AssemblyError> {
        let of = (std::slice::from_ref(body), Which::Moved);
        let parts = match self.dimension {
            1 => self.laid(of, vertices, on_a_line)?,
            2 => self.laid(of, vertices, in_the_plane)?,
            _ => self.laid(of, vertices, in_space)?,
        };
        let freedoms = self.dimension * vertices.free;
        Ok((!parts.is_empty()).then_some(ElasticBodies { freedoms, parts }))
    }

    fn laid<const D: usize>(
        &self,
        (bodies, which): (&[ElasticBody], Which),
        vertices: &Vertices,
        make: fn(&Laid<'_, D>) -> Parts,
    ) -> Parts {
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
        let mut moves = vec![false; self.particles.len()];
        self.drives.motions.iter().for_each(|motion| moves[motion.particle] = true);
        let moved = |nodes: &[usize]| nodes.iter().any(|&node| moves.get(node) == Some(&true));
        let keeps = |nodes: &[usize]| match which {
            Which::All => true,
            Which::Still => !moved(nodes),
            Which::Moved => moved(nodes),
        };
        let mut all = Vec::new();
        for whole in bodies {
            let mut body = Cow::Borrowed(whole);
            if which != Which::All && !self.drives.motions.is_empty() {
                body.to_mut().simplices = whole.simplices.kept(&whole.middles, keeps);
                if body.simplices.is_empty() {
                    continue;
                }
            }
            let mut rest: Vec<SVector<f64, D>> = places.iter().map(|&x| x.into()).collect();
            for (vertex, &x) in body.rest.iter().enumerate() {
                rest[vertices.of_particle[body.first + vertex]] = leading::<D>(x).into();
            }
            let (body, keeps) = (&*body, &keeps);
            all.extend(make(&Laid { body, whole, keeps, freedoms: &freedoms, rest, vertices })?);
        }
        Ok(all)
    }
}

impl<const D: usize> Laid<'_, D> {
    fn is_quadratic(&self) -> bool {
        !self.body.middles.is_empty()
    }

    fn mesh<const K: usize>(&self, simplices: &[[usize; K]]) -> Result<Mesh<D, K>, AssemblyError> {
        let of_particle = &self.vertices.of_particle;
        let corners = simplices.iter().map(|corners| corners.map(|corner| of_particle[corner]));
        Ok(Mesh::new(self.rest.clone(), corners.collect()).map_err(ElasticityError::from)?)
    }

    /// The same with the nodes in the middle of the edges.
    fn quadratic<const K: usize, const N: usize>(
        &self,
        simplices: &[[usize; K]],
    ) -> Result<Quadratic<D, K, N>, AssemblyError>
    where
        [usize; K]: Simplex,
    {
        // A node that is not there is a vertex that the elements refuse.
        let vertex =
            |node: usize| self.vertices.of_particle.get(node).copied().unwrap_or(usize::MAX);
        let elements = with_middles(simplices, &self.body.middles);
        let elements = elements.iter().map(|nodes| nodes.map(vertex)).collect();
        Ok(Quadratic::new(self.rest.clone(), elements).map_err(ElasticityError::from)?)
    }

    /// The body of these elements and this material.
    fn solid<F, M, const G: usize, const N: usize, const R: usize, const Q: usize>(
        &self,
        family: F,
        mesh: &impl Elements<G, N>,
        material: M,
    ) -> Result<Solid<M, N, D, R, Q>, AssemblyError>
    where
        F: Reference<N, R, Q>,
        M: Material<D, R>,
    {
        Ok(Solid::new(family, mesh, self.body.section, material, self.freedoms.clone())?)
    }

    /// The body of these elements that fill their space, with the parameters as they are there.
    fn filling<F, const N: usize, const Q: usize>(
        &self,
        family: F,
        mesh: &impl Elements<D, N>,
        lame: Lame<D>,
    ) -> Result<Filling<N, D, Q>, AssemblyError>
    where
        F: Reference<N, D, Q>,
    {
        Ok(match self.body.material {
            ElasticMaterial::SaintVenantKirchhoff => {
                let material = SaintVenantKirchhoff::new(lame);
                Filling::SaintVenantKirchhoff(self.solid(family, mesh, material)?)
            }
            ElasticMaterial::NeoHookean => {
                Filling::NeoHookean(self.solid(family, mesh, NeoHookean::new(lame)?)?)
            }
            ElasticMaterial::FixedCorotated => {
                Filling::FixedCorotated(self.solid(family, mesh, FixedCorotated::new(lame)?)?)
            }
            ElasticMaterial::Linear => {
                Filling::Linear(self.solid(family, mesh, Linear::new(lame))?)
            }
        })
    }

    /// Segments, free to thin where they are drawn out, made into a part as they are straight or
    /// have middles.
    fn bar(
        &self,
        segments: &[[usize; 2]],
        straight: fn(Bar<D>) -> Part,
        quadratic: fn(QuadraticBar<D>) -> Part,
    ) -> Parts {
        let material = SaintVenantKirchhoff::new(self.body.lame.uniaxial_stress());
        Ok(vec![if self.is_quadratic() {
            let elements = self.quadratic::<2, 3>(segments)?;
            quadratic(self.solid(QuadraticSegment, &elements, material)?)
        } else {
            straight(self.solid(LinearSegment, &self.mesh(segments)?, material)?)
        }])
    }
}

fn on_a_line(laid: &Laid<'_, 1>) -> Parts {
    match &laid.body.simplices {
        Simplices::Segments(segments) => {
            laid.bar(segments, Part::BarOnALine, Part::QuadraticBarOnALine)
        }
        _ => Err(AssemblyError::Dimension { scene: 1, asked: 2 }),
    }
}

fn in_the_plane(laid: &Laid<'_, 2>) -> Parts {
    let triangles = match &laid.body.simplices {
        Simplices::Segments(segments) => {
            return laid.bar(segments, Part::BarInThePlane, Part::QuadraticBarInThePlane);
        }
        Simplices::Triangles(triangles) => triangles,
        Simplices::Tetrahedra(_) => return Err(AssemblyError::Dimension { scene: 2, asked: 3 }),
    };
    let lame = laid.body.lame.plane_stress();
    Ok(vec![if laid.is_quadratic() {
        let elements = laid.quadratic::<3, 6>(triangles)?;
        Part::QuadraticSheet(laid.filling(QuadraticTriangle, &elements, lame)?)
    } else {
        Part::Sheet(laid.filling(LinearTriangle, &laid.mesh(triangles)?, lame)?)
    }])
}

fn in_space(laid: &Laid<'_, 3>) -> Parts {
    let tetrahedra = match &laid.body.simplices {
        Simplices::Segments(segments) => {
            return laid.bar(segments, Part::BarInSpace, Part::QuadraticBarInSpace);
        }
        Simplices::Triangles(triangles) => return membrane(laid, triangles),
        Simplices::Tetrahedra(tetrahedra) => tetrahedra,
    };
    Ok(vec![if laid.is_quadratic() {
        let elements = laid.quadratic::<4, 10>(tetrahedra)?;
        Part::QuadraticBlock(laid.filling(QuadraticTetrahedron, &elements, laid.body.lame)?)
    } else {
        Part::Block(laid.filling(LinearTetrahedron, &laid.mesh(tetrahedra)?, laid.body.lame)?)
    }])
}

/// A sheet in space, which stretches, and bends where that costs something.
fn membrane(laid: &Laid<'_, 3>, triangles: &[[usize; 3]]) -> Parts {
    let material = SaintVenantKirchhoff::new(laid.body.lame.plane_stress());
    if laid.is_quadratic() {
        let elements = laid.quadratic::<3, 6>(triangles)?;
        let membrane = laid.solid(QuadraticTriangle, &elements, material)?;
        return Ok(vec![Part::QuadraticMembrane(membrane)]);
    }
    let mesh = laid.mesh(triangles)?;
    let mut parts = vec![Part::Membrane(laid.solid(LinearTriangle, &mesh, material)?)];
    if let (Some(bending), Simplices::Triangles(whole)) = (laid.body.bending, &laid.whole.simplices)
    {
        let fixed = laid.rest[laid.vertices.free..].iter().map(|&x| x.into()).collect();
        // A fold lies between two triangles, of which one alone may be laid.
        let mut folds = hinges(&laid.mesh(whole)?, bending)?;
        let particles = &laid.vertices.particles;
        folds.retain(|fold| (laid.keeps)(&fold.vertices().map(|vertex| particles[vertex])));
        parts.push(Part::Folds(Stencils::new(laid.vertices.free, fixed, folds)?));
    }
    Ok(parts)
}
