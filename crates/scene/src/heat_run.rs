//! A run of heat: step after step to the horizon, on the lumped mass.
//!
//! ```text
//! H = int f,   V = 1/2 int |grad f|^2          content of heat, Dirichlet energy             (15.1)
//! ```

use std::ops::ControlFlow;

use nalgebra::SVector;
use stationary_calculus::Potential;
use stationary_integrators::Cost;
use stationary_laplacian::{Domain, Elements, Heat, LaplacianError};
use stationary_mesh::Mesh;

use crate::heat::HeatedBody;
use crate::observable::Moment;
use crate::run::{Progress, Run, Samples};
use crate::shape::Simplices;
use crate::system::leading;
use crate::{AssemblyError, RunError, Scene, Stepping};

impl Scene {
    /// Runs a scene of heat to its horizon, or until the watcher breaks off.
    pub(crate) fn run_heat(
        &self,
        body: &HeatedBody,
        watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        match (&body.simplices, self.dimension) {
            (Simplices::Segments(all), 1) => self.flow(body, self.elements::<1, 2>(all)?, watch),
            (Simplices::Segments(all), 2) => self.flow(body, self.elements::<2, 2>(all)?, watch),
            (Simplices::Segments(all), _) => self.flow(body, self.elements::<3, 2>(all)?, watch),
            (Simplices::Triangles(all), 2) => self.flow(body, self.elements::<2, 3>(all)?, watch),
            (Simplices::Triangles(all), _) => self.flow(body, self.elements::<3, 3>(all)?, watch),
            (Simplices::Tetrahedra(all), _) => self.flow(body, self.elements::<3, 4>(all)?, watch),
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
        mut watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        let Stepping::Heat(method) = self.stepping else {
            return Err(AssemblyError::Heat.into());
        };
        let held: Vec<(usize, f64)> =
            (0..body.held.len()).filter(|&v| body.held[v]).map(|v| (v, body.start[v])).collect();
        let shares = Domain::free(elements.clone()).and_then(|all| all.lumped());
        let shares = shares.map_err(AssemblyError::from)?;
        let domain = Domain::held(elements, &held).map_err(AssemblyError::from)?;
        let mass = domain.lumped().map_err(AssemblyError::from)?;
        let mut f = domain.on_freedoms(&body.start).map_err(AssemblyError::from)?;
        let h = self.timing.stepping().step();
        let heat = Heat::new(&mass, domain.dirichlet(), method, body.diffusivity, h);
        let mut heat = heat.map_err(AssemblyError::from)?;

        let mut samples =
            Recorder { scene: self, shares: shares.masses(), samples: self.no_samples() };
        let energy = |f: &[f64]| domain.dirichlet().energy(f);
        samples.take(0.0, &body.start, energy(&f));
        let (steps, every) = (self.timing.steps(), self.timing.sample_every());
        let mut cost = Cost::default();
        for step in 1..=steps {
            let time = self.timing.stepping().time(step);
            if let Err(error) = heat.step(&mut f) {
                let run = Run::quiet(self, samples.samples, cost);
                let from = self.timing.stepping().time(step - 1);
                return Err(run.stopped(step, from, error.into()));
            }
            cost.steps += 1;
            cost.differentials += 1;
            let flow = watch(Progress { step, steps, time, q: &f });
            if step % every == 0 || step == steps || flow.is_break() {
                let values = domain.on_vertices(&f).map_err(AssemblyError::from)?;
                samples.take(time, &values, energy(&f));
            }
            if flow.is_break() {
                break;
            }
        }
        Ok(Run::quiet(self, samples.samples, cost))
    }
}

/// Takes samples of temperatures.
struct Recorder<'a> {
    scene: &'a Scene,
    shares: &'a [f64],
    samples: Samples,
}

impl Recorder<'_> {
    fn take(&mut self, time: f64, temperatures: &[f64], energy: f64) {
        let positions: Vec<[f64; 3]> = self.scene.particles.iter().map(|p| p.position).collect();
        let moment = Moment {
            potential: energy,
            positions: &positions,
            temperatures,
            heat: self.shares.iter().zip(temperatures).map(|(m, f)| m * f).sum(),
            ..Moment::default()
        };
        self.samples.push(self.scene, time, &moment, [0.0; 2]);
    }
}
