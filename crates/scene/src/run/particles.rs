//! A run of particles: what steps them, and samples of where they are and what their rods felt.

use stationary_calculus::{Metric, Potential, Vector};
use stationary_integrators::{
    State, StepError, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale,
};

use crate::assemble::acceleration::most_accelerated;
use crate::assemble::acting::Acting;
use crate::assemble::error::AssemblyError;
use crate::assemble::particle_system::ParticleSystem;
use crate::assemble::system::SceneProblem;
use crate::assemble::vertices::Vertices;
use crate::model::columns::Moment;
use crate::model::scene::Scene;
use crate::model::stepping::Stepping;
use crate::run::adaptive;
use crate::run::checkpoint::Checkpoint;
use crate::run::engine::{Clock, Engine};
use crate::run::equal::Equal;
use crate::run::error::{Interruption, RunError, StepFailure, unknown};
use crate::run::observer::Observer;
use crate::run::recorder::{Failed, Recorder};
use crate::run::samples::{BrokenRod, Run, Samples, whole_rods};
use crate::run::stepper::Stepper;

impl Scene {
    /// Runs a scene of particles to its horizon, or until the observer breaks off.
    pub(crate) fn run_particles(
        &self,
        checkpoint: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        match self.dimension {
            1 => self.run_in::<1>(checkpoint, observer),
            2 => self.run_in::<2>(checkpoint, observer),
            _ => self.run_in::<3>(checkpoint, observer),
        }
    }

    fn run_in<const D: usize>(
        &self,
        checkpoint: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        let system = ParticleSystem::<D>::of(self)?;
        let problem = &system.problem;
        let mut stepper = stepper(self, &system)?;
        let mut state = problem.initial.clone();
        stepper.start(&mut state)?;
        let built = problem.system.potential().built() + system.built() + stepper.built();
        let recorder = Box::new(ParticleRecorder::<D>::new(self, problem));
        let clock = Clock::OfTheScene;
        Engine { scene: self, state, stepper, recorder, clock, built }
            .integrate(checkpoint, observer)
    }
}

/// What steps the particles of a scene.
fn stepper<'s, const D: usize>(
    scene: &'s Scene,
    system: &'s ParticleSystem<D>,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    #[cfg(feature = "modal")]
    if let Some(modes) = &system.modes {
        return crate::run::linear_modes::stepper(modes, &system.problem);
    }
    #[cfg(feature = "contact")]
    if let (Some(gaps), Some(contact)) = (&system.gaps, &scene.contact) {
        let impacts = crate::run::impacts::stepper(scene, contact, gaps, &system.problem)?;
        return Ok(crate::run::driven::kicked(scene, impacts));
    }
    let problem = &system.problem;
    match scene.stepping {
        #[cfg(feature = "constraints")]
        Stepping::Equal(method) if !scene.rods.is_empty() => {
            crate::run::rods::projected::<D>(scene, problem, method)
        }
        #[cfg(feature = "constraints")]
        Stepping::Constrained(method) => crate::run::rods::held::<D>(scene, problem, method),
        Stepping::Equal(method) => Equal::of(scene, problem, method),
        Stepping::Adaptive { method, tolerance } => {
            adaptive::stepper(scene, problem, method, tolerance)
        }
        other => Err(AssemblyError::NotCompiled(other.name())),
    }
}

/// Takes samples of particles.
struct ParticleRecorder<'a, const D: usize> {
    scene: &'a Scene,
    problem: &'a SceneProblem,
    vertices: Vertices,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    tensions: Vec<f64>,
    /// The rods that are left, in the order of their multipliers.
    left: Vec<usize>,
    broken: Vec<BrokenRod>,
    acting: Option<Acting>,
}

