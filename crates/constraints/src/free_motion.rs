//! How a system moves between two kicks: the free motion, along which multipliers hold it.
//!
//! ```text
//! (q, p) -> Phi_h(q, p)          the flow of 1/2 <p, M^-1 p>, or a symplectic map close to it
//! straight   q' = q + h M^-1 p,   p' = p
//! ```
//! `q` configuration, `p` momentum covector (n), `M` the metric, `h` seconds. The straight motion
//! is the free one of flat spaces, and is that of no other: where a body's axes turn under it the
//! momentum's components turn, too, and a crate that knows the space brings its own motion. A map that is symmetric and symplectic makes RATTLE so,
//! of order 2; to first order in h it must be straight. Source: notes 6.5, 9.5; Leimkuhler and
//! Reich (2004), 7.2.

use stationary_calculus::{Covector, Flat, Metric, Space, Vector};
use stationary_integrators::StepError;

/// A motion free of forces.
pub trait FreeMotion<M, S> {
    /// Moves `q` and `p` from a time for an interval, both in seconds. `room` holds as many numbers as `p`, of no
    /// meaning.
    ///
    /// # Errors
    /// A step that the motion cannot make; `q` and `p` are then undefined.
    fn advance(
        &mut self,
        metric: &M,
        space: &S,
        interval: (f64, f64),
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        room: Vector<&mut [f64]>,
    ) -> Result<(), StepError>;

    /// Takes the last motion for that of a step, which is made: of others, and of steps that fail, it tells nothing.
    fn accept(&mut self) {}
}

/// The motion of constant momentum on flat space.
///
/// On no other: bodies whose moments differ would move without their gyroscopic torque.
/// ```compile_fail
/// use stationary_calculus::{Metric, Space};
/// use stationary_constraints::{FreeMotion, Straight};
/// fn moves<M, S, F: FreeMotion<M, S>>(_: F) {}
/// fn on_any_space<M: Metric, S: Space>() {
///     moves::<M, S, Straight>(Straight);
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Straight;

impl<M: Metric> FreeMotion<M, Flat> for Straight {
    #[inline]
    fn advance(
        &mut self,
        metric: &M,
        space: &Flat,
        (_, h): (f64, f64),
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        mut room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        metric.drift(h, p.view(), room.view_mut());
        space.advance(q, 1.0, room.view());
        Ok(())
    }
}
