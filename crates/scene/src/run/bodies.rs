//! A run of bodies: step after step to the horizon, and samples of their centres and points.

use nalgebra::Vector3;
use stationary_integrators::State;
#[cfg(feature = "constraints")]
use stationary_rigid::BodyMethod;
use stationary_rigid::BodyMotion;

use crate::assemble::acting::Acting;
use crate::assemble::body_system::{BodySystem, InSpace, InThePlane};
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::columns::Moment;
use crate::model::particle::{Motion, Particle};
use crate::model::scene::Scene;
use crate::model::stepping::Stepping;
use crate::run::checkpoint::Checkpoint;
use crate::run::driven::kicked;
use crate::run::engine::{Clock, Engine};
use crate::run::equal::Equal;
use crate::run::error::{RunError, StepFailure};
use crate::run::joint_coordinates;
use crate::run::observer::Observer;
use crate::run::recorder::{Failed, Recorder};
use crate::run::samples::{BrokenRod, Run, Samples, whole_rods};
use crate::run::stepper::Stepper;

impl Scene {
    /// Runs a scene of bodies to its horizon, or until the observer breaks off.
    pub(crate) fn run_bodies(
        &self,
        checkpoint: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        if self.dimension == 3 {
            let system = self.in_space()?;
            if self.moves_joints() {
                #[cfg(feature = "constraints")]
                if !self.rods.is_empty() {
                    // A start that moves against its rods is refused as in full coordinates.
                    let (method, start) =
                        (BodyMethod::VariationalRotation, (&system.initial, None));
                    crate::run::joints::in_space(method, &system.system, &system.joints, start)?;
                }
                let stepper = joint_coordinates::stepper(self, &system)?;
                return self.run_system(&system, stepper, checkpoint, observer);
            }
            return self.run_system(&system, in_space(self, &system)?, checkpoint, observer);
        }
        let system = self.in_the_plane()?;
        if self.moves_joints() {
            #[cfg(feature = "constraints")]
            if !self.rods.is_empty() {
                let start = (&system.initial, None);
                crate::run::joints::in_the_plane(&system.system, &system.joints, start)?;
            }
            let stepper = joint_coordinates::stepper(self, &system)?;
            return self.run_system(&system, stepper, checkpoint, observer);
        }
        self.run_system(&system, in_the_plane(self, &system)?, checkpoint, observer)
    }

    fn run_system(
        &self,
        system: &dyn BodySystem,
        stepper: Box<dyn Stepper + '_>,
        checkpoint: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        let springs = self.links.len() as u64;
        let built = Built { bodies: self.bodies.len() as u64, springs, ..stepper.built() };
        let (acting, tensions) = (Acting::of(self), vec![0.0; self.rods.len()]);
        let (left, broken) = ((0..self.rods.len()).collect(), Vec::new());
        let recorder =
            Box::new(BodyRecorder { scene: self, system, acting, tensions, left, broken });
        let (state, clock) = (system.initial().clone(), Clock::OfTheSteps);
        Engine { scene: self, state, stepper, recorder, clock, built }
            .integrate(checkpoint, observer)
    }
}

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// What steps bodies in space.
fn in_space<'a>(scene: &'a Scene, of: &'a InSpace) -> Made<'a> {
    #[cfg(feature = "contact")]
    if let Stepping::EventDriven(flights) = scene.stepping {
        return crate::run::event_driven::in_space(scene, of, flights);
    }
    #[cfg(feature = "contact")]
    if let Stepping::ErrorControlled { tolerance } = scene.stepping {
        return crate::run::error_controlled::in_space(scene, of, tolerance);
    }
    let Stepping::Bodies(method) = scene.stepping else {
        return Err(AssemblyError::Bodies);
    };
    let InSpace { system, joints, initial } = of;
    #[cfg(feature = "contact")]
    if scene.has_inequalities() {
        return crate::run::touching::in_space(scene, of);
    }
    #[cfg(feature = "constraints")]
    if scene.has_joints() {
        return crate::run::joints::in_space(
            method,
            system,
            joints,
            (initial, crate::run::driven::shared(scene)),
        );
    }
    let _ = (joints, initial);
    Ok(kicked(scene, Box::new(Equal::without_solver(method.integrator(system)?))))
}

/// What steps bodies in the plane.
fn in_the_plane<'a>(scene: &'a Scene, of: &'a InThePlane) -> Made<'a> {
    #[cfg(feature = "contact")]
    if let Stepping::EventDriven(flights) = scene.stepping {
        return crate::run::event_driven::in_the_plane(scene, of, flights);
    }
    #[cfg(feature = "contact")]
    if let Stepping::ErrorControlled { tolerance } = scene.stepping {
        return crate::run::error_controlled::in_the_plane(scene, of, tolerance);
    }
    let Stepping::Equal(method) = scene.stepping else {
        return Err(AssemblyError::Bodies);
    };
    let InThePlane { system, joints, initial } = of;
    #[cfg(feature = "contact")]
    if scene.has_inequalities() {
        return crate::run::touching::in_the_plane(scene, of);
    }
    #[cfg(feature = "constraints")]
    if scene.has_joints() {
        return crate::run::joints::in_the_plane(
            system,
            joints,
            (initial, crate::run::driven::shared(scene)),
        );
    }
    let _ = (joints, initial);
    Ok(kicked(scene, Box::new(Equal::without_solver(method.integrator(system)?))))
}

