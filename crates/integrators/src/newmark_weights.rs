//! The weights of Newmark's family, and what is known of the method that they make.
//!
//! ```text
//! Newmark              beta, gamma                      am = af = 0
//! generalized alpha    am = (2 r - 1)/(r + 1),  af = r/(r + 1)
//!                      gamma = 1/2 - am + af,   beta = (1 - am + af)^2/4
//! ```
//! `r` in [0, 1] is the spectral radius at infinite frequency: what is left of the fastest
//! oscillation after each step. Order 2 where `gamma = 1/2 - am + af`, else 1. With `gamma < 1/2`
//! motions would grow at every step, and with beta = 0 the step is explicit: that is
//! Stormer-Verlet. Source: Newmark 1959; Chung and Hulbert 1993; Hughes, The Finite Element Method,
//! 9.1.

use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, ParameterError,
    Stability, Symplecticity, implicit_euler,
};

/// The weights of a method of Newmark's family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewmarkWeights {
    pub(crate) beta: f64,
    pub(crate) gamma: f64,
    /// The part of the old acceleration in the place: 1/2 - beta, but of implicit Euler.
    pub(crate) old_place: f64,
    /// am: the part of the old acceleration in the equation of motion.
    pub(crate) old_inertia: f64,
    /// af: the part of the old configuration in the equation of motion.
    pub(crate) old_force: f64,
    facts: Facts,
}

/// What all of them have in common: the facts of the average acceleration.
const FACTS: Facts = Facts {
    name: "newmark",
    order: 2,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: true,
    symplecticity: Symplecticity::Conjugate,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::LinearForces,
    stability: Stability::Always,
    damping: Damping::AStable,
    error_growth: ErrorGrowth::Linear,
};

impl NewmarkWeights {
    /// The average acceleration, beta = 1/4 and gamma = 1/2: without damping forces it is the
    /// trapezoid rule.
    pub const AVERAGE_ACCELERATION: NewmarkWeights = NewmarkWeights::of(0.25, 0.5, FACTS);

    /// Implicit Euler, `v' = v + h a'` and `q' = q + h v'`, which is none of Newmark's.
    pub(crate) const IMPLICIT_EULER: NewmarkWeights =
        NewmarkWeights { old_place: 0.0, ..NewmarkWeights::of(1.0, 1.0, implicit_euler::FACTS) };

    /// Newmark's weights with these facts.
    const fn of(beta: f64, gamma: f64, facts: Facts) -> Self {
        NewmarkWeights {
            beta,
            gamma,
            old_place: 0.5 - beta,
            old_inertia: 0.0,
            old_force: 0.0,
            facts,
        }
    }

    /// Newmark's weights: `beta` in (0, 1], `gamma` in [1/2, 1].
    ///
    /// # Errors
    /// [`ParameterError`] for a weight outside of its range.
    pub fn newmark(beta: f64, gamma: f64) -> Result<Self, ParameterError> {
        ParameterError::check("beta", beta, "(0, 1]", beta > 0.0 && beta <= 1.0)?;
        ParameterError::check("gamma", gamma, "[1/2, 1]", (0.5..=1.0).contains(&gamma))?;
        let stability = match 0.5 * gamma - beta {
            excess if excess > 0.0 => Stability::Below(excess.sqrt().recip()),
            _ => Stability::Always,
        };
        let damping = match stability {
            Stability::Always => Damping::AStable,
            _ => Damping::Conditional,
        };
        let damped = Facts {
            order: 1,
            symmetric: false,
            symplecticity: Symplecticity::No,
            energy: EnergyBehavior::Decays,
            angular_momentum: Conservation::ToOrder,
            error_growth: ErrorGrowth::Saturates,
            ..FACTS
        };
        let facts = if gamma > 0.5 { damped } else { FACTS };
        let facts = Facts { stability, damping, ..facts };
        Ok(NewmarkWeights::of(beta, gamma, facts))
    }

    /// The generalized-alpha weights that leave the part `radius` in [0, 1] of the fastest
    /// oscillations after each step: 0 damps them most, 1 is the implicit midpoint rule.
    ///
    /// # Errors
    /// [`ParameterError`] for a radius outside of [0, 1].
    pub fn generalized_alpha(radius: f64) -> Result<Self, ParameterError> {
        let inside = (0.0..=1.0).contains(&radius);
        ParameterError::check("the spectral radius", radius, "[0, 1]", inside)?;
        Ok(NewmarkWeights::with_radius(radius))
    }

    /// Weights for a radius that is known to be in [0, 1].
    pub(crate) const fn with_radius(radius: f64) -> Self {
        let old_inertia = (2.0 * radius - 1.0) / (radius + 1.0);
        let old_force = radius / (radius + 1.0);
        let shift = old_force - old_inertia;
        let midpoint = Facts {
            name: "generalized-alpha",
            symplecticity: Symplecticity::Symplectic,
            angular_momentum: Conservation::Exact,
            ..FACTS
        };
        let facts = if radius == 1.0 {
            midpoint
        } else {
            Facts {
                symmetric: false,
                symplecticity: Symplecticity::No,
                energy: EnergyBehavior::Decays,
                angular_momentum: Conservation::ToOrder,
                ..midpoint
            }
        };
        let beta = 0.25 * (1.0 + shift) * (1.0 + shift);
        let weights = NewmarkWeights::of(beta, 0.5 + shift, facts);
        NewmarkWeights { old_inertia, old_force, ..weights }
    }

    /// What is known of the method with these weights.
    pub const fn facts(&self) -> Facts {
        self.facts
    }
}
