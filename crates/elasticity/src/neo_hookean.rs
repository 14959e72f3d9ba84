//! A rubber that survives being turned inside out.
//!
//! ```text
//! I = tr F^T F,  J = det F,  d dimensions
//! W = m/2 [I - d - log((I + 1)/(d + 1))] + l/2 (J - 1)^2 - mu (J - 1)         J/m^3
//! m = mu (d + 1)/d,    l = lambda + mu - 2 mu/(d (d + 1))
//! P = a F + b cof F,   a = m (1 - 1/(I + 1)),   b = l (J - 1) - mu
//! K(a', b') = a (a'.b') I + 2 m/(I + 1)^2 (F a')(F b')^T + l (cof F a')(cof F b')^T
//!             + b dcof        dcof = -[F (a' x b')]x in space
//! ```
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. W and P vanish at rest, and for small strains W is
//! that of linear elasticity for every Poisson's ratio, zero and negative ones included: nothing is
//! divided by lambda. W is finite and smooth for every F, also where J <= 0, and at F = 0 it has no
//! resting point. That pulls an inverted element back; it is no barrier against inversion.
//! Needs l > 0, true of every solid and of plane strain; a sheet in plane stress needs nu > -1/2.
//! Source: Smith, de Goes and Kim, Stable Neo-Hookean Flesh Simulation (2018), rewritten so that the
//! rest state has no energy, and carried over to two dimensions.

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, pairs};
use crate::tensor::{apply, cofactor, cross, determinant, dot, inner};
use crate::{ElasticityError, Lame, Material, Real, Tangent};

/// The stable neo-Hookean material of bodies that fill their space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<const D: usize> {
    lame: Lame<D>,
    /// m and l.
    stretch: f64,
    volume: f64,
}

impl<const D: usize> NeoHookean<D> {
    /// The material of a pair.
    pub fn new(lame: Lame<D>) -> Result<Self, ElasticityError> {
        const { assert!(D == 2 || D == 3, "for bodies in the plane and in space") };
        let (d, mu) = (D as f64, lame.mu());
        let volume = lame.lambda() + mu - 2.0 * mu / (d * (d + 1.0));
        if volume > 0.0 {
            Ok(NeoHookean { lame, stretch: mu * (d + 1.0) / d, volume })
        } else {
            Err(ElasticityError::NeoHookean { poisson: lame.poisson() })
        }
    }

    /// Its pair.
    pub fn lame(&self) -> Lame<D> {
        self.lame
    }

    /// `1/(I + 1)`.
    #[inline(always)]
    fn softening<T: Real>(f: &[[T; D]; D]) -> T {
        T::reciprocal(inner(f, f) + T::splat(1.0))
    }

    /// The pressure-like `b`.
    #[inline(always)]
    fn volume_stress<T: Real>(&self, f: &[[T; D]; D]) -> T {
        determinant(f).multiply_add(T::splat(self.volume), T::splat(-self.volume - self.lame.mu()))
    }
}

impl<const D: usize> Material<D, D> for NeoHookean<D> {
    type Tangent<T: Real> = NeoHookeanTangent<T, D>;
    type Semidefinite<T: Real> = PrincipalTangent<T, D, D>;

    #[inline(always)]
    fn energy<T: Real>(&self, f: &[[T; D]; D]) -> T {
        let d = D as f64;
        let excess = inner(f, f) + T::splat(-d);
        let [softening] = T::each(&[excess], |[x]| [(x / (d + 1.0)).ln_1p()]);
        let growth = determinant(f) + T::splat(-1.0);
        let volume = growth * (growth * (0.5 * self.volume) + T::splat(-self.lame.mu()));
        (excess - softening).multiply_add(T::splat(0.5 * self.stretch), volume)
    }

