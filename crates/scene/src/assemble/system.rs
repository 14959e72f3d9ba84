//! The mechanical system of a scene: only what the scene names is built.
//!
//! ```text
//! M = diag(m_i)     V = uniform gravity + Newtonian gravity + springs + elastic bodies + touch
//! ```
//! Particles that are free come first, in the scene's order, D freedoms each; pinned ones have no
//! freedoms and are the fixed vertices of the springs. What is hung starts where V is lowest while
//! it is held.

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System, array};
use stationary_integrators::problems::Problem;
use stationary_integrators::{NewtonianGravity, State, UniformGravity};

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::{Vertices, leading};
use crate::model::built::Built;
#[cfg(feature = "modal")]
use crate::model::drives::Drives;
use crate::model::particle::Motion;
use crate::model::scene::Scene;

#[cfg(feature = "contact")]
use crate::assemble::contacts::Penalty;
#[cfg(feature = "elasticity")]
use crate::assemble::elastic::{ElasticBodies, Which};
#[cfg(feature = "modal")]
use crate::assemble::rest;
#[cfg(feature = "elasticity")]
use crate::assemble::springs::Springs;

/// The potential of a scene. Its springs, elastic bodies and springs of touch may be none.
///
/// It knows its dimension when it is asked, so that every method is compiled once.
#[derive(Clone, Debug)]
pub struct ScenePotential(Dimensioned);

#[derive(Clone, Debug)]
enum Dimensioned {
    OnALine(PotentialIn<1>),
    InThePlane(PotentialIn<2>),
    InSpace(PotentialIn<3>),
}

/// The same in D dimensions.
#[derive(Clone, Debug)]
struct PotentialIn<const D: usize> {
    freedoms: usize,
    weight: Weight<D>,
    #[cfg(feature = "elasticity")]
    springs: Springs<D>,
    #[cfg(feature = "contact")]
    penalty: Option<Penalty<D>>,
    #[cfg(feature = "elasticity")]
    elastic: ElasticBodies,
    built: Built,
}

type Weight<const D: usize> = (Option<UniformGravity<D>>, Option<NewtonianGravity<D>>);

/// A scene as a problem: a system, where it starts, and for how long.
pub type SceneProblem = Problem<DiagonalMetric<Vec<f64>>, ScenePotential, Vec<f64>>;

macro_rules! in_its_dimension {
    ($potential:expr, $of:ident => $asked:expr) => {
        match &$potential.0 {
            Dimensioned::OnALine($of) => $asked,
            Dimensioned::InThePlane($of) => $asked,
            Dimensioned::InSpace($of) => $asked,
        }
    };
}

impl ScenePotential {
    /// What was built for it.
    pub(crate) fn built(&self) -> Built {
        in_its_dimension!(self, of => of.built)
    }
}

impl Potential for ScenePotential {
    fn dim(&self) -> usize {
        in_its_dimension!(self, of => of.freedoms)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        in_its_dimension!(self, of => of.energy(q))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        in_its_dimension!(self, of => of.add_differential(q, dv))
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        in_its_dimension!(self, of => of.add_hessian(q, hessian))
    }
}

impl<const D: usize> PotentialIn<D> {
    fn energy(&self, q: &[f64]) -> f64 {
        #[cfg(not(feature = "elasticity"))]
        let bonds = 0.0;
        #[cfg(feature = "elasticity")]
        let bonds = self.springs.energy(q);
        #[cfg(feature = "contact")]
        let bonds = bonds + self.penalty.energy(q);
        let energy = self.weight.energy(q) + bonds;
        #[cfg(feature = "elasticity")]
        let energy = energy + self.elastic.energy(q);
        energy
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let mut dv = dv;
        self.weight.add_differential(q, dv.view_mut());
        #[cfg(feature = "elasticity")]
        self.springs.add_differential(q, dv.view_mut());
        #[cfg(feature = "contact")]
        self.penalty.add_differential(q, dv.view_mut());
        #[cfg(feature = "elasticity")]
        self.elastic.add_differential(q, dv.view_mut());
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.weight.add_hessian(q, hessian);
        #[cfg(feature = "elasticity")]
        self.springs.add_hessian(q, hessian);
        #[cfg(feature = "contact")]
        self.penalty.add_hessian(q, hessian);
        #[cfg(feature = "elasticity")]
        self.elastic.add_hessian(q, hessian);
    }
}

