//! A run of bodies: step after step to the horizon, and samples of their centres and points.

use nalgebra::Vector3;
use stationary_integrators::{Saved, State};
use stationary_rigid::BodyMotion;

use crate::assemble::body_system::BodySystem;
use crate::model::built::Built;
use crate::model::observable::Moment;
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::RunError;
use crate::run::error::StepFailure;
use crate::run::march::{Moving, Watcher, march};
use crate::run::samples::{BrokenRod, Run, Samples};
use crate::run::steps::{Stepped, Steps};
use crate::words::particles::Motion;

impl Scene {
    /// Runs a scene of bodies to its horizon, or until the watcher breaks off.
    pub(crate) fn run_bodies(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        match self.dimension {
            3 => self.run_system(&self.in_space()?, checkpoint, watcher),
            _ => self.run_system(&self.in_the_plane()?, checkpoint, watcher),
        }
    }

    fn run_system(
        &self,
        system: &impl BodySystem,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        let (steps, state) = (system.steps(self)?, system.initial().clone());
        march(self, Bodies { scene: self, system, steps, state }, checkpoint, watcher)
    }

    fn sample(
        &self,
        system: &impl BodySystem,
        state: &State<Vec<f64>>,
        time: f64,
        samples: &mut Samples,
    ) {
        let motions: Vec<BodyMotion> =
            (0..self.bodies.len()).map(|body| system.motion(state, body)).collect();
        let at = |particle: &Motion| match *particle {
            Motion::Carried { body, point } => {
                let BodyMotion { pose, velocity, angular_velocity } = &motions[body];
                let point = Vector3::from(point);
                let turning = pose.rotation.rotate(&angular_velocity.cross(&point));
                (pose.apply(&point).into(), (velocity + turning).into())
            }
            _ => ([0.0; 3], [0.0; 3]),
        };
        let (positions, velocities): (Vec<[f64; 3]>, Vec<[f64; 3]>) =
            self.particles.iter().map(|particle| at(&particle.motion)).unzip();
        let [kinetic, potential] = system.energies(state);
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        let mut scales = [0.0; 2];
        for (body, motion) in self.bodies.iter().zip(&motions) {
            let (x, p) = (motion.pose.translation, motion.velocity * body.mass);
            let m = Vector3::from(body.moments).component_mul(&motion.angular_velocity);
            linear += p;
            angular += x.cross(&p) + motion.pose.rotation.rotate(&m);
            scales[0] += p.norm();
            scales[1] += x.norm() * p.norm() + m.norm();
        }
        let mut bodies = Vec::new();
        (0..self.bodies.len()).for_each(|body| system.append_field(state, body, &mut bodies));
        let turning: Vec<[f64; 3]> = motions.iter().map(|m| m.angular_velocity.into()).collect();
        let moment = Moment {
            kinetic,
            potential,
            linear: linear.into(),
            angular: angular.into(),
            positions: &positions,
            velocities: &velocities,
            angular_velocities: &turning,
            bodies: &bodies,
            ..Moment::default()
        };
        samples.push(self, time, &moment, scales);
    }
}

/// The bodies of a scene on their way.
struct Bodies<'a, B> {
    scene: &'a Scene,
    system: &'a B,
    steps: Box<dyn Steps + 'a>,
    /// Its own time, a sum of steps, is what joints remember it by.
    state: State<Vec<f64>>,
}

impl<B: BodySystem> Moving for Bodies<'_, B> {
    fn state(&self) -> &State<Vec<f64>> {
        &self.state
    }

    fn step(&mut self, h: f64, to: f64) -> Result<Stepped, StepFailure> {
        self.steps.step(&mut self.state, h, to)
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        self.steps.pushes(time, see);
    }

    fn built(&self) -> Built {
        Built { bodies: self.scene.bodies.len() as u64, ..self.steps.built() }
    }

    fn sample(&mut self, time: f64, samples: &mut Samples) {
        self.scene.sample(self.system, &self.state, time, samples);
    }

    fn broken(&self) -> &[BrokenRod] {
        &[]
    }

    fn failed(&self, step: u64, time: f64, source: StepFailure, run: Run) -> RunError {
        let h = self.scene.timing.step();
        let turn = |body| h * self.system.motion(&self.state, body).angular_velocity.norm();
        let turns: Vec<f64> = (0..self.scene.bodies.len()).map(turn).collect();
        match self.scene.turn_named(&source, &turns) {
            Some(words) => run.stopped_by(Some(words), step, time, source),
            None => run.stopped(step, time, source),
        }
    }

    fn save(&mut self) -> Saved {
        self.steps.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.steps.load(before)?;
        self.state.clone_from(&before.state);
        Ok(())
    }
}
