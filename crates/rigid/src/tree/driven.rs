//! What acts on a tree in a variational step beside its weight: a kick at either end.
//!
//! ```text
//! p~ = p  + h/2 f(t, q, v),              v  = M^-1 p
//! p' = p^ + h/2 f(t + h, q', v'),        v' = M^-1 p'             solved for p' by iteration
//! W  = h/2 <f, (v + v~)/2> + h/2 <f', (v^ + v')/2>
//! ```
//! `f` the forces of bodies and joints as the joints feel them, `p` momenta and `v` speeds of the joints,
//! `M` the mass matrix, `W` their work in the step, joules: the kinetic energy that the kicks bring. The
//! second kick is the first one backward: order 2, whatever the forces depend on. The iteration
//! contracts where `h/2 |M^-1 df/dv| < 1`; a step too long for its dampers is an error.

use stationary_calculus::{NewtonError, NewtonFailure};
use stationary_integrators::StepError;

use super::error::TreeError;
use super::forces::TreeForces;
use super::motion::TreeMotion;

/// Most iterations of the second kick.
const ITERATIONS: usize = 100;
/// A change of speeds this small against them is rounding.
const ROUNDING: f64 = 4e-16;
/// What no longer falls in so many iterations is rounding up to this, of a mass matrix that multiplies it.
const PATIENCE: u32 = 3;
const STAGNANT: f64 = 1e-10;

/// The memory of the kicks.
#[derive(Clone, Debug)]
pub(super) struct Kicks {
    forces: TreeForces,
    impulse: Vec<f64>,
    speeds: [Vec<f64>; 2],
    pub(super) momenta: Vec<f64>,
    /// In the step that is tried.
    pub(super) tried: f64,
    pub(super) work: f64,
}

/// What adds to the forces at a time and a motion.
pub(super) type Drive<'a> = &'a dyn Fn(f64, &TreeMotion, &mut TreeForces);

impl Kicks {
    pub(super) fn new(motion: &TreeMotion) -> Self {
        let zeros = vec![0.0; motion.tree.speeds()];
        Kicks {
            forces: TreeForces::none(&motion.tree),
            impulse: zeros.clone(),
            speeds: [zeros.clone(), zeros.clone()],
            momenta: zeros,
            tried: 0.0,
            work: 0.0,
        }
    }

    /// Sets the impulse of half a step at these coordinates, where the motion is placed, and the first
    /// speeds.
    fn push(
        &mut self,
        motion: &mut TreeMotion,
        drive: Drive,
        (t, h): (f64, f64),
        q: &[f64],
    ) -> Result<(), StepError> {
        motion.set_moving(q, &self.speeds[0]);
        self.forces.clear();
        drive(t, motion, &mut self.forces);
        motion.forces.copy_from_slice(&self.forces.bodies);
        motion.gather(&mut self.impulse);
        let joints = self.impulse.iter_mut().zip(&self.forces.joints);
        joints.for_each(|(impulse, joint)| *impulse = 0.5 * h * (*impulse + joint));
        match stationary_calculus::first_non_finite(&self.impulse) {
            Some(freedom) => Err(StepError::NonFiniteMomentum { freedom }),
            None => Ok(()),
        }
    }

    /// The first kick: the momenta `p` with it, in `momenta`. The motion is placed at `q`.
    pub(super) fn before(
        &mut self,
        motion: &mut TreeMotion,
        drive: Drive,
        interval: (f64, f64),
        (q, p): (&[f64], &[f64]),
    ) -> Result<(), StepError> {
        motion.speeds_of(p, &mut self.speeds[0]).map_err(speedless)?;
        self.push(motion, drive, interval, q)?;
        let pushed = p.iter().zip(&self.impulse).map(|(p, f)| p + f);
        self.momenta.iter_mut().zip(pushed).for_each(|(sum, pushed)| *sum = pushed);
        motion.speeds_of(&self.momenta, &mut self.speeds[1]).map_err(speedless)?;
        self.tried = self.along();
        Ok(())
    }

    /// The second kick, of momenta at the step's end.
    pub(super) fn after(
        &mut self,
        motion: &mut TreeMotion,
        drive: Drive,
        (t, h): (f64, f64),
        (q, p): (&[f64], &mut [f64]),
    ) -> Result<(), StepError> {
        motion.speeds_of(p, &mut self.speeds[1]).map_err(speedless)?;
        let [now, arrived] = &mut self.speeds;
        now.copy_from_slice(arrived);
        let (mut last, mut best, mut stale) = (f64::INFINITY, f64::INFINITY, 0);
        let mut history = [0.0; ITERATIONS];
        for iteration in 0..ITERATIONS {
            self.push(motion, drive, (t + h, h), q)?;
            let pushed = p.iter().zip(&self.impulse).map(|(p, f)| p + f);
            self.momenta.iter_mut().zip(pushed).for_each(|(sum, pushed)| *sum = pushed);
            let [now, arrived] = &mut self.speeds;
            self.forces.joints.copy_from_slice(now);
            motion.speeds_of(&self.momenta, now).map_err(speedless)?;
            let scale = now.iter().chain(arrived.iter()).fold(0.0_f64, |s, v| s.max(v.abs()));
            let moved = now.iter().zip(&self.forces.joints);
            let change = moved.fold(0.0_f64, |most, (now, then)| most.max((now - then).abs()));
            history[iteration] = change;
            (best, stale) = if change < 0.95 * best { (change, 0) } else { (best, stale + 1) };
            if change <= ROUNDING * scale
                || (change >= 0.5 * last && change <= 1e-13 * scale)
                || (stale >= PATIENCE && change <= STAGNANT * scale)
            {
                p.copy_from_slice(&self.momenta);
                self.tried += self.along();
                return Ok(());
            }
            if change.is_nan() || change > 1e12 * scale.max(last) {
                return Err(failed(&history[..=iteration]));
            }
            last = change;
        }
        Err(failed(&history))
    }

    /// The impulse along the mean of both speeds.
    fn along(&self) -> f64 {
        let means = self.speeds[0].iter().zip(&self.speeds[1]).map(|(a, b)| 0.5 * (a + b));
        self.impulse.iter().zip(means).map(|(f, v)| f * v).sum()
    }
}

fn speedless(error: TreeError) -> StepError {
    match error {
        TreeError::Singular { .. } => StepError::SingularLegendreTransform,
        TreeError::NonFinite { index, .. } => StepError::NonFiniteMomentum { freedom: index },
        _ => StepError::NonFiniteMomentum { freedom: 0 },
    }
}

#[cold]
fn failed(history: &[f64]) -> StepError {
    NewtonError { failure: NewtonFailure::NotConverged, history: history.to_vec() }.into()
}
