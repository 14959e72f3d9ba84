//! Measures of stretch, and how a material model changes when its measure does.
//!
//! ```text
//! s = l/L                         stretch: length over rest length, along one direction
//! Cauchy       s - 1              Green      (s^2 - 1)/2
//! logarithmic  log s              deformed   1 - 1/s             (notes 3, bonus)
//! V = 1/2 c2 eps^2 + 1/6 c3 eps^3 + 1/24 c4 eps^4 + ...
//!
//! in R dimensions, F = U diag(s) V^T:    strain tensor = V diag(eps(s)) V^T,  R x R
//! Green = 1/2 (F^T F - I),  Cauchy = sqrt(F^T F) - I,  logarithmic = 1/2 log F^T F
//! ```
//! `c2 c3 c4` joules for a spring, J/m^3 for a body. "The strain can be chosen freely, but the
//! material must then be specified with respect to that strain": [`Measure::converted`] does so,
//! exactly through fourth order. Logarithmic and deformed strain have no value at stretch zero, the
//! others have. A body that is turned inside out has the stretches of its mirror image. Source:
//! notes 3.1 with its bonus section, 13.1; errata 3 (a sign of the deformed measure).

use crate::eigen::{spectral, symmetric_eigen};
use crate::singular::singular;
use crate::tensor::{inner, scaled, twice_green};

/// A measure of how much a length has changed. All agree for small changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// `(l - L)/L`.
    Cauchy,
    /// `(l^2 - L^2)/(2 L^2)`.
    Green,
    /// `log(l/L)`: stretching twice adds up.
    Logarithmic,
    /// `(l - L)/l`: relative to the deformed length.
    Deformed,
}

/// Up to this `|F^T F - I|^2` strain is taken from there.
const NEAR: f64 = 0.25;

impl Measure {
    /// All of them.
    pub const ALL: [Measure; 4] =
        [Measure::Cauchy, Measure::Green, Measure::Logarithmic, Measure::Deformed];

    /// The strain at a stretch. NaN where the measure has no value, at stretches below zero.
    pub fn strain(self, stretch: f64) -> f64 {
        let s = stretch;
        if s < 0.0 {
            return f64::NAN;
        }
        match self {
            Measure::Cauchy => s - 1.0,
            Measure::Green => 0.5 * (s - 1.0) * (s + 1.0),
            Measure::Logarithmic => s.ln(),
            Measure::Deformed => (s - 1.0) / s,
        }
    }

    /// The stretch at a strain. NaN where no stretch has that strain.
    pub fn stretch(self, strain: f64) -> f64 {
        let s = match self {
            Measure::Cauchy => 1.0 + strain,
            Measure::Green => (1.0 + 2.0 * strain).sqrt(),
            Measure::Logarithmic => strain.exp(),
            Measure::Deformed => (1.0 - strain).recip(),
        };
        if s >= 0.0 { s } else { f64::NAN }
    }

    /// The strain by the stretch less one: `x + a x^2 + b x^3`.
    fn series(self) -> [f64; 2] {
        match self {
            Measure::Cauchy => [0.0, 0.0],
            Measure::Green => [0.5, 0.0],
            Measure::Logarithmic => [-0.5, 1.0 / 3.0],
            Measure::Deformed => [-1.0, 1.0],
        }
    }

    /// The coefficients `c2, c3, c4` of the same energy in another measure of strain.
    pub fn converted(self, coefficients: [f64; 3], to: Measure) -> [f64; 3] {
        // With e this measure's strain and t the other's: e = t + p t^2 + q t^3.
        let ([a, b], [c, d]) = (self.series(), to.series());
        // x = t - c t^2 + (2 c^2 - d) t^3
        let [x2, x3] = [-c, 2.0 * c * c - d];
        let (p, q) = (x2 + a, x3 + 2.0 * a * x2 + b);
        let [c2, c3, c4] = coefficients;
        let third = c2 * p + c3 / 6.0;
        let fourth = c2 * (0.5 * p * p + q) + 0.5 * c3 * p + c4 / 24.0;
        [c2, 6.0 * third, 24.0 * fourth]
    }

    /// The strain tensor of F, given by columns.
    pub fn tensor<const D: usize, const R: usize>(self, f: &[[f64; D]; R]) -> [[f64; R]; R] {
        let twice = twice_green(f);
        if self == Measure::Green {
            return scaled(&twice, 0.5);
        }
        // Small strains have their digits in F^T F - I, large ones in the stretches.
        if inner(&twice, &twice) <= NEAR {
            let (values, vectors) = symmetric_eigen(&twice);
            return spectral(&vectors, &values.map(|c| self.of_square(c)));
        }
        singular(f).spectral(|s| self.strain(s.abs()))
    }

