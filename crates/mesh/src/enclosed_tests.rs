use super::*;
use crate::{cuboid, icosphere, torus};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;

fn cube(size: [f64; 3]) -> Mesh<3, 3> {
    cuboid(size, [2, 1, 3]).unwrap().boundary().mesh
}

#[test]
fn a_box_has_its_textbook_inertia() {
    let surface = ClosedSurface::new(cube([0.2, 0.4, 0.6])).unwrap();
    let central = surface.moments().central().unwrap();
    assert!((central.measure - 0.048).abs() < 1e-16);
    assert!((central.about - Vector3::new(0.1, 0.2, 0.3)).amax() < 1e-16);
    let textbook = Vector3::new(0.16 + 0.36, 0.04 + 0.36, 0.04 + 0.16) / 12.0 * 0.048;
    assert!((central.inertia() - Matrix3::from_diagonal(&textbook)).amax() < 1e-17);
}

#[test]
fn the_surface_of_a_solid_has_the_moments_of_the_solid() {
    let solid = cuboid([1.0, 2.0, 0.5], [3, 4, 2]).unwrap();
    let bent = solid.mapped(|x| Vector3::new(x.x + 0.3 * x.y * x.y, x.y, x.z + 0.2 * x.x)).unwrap();
    let surface = ClosedSurface::new(bent.boundary().mesh).unwrap().moments();
    let solid = bent.moments().seen_from(surface.about);
    assert!((surface.measure - solid.measure).abs() < 1e-14);
    assert!((surface.first - solid.first).amax() < 1e-14);
    assert!((surface.second - solid.second).amax() < 1e-14);
}

#[test]
fn a_unit_cube_a_million_metres_away_keeps_nine_digits() {
    let near = ClosedSurface::new(cube([1.0; 3])).unwrap().moments().central().unwrap();
    for shift in [Vector3::new(1e6, -1e6, 1e6), Vector3::new(1e6 + 0.1, -1e6 - 0.7, 1e6 + 0.3)] {
        let far = cube([1.0; 3]).mapped(|x| x + shift).unwrap();
        let far = ClosedSurface::new(far).unwrap().moments().central().unwrap();
        assert!((far.measure - 1.0).abs() < 1e-9);
        assert!((far.inertia() - near.inertia()).amax() < 1e-9 / 6.0);
        assert!((far.about - near.about - shift).amax() < 1e-9);
    }
}

#[test]
fn a_cavity_takes_away_and_must_face_inward() {
    let outer = cube([4.0; 3]);
    let inner = cube([1.0; 3]).mapped(|x| x + Vector3::repeat(1.0)).unwrap();
    let hollow = ClosedSurface::new(outer.beside(&inner.reversed())).unwrap();
    assert!((hollow.moments().measure - 63.0).abs() < 1e-12);
    assert!((hollow.winding_number(&Vector3::new(0.5, 0.5, 0.5)) - 1.0).abs() < 1e-12);
    assert!(hollow.winding_number(&Vector3::new(1.5, 1.5, 1.5)).abs() < 1e-12);
    let wrong = outer.beside(&inner);
    let first = outer.simplices().len();
    let error = ClosedSurface::new(wrong.clone()).unwrap_err();
    assert_eq!(error, MeshError::InsideOut(Places(vec![first])));
    assert_eq!(ClosedSurface::oriented(&wrong).unwrap().moments(), hollow.moments());
}

#[test]
fn an_inside_out_surface_is_refused_and_repaired_on_request() {
    let surface = torus([2.0, 0.5], [12, 8]).unwrap();
    let right = ClosedSurface::new(surface.clone()).unwrap();
    let error = ClosedSurface::new(surface.reversed()).unwrap_err();
    assert_eq!(error, MeshError::InsideOut(Places(vec![0])));
    let repaired = ClosedSurface::oriented(&surface.reversed()).unwrap();
    assert!((repaired.moments().measure - right.moments().measure).abs() < 1e-14);
}

