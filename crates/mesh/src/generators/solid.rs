//! Boxes, and what becomes of a plane shape that is drawn out: cylinders.
//!
//! ```text
//! box      x_ijk = (i a/l, j b/m, k c/n),  i fastest, six tetrahedra a cell
//! prism    (a, b, c) below, (a', b', c') above:  a b c c',  a b b' c',  a a' b' c'   for a < b < c
//! ```
//! Lengths in metres. Neighbours cut their common face along the same diagonal, because both go
//! by the rising order of its vertices. All tetrahedra are positive. Source: Kuhn 1960 (the six).

use nalgebra::Vector3;

use super::{check_cells, check_size, direction, disc};
use crate::MeshError;
use crate::mesh::Mesh;
use crate::quadratic::{Quadratic, QuadraticTetrahedra};
use crate::refinement::check_count;

/// A box with a corner at the origin, in equal cells of six tetrahedra.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn cuboid(size: [f64; 3], cells: [usize; 3]) -> Result<Mesh<3, 4>, MeshError> {
    for (what, side) in ["the length", "the width", "the height"].into_iter().zip(size) {
        check_size(what, side)?;
    }
    for (what, count) in ["cells along", "cells across", "cells up"].into_iter().zip(cells) {
        check_cells(what, count, 1)?;
    }
    let [l, m, n] = cells;
    check_count("the box", [l, m, n, 6])?;
    let strides = [1, l + 1, (l + 1) * (m + 1)];
    let mut vertices = Vec::with_capacity(strides[2] * (n + 1));
    for (k, j, i) in grid([n + 1, m + 1, l + 1]) {
        let part = |c: usize, step: usize| size[c] * (step as f64 / cells[c] as f64);
        vertices.push(Vector3::new(part(0, i), part(1, j), part(2, k)));
    }
    // From one corner of a cell to the opposite one, along each axis once: six ways.
    let ways = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    let mut tetrahedra = Vec::with_capacity(6 * l * m * n);
    for (k, j, i) in grid([n, m, l]) {
        let a = i * strides[0] + j * strides[1] + k * strides[2];
        for (number, [x, y, z]) in ways.into_iter().enumerate() {
            let (b, c) = (a + strides[x], a + strides[x] + strides[y]);
            let d = c + strides[z];
            tetrahedra.push(if number < 3 { [a, b, c, d] } else { [b, a, c, d] });
        }
    }
    Mesh::new(vertices, tetrahedra)
}

fn grid([n, m, l]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..n).flat_map(move |k| (0..m).flat_map(move |j| (0..l).map(move |i| (k, j, i))))
}

