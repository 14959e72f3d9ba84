//! Equations that Newton's method solves: what each of them knows of itself.
//!
//! ```text
//! f(x) = 0,    df(x) delta = -f(x),    optionally f = dE
//! ```
//! `x` the unknowns (n), `f` the residual (n), `df` its differential (n x n) or what the equation takes
//! for it, `E` an energy. The equation measures its residuals and solves its linearization; whoever
//! searches for its root knows nothing of matrices, and the equation nothing of steps and tolerances.

/// An equation f(x) = 0 in n unknowns that can be linearized.
pub trait Equation {
    /// Writes f(x).
    fn residual(&mut self, x: &[f64], f: &mut [f64]);

    /// Replaces `f` by `df(x)^-1 f`.
    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable>;

    /// The size of a residual, in the units of the tolerance.
    fn norm(&mut self, f: &[f64]) -> f64;

    /// The energy whose differential is f, where there is one.
    fn energy(&mut self, x: &[f64]) -> Option<f64>;

    /// What a step must lower.
    fn merit(&self) -> Merit {
        Merit::Residual
    }
}

/// What a step must lower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Merit {
    /// The residual by half; or, where a step does not, the energy, or the residual by a little.
    /// Finds any root, at the price of no energies where all goes well.
    #[default]
    Residual,
    /// The energy, at every step that descends. Finds a minimum, not a maximum or a saddle.
    Energy,
}

/// The linearized equation has no solution that can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// A pivot vanished.
    #[error("the linearized equation is singular to working precision")]
    Singular,
    /// The linearization overflowed, or was evaluated outside its domain.
    #[error("the linearized equation has numbers that are not finite")]
    NonFinite,
    /// A Hessian or Jacobian must visit the same blocks in the same order as when it was analysed.
    #[error("block {block} of the linearization is not where it was when its pattern was analysed")]
    PatternChanged {
        /// The first block that differs, counted from 0.
        block: usize,
    },
    /// The factorization was finished, but what it gives does not solve the equation.
    #[error("the linearized equation was solved with a relative residual of {relative_residual:e}")]
    Untrusted {
        /// The best residual that refinement reached, relative to the right-hand side.
        relative_residual: f64,
    },
}

/// The Euclidean length, not a number if any component is none.
pub(crate) fn length(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