#[test]
fn what_is_wrong_with_a_surface_is_named() {
    let empty = Mesh::new(vec![], vec![]).unwrap();
    assert_eq!(ClosedSurface::new(empty), Err(MeshError::Empty));
    let sphere = icosphere(1.0, 1).unwrap();
    let open = Mesh::new(sphere.vertices().to_vec(), sphere.simplices()[1..].to_vec()).unwrap();
    let error = ClosedSurface::new(open).unwrap_err();
    assert!(matches!(error, MeshError::Open(edges) if edges.0.len() == 3));
    let flat = sphere.mapped(|x| Vector3::new(x.x, x.y, 0.0)).unwrap();
    let error = ClosedSurface::new(flat).unwrap_err();
    assert!(matches!(
        error,
        MeshError::NothingEnclosed(_) | MeshError::Degenerate(_) | MeshError::Overlapping(_)
    ));
    let two_sided = vec![[0, 1, 2], [0, 2, 1]];
    let corners = vec![Vector3::zeros(), Vector3::x(), Vector3::y()];
    let error = ClosedSurface::new(Mesh::new(corners, two_sided).unwrap()).unwrap_err();
    assert_eq!(error, MeshError::NothingEnclosed(Places(vec![0])));
    let moved = sphere.mapped(|x| x + Vector3::x() * 0.7).unwrap();
    let error = ClosedSurface::new(sphere.beside(&moved)).unwrap_err();
    assert!(matches!(error, MeshError::Overlapping(_)));
    let mut turned = sphere.simplices().to_vec();
    turned[3].swap(0, 1);
    let turned = Mesh::new(sphere.vertices().to_vec(), turned).unwrap();
    let error = ClosedSurface::new(turned).unwrap_err();
    assert!(matches!(error, MeshError::Inconsistent(edges) if edges.0.len() == 3));
}

#[test]
fn the_winding_number_is_one_inside_and_zero_outside() {
    let sphere = ClosedSurface::new(icosphere(1.0, 2).unwrap()).unwrap();
    for (radius, expected) in [(0.0, 1.0), (0.5, 1.0), (0.9, 1.0), (1.1, 0.0), (9.0, 0.0)] {
        let point = Vector3::new(0.6, -0.48, 0.64) * radius;
        assert!((sphere.winding_number(&point) - expected).abs() < 1e-12, "{radius}");
    }
}

proptest! {
    #[test]
    fn reversal_flips_every_moment_and_rotation_turns_them(
        axis in proptest::array::uniform3(-3.0..3.0_f64),
    ) {
        let surface = cube([1.0, 2.0, 3.0]);
        let cone = |mesh: &Mesh<3, 3>| {
            cone_moments(Vector3::zeros(), mesh.simplices().iter().map(|t| mesh.corners(t)))
        };
        let (here, turned_over) = (cone(&surface), cone(&surface.reversed()).negative());
        prop_assert!((here.measure - turned_over.measure).abs() < 1e-14);
        prop_assert!((here.first - turned_over.first).amax() < 1e-13);
        prop_assert!((here.second - turned_over.second).amax() < 1e-13);
        let turn = Rotation3::new(Vector3::from(axis));
        let there = cone(&surface.mapped(|x| turn * x).unwrap());
        prop_assert!((there.measure - here.measure).abs() < 1e-13);
        prop_assert!((there.first - turn * here.first).amax() < 1e-13);
        let second = turn.matrix() * here.second * turn.matrix().transpose();
        prop_assert!((there.second - second).amax() < 1e-12);
    }

    #[test]
    fn a_constant_field_has_no_flux_through_a_closed_surface(
        field in proptest::array::uniform3(-1.0..1.0_f64),
        shape in proptest::array::uniform3(0.5..2.0_f64),
    ) {
        let (shape, field) = (Vector3::from(shape), Vector3::from(field));
        let surface = torus([2.0, 0.5], [9, 7]).unwrap();
        let surface = surface.mapped(|x| x.component_mul(&shape)).unwrap();
        let flux: f64 = surface
            .simplices()
            .iter()
            .map(|t| surface.corners(t))
            .map(|[a, b, c]: [Vector3<f64>; 3]| (b - a).cross(&(c - a)).dot(&field) / 2.0)
            .sum();
        prop_assert!(flux.abs() < 1e-13);
    }
}
