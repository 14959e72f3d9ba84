//! A point on a curve in the plane or on a surface in space, given by one function.
//!
//! ```text
//! g = phi(t, x_i) = 0,    F = -lambda dphi      normal to the curve or surface
//! ```
//! `x_i` a free point in D dimensions, `phi` its level function, written once over any [`Number`].
//! A curve in space is a point on two surfaces. The differential must not vanish on the zero level:
//! `|x|^2 - r^2` will do, `(|x| - r)^2` will not (notes 6).

use stationary_calculus::{Flat, Number, Sink, SizeError, array};

use crate::{Constraint, ConstraintOn, Function, FunctionConstraint, Rows, Scale};

/// A function of time and a point, zero on the curve or surface.
pub trait Level<const D: usize> {
    /// The function.
    fn value<R: Number>(&self, t: R, x: [R; D]) -> R;

    /// How large it and its differential typically are.
    fn scale(&self) -> Scale {
        Scale::default()
    }
}

/// A level function as one equation.
#[derive(Clone, Debug, PartialEq)]
struct Equation<L>(L);

impl<L: Level<D>, const D: usize> Function<D, 1> for Equation<L> {
    fn value<R: Number>(&self, t: R, x: [R; D]) -> [R; 1] {
        [self.0.value(t, x)]
    }

    fn scale(&self, _: usize) -> Scale {
        self.0.scale()
    }
}

/// A point that stays on a curve (D = 2) or a surface (D = 3).
#[derive(Clone, Debug, PartialEq)]
pub struct LevelSet<L, const D: usize>(FunctionConstraint<Equation<L>, D, 1>);

impl<L: Level<D>, const D: usize> LevelSet<L, D> {
    /// Keeps a vertex on the zero level of a function.
    pub fn new(vertex: usize, level: L) -> Self {
        let freedoms = array(|c| D.saturating_mul(vertex).saturating_add(c));
        LevelSet(FunctionConstraint::of_distinct(Equation(level), freedoms))
    }
}

impl<L: Level<D>, const D: usize> ConstraintOn<Flat> for LevelSet<L, D> {}

impl<L: Level<D>, const D: usize> Constraint for LevelSet<L, D> {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        self.0.value(t, q, g)
    }

    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.0.differential(t, q, rows)
    }

    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        self.0.add_hessian(t, q, lambda, hessian)
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        self.0.rate(t, q, rate)
    }

    fn scale(&self, row: usize) -> Scale {
        self.0.scale(row)
    }
}