    /// The strain at a stretch whose square is `1 + c`.
    fn of_square(self, c: f64) -> f64 {
        let s = (1.0 + c).sqrt();
        match self {
            Measure::Cauchy => c / (1.0 + s),
            Measure::Green => 0.5 * c,
            Measure::Logarithmic => 0.5 * c.ln_1p(),
            Measure::Deformed => c / (s * (1.0 + s)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{product, trace};
    use proptest::prelude::*;

    #[test]
    fn the_notes_coefficients_hold_with_their_sign_put_right() {
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        let green = Measure::Green.converted([1.0, 0.0, 0.0], Measure::Cauchy);
        assert!(close(green, [1.0, 3.0, 3.0]), "{green:?}");
        let deformed = Measure::Deformed.converted([1.0, 0.0, 0.0], Measure::Cauchy);
        assert!(close(deformed, [1.0, -6.0, 36.0]), "{deformed:?}");
    }

    #[test]
    fn every_conversion_leaves_the_energy_alone_through_fourth_order() {
        let energy =
            |c: [f64; 3], e: f64| e * e * (c[0] / 2.0 + e * (c[1] / 6.0 + e * c[2] / 24.0));
        for from in Measure::ALL {
            for to in Measure::ALL {
                let c = [2.0, -3.0, 5.0];
                let converted = from.converted(c, to);
                let gap = |x: f64| {
                    let there = energy(converted, to.strain(1.0 + x));
                    (energy(c, from.strain(1.0 + x)) - there).abs()
                };
                if from == to {
                    assert_eq!(converted, c);
                    continue;
                }
                let order = (gap(4e-2) / gap(2e-2)).log2();
                assert!((order - 5.0).abs() < 0.4 || gap(4e-2) < 1e-15, "{from:?} {to:?} {order}");
                let back = to.converted(converted, from);
                assert!(back.iter().zip(c).all(|(a, b)| (a - b).abs() < 1e-11), "{from:?} {to:?}");
            }
        }
    }

    #[test]
    fn stretch_and_strain_undo_each_other_where_both_are_defined() {
        for measure in Measure::ALL {
            for s in [0.1, 0.5, 1.0, 1.7, 40.0] {
                assert!((measure.stretch(measure.strain(s)) / s - 1.0).abs() < 1e-12);
            }
            assert!(measure.strain(-1.0).is_nan());
        }
        assert!(Measure::Green.stretch(-0.6).is_nan() && Measure::Cauchy.stretch(-1.1).is_nan());
        assert!(Measure::Deformed.stretch(1.5).is_nan());
        assert_eq!(Measure::Logarithmic.strain(0.0), f64::NEG_INFINITY);
    }

    proptest! {
        #[test]
        fn tensors_have_the_strain_of_every_principal_direction(
            s in prop::array::uniform3(0.2..3.0_f64), angle in -3.0..3.0_f64,
        ) {
            let (c, d) = (angle.cos(), angle.sin());
            // F = R diag(s) R^T with R a turn about the third axis.
            let r = [[c, d, 0.0], [-d, c, 0.0], [0.0, 0.0, 1.0]];
            let f = crate::eigen::spectral(&r, &s);
            for measure in Measure::ALL {
                let tensor = measure.tensor(&f);
                for (k, v) in r.iter().enumerate() {
                    let image = crate::tensor::apply(&tensor, v);
                    for i in 0..3 {
                        prop_assert!((image[i] - measure.strain(s[k]) * v[i]).abs() < 1e-12);
                    }
                }
            }
            // Volume: the trace of logarithmic strain is the logarithm of the product.
            let volume = trace(&Measure::Logarithmic.tensor(&f));
            prop_assert!((volume - (s[0] * s[1] * s[2]).ln()).abs() < 1e-12);
        }

        #[test]
        fn small_strains_keep_their_digits_in_every_measure(
            e in prop::array::uniform3(-1.0..1.0_f64), power in 10..40_i32,
        ) {
            // Doubles, so that F - I is what it says.
            let size = 2.0_f64.powi(-power);
            let e = e.map(|e| size * (e * 1024.0).round() / 1024.0);
            let f = [[1.0 + e[0], 0.0, 0.0], [0.0, 1.0 + e[1], 0.0], [0.0, 0.0, 1.0 + e[2]]];
            for measure in Measure::ALL {
                let tensor = measure.tensor(&f);
                for k in 0..3 {
                    let error = (tensor[k][k] - e[k]).abs();
                    prop_assert!(error <= 2.0 * e[k] * e[k] + 1e-15 * size, "{:?}", measure);
                }
            }
        }

        #[test]
        fn rotations_have_no_strain(angle in -3.0..3.0_f64) {
            let (c, d) = (angle.cos(), angle.sin());
            let about = [[c, d, 0.0], [-d, c, 0.0], [0.0, 0.0, 1.0]];
            let turn = |f: &[[f64; 3]; 3]| product(&about, f);
            let sheet = turn(&[[1.0, 0.0, 0.0], [0.0, c, d], [0.0, -d, c]]);
            for measure in Measure::ALL {
                let strain = measure.tensor(&[sheet[0], sheet[1]]);
                prop_assert!(strain.as_flattened().iter().all(|e| e.abs() < 1e-15));
            }
        }
    }
}
