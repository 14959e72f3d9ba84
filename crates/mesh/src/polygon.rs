//! A region of the plane between outlines: holes, islands in holes, and its moments.
//!
//! ```text
//! m = 1/2 sum v x w     f = 1/6 sum (v + w)(v x w)     tr C = 1/12 sum (v.v + v.w + w.w)(v x w)
//! ```
//! Sums over edges from `v` to `w` (m, seen from the middle of the outline), `v x w` the number
//! `vx wy - vy wx`: the integrals of the notes' Stokes theorem, written as signed triangles.
//! Outlines may wind either way and come in any order; one inside an odd number of others is a
//! hole, and they are turned silently so that the region lies on their left. Outlines that cross
//! or touch themselves or each other are refused, by exact signs. Source: notes 7.1-7.3; errata
//! chapter 7.

use std::cmp::Ordering;

use nalgebra::{SVector, Vector2};

use crate::crossing::crossings;
use crate::measure::in_space;
use crate::mesh::{Mesh, check_vertices};
use crate::moments::{Moments, middle};
use crate::side::side_of_line;
use crate::{MeshError, Places};

/// A region of the plane, bounded by outlines that neither cross nor touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    outlines: Vec<Vec<Vector2<f64>>>,
    depths: Vec<usize>,
}

impl Polygon {
    /// The region between outlines, each a list of corners; the last is joined to the first.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::ShortOutline`], [`MeshError::NonFinite`],
    /// [`MeshError::TooFar`] (with vertices counted through all outlines),
    /// [`MeshError::RepeatedCorner`], [`MeshError::SmallOutline`] and [`MeshError::Crossing`].
    pub fn new(mut outlines: Vec<Vec<Vector2<f64>>>) -> Result<Self, MeshError> {
        if outlines.is_empty() {
            return Err(MeshError::Empty);
        }
        check_vertices(&outlines.concat())?;
        for (outline, corners) in outlines.iter().enumerate() {
            check_outline(outline, corners)?;
        }
        Places::refuse(crossings(&outlines), MeshError::Crossing)?;
        let depths: Vec<usize> = (0..outlines.len()).map(|k| depth(&outlines, k)).collect();
        for (corners, depth) in outlines.iter_mut().zip(&depths) {
            let counterclockwise = outline_moments(corners).measure > 0.0;
            if counterclockwise != (depth % 2 == 0) {
                corners[1..].reverse();
            }
        }
        Ok(Polygon { outlines, depths })
    }

    /// The outlines, in the order given: those around the region counterclockwise, those around a
    /// hole clockwise, each with its first corner first.
    pub fn outlines(&self) -> &[Vec<Vector2<f64>>] {
        &self.outlines
    }

    /// For each outline, how many others it lies in: it bounds a hole if that is odd.
    pub fn depths(&self) -> &[usize] {
        &self.depths
    }

    /// Area, first and second moments, about the middle of the first outline.
    pub fn moments(&self) -> Moments<2> {
        let mut moments = self.outlines.iter().map(|corners| outline_moments(corners));
        let first = moments.next().unwrap_or_else(|| Moments::zero(Vector2::zeros()));
        moments.fold(first, |sum, outline| sum.with(&outline))
    }

    /// Whether a point lies in the region; its edges belong to it. One with a coordinate that is not a
    /// number lies nowhere.
    pub fn contains(&self, point: &Vector2<f64>) -> bool {
        if point.iter().any(|x| x.is_nan()) {
            return false;
        }
        let on_edge = |corners: &Vec<Vector2<f64>>| winds(corners, point).is_none();
        let within = |corners: &&Vec<Vector2<f64>>| winds(corners, point) == Some(true);
        self.outlines.iter().any(on_edge) || self.outlines.iter().filter(within).count() % 2 == 1
    }

    /// The outlines as segments that have the region on their left.
    pub fn boundary(&self) -> Mesh<2, 2> {
        let (mut vertices, mut segments) = (Vec::new(), Vec::new());
        for corners in &self.outlines {
            let (first, count) = (vertices.len(), corners.len());
            segments.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
            vertices.extend_from_slice(corners);
        }
        Mesh::known(vertices, segments)
    }
}

fn check_outline(outline: usize, corners: &[Vector2<f64>]) -> Result<(), MeshError> {
    if corners.len() < 3 {
        return Err(MeshError::ShortOutline { outline, corners: corners.len() });
    }
    let before = corners.iter().cycle().skip(corners.len() - 1);
    match corners.iter().zip(before).position(|(corner, before)| corner == before) {
        Some(corner) => Err(MeshError::RepeatedCorner { outline, corner }),
        None => check_extent(outline, corners),
    }
}

/// The least size of an outline: below it signs, areas and moments are lost to underflow.
const LEAST: f64 = 1e-100;

fn check_extent(outline: usize, corners: &[Vector2<f64>]) -> Result<(), MeshError> {
    let (low, high) = (corners.iter().copied().reduce(|a, b| a.inf(&b)))
        .zip(corners.iter().copied().reduce(|a, b| a.sup(&b)))
        .unwrap_or_default();
    let size = (high - low).max();
    match size < LEAST {
        true => Err(MeshError::SmallOutline { outline, size, least: LEAST }),
        false => Ok(()),
    }
}

/// How many of the other outlines an outline lies in, looking at all of them. None touches it, so one
/// corner tells.
fn depth(outlines: &[Vec<Vector2<f64>>], outline: usize) -> usize {
    let corner = &outlines[outline][0];
    let others = outlines.iter().enumerate().filter(|(other, _)| *other != outline);
    others.filter(|(_, corners)| winds(corners, corner) == Some(true)).count()
}

/// Whether an outline goes around a point: a ray to the right crosses it an odd number of times.
/// `None` where the point is on the outline.
fn winds(corners: &[Vector2<f64>], point: &Vector2<f64>) -> Option<bool> {
    let mut odd = false;
    for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let side = side_of_line(p, q, point);
        if side == Ordering::Equal && (p - point).dot(&(q - point)) <= 0.0 {
            return None;
        }
        let upward = q.y > point.y;
        if (p.y > point.y) != upward && (side == Ordering::Greater) == upward {
            odd = !odd;
        }
    }
    Some(odd)
}

/// The moments of what an outline encloses, counted negative if it is clockwise.
fn outline_moments(corners: &[Vector2<f64>]) -> Moments<2> {
    let about = middle(corners.iter().copied()).unwrap_or_else(Vector2::zeros);
    let next = corners.iter().cycle().skip(1);
    cone_moments(about, corners.iter().zip(next).map(|(&v, &w)| [v, w]))
}

/// The moments of what closed facets enclose, as a sum of the signed simplices that join each to a
/// point: the divergence theorem for polynomials.
pub(crate) fn cone_moments<const D: usize>(
    about: SVector<f64, D>,
    facets: impl Iterator<Item = [SVector<f64, D>; D]>,
) -> Moments<D> {
    let mut moments = Moments::zero(about);
    for facet in facets {
        let seen = facet.map(|corner| corner - about);
        moments.add_simplex(cone(&seen), &seen, D + 1);
    }
    moments
}

/// The signed area or volume between a facet and the origin.
fn cone<const D: usize>(facet: &[SVector<f64, D>; D]) -> f64 {
    let corner = |k: usize| facet.get(k).map_or_else(Default::default, in_space);
    let (a, b) = (corner(0), corner(1));
    if D == 2 { a.xy().perp(&b.xy()) / 2.0 } else { a.dot(&b.cross(&corner(2))) / 6.0 }
}

#[cfg(test)]
#[path = "polygon_tests.rs"]
mod tests;
