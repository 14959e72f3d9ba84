//! The methods of this crate by name, for whoever chooses one when the program runs.

use std::fmt;
use std::str::FromStr;

use stationary_calculus::{HessianSolver, Metric, Potential, SizeError, Storage, System};

use crate::{
    Composition, ExplicitEuler, Facts, GaussLegendre, ImplicitEuler, ImplicitMidpoint, Integrator,
    Newmark, NewmarkWeights, Nodes, Nystrom4, RungeKutta4, Scheme, StormerVerlet,
    SymplecticEulerDriftKick, SymplecticEulerKickDrift, Trapezoid, explicit_euler, implicit_euler,
    implicit_midpoint, nystrom_4, runge_kutta_4, stormer_verlet, symplectic_euler, trapezoid,
};

/// A method of this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// [`ExplicitEuler`].
    ExplicitEuler,
    /// [`ImplicitEuler`].
    ImplicitEuler,
    /// [`Trapezoid`].
    Trapezoid,
    /// [`ImplicitMidpoint`].
    ImplicitMidpoint,
    /// [`SymplecticEulerDriftKick`].
    SymplecticEulerDriftKick,
    /// [`SymplecticEulerKickDrift`].
    SymplecticEulerKickDrift,
    /// [`StormerVerlet`].
    StormerVerlet,
    /// [`RungeKutta4`].
    RungeKutta4,
    /// [`Nystrom4`].
    Nystrom4,
    /// [`Composition`] with the coefficients of a scheme.
    Composition(Scheme),
    /// [`GaussLegendre`] at this many nodes.
    GaussLegendre(Nodes),
    /// [`Newmark`] with the average acceleration.
    Newmark,
    /// [`Newmark`] with the generalized-alpha weights of spectral radius 1/2.
    GeneralizedAlpha,
}

/// The weights of [`Method::Newmark`].
const AVERAGE: NewmarkWeights = NewmarkWeights::AVERAGE_ACCELERATION;
/// The weights of [`Method::GeneralizedAlpha`].
const HALF_RADIUS: NewmarkWeights = NewmarkWeights::with_radius(0.5);

/// There is no method of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no integrator called `{0}`")]
pub struct UnknownMethod(pub String);

impl Method {
    /// The methods of the notes' table 4.1, in its order.
    pub const TABLE_4_1: [Method; 8] = [
        Method::ExplicitEuler,
        Method::ImplicitEuler,
        Method::Trapezoid,
        Method::ImplicitMidpoint,
        Method::SymplecticEulerDriftKick,
        Method::SymplecticEulerKickDrift,
        Method::StormerVerlet,
        Method::RungeKutta4,
    ];

    /// Every method.
    pub const ALL: &[Method] = &[
        Method::ExplicitEuler,
        Method::ImplicitEuler,
        Method::Trapezoid,
        Method::ImplicitMidpoint,
        Method::SymplecticEulerDriftKick,
        Method::SymplecticEulerKickDrift,
        Method::StormerVerlet,
        Method::RungeKutta4,
        Method::Nystrom4,
        Method::Composition(Scheme::TripleJump4),
        Method::Composition(Scheme::Suzuki4),
        Method::Composition(Scheme::BlanesMoan4),
        Method::Composition(Scheme::BlanesMoanNystrom4),
        Method::Composition(Scheme::Yoshida6),
        Method::Composition(Scheme::KahanLi6),
        Method::Composition(Scheme::BlanesMoan6),
        Method::Composition(Scheme::BlanesMoanNystrom6),
        Method::Composition(Scheme::Yoshida8),
        Method::Composition(Scheme::KahanLi8),
        Method::GaussLegendre(Nodes::Two),
        Method::GaussLegendre(Nodes::Three),
        Method::GaussLegendre(Nodes::Four),
        Method::Newmark,
        Method::GeneralizedAlpha,
    ];

