//! The integrators of this crate by name, for whoever chooses one when the program runs.

use std::fmt;
use std::str::FromStr;

use stationary_calculus::{Force, Potential, SizeError, System};
use stationary_integrators::{Facts, Integrator, UnknownMethod};

use crate::free_rotation::FreeRotation;
use crate::{
    AxisRotations, BodyMetric, BodySpace, ConstantVelocity, ExactRotation, LieVerlet, MuntheKaas4,
    RenormalizedEuler, munthe_kaas, renormalized_euler,
};

/// An integrator of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyMethod {
    /// [`LieVerlet`] with [`ConstantVelocity`].
    VariationalRotation,
    /// [`LieVerlet`] with [`AxisRotations`].
    AxisRotations,
    /// [`LieVerlet`] with [`ExactRotation`].
    ExactRotation,
    /// [`MuntheKaas4`].
    MuntheKaas4,
    /// [`RenormalizedEuler`].
    RenormalizedEuler,
}

impl BodyMethod {
    /// Every method.
    pub const ALL: &[BodyMethod] = &[
        BodyMethod::VariationalRotation,
        BodyMethod::AxisRotations,
        BodyMethod::ExactRotation,
        BodyMethod::MuntheKaas4,
        BodyMethod::RenormalizedEuler,
    ];

    /// What is known of it.
    pub fn facts(self) -> Facts {
        match self {
            BodyMethod::VariationalRotation => ConstantVelocity::FACTS,
            BodyMethod::AxisRotations => AxisRotations::FACTS,
            BodyMethod::ExactRotation => ExactRotation::FACTS,
            BodyMethod::MuntheKaas4 => munthe_kaas::FACTS,
            BodyMethod::RenormalizedEuler => renormalized_euler::FACTS,
        }
    }

    /// The method on a system of bodies.
    ///
    /// # Errors
    /// None: vectors hold every system of bodies.
    pub fn integrator<'s, P: Potential, S: BodySpace>(
        self,
        system: &'s System<BodyMetric<S>, P, S>,
    ) -> Result<Box<dyn Integrator<Vec<f64>> + 's>, SizeError> {
        Ok(match self {
            BodyMethod::VariationalRotation => {
                Box::new(LieVerlet::<_, _, ConstantVelocity>::new(system)?)
            }
            BodyMethod::AxisRotations => Box::new(LieVerlet::<_, _, AxisRotations>::new(system)?),
            BodyMethod::ExactRotation => Box::new(LieVerlet::<_, _, ExactRotation>::new(system)?),
            BodyMethod::MuntheKaas4 => Box::new(MuntheKaas4::new(system)?),
            BodyMethod::RenormalizedEuler => Box::new(RenormalizedEuler::new(system)?),
        })
    }

    /// The method on a system of bodies under a force that no potential gives.
    ///
    /// # Errors
    /// A force of another size than the system's.
    pub fn forced<'s, P: Potential, S: BodySpace, F: Force + 's>(
        self,
        system: &'s System<BodyMetric<S>, P, S>,
        force: F,
    ) -> Result<Box<dyn Integrator<Vec<f64>> + 's>, SizeError> {
        Ok(match self {
            BodyMethod::VariationalRotation => {
                Box::new(LieVerlet::<_, _, ConstantVelocity, _>::forced(system, force)?)
            }
            BodyMethod::AxisRotations => {
                Box::new(LieVerlet::<_, _, AxisRotations, _>::forced(system, force)?)
            }
            BodyMethod::ExactRotation => {
                Box::new(LieVerlet::<_, _, ExactRotation, _>::forced(system, force)?)
            }
            BodyMethod::MuntheKaas4 => Box::new(MuntheKaas4::forced(system, force)?),
            BodyMethod::RenormalizedEuler => Box::new(RenormalizedEuler::forced(system, force)?),
        })
    }
}

impl fmt::Display for BodyMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.facts().name)
    }
}

impl FromStr for BodyMethod {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let named = BodyMethod::ALL.iter().find(|method| method.facts().name == name);
        named.copied().ok_or_else(|| UnknownMethod(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_found_by_its_name() {
        for &method in BodyMethod::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert!("stormer-verlet".parse::<BodyMethod>().is_err());
    }
}
