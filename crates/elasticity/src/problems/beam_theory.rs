//! Frequencies of a slender sheet by the two theories of beams.
//!
//! ```text
//! w' = psi + Q/(k G A)     psi' = M/(E I)     M' = -Q - rho I om^2 psi     Q' = -rho A om^2 w
//! y(l) = exp(l B) y(0),  y = (w, psi, Q, M)          over a piece of length l
//! clamped  w = psi = 0 at 0, M = Q = 0 at L       free  M = Q = 0 at both ends
//! ```
//! `w` deflection (m), `psi` the turn of the cross-section, `M Q` moment and shear force, `om` angular
//! frequency (rad/s); thickness, density and E are 1, nu is 0: `A = h`, `I = h^3/12`, `G = 1/2`, `k =
//! 5/6`. Without shear and rotary inertia this is Euler and Bernoulli's beam, `cosh b cos b = -1` or `1`
//! for `b^4 = rho A om^2 L^4/(E I)`; with them Timoshenko's, whose error against the sheet is of a higher
//! power of h/L.
//!
//! The beam is cut into pieces so short that none vibrates by itself, its ends clamped, as slowly as
//! `om`. Then as many frequencies are below `om` as the dynamic stiffness of the cuts has negative
//! eigenvalues: counted, so that none is lost, and without exponentials that cancel. Source: Timoshenko
//! (1921); Cowper (1966) for k at nu = 0; Wittrick and Williams (1971) for the count.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Matrix4};

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

/// The first piece, of the others' length: by the golden section, so that no end of a piece is where a shorter
/// beam of the same frequency would end.
const FIRST: f64 = 0.618_033_988_749_894_9;
/// A beam is cut into no more pieces: some three hundred frequencies.
const PIECES: f64 = 1000.0;
/// No exponent of a piece has such entries.
const LARGEST: f64 = 1e6;
/// Terms of a power series: `1/2^TERMS / TERMS!` is far below rounding.
const TERMS: u32 = 18;
/// Doublings of the frequency that a search may take, and halvings: down to the last digit.
const DOUBLINGS: u32 = 200;
const HALVINGS: u32 = 120;

impl BeamTheory {
    /// The lowest angular frequencies of a sheet of length and height, rad/s, but for those that are zero;
    /// fewer where the beam would have to be cut into more than a thousand pieces, none of sizes that are
    /// not positive numbers or whose ratio's square is not.
    pub fn frequencies(self, ends: Ends, size: [f64; 2], count: usize) -> Vec<f64> {
        let [length, height] = size;
        let ratio = height / length;
        let is_normal = |x: f64| x.is_normal() && x > 0.0;
        if !(is_normal(length) && is_normal(height) && is_normal(ratio * ratio)) {
            return Vec::new();
        }
        // Of a beam of length 1; the speed of waves along it is 1.
        let mut low = 0.0;
        let frequencies = (0..count).map_while(|mode| {
            let omega = self.frequency(ends, ratio, mode, low)?;
            low = omega;
            let omega = omega / length;
            is_normal(omega).then_some(omega)
        });
        frequencies.collect()
    }

    /// The frequency of a mode, from 0, that is not below `low`: where the count reaches it.
    fn frequency(self, ends: Ends, ratio: f64, mode: usize, mut low: f64) -> Option<f64> {
        let above = |omega: f64| Some(self.below(ends, ratio, omega)? > mode);
        let mut high = if low > 0.0 { 2.0 * low } else { ratio.min(1.0) };
        for _ in 0..DOUBLINGS {
            if above(high)? {
                break;
            }
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if above(middle)? { high = middle } else { low = middle }
        }
        Some(high)
    }

    /// How many frequencies other than zero are below this one; `None` where that takes too many pieces.
    fn below(self, ends: Ends, ratio: f64, omega: f64) -> Option<usize> {
        let pieces = (1.0 / self.longest_piece(ratio, omega) - FIRST).ceil().max(2.0);
        if pieces.is_nan() || pieces > PIECES {
            return None;
        }
        let length = 1.0 / (pieces + FIRST);
        let first = self.stiffness(ratio, FIRST * length, [length, omega])?;
        let piece = self.stiffness(ratio, length, [length, omega])?;
        let right = pieces as usize / 2;
        let left =
            std::iter::once(&first).chain(std::iter::repeat_n(&piece, pieces as usize - right));
        // From both ends to the middle: a beam whose other end is clamped has all but the same frequencies.
        let (one, before) = eliminated(left, 0, ends == Ends::Free);
        let (other, after) = eliminated(std::iter::repeat_n(&piece, right), 1, true);
        let negative = one + other + negatives(&(before + after));
        let rigid = if ends == Ends::Free { 2 } else { 0 };
        Some(usize::saturating_sub(negative, rigid))
    }

