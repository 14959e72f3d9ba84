//! When a moving particle meets a moving triangle, or a moving edge another: "never" is a proof.
//!
//! ```text
//! F(t, u, v) = p - (a + u (b - a) + v (c - a)),      u, v >= 0,  u + v <= 1     particle, triangle
//! F(t, u, v) = a + u (b - a) - (c + v (d - c)),      0 <= u, v <= 1             edge, edge
//! ```
//! Every corner moves on a straight line, `a(t) = a0 + t (a1 - a0)`, `0 <= t <= 1` (metres). `F` is
//! linear in each of its arguments, so that its values over a box of them lie in the hull of its
//! values at the eight corners. If all eight lie beyond `thickness` on one side along some
//! direction, by more than rounding can account for, then nothing in the box comes that close: the
//! box is ruled out, in exact arithmetic. The directions tried are the three axes, the normal, the
//! way straight from an edge to the other thing, and the mean of `F`. What is not ruled out is halved along the
//! argument that changes `F` most, earliest first, until the values spread by less than the
//! tolerance; that is a hit. A close place that is known lets all but an instant of the other boxes
//! be tried at once.
//!
//! No hit: the distance exceeds `thickness` at all times. A hit: at [`Hit::time`] the distance is
//! at most `thickness + 3 tolerance`, and it exceeds `thickness` at all earlier times. Coplanar,
//! parallel and collapsed cases are cases like any other. Source: notes 11.1; Wang, Ferguson,
//! Schneider, Jiang, Attene and Panozzo 2021 (conservative inclusion) for the idea of the hull.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use crate::error::check_finite;
use crate::{Closeness, ContactError, Hit, Moving};

/// When a particle comes within the thickness of a triangle.
///
/// # Errors
/// [`ContactError::NonFinite`]; [`ContactError::Tolerance`] for a tolerance that is not finite or
/// not above 512 roundings of the largest coordinate, and for a thickness that is negative or not
/// finite.
pub fn particle_meets_triangle(
    particle: &Moving,
    triangle: &[Moving; 3],
    close: Closeness,
) -> Result<Option<Hit>, ContactError> {
    let [a, b, c] = *triangle;
    Query::new([*particle, a, b, c], Pair::ParticleTriangle, close)?.answer()
}

/// When an edge comes within the thickness of another.
///
/// # Errors
/// Those of [`particle_meets_triangle`].
pub fn edge_meets_edge(
    first: &[Moving; 2],
    second: &[Moving; 2],
    close: Closeness,
) -> Result<Option<Hit>, ContactError> {
    let ([a, b], [c, d]) = (*first, *second);
    Query::new([a, b, c, d], Pair::EdgeEdge, close)?.answer()
}

#[derive(Clone, Copy, PartialEq)]
enum Pair {
    ParticleTriangle,
    EdgeEdge,
}

struct Query {
    corners: [Moving; 4],
    pair: Pair,
    close: Closeness,
    /// What rounding can do to a component of F.
    rounding: f64,
    /// What it can do to F along a direction.
    projected: f64,
}

/// Lower and upper ends of t, u and v.
type Box3 = [[f64; 2]; 3];

/// Roundings of a component of F, in units of the largest coordinate: a sum of bounds gives 64.
const ROUNDINGS: f64 = 128.0 * f64::EPSILON;
/// The same for a product with a direction of length 1, of whose components the sizes add up to at
/// most 1.8.
const PROJECTED: f64 = 512.0 * f64::EPSILON;
/// Boxes after which the earliest that is left counts as a hit.
const BOXES: usize = 20_000;
/// No hit.
const NEVER: Hit = Hit { time: f64::INFINITY, place: [0.0; 2], boxes: 0, settled: true };

impl Query {
    fn new(corners: [Moving; 4], pair: Pair, close: Closeness) -> Result<Self, ContactError> {
        let mut largest = 0.0_f64;
        for corner in &corners {
            check_finite("a moving corner", corner.start.as_slice())?;
            check_finite("a moving corner", corner.end.as_slice())?;
            largest = largest.max(corner.start.amax()).max(corner.end.amax());
        }
        let rounding = ROUNDINGS * largest;
        close.check(4.0 * rounding)?;
        Ok(Query { corners, pair, close, rounding, projected: PROJECTED * largest })
    }

    fn answer(&self) -> Result<Option<Hit>, ContactError> {
        let hit = self.search();
        Ok((hit.time < f64::INFINITY).then_some(hit))
    }

