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
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. W and P vanish at rest, and for small strains W
//! is that of linear elasticity for every Poisson's ratio, zero and negative ones included: nothing
//! is divided by lambda. W is finite and smooth for every F, also where J <= 0, and at F = 0 it has
//! no resting point. That pulls an inverted element back; it is no barrier against inversion. Needs
//! l > 0, true of every solid and of plane strain; a sheet in plane stress needs nu > -1/2. Source:
//! Smith, de Goes and Kim, Stable Neo-Hookean Flesh Simulation (2018), rewritten so that the rest
//! state has no energy, and carried over to two dimensions.

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, others, pairs};
use crate::material::TakesTangent;
use crate::tensor::{
    apply, cofactor, cross, determinant, dot, gram, inner, is_positive, scaled, shifted,
};
use crate::{ElasticityError, Lame, Material, Real, Tangent, convexified};

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

    /// `I - d` and the energy of the volume.
    #[inline(always)]
    fn excess_and_volume<T: Real>(&self, f: &[[T; D]; D]) -> (T, T) {
        let growth = determinant(f) + T::splat(-1.0);
        let volume = growth * (growth * (0.5 * self.volume) + T::splat(-self.lame.mu()));
        (inner(f, f) + T::splat(-(D as f64)), volume)
    }

    /// The energy of the stretches on top of that of the volume.
    #[inline(always)]
    fn softened<T: Real>(&self, excess: T, volume: T) -> T {
        let softening = log_of_one_and(excess * (1.0 / (D as f64 + 1.0)));
        (excess - softening).multiply_add(T::splat(0.5 * self.stretch), volume)
    }

    /// `1/(I + 1)`.
    #[inline(always)]
    fn softening<T: Real>(f: &[[T; D]; D]) -> T {
        T::reciprocal(inner(f, f) + T::splat(1.0))
    }

    /// Whether the matrix of the scalings is positive, in space: by the second and the third of its
    /// invariants, as the first one is where the twists' eigenvalues are.
    ///
    /// ```text
    /// w_ij = a (i = j),  b s_k (i, j, k distinct),  + n s_i s_j + l c_i c_j
    /// c_i = J/s_i,   I = sum s_i^2,   II = sum c_i^2,   n = 2 m/(I + 1)^2
    /// w_2 = 3 a^2 - b^2 I + 2 n (a I - 3 b J) + 2 l (a II - b J I) + n l (I II - 9 J^2)
    /// w_3 = a^3 + 2 b^3 J - a b^2 I
    ///     + n (a^2 I - b^2 (I^2 - 4 II) - 6 a b J) + l (a^2 II + 3 b^2 J^2 - 2 a b J I)
    ///     + n l (a (I II - 9 J^2) - 2 b J (I^2 - 3 II))
    /// ```
    #[inline(always)]
    fn stretches_convexly<T: Real>(&self, f: &[[T; D]; D], [a, b]: [T; 2], softening: T) -> bool {
        let (cofactor, l) = (cofactor(f), self.volume);
        let n = softening * softening * (2.0 * self.stretch);
        let (one, two, j) = (inner(f, f), inner(&cofactor, &cofactor), dot(&f[0], &cofactor[0]));
        let (aa, ab, bb) = (a * a, a * b, b * b);
        let (jj, bj) = (j * j, b * j);
        let spread = one * two - jj * 9.0;
        let second = aa * 3.0 - bb * one
            + n * (a * one - bj * 3.0) * 2.0
            + (a * two - bj * one) * (2.0 * l)
            + n * spread * l;
        let third = a * aa + bb * bj * 2.0 - a * bb * one
            + n * (aa * one - bb * (one * one - two * 4.0) - ab * j * 6.0)
            + (aa * two + bb * jj * 3.0 - ab * j * one * 2.0) * l
            + n * (a * spread - bj * (one * one - two * 3.0) * 2.0) * l;
        second.all(|x| x > 0.0) && third.all(|x| x > 0.0)
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
        let (excess, volume) = self.excess_and_volume(f);
        self.softened(excess, volume)
    }

    /// The logarithms come after all the rest: their long chains of dependent terms overlap.
    #[inline(always)]
    fn energies<T: Real>(&self, mut f: impl FnMut(usize) -> [[T; D]; D], densities: &mut [T]) {
        const BATCH: usize = 16;
        for (batch, densities) in densities.chunks_mut(BATCH).enumerate() {
            let mut excess = [T::splat(0.0); BATCH];
            for (k, density) in densities.iter_mut().enumerate() {
                (excess[k], *density) = self.excess_and_volume(&f(BATCH * batch + k));
            }
            for (density, excess) in densities.iter_mut().zip(excess) {
                *density = self.softened(excess, *density);
            }
        }
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

    /// In space. Twists and flips have the eigenvalues `a +- b s_k`; that the matrix of the
    /// scalings is positive is seen by its invariants.
    #[inline(always)]
    fn is_semidefinite<T: Real>(&self, f: &[[T; D]; D]) -> bool {
        if D != 3 {
            return false;
        }
        let softening = Self::softening(f);
        let (a, b) = ((T::splat(1.0) - softening) * self.stretch, self.volume_stress(f));
        let twists = shifted(scaled(&gram(f), -(b * b)), a * a);
        is_positive(&twists) && self.stretches_convexly(f, [a, b], softening)
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; D], weight: T) -> PrincipalTangent<T, D, D> {
        PrincipalTangent::semidefinite(self, f, weight)
    }

    #[inline(always)]
    fn hand_semidefinite<T: Real>(
        &self,
        f: &[[T; D]; D],
        weight: T,
        taker: &mut impl TakesTangent<T, D, D>,
    ) {
        convexified::hand_semidefinite(self, f, weight, taker);
    }
}