    /// No clamped piece of this length or less has a frequency as low as omega.
    ///
    /// ```text
    /// |w| <= l/pi |w'|,  |w'| <= |gamma| + |psi|,  |psi| <= l/pi |psi'|,    gamma = w' - psi
    /// om^2 int A w^2 + I psi^2  <  int k G A gamma^2 + E I psi'^2     for the s = (l/pi)^2 below
    /// ```
    fn longest_piece(self, ratio: f64, omega: f64) -> f64 {
        let bending = ratio / omega / 48.0_f64.sqrt();
        let square = match self {
            BeamTheory::EulerBernoulli => bending,
            BeamTheory::Timoshenko => bending.min(5.0 / 24.0 / omega / omega),
        };
        PI * (0.9 * square).sqrt()
    }

    /// The dynamic stiffness of a piece of a length, in the units of one of length `unit`; `None` where it
    /// leaves the range of numbers.
    fn stiffness(self, ratio: f64, length: f64, [unit, omega]: [f64; 2]) -> Option<Piece> {
        let transfer = self.transfer(ratio, length, [unit, omega])?;
        let block =
            |row, column| -> Matrix2<f64> { transfer.fixed_view::<2, 2>(row, column).into() };
        let flexibility = block(0, 2).try_inverse()?;
        let ends = [flexibility * block(0, 0), block(2, 2) * flexibility];
        let is_finite = ends.iter().flatten().all(|entry| entry.is_finite());
        is_finite.then(|| Piece {
            ends: ends.map(|end| 0.5 * (end + end.transpose())),
            across: -flexibility,
        })
    }

    /// What becomes of (w, psi, Q, M) from one end of a piece to the other. In units in which the entries of
    /// the exponent are moderate, however short, thick or slender the piece: w in b l, Q in E I/(b l^2) and M
    /// in E I/l, `b^2 = 1 + E I/(k G A l^2)`.
    fn transfer(self, ratio: f64, length: f64, [unit, omega]: [f64; 2]) -> Option<Matrix4<f64>> {
        let (slender, turn) = ((ratio / unit).powi(2), omega * unit);
        let (shear, rotary) = match self {
            BeamTheory::EulerBernoulli => (0.0, 0.0),
            BeamTheory::Timoshenko => (0.2 * slender, turn * turn),
        };
        let b = (1.0 + shear).sqrt();
        let mut rates = Matrix4::zeros();
        (rates[(0, 1)], rates[(0, 2)]) = (1.0 / b, shear / (b * b));
        rates[(1, 3)] = 1.0;
        rates[(2, 0)] = -12.0 * (turn * b * (unit / ratio)).powi(2);
        (rates[(3, 1)], rates[(3, 2)]) = (-rotary, -1.0 / b);
        let exponent = rates * (length / unit);
        exponent.iter().all(|x| x.abs() < LARGEST).then(|| exponential(&exponent))
    }
}

/// The exponential of a matrix: a power series to rounding, of a part of it that is then squared.
fn exponential(exponent: &Matrix4<f64>) -> Matrix4<f64> {
    let halvings = (exponent.norm().log2() + 1.0).ceil().max(0.0);
    let part = exponent * 0.5_f64.powi(halvings as i32);
    let mut term = Matrix4::identity();
    let mut sum = term;
    for k in 1..TERMS {
        term = term * part / f64::from(k);
        sum += term;
    }
    (0..halvings as u32).fold(sum, |power, _| power * power)
}

/// The dynamic stiffness of a piece: of each end by itself, and of the second's turn on the first's forces.
struct Piece {
    ends: [Matrix2<f64>; 2],
    across: Matrix2<f64>,
}

