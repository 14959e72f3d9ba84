//! The simplest isotropic material: quadratic in Green's strain.
//!
//! ```text
//! S = 1/2 (F^T F - I)                      Green's strain, R x R                    (13.1)
//! W = mu tr S^2 + lambda/2 (tr S)^2        J/m^3                                    (13.2)
//! T = 2 mu S + lambda tr S I,  P = F T     T the second Piola-Kirchhoff stress, R x R
//! K(a, b) = lambda (F a)(F b)^T + mu (F b)(F a)^T + mu (a.b) F F^T + (a.T b) I
//! ```
//! `(lambda, mu)` the pair of the body's own dimension: for a sheet [`Lame::plane_stress`], for a
//! bar [`Lame::uniaxial_stress`]. Defined for every body of R dimensions in D, R <= D: bars, sheets
//! and membranes, solids.
//!
//! For small strains only. Pressed along one direction, the force of a bar turns at stretch 1/sqrt
//! 3 and is zero at stretch 0: nothing keeps an element from turning inside out (errata 13.1).
//! Where T pulls more than it pushes, along any two directions together, the second derivative is
//! positive semidefinite: a test that costs little.

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, pairs};
use crate::material::{TakesTangent, hookean_block};
use crate::tensor::{
    apply, dot, gram, green, inner, is_positive, outer_gram, product, scaled, shifted, trace,
};
use crate::{Lame, Material, Real, Tangent, convexified};

/// The Saint Venant-Kirchhoff material of bodies of `R` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff<const R: usize> {
    lame: Lame<R>,
}

impl<const R: usize> SaintVenantKirchhoff<R> {
    /// The material of a pair.
    pub fn new(lame: Lame<R>) -> Self {
        SaintVenantKirchhoff { lame }
    }

    /// Its pair.
    pub fn lame(&self) -> Lame<R> {
        self.lame
    }

    /// The second Piola-Kirchhoff stress.
    #[inline(always)]
    fn second_stress<T: Real, const D: usize>(&self, f: &[[T; D]; R]) -> [[T; R]; R] {
        let strain = green(f);
        let pressure = trace(&strain) * self.lame.lambda();
        shifted(scaled(&strain, T::splat(2.0 * self.lame.mu())), pressure)
    }
}

/// The second derivative of the Saint Venant-Kirchhoff energy, times a weight.
#[derive(Clone, Copy, Debug)]
pub struct SaintVenantKirchhoffTangent<T, const D: usize, const R: usize> {
    f: [[T; D]; R],
    stress: [[T; R]; R],
    spread: [[T; D]; D],
    pair: [T; 2],
}

impl<const D: usize, const R: usize> Material<D, R> for SaintVenantKirchhoff<R> {
    type Tangent<T: Real> = SaintVenantKirchhoffTangent<T, D, R>;
    type Semidefinite<T: Real> = PrincipalTangent<T, D, R>;

    #[inline(always)]
    fn energy<T: Real>(&self, f: &[[T; D]; R]) -> T {
        let strain = green(f);
        let spread = trace(&strain);
        (spread * spread).multiply_add(
            T::splat(0.5 * self.lame.lambda()),
            inner(&strain, &strain) * self.lame.mu(),
        )
    }

    #[inline(always)]
    fn stress<T: Real>(&self, f: &[[T; D]; R]) -> [[T; D]; R] {
        product(f, &self.second_stress(f))
    }

    #[inline(always)]
    fn tangent<T: Real>(&self, f: &[[T; D]; R], weight: T) -> Self::Tangent<T> {
        SaintVenantKirchhoffTangent {
            f: *f,
            stress: scaled(&self.second_stress(f), weight),
            spread: outer_gram(f),
            pair: [weight * self.lame.lambda(), weight * self.lame.mu()],
        }
    }

    /// Where `lambda >= 0`: of a sheet or a bar if T is; of what fills its space already if
    /// `tr T I - T` and `T + 2 mu F^T F` are. In space the eigenvalues of twists and flips are at
    /// least half those of the one; those of the scalings are at least those of the other.
    #[inline(always)]
    fn is_semidefinite<T: Real>(&self, f: &[[T; D]; R]) -> bool {
        if self.lame.lambda() < 0.0 {
            return false;
        }
        // Rounding of the rest state, where T is zero, must not look like compression.
        let slack = T::splat(1e-13 * self.lame.mu());
        let stress = self.second_stress(f);
        if D != R {
            return is_positive(&shifted(stress, slack));
        }
        let (mut sums, mut scalings) =
            (shifted(stress, -trace(&stress)), scaled(&gram(f), T::splat(2.0 * self.lame.mu())));
        for k in 0..R {
            for l in 0..R {
                sums[k][l] = -sums[k][l];
                scalings[k][l] += stress[k][l];
            }
        }
        is_positive(&shifted(sums, slack)) && is_positive(&scalings)
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; R], weight: T) -> PrincipalTangent<T, D, R> {
        PrincipalTangent::semidefinite(self, f, weight)
    }

    #[inline(always)]
    fn hand_semidefinite<T: Real>(
        &self,
        f: &[[T; D]; R],
        weight: T,
        taker: &mut impl TakesTangent<T, D, R>,
    ) {
        convexified::hand_semidefinite(self, f, weight, taker);
    }
}

impl<T: Real, const D: usize, const R: usize> Tangent<T, D, R>
    for SaintVenantKirchhoffTangent<T, D, R>
{
    /// The gradient, its image, and the stress on it.
    type Node = ([T; R], [T; D], [T; R]);

    #[inline(always)]
    fn node(&self, gradient: &[T; R]) -> Self::Node {
        (*gradient, apply(&self.f, gradient), apply(&self.stress, gradient))
    }

    #[inline(always)]
    fn block(&self, a: &Self::Node, b: &Self::Node) -> [[T; D]; D] {
        let spread = (self.pair[1] * dot(&a.0, &b.0), &self.spread);
        hookean_block(self.pair, &a.1, &b.1, spread, dot(&a.0, &b.2))
    }
}

impl<const R: usize> Isotropic<R> for SaintVenantKirchhoff<R> {
    /// `W = mu sum e_i^2 + lambda/2 (sum e_i)^2` with `e_i = (s_i^2 - 1)/2`.
    #[inline(always)]
    fn curvature<T: Real>(&self, s: &[T; R]) -> PrincipalCurvature<T, R> {
        let (lambda, mu) = (self.lame.lambda(), self.lame.mu());
        let pressure = (dot(s, s) + T::splat(-(R as f64))) * (0.5 * lambda);
        // pressure + mu (x - 1), zero at rest to the last bit.
        let beyond = |x: T| (x + T::splat(-1.0)).multiply_add(T::splat(mu), pressure);
        let scaling = pairs(|i, j| {
            let spread = s[i] * s[j] * lambda;
            if i == j { spread + beyond(s[i] * s[i] * 3.0) } else { spread }
        });
        let squares = |i: usize, j: usize| s[i].multiply_add(s[i], s[j] * s[j]);
        PrincipalCurvature {
            scaling,
            twist: pairs(|i, j| beyond(squares(i, j) - s[i] * s[j])),
            flip: pairs(|i, j| beyond(squares(i, j) + s[i] * s[j])),
            normal: s.map(|s| beyond(s * s)),
        }
    }
}