    /// What is known of it.
    pub fn facts(self) -> Facts {
        match self {
            Method::ExplicitEuler => explicit_euler::FACTS,
            Method::ImplicitEuler => implicit_euler::FACTS,
            Method::Trapezoid => trapezoid::FACTS,
            Method::ImplicitMidpoint => implicit_midpoint::FACTS,
            Method::SymplecticEulerDriftKick => symplectic_euler::DRIFT_KICK,
            Method::SymplecticEulerKickDrift => symplectic_euler::KICK_DRIFT,
            Method::StormerVerlet => stormer_verlet::FACTS,
            Method::RungeKutta4 => runge_kutta_4::FACTS,
            Method::Nystrom4 => nystrom_4::FACTS,
            Method::Composition(scheme) => scheme.facts(),
            Method::GaussLegendre(nodes) => nodes.facts(),
            Method::Newmark => AVERAGE.facts(),
            Method::GeneralizedAlpha => HALF_RADIUS.facts(),
        }
    }

    /// The weights of a method that is Newmark's: with [`Newmark`] it takes forces beside the
    /// potential.
    pub fn newmark_weights(self) -> Option<NewmarkWeights> {
        match self {
            Method::Newmark => Some(AVERAGE),
            Method::GeneralizedAlpha => Some(HALF_RADIUS),
            _ => None,
        }
    }

    /// The weights with which [`Newmark`] takes the steps of an implicit method of one stage, forces included.
    pub fn weights_with_force(self) -> Option<NewmarkWeights> {
        match self {
            Method::ImplicitEuler => Some(NewmarkWeights::IMPLICIT_EULER),
            Method::Trapezoid => Some(AVERAGE),
            Method::ImplicitMidpoint => Some(NewmarkWeights::with_radius(1.0)),
            _ => self.newmark_weights(),
        }
    }

    /// The method on a system; an implicit one factors dense matrices.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn integrator<'s, M: Metric, P: Potential, C: Storage + 's>(
        self,
        system: &'s System<M, P>,
    ) -> Result<Box<dyn Integrator<C> + 's>, SizeError> {
        Ok(match self {
            Method::ImplicitEuler => Box::new(ImplicitEuler::new(system)?),
            Method::Trapezoid => Box::new(Trapezoid::new(system)?),
            Method::ImplicitMidpoint => Box::new(ImplicitMidpoint::new(system)?),
            Method::ExplicitEuler => Box::new(ExplicitEuler::new(system)?),
            Method::SymplecticEulerDriftKick => Box::new(SymplecticEulerDriftKick::new(system)?),
            Method::SymplecticEulerKickDrift => Box::new(SymplecticEulerKickDrift::new(system)?),
            Method::StormerVerlet => Box::new(StormerVerlet::new(system)?),
            Method::RungeKutta4 => Box::new(RungeKutta4::new(system)?),
            Method::Nystrom4 => Box::new(Nystrom4::new(system)?),
            Method::Composition(scheme) => Box::new(Composition::new(system, scheme)?),
            Method::GaussLegendre(nodes) => Box::new(GaussLegendre::new(system, nodes)?),
            Method::Newmark => Box::new(Newmark::new(system, AVERAGE)?),
            Method::GeneralizedAlpha => Box::new(Newmark::new(system, HALF_RADIUS)?),
        })
    }

    /// The method on a system of many freedoms; an implicit one uses the caller's solver, an
    /// explicit one needs none.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's, and of an implicit method for
    /// a solver that was made for another.
    pub fn integrator_with<'s, M: Metric, P: Potential, C: Storage + 's, L: HessianSolver + 's>(
        self,
        system: &'s System<M, P>,
        solver: L,
    ) -> Result<Box<dyn Integrator<C> + 's>, SizeError> {
        Ok(match self {
            Method::ImplicitEuler => Box::new(ImplicitEuler::with_solver(system, solver)?),
            Method::Trapezoid => Box::new(Trapezoid::with_solver(system, solver)?),
            Method::ImplicitMidpoint => Box::new(ImplicitMidpoint::with_solver(system, solver)?),
            Method::GaussLegendre(nodes) => {
                Box::new(GaussLegendre::with_solver(system, nodes, solver)?)
            }
            Method::Newmark => Box::new(Newmark::with_solver(system, AVERAGE, solver)?),
            Method::GeneralizedAlpha => {
                Box::new(Newmark::with_solver(system, HALF_RADIUS, solver)?)
            }
            _ => self.integrator(system)?,
        })
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.facts().name)
    }
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let named = Method::ALL.iter().find(|method| method.facts().name == name);
        named.copied().ok_or_else(|| UnknownMethod(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_found_by_its_name() {
        for &method in Method::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert!("velocity-verlet".parse::<Method>().is_err());
    }
}