/// A plane shape drawn upward from z = 0 in equal layers of prisms, three tetrahedra each.
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`], [`MeshError::TooMany`] and, for a shape with
/// inverted triangles, [`MeshError::Inverted`].
pub fn extruded(shape: &Mesh<2, 3>, height: f64, layers: usize) -> Result<Mesh<3, 4>, MeshError> {
    check_size("the height", height)?;
    check_cells("the number of layers", layers, 1)?;
    check_count("the extrusion", [shape.simplices().len(), layers, 3])?;
    shape.check_positive()?;
    let count = shape.vertices().len();
    let level = |k: usize| height * (k as f64 / layers as f64);
    let vertices: Vec<Vector3<f64>> = (0..=layers)
        .flat_map(|k| shape.vertices().iter().map(move |x| Vector3::new(x.x, x.y, level(k))))
        .collect();
    let mut tetrahedra = Vec::with_capacity(3 * layers * shape.simplices().len());
    for layer in 0..layers {
        for triangle in shape.simplices() {
            tetrahedra.extend(prism(triangle.map(|vertex| vertex + layer * count), count));
        }
    }
    Mesh::new(vertices, tetrahedra)
}

/// The tetrahedra of a prism over a triangle, its upper vertices numbered `up` higher.
fn prism(triangle: [usize; 3], up: usize) -> [[usize; 4]; 3] {
    let mut rising = triangle;
    rising.sort_unstable();
    let [a, b, c] = rising;
    let even = (0..3).any(|k| triangle == [rising[k], rising[(k + 1) % 3], rising[(k + 2) % 3]]);
    let cut = [[a, b, c, c + up], [a, b + up, b, c + up], [a, a + up, b + up, c + up]];
    cut.map(|[p, q, r, s]| if even { [p, q, r, s] } else { [q, p, r, s] })
}

/// A cylinder along z from z = 0, a drawn out [`disc`].
///
/// # Errors
/// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
pub fn cylinder(
    radius: f64,
    height: f64,
    rings: usize,
    layers: usize,
) -> Result<Mesh<3, 4>, MeshError> {
    extruded(&disc(radius, rings)?, height, layers)
}

/// A cylinder of quadratic tetrahedra, whose edges on the side pass through the true surface at
/// their middles.
///
/// # Errors
/// Those of [`cylinder`].
pub fn curved_cylinder(
    radius: f64,
    height: f64,
    rings: usize,
    layers: usize,
) -> Result<QuadraticTetrahedra<3>, MeshError> {
    let mesh = cylinder(radius, height, rings, layers)?;
    let in_layer = mesh.vertices().len() / (layers + 1);
    let on_side = |vertex: usize| vertex % in_layer >= in_layer - 6 * rings;
    Quadratic::curved(&mesh, |[a, b], middle| {
        if !(on_side(a) && on_side(b)) {
            return middle;
        }
        let outward = direction(middle.xy()) * radius;
        Vector3::new(outward.x, outward.y, middle.z)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagonals, rectangle};
    use std::f64::consts::PI;

    fn check(mesh: &Mesh<3, 4>) {
        mesh.check_referenced().unwrap();
        mesh.check_nondegenerate().unwrap();
        mesh.check_manifold().unwrap();
        mesh.check_oriented().unwrap();
        mesh.check_positive().unwrap();
        assert_eq!(mesh.euler_characteristic(), 1);
        assert_eq!(mesh.boundary().mesh.euler_characteristic(), 2);
    }

    #[test]
    fn a_box_is_filled_once() {
        let mesh = cuboid([1.0, 2.0, 3.0], [2, 3, 4]).unwrap();
        check(&mesh);
        assert_eq!(mesh.simplices().len(), 144);
        assert!((mesh.measure() - 6.0).abs() < 1e-14);
        assert!((mesh.boundary().mesh.measure() - 22.0).abs() < 1e-13);
    }

    #[test]
    fn a_drawn_out_shape_has_area_times_height() {
        let shape = rectangle([2.0, 1.0], [3, 2], Diagonals::Crossed).unwrap();
        let mesh = extruded(&shape, 0.5, 2).unwrap();
        check(&mesh);
        assert!((mesh.measure() - 1.0).abs() < 1e-14);
        let turned = extruded(&shape.reversed(), 0.5, 2).unwrap_err();
        assert!(matches!(turned, MeshError::Inverted(_)));
    }

    #[test]
    fn a_cylinder_stands_on_its_disc() {
        let mesh = cylinder(1.0, 3.0, 3, 4).unwrap();
        check(&mesh);
        assert!((mesh.measure() - 3.0 * disc(1.0, 3).unwrap().measure()).abs() < 1e-13);
    }

    #[test]
    fn a_curved_cylinder_gains_two_orders() {
        let exact = 2.0 * PI;
        let error = |n: usize| (curved_cylinder(1.0, 2.0, n, n).unwrap().measure() - exact).abs();
        let straight = |n: usize| (cylinder(1.0, 2.0, n, n).unwrap().measure() - exact).abs();
        let order = (error(3) / error(6)).log2();
        assert!((order - 4.0).abs() < 0.2, "{order}");
        assert!(((straight(3) / straight(6)).log2() - 2.0).abs() < 0.1);
    }
}
