//! Bars, rectangles and discs.
//!
//! ```text
//! bar        x_i = i L/n
//! rectangle  x_ij = (i a/m, j b/n),  i fastest
//! disc       ring k of n has 6 k vertices at radius k R/n
//! ```
//! `L a b R` lengths (m). Triangles run counterclockwise. A disc's rings make triangles whose
//! angles stay near 60 degrees however fine they are; its boundary vertices are on the circle.

use std::f64::consts::TAU;

use nalgebra::{SVector, Vector1, Vector2};

use super::{check_cells, check_size, direction};
use crate::MeshError;
use crate::mesh::Mesh;
use crate::quadratic::{Quadratic, QuadraticTriangles};
use crate::refinement::check_count;

/// How the cells of a rectangle are cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonals {
    /// All from lower left to upper right.
    Same,
    /// In turn one way and the other: no direction is preferred, and no corner is cut off if both
    /// numbers of cells are even.
    Alternating,
    /// Both in every cell, with a vertex where they cross.
    Crossed,
}

/// A line from 0 to a length, in equal segments.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn bar(length: f64, cells: usize) -> Result<Mesh<1, 2>, MeshError> {
    check_size("the length", length)?;
    segment(Vector1::new(0.0), Vector1::new(length), cells)
}

/// A line from one point to another, in equal segments.
///
/// # Errors
/// [`MeshError::TooFew`], [`MeshError::TooMany`], and [`MeshError::NonFinite`] or
/// [`MeshError::TooFar`] for the ends.
pub fn segment<const D: usize>(
    from: SVector<f64, D>,
    to: SVector<f64, D>,
    cells: usize,
) -> Result<Mesh<D, 2>, MeshError> {
    check_cells("the number of segments", cells, 1)?;
    check_count("the line", [cells])?;
    let at = |k: usize| from.lerp(&to, k as f64 / cells as f64);
    Mesh::new((0..=cells).map(at).collect(), (0..cells).map(|k| [k, k + 1]).collect())
}

/// A circle about the origin, counterclockwise, in equal segments.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn circle(radius: f64, cells: usize) -> Result<Mesh<2, 2>, MeshError> {
    check_size("the radius", radius)?;
    check_cells("the number of segments", cells, 3)?;
    check_count("the circle", [cells])?;
    let at = |k: usize| on_circle(radius, k, cells);
    Mesh::new((0..cells).map(at).collect(), (0..cells).map(|k| [k, (k + 1) % cells]).collect())
}

fn on_circle(radius: f64, k: usize, of: usize) -> Vector2<f64> {
    let (s, c) = (TAU * k as f64 / of as f64).sin_cos();
    Vector2::new(c, s) * radius
}

/// A rectangle with a corner at the origin, in equal cells, each cut into triangles.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn rectangle(
    size: [f64; 2],
    cells: [usize; 2],
    diagonals: Diagonals,
) -> Result<Mesh<2, 3>, MeshError> {
    check_rectangle(size, cells)?;
    let [m, n] = cells;
    let at = |x: f64, y: f64| Vector2::new(size[0] * x / m as f64, size[1] * y / n as f64);
    let corners = (0..=n).flat_map(|j| (0..=m).map(move |i| at(i as f64, j as f64)));
    let mut vertices: Vec<Vector2<f64>> = corners.collect();
    let mut triangles = Vec::with_capacity(4 * m * n);
    for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
        let a = (m + 1) * j + i;
        let (b, c, d) = (a + 1, a + m + 2, a + m + 1);
        match diagonals {
            Diagonals::Crossed => {
                let middle = vertices.len();
                vertices.push(at(i as f64 + 0.5, j as f64 + 0.5));
                triangles.extend([[a, b, middle], [b, c, middle], [c, d, middle], [d, a, middle]]);
            }
            Diagonals::Alternating if (i + j) % 2 == 1 => {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
            _ => triangles.extend([[a, b, c], [a, c, d]]),
        }
    }
    Mesh::new(vertices, triangles)
}

/// An error unless a rectangle can be cut like that.
pub(crate) fn check_rectangle(size: [f64; 2], cells: [usize; 2]) -> Result<(), MeshError> {
    for (what, side) in ["the width", "the height"].into_iter().zip(size) {
        check_size(what, side)?;
    }
    for (what, count) in ["cells across", "cells up"].into_iter().zip(cells) {
        check_cells(what, count, 1)?;
    }
    check_count("the rectangle", [cells[0], cells[1], 4]).map(|_| ())
}

