//! The two numbers of an isotropic material, and their conversions in one, two and three
//! dimensions.
//!
//! ```text
//! W = mu tr S^2 + lambda/2 (tr S)^2               the pair (lambda, mu), Pa; mu the shear modulus
//! K  = lambda + 2 mu/d                            bulk modulus in d dimensions
//! nu = lambda / ((d - 1) lambda + 2 mu)           Poisson's ratio, below 1/(d - 1)
//! E  = 2 mu (1 + nu)                              Young's modulus
//! plane strain    lambda' = lambda                a sheet held at its thickness
//! plane stress    lambda' = 2 lambda mu/(lambda + 2 mu)      a sheet free to thin
//! uniaxial stress lambda' + 2 mu = E              a bar free to thin
//! ```
//! `S` Green's strain tensor (d x d), `W` energy density (J/m^3), `mu` the same in every dimension.
//! The notes' equation (13.2) has alpha = 2 mu and beta = lambda; public shell codes use alpha and
//! beta the other way round, so neither letter appears here. The energy is positive for every
//! strain exactly if mu > 0 and K > 0, that is -1 < nu < 1/(d - 1): other pairs are refused.
//! Source: notes 13.1; errata 13, which checks the sheet's pair by eliminating the free strain.

use crate::ElasticityError;

/// Lame's pair of a material in `d` dimensions, with positive energy for every strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame<const DIM: usize> {
    lambda: f64,
    mu: f64,
}

/// Moduli are in this range, Pa: sums and ratios of them are finite and not zero.
const SMALLEST: f64 = 1e-300;
const LARGEST: f64 = 1e300;

impl<const DIM: usize> Lame<DIM> {
    const D: f64 = {
        assert!(1 <= DIM && DIM <= 3, "space has one, two or three dimensions");
        DIM as f64
    };

    /// The pair itself, Pa.
    ///
    /// # Errors
    /// [`ElasticityError::Lame`] where mu or the bulk modulus is not positive, or so large or so small
    /// that products with a few of them leave the range of numbers.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, ElasticityError> {
        let pair = Lame { lambda, mu };
        let is_in_range = lambda.abs() <= LARGEST && (SMALLEST..=LARGEST).contains(&mu);
        let is_finite = pair.poisson().is_finite() && pair.young().is_finite();
        let positive = is_in_range && is_finite && pair.bulk() > 0.0 && pair.young() > 0.0;
        if positive { Ok(pair) } else { Err(ElasticityError::Lame { lambda, mu, dimensions: DIM }) }
    }

    /// Young's modulus (Pa) and Poisson's ratio, `-1 < nu < 1/(d - 1)`; without a bound above on a
    /// line.
    ///
    /// # Errors
    /// [`ElasticityError::Poisson`] and [`ElasticityError::Young`] out of their bounds; those of
    /// [`Lame::new`] where the pair leaves its range.
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, ElasticityError> {
        let bound = 1.0 / (Self::D - 1.0);
        if !(poisson > -1.0 && poisson < bound && poisson.is_finite()) {
            return Err(ElasticityError::Poisson { poisson, bound });
        }
        if !(young > 0.0 && young.is_finite()) {
            return Err(ElasticityError::Young(young));
        }
        let mu = young / (2.0 * (1.0 + poisson));
        Lame::new(2.0 * mu * poisson / (1.0 - (Self::D - 1.0) * poisson), mu)
    }

    /// The bulk and the shear modulus, Pa.
    ///
    /// # Errors
    /// Those of [`Lame::new`].
    pub fn from_bulk_shear(bulk: f64, shear: f64) -> Result<Self, ElasticityError> {
        Lame::new(bulk - 2.0 * shear / Self::D, shear)
    }

    /// The first parameter, Pa.
    #[inline]
    pub fn lambda(&self) -> f64 {
        self.lambda
    }

    /// The second parameter, which is the shear modulus, Pa.
    #[inline]
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// The bulk modulus, Pa.
    pub fn bulk(&self) -> f64 {
        self.lambda + 2.0 * self.mu / Self::D
    }

    /// Poisson's ratio.
    pub fn poisson(&self) -> f64 {
        self.lambda / ((Self::D - 1.0) * self.lambda + 2.0 * self.mu)
    }

    /// Young's modulus, Pa.
    pub fn young(&self) -> f64 {
        2.0 * self.mu * (1.0 + self.poisson())
    }
}

