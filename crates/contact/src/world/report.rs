//! What a step of a world took and left.
//!
//! ```text
//! max_i |min(W_i lambda_i, u_i)|,   max_i |beta_i - disc_i(beta_i - u_i/d_i)| d_i            m/s
//! T+ - T- = load work - impact energy - friction energy - joint energy + work                             J
//! ```
//! What is left of the normal conditions and of Coulomb's law, as velocities; the symbols are those
//! of `friction.rs`. The second line is exact to rounding: each impulse is paid at the mean of the
//! velocities before and after it; in space a body's free turn in the step, after them, changes its energy
//! by third order in the step. Lifting out of overlap moves positions alone, and so what it
//! gives is potential energy.

use crate::Painleve;

/// What a step of a world took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldReport {
    /// Contact points within reach of the step.
    pub contacts: usize,
    /// Islands of bodies that hang together by them.
    pub islands: usize,
    /// Islands solved by the exact projection without friction.
    pub projected: usize,
    /// Contacts relaxed, over all sweeps; none where everything rests as it did.
    pub relaxed: usize,
    /// Sparse systems solved between sweeps.
    pub solved: usize,
    /// Passes of the impact law.
    pub impacts: usize,
    /// The fastest approach that all passes of the impacts leave, m/s: it is stopped by resting contact, and
    /// its restitution is not given. Zero where the impacts end by themselves.
    pub impact_residual: f64,
    /// Whether the contact conditions are met as far as asked.
    pub settled: bool,
    /// How far the normal conditions are from being met, m/s, and how fast what was not looked at closes; of what
    /// rests, at most.
    pub residual: f64,
    /// How far Coulomb's law is from being met, m/s; of what rests, at most.
    pub coulomb: f64,
    /// A contact for which no force obeys Coulomb's law, or several do: it jams with an impulse.
    pub painleve: Option<Painleve>,
    /// The deepest overlap that the step started with, m.
    pub overlap: f64,
    /// The work that obstacles did on the other bodies, J.
    pub work: f64,
    /// The energy that impacts and normal impulses took, J.
    pub impact_energy: f64,
    /// The energy that friction took, J: below zero as that of joints may be.
    pub friction_energy: f64,
    /// The energy that joints took, J: of closed ones that ask for no speed, what their velocities were
    /// off.
    pub joint_energy: f64,
    /// What of it dry friction of joints took, J: below zero where other impulses of the step turn around the
    /// motion that it opposes at the end.
    pub joint_friction_energy: f64,
    /// How far joints are open after the step, and limits exceeded, m or rad; zero but for rounding where
    /// they could be closed.
    pub joint_violation: f64,
    /// The potential energy that lifting out of overlap and closing joints gave, J.
    pub lifting_energy: f64,
}