/// A disc about the origin, in rings of triangles.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn disc(radius: f64, rings: usize) -> Result<Mesh<2, 3>, MeshError> {
    check_size("the radius", radius)?;
    check_cells("the number of rings", rings, 1)?;
    check_count("the disc", [rings, rings, 6])?;
    let mut vertices = vec![Vector2::zeros()];
    for ring in 1..=rings {
        let r = radius * (ring as f64 / rings as f64);
        vertices.extend((0..6 * ring).map(|k| on_circle(r, k, 6 * ring)));
    }
    let vertex = |ring: usize, k: usize| match ring {
        0 => 0,
        _ => 1 + 3 * ring * (ring - 1) + k % (6 * ring),
    };
    let mut triangles = Vec::with_capacity(6 * rings * rings);
    for (ring, sector) in (1..=rings).flat_map(|ring| (0..6).map(move |sector| (ring, sector))) {
        let outer = |k: usize| vertex(ring, sector * ring + k);
        let inner = |k: usize| vertex(ring - 1, sector * (ring - 1) + k);
        for k in 0..ring {
            triangles.push([inner(k), outer(k), outer(k + 1)]);
            if k + 1 < ring {
                triangles.push([inner(k), outer(k + 1), inner(k + 1)]);
            }
        }
    }
    Mesh::new(vertices, triangles)
}

/// A disc of quadratic triangles, whose outer edges pass through the circle at their middles.
///
/// # Errors
/// Those of [`disc`].
pub fn curved_disc(radius: f64, rings: usize) -> Result<QuadraticTriangles<2>, MeshError> {
    let mesh = disc(radius, rings)?;
    let first_outer = mesh.vertices().len() - 6 * rings;
    Quadratic::curved(&mesh, |[a, b], middle| {
        let on_rim = a >= first_outer && b >= first_outer;
        if on_rim { direction(middle) * radius } else { middle }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quality;
    use std::f64::consts::PI;

    fn check<const D: usize, const K: usize>(mesh: &Mesh<D, K>)
    where
        [usize; K]: crate::Simplex,
    {
        mesh.check_referenced().unwrap();
        mesh.check_nondegenerate().unwrap();
        mesh.check_manifold().unwrap();
        mesh.check_oriented().unwrap();
        mesh.check_positive().unwrap();
    }

    #[test]
    fn lines_and_circles_have_their_lengths() {
        let bar = bar(2.0, 5).unwrap();
        check(&bar);
        assert!((bar.measure() - 2.0).abs() < 1e-15);
        assert_eq!(bar.euler_characteristic(), 1);
        let circle = circle(1.0, 100).unwrap();
        check(&circle);
        circle.check_closed().unwrap();
        assert!((circle.measure() - 200.0 * (PI / 100.0).sin()).abs() < 1e-13);
        assert_eq!(circle.euler_characteristic(), 0);
    }

    #[test]
    fn rectangles_are_covered_once_however_they_are_cut() {
        for diagonals in [Diagonals::Same, Diagonals::Alternating, Diagonals::Crossed] {
            let mesh = rectangle([2.0, 0.5], [4, 3], diagonals).unwrap();
            check(&mesh);
            assert!((mesh.measure() - 1.0).abs() < 1e-15);
            assert_eq!(mesh.euler_characteristic(), 1);
            assert_eq!(mesh.boundary_facets().len(), 14);
        }
    }

    #[test]
    fn a_fine_disc_is_round_and_well_shaped() {
        for rings in [1, 2, 30] {
            let mesh = disc(2.0, rings).unwrap();
            check(&mesh);
            assert_eq!(mesh.simplices().len(), 6 * rings * rings);
            assert_eq!(mesh.euler_characteristic(), 1);
            let boundary = mesh.boundary().mesh;
            assert_eq!(boundary.simplices().len(), 6 * rings);
            assert!(boundary.vertices().iter().all(|x| (x.norm() - 2.0).abs() < 1e-15));
            let smallest = mesh.quality(Quality::SmallestAngle).into_iter().fold(PI, f64::min);
            assert!(smallest > 0.6, "{rings} rings: {smallest}");
        }
    }

    #[test]
    fn impossible_sizes_and_counts_are_named() {
        assert_eq!(
            bar(f64::NAN, 1).unwrap_err().to_string(),
            "the length is NaN; it must be positive and finite"
        );
        let error = rectangle([1.0, 0.0], [1, 1], Diagonals::Same).unwrap_err();
        assert_eq!(error, MeshError::Size { what: "the height", value: 0.0 });
        let error = rectangle([1.0, 1.0], [1, 0], Diagonals::Same).unwrap_err();
        assert_eq!(error, MeshError::TooFew { what: "cells up", given: 0, least: 1 });
        assert!(matches!(disc(1.0, usize::MAX), Err(MeshError::TooMany { .. })));
        assert!(matches!(bar(1.0, usize::MAX), Err(MeshError::TooMany { .. })));
        let huge = rectangle([1.0, 1.0], [usize::MAX, 7], Diagonals::Same);
        assert!(matches!(huge, Err(MeshError::TooMany { .. })));
        assert!(matches!(circle(1.0, 2), Err(MeshError::TooFew { .. })));
    }
}
