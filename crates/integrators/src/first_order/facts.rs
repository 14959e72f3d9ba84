//! What is known of a method for first-order systems before it runs.

use super::{backward_differences, dormand_prince, dormand_prince_54, radau};
use crate::{Damping, Evaluation};

/// The facts of a method; tests assert each of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderFacts {
    /// Its name in the field, with lower-case letters and hyphens.
    pub name: &'static str,
    /// The power of h in the error at a fixed end time; the highest one where the order varies.
    pub order: u32,
    /// The power of h in the error of the dense output between steps.
    pub dense_order: u32,
    /// Evaluations of f in an accepted step, or stages of an implicit one.
    pub stages: u32,
    /// Evaluations of f that dense output costs on top: once for each step that is looked into, or
    /// for each moment within it where the method is implicit or a Nystrom pair.
    pub dense_stages: u32,
    /// Whether a step solves an equation.
    pub evaluation: Evaluation,
    /// The loosest relative tolerance that it tells from tighter ones: a looser one is held as this.
    pub loosest: f64,
    /// What it does to fast decay.
    pub damping: Damping,
    /// Half the opening angle, in degrees, of the largest sector about the negative real axis in
    /// which y' = lambda y decays at every step: 90 for A-stability, 0 for none.
    pub sector: f64,
}

impl FirstOrderFacts {
    /// The facts of every method for first-order systems, of the formulas of variable order at
    /// their highest and at order 2.
    pub fn all() -> [FirstOrderFacts; 5] {
        let formulas = backward_differences::facts;
        [dormand_prince::FACTS, dormand_prince_54::FACTS, radau::FACTS, formulas(5), formulas(2)]
    }
}
