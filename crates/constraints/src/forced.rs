//! A free motion between the two kicks of a force: what gives forces to every method that drifts along
//! a [`FreeMotion`].
//!
//! ```text
//! kick of h/2 F,   (q, p) -> Phi_h(q, p),   kick of h/2 F
//! ```
//! RATTLE along it keeps its order, its symmetry and its constraints; momenta change by the impulses of
//! the forces, to rounding. The kicks, their works, and the principle behind them are in [`ForceKicks`].

use stationary_calculus::{Covector, Force, Metric, Vector};
use stationary_integrators::StepError;

use crate::{ForceKicks, FreeMotion};

/// A free motion with forces.
#[derive(Clone, Debug)]
pub struct Forced<G, F> {
    motion: G,
    kicks: ForceKicks<F>,
}

impl<G, F: Force> Forced<G, F> {
    /// This motion under this force.
    pub fn new(motion: G, force: F) -> Self {
        Forced { motion, kicks: ForceKicks::new(force) }
    }

    /// The force.
    pub fn force(&self) -> &F {
        self.kicks.force()
    }

    /// The work of each thing that acts, in the last step that was made, joules.
    pub fn works(&self) -> &[f64] {
        self.kicks.works()
    }
}

impl<M: Metric, S, G: FreeMotion<M, S>, F: Force> FreeMotion<M, S> for Forced<G, F> {
    fn advance(
        &mut self,
        metric: &M,
        space: &S,
        interval: (f64, f64),
        q: &mut [f64],
        mut p: Covector<&mut [f64]>,
        room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        self.kicks.before(metric, interval, q, &mut p)?;
        self.motion.advance(metric, space, interval, q, p.view_mut(), room)?;
        self.kicks.after(metric, interval, q, &mut p);
        Ok(())
    }

    fn accept(&mut self) {
        self.motion.accept();
        self.kicks.accept();
    }
}
