//! How far the contacts of touching bodies are settled, and what a step took and left.
//!
//! ```text
//! max_i |min(W_i lambda_i, u_i)|,   max_i |beta_i - disc_i(beta_i - u_i/d_i)| d_i            m/s
//! ```
//! What is left of the normal conditions and of Coulomb's law, as velocities; the symbols are those
//! of `friction.rs`.

/// What a step of touching bodies took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchingReport {
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
    /// How far the normal conditions are from being met, m/s; of what rests, at most.
    pub residual: f64,
    /// How far Coulomb's law is from being met, m/s; of what rests, at most.
    pub coulomb: f64,
    /// The deepest overlap that the step started with, m.
    pub overlap: f64,
    /// The work that obstacles did on the other bodies, J.
    pub work: f64,
}

/// How far the contact conditions of a step are settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Sweeps end where no contact changes a velocity by more than this, m/s, and what is off by no
    /// more may rest as it is; rounding ends them in any case.
    pub change: f64,
    /// The most sweeps over an island in a step.
    pub sweeps: usize,
}

impl Default for Settling {
    fn default() -> Self {
        Settling { change: 0.0, sweeps: 200 }
    }
}
