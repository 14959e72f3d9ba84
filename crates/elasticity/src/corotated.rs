//! Linear elasticity that turns along with the body.
//!
//! ```text
//! R = U V^T                        the rotation nearest to F = U diag(s) V^T
//! W = mu |F - R|^2 + lambda/2 (J - 1)^2 = mu sum (s_i - 1)^2 + lambda/2 (s_1 ... s_d - 1)^2
//! P = 2 mu (F - R) + lambda (J - 1) cof F
//! F - R = R e = F e/(I + e),  e = sqrt C - I = (C - I)/(I + sqrt C)      near rest, C = F^T F
//! ```
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. Cauchy strain in the frame of R. Finite for
//! every F; where two stretches add up to zero, as just past inversion, R jumps and the second
//! derivative has no bound, and at exactly that place it is not finite. With a negative lambda a
//! body would gain energy by swelling without end, as `J^2` outgrows `s^2`: that is refused. In the
//! plane with the pair of plane stress it is a sheet that is free to thin to first order of the strain
//! only, 31 % too stiff at a stretch of 1.2 along both directions (nu = 0.3): then take
//! [`FreeToThin`](crate::FreeToThin) of the solid.
//! Source: Stomakhin, Howes, Schroeder and Teran, Energetically Consistent Invertible Elasticity
//! (2012).

use crate::eigen::{spectral, symmetric_eigen};
use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, others, pairs};
use crate::singular::singular;
use crate::tensor::{cofactor, displacement_gradient, dot, growth, inner, product, twice_green};
use crate::{ElasticityError, Lame, Material, Real};
use stationary_calculus::array;

/// The fixed corotated material of bodies that fill their space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedCorotated<const D: usize> {
    lame: Lame<D>,
}

impl<const D: usize> FixedCorotated<D> {
    /// The material of a pair.
    ///
    /// # Errors
    /// [`ElasticityError::Corotated`] for a pair with a negative lambda.
    pub fn new(lame: Lame<D>) -> Result<Self, ElasticityError> {
        if lame.lambda() < 0.0 {
            return Err(ElasticityError::Corotated { poisson: lame.poisson() });
        }
        Ok(FixedCorotated { lame })
    }

    /// Its pair.
    pub fn lame(&self) -> Lame<D> {
        self.lame
    }

    /// `J - 1`.
    #[inline(always)]
    fn growth<T: Real>(f: &[[T; D]; D]) -> T {
        let g = displacement_gradient(f);
        growth(&g, &cofactor(&g))
    }

    /// `|C - I|^2` where J is positive, and more than [`NEAR`] where it is not.
    #[inline(always)]
    fn distance_from_rest<T: Real>(strain: &[[T; D]; D], growth: T) -> T {
        growth.where_above(T::splat(-1.0), inner(strain, strain), T::splat(1.0))
    }

    /// `F - R`, as the difference that it is.
    #[inline(always)]
    fn beyond_rotation<T: Real>(f: &[[T; D]; D], rotation: &[[T; D]; D]) -> [[T; D]; D] {
        let mut difference = *f;
        for k in 0..D {
            for i in 0..D {
                difference[k][i] = f[k][i] - rotation[k][i];
            }
        }
        difference
    }
}

/// Below this `|C - I|^2` strain is taken from C - I, which near rest has all its digits, and above it
/// from F - R, which far from rest has more.
const NEAR: f64 = 0.25;

/// `sqrt(1 + c) - 1` of an eigenvalue of C - I.
#[inline(always)]
fn stretched<T: Real>(c: T) -> T {
    c * ((c + T::splat(1.0)).square_root() + T::splat(1.0)).reciprocal()
}

impl<const D: usize> Material<D, D> for FixedCorotated<D> {
    type Tangent<T: Real> = PrincipalTangent<T, D, D>;
    type Semidefinite<T: Real> = PrincipalTangent<T, D, D>;

    fn energy<T: Real>(&self, f: &[[T; D]; D]) -> T {
        let (strain, growth) = (twice_green(f), Self::growth(f));
        let distance = Self::distance_from_rest(&strain, growth);
        let e = symmetric_eigen(&strain).0.map(stretched);
        let mut square = dot(&e, &e);
        if !distance.all(|x| x <= NEAR) {
            let difference = Self::beyond_rotation(f, &singular(f).rotation());
            let far = inner(&difference, &difference);
            square = distance.where_above(T::splat(NEAR), far, square);
        }
        square * self.lame.mu() + growth * growth * (0.5 * self.lame.lambda())
    }

