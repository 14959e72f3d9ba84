//! A scene: what a file has said, checked. It can be run, and run otherwise.

use std::path::Path;

use stationary_integrators::Horizon;

use crate::assemble::scene::assemble;
use crate::model::observable::Observable;
use crate::model::things::{Link, RigidBody, SceneContact, SceneJoint};
use crate::model::units::Units;
use crate::run::error::SceneError;
use crate::run::fields::numbers_of_a_body;
use crate::text::diagnostic::Checked;
use crate::text::fault::Fault;
use crate::text::limits;
use crate::text::source;
use crate::text::source::diagnose;
use crate::words::declaration::Declaration;
use crate::words::heat::HeatedBody;
use crate::words::integrator::Stepping;
use crate::words::particles::{Motion, Particle};
use crate::words::rods::Rod;
use crate::words::solids::ElasticBody;

/// Particles or bodies and what acts on them, a method, and what is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub(crate) title: String,
    pub(crate) dimension: usize,
    pub(crate) units: Units,
    pub(crate) stepping: Stepping,
    pub(crate) timing: Timing,
    pub(crate) gravity: Gravity,
    pub(crate) drag: Option<f64>,
    pub(crate) contact: Option<SceneContact>,
    pub(crate) particles: Vec<Particle>,
    pub(crate) written_out: usize,
    pub(crate) links: Vec<Link>,
    pub(crate) rods: Vec<Rod>,
    pub(crate) bodies: Vec<RigidBody>,
    pub(crate) joints: Vec<SceneJoint>,
    pub(crate) solids: Vec<ElasticBody>,
    pub(crate) heat: Option<HeatedBody>,
    /// The particles that are held until the start.
    pub(crate) hung: Vec<usize>,
    /// Pairs of points of bodies and solids that a picture joins.
    pub(crate) edges: Vec<[usize; 2]>,
    /// Triangles on the outside of solids.
    pub(crate) faces: Vec<[usize; 3]>,
    pub(crate) observables: Vec<Observable>,
    pub(crate) view: [f64; 3],
}

/// The gravity of a scene, where it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// The acceleration of a uniform field. Components beyond the scene's dimension are zero.
    pub acceleration: Option<[f64; 3]>,
    /// The constant G of the attraction of every two particles.
    pub constant: Option<f64>,
}

/// Equal steps to a horizon, and how many of them from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    step: f64,
    horizon: f64,
    steps: Horizon,
    sample_every: u64,
}

impl Timing {
    pub(crate) fn new(step: f64, horizon: f64, sample_every: u64) -> Result<Self, Fault> {
        let steps = Horizon::new(horizon, step)?;
        if steps.steps() > limits::STEPS {
            return Err(Fault::too_many_steps(steps.steps()));
        }
        Ok(Timing { step, horizon, steps, sample_every })
    }

    /// The step.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The time to which the scene runs.
    pub fn horizon(&self) -> f64 {
        self.horizon
    }

    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps.steps()
    }

    /// The same steps, for an integrator.
    pub(crate) fn stepping(&self) -> Horizon {
        self.steps
    }

    /// The number of steps from one sample to the next.
    pub fn sample_every(&self) -> u64 {
        self.sample_every
    }

    /// The number of samples: the start, every so many steps, and the end.
    pub fn samples(&self) -> u64 {
        1 + self.steps().div_ceil(self.sample_every)
    }
}

impl Scene {
    /// The scene that a text describes. `name` stands in errors where a file's name would, and for
    /// a title where the text gives none. Such a scene has no folder to find meshes in.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with the [`Fault`] and its place; [`SceneError::TooLarge`] beyond
    /// [`limits::FILE_BYTES`].
    pub fn parse(name: &str, text: &str) -> Result<Scene, SceneError> {
        Scene::parse_in(None, name, text)
    }

