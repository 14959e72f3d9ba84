//! A run of heat: step after step to the horizon, or by its modes, on the lumped mass.
//!
//! ```text
//! H = int f,   V = 1/2 int |grad f|^2          content of heat, Dirichlet energy             (15.1)
//! f(t) = f* + sum_i v_i exp(-alpha lambda_i t) <v_i, M (f(0) - f*)>          by N modes     (15.2)
//! ```
//! `f*` what the held temperatures come to in the end, zero where nothing is held: then the
//! constant is among the modes, besides N others.

use nalgebra::SVector;
use stationary_calculus::{Covector, DiagonalMetric, Potential};
use stationary_integrators::{Saved, State, StepReport};
use stationary_laplacian::{
    Domain, Elements, ExactHeat, Heat, HeatMethod, LaplacianError, harmonic, largest_eigenvalue,
    lowest_modes,
};
use stationary_mesh::Mesh;
use stationary_modal::Modes;

use crate::assemble::system::leading;
use crate::model::built::Built;
use crate::model::observable::Moment;
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::StepFailure;
use crate::run::error::{AssemblyError, RunError};
use crate::run::march::{Moving, Watcher, march};
use crate::run::samples::{BrokenRod, Run, Samples};
use crate::run::steps::Stepped;
use crate::words::heat::HeatedBody;
use crate::words::integrator::Stepping;
use crate::words::shape::Simplices;

/// The same with the elements of a body of every shape.
macro_rules! of_each_shape {
    ($scene:expr, $body:expr, $elements:ident => $same:expr) => {
        match (&$body.simplices, $scene.dimension) {
            (Simplices::Segments(all), 1) => {
                let $elements = $scene.elements::<1, 2>(all);
                $same
            }
            (Simplices::Segments(all), 2) => {
                let $elements = $scene.elements::<2, 2>(all);
                $same
            }
            (Simplices::Segments(all), _) => {
                let $elements = $scene.elements::<3, 2>(all);
                $same
            }
            (Simplices::Triangles(all), 2) => {
                let $elements = $scene.elements::<2, 3>(all);
                $same
            }
            (Simplices::Triangles(all), _) => {
                let $elements = $scene.elements::<3, 3>(all);
                $same
            }
            (Simplices::Tetrahedra(all), _) => {
                let $elements = $scene.elements::<3, 4>(all);
                $same
            }
        }
    };
}

impl Scene {
    /// Runs a scene of heat to its horizon, or until the watcher breaks off.
    pub(crate) fn run_heat(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        let Some(body) = &self.heat else { return Err(AssemblyError::Heat.into()) };
        of_each_shape!(self, body, elements => self.flow(body, elements?, checkpoint, watcher))
    }

    /// The longest step at which a method is stable.
    pub(crate) fn stable_heat_step(
        &self,
        method: HeatMethod,
    ) -> Result<Option<f64>, AssemblyError> {
        let (Some(body), HeatMethod::ExplicitEuler) = (&self.heat, method) else {
            return Ok(None);
        };
        let largest = of_each_shape!(self, body, elements => {
            let domain = Domain::held(elements?, &body.held_values())?;
            largest_eigenvalue(&domain.lumped()?, domain.dirichlet())
        })?;
        Ok((largest > 0.0).then(|| 2.0 / (body.diffusivity * largest)))
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
        // Every particle of a heated body has a share of it.
        mesh.check_referenced().map_err(LaplacianError::from)?;
        Ok(Elements::of(&mesh)?)
    }

    fn flow<const K: usize>(
        &self,
        body: &HeatedBody,
        elements: Elements<K>,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        let held = body.held_values();
        let made = || -> Result<_, LaplacianError> {
            let shares = Domain::free(elements.clone())?.lumped()?;
            let domain = Domain::held(elements, &held)?;
            let (mass, f) = (domain.lumped()?, domain.on_freedoms(&body.start)?);
            Ok((shares, domain, mass, f))
        };
        let (shares, domain, mass, f) = made().map_err(AssemblyError::from)?;
        let state = State::new(f, Covector(Vec::new()));
        let (shares, alpha) = (shares.masses(), body.diffusivity);
        let built = Built { heated: body.simplices.len() as u64, ..Built::default() };
        let (domain, mass) = (&domain, &mass);
        match self.stepping {
            Stepping::Heat(method) => {
                let h = self.timing.stepping().step();
                let heat = Heat::new(mass, domain.dirichlet(), method, alpha, h);
                let heat = heat.map_err(AssemblyError::from)?;
                let implicit = method != HeatMethod::ExplicitEuler;
                let prepared = StepReport { hessians: implicit.into(), ..StepReport::default() };
                // A solve with the factor counts as a differential.
                let step =
                    StepReport { differentials: 1 + u32::from(implicit), ..StepReport::default() };
                let way = Way::Steps(Box::new(heat), step);
                let built = Built { sparse_solvers: implicit.into(), ..built };
                let flow = Flow { scene: self, shares, domain, way, prepared, built, state };
                march(self, flow, checkpoint, watcher)
            }
            Stepping::LinearModes { count } => {
                let known = Spectrum::of(domain, mass, count).map_err(AssemblyError::from)?;
                let exact = known.flow(mass, alpha, &state.q).map_err(AssemblyError::from)?;
                let (way, prepared) = (Way::Modes(exact, &known.steady), known.prepared());
                let built = built + known.built;
                let flow = Flow { scene: self, shares, domain, way, prepared, built, state };
                march(self, flow, checkpoint, watcher)
            }
            _ => Err(AssemblyError::Heat.into()),
        }
    }
}

