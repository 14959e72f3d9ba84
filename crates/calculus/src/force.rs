//! Forces that no potential gives: drag, motors, loads that change with time.
//!
//! ```text
//! p. = -dV(q) + F(t, q, v)         F a covector (n), newtons where q is a length
//! C = -dF/dv                       damping, n x n, for those who solve with it
//! ```
//! `t` seconds, `q` a configuration, `v` a velocity (n). The power that a force puts into the
//! system is `<F, v>` (notes 10.1).

use crate::{Covector, Sink, Vector};

/// A force on the configurations of a system with [`dim`](Force::dim) freedoms.
pub trait Force {
    /// The number of freedoms n.
    fn dim(&self) -> usize;

    /// Adds F(t, q, v) to `f`.
    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>);

    /// Adds the symmetric part of -dF/dv, block by block, in the same order for every q and v.
    ///
    /// What dF/dq and an unsymmetric dF/dv leave out costs Newton's method iterations, not
    /// correctness.
    fn add_damping(&self, _t: f64, _q: &[f64], _v: Vector<&[f64]>, _damping: &mut impl Sink) {}
}

impl<F: Force> Force for &F {
    fn dim(&self) -> usize {
        F::dim(self)
    }

    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        F::add_force(self, t, q, v, f);
    }

    fn add_damping(&self, t: f64, q: &[f64], v: Vector<&[f64]>, damping: &mut impl Sink) {
        F::add_damping(self, t, q, v, damping);
    }
}