/// Takes samples of bodies, and of their points.
struct BodyRecorder<'a> {
    scene: &'a Scene,
    system: &'a dyn BodySystem,
    acting: Option<Acting>,
    /// Of all rods; zero of those that broke.
    tensions: Vec<f64>,
    /// The rods that are left, by their places in the scene, and those that broke.
    left: Vec<usize>,
    broken: Vec<BrokenRod>,
}

impl Recorder for BodyRecorder<'_> {
    fn sample(&mut self, state: &State<Vec<f64>>, time: f64, samples: &mut Samples) {
        let (scene, system) = (self.scene, self.system);
        let motions: Vec<BodyMotion> =
            (0..scene.bodies.len()).map(|body| system.motion(state, body)).collect();
        let at = |particle: &Particle| match particle.motion {
            Motion::Carried { body, point } => {
                let BodyMotion { pose, velocity, angular_velocity } = &motions[body];
                let point = Vector3::from(point);
                let turning = pose.rotation.rotate(&angular_velocity.cross(&point));
                (pose.apply(&point).into(), (velocity + turning).into())
            }
            _ => (particle.position, [0.0; 3]),
        };
        let (mut positions, mut velocities): (Vec<[f64; 3]>, Vec<[f64; 3]>) =
            scene.particles.iter().map(at).unzip();
        for motion in &scene.drives.motions {
            let start = scene.particles[motion.particle].position;
            positions[motion.particle] = motion.place(start, time);
            velocities[motion.particle] = motion.velocity(time);
        }
        let [kinetic, potential] = system.energies(state);
        let pulled = self.acting.as_ref().map_or(0.0, |acting| acting.energy(time, &state.q));
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        let mut scales = [0.0; 2];
        for (body, motion) in scene.bodies.iter().zip(&motions) {
            let (x, p) = (motion.pose.translation, motion.velocity * body.mass);
            let m = Vector3::from(body.moments).component_mul(&motion.angular_velocity);
            linear += p;
            angular += x.cross(&p) + motion.pose.rotation.rotate(&m);
            scales[0] += p.norm();
            scales[1] += x.norm() * p.norm() + m.norm();
        }
        let mut bodies = Vec::new();
        (0..scene.bodies.len()).for_each(|body| system.append_field(state, body, &mut bodies));
        let turning: Vec<[f64; 3]> = motions.iter().map(|m| m.angular_velocity.into()).collect();
        let moment = Moment {
            kinetic,
            potential: potential + pulled,
            linear: linear.into(),
            angular: angular.into(),
            positions: &positions,
            velocities: &velocities,
            angular_velocities: &turning,
            bodies: &bodies,
            tensions: &self.tensions,
            ..Moment::default()
        };
        samples.push(scene, time, &moment, scales);
    }

    fn check(&self, state: &State<Vec<f64>>) -> Result<(), StepFailure> {
        let inside = self.system.attraction().and_then(|attraction| attraction.inside(&state.q));
        if let Some((pair, [distance, radii])) = inside {
            let [first, second] = pair.map(|number| self.scene.attracting(number).to_owned());
            return Err(StepFailure::Inside { first, second, distance, radii });
        }
        let of_pins = self.acting.as_ref().and_then(|acting| acting.inside(state.t, &state.q));
        let Some(([body, pin], [distance, radii])) = of_pins else { return Ok(()) };
        let first = self.scene.bodies[body].name.clone();
        let second = self.scene.particles[pin].name.clone();
        Err(StepFailure::Inside { first, second, distance, radii })
    }

    fn feel(&mut self, multipliers: &[f64], broken: Option<BrokenRod>) {
        // Equations of joints come first; the multiplier of a rod's is its tension.
        let rods = multipliers.get(self.scene.rows_of_joints()..).unwrap_or_default();
        self.left.iter().zip(rods).for_each(|(&rod, force)| self.tensions[rod] = *force);
        if let Some(broken) = broken {
            let rod = self.left.remove(broken.rod);
            self.tensions[rod] = 0.0;
            self.broken.push(BrokenRod { rod, ..broken });
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
        let h = self.scene.timing.step();
        let turn = |body| h * self.system.motion(state, body).angular_velocity.norm();
        let turns: Vec<f64> = (0..self.scene.bodies.len()).map(turn).collect();
        let words = self.scene.turn_named(&failed.source, &turns);
        failed.stops(run, words)
    }
}
