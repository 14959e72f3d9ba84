//! What is known of a method before it runs: table 4.1 of the notes as data, corrected.
//!
//! Studies and tests ask for these facts and assert them.

/// Whether a step solves an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// Known numbers are plugged in.
    Explicit,
    /// The new state solves an equation, by Newton's method.
    Implicit,
}

/// Whether a step preserves the symplectic form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symplecticity {
    /// It does.
    Symplectic,
    /// It does after a change of variables that is near the identity, and so behaves alike.
    Conjugate,
    /// It does not.
    No,
}

/// What the energy of a conservative system does over a long run within the stability limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyBehavior {
    /// It oscillates about its true value.
    Bounded,
    /// It grows without bound.
    Grows,
    /// It decays.
    Decays,
}

/// How well an invariant of the exact motion is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conservation {
    /// To rounding.
    Exact,
    /// To rounding where forces are linear; else it oscillates about its true value.
    LinearForces,
    /// To the order of the method only.
    ToOrder,
}

/// For which steps h an oscillator of angular frequency omega stays bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// For h omega below this number.
    Below(f64),
    /// For every h.
    Always,
    /// For no h.
    Never,
}

/// What the method does to y' = lambda y where lambda decays, however large the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// It blows up above some step.
    Conditional,
    /// It stays bounded: A-stable.
    AStable,
    /// It dies out, within one step where the decay is fast: L-stable.
    LStable,
}

/// How the error of a harmonic oscillator grows with time at a fixed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorGrowth {
    /// In proportion to time.
    Linear,
    /// Exponentially.
    Exponential,
    /// Up to the size of the motion, which has decayed by then.
    Saturates,
}

/// The facts of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Its name in the field, with lower-case letters and hyphens.
    pub name: &'static str,
    /// The power of h in the error at a fixed end time.
    pub order: u32,
    /// Configurations at which a step evaluates the force; a configuration that the next step
    /// evaluates again counts once.
    pub stages: u32,
    /// Whether a step solves an equation.
    pub evaluation: Evaluation,
    /// Whether a step back undoes a step.
    pub symmetric: bool,
    /// Whether a step preserves the symplectic form.
    pub symplecticity: Symplecticity,
    /// What energy does.
    pub energy: EnergyBehavior,
    /// How well linear momentum is kept where the potential is invariant under translations.
    pub linear_momentum: Conservation,
    /// How well angular momentum is kept where the system is invariant under rotations.
    pub angular_momentum: Conservation,
    /// The stability limit on an oscillator.
    pub stability: Stability,
    /// What it does to fast decay.
    pub damping: Damping,
    /// The growth of the error on an oscillator.
    pub error_growth: ErrorGrowth,
}
