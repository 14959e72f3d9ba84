//! A run: how a scene is run, what its particles do in a step, and what was sampled.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use stationary_calculus::{Metric, Potential, Vector, first_non_finite};
use stationary_integrators::{
    Cost, State, StepError, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale,
};

use crate::assemble::acceleration::most_accelerated;
use crate::assemble::system::{SceneProblem, Vertices};
use crate::model::built::Built;
use crate::model::observable::Moment;
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::contact_impulses::ContactImpulse;
use crate::run::error::{Interruption, RunError, Stop, WriteError};
use crate::run::error::{StepFailure, unknown};
use crate::run::march::{Watcher, Wish};
use crate::show::csv;
use crate::show::csv::write_file;
use crate::show::summary::Summary;
use crate::show::{field_tables, film, picture, player, vtk};

/// What a run has sampled, and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    pub(crate) scene: Scene,
    pub(crate) samples: Samples,
    pub(crate) broken: Vec<BrokenRod>,
    pub(crate) cost: Cost,
    pub(crate) built: Built,
}

/// A rod that broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrokenRod {
    /// Its place in [`Scene::rods`].
    pub rod: usize,
    /// The end of the step in which it broke.
    pub time: f64,
    /// The tension that broke it, negative for a thrust.
    pub tension: f64,
}

/// The impacts of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impacts {
    /// The last moment in the step at which things met; the step's end where it is not known.
    pub time: f64,
    /// How often the law of impact was applied.
    pub count: usize,
}

/// Samples in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Samples {
    pub(crate) times: Vec<f64>,
    /// D numbers a particle, in the scene's order, sample after sample.
    pub(crate) positions: Vec<f64>,
    /// D numbers a particle, where a scene keeps velocities.
    pub(crate) velocities: Vec<f64>,
    /// Orientation and velocities of each body (`fields.rs`).
    pub(crate) bodies: Vec<f64>,
    pub(crate) kinetic: Vec<f64>,
    pub(crate) potential: Vec<f64>,
    pub(crate) linear: Vec<[f64; 3]>,
    pub(crate) angular: Vec<[f64; 3]>,
    /// A number a vertex of a scene of heat, sample after sample, and the heat of each sample.
    pub(crate) temperatures: Vec<f64>,
    pub(crate) heat: Vec<f64>,
    /// Of each step in which things met, in the order of time.
    pub(crate) impacts: Vec<Impacts>,
    /// Rows of contact impulses, in the order of the samples.
    pub(crate) contacts: Vec<ContactImpulse>,
    /// The first sample of which there are no rows any more, where there would be too many.
    pub(crate) contacts_end: Option<usize>,
    /// As many numbers a sample as the observables have columns.
    pub(crate) observed: Vec<f64>,
    pub(crate) columns: usize,
    /// The largest of what rounding in the momenta scales with.
    pub(crate) linear_scale: f64,
    pub(crate) angular_scale: f64,
}

impl Samples {
    /// The observables of the last sample.
    pub(crate) fn last_observed(&self) -> &[f64] {
        &self.observed[self.observed.len().saturating_sub(self.columns)..]
    }

    /// The first quantity of the last sample that is not finite, by name, and its value.
    pub(crate) fn overflow(&self, scene: &Scene) -> Option<(String, f64)> {
        let last = |quantity: &str, values: &[f64]| {
            let value = values.iter().copied().find(|x| !x.is_finite())?;
            Some((quantity.to_owned(), value))
        };
        let tail = |values: &[f64]| values.last().map(|&value| [value]).unwrap_or_default();
        last("kinetic energy", &tail(&self.kinetic))
            .or_else(|| last("potential energy", &tail(&self.potential)))
            .or_else(|| last("linear momentum", self.linear.last()?))
            .or_else(|| last("angular momentum", self.angular.last()?))
            .or_else(|| last("heat", &tail(&self.heat)))
            .or_else(|| {
                let sample = scene.particles.len() * scene.dimension;
                let positions = &self.positions[self.positions.len().saturating_sub(sample)..];
                let number = first_non_finite(positions)?;
                let name = &scene.particles[number / scene.dimension].name;
                Some((format!("the position of `{name}`"), positions[number]))
            })
            .or_else(|| {
                let vertices = self.temperatures.len().checked_div(self.times.len())?;
                last("a temperature", &self.temperatures[self.temperatures.len() - vertices..])
            })
            .or_else(|| {
                let column = first_non_finite(self.last_observed())?;
                let heading =
                    scene.observables.iter().flat_map(|o| o.headings(scene)).nth(column)?;
                Some((heading, self.last_observed()[column]))
            })
    }