impl Scene {
    /// The scene as a problem, called `scene`: without drag, what is driven and rods,
    /// which are no part of a metric or a potential. It knows no true solution, and
    /// its period is its horizon; its scale is the largest distance from the middle.
    ///
    /// # Errors
    /// [`AssemblyError::Bodies`] and [`AssemblyError::Heat`] where the scene is of another kind;
    /// [`AssemblyError::Metric`] and
    /// [`AssemblyError::Elasticity`] for masses, elements and materials that cannot be;
    /// [`AssemblyError::Equilibrium`], [`AssemblyError::Modal`] and [`AssemblyError::Sparse`] where
    /// no rest is found of what is hung.
    pub fn problem(&self) -> Result<SceneProblem, AssemblyError> {
        if !self.bodies.is_empty() {
            return Err(AssemblyError::Bodies);
        }
        if self.heat.is_some() {
            return Err(AssemblyError::Heat);
        }
        match self.dimension {
            1 => self.problem_in(Dimensioned::OnALine),
            2 => self.problem_in(Dimensioned::InThePlane),
            _ => self.problem_in(Dimensioned::InSpace),
        }
    }

    fn problem_in<const D: usize>(
        &self,
        of: fn(PotentialIn<D>) -> Dimensioned,
    ) -> Result<SceneProblem, AssemblyError> {
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
        let uniform = self.steady_gravity().map(|acceleration| UniformGravity {
            acceleration: leading::<D>(acceleration),
            masses: masses.clone(),
        });
        let fixed = || {
            let place = |pin: usize| leading::<D>(self.particles[pin].position);
            self.still_attractors().map(|(pin, mass)| (mass, place(pin))).collect()
        };
        let newtonian = self.gravity.constant.map(|constant| NewtonianGravity {
            constant,
            masses: masses.clone(),
            fixed: fixed(),
        });
        #[cfg_attr(
            not(any(feature = "contact", feature = "elasticity", feature = "modal")),
            expect(unused_mut)
        )]
        let mut built = Built::default();
        #[cfg(feature = "elasticity")]
        let springs = self.springs::<D>(&vertices, &mut built)?;
        #[cfg(feature = "contact")]
        let penalty = self.penalty(&mut built)?;
        #[cfg(feature = "elasticity")]
        let elastic = self.elastic_bodies::<D>(Which::Still, &vertices)?;
        #[cfg(feature = "elasticity")]
        elastic.count(&mut built);
        let q = match self.hung.as_slice() {
            [] => free.iter().flat_map(position).collect(),
            #[cfg(feature = "modal")]
            _ => self.hanging::<D>(&vertices, &mut built)?,
            #[cfg(not(feature = "modal"))]
            _ => return Err(AssemblyError::NotCompiled("hung")),
        };
        let potential = PotentialIn {
            freedoms: D * free.len(),
            weight: (uniform, newtonian),
            #[cfg(feature = "elasticity")]
            springs,
            #[cfg(feature = "contact")]
            penalty,
            #[cfg(feature = "elasticity")]
            elastic,
            built,
        };
        let (metric, potential) =
            (DiagonalMetric::particles::<D>(&masses)?, ScenePotential(of(potential)));
        Ok(Problem {
            name: "scene",
            system: System::new(metric, potential)?,
            initial: State::new(q, Covector(momenta)),
            horizon: self.timing.horizon(),
            period: self.timing.horizon(),
            scale: self.scale(),
            solution: Box::new(|_| None),
            solution_error: f64::INFINITY,
        })
    }

    #[cfg(feature = "modal")]
    /// The configuration in which all is at rest while what is hung is held.
    fn hanging<const D: usize>(
        &self,
        vertices: &Vertices,
        built: &mut Built,
    ) -> Result<Vec<f64>, AssemblyError> {
        // Pins that move are where they start.
        let drives = Drives { motions: Vec::new(), ..self.drives.clone() };
        let mut held = Scene { hung: Vec::new(), drives, ..self.clone() };
        for &particle in &self.hung {
            held.particles[particle].motion = Motion::Pinned;
        }
        let held_problem = held.problem()?;
        let system = &held_problem.system;
        let start = &held_problem.initial.q;
        let rest = rest::rest::<D>(system.metric(), system.potential(), start, held_problem.scale)?;
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
        let middle: [f64; 3] =
            array(|c| self.particles.iter().map(|particle| particle.position[c] / count).sum());
        let from_middle = |x: [f64; 3]| -> f64 {
            (0..3).map(|c| (x[c] - middle[c]) * (x[c] - middle[c])).sum::<f64>().sqrt()
        };
        let distances = self.particles.iter().map(|particle| from_middle(particle.position));
        let largest = distances.fold(0.0, f64::max);
        if largest > 0.0 && largest.is_finite() { largest } else { 1.0 }
    }
}
