//! A run of bodies: step after step to the horizon, and samples of their centres and points.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_integrators::{Cost, State};
use stationary_rigid::BodyMotion;

use crate::body_system::BodySystem;
use crate::observable::Moment;
use crate::run::{Progress, Run, Samples};
use crate::{Motion, RunError, Scene};

impl Scene {
    /// Runs a scene of bodies to its horizon, or until the watcher breaks off.
    pub(crate) fn run_bodies(
        &self,
        watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        match self.dimension {
            3 => self.run_system(&self.in_space()?, watch),
            _ => self.run_system(&self.in_the_plane()?, watch),
        }
    }

    fn run_system(
        &self,
        system: &impl BodySystem,
        mut watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        let mut step_by = system.steps(self.stepping)?;
        let (timing, mut cost) = (self.timing, Cost::default());
        let (steps, h) = (timing.steps(), timing.stepping().step());
        let mut state = system.initial().clone();
        let (mut samples, mut impacts) = (self.no_samples(), Vec::new());
        self.sample(system, &state, 0.0, &mut samples);
        for step in 1..=steps {
            let time = (step - 1) as f64 * h;
            let stepped = match step_by(&mut state, h) {
                Ok(stepped) => stepped,
                Err(source) => {
                    if samples.times.last().is_some_and(|&last| last < time) {
                        self.sample(system, &state, time, &mut samples);
                    }
                    let run = Run { impacts, ..Run::quiet(self, samples, cost) };
                    return Err(run.stopped(step, time, source));
                }
            };
            // The state's own time, a sum of steps, is what joints remember it by.
            let time = step as f64 * h;
            cost.add(&stepped.report);
            if stepped.impacts > 0 {
                impacts.push((stepped.last_impact, stepped.impacts));
            }
            let flow = watch(Progress { step, steps, time, q: &state.q });
            if step % timing.sample_every() == 0 || step == steps || flow.is_break() {
                self.sample(system, &state, time, &mut samples);
            }
            if flow.is_break() {
                break;
            }
        }
        Ok(Run { impacts, ..Run::quiet(self, samples, cost) })
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
        let turning: Vec<[f64; 3]> = motions.iter().map(|m| m.angular_velocity.into()).collect();
        let moment = Moment {
            kinetic,
            potential,
            linear: linear.into(),
            angular: angular.into(),
            positions: &positions,
            velocities: &velocities,
            angular_velocities: &turning,
            ..Moment::default()
        };
        samples.push(self, time, &moment, scales);
    }
}