    /// Adds a moment, with what rounding in its momenta scales with.
    pub(crate) fn push(&mut self, scene: &Scene, t: f64, moment: &Moment<'_>, scales: [f64; 2]) {
        let d = scene.dimension;
        self.times.push(t);
        self.positions.extend(moment.positions.iter().flat_map(|x| &x[..d]));
        if scene.keeps_velocities() {
            self.velocities.extend(moment.velocities.iter().flat_map(|v| &v[..d]));
        }
        self.bodies.extend(moment.bodies);
        self.kinetic.push(moment.kinetic);
        self.potential.push(moment.potential);
        self.linear.push(moment.linear);
        self.angular.push(moment.angular);
        self.temperatures.extend(moment.temperatures);
        self.heat.push(moment.heat);
        for observable in &scene.observables {
            observable.append(moment, d, &mut self.observed);
        }
        self.linear_scale = self.linear_scale.max(scales[0]);
        self.angular_scale = self.angular_scale.max(scales[1]);
    }
}

/// How far a run has come, shown after every step.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Steps taken.
    pub step: u64,
    /// Steps to the horizon.
    pub steps: u64,
    /// The time.
    pub time: f64,
    /// The configuration: D numbers for each particle that is free; of a body in the plane place
    /// and angle, in space place and quaternion.
    pub q: &'a [f64],
    /// What was computed so far.
    pub cost: Cost,
    /// The observables at the last sample, a number for each heading.
    pub observed: &'a [f64],
}

impl Scene {
    /// Runs the scene to its horizon.
    ///
    /// # Errors
    /// Those of [`Scene::run_watched`].
    pub fn run(&self) -> Result<Run, RunError> {
        self.run_watched(|_| ControlFlow::Continue(()))
    }

    /// Runs the scene to its horizon, or until the watcher breaks off; that is no error.
    ///
    /// # Errors
    /// [`RunError::Assembly`] where scene and method make no system. Where a step fails
    /// [`RunError::Interrupted`] of particles, [`RunError::Stopped`] of bodies and heat; the latter
    /// also where a sample is not finite. Both hold the run up to there.
    pub fn run_watched(
        &self,
        watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        self.run_from(None, &mut Sight(watch))
    }

    /// Runs the scene from its start or from a checkpoint, to its horizon or until the watcher
    /// stops.
    ///
    /// A run that is resumed has the samples, the counts and the bits of a whole one.
    ///
    /// # Errors
    /// Those of [`Scene::run_watched`]; [`RunError::Checkpoint`] where the checkpoint is not one of
    /// this scene, or where its last step leads to other bits here.
    pub fn run_from(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        self.run_kind(checkpoint, watcher).map_err(|error| self.named(error))
    }

    /// Samples, before the first one.
    pub(crate) fn no_samples(&self) -> Samples {
        let columns = self.observables.iter().map(|o| o.headings(self).len()).sum();
        Samples { columns, ..Samples::default() }
    }
}

/// A watcher that wishes for no checkpoints.
struct Sight<F>(F);

impl<F: FnMut(Progress<'_>) -> ControlFlow<()>> Watcher for Sight<F> {
    fn stepped(&mut self, now: Progress<'_>) -> Wish {
        if self.0(now).is_break() { Wish::Stop } else { Wish::GoOn }
    }

    fn keep(&mut self, _: &Checkpoint) {}
}

/// A step that failed.
pub(crate) struct Failed {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) source: StepFailure,
}

/// Takes samples of states.
pub(crate) struct Recorder<'a, const D: usize> {
    pub(crate) scene: &'a Scene,
    problem: &'a SceneProblem<D>,
    vertices: Vertices,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    tensions: Vec<f64>,
    /// The rods that are left, in the order of their multipliers.
    pub(crate) left: Vec<usize>,
    pub(crate) broken: Vec<BrokenRod>,
}

impl<'a, const D: usize> Recorder<'a, D> {
    pub(crate) fn new(scene: &'a Scene, problem: &'a SceneProblem<D>) -> Self {
        Recorder {
            scene,
            problem,
            vertices: Vertices::new(scene),
            positions: scene.particles.iter().map(|particle| particle.position).collect(),
            velocities: vec![[0.0; 3]; scene.particles.len()],
            tensions: vec![0.0; scene.rods.len()],
            left: (0..scene.rods.len()).collect(),
            broken: Vec::new(),
        }
    }

    /// Takes the tensions of a step, and the rod that broke in it.
    pub(crate) fn feel(&mut self, multipliers: &[f64], broken: Option<BrokenRod>) {
        if let Some(broken) = broken {
            let rod = self.left.remove(broken.rod);
            self.tensions[rod] = 0.0;
            self.broken.push(BrokenRod { rod, ..broken });
        }
        for (&rod, lambda) in self.left.iter().zip(multipliers) {
            self.tensions[rod] = 2.0 * self.scene.rods[rod].length * lambda;
        }
    }