impl<'a, const D: usize> ParticleRecorder<'a, D> {
    fn new(scene: &'a Scene, problem: &'a SceneProblem) -> Self {
        ParticleRecorder {
            scene,
            problem,
            vertices: Vertices::new(scene),
            positions: scene.particles.iter().map(|particle| particle.position).collect(),
            velocities: vec![[0.0; 3]; scene.particles.len()],
            tensions: vec![0.0; scene.rods.len()],
            left: (0..scene.rods.len()).collect(),
            broken: Vec::new(),
            acting: Acting::of(scene),
        }
    }

    /// The freedom of the largest acceleration, or the first whose acceleration is not finite.
    fn most_accelerated(&self, q: &[f64]) -> usize {
        let system = &self.problem.system;
        most_accelerated(system.metric(), system.potential(), q)
    }
}

impl<const D: usize> Recorder for ParticleRecorder<'_, D> {
    fn sample(&mut self, state: &State<Vec<f64>>, time: f64, samples: &mut Samples) {
        let system = &self.problem.system;
        let mut v = Vector(vec![0.0; system.dim()]);
        system.metric().sharp(state.p.view(), v.view_mut());
        let (q, v) = (state.q.as_chunks::<D>().0, v.components().as_chunks::<D>().0);
        for (vertex, &particle) in self.vertices.particles[..self.vertices.free].iter().enumerate()
        {
            self.positions[particle][..D].copy_from_slice(&q[vertex]);
            self.velocities[particle][..D].copy_from_slice(&v[vertex]);
        }

        for motion in &self.scene.drives.motions {
            let start = self.scene.particles[motion.particle].position;
            self.positions[motion.particle] = motion.place(start, time);
            self.velocities[motion.particle] = motion.velocity(time);
        }

        let pulled = self.acting.as_ref().map_or(0.0, |acting| acting.energy(time, &state.q));
        let mut linear = [0.0; 3];
        linear[..D].copy_from_slice(&linear_momentum::<D>(state));
        let moment = Moment {
            kinetic: system.metric().kinetic_energy(state.p.view()),
            potential: system.potential().energy(&state.q) + pulled,
            linear,
            angular: angular_momentum::<D>(state),
            positions: &self.positions,
            velocities: &self.velocities,
            tensions: &self.tensions,
            ..Moment::default()
        };
        let scales = [linear_momentum_scale::<D>(state), angular_momentum_scale::<D>(state)];
        samples.push(self.scene, time, &moment, scales);
    }

    fn feel(&mut self, multipliers: &[f64], broken: Option<BrokenRod>) {
        if let Some(broken) = broken {
            let rod = self.left.remove(broken.rod);
            self.tensions[rod] = 0.0;
            self.broken.push(BrokenRod { rod, ..broken });
        }
        for (&rod, lambda) in self.left.iter().zip(multipliers) {
            self.tensions[rod] = 2.0 * self.scene.rods[rod].length * lambda;
        }
    }

    fn broken(&self) -> &[BrokenRod] {
        &self.broken
    }

    fn restore(&mut self, broken: &[BrokenRod]) {
        self.left = whole_rods(self.tensions.len(), broken);
        self.broken.clear();
        self.broken.extend_from_slice(broken);
    }

    fn failed(&self, failed: Failed, state: &State<Vec<f64>>, run: Run) -> RunError {
        let freedom = match &failed.source {
            StepFailure::Step(
                StepError::NonFiniteConfiguration { freedom }
                | StepError::NonFiniteMomentum { freedom },
            ) => *freedom,
            other => unknown(other).unwrap_or_else(|| self.most_accelerated(&state.q)),
        };
        let particle = self.vertices.particles[freedom / D];
        RunError::Interrupted(Box::new(Interruption {
            step: failed.step,
            time: failed.time,
            unit: self.scene.units.time.clone(),
            particle: self.scene.particles[particle].name.clone(),
            coordinate: freedom % D,
            named: self.scene.failure_named(&failed.source, &self.left),
            unstable: self.scene.unstable_step(),
            source: failed.source,
            run: Box::new(run),
        }))
    }
}