    fn stress<T: Real>(&self, f: &[[T; D]; D]) -> [[T; D]; D] {
        let (strain, growth) = (twice_green(f), Self::growth(f));
        let distance = Self::distance_from_rest(&strain, growth);
        let (values, vectors) = symmetric_eigen(&strain);
        // R e = F e/(I + e)
        let along = values.map(|c| {
            let e = stretched(c);
            e * (e + T::splat(1.0)).reciprocal()
        });
        let mut difference = product(f, &spectral(&vectors, &along));
        if !distance.all(|x| x <= NEAR) {
            let far = Self::beyond_rotation(f, &singular(f).rotation());
            for k in 0..D {
                for i in 0..D {
                    let near = difference[k][i];
                    difference[k][i] = distance.where_above(T::splat(NEAR), far[k][i], near);
                }
            }
        }
        let (cofactor, pressure) = (cofactor(f), growth * self.lame.lambda());
        array(|k| array(|i| difference[k][i] * (2.0 * self.lame.mu()) + cofactor[k][i] * pressure))
    }

    fn tangent<T: Real>(&self, f: &[[T; D]; D], weight: T) -> PrincipalTangent<T, D, D> {
        PrincipalTangent::exact(self, f, weight)
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; D], weight: T) -> PrincipalTangent<T, D, D> {
        PrincipalTangent::semidefinite(self, f, weight)
    }
}

impl<const D: usize> Isotropic<D> for FixedCorotated<D> {
    #[inline(always)]
    fn curvature<T: Real>(&self, s: &[T; D]) -> PrincipalCurvature<T, D> {
        let (lambda, twice) = (self.lame.lambda(), T::splat(2.0 * self.lame.mu()));
        let pressure = (others(s, [D; 2]) + T::splat(-1.0)) * lambda;
        let scaling = pairs(|i, j| {
            let volume = others(s, [i, i]) * others(s, [j, j]) * lambda;
            volume + if i == j { twice } else { pressure * others(s, [i, j]) }
        });
        PrincipalCurvature {
            scaling,
            twist: pairs(|i, j| {
                let turn = twice * (s[i] + s[j]).reciprocal() * 2.0;
                pressure.multiply_add(others(s, [i, j]), twice - turn)
            }),
            flip: pairs(|i, j| twice - pressure * others(s, [i, j])),
            normal: [T::splat(0.0); D],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_and_stress_keep_their_digits_at_strains_of_1e_12() {
        let lame = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
        let (lambda, mu) = (lame.lambda(), lame.mu());
        let body = FixedCorotated::new(lame).unwrap();
        for e in [2.0_f64.powi(-40), 2.0_f64.powi(-30), 2.0_f64.powi(-24)] {
            let f = [[1.0 + e, 0.0, 0.0], [0.0, 1.0, 0.0], [e, 0.0, 1.0 - 2.0 * e]];
            let energy = mu * (5.0 * e * e + 0.5 * e * e) + 0.5 * lambda * e * e;
            assert!((body.energy(&f) / energy - 1.0).abs() < 20.0 * e + 1e-14, "{e}");
            let along = 2.0 * mu * e - lambda * e;
            assert!((body.stress(&f)[0][0] / along - 1.0).abs() < 100.0 * e + 1e-13, "{e}");
        }
        let rest = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!((body.energy(&rest), body.stress(&rest)), (0.0, [[0.0; 3]; 3]));
    }

    #[test]
    fn both_forms_of_the_strain_agree_where_one_takes_over_from_the_other() {
        let body = FixedCorotated::new(Lame::<2>::from_young_poisson(1.0, 0.3).unwrap()).unwrap();
        // |C - I| = s^2 - 1 = 1/2
        let border = 1.5_f64.sqrt();
        let at = |s: f64| [[0.6 * s, 0.8 * s], [-0.8, 0.6]];
        let (below, above) = (at(border * (1.0 - 1e-12)), at(border * (1.0 + 1e-12)));
        assert!((body.energy(&above) - body.energy(&below)).abs() < 1e-11);
        for (a, b) in body.stress(&above).iter().flatten().zip(body.stress(&below).iter().flatten())
        {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
        // A mirror image has no strain in C, and a lot of it in F - R.
        assert!(
            (body.energy(&[[1.0, 0.0], [0.0, -1.0]])
                - (4.0 * body.lame().mu() + 2.0 * body.lame().lambda()))
            .abs()
                < 1e-14
        );
    }
}