impl Lame<3> {
    /// The pair of a slice of the body that cannot move out of its plane.
    pub fn plane_strain(&self) -> Lame<2> {
        Lame { lambda: self.lambda, mu: self.mu }
    }

    /// The pair of a sheet whose faces are free: the default for sheets.
    ///
    /// Exact at every strain for [`SaintVenantKirchhoff`](crate::SaintVenantKirchhoff) and for
    /// [`Linear`](crate::Linear), and to first order of the strain for the other laws: they know the
    /// sheet's pair and not its thickness. Stretched by 1.01 and 1.2 along both directions, a
    /// [`NeoHookean`](crate::NeoHookean) sheet of nu = 0.3 is 1.6 and 40 % too stiff, a
    /// [`FixedCorotated`](crate::FixedCorotated) one 1.2 and 31 %. At large strain take
    /// [`FreeToThin`](crate::FreeToThin) of the solid.
    pub fn plane_stress(&self) -> Lame<2> {
        let Lame { lambda, mu } = *self;
        Lame { lambda: lambda * (2.0 * mu / (lambda + 2.0 * mu)), mu }
    }

    /// The pair of a bar whose sides are free: stretched, it resists with Young's modulus.
    pub fn uniaxial_stress(&self) -> Lame<1> {
        Lame { lambda: self.young() - 2.0 * self.mu, mu: self.mu }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-13 * (a.abs() + b.abs() + 1.0)
    }

    proptest! {
        #[test]
        fn every_pair_of_moduli_comes_back(young in 0.1..10.0, poisson in -0.95..0.49) {
            let solid = Lame::<3>::from_young_poisson(young, poisson).unwrap();
            prop_assert!(close(solid.young(), young) && close(solid.poisson(), poisson));
            let again = Lame::<3>::from_bulk_shear(solid.bulk(), solid.mu()).unwrap();
            prop_assert!(close(again.lambda(), solid.lambda()) && close(again.mu(), solid.mu()));
            prop_assert!(close(solid.bulk(), young / (3.0 * (1.0 - 2.0 * poisson))));
        }

        /// The free strain across takes the value of least energy.
        #[test]
        fn a_free_face_takes_the_strain_of_least_energy(
            young in 0.1..10.0, poisson in -0.9..0.49, e in prop::array::uniform2(-1.0..1.0),
        ) {
            let solid = Lame::<3>::from_young_poisson(young, poisson).unwrap();
            let w = |pair: (f64, f64), e: &[f64]| {
                let trace: f64 = e.iter().sum();
                pair.1 * e.iter().map(|e| e * e).sum::<f64>() + 0.5 * pair.0 * trace * trace
            };
            let pair = (solid.lambda(), solid.mu());
            let across = -pair.0 * (e[0] + e[1]) / (pair.0 + 2.0 * pair.1);
            let sheet = solid.plane_stress();
            let relaxed = w(pair, &[e[0], e[1], across]);
            prop_assert!(close(w((sheet.lambda(), sheet.mu()), &e), relaxed));
            prop_assert!(relaxed <= w(pair, &[e[0], e[1], across + 1e-3]));
            // Stretched along one direction only, sheet and bar both show Young's modulus.
            prop_assert!(close(sheet.young(), young) && close(sheet.poisson(), poisson));
            let bar = solid.uniaxial_stress();
            prop_assert!(close(w((bar.lambda(), bar.mu()), &[e[0]]), 0.5 * young * e[0] * e[0]));
            prop_assert!(close(bar.young(), young));
        }
    }

    #[test]
    fn materials_that_could_give_energy_away_are_refused() {
        for poisson in [0.5, 0.7, -1.0, f64::NAN] {
            let error = Lame::<3>::from_young_poisson(1.0, poisson).unwrap_err();
            assert!(matches!(error, ElasticityError::Poisson { bound: 0.5, .. }), "{error}");
        }
        assert!(Lame::<2>::from_young_poisson(1.0, 0.9).is_ok());
        for young in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            let error = Lame::<2>::from_young_poisson(young, 0.3).unwrap_err();
            assert!(matches!(error, ElasticityError::Young(_)), "{error}");
        }
        let error = Lame::<3>::new(-0.7, 1.0).unwrap_err();
        assert_eq!(error, ElasticityError::Lame { lambda: -0.7, mu: 1.0, dimensions: 3 });
        assert!(Lame::<2>::new(-0.7, 1.0).is_ok());
        assert!(Lame::<3>::from_bulk_shear(0.0, 1.0).is_err());
    }
}