    /// The scene that a text describes, as if it stood in the file of this path: meshes are those
    /// beside it.
    ///
    /// # Errors
    /// Those of [`Scene::parse`].
    pub fn parse_at(path: impl AsRef<Path>, text: &str) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_in(path.parent(), &path.display().to_string(), text)
    }

    fn parse_in(folder: Option<&Path>, name: &str, text: &str) -> Result<Scene, SceneError> {
        let bytes = text.len() as u64;
        if bytes > limits::FILE_BYTES {
            return Err(SceneError::TooLarge { name: name.to_owned(), bytes });
        }
        let scene = source::parse(text).and_then(|declared| assemble(name, folder, &declared));
        scene.map_err(|located| diagnose(name, text, *located))
    }

    /// The scene that a file describes.
    ///
    /// # Errors
    /// [`SceneError::Read`], [`SceneError::NotAFile`] and [`SceneError::NotUtf8`] for the file;
    /// those of [`Scene::parse`] for its text.
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_at(path, &source::read(path)?)
    }

    /// The scene that a text describes, once `change` has been made to its declarations.
    pub(crate) fn parse_changed(
        name: &str,
        text: &str,
        change: impl FnOnce(&mut Declaration),
    ) -> Result<Scene, SceneError> {
        let changed = |mut declared: Declaration| -> Checked<Scene> {
            change(&mut declared);
            assemble(name, None, &declared)
        };
        source::parse(text).and_then(changed).map_err(|located| diagnose(name, text, *located))
    }

    /// The same scene with another method, which must be one that moves such a scene.
    ///
    /// # Errors
    /// [`Fault::MethodOfAnother`], [`Fault::MethodOfJoints`] and [`Fault::MethodCannot`] where it
    /// does not; [`Fault::Tolerance`] and [`Fault::NumberOfModes`] where its number is out of range;
    /// [`Fault::Untouchable`]; [`Fault::TooMany`] numbers of modes; [`Fault::NotCompiled`].
    pub fn with_method(self, method: impl Into<Stepping>) -> Result<Scene, Fault> {
        let scene = Scene { stepping: method.into(), ..self };
        scene.check_stepping()?;
        Ok(scene)
    }

    /// The same scene with another step, sampled at about the same times.
    ///
    /// # Errors
    /// [`Fault::NotPositive`] also where it is not finite; [`Fault::NotWhole`] where the horizon is
    /// not a whole number of steps; [`Fault::TooMany`] steps; [`Fault::TooManySamples`].
    pub fn with_step(self, step: f64) -> Result<Scene, Fault> {
        let old = self.timing;
        let every = (old.sample_every as f64 * (old.step / step)).round().max(1.0) as u64;
        let scene = Scene { timing: Timing::new(step, old.horizon, every)?, ..self };
        scene.check_samples()?;
        Ok(scene)
    }

    /// The same scene to another horizon, a whole number of its steps.
    ///
    /// # Errors
    /// Those of [`Scene::with_step`].
    pub fn with_horizon(self, horizon: f64) -> Result<Scene, Fault> {
        let timing = Timing::new(self.timing.step, horizon, self.timing.sample_every)?;
        let scene = Scene { timing, ..self };
        scene.check_samples()?;
        Ok(scene)
    }

    /// Its title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Its dimension: 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The words for its units.
    pub fn units(&self) -> &Units {
        &self.units
    }

    /// How it is stepped.
    pub fn stepping(&self) -> Stepping {
        self.stepping
    }

    /// Its step, horizon and samples.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Its gravity.
    pub fn gravity(&self) -> Gravity {
        self.gravity
    }

    /// The coefficient c of the drag `F = -c v` on every free particle, where it has one.
    pub fn drag(&self) -> Option<f64> {
        self.drag
    }

    /// How its things touch, where they do.
    pub fn contact(&self) -> Option<&SceneContact> {
        self.contact.as_ref()
    }

    /// Its particles: those that are written out, in the file's order, then the vertices of nets
    /// and of solids; or the centres of its bodies, then their points.
    pub fn particles(&self) -> &[Particle] {
        &self.particles
    }

    /// Its springs: those of nets, then those that are written out.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Its rods.
    pub fn rods(&self) -> &[Rod] {
        &self.rods
    }

    /// Its rigid bodies, in the file's order.
    pub fn bodies(&self) -> &[RigidBody] {
        &self.bodies
    }

    /// Its joints, in the file's order.
    pub fn joints(&self) -> &[SceneJoint] {
        &self.joints
    }

    /// Its elastic bodies, in the file's order.
    pub fn solids(&self) -> &[ElasticBody] {
        &self.solids
    }

    /// The body through which heat flows, where there is one: then there is nothing else.
    pub fn heat(&self) -> Option<&HeatedBody> {
        self.heat.as_ref()
    }

    /// Triangles on the outside of its elastic bodies, counterclockwise from there, by their places
    /// in [`Scene::particles`]; those of sheets are seen from one side.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.faces
    }

    /// What a run writes down besides the positions.
    pub fn observables(&self) -> &[Observable] {
        &self.observables
    }

    /// The number of its freedoms, of which joints take some.
    pub fn freedoms(&self) -> usize {
        if let Some(body) = &self.heat {
            return body.held.iter().filter(|&&held| !held).count();
        }
        if !self.bodies.is_empty() {
            return (if self.dimension == 3 { 6 } else { 3 }) * self.bodies.len();
        }
        let free = |particle: &&Particle| matches!(particle.motion, Motion::Free { .. });
        self.dimension * self.particles.iter().filter(free).count()
    }

    /// The lines that a picture draws between particles: springs, or edges of bodies.
    pub(crate) fn lines(&self) -> impl Iterator<Item = [usize; 2]> {
        self.links.iter().map(|link| link.ends).chain(self.edges.iter().copied())
    }

    /// The particles whose paths a picture shows: those written out and those observed.
    pub(crate) fn followed(&self) -> Vec<usize> {
        let observed = self.observables.iter().filter_map(|observable| match *observable {
            Observable::Position(particle)
            | Observable::Velocity(particle)
            | Observable::Temperature(particle) => Some(particle),
            _ => None,
        });
        let mut followed: Vec<usize> =
            (0..self.written_out).chain(observed.filter(|&p| p >= self.written_out)).collect();
        followed.sort_unstable();
        followed.dedup();
        followed
    }

    /// An error where the samples would be more numbers than are kept.
    pub(crate) fn check_samples(&self) -> Result<(), Fault> {
        let columns: usize = self.observables.iter().map(|o| o.headings(self).len()).sum();
        // Positions, velocities and temperatures, observables, and the time, heat, energies and
        // momenta that every sample has.
        let velocities = if self.keeps_velocities() { self.dimension } else { 0 };
        let per_particle = self.dimension + velocities + usize::from(self.heat.is_some());
        let of_bodies = numbers_of_a_body(self.dimension) * self.bodies.len();
        let per_sample = (per_particle * self.particles.len() + of_bodies + columns + 10) as u64;
        let numbers = self.timing.samples().saturating_mul(per_sample);
        if numbers <= limits::SAMPLED_NUMBERS {
            return Ok(());
        }
        let rows = (limits::SAMPLED_NUMBERS / per_sample).saturating_sub(1).max(1);
        Err(Fault::TooManySamples { numbers, enough: self.timing.steps().div_ceil(rows) })
    }
}