    #[inline(always)]
    fn stress<T: Real>(&self, f: &[[T; D]; D]) -> [[T; D]; D] {
        let a = (T::splat(1.0) - Self::softening(f)) * self.stretch;
        let b = self.volume_stress(f);
        let c = cofactor(f);
        let mut stress = *f;
        for k in 0..D {
            for i in 0..D {
                stress[k][i] = f[k][i].multiply_add(a, c[k][i] * b);
            }
        }
        stress
    }

    #[inline(always)]
    fn tangent<T: Real>(&self, f: &[[T; D]; D], weight: T) -> NeoHookeanTangent<T, D> {
        let softening = Self::softening(f);
        NeoHookeanTangent {
            f: *f,
            cofactor: cofactor(f),
            identity: (T::splat(1.0) - softening) * self.stretch * weight,
            stretch: softening * softening * (2.0 * self.stretch) * weight,
            volume: weight * self.volume,
            turn: self.volume_stress(f) * weight,
        }
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; D], weight: T) -> PrincipalTangent<T, D, D> {
        PrincipalTangent::semidefinite(self, f, weight)
    }
}

/// The second derivative of the neo-Hookean energy, times a weight.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookeanTangent<T, const D: usize> {
    f: [[T; D]; D],
    cofactor: [[T; D]; D],
    identity: T,
    stretch: T,
    volume: T,
    turn: T,
}

impl<T: Real, const D: usize> Tangent<T, D, D> for NeoHookeanTangent<T, D> {
    /// The gradient and its images under F and its cofactors.
    type Node = [[T; D]; 3];

    #[inline(always)]
    fn node(&self, gradient: &[T; D]) -> [[T; D]; 3] {
        [*gradient, apply(&self.f, gradient), apply(&self.cofactor, gradient)]
    }

    #[inline(always)]
    fn block(&self, a: &[[T; D]; 3], b: &[[T; D]; 3]) -> [[T; D]; D] {
        let diagonal = self.identity * dot(&a[0], &b[0]);
        let mut block = [[T::splat(0.0); D]; D];
        for j in 0..D {
            let (stretched, pressed) = (self.stretch * b[1][j], self.volume * b[2][j]);
            for i in 0..D {
                block[j][i] = a[1][i].multiply_add(stretched, a[2][i] * pressed);
            }
            block[j][j] += diagonal;
        }
        if D == 2 {
            let turned = (a[0][0] * b[0][1] - a[0][1] * b[0][0]) * self.turn;
            block[1][0] += turned;
            block[0][1] += -turned;
        } else {
            let image = apply(&self.f, &cross(&a[0], &b[0]));
            for i in 0..D {
                let (j, k) = ((i + 1) % D, (i + 2) % D);
                let turned = image[k] * self.turn;
                block[j][i] += turned;
                block[i][j] += -turned;
            }
        }
        block
    }
}

impl<const D: usize> Isotropic<D> for NeoHookean<D> {
    fn curvature(&self, s: &[f64; D]) -> PrincipalCurvature<D> {
        let softening = (s.iter().map(|s| s * s).sum::<f64>() + 1.0).recip();
        let identity = self.stretch * (1.0 - softening);
        let stretch = 2.0 * self.stretch * softening * softening;
        let volume_stress = self.volume * (s.iter().product::<f64>() - 1.0) - self.lame.mu();
        // The stretches other than i, and other than i and j.
        let without = |left_out: &[usize]| -> f64 {
            (0..D).filter(|k| !left_out.contains(k)).map(|k| s[k]).product()
        };
        let scaling = pairs(|i, j| {
            let sum = stretch * s[i] * s[j] + self.volume * without(&[i]) * without(&[j]);
            sum + if i == j { identity } else { volume_stress * without(&[i, j]) }
        });
        PrincipalCurvature {
            scaling,
            twist: pairs(|i, j| identity + volume_stress * without(&[i, j])),
            flip: pairs(|i, j| identity - volume_stress * without(&[i, j])),
            normal: [0.0; D],
        }
    }
}
