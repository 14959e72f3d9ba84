//! A run: how a scene is run, what its particles do in a step, and what was sampled.

use stationary_calculus::first_non_finite;
use stationary_integrators::Cost;

use crate::model::built::Built;
use crate::model::columns::Moment;
use crate::model::scene::Scene;
use crate::run::contact_impulses::{ContactImpulse, ContactRows};

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

/// Which of so many rods are left.
pub(crate) fn whole_rods(rods: usize, broken: &[BrokenRod]) -> Vec<usize> {
    (0..rods).filter(|rod| broken.iter().all(|broken| broken.rod != *rod)).collect()
}

/// The impacts of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impacts {
    /// The last moment in the step at which things met; the step's end where it is not known.
    pub time: f64,
    /// How often the law of impact was applied.
    pub count: usize,
}

/// Steps whose contact conditions were not met as far as asked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unsettled {
    /// How many there were.
    pub steps: u64,
    /// The largest velocity by which the conditions were missed; zero where the method does not tell.
    pub residual: f64,
}

impl Unsettled {
    pub(crate) fn add(&mut self, residual: f64) {
        self.steps += 1;
        self.residual = self.residual.max(residual);
    }
}

/// Steps in which contact lasted, of a method that steps it otherwise than flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LastingContact {
    /// How many there were.
    pub steps: u64,
    /// For how long it lasted in all.
    pub time: f64,
}

/// Steps whose length contact chose by their error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChosenSteps {
    /// Steps that were taken.
    pub accepted: u64,
    /// Steps that were tried and were off by too much.
    pub rejected: u64,
}

impl ChosenSteps {
    pub(crate) fn add(&mut self, other: ChosenSteps) {
        self.accepted += other.accepted;
        self.rejected += other.rejected;
    }
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
    pub(crate) unsettled: Unsettled,
    pub(crate) lasting: LastingContact,
    pub(crate) chosen: ChosenSteps,
    /// The works so far of what acts on the scene, and last that of motors with a speed.
    pub(crate) works: Vec<f64>,
    /// Rows of contact impulses, in the order of the samples.
    pub(crate) contacts: ContactRows,
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

impl Scene {
    /// Samples, before the first one.
    pub(crate) fn no_samples(&self) -> Samples {
        let columns = self.observables.iter().map(|o| o.headings(self).len()).sum();
        Samples { columns, works: vec![0.0; self.works_of().len()], ..Samples::default() }
    }
}

impl Run {
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

    /// The works so far of what acts on the scene beside its potential, by name. They and the energy's
    /// change differ by what impacts and friction took, and by the defect of the integrator.
    pub fn works(&self) -> Vec<(String, f64)> {
        let mut works: Vec<(String, f64)> = Vec::new();
        for (name, &work) in self.scene.works_of().into_iter().zip(&self.samples.works) {
            match works.iter_mut().find(|(other, _)| *other == name) {
                Some((_, sum)) => *sum += work,
                None => works.push((name, work)),
            }
        }
        works
    }

    /// Steps whose contact conditions were not met as far as asked.
    pub fn unsettled(&self) -> Unsettled {
        self.samples.unsettled
    }

    /// Steps of `event-driven-2` and `event-driven-4` in which contact lasted: there their order is 1.
    pub fn lasting_contact(&self) -> LastingContact {
        self.samples.lasting
    }

    /// Steps of `error-controlled`, none of other methods.
    pub fn chosen_steps(&self) -> ChosenSteps {
        self.samples.chosen
    }

    /// What things that touch gave each other from one sample to the next, in the order of the
    /// samples; at most [`limits::CONTACT_ROWS`](crate::limits::CONTACT_ROWS) rows, whole intervals
    /// from the start. None of what touches by springs.
    pub fn contact_impulses(&self) -> &[ContactImpulse] {
        &self.samples.contacts.rows
    }

    /// The time of the last sample up to which all contact impulses are kept, where they are not kept
    /// to the end.
    pub fn contact_impulses_end(&self) -> Option<f64> {
        let end = self.samples.contacts.end?;
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
}
