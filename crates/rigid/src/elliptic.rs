//! Jacobi's elliptic functions and Carlson's integrals, as the free top needs them.
//!
//! ```text
//! u = F(am u) = int_0^am dx / sqrt(1 - k^2 sin^2 x)
//! sn = sin am,   cn = cos am,   dn = sqrt(kc^2 + k^2 cn^2)
//! Pi(u) = int_0^u dv / (1 + c sn^2 v),                 c >= 0
//! F = s RF(cos^2, 1 - k^2 s^2, 1)                      s = sin am, |am| <= pi/2
//! Pi = F - c/3 s^3 RJ(cos^2, 1 - k^2 s^2, 1, 1 + c s^2)
//! ```
//! `k` the modulus, `kc` its complement, given as well because `1 - k^2` loses it near 1, where the
//! quarter period `K = F(pi/2)` grows without bound. The amplitude is the descending Landen
//! transformation's; the integrals are found by duplication.
//! Source: Abramowitz and Stegun 16.4; Carlson 1995; DLMF 19.25, 19.36.

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

    fn near_zero(&self, u: f64) -> [f64; 3] {
        let (s, c) = self.amplitude(u).sin_cos();
        [s, c, self.delta2(s, c).sqrt()]
    }

    /// `Pi(u)` for `c >= 0`.
    pub(crate) fn third_integral(&self, u: &Argument, c: f64) -> f64 {
        let less = self.less_than_argument(u.functions, c);
        if u.turns == 0.0 {
            return u.rest - less;
        }
        let complete = self.less_than_argument([1.0, 0.0, self.kc2.sqrt()], c);
        (u.rest - less) + 2.0 * u.turns * (self.quarter_period() - complete)
    }

    /// `c/3 s^3 RJ`, by which Pi is less than u.
    fn less_than_argument(&self, [sn, cn, dn]: [f64; 3], c: f64) -> f64 {
        c / 3.0 * sn.powi(3) * carlson_rj(cn * cn, dn * dn, 1.0, 1.0 + c * sn * sn)
    }

    /// `1 - k^2 s^2` without cancellation.
    fn delta2(&self, s: f64, c: f64) -> f64 {
        self.kc2 * s * s + c * c
    }

    /// `am u`, by the descending Landen transformation.
    fn amplitude(&self, u: f64) -> f64 {
        if self.kc2 == 0.0 {
            return u.sinh().atan();
        }
        let (mut a, mut b) = (1.0, self.kc2.sqrt());
        let mut ratios = [0.0; 32];
        let mut depth = 0;
        // Each step squares the relative difference.
        while depth < ratios.len() && (a - b).abs() > 1e-15 * a {
            let mean = 0.5 * (a + b);
            ratios[depth] = 0.5 * (a - b) / mean;
            (a, b) = (mean, (a * b).sqrt());
            depth += 1;
        }
        let mut phi = a * u * 2.0_f64.powi(depth as i32);
        for ratio in ratios[..depth].iter().rev() {
            phi = 0.5 * (phi + (ratio * phi.sin()).clamp(-1.0, 1.0).asin());
        }
        phi
    }
}

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
    fn the_third_integral_has_its_integrand_as_slope() {
        for (k, c) in [(0.0, 0.5), (0.4, 0.0), (0.8, 3.0), (0.99, 100.0)] {
            let modulus = modulus(k);
            let pi = |u: f64| modulus.third_integral(&modulus.argument(u), c);
            for i in -20..=20 {
                let (u, h) = (0.37 * f64::from(i), 1e-5);
                let [sn, ..] = modulus.argument(u).functions();
                let slope = (pi(u + h) - pi(u - h)) / (2.0 * h);
                assert!(
                    (slope - 1.0 / (1.0 + c * sn * sn)).abs() < 1e-7,
                    "k = {k}, c = {c}, u = {u}"
                );
            }
        }
    }
}