    /// Where the corners are at a time.
    #[inline]
    fn places(&self, t: f64) -> [Vector3<f64>; 4] {
        let [a, b, c, d] = &self.corners;
        [a.at(t), b.at(t), c.at(t), d.at(t)]
    }

    #[inline]
    fn value(&self, t: f64, u: f64, v: f64) -> Vector3<f64> {
        let [a, b, c, d] = self.places(t);
        match self.pair {
            Pair::ParticleTriangle => a - (b + (c - b) * u + (d - b) * v),
            Pair::EdgeEdge => (a + (b - a) * u) - (c + (d - c) * v),
        }
    }

    /// Directions along which the two may be apart at a time: across both, and from one edge of
    /// each straight to the other thing. Of any length.
    fn directions(&self, t: f64) -> [Vector3<f64>; 4] {
        let [a, b, c, d] = self.places(t);
        let off = |r: Vector3<f64>, e: Vector3<f64>| r * e.norm_squared() - e * r.dot(&e);
        match self.pair {
            Pair::ParticleTriangle => {
                let normal = (c - b).cross(&(d - b));
                [normal, off(a - b, c - b), off(a - b, d - b), off(a - c, d - c)]
            }
            Pair::EdgeEdge => {
                let middle = 0.5 * (a + b - c - d);
                [(b - a).cross(&(d - c)), off(a - c, b - a), off(a - c, d - c), middle]
            }
        }
    }

    fn search(&self) -> Hit {
        let slack = self.close.tolerance / self.fastest();
        let mut left = BinaryHeap::from([Candidate { halvings: 0, of: [[0.0, 1.0]; 3] }]);
        // The earliest time at which they are known to be close, and when they may first be.
        let (mut known, mut first) = (NEVER, f64::INFINITY);
        let mut boxes = 0;
        while let Some(Candidate { halvings, of: mut this }) = left.pop() {
            let [[t, end], [u, _], [v, _]] = this;
            if t >= first {
                break;
            }
            if self.pair == Pair::ParticleTriangle && u + v > 1.0 {
                continue;
            }
            if boxes == BOXES {
                return Hit { time: t, boxes, settled: false, ..known };
            }
            boxes += 1;
            this[0][1] = end.min(known.time);
            let values = self.corner_values(&this);
            if self.ruled_out(&this, &values) {
                continue;
            }
            self.look_closely(&this, &mut known);
            first = first.min(known.time);
            let sliver = known.time - slack;
            if t >= sliver {
                first = first.min(t);
                continue;
            }
            if known.time <= this[0][1] {
                let before = with(&this, 0, [t, sliver]);
                if self.ruled_out(&before, &self.corner_values(&before)) {
                    first = first.min(sliver);
                    continue;
                }
            }
            let (argument, spread) = widest(&values);
            if spread <= self.close.tolerance {
                known = Hit { time: t, place: [u, v], ..known };
                first = first.min(t);
                continue;
            }
            let [low, high] = this[argument];
            let middle = 0.5 * (low + high);
            for side in [[low, middle], [middle, high]] {
                let of = with(&this, argument, side);
                left.push(Candidate { halvings: halvings + 1, of });
            }
        }
        Hit { time: first, boxes, ..known }
    }

    /// Notes when the places that are nearest at the ends of a box's time are first close enough.
    fn look_closely(&self, of: &Box3, known: &mut Hit) {
        let near = self.close.thickness + self.close.tolerance;
        let aim = self.close.thickness + 0.5 * self.close.tolerance;
        for t in of[0] {
            let [u, v] = self.nearest_place(t);
            let (start, end) = (self.value(of[0][0], u, v), self.value(of[0][1], u, v));
            let Some(part) = first_within(&start, &end, aim) else { continue };
            let time = of[0][0] + part * (of[0][1] - of[0][0]);
            if time < known.time && self.value(time, u, v).norm() <= near {
                *known = Hit { time, place: [u, v], ..*known };
            }
        }
    }

