//! A constraint: functions of the configuration that must stay zero, with their differentials.
//!
//! ```text
//! g(t, q) = 0                 m equations                                             (6)
//! J = dg                      m x n, sparse, one row for each equation
//! sum_i lambda_i d2g_i        n x n, symmetric, for multipliers lambda (m)
//! J v + dg/dt = 0             what it asks of the velocity
//! F = -J^T lambda             the force that keeps it, a covector
//! ```
//! `t` seconds, `q` a configuration, `v` a velocity (n freedoms). The columns of J belong to the
//! freedoms of velocities, never to the stored numbers of q: J v is the rate of g where q moves
//! along v by [`Space::advance`](stationary_calculus::Space::advance). The units of g are the
//! constraint's own; [`Scale`] turns them into lengths, so that violations and ranks can be judged.
//!
//! A tuple or a `Vec` of constraints is a constraint. Which spaces' configurations it reads,
//! [`ConstraintOn`] says. Asked of too few numbers, its values are not numbers. Zero must be a regular value: J has full row
//! rank wherever g = 0, or there is no surface to stay on (notes 8.1). Source: notes 6; errata
//! conventions (multipliers are forces).

use stationary_calculus::Sink;

/// Takes the entries of a differential, one after another.
pub trait Rows {
    /// Adds `value` at a row and the column of a freedom.
    fn add(&mut self, row: usize, freedom: usize, value: f64);
}

/// How large the numbers of an equation typically are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The length of its row of J, in the units of g over those of q: 2 L for `|d|^2 - L^2`.
    pub slope: f64,
    /// The length of the thing constrained, in the units of q: L for a rod of that length.
    pub length: f64,
}

impl Default for Scale {
    /// An equation that is a distance, of things of unit size.
    fn default() -> Self {
        Scale { slope: 1.0, length: 1.0 }
    }
}

/// Equations that a configuration must satisfy.
pub trait Constraint {
    /// The number of freedoms n of the system; at least those that it reads.
    fn dim(&self) -> usize;

    /// The number of equations m.
    fn count(&self) -> usize;

    /// Writes g(t, q), m numbers; what is not a number where `q` has too few.
    fn value(&self, t: f64, q: &[f64], g: &mut [f64]);

    /// Brings the entries of J, row after row, at most one for a row and a freedom; the same places
    /// in the same order for every t and q.
    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows);

    /// Adds the sum of `lambda_i d2g_i`, the same blocks in the same order every time.
    fn add_hessian(&self, t: f64, q: &[f64], lambda: &[f64], hessian: &mut impl Sink);

    /// Writes dg/dt at a configuration that stays, m numbers: zero unless something is driven.
    fn rate(&self, _t: f64, _q: &[f64], rate: &mut [f64]) {
        rate.fill(0.0);
    }

    /// How large the numbers of equation `row` typically are.
    fn scale(&self, _row: usize) -> Scale {
        Scale::default()
    }
}

/// A constraint that says of itself that it reads the configurations of the space S. Where the space
/// may be any, only such are taken.
pub trait ConstraintOn<S>: Constraint {}

impl<S, K: ConstraintOn<S>> ConstraintOn<S> for &K {}

/// The number at a place, or what is not a number where there is none.
#[inline]
pub(crate) fn read(q: &[f64], freedom: usize) -> f64 {
    q.get(freedom).copied().unwrap_or(f64::NAN)
}

impl<K: Constraint> Constraint for &K {
    fn dim(&self) -> usize {
        K::dim(self)
    }

    fn count(&self) -> usize {
        K::count(self)
    }

    #[inline]
    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) {
        K::value(self, t, q, g);
    }

    #[inline]
    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) {
        K::differential(self, t, q, rows);
    }

    fn add_hessian(&self, t: f64, q: &[f64], lambda: &[f64], hessian: &mut impl Sink) {
        K::add_hessian(self, t, q, lambda, hessian);
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) {
        K::rate(self, t, q, rate);
    }

    fn scale(&self, row: usize) -> Scale {
        K::scale(self, row)
    }
}
