//! Jacobi's elliptic functions and Carlson's integrals, as the free top needs them.
//!
//! ```text
//! u = F(am u) = int_0^am dx / sqrt(1 - k^2 sin^2 x)
//! sn = sin am,   cn = cos am,   dn = sqrt(kc^2 + k^2 cn^2)
//! F = s RF(cos^2, 1 - k^2 s^2, 1)                      s = sin am, |am| <= pi/2
//! E_c(u) = int_0^u c sn^2 v / (1 + c sn^2 v) dv        c >= 0
//!        = c/3 s^3 RJ(cos^2, 1 - k^2 s^2, 1, 1 + c s^2)
//!        = c/(1 + c) (u - atan(sqrt(c) tanh u)/sqrt(c))                              k = 1
//! ```
//! `k` the modulus, `kc` its complement, given as well because `1 - k^2` loses it near 1, where the
//! quarter period `K = F(pi/2)` grows without bound. The functions come from the descending Landen
//! transformation in cotangents, where nothing cancels: sn, cn and dn are right in their own digits, as
//! the integrals need them, which tell how small cn is. The integrals are found by duplication.
//! Source: Bulirsch 1965, Numerical calculation of elliptic integrals and elliptic functions; Carlson
//! 1995; DLMF 19.25, 19.36.

/// A modulus and its complement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Modulus {
    /// The square of k, in [0, 1].
    pub k2: f64,
    /// The square of kc, in [0, 1].
    pub kc2: f64,
}

/// An argument as whole half periods and a rest, `u = 2 K turns + rest`, and the functions there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Argument {
    turns: f64,
    rest: f64,
    /// sn, cn and dn of the rest.
    functions: [f64; 3],
}

impl Argument {
    /// `sn, cn, dn`.
    pub(crate) fn functions(&self) -> [f64; 3] {
        let [sn, cn, dn] = self.functions;
        // Each half period turns both signs.
        let sign = if self.turns.rem_euclid(2.0) == 1.0 { -1.0 } else { 1.0 };
        [sign * sn, sign * cn, dn]
    }
}

impl Modulus {
    /// The quarter period K; infinite where kc is 0.
    pub(crate) fn quarter_period(&self) -> f64 {
        if self.kc2 == 0.0 { f64::INFINITY } else { carlson_rf(0.0, self.kc2, 1.0) }
    }

    /// The u in [-2K, 2K] at which sn and cn are proportional to `s` and `c`.
    pub(crate) fn argument_of(&self, s: f64, c: f64) -> f64 {
        let kc = self.kc2.sqrt();
        let first = if kc * s.abs() < c.abs() {
            self.first_integral(s.abs(), c.abs())
        } else {
            // Seen from the quarter period, where dn is as small as kc.
            self.quarter_period() - self.first_integral(c.abs(), kc * s.abs())
        };
        if c >= 0.0 { first.copysign(s) } else { (2.0 * self.quarter_period() - first).copysign(s) }
    }

    /// `F` of the angle in [0, pi/2] whose sine and cosine are proportional to `s` and `c`.
    fn first_integral(&self, s: f64, c: f64) -> f64 {
        let length = s.hypot(c);
        let (s, c) = (s / length, c / length);
        s * carlson_rf(c * c, self.delta2(s, c), 1.0)
    }

    /// Whole half periods, rest and functions of an argument.
    pub(crate) fn argument(&self, u: f64) -> Argument {
        let quarter = self.quarter_period();
        let turns = if quarter.is_finite() { (u / (2.0 * quarter)).round() } else { 0.0 };
        let rest = if turns == 0.0 { u } else { u - turns * (2.0 * quarter) };
        if rest.abs() <= 0.5 * quarter {
            return Argument { turns, rest, functions: self.near_zero(rest) };
        }
        let [sn, cn, dn] = self.near_zero(quarter - rest.abs());
        let kc = self.kc2.sqrt();
        Argument { turns, rest, functions: [(cn / dn).copysign(rest), kc * sn / dn, kc / dn] }
    }