    pub(crate) fn sample(&mut self, state: &State<Vec<f64>>, samples: &mut Samples) {
        let system = &self.problem.system;
        let mut v = Vector(vec![0.0; system.dim()]);
        system.metric().sharp(state.p.view(), v.view_mut());
        let (q, v) = (state.q.as_chunks::<D>().0, v.components().as_chunks::<D>().0);
        for (vertex, &particle) in self.vertices.particles[..self.vertices.free].iter().enumerate()
        {
            self.positions[particle][..D].copy_from_slice(&q[vertex]);
            self.velocities[particle][..D].copy_from_slice(&v[vertex]);
        }

        let mut linear = [0.0; 3];
        linear[..D].copy_from_slice(&linear_momentum::<D>(state));
        let moment = Moment {
            kinetic: system.metric().kinetic_energy(state.p.view()),
            potential: system.potential().energy(&state.q),
            linear,
            angular: angular_momentum::<D>(state),
            positions: &self.positions,
            velocities: &self.velocities,
            tensions: &self.tensions,
            ..Moment::default()
        };
        let scales = [linear_momentum_scale::<D>(state), angular_momentum_scale::<D>(state)];
        samples.push(self.scene, state.t, &moment, scales);
    }

    pub(crate) fn interrupt(&self, failed: Failed, state: &State<Vec<f64>>, run: Run) -> RunError {
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

    /// The freedom of the largest acceleration, or the first whose acceleration is not finite.
    fn most_accelerated(&self, q: &[f64]) -> usize {
        let system = &self.problem.system;
        most_accelerated(system.metric(), system.potential(), q)
    }
}

impl Run {
    /// The error of a step, from a time, that failed after all this.
    pub(crate) fn stopped(self, step: u64, time: f64, source: StepFailure) -> RunError {
        let named = self.scene.failure_named(&source, &[]);
        self.stopped_by(named, step, time, source)
    }

    /// The same in words of its own.
    pub(crate) fn stopped_by(
        self,
        named: Option<String>,
        step: u64,
        time: f64,
        source: StepFailure,
    ) -> RunError {
        let unit = self.scene.units.time.clone();
        let reason = named.unwrap_or_else(|| source.to_string());
        let unstable = self.scene.unstable_step();
        let run = Box::new(self);
        RunError::Stopped(Box::new(Stop { step, time, unit, reason, unstable, source, run }))
    }

    /// The scene that was run.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The times of the samples.
    pub fn times(&self) -> &[f64] {
        &self.samples.times
    }

    /// The positions of all particles at a sample: D numbers each, in the scene's order. Empty
    /// where there is no such sample.
    pub fn positions(&self, sample: usize) -> &[f64] {
        let n = self.scene.dimension * self.scene.particles.len();
        self.samples.positions.get(n * sample..n * (sample + 1)).unwrap_or_default()
    }

    /// The position of a particle at a sample, as a point in space.
    pub(crate) fn position(&self, sample: usize, particle: usize) -> [f64; 3] {
        let d = self.scene.dimension;
        let mut x = [0.0; 3];
        if let Some(position) = self.positions(sample).get(d * particle..d * (particle + 1)) {
            x[..d].copy_from_slice(position);
        }
        x
    }

    /// The energy at each sample.
    pub fn energies(&self) -> Vec<f64> {
        let sum = |(kinetic, potential)| kinetic + potential;
        self.samples.kinetic.iter().zip(&self.samples.potential).map(sum).collect()
    }

    /// The kinetic energy at each sample.
    pub fn kinetic_energies(&self) -> &[f64] {
        &self.samples.kinetic
    }

    /// The linear momentum of the free particles at each sample, as a vector in space.
    pub fn linear_momenta(&self) -> &[[f64; 3]] {
        &self.samples.linear
    }

    /// The angular momentum of the free particles about the origin at each sample.
    pub fn angular_momenta(&self) -> &[[f64; 3]] {
        &self.samples.angular
    }

    /// The temperatures of all vertices of a scene of heat at a sample, in the scene's order. Empty
    /// where there is no such sample, or no heat.
    pub fn temperatures(&self, sample: usize) -> &[f64] {
        let n = self.scene.particles.len();
        self.samples.temperatures.get(n * sample..n * (sample + 1)).unwrap_or_default()
    }

    /// Of each step in which things met, at most [`limits::IMPACTS`](crate::limits::IMPACTS) of
    /// them.
    pub fn impacts(&self) -> &[Impacts] {
        &self.samples.impacts
    }

