//! Inequalities: functions of the configuration that must not become negative.
//!
//! ```text
//! g_i(q) >= 0                          feasible; dg_i is not zero where g_i is              (11.2)
//! floor       g = n.x - offset - r
//! two balls   g = |x2 - x1| - (r1 + r2)                            (errata 11.2: the sum of radii)
//! fixed ball  g = |x - centre| - (r + radius)
//! ```
//! The shape is that of an equality, the type is not: [`Inequality`] reads a constraint's functions
//! as gaps. `x` centres in D dimensions, `r` radii, `n` unit normals, lengths in metres.

use stationary_calculus::{Sink, SizeError, Vector, array};
use stationary_constraints::{Constraint, Rows, check_multipliers, check_read, check_values};

use crate::error::check_finite;
use crate::{ContactError, ContactRows};

/// A constraint's functions read as gaps that must not be negative.
#[derive(Clone, Debug)]
pub struct Inequality<K>(pub K);

/// Gaps that know how small they become on a straight path.
pub trait Swept: Constraint {
    /// Writes the smallest value of each gap while q moves straight by a displacement.
    fn lowest(&self, q: &[f64], displacement: Vector<&[f64]>, lowest: &mut [f64]);

    /// Writes the length that each gap is a difference of, m, where each freedom is at most `reach` from zero:
    /// its rounding is relative to that.
    fn sizes(&self, reach: &[f64], sizes: &mut [f64]);
}

/// Collects rows that come entry by entry.
struct Collect<'a> {
    rows: &'a mut ContactRows,
    wanted: &'a [usize],
    row: Option<usize>,
    entries: Vec<(usize, f64)>,
}

impl Collect<'_> {
    fn finish_row(&mut self) {
        if let Some(row) = self.row.take()
            && self.wanted.contains(&row)
        {
            self.rows.push(self.entries.iter().copied());
        }
        self.entries.clear();
    }
}

impl Rows for Collect<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        if self.row != Some(row) {
            self.finish_row();
            self.row = Some(row);
        }
        self.entries.push((freedom, value));
    }
}

impl<K: Constraint> Inequality<K> {
    /// The gaps at a configuration.
    pub fn gaps(&self, t: f64, q: &[f64]) -> Vec<f64> {
        let mut gaps = vec![0.0; self.0.count()];
        // Of too few numbers no gap is one.
        if self.0.value(t, q, &mut gaps).is_err() {
            gaps.fill(f64::NAN);
        }
        gaps
    }

    /// The differentials of some of the gaps, in ascending order.
    pub fn rows(&self, t: f64, q: &[f64], wanted: &[usize]) -> ContactRows {
        let mut rows = ContactRows::new();
        let mut collect = Collect { rows: &mut rows, wanted, row: None, entries: Vec::new() };
        match self.0.differential(t, q, &mut collect) {
            Ok(()) => collect.finish_row(),
            Err(_) => return ContactRows::new(),
        }
        rows
    }
}

impl<K: Swept> Inequality<K> {
    /// The smallest value of each gap while q moves straight by a displacement.
    pub fn lowest(&self, q: &[f64], displacement: Vector<&[f64]>) -> Vec<f64> {
        let mut lowest = vec![0.0; self.0.count()];
        self.0.lowest(q, displacement, &mut lowest);
        lowest
    }

    /// The length that each gap is a difference of, m, at any of these configurations.
    pub(crate) fn sizes(&self, places: &[&[f64]]) -> Vec<f64> {
        let mut reach = vec![0.0_f64; self.0.dim()];
        for place in places {
            reach.iter_mut().zip(*place).for_each(|(far, x)| *far = far.max(x.abs()));
        }
        let mut sizes = vec![0.0; self.0.count()];
        self.0.sizes(&reach, &mut sizes);
        sizes
    }
}

/// A fixed wall: the half-space `n.x >= offset` is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall<const D: usize> {
    /// Points into the free side, of length 1.
    pub normal: [f64; D],
    /// How far the wall is from the origin along it, m.
    pub offset: f64,
}

/// A ball that nothing moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedBall<const D: usize> {
    /// Where it is, m.
    pub centre: [f64; D],
    /// Its radius, m.
    pub radius: f64,
}

