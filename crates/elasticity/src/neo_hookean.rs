//! A rubber that survives being turned inside out.
//!
//! ```text
//! I = tr F^T F,  J = det F,  d dimensions
//! W = m/2 [I - d - log((I + 1)/(d + 1))] + l/2 (J - 1)^2 - mu (J - 1)         J/m^3
//! m = mu (d + 1)/d,    l = lambda + mu - 2 mu/(d (d + 1))
//! P = a F + b cof F,   a = m (1 - 1/(I + 1)),   b = l (J - 1) - mu
//!
//! near rest, where the terms of first order cancel, with C = F^T F and G = F - I
//! W = m/2 [y - log(1 + y)] + (l + mu)/2 (J - 1)^2 - mu/2 [II(C - I) + det(C - I)],  y = (I - d)/(d + 1)
//! P = (mu + s) G + (b I) (cof F - I) + (s + b + mu) I,   s = m y/((d + 1) (1 + y))
//! K(a', b') = a (a'.b') I + 2 m/(I + 1)^2 (F a')(F b')^T + l (cof F a')(cof F b')^T
//!             + b dcof        dcof = -[F (a' x b')]x in space
//! ```
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. W and P vanish at rest, and for small strains W
//! is that of linear elasticity for every Poisson's ratio, zero and negative ones included: nothing
//! is divided by lambda. W is finite and smooth for every F, also where J <= 0, and at F = 0 it has
//! no resting point. That pulls an inverted element back; it is no barrier against inversion. Needs
//! l > 0, true of every solid and of plane strain; a sheet in plane stress needs nu > -1/2.
//!
//! In the plane it is the rubber of plane strain. With the pair of plane stress it is a sheet that is
//! free to thin to first order of the strain only: 1.6 % too stiff when stretched by 1.01 along both
//! directions, 40 % by 1.2 (nu = 0.3; 13 % along one direction with the other held). At such strains
//! take [`FreeToThin`](crate::FreeToThin) of the solid. Source:
//! Smith, de Goes and Kim, Stable Neo-Hookean Flesh Simulation (2018), rewritten so that the rest
//! state has no energy, and carried over to two dimensions.

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent, others, pairs};
use crate::material::TakesTangent;
use crate::tensor::{
    apply, cofactor, cross, determinant, displacement_gradient, dot, gram, growth, inner,
    is_positive, scaled, shifted, trace, twice_green,
};
use crate::{ElasticityError, Lame, Material, Real, Tangent, convexified};

/// The stable neo-Hookean material of bodies that fill their space. In the plane that is plane strain:
/// a sheet of large strain whose faces are free is [`FreeToThin`](crate::FreeToThin) of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<const D: usize> {
    lame: Lame<D>,
    /// m and l.
    stretch: f64,
    volume: f64,
}

impl<const D: usize> NeoHookean<D> {
    /// The material of a pair. With [`Lame::plane_stress`] it is 40 % too stiff at a stretch of 1.2.
    ///
    /// # Errors
    /// [`ElasticityError::NeoHookean`] where the energy has no lower bound.
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

    /// `y = (I - d)/(d + 1)`, and the energy without `m/2 [y - log(1 + y)]`.
    ///
    /// ```text
    /// mu [(I - d)/2 - (J - 1)] + l/2 (J - 1)^2
    /// (I - d)/2 - (J - 1) = 1/2 [(F_11 - F_22)^2 + (F_12 + F_21)^2]                in the plane
    ///                     = 1/2 [(J - 1)^2 - II(C - I) - det(C - I)]               in space
    /// ```
    /// The last form for small strains, turned or not: for large ones its terms cancel, and the first
    /// one's do not.
    #[inline(always)]
    fn softening_and_rest<T: Real>(&self, f: &[[T; D]; D]) -> (T, T) {
        let (mu, half) = (self.lame.mu(), 0.5 * self.volume);
        let g = displacement_gradient(f);
        let growth = growth(&g, &cofactor(&g));
        if D == 2 {
            let (turned, sheared) = (g[0][0] - g[1][1], g[0][1] + g[1][0]);
            let shape = turned.multiply_add(turned, sheared * sheared);
            let excess = inner(&g, &g) + (g[0][0] + g[1][1]) * 2.0;
            let rest = shape * (0.5 * mu) + growth * growth * half;
            return (excess * (1.0 / (D as f64 + 1.0)), rest);
        }
        let c = twice_green(f);
        let cofactors = cofactor(&c);
        let (excess, invariants) = (trace(&c), trace(&cofactors) + dot(&c[0], &cofactors[0]));
        let volume = growth * growth;
        let near = volume.multiply_add(T::splat(half + 0.5 * mu), invariants * (-0.5 * mu));
        let far = volume.multiply_add(T::splat(half), (excess * 0.5 - growth) * mu);
        let rest = excess.where_above(T::splat(1.0), far, near);
        (excess * (1.0 / (D as f64 + 1.0)), rest)
    }