/// Below this `(y/(2 + y))^2` the polynomial of [`log_of_one_and`] is exact to rounding: for y from
/// -0.29 to 0.41.
const MODERATE: f64 = 0.1716 * 0.1716;

/// `log(1 + y) = 2 atanh r`, `r = y/(2 + y)`: a polynomial of r where every element's y is moderate,
/// for a fraction of the time that logarithms take one by one.
#[inline(always)]
fn log_of_one_and<T: Real>(y: T) -> T {
    let r = y * (y + T::splat(2.0)).reciprocal();
    let t = r * r;
    if t.any(|t| t.is_nan() | (t >= MODERATE)) {
        let [log] = T::each(&[y], |[y]| [y.ln_1p()]);
        return log;
    }
    // The terms in pairs, and pairs of pairs: a sum one by one would wait for itself.
    let (square, fourth) = (t * t, (t * t) * (t * t));
    let pair = |k: usize| T::splat(ATANH[k + 1]).multiply_add(t, T::splat(ATANH[k]));
    let low = pair(2).multiply_add(square, pair(0));
    let high = T::splat(ATANH[6]).multiply_add(square, pair(4));
    let sum = high.multiply_add(fourth, low);
    let twice = r + r;
    (twice * t).multiply_add(sum, twice)
}

/// `(atanh(r)/r - 1)/r^2` as a polynomial of `r^2`, through Chebyshev points from 0 to [`MODERATE`].
const ATANH: [f64; 7] = [
    0.333_333_333_333_333_5,
    0.199_999_999_999_496_55,
    0.142_857_143_130_316_9,
    0.111_111_055_602_246_49,
    0.090_914_450_851_569_85,
    0.076_658_434_343_192_14,
    0.073_084_394_595_149_11,
];

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
    #[inline(always)]
    fn curvature<T: Real>(&self, s: &[T; D]) -> PrincipalCurvature<T, D> {
        let softening = (dot(s, s) + T::splat(1.0)).reciprocal();
        let identity = (T::splat(1.0) - softening) * self.stretch;
        let stretch = softening * softening * (2.0 * self.stretch);
        let shift = T::splat(-self.volume - self.lame.mu());
        let volume_stress = others(s, [D; 2]).multiply_add(T::splat(self.volume), shift);
        let scaling = pairs(|i, j| {
            let volume = others(s, [i, i]) * others(s, [j, j]) * self.volume;
            let sum = stretch.multiply_add(s[i] * s[j], volume);
            sum + if i == j { identity } else { volume_stress * others(s, [i, j]) }
        });
        PrincipalCurvature {
            scaling,
            twist: pairs(|i, j| volume_stress.multiply_add(others(s, [i, j]), identity)),
            flip: pairs(|i, j| identity - volume_stress * others(s, [i, j])),
            normal: [T::splat(0.0); D],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lanes;

    #[test]
    fn the_series_is_the_logarithm_on_both_sides_of_its_border() {
        for y in [-0.74, -0.3, -0.292, -0.1, -1e-9, 0.0, 1e-12, 0.2, 0.414, 0.4145, 30.0, 1e300] {
            for other in [0.01, 5.0] {
                let lanes = log_of_one_and(Lanes::from([y, other, 0.3, y]));
                for (lane, y) in [y, other, 0.3, y].into_iter().enumerate() {
                    let log = lanes.lane(lane);
                    let exact = y.ln_1p();
                    assert!((log - exact).abs() <= 4e-16 * exact.abs(), "{y}: {log} {exact}");
                }
            }
        }
        assert!(log_of_one_and(f64::NAN).is_nan() && log_of_one_and(-1.5).is_nan());
    }
}