impl HeatedBody {
    /// The vertices that are held, each with its temperature.
    fn held_values(&self) -> Vec<(usize, f64)> {
        let held = (0..self.held.len()).filter(|&vertex| self.held[vertex]);
        held.map(|vertex| (vertex, self.start[vertex])).collect()
    }
}

/// Heat on its way: temperatures for a configuration, and no momenta.
struct Flow<'a, const K: usize> {
    scene: &'a Scene,
    /// The length, area or volume that belongs to each vertex.
    shares: &'a [f64],
    domain: &'a Domain<K>,
    way: Way<'a>,
    prepared: StepReport,
    built: Built,
    state: State<Vec<f64>>,
}

/// How heat is moved.
enum Way<'a> {
    /// In steps, each of which counts this.
    Steps(Box<Heat<'a, DiagonalMetric<Vec<f64>>>>, StepReport),
    /// In closed form, about what it comes to in the end.
    Modes(ExactHeat<'a>, &'a [f64]),
}

/// The lowest modes of a domain, and what it comes to in the end.
struct Spectrum {
    modes: Modes,
    steady: Vec<f64>,
    built: Built,
}

impl Spectrum {
    /// The constant, where nothing is held, and `count` others.
    fn of<const K: usize>(
        domain: &Domain<K>,
        mass: &DiagonalMetric<Vec<f64>>,
        count: usize,
    ) -> Result<Self, LaplacianError> {
        let held = domain.dim() < domain.elements().vertices();
        let steady =
            if held { domain.on_freedoms(&harmonic(domain)?)? } else { vec![0.0; domain.dim()] };
        let constant = usize::from(!held);
        let modes = lowest_modes(domain, mass, count + constant)?;
        // One for the modes, and one for what it comes to where something is held.
        let sparse_solvers = 1 + u64::from(held);
        let built = Built { modes: modes.len() as u64, sparse_solvers, ..Built::default() };
        Ok(Spectrum { modes, steady, built })
    }

    fn prepared(&self) -> StepReport {
        let (solves, hessians) = (self.modes.solves() as u32, self.modes.factorizations() as u32);
        StepReport { differentials: solves, hessians, ..StepReport::default() }
    }

    fn flow(
        &self,
        mass: &DiagonalMetric<Vec<f64>>,
        alpha: f64,
        start: &[f64],
    ) -> Result<ExactHeat<'_>, LaplacianError> {
        let off: Vec<f64> = start.iter().zip(&self.steady).map(|(f, end)| f - end).collect();
        ExactHeat::new(&self.modes, mass, alpha, &off)
    }
}

impl<const K: usize> Moving for Flow<'_, K> {
    fn state(&self) -> &State<Vec<f64>> {
        &self.state
    }

    fn step(&mut self, _: f64, to: f64) -> Result<Stepped, StepFailure> {
        let report = match &mut self.way {
            Way::Steps(heat, report) => {
                heat.step(&mut self.state.q)?;
                *report
            }
            Way::Modes(exact, steady) => {
                self.state.q = exact.at(to)?;
                self.state.q.iter_mut().zip(*steady).for_each(|(f, end)| *f += end);
                StepReport::default()
            }
        };
        self.state.t = to;
        Ok(Stepped::done(report))
    }

    fn prepared(&self) -> StepReport {
        self.prepared
    }

    /// Steps are factored for one size.
    fn takes_parts(&self) -> bool {
        self.reads_off()
    }

    fn reads_off(&self) -> bool {
        matches!(self.way, Way::Modes(..))
    }

    fn built(&self) -> Built {
        self.built
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

    fn save(&mut self) -> Saved {
        Saved::default()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.state.clone_from(&before.state);
        Ok(())
    }
}