/// Balls that overlap neither walls, fixed balls nor each other. A ball of radius zero is a point;
/// points do not meet each other. Where two centres are one place, the normal is the first axis, and gaps do
/// not bend there.
#[derive(Clone, Debug, PartialEq)]
pub struct Balls<const D: usize> {
    radii: Vec<f64>,
    walls: Vec<Wall<D>>,
    fixed: Vec<FixedBall<D>>,
    pairs: Vec<[usize; 2]>,
}

fn check_radius(value: f64) -> Result<(), ContactError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ContactError::Length { shape: "ball", what: "radius", value })
}

impl<const D: usize> Balls<D> {
    /// Balls of these radii among these walls; all pairs of them are gaps.
    ///
    /// # Errors
    /// [`ContactError::Length`] for a radius that is negative or not finite, and for a normal whose
    /// length is not 1; [`ContactError::NonFinite`] for a wall that is not finite.
    pub fn new(radii: Vec<f64>, walls: Vec<Wall<D>>) -> Result<Self, ContactError> {
        radii.iter().try_for_each(|&radius| check_radius(radius))?;
        for wall in &walls {
            check_finite("a wall", &wall.normal)?;
            check_finite("a wall", &[wall.offset])?;
            let length = wall.normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            if (length - 1.0).abs() > 1e-9 {
                let (shape, what) = ("wall", "normal");
                return Err(ContactError::Length { shape, what, value: length });
            }
        }
        let round: Vec<usize> = (0..radii.len()).filter(|&ball| radii[ball] > 0.0).collect();
        let pairs = round.iter().flat_map(|&a| {
            let point_or_later = |&b: &usize| radii[b] == 0.0 || b > a;
            let others: Vec<usize> = (0..radii.len()).filter(point_or_later).collect();
            others.into_iter().map(move |b| [a.min(b), a.max(b)])
        });
        let pairs = pairs.collect();
        Ok(Balls { radii, walls, fixed: Vec::new(), pairs })
    }

    /// The same balls among fixed balls as well.
    ///
    /// # Errors
    /// [`ContactError::Length`] for a radius that is negative or not finite;
    /// [`ContactError::NonFinite`] for a centre that is not finite.
    pub fn with_fixed(self, fixed: Vec<FixedBall<D>>) -> Result<Self, ContactError> {
        for ball in &fixed {
            check_radius(ball.radius)?;
            check_finite("the centre of a fixed ball", &ball.centre)?;
        }
        Ok(Balls { fixed, ..self })
    }

    fn against_walls(&self) -> impl Iterator<Item = (usize, &Wall<D>)> {
        (0..self.radii.len()).flat_map(|ball| self.walls.iter().map(move |wall| (ball, wall)))
    }

    fn against_fixed(&self) -> impl Iterator<Item = (usize, &FixedBall<D>)> {
        (0..self.radii.len()).flat_map(|ball| self.fixed.iter().map(move |fixed| (ball, fixed)))
    }

    /// From the centre of a fixed ball, and how far.
    fn away_from_fixed(&self, q: &[f64], ball: usize, fixed: &FixedBall<D>) -> ([f64; D], f64) {
        let d: [f64; D] = array(|k| q[D * ball + k] - fixed.centre[k]);
        (d, norm(&d))
    }

