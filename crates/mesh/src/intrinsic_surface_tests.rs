use super::*;
use crate::{Diagonals, disc, icosphere, rectangle, torus};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;

/// The sum of the angles at each vertex.
fn cone_angles(surface: &IntrinsicSurface) -> Vec<f64> {
    let mut sums = vec![0.0; surface.vertices()];
    for (triangle, corners) in surface.triangles().iter().enumerate() {
        for (&vertex, angle) in corners.iter().zip(surface.shape(triangle).angles()) {
            sums[vertex] += angle;
        }
    }
    sums
}

/// Sides are glued in pairs of equal length and opposite direction.
fn check_gluing(surface: &IntrinsicSurface) {
    for side in surface.sides() {
        if let Some(other) = surface.across(side) {
            assert_eq!(surface.across(other), Some(side));
            let (here, there) = (surface.ends(side), surface.ends(other));
            assert_eq!(here, [there[1], there[0]]);
            let length = |side: Side| surface.lengths()[side.triangle][side.side];
            assert_eq!(length(side), length(other));
        }
    }
}

/// A disc whose points were pushed about, so that many edges are not Delaunay.
fn pushed_disc() -> Mesh<2, 3> {
    disc(1.0, 8).unwrap().mapped(|x| Vector2::new(x.x * 3.0 + 1.5 * x.y, 0.6 * x.y)).unwrap()
}

#[test]
fn flips_keep_the_metric_and_make_every_inner_edge_delaunay() {
    let torus = torus([2.0, 0.5], [30, 20]).unwrap();
    for mesh in [torus, icosphere(1.0, 2).unwrap()] {
        let mesh = mesh.mapped(|x| Vector3::new(x.x, x.y, 5.0 * x.z + 3.0 * x.y)).unwrap();
        let before = IntrinsicSurface::of(&mesh).unwrap();
        let mut after = before.clone();
        let flips = after.flip_to_delaunay().unwrap();
        assert!(flips > 10, "{flips}");
        check_gluing(&after);
        assert!((after.area() / before.area() - 1.0).abs() < 1e-12);
        for (a, b) in cone_angles(&before).iter().zip(cone_angles(&after)) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
        assert!(before.sides().any(|side| before.weight(side) < -0.01));
        assert!(after.sides().all(|side| after.weight(side) > -1e-11));
    }
}

#[test]
fn in_the_plane_flipped_edges_are_as_long_as_their_ends_are_apart() {
    let mesh = pushed_disc();
    let mut surface = IntrinsicSurface::of(&mesh).unwrap();
    assert!(surface.flip_to_delaunay().unwrap() > 50);
    for side in surface.sides() {
        let [a, b] = surface.ends(side).map(|vertex| mesh.vertices()[vertex]);
        assert!((surface.lengths()[side.triangle][side.side] - (a - b).norm()).abs() < 1e-12);
    }
    let inner = |side: &Side| surface.across(*side).is_some();
    assert!(surface.sides().filter(inner).all(|side| surface.weight(side) > -1e-11));
}

#[test]
fn boundary_sides_that_face_an_obtuse_angle_are_reported() {
    let square = rectangle([1.0, 1.0], [3, 3], Diagonals::Same).unwrap();
    assert!(IntrinsicSurface::of(&square).unwrap().obtuse_boundary().is_empty());
    let corners = [[0.0, 0.0], [4.0, 0.0], [2.0, 1.0]].map(Vector2::from).to_vec();
    let flat = IntrinsicSurface::of(&Mesh::new(corners, vec![[0, 1, 2]]).unwrap()).unwrap();
    assert_eq!(flat.obtuse_boundary(), [Side { triangle: 0, side: 0 }]);
}

#[test]
fn a_flat_torus_is_flat_at_every_vertex_even_if_it_has_one() {
    for cells in [[1, 1], [1, 3], [2, 2], [7, 5]] {
        let mut torus = IntrinsicSurface::flat_torus([2.0, 0.3], cells).unwrap();
        check_gluing(&torus);
        torus.flip_to_delaunay().unwrap();
        check_gluing(&torus);
        assert!((torus.area() - 0.6).abs() < 1e-14);
        assert!(cone_angles(&torus).iter().all(|angle| (angle - 2.0 * PI).abs() < 1e-12));
    }
}

#[test]
fn a_sheared_grid_on_a_flat_torus_flips_back_to_its_right_angles() {
    // One cell of sides 1 and 1 in a basis sheared five times: edges (1, 0), (5, 1), (6, 1).
    let (a, b, c) = (1.0, 26.0_f64.sqrt(), 37.0_f64.sqrt());
    let square = IntrinsicSurface::flat_torus([1.0, 1.0], [1, 1]).unwrap();
    let mut sheared = IntrinsicSurface { lengths: vec![[a, b, c], [c, a, b]], ..square.clone() };
    assert!(sheared.flip_to_delaunay().unwrap() >= 4);
    check_gluing(&sheared);
    let mut lengths = sheared.lengths()[0];
    lengths.sort_by(f64::total_cmp);
    for (got, expected) in lengths.iter().zip([1.0, 1.0, 2.0_f64.sqrt()]) {
        assert!((got - expected).abs() < 1e-12, "{got}");
    }
}

#[test]
fn a_triangle_without_area_is_given_one_on_request() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]].map(Vector2::from).to_vec();
    let mesh = Mesh::new(corners, vec![[0, 1, 3], [1, 2, 3], [0, 2, 1]]).unwrap();
    let surface = IntrinsicSurface::of(&mesh).unwrap();
    assert_eq!(surface.shape(2).area(), 0.0);
    let better = surface.clone().mollified(1e-5).unwrap();
    assert!(better.shape(2).area() > 1e-3);
    assert!((better.area() - 1.0).abs() < 1e-2);
    assert!(better.shape(2).cotangents().iter().all(|c| c.is_finite()));
    let good = IntrinsicSurface::of(&pushed_disc()).unwrap();
    assert_eq!(good.clone().mollified(1e-9).unwrap(), good);
    assert!(matches!(good.mollified(f64::NAN), Err(MeshError::Size { .. })));
}

#[test]
fn what_is_no_surface_is_refused() {
    let sphere = icosphere(1.0, 0).unwrap();
    let mut turned = sphere.simplices().to_vec();
    turned[3].swap(0, 1);
    let turned = Mesh::new(sphere.vertices().to_vec(), turned).unwrap();
    assert!(matches!(IntrinsicSurface::of(&turned), Err(MeshError::Inconsistent(_))));
    let coincident = sphere.mapped(|x| x * 0.0).unwrap();
    let error = IntrinsicSurface::of(&coincident).unwrap_err();
    assert!(matches!(error, MeshError::TriangleInequality(places) if places.0.len() == 20));
}