    /// The energy with the softening on top of the rest.
    #[inline(always)]
    fn softened<T: Real>(&self, y: T, rest: T) -> T {
        excess_over_log(y).multiply_add(T::splat(0.5 * self.stretch), rest)
    }

    /// `1/(I + 1)`.
    #[inline(always)]
    fn softening<T: Real>(f: &[[T; D]; D]) -> T {
        T::reciprocal(inner(f, f) + T::splat(1.0))
    }

    /// Whether the matrix of the scalings is positive, in space, where the twists' eigenvalues are: by
    /// its determinant alone. Its minors `a^2 - b^2 s_k^2` are those of the twists, so that no two
    /// eigenvalues are negative, and what `n` and `l` add makes none smaller.
    ///
    /// ```text
    /// w_ij = a (i = j),  b s_k (i, j, k distinct),  + n s_i s_j + l c_i c_j
    /// c_i = J/s_i,   I = sum s_i^2,   II = sum c_i^2,   n = 2 m/(I + 1)^2
    /// det = a^3 + 2 b^3 J - a b^2 I
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
        let determinant = a * aa + bb * bj * 2.0 - a * bb * one
            + n * (aa * one - bb * (one * one - two * 4.0) - ab * j * 6.0)
            + (aa * two + bb * jj * 3.0 - ab * j * one * 2.0) * l
            + n * (a * spread - bj * (one * one - two * 3.0) * 2.0) * l;
        determinant.all(|x| x > 0.0)
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
        let (y, rest) = self.softening_and_rest(f);
        self.softened(y, rest)
    }

    /// The logarithms come after all the rest: their long chains of dependent terms overlap.
    #[inline(always)]
    fn energies<T: Real>(&self, mut f: impl FnMut(usize) -> [[T; D]; D], densities: &mut [T]) {
        const BATCH: usize = 16;
        for (batch, densities) in densities.chunks_mut(BATCH).enumerate() {
            let mut y = [T::splat(0.0); BATCH];
            for (k, density) in densities.iter_mut().enumerate() {
                (y[k], *density) = self.softening_and_rest(&f(BATCH * batch + k));
            }
            for (density, y) in densities.iter_mut().zip(y) {
                *density = self.softened(y, *density);
            }
        }
    }

    #[inline(always)]
    fn stress<T: Real>(&self, f: &[[T; D]; D]) -> [[T; D]; D] {
        let (mu, d) = (self.lame.mu(), D as f64);
        let g = displacement_gradient(f);
        let c = cofactor(&g);
        let plain = trace(&g);
        let pressure = growth(&g, &c) * self.volume;
        let excess = inner(&g, &g) + plain * 2.0;
        // I + 1 = (I - d) + (d + 1)
        let stiffened = excess * (excess + T::splat(d + 1.0)).reciprocal();
        let s = stiffened * (self.stretch / (d + 1.0));
        let (a, b) = (s + T::splat(mu), pressure + T::splat(-mu));
        // cof F - I = tr G I - G^T + cof G in space, cof G in the plane.
        let mut diagonal = s + pressure;
        if D == 3 {
            diagonal = b.multiply_add(plain, diagonal);
        }
        let mut stress = *f;
        for k in 0..D {
            for i in 0..D {
                let beyond = if D == 3 { c[k][i] - g[i][k] } else { c[k][i] };
                stress[k][i] = g[k][i].multiply_add(a, beyond * b);
            }
            stress[k][k] += diagonal;
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
    /// scalings is positive is seen by its determinant.
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

/// Below this `(y/(2 + y))^2` the polynomial of [`excess_over_log`] is exact to rounding: for y from
/// -0.29 to 0.41.
const MODERATE: f64 = 0.1716 * 0.1716;

/// `y - log(1 + y) = y r - 2 (atanh r - r)`, `r = y/(2 + y)`: a polynomial of r where every element's
/// y is moderate, for a fraction of the time that logarithms take one by one, and without cancellation.
#[inline(always)]
fn excess_over_log<T: Real>(y: T) -> T {
    let r = y * (y + T::splat(2.0)).reciprocal();
    let t = r * r;
    if t.any(|t| t.is_nan() | (t >= MODERATE)) {
        let [excess] = T::each(&[y], |&[y]| [plain_excess_over_log(y)]);
        return excess;
    }
    // The terms in pairs, and pairs of pairs: a sum one by one would wait for itself.
    let (square, fourth) = (t * t, (t * t) * (t * t));
    let pair = |k: usize| T::splat(ATANH[k + 1]).multiply_add(t, T::splat(ATANH[k]));
    let low = pair(2).multiply_add(square, pair(0));
    let high = T::splat(ATANH[6]).multiply_add(square, pair(4));
    let sum = high.multiply_add(fourth, low);
    ((t + t) * -r).multiply_add(sum, y * r)
}

/// The same of one number: beside others that are not moderate it keeps its own bits but for rounding.
fn plain_excess_over_log(y: f64) -> f64 {
    let r = y / (2.0 + y);
    let t = r * r;
    if t < MODERATE {
        let sum = ATANH.iter().rev().fold(0.0, |sum, c| sum * t + c);
        y * r - 2.0 * r * t * sum
    } else {
        y - y.ln_1p()
    }
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
        for y in [-0.74, -0.3, -0.292, -0.1, 0.2, 0.414, 0.4145, 30.0, 1e300] {
            for other in [0.01, 5.0] {
                let lanes = excess_over_log(Lanes::from([y, other, 0.3, y]));
                for (lane, y) in [y, other, 0.3, y].into_iter().enumerate() {
                    let (got, exact) = (lanes.lane(lane), y - y.ln_1p());
                    // The plain difference loses y over the result.
                    assert!((got - exact).abs() <= 1e-15 * y.abs() + 4e-16 * exact, "{y}: {got}");
                }
            }
        }
        assert!(excess_over_log(f64::NAN).is_nan() && excess_over_log(-1.5).is_nan());
    }

    #[test]
    fn the_series_keeps_its_digits_down_to_nothing() {
        for y in [1e-12, -1e-9, 1e-5, -1e-5, 0.0] {
            let exact = y * y * (0.5 - y * (1.0 / 3.0 - y * 0.25));
            for other in [0.0, 5.0] {
                let got = excess_over_log(Lanes::from([y, other, 0.3, y])).lane(0);
                assert!((got - exact).abs() <= 1e-14 * exact, "{y}: {got} {exact}");
            }
        }
    }

    #[test]
    fn energy_and_stress_keep_their_digits_at_strains_of_1e_12() {
        let lame = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap();
        let (lambda, mu) = (lame.lambda(), lame.mu());
        let rubber = NeoHookean::new(lame).unwrap();
        // Doubles, so that F is exactly I + e: to leading order the linear law's.
        for e in [2.0_f64.powi(-40), 2.0_f64.powi(-30), 2.0_f64.powi(-24)] {
            let f = [[1.0 + e, 0.0, 0.0], [0.0, 1.0, 0.0], [e, 0.0, 1.0 - 2.0 * e]];
            let energy = mu * (5.0 * e * e + 0.5 * e * e) + 0.5 * lambda * e * e;
            assert!((rubber.energy(&f) / energy - 1.0).abs() < 20.0 * e + 1e-14, "{e}");
            let along = 2.0 * mu * e - lambda * e;
            assert!((rubber.stress(&f)[0][0] / along - 1.0).abs() < 100.0 * e + 1e-13, "{e}");
        }
        let rest = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!((rubber.energy(&rest), rubber.stress(&rest)), (0.0, [[0.0; 3]; 3]));
    }

    #[test]
    fn where_the_twists_are_positive_a_determinant_tells_whether_the_scalings_are() {
        let mut random = stationary_measure::SplitMix64::new(5);
        let mut convex = [0; 2];
        for k in 0..20_000 {
            // Of any shape, and all but evenly pressed where a body hardly resists that.
            let (poisson, spread) = if k % 2 == 0 { (-0.2, 0.9) } else { (-0.89, 0.05) };
            let (poisson, base) =
                (poisson + 0.109 * random.symmetric(), (0.2 * random.symmetric() - 0.1).exp());
            let lame = Lame::<3>::from_young_poisson(1.0, poisson).unwrap();
            let rubber = NeoHookean::new(lame).unwrap();
            let s = [0, 1, 2].map(|_| base * (1.0 + spread * random.symmetric()));
            let f = [[s[0], 0.0, 0.0], [0.0, s[1], 0.0], [0.0, 0.0, s[2]]];
            let PrincipalCurvature { scaling, twist, flip, .. } = rubber.curvature(&s);
            let pairs = [(0, 1), (1, 2), (2, 0)];
            if pairs.iter().any(|&(i, j)| twist[i][j].min(flip[i][j]) < 0.0) {
                continue;
            }
            let matrix = nalgebra::Matrix3::from_fn(|i, j| scaling[i][j]);
            let least = matrix.symmetric_eigenvalues().min();
            if least.abs() < 1e-6 {
                continue;
            }
            let softening = NeoHookean::<3>::softening(&f);
            let a = rubber.stretch * (1.0 - softening);
            let told = rubber.stretches_convexly(&f, [a, rubber.volume_stress(&f)], softening);
            assert_eq!(told, least > 0.0, "{s:?} {poisson}: {least}");
            convex[usize::from(told)] += 1;
        }
        assert!(convex.iter().all(|&count| count > 100), "{convex:?}");
    }
}
