//! Exact separations of hulls whose corners are fractions of two: whole numbers of any length.
//!
//! ```text
//! x = t + R(q) c,    q.q R(q) of whole numbers           both hulls times q1.q1 q2.q2 and a power of two
//! s(n) |s(n)|/n.n                                        the sign and square of what a direction makes
//! ```

use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

use super::hulls::{Line, Way};

type Whole = [BigInt; 3];

/// Two hulls, in a unit of their own.
pub(super) struct ExactHulls {
    corners: [Vec<Whole>; 2],
    /// What a metre is: this fraction.
    unit: (BigInt, BigInt),
}

/// A hull's corners in its own axes, its place and its turn.
pub(super) struct Place<'a> {
    pub(super) corners: &'a [[f64; 3]],
    pub(super) translation: [f64; 3],
    pub(super) quaternion: [f64; 4],
}

/// A double as a whole number times a power of two.
fn split(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent.max(1) - 1075)
}

/// The least power of two in some numbers, and how they are whole times it.
fn whole(numbers: &[f64]) -> (Vec<BigInt>, i32) {
    let parts = numbers.iter().map(|&x| {
        let (mantissa, power) = split(x);
        let even = if mantissa == 0 { 0 } else { mantissa.trailing_zeros() };
        (mantissa >> even, power + even as i32)
    });
    let parts: Vec<(i64, i32)> = parts.collect();
    let used = parts.iter().filter(|(mantissa, _)| *mantissa != 0);
    let least = used.map(|(_, power)| *power).min().unwrap_or(0);
    let shifted = |&(mantissa, power): &(i64, i32)| match mantissa {
        0 => BigInt::zero(),
        _ => BigInt::from(mantissa) << (power - least),
    };
    (parts.iter().map(shifted).collect(), least)
}

fn dot(a: &Whole, b: &Whole) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Whole, b: &Whole) -> Whole {
    let at = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [at(1, 2), at(2, 0), at(0, 1)]
}

fn minus(a: &Whole, b: &Whole) -> Whole {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

impl ExactHulls {
    pub(super) fn new(places: [Place<'_>; 2]) -> Self {
        // Lengths share one power of two; turns have no unit.
        let all = places.iter().flat_map(|place| {
            place.translation.into_iter().chain(place.corners.iter().copied().flatten())
        });
        let all: Vec<f64> = all.collect();
        let (lengths, power) = whole(&all);
        let turns = places.each_ref().map(|place| turn(place.quaternion));
        let mut rest = lengths.chunks_exact(3).map(|v| [v[0].clone(), v[1].clone(), v[2].clone()]);
        let corners = [0, 1].map(|k| {
            let (square, rows) = &turns[k];
            let (other, _) = &turns[1 - k];
            let mut next = || rest.next().unwrap_or_default();
            let middle = next();
            let own: Vec<Whole> = places[k].corners.iter().map(|_| next()).collect();
            let there =
                |c: &Whole| [0, 1, 2].map(|i| (&middle[i] * square + dot(&rows[i], c)) * other);
            own.iter().map(there).collect()
        });
        let one = &turns[0].0 * &turns[1].0;
        let unit = match power {
            0.. => (one, BigInt::from(1) << power),
            _ => (one << -power, BigInt::from(1)),
        };
        ExactHulls { corners, unit }
    }

    fn vector(&self, way: Way) -> Whole {
        let along =
            |(k, [from, to]): (usize, Line)| minus(&self.corners[k][to], &self.corners[k][from]);
        let between = |[i, j]: [usize; 2]| minus(&self.corners[1][j], &self.corners[0][i]);
        match way {
            Way::Cross([e, f], turned) => {
                let n = cross(&along(e), &along(f));
                if turned { n.map(|x| -x) } else { n }
            }
            Way::Side(line, turned) => {
                let [x, y, _] = along(line);
                let n = [y, -x, BigInt::zero()];
                if turned { n.map(|x| -x) } else { n }
            }
            Way::Across(ends, line) => {
                let (e, w) = (along(line), between(ends));
                cross(&cross(&e, &w), &e)
            }
            Way::Between(ends) => between(ends),
        }
    }

    /// What a way makes of the separation, m: its sign is exact, its size rounded once. None where it is no
    /// direction.
    pub(super) fn separation(&self, way: Way) -> Option<f64> {
        let n = self.vector(way);
        let square = dot(&n, &n);
        if square.is_zero() {
            return None;
        }
        let [a, b] = &self.corners;
        let high = a.iter().map(|c| dot(c, &n)).max()?;
        let low = b.iter().map(|c| dot(c, &n)).min()?;
        let apart = low - high;
        let (metre, parts) = &self.unit;
        let length = quotient(&(&apart * &apart * parts * parts), &(square * metre * metre)).sqrt();
        Some(if apart.is_negative() { -length } else { length })
    }
}

/// The square of a quaternion, and the rows of its rotation times it.
fn turn(quaternion: [f64; 4]) -> (BigInt, [Whole; 3]) {
    let (q, _) = whole(&quaternion);
    let at = |i: usize, j: usize| &q[i] * &q[j];
    let square = at(0, 0) + at(1, 1) + at(2, 2) + at(3, 3);
    let rows = [
        [&square - (at(2, 2) + at(3, 3)) * 2, (at(1, 2) - at(0, 3)) * 2, (at(1, 3) + at(0, 2)) * 2],
        [(at(1, 2) + at(0, 3)) * 2, &square - (at(1, 1) + at(3, 3)) * 2, (at(2, 3) - at(0, 1)) * 2],
        [(at(1, 3) - at(0, 2)) * 2, (at(2, 3) + at(0, 1)) * 2, &square - (at(1, 1) + at(2, 2)) * 2],
    ];
    (square, rows)
}

/// A fraction as a double.
fn quotient(top: &BigInt, bottom: &BigInt) -> f64 {
    let shift = 120 + bottom.bits() as i64 - top.bits() as i64;
    let whole = if shift >= 0 { (top << shift) / bottom } else { top / (bottom << -shift) };
    let digits = whole.to_f64().unwrap_or(f64::NAN);
    // In two halves: neither leaves the range of numbers where the whole does not.
    let half = (shift / 2) as i32;
    digits * 2.0_f64.powi(-half) * 2.0_f64.powi(half - shift as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_a_rounding_apart_are_told_from_those_that_overlap_by_it() {
        let corners: Vec<[f64; 3]> =
            (0..8).map(|k| [0, 1, 2].map(|c| if k >> c & 1 == 0 { 0.5 } else { -0.5 })).collect();
        let gap = |off: f64| {
            let place = |x: f64| Place {
                corners: &corners,
                translation: [x, 0.0, off],
                quaternion: [0.6, 0.8, 0.0, 0.0],
            };
            let hulls = ExactHulls::new([place(0.0), place(1.0 + off)]);
            let x = [(0, [0, 2]), (0, [0, 4])];
            hulls.separation(Way::Cross(x, false)).unwrap()
        };
        assert_eq!(gap(f64::EPSILON), f64::EPSILON);
        assert_eq!(gap(0.0), 0.0);
        assert_eq!(gap(-f64::EPSILON / 2.0), -f64::EPSILON / 2.0);
    }
}
