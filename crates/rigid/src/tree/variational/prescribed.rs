//! Joints of a variational step that follow schedules, and the force that it takes.
//!
//! ```text
//! A = -D1 L(q, q') - p,     B = what makes  (M^-1 p')_k = s.(t + h)
//! ```
//! impulses of the driven coordinates `k`, newton seconds or newton metre seconds.

use stationary_calculus::SizeError;
use stationary_integrators::StepError;

use super::super::error::TreeError;
use super::super::prescribed::TreeDrive;
use super::super::spatial::{SpatialForce, Twist};
use super::TreeVariational;

/// Joints that follow schedules.
#[derive(Clone, Default)]
pub(super) struct Prescribed {
    pub(super) drives: Vec<TreeDrive>,
    /// Of each speed, whether it follows one; empty where none does.
    held: Vec<bool>,
    /// The mean force of each in the last step, and their work.
    forces: Vec<f64>,
    work: f64,
}

impl Prescribed {
    pub(super) fn holds(&self, speed: usize) -> bool {
        self.held.get(speed).copied().unwrap_or(false)
    }

    /// Sets the coordinates that follow schedules.
    pub(super) fn lead(&self, t: f64, q: &mut [f64]) {
        for drive in &self.drives {
            q[drive.coordinate] = drive.motion(t)[0];
        }
    }
}

impl<D> TreeVariational<D> {
    /// The same step where joints follow schedules, whatever force it takes.
    ///
    /// # Errors
    /// Drives of another tree, or two of one speed: [`TreeError::DrivenTwice`].
    pub fn prescribed(mut self, drives: Vec<TreeDrive>) -> Result<Self, TreeError> {
        let (coordinates, speeds) = (self.tree().coordinates(), self.tree().speeds());
        let mut held = vec![false; speeds];
        for drive in &drives {
            SizeError::check("the tree's speeds", speeds, speeds.max(drive.speed + 1))?;
            let least = coordinates.max(drive.coordinate + 1);
            SizeError::check("the tree's coordinates", coordinates, least)?;
            if std::mem::replace(&mut held[drive.speed], true) {
                return Err(TreeError::DrivenTwice { speed: drive.speed });
            }
        }
        for motion in [&mut self.before, &mut self.after] {
            motion.held.reserve(drives.len());
        }
        let forces = vec![0.0; drives.len()];
        self.prescribed = Prescribed { drives, held, forces, work: 0.0 };
        Ok(self)
    }

    /// The mean force of each prescribed motion in the last step: N, or N m.
    pub fn drive_forces(&self) -> &[f64] {
        &self.prescribed.forces
    }

    /// The work of the prescribed motions in the last step, joules.
    pub fn drive_work(&self) -> f64 {
        self.prescribed.work
    }

    /// Holds what follows schedules: the impulse that the end of the step takes, beyond that at its start, with the
    /// speeds that the schedules have there.
    pub(super) fn hold(&mut self, (t, h): (f64, f64)) -> Result<(), StepError> {
        let TreeVariational { before, after, equations, prescribed, speeds, next, kicks, .. } =
            self;
        // At the start: what the bodies carry beyond the momenta that are there.
        for (body, link) in before.tree.links.iter().enumerate() {
            let (carried, moved) = (&equations.carried[body], &equations.moved[body]);
            before.forces[body] = SpatialForce {
                force: carried.force + moved.linear * (link.mass / h),
                torque: carried.torque + equations.slopes[body] * moved.angular,
            };
        }
        before.gather(speeds);
        prescribed.work = 0.0;
        for (force, drive) in prescribed.forces.iter_mut().zip(&prescribed.drives) {
            let impulse = speeds[drive.speed] - kicks.momenta[drive.speed];
            *force = impulse / h;
            prescribed.work += impulse * drive.motion(t)[1];
        }
        // At the end: what it takes to have the schedules' speeds.
        after.moving.iter_mut().for_each(|moving| moving.bias = Twist::zero());
        after.held.clear();
        for drive in &prescribed.drives {
            after.held.push(drive.speed);
            after.accelerate_along(drive.speed, drive.motion(t + h)[1]);
        }
        let factored = after.factor();
        after.forces.fill(SpatialForce::zero());
        if factored.is_ok() {
            after.solve(next.p.components(), |moving| moving.bias, speeds);
        }
        after.held.clear();
        factored.map_err(|_| StepError::SingularLegendreTransform)?;
        for (force, drive) in prescribed.forces.iter_mut().zip(&prescribed.drives) {
            let impulse = speeds[drive.speed];
            next.p.components_mut()[drive.speed] += impulse;
            *force += impulse / h;
            prescribed.work += impulse * drive.motion(t + h)[1];
        }
        Ok(())
    }
}
