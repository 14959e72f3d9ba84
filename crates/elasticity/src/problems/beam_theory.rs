//! Frequencies of a slender sheet by the two theories of beams.
//!
//! ```text
//! w' = psi + Q/(k G A)     psi' = M/(E I)     M' = -Q - rho I om^2 psi     Q' = -rho A om^2 w
//! y(L) = exp(L B) y(0),  y = (w, psi, M, Q)
//! clamped  w = psi = 0 at 0, M = Q = 0 at L       free  M = Q = 0 at both ends
//! ```
//! `w` deflection (m), `psi` the turn of the cross-section, `M Q` moment and shear force, `om` angular
//! frequency (rad/s); thickness, density and E are 1, nu is 0: `A = h`, `I = h^3/12`, `G = 1/2`, `k =
//! 5/6`. An angular frequency is one at which the conditions have a solution other than zero: the
//! determinant of two rows and two columns of the exponential changes sign. Without shear and rotary
//! inertia this is Euler and Bernoulli's beam, `cosh b cos b = -1` or `1` for `b^4 = rho A om^2 L^4/(E I)`;
//! with them Timoshenko's, whose error against the sheet is of a higher power of h/L. Source:
//! Timoshenko (1921); Cowper (1966) for k at nu = 0.

use nalgebra::Matrix4;

/// How a beam is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Clamped at x = 0, free at the other end.
    Clamped,
    /// Free at both.
    Free,
}

/// What a cross-section may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeamTheory {
    /// It stays normal to the beam and turns without inertia.
    EulerBernoulli,
    /// It turns by itself.
    Timoshenko,
}

/// Steps of the search between zero and the first frequency of a clamped beam.
const STEPS: f64 = 20.0;
/// No exponential of such numbers is one.
const LARGEST: f64 = 1e100;
/// Steps in all.
const BOUND: u32 = 20_000;

impl BeamTheory {
    /// The lowest angular frequencies of a sheet of length and height, rad/s; fewer where some are
    /// not met within the search, none of sizes that are not positive numbers.
    pub fn frequencies(self, ends: Ends, size: [f64; 2], count: usize) -> Vec<f64> {
        let [length, height] = size;
        let step = 3.516 * height / 12.0_f64.sqrt() / length.powi(2) / STEPS;
        let condition = |omega: f64| self.condition(ends, size, omega);
        let mut found = Vec::new();
        let mut before = condition(step);
        for k in 2..BOUND {
            let omega = f64::from(k) * step;
            let here = condition(omega);
            if !here.is_finite() {
                break;
            }
            if before * here <= 0.0 {
                found.push(bisected(condition, omega - step, omega));
            }
            if found.len() == count {
                break;
            }
            before = here;
        }
        found
    }

    /// What is zero at a frequency.
    fn condition(self, ends: Ends, size: [f64; 2], omega: f64) -> f64 {
        let first = match ends {
            Ends::Clamped => 2,
            Ends::Free => 0,
        };
        self.transfer(size, omega).fixed_view::<2, 2>(2, first).determinant()
    }

    /// What becomes of (w, psi, M, Q) from one end to the other.
    fn transfer(self, [length, height]: [f64; 2], omega: f64) -> Matrix4<f64> {
        let (area, inertia) = (height, height.powi(3) / 12.0);
        let (shear, rotary) = match self {
            BeamTheory::EulerBernoulli => (0.0, 0.0),
            BeamTheory::Timoshenko => (2.0 * 6.0 / 5.0 / area, inertia),
        };
        let square = omega * omega;
        let mut rates = Matrix4::zeros();
        (rates[(0, 1)], rates[(0, 3)]) = (1.0, shear);
        rates[(1, 2)] = 1.0 / inertia;
        (rates[(2, 1)], rates[(2, 3)]) = (-rotary * square, -1.0);
        rates[(3, 0)] = -area * square;
        let exponent = rates * length;
        // The exponential of larger numbers would be squared for ever.
        if exponent.iter().all(|x| x.abs() < LARGEST) {
            exponent.exp()
        } else {
            Matrix4::repeat(f64::NAN)
        }
    }
}

/// The zero of a function between two places where it has different signs.
fn bisected(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low).signum();
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == sign {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slender_beams_have_the_roots_of_cosh_b_cos_b() {
        let size = [20.0, 0.3];
        for (ends, right) in [(Ends::Clamped, -1.0), (Ends::Free, 1.0)] {
            for omega in BeamTheory::EulerBernoulli.frequencies(ends, size, 4) {
                let b = (12.0_f64.sqrt() * omega / size[1]).sqrt() * size[0];
                assert!((b.cos() - right / b.cosh()).abs() < 1e-8, "{ends:?} {b}");
            }
        }
        let first = BeamTheory::EulerBernoulli.frequencies(Ends::Clamped, size, 1)[0];
        let b = (12.0_f64.sqrt() * first / size[1]).sqrt() * size[0];
        assert!((b - 1.875_104_068_711_961).abs() < 1e-9);
    }

    /// A beam on knife edges has w = M = 0 at both ends, and Timoshenko's equations a sine:
    /// `(EI k^2 + kGA - rho I om^2)(kGA k^2 - rho A om^2) = (kGA k)^2`.
    #[test]
    fn shear_and_rotary_inertia_lower_a_frequency_by_what_a_sine_says() {
        let size: [f64; 2] = [1.0, 0.1];
        let (area, inertia) = (size[1], size[1].powi(3) / 12.0);
        let k = std::f64::consts::PI / size[0];
        let stiffness = 5.0 / 12.0 * area;
        let excess = |omega: f64| {
            let square = omega * omega;
            let turning = inertia * k * k + stiffness - inertia * square;
            turning * (stiffness * k * k - area * square) - (stiffness * k).powi(2)
        };
        let sine = bisected(excess, 1e-3, 1.0);
        // From (0, psi, 0, Q) to (., ., ., .) with w = M = 0 again.
        let transfer = BeamTheory::Timoshenko.transfer(size, sine);
        let across = |row: usize, column: usize| transfer[(row, column)];
        let knives = across(0, 1) * across(2, 3) - across(0, 3) * across(2, 1);
        let scale = (across(0, 1) * across(2, 3)).abs() + (across(0, 3) * across(2, 1)).abs();
        assert!(knives.abs() < 1e-10 * scale, "{knives:e} of {scale:e}");
        let thin = (inertia / area).sqrt() * k * k;
        assert!(sine < thin && sine > 0.95 * thin);
    }

    #[test]
    fn sizes_that_are_no_lengths_have_no_frequencies_and_end() {
        for size in [[0.0, 1.0], [1.0, 0.0], [1e-200, 1.0], [1.0, 1e-200], [f64::NAN, 1.0]] {
            for theory in [BeamTheory::EulerBernoulli, BeamTheory::Timoshenko] {
                assert_eq!(theory.frequencies(Ends::Clamped, size, 2), Vec::<f64>::new());
            }
        }
    }

    #[test]
    fn the_theories_part_with_the_square_of_the_slenderness() {
        let gap = |height: f64| {
            let of = |theory: BeamTheory| theory.frequencies(Ends::Free, [1.0, height], 1)[0];
            1.0 - of(BeamTheory::Timoshenko) / of(BeamTheory::EulerBernoulli)
        };
        assert!(((gap(0.04) / gap(0.02)).log2() - 2.0).abs() < 0.1);
    }
}
