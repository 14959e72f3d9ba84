//! Inequalities: functions of the configuration that must not become negative.
//!
//! ```text
//! g_i(q) >= 0                          feasible; dg_i is not zero where g_i is              (11.2)
//! floor       g = n.x - offset - r
//! two balls   g = |x2 - x1| - (r1 + r2)                              (errata 11.2: the sum of radii)
//! ```
//! The shape is that of an equality, the type is not: [`Inequality`] reads a constraint's functions
//! as gaps. `x` centres in D dimensions, `r` radii, `n` unit normals, lengths in metres.

use stationary_calculus::{Sink, Vector};
use stationary_constraints::{Constraint, Rows};

use crate::error::check_finite;
use crate::{ContactError, ContactRows};

/// A constraint's functions read as gaps that must not be negative.
#[derive(Clone, Debug)]
pub struct Inequality<K>(pub K);

/// Gaps that know how small they become on a straight path.
pub trait Swept: Constraint {
    /// Writes the smallest value of each gap while q moves straight by a displacement.
    fn lowest(&self, q: &[f64], displacement: Vector<&[f64]>, lowest: &mut [f64]);
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
        self.0.value(t, q, &mut gaps);
        gaps
    }

    /// The differentials of some of the gaps, in ascending order.
    pub fn rows(&self, t: f64, q: &[f64], wanted: &[usize]) -> ContactRows {
        let mut rows = ContactRows::new();
        let mut collect = Collect { rows: &mut rows, wanted, row: None, entries: Vec::new() };
        self.0.differential(t, q, &mut collect);
        collect.finish_row();
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
}

/// A fixed wall: the half-space `n.x >= offset` is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall<const D: usize> {
    /// Points into the free side, of length 1.
    pub normal: [f64; D],
    /// How far the wall is from the origin along it, m.
    pub offset: f64,
}

/// Balls that overlap neither walls nor each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Balls<const D: usize> {
    radii: Vec<f64>,
    walls: Vec<Wall<D>>,
    pairs: Vec<[usize; 2]>,
}

impl<const D: usize> Balls<D> {
    /// Balls of these radii among these walls; all pairs of them are gaps.
    pub fn new(radii: Vec<f64>, walls: Vec<Wall<D>>) -> Result<Self, ContactError> {
        if let Some(&value) = radii.iter().find(|r| !(**r > 0.0 && r.is_finite())) {
            return Err(ContactError::Length { shape: "ball", what: "radius", value });
        }
        for wall in &walls {
            check_finite("a wall", &wall.normal)?;
            check_finite("a wall", &[wall.offset])?;
            let length = wall.normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            if (length - 1.0).abs() > 1e-9 {
                let (shape, what) = ("wall", "normal");
                return Err(ContactError::Length { shape, what, value: length });
            }
        }
        let balls = radii.len();
        let pairs = (0..balls).flat_map(|a| (a + 1..balls).map(move |b| [a, b])).collect();
        Ok(Balls { radii, walls, pairs })
    }

    fn against_walls(&self) -> impl Iterator<Item = (usize, &Wall<D>)> {
        (0..self.radii.len()).flat_map(|ball| self.walls.iter().map(move |wall| (ball, wall)))
    }

    fn apart(&self, q: &[f64], [a, b]: [usize; 2]) -> ([f64; D], f64) {
        let d: [f64; D] = std::array::from_fn(|k| q[D * b + k] - q[D * a + k]);
        (d, d.iter().map(|x| x * x).sum::<f64>().sqrt())
    }
}

impl<const D: usize> Swept for Balls<D> {
    fn lowest(&self, q: &[f64], displacement: Vector<&[f64]>, lowest: &mut [f64]) {
        let end: Vec<f64> = q.iter().zip(displacement.0).map(|(q, d)| q + d).collect();
        self.value(0.0, q, lowest);
        let mut then = vec![0.0; lowest.len()];
        self.value(0.0, &end, &mut then);
        lowest.iter_mut().zip(&then).for_each(|(low, then)| *low = low.min(*then));
        let walls = self.radii.len() * self.walls.len();
        for (&[a, b], lowest) in self.pairs.iter().zip(&mut lowest[walls..]) {
            let (d, _) = self.apart(q, [a, b]);
            let (s, length) = self.apart(displacement.0, [a, b]);
            let along: f64 = d.iter().zip(&s).map(|(d, s)| -d * s).sum();
            let part = along / (length * length);
            if part > 0.0 && part < 1.0 {
                let nearest = (0..D).map(|k| (d[k] + part * s[k]).powi(2)).sum::<f64>().sqrt();
                *lowest = lowest.min(nearest - (self.radii[a] + self.radii[b]));
            }
        }
    }
}

