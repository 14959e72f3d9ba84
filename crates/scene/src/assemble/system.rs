//! The mechanical system of a scene: only what the scene names is built.
//!
//! ```text
//! M = diag(m_i)     V = uniform gravity + Newtonian gravity + springs + elastic bodies + touch
//! ```
//! Particles that are free come first, in the scene's order, D freedoms each; pinned ones have no
//! freedoms and are the fixed vertices of the springs. What is hung starts where V is lowest while
//! it is held.

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_integrators::problems::Problem;
use stationary_integrators::{NewtonianGravity, State, UniformGravity};

use crate::assemble::contacts::Penalty;
use crate::assemble::elastic::ElasticBodies;
use crate::assemble::rest;
use crate::assemble::springs::Springs;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::error::AssemblyError;
use crate::words::particles::Motion;

/// The potential of a scene. Its springs, elastic bodies and springs of touch may be none.
#[derive(Clone, Debug)]
pub struct ScenePotential<const D: usize> {
    parts: Parts<D>,
    pub(crate) built: Built,
}

type Parts<const D: usize> = (Weight<D>, (Springs<D>, Option<Penalty<D>>), ElasticBodies);
type Weight<const D: usize> = (Option<UniformGravity<D>>, Option<NewtonianGravity<D>>);

/// A scene as a problem: a system, where it starts, and for how long.
pub type SceneProblem<const D: usize> =
    Problem<DiagonalMetric<Vec<f64>>, ScenePotential<D>, Vec<f64>>;

impl<const D: usize> Potential for ScenePotential<D> {
    fn dim(&self) -> usize {
        self.parts.dim()
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        self.parts.energy(q)
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.parts.add_differential(q, dv);
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.parts.add_hessian(q, hessian);
    }
}

/// The order of the particles as vertices: the free ones first, each part in the scene's order.
#[derive(Clone, Debug)]
pub(crate) struct Vertices {
    /// The vertex of each particle.
    pub(crate) of_particle: Vec<usize>,
    /// The particle of each vertex.
    pub(crate) particles: Vec<usize>,
    /// The number of free ones.
    pub(crate) free: usize,
}

impl Vertices {
    pub(crate) fn new(scene: &Scene) -> Self {
        let all = || 0..scene.particles.len();
        let pinned = |&particle: &usize| scene.particles[particle].motion == Motion::Pinned;
        let mut particles: Vec<usize> = all().filter(|particle| !pinned(particle)).collect();
        let free = particles.len();
        particles.extend(all().filter(pinned));
        let mut of_particle = vec![0; particles.len()];
        for (vertex, &particle) in particles.iter().enumerate() {
            of_particle[particle] = vertex;
        }
        Vertices { of_particle, particles, free }
    }
}

/// Whether full matrices are factored, not sparse ones.
pub(crate) fn few(freedoms: usize) -> bool {
    freedoms <= 32
}

/// The first D components, D <= 3.
pub(crate) fn leading<const D: usize>(x: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|c| x.get(c).copied().unwrap_or(0.0))
}

impl Scene {
    /// The scene as a problem of its dimension D, called `scene`: without drag and rods, which are
    /// no part of a metric or a potential. It knows no true solution, and
    /// its period is its horizon; its scale is the largest distance from the middle.
    ///
    /// # Errors
    /// [`AssemblyError::Bodies`], [`AssemblyError::Heat`] and [`AssemblyError::Dimension`] where
    /// the scene is of another kind or dimension; [`AssemblyError::Metric`] and
    /// [`AssemblyError::Elasticity`] for masses, elements and materials that cannot be;
    /// [`AssemblyError::Equilibrium`], [`AssemblyError::Modal`] and [`AssemblyError::Sparse`] where
    /// no rest is found of what is hung.
    pub fn problem<const D: usize>(&self) -> Result<SceneProblem<D>, AssemblyError> {
        if !self.bodies.is_empty() {
            return Err(AssemblyError::Bodies);
        }
        if self.heat.is_some() {
            return Err(AssemblyError::Heat);
        }
        if D != self.dimension {
            return Err(AssemblyError::Dimension { scene: self.dimension, asked: D });
        }
        let vertices = Vertices::new(self);
        let free = &vertices.particles[..vertices.free];
        let position = |&particle: &usize| leading::<D>(self.particles[particle].position);

        let (mut masses, mut momenta) = (Vec::new(), Vec::new());
        for &particle in free {
            if let Motion::Free { mass, momentum } = self.particles[particle].motion {
                masses.push(mass);
                momenta.extend(leading::<D>(momentum));
            }
        }
        let uniform = self.gravity.acceleration.map(|acceleration| UniformGravity {
            acceleration: leading::<D>(acceleration),
            masses: masses.clone(),
        });
        let newtonian = self
            .gravity
            .constant
            .map(|constant| NewtonianGravity { constant, masses: masses.clone() });
        let mut built = Built::default();
        let springs = self.springs::<D>(&vertices, &mut built)?;
        let penalty = self.penalty(&mut built)?;
        let elastic = self.elastic_bodies::<D>(&vertices)?;
        elastic.count(&mut built);
        let q = match self.hung.as_slice() {
            [] => free.iter().flat_map(position).collect(),
            _ => self.hanging::<D>(&vertices, &mut built)?,
        };
        let parts = ((uniform, newtonian), (springs, penalty), elastic);
        let potential = ScenePotential { parts, built };
        Ok(Problem {
            name: "scene",
            system: System::new(DiagonalMetric::particles::<D>(&masses)?, potential)?,
            initial: State::new(q, Covector(momenta)),
            horizon: self.timing.horizon(),
            period: self.timing.horizon(),
            scale: self.scale(),
            solution: Box::new(|_| None),
            solution_error: f64::INFINITY,
        })
    }

    /// The configuration in which all is at rest while what is hung is held.
    fn hanging<const D: usize>(
        &self,
        vertices: &Vertices,
        built: &mut Built,
    ) -> Result<Vec<f64>, AssemblyError> {
        let mut held = Scene { hung: Vec::new(), ..self.clone() };
        for &particle in &self.hung {
            held.particles[particle].motion = Motion::Pinned;
        }
        let rest = rest::rest(&held.problem::<D>()?)?;
        *built = *built + rest.built;
        let x = rest.q;
        let of_held = Vertices::new(&held);
        let place = |&particle: &usize| {
            let vertex = of_held.of_particle[particle];
            match x.as_chunks::<D>().0.get(vertex) {
                Some(&place) => place,
                None => leading::<D>(held.particles[particle].position),
            }
        };
        Ok(vertices.particles[..vertices.free].iter().flat_map(place).collect())
    }

    /// The largest distance of a particle from the middle of all; one where that is zero.
    pub(crate) fn scale(&self) -> f64 {
        let count = self.particles.len() as f64;
        let middle: [f64; 3] = std::array::from_fn(|c| {
            self.particles.iter().map(|particle| particle.position[c] / count).sum()
        });
        let from_middle = |x: [f64; 3]| -> f64 {
            (0..3).map(|c| (x[c] - middle[c]) * (x[c] - middle[c])).sum::<f64>().sqrt()
        };
        let distances = self.particles.iter().map(|particle| from_middle(particle.position));
        let largest = distances.fold(0.0, f64::max);
        if largest > 0.0 && largest.is_finite() { largest } else { 1.0 }
    }
}