    /// sn, cn and dn of at most half a quarter period, where the last cosine of the transformation is
    /// not small.
    fn near_zero(&self, u: f64) -> [f64; 3] {
        if self.kc2 == 0.0 {
            return [u.tanh(), 1.0 / u.cosh(), 1.0 / u.cosh()];
        }
        if u.abs() < TINY {
            return [u, 1.0, 1.0];
        }
        let mut means = [[1.0, self.kc2.sqrt()]; LEVELS];
        let mut level = 0;
        // Each step squares the relative difference.
        while level + 1 < LEVELS
            && (means[level][0] - means[level][1]).abs() > TINY * means[level][0]
        {
            let [a, b] = means[level];
            level += 1;
            means[level] = [0.5 * (a + b), (a * b).sqrt()];
        }
        let mean = 0.5 * (means[level][0] + means[level][1]);
        let (s, c) = (mean * u).sin_cos();
        // cn/sn times the mean, level by level.
        let (mut ratio, mut cotangent, mut dn) = (c / s, mean * (c / s), 1.0);
        for &[a, b] in means[..=level].iter().rev() {
            ratio *= cotangent;
            cotangent *= dn;
            dn = (b + ratio) / (a + ratio);
            ratio = cotangent / a;
        }
        let sn = (1.0 / cotangent.hypot(1.0)).copysign(u);
        [sn, cotangent * sn, dn]
    }

    /// `E_c(u)` for `c >= 0`.
    pub(crate) fn excess_integral(&self, u: &Argument, c: f64) -> f64 {
        if self.kc2 == 0.0 {
            let root = c.sqrt();
            let turned =
                if root == 0.0 { u.rest.tanh() } else { (root * u.rest.tanh()).atan() / root };
            return c / (1.0 + c) * (u.rest - turned);
        }
        let rest = self.excess_within(u.functions, c);
        if u.turns == 0.0 {
            return rest;
        }
        rest + 2.0 * u.turns * self.excess_within([1.0, 0.0, self.kc2.sqrt()], c)
    }

    /// `E_c` within half a period.
    fn excess_within(&self, [sn, cn, dn]: [f64; 3], c: f64) -> f64 {
        c / 3.0 * sn.powi(3) * carlson_rj(cn * cn, dn * dn, 1.0, 1.0 + c * sn * sn)
    }

    /// `1 - k^2 s^2` without cancellation.
    fn delta2(&self, s: f64, c: f64) -> f64 {
        self.kc2 * s * s + c * c
    }
}

/// Differences and arguments whose square is below rounding.
const TINY: f64 = 1e-8;
/// Steps of the transformation that no modulus exceeds.
const LEVELS: usize = 32;

/// Relative differences at which the series of a duplication is exact to rounding.
const NEAR: f64 = 1e-3;
/// Each duplication divides the differences by four: no double needs more.
const DUPLICATIONS: usize = 600;

/// Carlson's `RF(x, y, z)`, at most one argument zero.
fn carlson_rf(x: f64, y: f64, z: f64) -> f64 {
    let (mut x, mut y, mut z) = (x, y, z);
    for _ in 0..DUPLICATIONS {
        let mean = (x + y + z) / 3.0;
        let (dx, dy) = (1.0 - x / mean, 1.0 - y / mean);
        let dz = -(dx + dy);
        if dx.abs().max(dy.abs()).max(dz.abs()) < NEAR {
            let (e2, e3) = (dx * dy - dz * dz, dx * dy * dz);
            let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0;
            return series / mean.sqrt();
        }
        let lambda = (x * y).sqrt() + (y * z).sqrt() + (z * x).sqrt();
        (x, y, z) = (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda));
    }
    f64::NAN
}

/// Carlson's `RJ(x, y, z, p)` where p is at least as large as the others, at most one of them zero.
fn carlson_rj(x: f64, y: f64, z: f64, p: f64) -> f64 {
    let (mut x, mut y, mut z, mut p) = (x, y, z, p);
    let (mut sum, mut scale) = (0.0, 1.0);
    for _ in 0..DUPLICATIONS {
        let mean = (x + y + z + 2.0 * p) / 5.0;
        let (dx, dy, dz) = (1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean);
        if dx.abs().max(dy.abs()).max(dz.abs()) < NEAR {
            return scale * rj_series(dx, dy, dz) / (mean * mean.sqrt()) + 6.0 * sum;
        }
        let (rx, ry, rz, rp) = (x.sqrt(), y.sqrt(), z.sqrt(), p.sqrt());
        let lambda = rx * ry + ry * rz + rz * rx;
        let d = (rp + rx) * (rp + ry) * (rp + rz);
        let e = (p - x) * (p - y) * (p - z) / (d * d);
        sum += scale / d * rc_beyond_one(e);
        scale *= 0.25;
        (x, y, z, p) =
            (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda), 0.25 * (p + lambda));
    }
    f64::NAN
}