    /// What things that touch gave each other from one sample to the next, in the order of the
    /// samples; at most [`limits::CONTACT_ROWS`](crate::limits::CONTACT_ROWS) rows, whole intervals
    /// from the start. None of what touches by springs.
    pub fn contact_impulses(&self) -> &[ContactImpulse] {
        &self.samples.contacts
    }

    /// The time of the last sample up to which all contact impulses are kept, where they are not kept
    /// to the end.
    pub fn contact_impulses_end(&self) -> Option<f64> {
        let end = self.samples.contacts_end?;
        Some(self.times().get(end.saturating_sub(1)).copied().unwrap_or_default())
    }

    /// What rounding in the linear and in the angular momentum is relative to: the largest sums of
    /// magnitudes.
    pub fn momentum_scales(&self) -> [f64; 2] {
        [self.samples.linear_scale, self.samples.angular_scale]
    }

    /// The headings of the observables' columns, with units.
    pub fn headings(&self) -> Vec<String> {
        self.scene.observables.iter().flat_map(|o| o.headings(&self.scene)).collect()
    }

    /// The observables at a sample, a number for each heading. Empty where there is no such sample.
    pub fn observed(&self, sample: usize) -> &[f64] {
        let n = self.samples.columns;
        self.samples.observed.get(n * sample..n * (sample + 1)).unwrap_or_default()
    }

    /// The rods that broke, in the order of time.
    pub fn broken(&self) -> &[BrokenRod] {
        &self.broken
    }

    /// What the steps cost.
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// What was built before the first step: nothing but what the scene names.
    pub fn built(&self) -> Built {
        self.built
    }

    /// What the run comes to, in numbers that another processor reproduces.
    pub fn summary(&self) -> Summary {
        Summary::of(self)
    }

    /// The files that runs write, each run those that its scene has something for.
    pub const FILES: [&str; 14] = [
        "trajectory.csv",
        "observables.csv",
        "velocity.csv",
        "bodies.csv",
        "displacement.csv",
        "stress.csv",
        "temperature.csv",
        "contacts.csv",
        "events.csv",
        "summary.txt",
        "picture.svg",
        "film.svg",
        "player.html",
        "trajectory.pvd",
    ];

    /// Writes into a folder, which is made where it is missing:
    ///
    /// | file | |
    /// | --- | --- |
    /// | `trajectory.csv`, `observables.csv` | every sample |
    /// | `velocity.csv` | of particles |
    /// | `bodies.csv` | place, orientation and velocities of bodies |
    /// | `displacement.csv`, `stress.csv` | of the vertices and of the elements of solids |
    /// | `temperature.csv` | of the vertices of heat |
    /// | `contacts.csv` | impulses between what touches, from sample to sample |
    /// | `events.csv` | rods that broke, where rods can; impacts, where things touch |
    /// | `summary.txt` | the summary, and what was built |
    /// | `picture.svg`, `film.svg` | paths from the start to the end, and moments side by side |
    /// | `player.html` | a page that plays the motion |
    ///
    /// # Errors
    /// [`WriteError`] at the first folder or file that cannot be written.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<(), WriteError> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder)
            .map_err(|source| WriteError { path: folder.to_owned(), source })?;
        write_file(&folder.join("trajectory.csv"), |out| csv::trajectory(self, out))?;
        write_file(&folder.join("observables.csv"), |out| csv::observables(self, out))?;
        field_tables::write(self, folder)?;
        if self.scene.rods.iter().any(|rod| rod.strength.is_finite()) {
            write_file(&folder.join("events.csv"), |out| csv::broken_rods(self, out))?;
        }
        if self.scene.contact.is_some() {
            write_file(&folder.join("events.csv"), |out| csv::impacts(self, out))?;
        }
        write_file(&folder.join("summary.txt"), |out| {
            let summary = self.summary();
            write!(out, "{summary}\n{}", summary.built)
        })?;
        write_file(&folder.join("picture.svg"), |out| out.write_all(self.picture().as_bytes()))?;
        write_file(&folder.join("film.svg"), |out| out.write_all(self.film().as_bytes()))?;
        write_file(&folder.join("player.html"), |out| player::write(self, out))
    }

    /// Writes `trajectory.pvd` and the files that it names, for ParaView, into a folder, which is
    /// made where it is missing.
    ///
    /// # Errors
    /// [`WriteError`] at the first folder or file that cannot be written.
    pub fn write_vtk(&self, folder: impl AsRef<Path>) -> Result<(), WriteError> {
        vtk::write(self, folder.as_ref())
    }

    /// The picture of the run, as the text of an SVG file.
    pub fn picture(&self) -> String {
        picture::Picture::of(self).svg()
    }

    /// A few moments of the run side by side, as the text of an SVG file.
    pub fn film(&self) -> String {
        film::Film::of(self).svg()
    }
}
