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
use stationary_integrators::{State, StepReport};
use stationary_laplacian::{
    Domain, Elements, ExactHeat, Heat, HeatMethod, LaplacianError, harmonic, largest_eigenvalue,
    lowest_modes,
};
use stationary_mesh::Mesh;
use stationary_modal::Modes;

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::leading;
use crate::model::built::Built;
use crate::model::columns::Moment;
use crate::model::elastic_body::HeatedBody;
use crate::model::scene::Scene;
use crate::model::simplices::Simplices;
use crate::model::stepping::Stepping;
use crate::model::strength::Strength;
use crate::run::checkpoint::Checkpoint;
use crate::run::engine::{Clock, Engine};
use crate::run::error::{RunError, StepFailure};
use crate::run::observer::Observer;
use crate::run::recorder::{Failed, Recorder};
use crate::run::samples::{Run, Samples};
use crate::run::stepper::{Stepped, Stepper};

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
    /// Runs a scene of heat to its horizon, or until the observer breaks off.
    pub(crate) fn run_heat(
        &self,
        checkpoint: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        let Some(body) = &self.heat else { return Err(AssemblyError::Heat.into()) };
        of_each_shape!(self, body, elements => self.flow(body, elements?, checkpoint, observer))
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
        observer: &mut dyn Observer,
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
        let known;
        let (flow, built) = match self.stepping {
            Stepping::Heat(method) => {
                let h = self.timing.stepping().step();
                let heat = Heat::new(mass, domain.dirichlet(), method, alpha, h);
                let heat = heat.map_err(AssemblyError::from)?;
                let implicit = method != HeatMethod::ExplicitEuler;
                let prepared = StepReport { hessians: implicit.into(), ..StepReport::default() };
                // A solve with the factor counts as a differential.
                let step =
                    StepReport { differentials: 1 + u32::from(implicit), ..StepReport::default() };
                // As the method weighs the ends of a step.
                let parts = match method {
                    HeatMethod::ExplicitEuler => [0.0, 1.0],
                    HeatMethod::CrankNicolson => [0.5, 0.5],
                    _ => [1.0, 0.0],
                };
                let sources = self.drives.sources.iter().map(|source| {
                    let rates = domain.on_freedoms(&source.rates)?;
                    let heat = mass.masses().iter().zip(&rates).map(|(m, rate)| m * rate).sum();
                    Ok(Inflow { rates, heat, strength: source.strength.clone(), parts })
                });
                let sources: Vec<Inflow> =
                    sources.collect::<Result<_, LaplacianError>>().map_err(AssemblyError::from)?;
                let given = vec![0.0; sources.len()];
                let flow = Flow {
                    stepper: HeatStepper::Steps(Box::new(heat), step),
                    prepared,
                    sources,
                    given,
                };
                let built = Built { sparse_solvers: implicit.into(), ..built };
                (flow, built)
            }
            Stepping::LinearModes { count } => {
                known = Spectrum::of(domain, mass, count).map_err(AssemblyError::from)?;
                let exact = known.flow(mass, alpha, &state.q).map_err(AssemblyError::from)?;
                let stepper = HeatStepper::Modes(exact, &known.steady);
                let (prepared, sources, given) = (known.prepared(), Vec::new(), Vec::new());
                let flow = Flow { stepper, prepared, sources, given };
                (flow, built + known.built)
            }
            _ => return Err(AssemblyError::Heat.into()),
        };
        let stepper = Box::new(flow);
        let recorder = Box::new(HeatRecorder { scene: self, shares, domain });
        let clock = Clock::OfTheScene;
        Engine { scene: self, state, stepper, recorder, clock, built }
            .integrate(checkpoint, observer)
    }
}

impl HeatedBody {
    /// The vertices that are held, each with its temperature.
    fn held_values(&self) -> Vec<(usize, f64)> {
        let held = (0..self.held.len()).filter(|&vertex| self.held[vertex]);
        held.map(|vertex| (vertex, self.start[vertex])).collect()
    }
}

/// What moves heat: temperatures for a configuration, and no momenta.
struct Flow<'a> {
    stepper: HeatStepper<'a>,
    prepared: StepReport,
    sources: Vec<Inflow>,
    /// The heat that each source gave in the last step.
    given: Vec<f64>,
}

/// A source of heat on the freedoms.
struct Inflow {
    rates: Vec<f64>,
    /// The heat that its rates come to in a unit of time.
    heat: f64,
    strength: Strength,
    /// The parts that flow in before the step and after it.
    parts: [f64; 2],
}

/// How heat is moved.
enum HeatStepper<'a> {
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

impl Stepper for Flow<'_> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let report = match &mut self.stepper {
            HeatStepper::Steps(heat, report) => {
                let warm = |f: &mut [f64], part: usize| {
                    for source in &self.sources {
                        let scale = source.parts[part] * source.strength.integral(to - h, to);
                        f.iter_mut().zip(&source.rates).for_each(|(f, rate)| *f += scale * rate);
                    }
                };
                if self.sources.is_empty() {
                    heat.step(&mut state.q)?;
                } else {
                    let mut f = state.q.clone();
                    warm(&mut f, 0);
                    heat.step(&mut f)?;
                    warm(&mut f, 1);
                    state.q = f;
                }
                for (given, source) in self.given.iter_mut().zip(&self.sources) {
                    *given = source.heat * source.strength.integral(to - h, to);
                }
                *report
            }
            HeatStepper::Modes(exact, steady) => {
                state.q = exact.at(to)?;
                state.q.iter_mut().zip(*steady).for_each(|(f, end)| *f += end);
                StepReport::default()
            }
        };
        Ok(Stepped::done(report))
    }

    fn works(&self) -> &[f64] {
        &self.given
    }

    fn prepared(&self) -> StepReport {
        self.prepared
    }

    /// Steps are factored for one size.
    fn takes_parts(&self) -> bool {
        self.reads_off()
    }

    fn reads_off(&self) -> bool {
        matches!(self.stepper, HeatStepper::Modes(..))
    }
}

/// Takes samples of temperatures.
struct HeatRecorder<'a, const K: usize> {
    scene: &'a Scene,
    /// The length, area or volume that belongs to each vertex.
    shares: &'a [f64],
    domain: &'a Domain<K>,
}

impl<const K: usize> Recorder for HeatRecorder<'_, K> {
    fn sample(&mut self, state: &State<Vec<f64>>, time: f64, samples: &mut Samples) {
        // As many freedoms as the domain has.
        let Ok(temperatures) = self.domain.on_vertices(&state.q) else { return };
        let positions: Vec<[f64; 3]> = self.scene.particles.iter().map(|p| p.position).collect();
        let moment = Moment {
            potential: self.domain.dirichlet().energy(&state.q),
            positions: &positions,
            temperatures: &temperatures,
            heat: self.shares.iter().zip(&temperatures).map(|(m, f)| m * f).sum(),
            ..Moment::default()
        };
        samples.push(self.scene, time, &moment, [0.0; 2]);
    }

    fn failed(&self, failed: Failed, _: &State<Vec<f64>>, run: Run) -> RunError {
        failed.stops(run, None)
    }
}
