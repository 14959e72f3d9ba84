//! What a run writes down of a state besides the positions.
//!
//! ```text
//! T = sum_i |p_i|^2 / 2 m_i      kinetic energy        V(q)     potential energy     E = T + V
//! P = sum_i p_i                  linear momentum       L = sum_i q_i x p_i    about the origin
//! ```
//! Sums over the particles that are free: a pinned one has no momentum. Of a scene of heat
//! ```text
//! H = int f      heat            V = 1/2 int |grad f|^2      Dirichlet energy
//! ```

use serde::Serialize;

/// A number, or a vector, of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Observable {
    /// E, the sum of the two below.
    Energy,
    /// T.
    KineticEnergy,
    /// V.
    PotentialEnergy,
    /// P, a component a column.
    LinearMomentum,
    /// L, one column in the plane, three in space, none on a line.
    AngularMomentum,
    /// Where a particle is.
    Position(usize),
    /// How fast a particle moves, a component a column.
    Velocity(usize),
    /// How far apart two particles are.
    Distance([usize; 2]),
    /// The tension of a rod, negative for a thrust: that of the mean force over the last step, at the start
    /// over the second 64th part of a step.
    Tension(usize),
    /// How fast a body turns, in body axes; one column in the plane.
    AngularVelocity(usize),
    /// H.
    Heat,
    /// V of a scene of heat.
    DirichletEnergy,
    /// How warm a vertex is.
    Temperature(usize),
}

impl Observable {
    /// How many numbers it is.
    pub(crate) fn columns(self, dimension: usize) -> usize {
        match (self, dimension) {
            (
                Observable::LinearMomentum | Observable::Position(_) | Observable::Velocity(_),
                dimension,
            ) => dimension,
            (Observable::AngularMomentum, 1) => 0,
            (Observable::AngularMomentum | Observable::AngularVelocity(_), 3) => 3,
            _ => 1,
        }
    }

    /// Whether it is an observable of scenes of heat, which have no other.
    pub(crate) fn of_heat(self) -> bool {
        matches!(self, Observable::Heat | Observable::DirichletEnergy | Observable::Temperature(_))
    }
}
