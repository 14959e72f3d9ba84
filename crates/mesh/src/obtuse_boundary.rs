//! Splitting boundary sides that face an obtuse angle: what flips cannot mend.
//!
//! ```text
//! side ab on the boundary, c opposite, angle at c beyond a right one
//! m the foot of c on ab:   a b c  ->  a m c,  m b c     both right-angled at m
//! ```
//! The weight of a boundary edge is half the cotangent opposite to it. Both new sides face what is
//! left of the angle at c on one side of its height, which is acute. Then inner edges are made
//! Delaunay again, which may bring other corners to the boundary, and so on until none of its sides
//! faces an obtuse angle: then no weight of the Laplacian is negative. New vertices lie on straight
//! sides, so the metric is as it was. Source: the intrinsic form of Delaunay refinement, Sharp,
//! Soliman and Crane 2019.

use crate::intrinsic_surface::Side;
use crate::{IntrinsicSurface, MeshError};

/// A vertex that was put on a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The ends of the side, each an old vertex or one of a split before.
    pub ends: [usize; 2],
    /// How far along it, from 0 at the first to 1 at the second.
    pub part: f64,
}

impl Split {
    /// What a function that is linear along the side has at the new vertex.
    pub fn between(&self, first: f64, second: f64) -> f64 {
        first + self.part * (second - first)
    }
}

/// Rounds of splits and flips before the boundary is given up.
const ROUNDS: usize = 100;
/// Cotangents above minus this are those of right angles.
const RIGHT: f64 = 1e-12;

impl IntrinsicSurface {
    /// Makes all inner edges Delaunay and splits boundary sides until none faces an obtuse angle.
    /// Split k puts vertex V + k on its side, V the number of vertices before.
    ///
    /// # Errors
    /// [`MeshError::TooManyFlips`] and [`MeshError::TooManySplits`]; the surface is then as it was.
    pub fn split_obtuse_boundary(&mut self) -> Result<Vec<Split>, MeshError> {
        let mut refined = self.clone();
        let mut splits = Vec::new();
        for _ in 0..ROUNDS {
            refined.flip_to_delaunay()?;
            // A triangle has one obtuse angle at most: these are of different ones.
            let obtuse: Vec<Side> = refined
                .obtuse_boundary()
                .into_iter()
                .filter(|&side| refined.cotangent(side) < -RIGHT)
                .collect();
            if obtuse.is_empty() {
                *self = refined;
                return Ok(splits);
            }
            splits.extend(obtuse.into_iter().map(|side| refined.split(side)));
        }
        Err(MeshError::TooManySplits { rounds: ROUNDS, splits: splits.len() })
    }

    /// Puts a vertex on a boundary side, at the foot of the opposite corner.
    fn split(&mut self, side: Side) -> Split {
        let t = side.triangle;
        let ([a, b], c) = (self.ends(side), self.triangles[t][side.after(2).side]);
        let [ab, bc, ca] = [0, 1, 2].map(|steps| self.lengths[t][side.after(steps).side]);
        let along = (ab + (ca - bc) * ((ca + bc) / ab)) / 2.0;
        let height = 2.0 * self.shape(t).area() / ab;
        let (m, u) = (self.vertices, self.triangles.len());
        let place = |triangle: usize, side: usize| Side { triangle, side };
        let moved = [(side.after(1), place(u, 1)), (side.after(2), place(t, 2))];
        let to = |old: Side| moved.iter().find(|pair| pair.0 == old).map_or(old, |pair| pair.1);
        let partners = moved.map(|(old, _)| self.across(old).map(to));
        self.vertices += 1;
        (self.triangles[t], self.lengths[t]) = ([a, m, c], [along, height, ca]);
        self.triangles.push([m, b, c]);
        self.lengths.push([ab - along, bc, height]);
        self.glued[t] = [None, Some(place(u, 2)), None];
        self.glued.push([None, None, Some(place(t, 1))]);
        for ((_, new), partner) in moved.into_iter().zip(partners) {
            self.glued[new.triangle][new.side] = partner;
            if let Some(partner) = partner {
                self.glued[partner.triangle][partner.side] = Some(new);
            }
        }
        Split { ends: [a, b], part: along / ab }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagonals, Mesh, disc, icosphere, rectangle};
    use nalgebra::Vector2;

    /// The smallest weight of any side.
    fn least(surface: &IntrinsicSurface) -> f64 {
        surface.sides().map(|side| surface.weight(side)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn after_splits_no_weight_is_negative_and_the_metric_is_as_it_was() {
        let sheared = |x: &Vector2<f64>| Vector2::new(4.0 * x.x + 3.0 * x.y, 0.5 * x.y);
        let square = rectangle([1.0, 1.0], [6, 6], Diagonals::Same).unwrap();
        for mesh in [square, disc(1.0, 6).unwrap()] {
            let mesh = mesh.mapped(sheared).unwrap();
            let before = IntrinsicSurface::of(&mesh).unwrap();
            let mut after = before.clone();
            after.flip_to_delaunay().unwrap();
            assert!(least(&after) < -0.01, "flips alone do not do");
            let splits = after.split_obtuse_boundary().unwrap();
            assert!(!splits.is_empty() && least(&after) > -1e-11, "{}", least(&after));
            assert_eq!(after.vertices(), before.vertices() + splits.len());
            assert!((after.area() / before.area() - 1.0).abs() < 1e-12);
            // In the plane every edge is as long as its ends are apart.
            let mut places: Vec<Vector2<f64>> = mesh.vertices().to_vec();
            for split in &splits {
                let [a, b] = split.ends.map(|vertex| places[vertex]);
                places.push(a + (b - a) * split.part);
            }
            for side in after.sides() {
                let [a, b] = after.ends(side).map(|vertex| places[vertex]);
                let length = after.lengths()[side.triangle][side.side];
                assert!(((a - b).norm() - length).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn a_flat_triangle_is_split_once_and_a_closed_or_acute_surface_never() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [0.5, 0.1]].map(Vector2::from).to_vec();
        let mut flat = IntrinsicSurface::of(&Mesh::new(corners, vec![[0, 1, 2]]).unwrap()).unwrap();
        let splits = flat.split_obtuse_boundary().unwrap();
        assert!(
            matches!(splits[..], [Split { ends: [0, 1], part }] if (part - 0.25).abs() < 1e-12)
        );
        assert!((splits[0].between(1.0, 5.0) - 2.0).abs() < 1e-11);
        let mut ball = IntrinsicSurface::of(&icosphere(1.0, 2).unwrap()).unwrap();
        assert_eq!(ball.split_obtuse_boundary(), Ok(vec![]));
        let square = rectangle([1.0, 1.0], [3, 3], Diagonals::Alternating).unwrap();
        let mut square = IntrinsicSurface::of(&square).unwrap();
        assert_eq!(square.split_obtuse_boundary(), Ok(vec![]));
    }
}
