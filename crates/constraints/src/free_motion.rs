//! How a system moves between two kicks: the free motion, along which multipliers hold it.
//!
//! ```text
//! (q, p) -> Phi_h(q, p)          the flow of 1/2 <p, M^-1 p>, or a symplectic map close to it
//! straight   q' = q exp(h M^-1 p),   p' = p
//! ```
//! `q` configuration, `p` momentum covector (n), `M` the metric, `h` seconds. The straight motion
//! is the free one where a body's axes do not turn under it: on flat spaces, and for bodies with
//! the same moment about all axes. Elsewhere the momentum's components turn, too, and a crate that
//! knows the space brings its own motion. A map that is symmetric and symplectic makes RATTLE so,
//! of order 2; to first order in h it must be straight. Source: notes 6.5, 9.5; Leimkuhler and
//! Reich (2004), 7.2.

use stationary_calculus::{Covector, Metric, Space, Vector};
use stationary_integrators::StepError;

/// A motion free of forces.
pub trait FreeMotion<M, S> {
    /// Moves `q` and `p` for `h` seconds. `room` holds as many numbers as `p`, of no meaning.
    ///
    /// # Errors
    /// A step that the motion cannot make; `q` and `p` are then undefined.
    fn advance(
        &self,
        metric: &M,
        space: &S,
        h: f64,
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        room: Vector<&mut [f64]>,
    ) -> Result<(), StepError>;
}

/// The motion of constant momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Straight;

impl<M: Metric, S: Space> FreeMotion<M, S> for Straight {
    #[inline]
    fn advance(
        &self,
        metric: &M,
        space: &S,
        h: f64,
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        mut room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        metric.drift(h, p.view(), room.view_mut());
        space.advance(q, 1.0, room.view());
        Ok(())
    }
}
