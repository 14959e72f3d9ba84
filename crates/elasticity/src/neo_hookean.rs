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
        let softening = log_of_one_and(excess * (1.0 / (d + 1.0)));
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

/// Below this `|y/(2 + y)|` the series of [`log_of_one_and`] is exact to rounding: for y from -0.29
/// to 0.41.
const SERIES: f64 = 0.1716;

/// `log(1 + y) = 2 atanh(y/(2 + y))`, by the series of atanh where every element's y is moderate: a
/// fraction of the time that logarithms take one by one.
#[inline(always)]
fn log_of_one_and<T: Real>(y: T) -> T {
    let r = y * (y + T::splat(2.0)).reciprocal();
    if r.any(|r| r.is_nan() || r.abs() >= SERIES) {
        let [log] = T::each(&[y], |[y]| [y.ln_1p()]);
        return log;
    }
    // The terms in pairs, pairs of pairs, and so on: a sum one by one would wait for itself.
    let t = r * r;
    let [square, fourth] = [t * t, (t * t) * (t * t)];
    let pair = |k: usize| {
        let term = |k: usize| T::splat(1.0 / (2 * k + 1) as f64);
        term(k + 1).multiply_add(t, term(k))
    };
    let last = square.multiply_add(T::splat(1.0 / 21.0), pair(8));
    let high = last.multiply_add(fourth, pair(6).multiply_add(square, pair(4)));
    let sum = high.multiply_add(fourth, pair(2).multiply_add(square, pair(0)));
    (r + r) * sum
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
                let lanes = log_of_one_and(Lanes([y, other, 0.3, y]));
                for (log, y) in lanes.0.iter().zip([y, other, 0.3, y]) {
                    let exact = y.ln_1p();
                    assert!((log - exact).abs() <= 4e-16 * exact.abs(), "{y}: {log} {exact}");
                }
            }
        }
        assert!(log_of_one_and(f64::NAN).is_nan() && log_of_one_and(-1.5).is_nan());
    }
}