    fn apart(&self, q: &[f64], [a, b]: [usize; 2]) -> ([f64; D], f64) {
        let d: [f64; D] = array(|k| q[D * b + k] - q[D * a + k]);
        (d, norm(&d))
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The length of `d` where it is shortest on its way to `d + s`, unless that is at an end.
fn shortest_between<const D: usize>(d: &[f64; D], s: &[f64; D]) -> Option<f64> {
    let along: f64 = d.iter().zip(s).map(|(d, s)| -d * s).sum();
    let part = along / s.iter().map(|s| s * s).sum::<f64>();
    let there: [f64; D] = array(|k| d[k] + part * s[k]);
    (part > 0.0 && part < 1.0).then(|| norm(&there))
}

/// The differential of a length: of none the first axis, as any direction leads out.
fn outwards<const D: usize>(d: &[f64; D], distance: f64, k: usize) -> f64 {
    match distance > 0.0 {
        true => d[k] / distance,
        false if k == 0 => 1.0,
        false => 0.0,
    }
}

/// The second differential of a length, times lambda; none where there is no length.
fn bent<const D: usize>(d: &[f64; D], distance: f64, lambda: f64, k: usize, l: usize) -> f64 {
    if distance == 0.0 {
        return 0.0;
    }
    let identity = if k == l { 1.0 } else { 0.0 };
    lambda * (identity - d[k] * d[l] / (distance * distance)) / distance
}

impl<const D: usize> Swept for Balls<D> {
    fn lowest(&self, q: &[f64], displacement: Vector<&[f64]>, lowest: &mut [f64]) {
        let end: Vec<f64> = q.iter().zip(displacement.0).map(|(q, d)| q + d).collect();
        let mut then = vec![0.0; lowest.len()];
        let both = self.value(0.0, q, lowest).and_then(|()| self.value(0.0, &end, &mut then));
        if both.is_err() {
            return lowest.fill(f64::NAN);
        }
        lowest.iter_mut().zip(&then).for_each(|(low, then)| *low = low.min(*then));
        let walls = self.radii.len() * self.walls.len();
        let (_, past_walls) = lowest.split_at_mut(walls);
        let (singles, pairs) = past_walls.split_at_mut(self.radii.len() * self.fixed.len());
        for ((ball, fixed), lowest) in self.against_fixed().zip(singles) {
            let (d, _) = self.away_from_fixed(q, ball, fixed);
            let s = array(|k| displacement.0[D * ball + k]);
            if let Some(nearest) = shortest_between(&d, &s) {
                *lowest = lowest.min(nearest - (self.radii[ball] + fixed.radius));
            }
        }
        for (&[a, b], lowest) in self.pairs.iter().zip(pairs) {
            let (d, _) = self.apart(q, [a, b]);
            let (s, _) = self.apart(displacement.0, [a, b]);
            if let Some(nearest) = shortest_between(&d, &s) {
                *lowest = lowest.min(nearest - (self.radii[a] + self.radii[b]));
            }
        }
    }

    fn sizes(&self, reach: &[f64], sizes: &mut [f64]) {
        if reach.len() != self.dim() {
            return sizes.fill(f64::NAN);
        }
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let farthest: Vec<f64> = reach.chunks_exact(D).map(largest).collect();
        let walls = self.against_walls().map(|(ball, wall)| {
            let height: f64 = (0..D).map(|k| wall.normal[k].abs() * reach[D * ball + k]).sum();
            height.max(wall.offset.abs()).max(self.radii[ball])
        });
        let fixed = self.against_fixed().map(|(ball, fixed)| {
            farthest[ball].max(largest(&fixed.centre)).max(self.radii[ball] + fixed.radius)
        });
        let pairs = self
            .pairs
            .iter()
            .map(|&[a, b]| farthest[a].max(farthest[b]).max(self.radii[a] + self.radii[b]));
        sizes.iter_mut().zip(walls.chain(fixed).chain(pairs)).for_each(|(size, x)| *size = x);
    }
}

impl<const D: usize> Constraint for Balls<D> {
    fn dim(&self) -> usize {
        D * self.radii.len()
    }

    fn count(&self) -> usize {
        self.radii.len() * (self.walls.len() + self.fixed.len()) + self.pairs.len()
    }

    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        check_read(self.dim(), q)?;
        let walls = self.against_walls().map(|(ball, wall)| {
            let height: f64 = (0..D).map(|k| wall.normal[k] * q[D * ball + k]).sum();
            height - wall.offset - self.radii[ball]
        });
        let pairs = self.pairs.iter().map(|&[a, b]| {
            let (_, distance) = self.apart(q, [a, b]);
            distance - (self.radii[a] + self.radii[b])
        });
        let fixed = self.against_fixed().map(|(ball, fixed)| {
            let (_, distance) = self.away_from_fixed(q, ball, fixed);
            distance - (self.radii[ball] + fixed.radius)
        });
        g.iter_mut().zip(walls.chain(fixed).chain(pairs)).for_each(|(g, value)| *g = value);
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        let mut row = 0;
        for (ball, wall) in self.against_walls() {
            (0..D).for_each(|k| rows.add(row, D * ball + k, wall.normal[k]));
            row += 1;
        }
        for (ball, fixed) in self.against_fixed() {
            let (d, distance) = self.away_from_fixed(q, ball, fixed);
            (0..D).for_each(|k| rows.add(row, D * ball + k, outwards(&d, distance, k)));
            row += 1;
        }
        for &[a, b] in &self.pairs {
            let (d, distance) = self.apart(q, [a, b]);
            (0..D).for_each(|k| rows.add(row, D * a + k, -outwards(&d, distance, k)));
            (0..D).for_each(|k| rows.add(row, D * b + k, outwards(&d, distance, k)));
            row += 1;
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        check_read(self.dim(), q)?;
        let lambda = &lambda[self.radii.len() * self.walls.len()..];
        let (singles, pairs) = lambda.split_at(self.radii.len() * self.fixed.len());
        for ((ball, fixed), &lambda) in self.against_fixed().zip(singles) {
            let (d, distance) = self.away_from_fixed(q, ball, fixed);
            let freedoms: [usize; D] = array(|k| D * ball + k);
            let block: Vec<f64> =
                (0..D * D).map(|at| bent(&d, distance, lambda, at % D, at / D)).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
        for (&[a, b], &lambda) in self.pairs.iter().zip(pairs) {
            let (d, distance) = self.apart(q, [a, b]);
            let freedoms: Vec<usize> =
                (0..D).map(|k| D * a + k).chain((0..D).map(|k| D * b + k)).collect();
            let entry = |i: usize, j: usize| {
                let side = if (i < D) == (j < D) { 1.0 } else { -1.0 };
                side * bent(&d, distance, lambda, i % D, j % D)
            };
            let block: Vec<f64> =
                (0..4 * D * D).map(|at| entry(at % (2 * D), at / (2 * D))).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_balls() -> Balls<2> {
        let wall = Wall { normal: [0.0, 1.0], offset: -1.0 };
        let fixed = FixedBall { centre: [3.0, 0.0], radius: 0.5 };
        Balls::new(vec![0.5, 0.25, 1.0], vec![wall]).unwrap().with_fixed(vec![fixed]).unwrap()
    }

    #[test]
    fn balls_touch_where_their_distance_is_the_sum_of_their_radii() {
        let gaps = Inequality(three_balls()).gaps(0.0, &[0.0, 0.0, 0.75, 0.0, 0.0, 2.0]);
        assert_eq!(gaps[..3], [0.5, 0.75, 2.0], "the wall");
        assert_eq!(gaps[3..5], [2.0, 1.5], "the fixed ball");
        assert_eq!(gaps[6], 0.0, "they touch, and |d| - r1 would say that they do not");
        assert_eq!(gaps[7], 0.5);
    }

    #[test]
    fn rows_are_the_differentials_of_the_gaps() {
        let balls = Inequality(three_balls());
        let q = [0.1, 0.2, 0.9, -0.3, 0.4, 2.0];
        let rows = balls.rows(0.0, &q, &[0, 1, 2, 3, 4, 5, 6, 7, 8]);
        for freedom in 0..6 {
            let moved = |h: f64| {
                let mut q = q;
                q[freedom] += h;
                balls.gaps(0.0, &q)
            };
            let (ahead, behind) = (moved(1e-6), moved(-1e-6));
            for contact in 0..9 {
                let slope = (ahead[contact] - behind[contact]) / 2e-6;
                let entry: f64 = rows.row(contact).filter(|e| e.0 == freedom).map(|e| e.1).sum();
                assert!((slope - entry).abs() < 1e-9);
            }
        }
        assert_eq!(balls.rows(0.0, &q, &[1, 4]).len(), 2);
    }

    #[test]
    fn points_meet_what_is_round_and_not_each_other() {
        let points = Balls::<2>::new(vec![0.0, 0.0, 1.0], vec![]).unwrap();
        let gaps = Inequality(points).gaps(0.0, &[0.0, 0.0, 0.0, 0.0, 3.0, 0.0]);
        assert_eq!(gaps, [2.0, 2.0]);
    }

    #[test]
    fn balls_of_negative_size_and_walls_without_direction_are_refused_by_name() {
        let wall = Wall { normal: [0.0, 0.5], offset: 0.0 };
        assert!(matches!(Balls::<2>::new(vec![-1.0], vec![]), Err(ContactError::Length { .. })));
        let error = Balls::new(vec![1.0], vec![wall]).unwrap_err();
        assert!(matches!(error, ContactError::Length { shape: "wall", .. }), "{error}");
    }
}
