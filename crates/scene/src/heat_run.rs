//! A run of heat: step after step to the horizon, on the lumped mass.
//!
//! ```text
//! H = int f,   V = 1/2 int |grad f|^2          content of heat, Dirichlet energy             (15.1)
//! ```

use nalgebra::SVector;
use stationary_calculus::{DiagonalMetric, Potential};
use stationary_integrators::{Saved, State, StepReport};
use stationary_laplacian::{Domain, Elements, Heat, LaplacianError};
use stationary_mesh::Mesh;

use crate::checkpoint::{Before, CheckpointError};
use crate::error::StepFailure;
use crate::heat::HeatedBody;
use crate::march::{Moving, Watcher, march};
use crate::observable::Moment;
use crate::run::{BrokenRod, Run, Samples};
use crate::shape::Simplices;
use crate::stepper::Stepped;
use crate::system::leading;
use crate::{AssemblyError, Checkpoint, RunError, Scene, Stepping};

impl Scene {
    /// Runs a scene of heat to its horizon, or until the watcher breaks off.
    pub(crate) fn run_heat(
        &self,
        body: &HeatedBody,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        match (&body.simplices, self.dimension) {
            (Simplices::Segments(all), 1) => {
                self.flow(body, self.elements::<1, 2>(all)?, checkpoint, watcher)
            }
            (Simplices::Segments(all), 2) => {
                self.flow(body, self.elements::<2, 2>(all)?, checkpoint, watcher)
            }
            (Simplices::Segments(all), _) => {
                self.flow(body, self.elements::<3, 2>(all)?, checkpoint, watcher)
            }
            (Simplices::Triangles(all), 2) => {
                self.flow(body, self.elements::<2, 3>(all)?, checkpoint, watcher)
            }
            (Simplices::Triangles(all), _) => {
                self.flow(body, self.elements::<3, 3>(all)?, checkpoint, watcher)
            }
            (Simplices::Tetrahedra(all), _) => {
                self.flow(body, self.elements::<3, 4>(all)?, checkpoint, watcher)
            }
        }
    }

    fn elements<const D: usize, const K: usize>(
        &self,
        simplices: &[[usize; K]],
    ) -> Result<Elements<K>, AssemblyError>
    where
        [usize; K]: stationary_mesh::Simplex,
    {
        let place = |particle: &crate::Particle| -> SVector<f64, D> {
            leading::<D>(particle.position).into()
        };
        let places = self.particles.iter().map(place).collect();
        let mesh = Mesh::<D, K>::new(places, simplices.to_vec()).map_err(LaplacianError::from)?;
        Ok(Elements::of(&mesh)?)
    }

    fn flow<const K: usize>(
        &self,
        body: &HeatedBody,
        elements: Elements<K>,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        let Stepping::Heat(method) = self.stepping else {
            return Err(AssemblyError::Heat.into());
        };
        let held: Vec<(usize, f64)> =
            (0..body.held.len()).filter(|&v| body.held[v]).map(|v| (v, body.start[v])).collect();
        let made = || -> Result<_, LaplacianError> {
            let shares = Domain::free(elements.clone())?.lumped()?;
            let domain = Domain::held(elements, &held)?;
            let (mass, f) = (domain.lumped()?, domain.on_freedoms(&body.start)?);
            Ok((shares, domain, mass, f))
        };
        let (shares, domain, mass, f) = made().map_err(AssemblyError::from)?;
        let h = self.timing.stepping().step();
        let heat = Heat::new(&mass, domain.dirichlet(), method, body.diffusivity, h);
        let heat = heat.map_err(AssemblyError::from)?;
        let state = State::new(f, Vec::new());
        let flow = Flow { scene: self, shares: shares.masses(), domain: &domain, heat, state };
        march(self, flow, checkpoint, watcher)
    }
}

/// Heat on its way: temperatures for a configuration, and no momenta.
struct Flow<'a, const K: usize> {
    scene: &'a Scene,
    /// The length, area or volume that belongs to each vertex.
    shares: &'a [f64],
    domain: &'a Domain<K>,
    heat: Heat<'a, DiagonalMetric<Vec<f64>>>,
    state: State<Vec<f64>>,
}

impl<const K: usize> Moving for Flow<'_, K> {
    fn state(&self) -> &State<Vec<f64>> {
        &self.state
    }

    fn step(&mut self, _: f64, to: f64) -> Result<Stepped, StepFailure> {
        self.heat.step(&mut self.state.q)?;
        self.state.t = to;
        Ok(Stepped::done(StepReport { differentials: 1, ..StepReport::default() }))
    }

    fn sample(&mut self, time: f64, samples: &mut Samples) {
        // As many freedoms as the domain has.
        let Ok(temperatures) = self.domain.on_vertices(&self.state.q) else { return };
        let positions: Vec<[f64; 3]> = self.scene.particles.iter().map(|p| p.position).collect();
        let moment = Moment {
            potential: self.domain.dirichlet().energy(&self.state.q),
            positions: &positions,
            temperatures: &temperatures,
            heat: self.shares.iter().zip(&temperatures).map(|(m, f)| m * f).sum(),
            ..Moment::default()
        };
        samples.push(self.scene, time, &moment, [0.0; 2]);
    }

    fn broken(&self) -> &[BrokenRod] {
        &[]
    }

    fn failed(&self, step: u64, time: f64, source: StepFailure, run: Run) -> RunError {
        run.stopped(step, time, source)
    }

    fn save(&mut self) -> Option<Saved> {
        Some(Saved::default())
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.state.clone_from(&before.state);
        Ok(())
    }
}
