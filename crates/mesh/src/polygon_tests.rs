use super::*;
use nalgebra::{Rotation2, Vector2};
use proptest::prelude::*;

fn outline(corners: &[[f64; 2]]) -> Vec<Vector2<f64>> {
    corners.iter().map(|&corner| corner.into()).collect()
}

fn rectangle(x: f64, y: f64, a: f64, b: f64) -> Vec<Vector2<f64>> {
    outline(&[[x, y], [x + a, y], [x + a, y + b], [x, y + b]])
}

/// A star-shaped outline around the origin.
fn star(radii: &[f64]) -> Vec<Vector2<f64>> {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / radii.len() as f64;
    radii
        .iter()
        .enumerate()
        .map(|(k, r)| Vector2::new(angle(k).cos(), angle(k).sin()) * *r)
        .collect()
}

#[test]
fn a_rectangle_has_its_textbook_moments_whichever_way_it_winds() {
    let mut corners = rectangle(1.0, 2.0, 3.0, 4.0);
    for _ in 0..2 {
        let moments = Polygon::new(vec![corners.clone()]).unwrap().moments();
        assert!((moments.measure - 12.0).abs() < 1e-14);
        let central = moments.central().unwrap();
        assert!((central.about - Vector2::new(2.5, 4.0)).amax() < 1e-15);
        assert!((central.second[(0, 0)] - 9.0).abs() < 1e-14, "a b^3/12 = 3^3 4/12");
        assert!((central.second[(1, 1)] - 16.0).abs() < 1e-14);
        assert!(central.second[(0, 1)].abs() < 1e-14);
        corners.reverse();
    }
}

#[test]
fn a_shape_that_is_not_convex_is_the_sum_of_its_rectangles() {
    let l = outline(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]);
    let whole = Polygon::new(vec![l]).unwrap().moments();
    let pieces = [rectangle(0.0, 0.0, 3.0, 1.0), rectangle(0.0, 1.0, 1.0, 3.0)];
    let pieces = pieces.map(|piece| Polygon::new(vec![piece]).unwrap().moments());
    let sum = pieces[0].with(&pieces[1]).seen_from(whole.about);
    assert!((whole.measure - sum.measure).abs() < 1e-14);
    assert!((whole.first - sum.first).amax() < 1e-14);
    assert!((whole.second - sum.second).amax() < 1e-13);
}

#[test]
fn holes_take_away_and_islands_in_them_add_whichever_way_they_wind() {
    let nested = [
        rectangle(2.0, 2.0, 1.0, 1.0),
        rectangle(0.0, 0.0, 6.0, 6.0),
        rectangle(1.0, 1.0, 3.0, 4.0),
    ];
    for reversed in 0..3 {
        let mut outlines = nested.to_vec();
        outlines[reversed].reverse();
        let polygon = Polygon::new(outlines).unwrap();
        assert_eq!(polygon.depths(), [2, 0, 1]);
        assert!((polygon.moments().measure - (36.0 - 12.0 + 1.0)).abs() < 1e-13);
        let signs = polygon.outlines().iter().map(|c| outline_moments(c).measure.signum());
        assert_eq!(signs.collect::<Vec<_>>(), [1.0, 1.0, -1.0]);
    }
}

#[test]
fn a_unit_square_a_million_metres_away_keeps_nine_digits() {
    let near = Polygon::new(vec![rectangle(0.0, 0.0, 1.0, 1.0)]).unwrap().moments();
    let far = Polygon::new(vec![rectangle(1e6, -1e6, 1.0, 1.0)]).unwrap().moments();
    assert_eq!(near.central().unwrap().second, far.central().unwrap().second);
    // Corners that no longer are where they were: the digits that the coordinates have left.
    let far = Polygon::new(vec![rectangle(1e6 + 0.1, -1e6 - 0.7, 1.0, 1.0)]).unwrap().moments();
    assert!((far.measure - 1.0).abs() < 1e-9);
    let second = far.central().unwrap().second;
    assert!((second - near.central().unwrap().second).amax() < 1e-9 / 12.0);
}

#[test]
fn points_are_inside_outside_or_on_the_edge() {
    let polygon =
        Polygon::new(vec![rectangle(0.0, 0.0, 4.0, 4.0), rectangle(1.0, 1.0, 2.0, 2.0)]).unwrap();
    for (point, inside) in [
        ([0.5, 0.5], true),
        ([2.0, 2.0], false),
        ([4.0, 4.0], true),
        ([2.0, 1.0], true),
        ([2.0, 1.0_f64.next_up()], false),
        ([-0.1, 0.0], false),
        ([5.0, 0.0], false),
    ] {
        assert_eq!(polygon.contains(&point.into()), inside, "{point:?}");
    }
}