    /// About the nearest place at a time: the least distance in u and v by turns, from the one
    /// without bounds.
    fn nearest_place(&self, t: f64) -> [f64; 2] {
        let f = self.value(t, 0.0, 0.0);
        let [a, b] = [self.value(t, 1.0, 0.0) - f, self.value(t, 0.0, 1.0) - f];
        let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
        let (fa, fb) = (f.dot(&a), f.dot(&b));
        let finite = |x: f64, bound: f64| if x.is_finite() { x.clamp(0.0, bound) } else { 0.0 };
        let mut v = finite((fa * ab - fb * aa) / (aa * bb - ab * ab), 1.0);
        let mut u = 0.0;
        for _ in 0..3 {
            let room = |other: f64| match self.pair {
                Pair::ParticleTriangle => 1.0 - other,
                Pair::EdgeEdge => 1.0,
            };
            u = finite(-(fa + v * ab) / aa, room(v));
            v = finite(-(fb + u * ab) / bb, room(u));
        }
        [u, v]
    }

    /// A bound on the relative speed of any two places.
    fn fastest(&self) -> f64 {
        let speeds = self.corners.map(|corner| (corner.end - corner.start).norm());
        let ends = match self.pair {
            Pair::ParticleTriangle => [speeds[0], speeds[1].max(speeds[2]).max(speeds[3])],
            Pair::EdgeEdge => [speeds[0].max(speeds[1]), speeds[2].max(speeds[3])],
        };
        ends[0] + ends[1]
    }

    /// F at the corners of a box; bit k of the index chooses the end of argument k.
    fn corner_values(&self, of: &Box3) -> [Vector3<f64>; 8] {
        let mut values = [Vector3::zeros(); 8];
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.value(of[0][i & 1], of[1][i >> 1 & 1], of[2][i >> 2]);
        }
        values
    }

    /// Whether the values are all beyond the thickness on one side of some plane.
    fn ruled_out(&self, of: &Box3, values: &[Vector3<f64>; 8]) -> bool {
        let beyond = self.close.thickness + self.rounding;
        for k in 0..3 {
            if values.iter().all(|f| f[k] > beyond) || values.iter().all(|f| f[k] < -beyond) {
                return true;
            }
        }
        let beyond = self.close.thickness * (1.0 + 8.0 * f64::EPSILON) + self.projected;
        // Two corners may be farther apart than the thickness along none of the others.
        let mean = values.iter().sum::<Vector3<f64>>() * 0.125;
        for direction in self.directions(0.5 * (of[0][0] + of[0][1])).into_iter().chain([mean]) {
            let length = direction.norm();
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            let mut along = [0.0; 8];
            for (along, f) in along.iter_mut().zip(values) {
                *along = direction.dot(f) / length;
            }
            if along.iter().all(|&x| x > beyond) || along.iter().all(|&x| x < -beyond) {
                return true;
            }
        }
        false
    }
}