/// `RC(1, 1 + e)` for `e >= 0`.
fn rc_beyond_one(e: f64) -> f64 {
    let root = e.max(0.0).sqrt();
    if root < 1e-8 { 1.0 } else { root.atan() / root }
}

fn rj_series(x: f64, y: f64, z: f64) -> f64 {
    let p = -0.5 * (x + y + z);
    let (xyz, pp) = (x * y * z, p * p);
    let e2 = x * y + y * z + z * x - 3.0 * pp;
    let e3 = xyz + 2.0 * e2 * p + 4.0 * p * pp;
    let e4 = (2.0 * xyz + e2 * p + 3.0 * p * pp) * p;
    let e5 = xyz * pp;
    1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0
        + 3.0 * e5 / 26.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    fn modulus(k: f64) -> Modulus {
        Modulus { k2: k * k, kc2: (1.0 - k) * (1.0 + k) }
    }

    #[test]
    fn quarter_periods_agree_with_the_tables() {
        // K(1/sqrt 2) is Gauss's Gamma(1/4)^2 / (4 sqrt pi); K(0) = pi/2.
        let lemniscate = Modulus { k2: 0.5, kc2: 0.5 }.quarter_period();
        assert!((lemniscate - 1.854_074_677_301_371_9).abs() < 1e-15);
        assert!((modulus(0.0).quarter_period() - FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn sn_and_cn_undo_the_first_integral() {
        for k in [0.0, 0.1, 0.7, 0.99, 0.999_999] {
            let modulus = modulus(k);
            for i in -15..=15 {
                let (s, c) = (0.2 * f64::from(i)).sin_cos();
                let u = modulus.argument(modulus.argument_of(s, c));
                let [sn, cn, _] = u.functions();
                assert!(
                    (sn - s).abs() < 1e-14 && (cn - c).abs() < 1e-14,
                    "k = {k}, {s} {c}: {u:?}"
                );
            }
        }
    }

    #[test]
    fn the_functions_obey_their_differential_equations() {
        for k in [0.0, 0.3, 0.9, 0.999] {
            let modulus = modulus(k);
            let at = |u: f64| modulus.argument(u).functions();
            for i in -20..=20 {
                let (u, h) = (0.37 * f64::from(i), 1e-5);
                let ([sn, cn, dn], after, before) = (at(u), at(u + h), at(u - h));
                assert!((sn * sn + cn * cn - 1.0).abs() < 1e-15);
                let slope = |j: usize| (after[j] - before[j]) / (2.0 * h);
                assert!((slope(0) - cn * dn).abs() < 1e-9, "k = {k}, u = {u}");
                assert!((slope(1) + sn * dn).abs() < 1e-9);
                assert!((slope(2) + modulus.k2 * sn * cn).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_excess_integral_has_its_integrand_as_slope() {
        for (k, c) in [(0.0, 0.5), (0.4, 0.0), (0.8, 3.0), (0.99, 100.0), (1.0, 2.0)] {
            let modulus = modulus(k);
            let excess = |u: f64| modulus.excess_integral(&modulus.argument(u), c);
            for i in -20..=20 {
                let (u, h) = (0.37 * f64::from(i), 1e-5);
                let [sn, ..] = modulus.argument(u).functions();
                let slope = (excess(u + h) - excess(u - h)) / (2.0 * h);
                let expected = c * sn * sn / (1.0 + c * sn * sn);
                assert!((slope - expected).abs() < 1e-7, "k = {k}, c = {c}, u = {u}");
            }
        }
    }

    #[test]
    fn beside_the_separatrix_cn_and_dn_are_right_in_their_own_digits() {
        // kc = 0 to rounding: cn = dn = 1/cosh u but for kc^2 cosh^2 u / 4.
        let modulus = Modulus { k2: 1.0, kc2: 1e-36 };
        for u in [0.1, 1.0, 5.9, 12.0, 20.0] {
            let [sn, cn, dn] = modulus.argument(u).functions();
            let expected = 1.0 / u.cosh();
            assert!((sn / u.tanh() - 1.0).abs() < 1e-15);
            assert!((cn / expected - 1.0).abs() < 1e-14, "u = {u}: {cn:e} {expected:e}");
            assert!((dn / expected - 1.0).abs() < 1e-14, "u = {u}: {dn:e} {expected:e}");
        }
    }
}
