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
//! [`ConstraintOn`] says. Too few numbers, or room for others than m values, are an error and never
//! numbers. Zero must be a regular value: J has full row rank wherever g = 0, or there is no surface
//! to stay on (notes 8.1). Source: notes 6; errata conventions (multipliers are forces).

use stationary_calculus::{Sink, SizeError};

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
    /// The length of the thing constrained, in the units of q: L for a rod of that length, 0 of a joint that has
    /// none, as at the centres of its bodies: then what counts are the bodies' lengths.
    pub length: f64,
    /// What it measures.
    pub measure: Measure,
}

/// What an equation measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// What all numbers of q do.
    #[default]
    Plain,
    /// A length among bodies.
    Length(BodyNumbers),
    /// A turn among bodies, radians: it counts as the way that it makes at the size of the bodies.
    Turn(BodyNumbers),
}

/// How the numbers of bodies follow each other: of each its lengths, then those of its turn. What comes after the
/// bodies are lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyNumbers {
    /// How many bodies.
    pub bodies: usize,
    /// The numbers of a body in a configuration.
    pub stored: usize,
    /// Its freedoms.
    pub freedoms: usize,
    /// How many of both are lengths.
    pub lengths: usize,
}

impl BodyNumbers {
    /// Whether this freedom turns a body.
    pub(crate) fn turns(&self, freedom: usize) -> bool {
        let own = freedom.checked_rem(self.freedoms).unwrap_or(0);
        freedom < self.bodies.saturating_mul(self.freedoms) && own >= self.lengths
    }
}

impl Default for Scale {
    /// An equation that is a distance, of things of unit size.
    fn default() -> Self {
        Scale { slope: 1.0, length: 1.0, measure: Measure::Plain }
    }
}

/// Equations that a configuration must satisfy.
///
/// A configuration may have more numbers than a constraint reads. One that has fewer is a
/// [`SizeError`], and so are lists of values or multipliers that have not m numbers: each function
/// looks at its sizes before it reads, and on an error has brought nothing, or of a set what its first
/// members brought.
pub trait Constraint {
    /// The number of freedoms n of the system; at least those that it reads.
    fn dim(&self) -> usize;

    /// The number of equations m.
    fn count(&self) -> usize;

    /// Writes g(t, q), m numbers.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the constraint reads; room for another number than m.
    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError>;

    /// Brings the entries of J, row after row, at most one for a row and a freedom; the same places
    /// in the same order for every t and q.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the constraint reads.
    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError>;

    /// Adds the sum of `lambda_i d2g_i`, the same blocks in the same order every time.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the constraint reads; another number of multipliers
    /// than of equations.
    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError>;

    /// Writes dg/dt at a configuration that stays, m numbers: zero unless something is driven.
    ///
    /// # Errors
    /// Room for another number than m; a configuration with fewer numbers than the constraint reads
    /// for its rates.
    fn rate(&self, _t: f64, _q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), rate)?;
        rate.fill(0.0);
        Ok(())
    }

    /// How large the numbers of equation `row` typically are.
    fn scale(&self, _row: usize) -> Scale {
        Scale::default()
    }

    /// How a message names what equation `row` holds, as "hinge between body 1 and the world"; `None` where
    /// the number of the equation must do.
    fn describe(&self, _row: usize) -> Option<String> {
        None
    }
}

/// A constraint that says of itself that it reads the configurations of the space S. Where the space
/// may be any, only such are taken.
pub trait ConstraintOn<S>: Constraint {}

impl<S, K: ConstraintOn<S>> ConstraintOn<S> for &K {}

/// An equation of a constraint as a message names it: its number, and what it holds where that has a name.
pub fn equation_name(constraint: &impl Constraint, row: usize) -> String {
    match constraint.describe(row) {
        Some(name) => format!("equation {row} ({name})"),
        None => format!("equation {row}"),
    }
}

/// An error where a configuration has fewer numbers than a constraint reads.
///
/// # Errors
/// Fewer numbers than are read.
#[inline]
pub fn check_read(read: usize, q: &[f64]) -> Result<(), SizeError> {
    SizeError::check("the configuration's numbers", read, q.len().min(read))
}

/// An error unless there is a value for each equation.
///
/// # Errors
/// Another number of values than of equations.
#[inline]
pub fn check_values(count: usize, values: &[f64]) -> Result<(), SizeError> {
    SizeError::check("the constraint's values", count, values.len())
}

/// An error unless there is a multiplier for each equation.
///
/// # Errors
/// Another number of multipliers than of equations.
#[inline]
pub fn check_multipliers(count: usize, lambda: &[f64]) -> Result<(), SizeError> {
    SizeError::check("the constraint's multipliers", count, lambda.len())
}

impl<K: Constraint> Constraint for &K {
    fn dim(&self) -> usize {
        K::dim(self)
    }

    fn count(&self) -> usize {
        K::count(self)
    }

    #[inline]
    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        K::value(self, t, q, g)
    }

    #[inline]
    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        K::differential(self, t, q, rows)
    }

    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        K::add_hessian(self, t, q, lambda, hessian)
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        K::rate(self, t, q, rate)
    }

    fn scale(&self, row: usize) -> Scale {
        K::scale(self, row)
    }

    fn describe(&self, row: usize) -> Option<String> {
        K::describe(self, row)
    }
}