#[test]
fn bad_outlines_are_named() {
    assert_eq!(Polygon::new(vec![]), Err(MeshError::Empty));
    let short = vec![rectangle(0.0, 0.0, 1.0, 1.0), outline(&[[5.0, 5.0], [6.0, 6.0]])];
    assert_eq!(Polygon::new(short), Err(MeshError::ShortOutline { outline: 1, corners: 2 }));
    let closed = outline(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
    assert_eq!(
        Polygon::new(vec![closed]),
        Err(MeshError::RepeatedCorner { outline: 0, corner: 0 })
    );
    let square = rectangle(0.0, 0.0, 1.0, 1.0);
    assert!(matches!(Polygon::new(vec![square.clone(), square]), Err(MeshError::Crossing(_))));
    let infinite = outline(&[[0.0, 0.0], [1.0, f64::INFINITY], [0.0, 1.0]]);
    assert!(matches!(Polygon::new(vec![infinite]), Err(MeshError::NonFinite { vertex: 1, .. })));
}

#[test]
fn the_boundary_keeps_the_region_on_its_left() {
    let outlines = vec![rectangle(0.0, 0.0, 4.0, 4.0), rectangle(1.0, 1.0, 2.0, 2.0)];
    let boundary = Polygon::new(outlines).unwrap().boundary();
    boundary.check_closed().unwrap();
    for segment in boundary.simplices() {
        let [p, q] = boundary.corners(segment);
        let left = Vector2::new(p.y - q.y, q.x - p.x).normalize() * 0.1;
        let within = (p + q) / 2.0 + left;
        assert!(within.iter().all(|x| (0.0..4.0).contains(x)));
        assert!(!within.iter().all(|x| (1.0..3.0).contains(x)));
    }
}

proptest! {
    #[test]
    fn area_and_polar_moment_do_not_notice_a_motion(
        radii in proptest::collection::vec(0.2..2.0_f64, 3..20),
        angle in -4.0..4.0_f64,
        shift in proptest::array::uniform2(-10.0..10.0_f64),
    ) {
        let corners = star(&radii);
        let turn = Rotation2::new(angle);
        let moved = corners.iter().map(|c| turn * c + Vector2::from(shift)).collect();
        let here = Polygon::new(vec![corners]).unwrap().moments().central().unwrap();
        let there = Polygon::new(vec![moved]).unwrap().moments().central().unwrap();
        prop_assert!((here.measure - there.measure).abs() < 1e-13 * here.measure.max(1.0));
        prop_assert!((here.polar() - there.polar()).abs() < 1e-12);
        prop_assert!((turn * here.about + Vector2::from(shift) - there.about).norm() < 1e-12);
    }

    #[test]
    fn the_printed_sums_of_the_notes_agree(
        radii in proptest::collection::vec(0.2..2.0_f64, 3..20),
    ) {
        let corners = star(&radii);
        let (mut area, mut first, mut polar) = (0.0, Vector2::zeros(), 0.0);
        for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let cross = p.perp(q);
            area += cross / 2.0;
            first += (p + q) * cross / 6.0;
            polar += (p.dot(p) + p.dot(q) + q.dot(q)) * cross / 12.0;
        }
        let got = Polygon::new(vec![corners]).unwrap().moments().seen_from(Vector2::zeros());
        prop_assert!((got.measure - area).abs() < 1e-13);
        prop_assert!((got.first - first).amax() < 1e-13);
        prop_assert!((got.polar() - polar).abs() < 1e-12);
    }
}

#[test]
fn a_point_with_a_coordinate_that_is_no_number_lies_nowhere() {
    let square = Polygon::new(vec![rectangle(0.0, 0.0, 1.0, 1.0)]).unwrap();
    assert!(square.contains(&Vector2::new(0.5, 0.5)));
    for point in [[f64::NAN, 0.5], [0.5, f64::NAN], [f64::NAN; 2], [f64::INFINITY, 0.5]] {
        assert!(!square.contains(&point.into()), "{point:?}");
    }
}

#[test]
fn outlines_too_small_for_products_of_their_coordinates_are_refused() {
    let size = 2.0_f64.powi(-1000);
    let small = rectangle(0.0, 0.0, 3.0 * size, size);
    let error = Polygon::new(vec![small]).unwrap_err();
    assert_eq!(error, MeshError::SmallOutline { outline: 0, size: 3.0 * size, least: 1e-100 });
    let least = Polygon::new(vec![rectangle(1e-100, 0.0, 2e-100, 1e-100)]).unwrap();
    assert!(least.contains(&Vector2::new(2e-100, 1e-101)));
    assert!(!least.contains(&Vector2::new(4e-100, 1e-101)));
    assert!((least.moments().measure / 2e-200 - 1.0).abs() < 1e-14);
}