impl<const D: usize> Constraint for Balls<D> {
    fn dim(&self) -> usize {
        D * self.radii.len()
    }

    fn count(&self) -> usize {
        self.radii.len() * self.walls.len() + self.pairs.len()
    }

    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) {
        let walls = self.against_walls().map(|(ball, wall)| {
            let height: f64 = (0..D).map(|k| wall.normal[k] * q[D * ball + k]).sum();
            height - wall.offset - self.radii[ball]
        });
        let pairs = self.pairs.iter().map(|&[a, b]| {
            let (_, distance) = self.apart(q, [a, b]);
            distance - (self.radii[a] + self.radii[b])
        });
        g.iter_mut().zip(walls.chain(pairs)).for_each(|(g, value)| *g = value);
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) {
        let mut row = 0;
        for (ball, wall) in self.against_walls() {
            (0..D).for_each(|k| rows.add(row, D * ball + k, wall.normal[k]));
            row += 1;
        }
        for &[a, b] in &self.pairs {
            let (d, distance) = self.apart(q, [a, b]);
            (0..D).for_each(|k| rows.add(row, D * a + k, -d[k] / distance));
            (0..D).for_each(|k| rows.add(row, D * b + k, d[k] / distance));
            row += 1;
        }
    }

    fn add_hessian(&self, _t: f64, q: &[f64], lambda: &[f64], hessian: &mut impl Sink) {
        let walls = self.radii.len() * self.walls.len();
        for (&[a, b], lambda) in self.pairs.iter().zip(&lambda[walls..]) {
            let (d, distance) = self.apart(q, [a, b]);
            let freedoms: Vec<usize> =
                (0..D).map(|k| D * a + k).chain((0..D).map(|k| D * b + k)).collect();
            let entry = |i: usize, j: usize| {
                let (k, l) = (i % D, j % D);
                let side = if (i < D) == (j < D) { 1.0 } else { -1.0 };
                let identity = if k == l { 1.0 } else { 0.0 };
                side * lambda * (identity - d[k] * d[l] / (distance * distance)) / distance
            };
            let block: Vec<f64> =
                (0..4 * D * D).map(|at| entry(at % (2 * D), at / (2 * D))).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_balls() -> Balls<2> {
        let wall = Wall { normal: [0.0, 1.0], offset: -1.0 };
        Balls::new(vec![0.5, 0.25, 1.0], vec![wall]).unwrap()
    }

    #[test]
    fn balls_touch_where_their_distance_is_the_sum_of_their_radii() {
        let gaps = Inequality(three_balls()).gaps(0.0, &[0.0, 0.0, 0.75, 0.0, 0.0, 2.0]);
        assert_eq!(gaps[..3], [0.5, 0.75, 2.0], "the wall");
        assert_eq!(gaps[3], 0.0, "they touch, and |d| - r1 would say that they do not");
        assert_eq!(gaps[4], 0.5);
    }

    #[test]
    fn rows_are_the_differentials_of_the_gaps() {
        let balls = Inequality(three_balls());
        let q = [0.1, 0.2, 0.9, -0.3, 0.4, 2.0];
        let rows = balls.rows(0.0, &q, &[0, 1, 2, 3, 4, 5]);
        for freedom in 0..6 {
            let moved = |h: f64| {
                let mut q = q;
                q[freedom] += h;
                balls.gaps(0.0, &q)
            };
            let (ahead, behind) = (moved(1e-6), moved(-1e-6));
            for contact in 0..6 {
                let slope = (ahead[contact] - behind[contact]) / 2e-6;
                let entry: f64 = rows.row(contact).filter(|e| e.0 == freedom).map(|e| e.1).sum();
                assert!((slope - entry).abs() < 1e-9);
            }
        }
        assert_eq!(balls.rows(0.0, &q, &[1, 4]).len(), 2);
    }

    #[test]
    fn balls_without_size_and_walls_without_direction_are_refused_by_name() {
        let wall = Wall { normal: [0.0, 0.5], offset: 0.0 };
        assert!(matches!(Balls::<2>::new(vec![0.0], vec![]), Err(ContactError::Length { .. })));
        let error = Balls::new(vec![1.0], vec![wall]).unwrap_err();
        assert!(matches!(error, ContactError::Length { shape: "wall", .. }), "{error}");
    }
}