/// What pieces in a row make of the stiffness of the cut at their end, and how many negative eigenvalues the
/// stiffness of the cuts before it has. They begin with the beam's end, which is each one's own end `near`.
fn eliminated<'a>(
    pieces: impl Iterator<Item = &'a Piece>,
    near: usize,
    is_free: bool,
) -> (usize, Matrix2<f64>) {
    let mut negative = 0;
    let mut before = is_free.then(Matrix2::zeros);
    for piece in pieces {
        let mut end = piece.ends[1 - near];
        if let Some(before) = before {
            let cut = before + piece.ends[near];
            let across = if near == 0 { piece.across } else { piece.across.transpose() };
            negative += negatives(&cut);
            end -= across.transpose() * inverse(&cut) * across;
        }
        before = Some(end);
    }
    (negative, before.unwrap_or_else(Matrix2::zeros))
}

/// How many eigenvalues of a symmetric matrix are negative.
fn negatives(matrix: &Matrix2<f64>) -> usize {
    let determinant = matrix.determinant();
    if determinant < 0.0 {
        1
    } else if matrix.trace() < 0.0 {
        2
    } else {
        0
    }
}

/// The inverse of a symmetric matrix; of one that has none that of a neighbour.
fn inverse(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    let determinant = matrix.determinant();
    let least = f64::EPSILON.powi(2) * matrix.norm_squared();
    let determinant = if determinant.abs() < least { least } else { determinant };
    let [a, b, d] = [matrix[(0, 0)], matrix[(0, 1)], matrix[(1, 1)]];
    Matrix2::new(d, -b, -b, a) / determinant
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn slender_beams_have_the_roots_of_cosh_b_cos_b_and_none_besides() {
        let size = [20.0, 0.3];
        for (ends, right) in [(Ends::Clamped, -1.0), (Ends::Free, 1.0)] {
            let found = BeamTheory::EulerBernoulli.frequencies(ends, size, 60);
            assert_eq!(found.len(), 60);
            for (mode, omega) in found.into_iter().enumerate() {
                let b = (12.0_f64.sqrt() * omega / size[1]).sqrt() * size[0];
                // One root to every half wave, from 0 or from one and a half.
                let first = if ends == Ends::Free { PI } else { 0.0 };
                let low = first + mode as f64 * PI;
                let exact = bisected(|b| b.cos() - right / b.cosh(), low + 0.5, low + PI);
                assert!((b / exact - 1.0).abs() < 1e-11, "{ends:?} {mode}: {b} {exact}");
            }
        }
    }

    #[test]
    fn of_a_thick_beam_no_pair_of_frequencies_is_lost() {
        // A hundred times as high as long it shears and turns all but by itself, in waves of either kind.
        let found = BeamTheory::Timoshenko.frequencies(Ends::Clamped, [0.01, 1.0], 8);
        let waves = (0..8).map(|k| (f64::from(k) + 0.5) * PI / 0.01);
        let mut right: Vec<f64> = waves.flat_map(|k| [k, k * (5.0_f64 / 12.0).sqrt()]).collect();
        right.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 8);
        for (omega, right) in found.iter().zip(&right) {
            assert!((omega / right - 1.0).abs() < 1e-3, "{found:?} {right}");
        }
    }

    #[test]
    fn as_many_frequencies_come_as_pieces_allow() {
        for theory in [BeamTheory::EulerBernoulli, BeamTheory::Timoshenko] {
            for height in [1e-6, 0.01, 1.0, 1e6] {
                let all = theory.frequencies(Ends::Clamped, [1.0, height], usize::MAX);
                assert!((100..2000).contains(&all.len()), "{theory:?} {height}: {}", all.len());
                assert!(all.is_sorted(), "{theory:?} {height}");
            }
        }
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
        // From (0, psi, Q, 0) to (., ., ., .) with w = M = 0 again.
        let transfer = BeamTheory::Timoshenko.transfer(size[1], 1.0, [1.0, sine]).unwrap();
        let across = |row: usize, column: usize| transfer[(row, column)];
        let knives = across(0, 1) * across(3, 2) - across(0, 2) * across(3, 1);
        let scale = (across(0, 1) * across(3, 2)).abs() + (across(0, 2) * across(3, 1)).abs();
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
