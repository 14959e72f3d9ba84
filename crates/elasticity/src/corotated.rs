//! Linear elasticity that turns along with the body.
//!
//! ```text
//! R = U V^T                        the rotation nearest to F = U diag(s) V^T
//! W = mu |F - R|^2 + lambda/2 (J - 1)^2 = mu sum (s_i - 1)^2 + lambda/2 (s_1 ... s_d - 1)^2
//! P = 2 mu (F - R) + lambda (J - 1) cof F
//! ```
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. Cauchy strain in the frame of R. Finite for
//! every F; where two stretches add up to zero, as just past inversion, R jumps and the second
//! derivative has no bound, and at exactly that place it is not finite. With a negative lambda a
//! body would gain energy by swelling without end, as `J^2` outgrows `s^2`: that is refused.
//! Source: Stomakhin, Howes, Schroeder and Teran, Energetically Consistent Invertible Elasticity
//! (2012).

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, others, pairs};
use crate::singular::singular;
use crate::tensor::{cofactor, determinant, inner};
use crate::{ElasticityError, Lame, Material, Real};

/// The fixed corotated material of bodies that fill their space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedCorotated<const D: usize> {
    lame: Lame<D>,
}

impl<const D: usize> FixedCorotated<D> {
    /// The material of a pair.
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

    /// `F - R`.
    #[inline(always)]
    fn beyond_rotation<T: Real>(f: &[[T; D]; D]) -> [[T; D]; D] {
        let rotation = singular(f).rotation();
        let mut difference = *f;
        for k in 0..D {
            for i in 0..D {
                difference[k][i] = f[k][i] - rotation[k][i];
            }
        }
        difference
    }
}

impl<const D: usize> Material<D, D> for FixedCorotated<D> {
    type Tangent<T: Real> = PrincipalTangent<T, D, D>;
    type Semidefinite<T: Real> = PrincipalTangent<T, D, D>;

    fn energy<T: Real>(&self, f: &[[T; D]; D]) -> T {
        let difference = Self::beyond_rotation(f);
        let growth = determinant(f) + T::splat(-1.0);
        inner(&difference, &difference) * self.lame.mu()
            + growth * growth * (0.5 * self.lame.lambda())
    }

    fn stress<T: Real>(&self, f: &[[T; D]; D]) -> [[T; D]; D] {
        let (difference, cofactor) = (Self::beyond_rotation(f), cofactor(f));
        let pressure = (determinant(f) + T::splat(-1.0)) * self.lame.lambda();
        std::array::from_fn(|k| {
            std::array::from_fn(|i| {
                difference[k][i] * (2.0 * self.lame.mu()) + cofactor[k][i] * pressure
            })
        })
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