/// A box that may hold a meeting: the earliest first, of equals the smallest.
struct Candidate {
    halvings: u32,
    of: Box3,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let later = |a: &Self, b: &Self| a.of[0][0].total_cmp(&b.of[0][0]);
        later(other, self).then(self.halvings.cmp(&other.halvings))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// The first part of the way from one point to another at which a distance from the origin is met.
fn first_within(start: &Vector3<f64>, end: &Vector3<f64>, distance: f64) -> Option<f64> {
    let excess = start.norm_squared() - distance * distance;
    if excess <= 0.0 {
        return Some(0.0);
    }
    let way = end - start;
    let (a, b) = (way.norm_squared(), -start.dot(&way));
    let root = (b * b - a * excess).sqrt();
    // A root that is not real is not a number, and compares as false.
    let part = excess / (b + root);
    (b > 0.0 && part <= 1.0).then_some(part)
}

/// A box with one of its sides replaced.
fn with(of: &Box3, argument: usize, side: [f64; 2]) -> Box3 {
    let mut changed = *of;
    changed[argument] = side;
    changed
}

/// The argument along which the values change most, and by how much they spread altogether.
fn widest(values: &[Vector3<f64>; 8]) -> (usize, f64) {
    let mut widest = (0, -1.0);
    for k in 0..3 {
        let pairs = (0..8).filter(|i| i >> k & 1 == 0).map(|i| (i, i | 1 << k));
        let change = pairs.map(|(i, j)| (values[j] - values[i]).amax()).fold(0.0, f64::max);
        if change > widest.1 {
            widest = (k, change);
        }
    }
    let spread = |k: usize| {
        let (low, high) = values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), f| (l.min(f[k]), h.max(f[k])));
        high - low
    };
    (widest.0, (0..3).map(spread).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOSE: Closeness = Closeness { thickness: 0.0, tolerance: 1e-9 };

    fn still(x: f64, y: f64, z: f64) -> Moving {
        let place = Vector3::new(x, y, z);
        Moving { start: place, end: place }
    }

    fn floor() -> [Moving; 3] {
        [still(-1.0, -1.0, 0.0), still(2.0, -1.0, 0.0), still(-1.0, 2.0, 0.0)]
    }

    fn falling(x: f64, from: f64, to: f64) -> Moving {
        Moving { start: Vector3::new(x, 0.1, from), end: Vector3::new(x, 0.1, to) }
    }

    #[test]
    fn the_time_is_just_before_the_true_one() {
        for from in [1e-3, 0.3, 1.0, 1e2] {
            let hit = particle_meets_triangle(&falling(0.1, from, -1.0), &floor(), CLOSE);
            let time = hit.unwrap().unwrap().time;
            let truth = from / (from + 1.0);
            assert!(time <= truth && truth - time < 3e-9 / (from + 1.0) + 1e-15, "{from}: {time}");
        }
    }

    #[test]
    fn what_passes_beside_or_stops_short_never_meets() {
        for particle in [falling(1.5, 1.0, -1.0), falling(0.1, 1.0, 1e-12), falling(0.1, 1.0, 2.0)]
        {
            assert_eq!(particle_meets_triangle(&particle, &floor(), CLOSE).unwrap(), None);
        }
    }

    #[test]
    fn a_thickness_is_met_earlier_by_just_that_much() {
        let close = Closeness { thickness: 0.25, ..CLOSE };
        let hit = particle_meets_triangle(&falling(0.1, 1.0, -1.0), &floor(), close);
        let time = hit.unwrap().unwrap().time;
        assert!(time <= 0.375 && time > 0.375 - 1e-8, "{time}");
    }

    #[test]
    fn what_passes_a_slope_a_little_farther_off_than_the_thickness_never_meets() {
        let close = Closeness { thickness: 0.25, ..CLOSE };
        // The plane x + y + z = 0, which no axis looks along.
        let slope = [still(4.0, -4.0, 0.0), still(0.0, 4.0, -4.0), still(-4.0, 0.0, 4.0)];
        let passing = |height: f64| {
            let (normal, way) =
                (Vector3::repeat(3.0_f64.sqrt().recip()), Vector3::x() - Vector3::y());
            Moving { start: normal * height - way, end: normal * height + way }
        };
        let meets = |height| particle_meets_triangle(&passing(height), &slope, close).unwrap();
        assert_eq!(meets(0.2501), None);
        assert!(meets(0.2499).is_some_and(|hit| hit.settled && hit.time == 0.0));
    }

    #[test]
    fn parallel_edges_meet_where_they_overlap_and_not_where_they_end() {
        let resting = [still(0.0, 0.0, 0.0), still(1.0, 1.0, 1.0)];
        let dropped = |along: f64| {
            let (up, down) = (Vector3::new(1.0, 0.0, -1.0), Vector3::new(-1.0, 0.0, 1.0));
            let from = Vector3::repeat(along);
            let to = from + Vector3::repeat(1.0);
            [from, to].map(|x| Moving { start: x + up, end: x + down })
        };
        let hit = edge_meets_edge(&resting, &dropped(0.5), CLOSE).unwrap().unwrap();
        assert!(hit.time <= 0.5 && hit.time > 0.5 - 1e-8, "{hit:?}");
        assert_eq!(edge_meets_edge(&resting, &dropped(1.01), CLOSE).unwrap(), None);
    }

    #[test]
    fn tolerances_below_rounding_and_numbers_that_are_not_finite_are_refused() {
        let far = [still(1e9, 0.0, 0.0), still(1e9, 1.0, 0.0)];
        let refused = edge_meets_edge(&far, &far, CLOSE).unwrap_err();
        assert_eq!(refused, ContactError::Tolerance(1e-9));
        let nan = [still(f64::NAN, 0.0, 0.0), still(0.0, 1.0, 0.0)];
        assert!(matches!(edge_meets_edge(&nan, &far, CLOSE), Err(ContactError::NonFinite { .. })));
        let thick = Closeness { thickness: -1.0, tolerance: 1.0 };
        let error = edge_meets_edge(&far, &far, thick).unwrap_err();
        assert_eq!(error, ContactError::Thickness(-1.0));
    }
}
