//! From shapes to bodies: the moments of polygons and surfaces, made mass.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use stationary_mesh::{ClosedSurface, Mesh, Moments, Polygon, bar, cuboid, icosphere};
use stationary_rigid::{
    Body, LieGroup, PlanarMass, PlanarMotion, RigidError, RigidMotion, Rotation, SpatialMass,
};

fn rectangle(x: f64, y: f64, a: f64, b: f64) -> Vec<Vector2<f64>> {
    [[x, y], [x + a, y], [x + a, y + b], [x, y + b]].map(Vector2::from).to_vec()
}

fn plate(density: f64, outlines: &[&[Vector2<f64>]]) -> PlanarMass {
    let outlines = outlines.iter().map(|corners| corners.to_vec()).collect();
    PlanarMass::of(density, &Polygon::new(outlines).unwrap().moments()).unwrap()
}

fn block(corner: [f64; 3], size: [f64; 3]) -> Mesh<3, 3> {
    let surface = cuboid(size, [1; 3]).unwrap().boundary().mesh;
    surface.mapped(|x| x + Vector3::from(corner)).unwrap()
}

fn solid(density: f64, surface: Mesh<3, 3>) -> SpatialMass {
    SpatialMass::of(density, &ClosedSurface::new(surface).unwrap().moments()).unwrap()
}

#[test]
fn a_rectangle_has_its_textbook_inertia_whichever_way_it_winds() {
    let mut shape = rectangle(1.0, 2.0, 3.0, 4.0);
    for _ in 0..2 {
        let got = plate(2.0, &[&shape]);
        assert!((got.mass - 24.0).abs() < 1e-14);
        assert!((got.centre - Vector2::new(2.5, 4.0)).norm() < 1e-15);
        assert!((got.inertia - 24.0 * 25.0 / 12.0).abs() < 1e-13);
        assert!((got.about(&Vector2::new(1.0, 2.0)) - 24.0 * 25.0 / 3.0).abs() < 1e-12);
        shape.reverse();
    }
}

#[test]
fn a_shape_that_is_not_convex_is_the_sum_of_its_pieces() {
    let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
    let whole = plate(1.5, &[&l.map(Vector2::from)]);
    let pieces = [rectangle(0.0, 0.0, 3.0, 1.0), rectangle(0.0, 1.0, 1.0, 3.0)];
    let sum = PlanarMass::composite(&pieces.map(|piece| plate(1.5, &[&piece]))).unwrap();
    assert!((whole.mass - sum.mass).abs() < 1e-14);
    assert!((whole.centre - sum.centre).norm() < 1e-15);
    assert!((whole.inertia - sum.inertia).abs() < 1e-13);
}

#[test]
fn a_hole_takes_away_and_an_island_in_it_adds() {
    let (outer, hole) = (rectangle(0.0, 0.0, 6.0, 6.0), rectangle(1.0, 1.0, 3.0, 4.0));
    let island = rectangle(2.0, 2.0, 1.0, 1.0);
    let got = plate(1.0, &[&island, &hole, &outer]);
    assert!((got.mass - (36.0 - 12.0 + 1.0)).abs() < 1e-13);
    let one = |shape: &[Vector2<f64>]| plate(1.0, &[shape]).about(&Vector2::zeros());
    let expected = one(&outer) - one(&hole) + one(&island);
    assert!((got.about(&Vector2::zeros()) - expected).abs() < 1e-12);
}

#[test]
fn a_plate_far_from_the_origin_loses_no_digit() {
    let near = plate(1.0, &[&rectangle(0.0, 0.0, 1.0, 1.0)]);
    let far = plate(1.0, &[&rectangle(1e6, -1e6, 1.0, 1.0)]);
    assert!((far.inertia - near.inertia).abs() < 1e-15);
    let by = PlanarMotion::exp(Vector3::new(1e6, -1e6, 0.0));
    assert!((near.moved(&by).centre - far.centre).norm() < 1e-9);
}

#[test]
fn a_box_has_its_textbook_inertia() {
    let got = solid(1.0 / 0.048, block([1.0, -2.0, 0.5], [0.2, 0.4, 0.6]));
    assert!((got.mass - 1.0).abs() < 1e-14);
    assert!((got.centre - Vector3::new(1.1, -1.8, 0.8)).norm() < 1e-14);
    let (body, pose) = got.body().unwrap();
    let textbook = Body::solid_box(1.0, [0.3, 0.2, 0.1]).unwrap();
    assert!((body.moments() - textbook.moments()).amax() < 1e-14, "ascending");
    assert!((pose.translation - got.centre).norm() == 0.0);
}

#[test]
fn a_moved_solid_has_the_moved_properties_and_pieces_add_up() {
    let motion = RigidMotion {
        translation: Vector3::new(0.3, -0.4, 2.0),
        rotation: Rotation::exp(Vector3::new(0.4, 1.0, -2.0)),
    };
    let whole = solid(2.0, block([0.0; 3], [1.0, 2.0, 3.0]));
    let got = solid(2.0, block([0.0; 3], [1.0, 2.0, 3.0]).mapped(|x| motion.apply(x)).unwrap());
    let expected = whole.moved(&motion);
    assert!((got.centre - expected.centre).norm() < 1e-14);
    assert!((got.inertia - expected.inertia).amax() < 1e-13);
    let halves = [0.0, 1.0].map(|y| solid(2.0, block([0.0, y, 0.0], [1.0, 1.0, 3.0])));
    let sum = SpatialMass::composite(&halves).unwrap();
    assert!((sum.centre - whole.centre).norm() < 1e-15);
    assert!((sum.inertia - whole.inertia).amax() < 1e-13);
}

#[test]
fn a_fine_sphere_approaches_two_fifths_m_r_squared_with_the_square_of_the_mesh_size() {
    let error = |levels: usize| {
        let got = solid(1.0, icosphere(1.0, levels).unwrap());
        (got.inertia[(0, 0)] / (8.0 * std::f64::consts::PI / 15.0) - 1.0).abs()
    };
    let slope = (error(2) / error(3)).log2();
    assert!((slope - 2.0).abs() < 0.05, "{slope}");
}

#[test]
fn what_no_body_can_be_made_of_is_refused() {
    let square = Polygon::new(vec![rectangle(0.0, 0.0, 1.0, 1.0)]).unwrap().moments();
    for density in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(PlanarMass::of(density, &square), Err(RigidError::Density(density)));
    }
    let hole = square.negative();
    assert_eq!(PlanarMass::of(1.0, &hole), Err(RigidError::NoMeasure { measure: -1.0 }));
    let nothing = Moments::<3>::zero(Vector3::zeros());
    assert_eq!(SpatialMass::of(1.0, &nothing), Err(RigidError::NoMeasure { measure: 0.0 }));
    let rod = bar(2.0, 3).unwrap().mapped(|x| Vector3::new(0.0, 0.0, x.x)).unwrap();
    let rod = SpatialMass::of(3.0, &rod.moments()).unwrap();
    assert!((rod.mass - 6.0).abs() < 1e-14, "a rod has mass, by its length");
    assert!(matches!(rod.body(), Err(RigidError::Moment { .. })), "but no inertia about itself");
}

#[test]
fn a_mass_or_an_inertia_out_of_range_is_refused_where_the_shape_is_given_its_density() {
    let moments = |measure: f64, second: f64| Moments::<3> {
        about: Vector3::zeros(),
        measure,
        first: Vector3::zeros(),
        second: Matrix3::identity() * second,
    };
    let plane = |measure: f64, second: f64| Moments::<2> {
        about: Vector2::zeros(),
        measure,
        first: Vector2::zeros(),
        second: Matrix2::identity() * second,
    };
    for (density, measure, mass) in [(1e300, 1e10, f64::INFINITY), (1e-200, 1e-200, 0.0)] {
        let expected = RigidError::Mass(mass);
        assert_eq!(SpatialMass::of(density, &moments(measure, 1.0)), Err(expected));
        assert_eq!(PlanarMass::of(density, &plane(measure, 1.0)), Err(expected));
    }
    let error = SpatialMass::of(1e150, &moments(1.0, 1e200)).unwrap_err();
    assert!(matches!(error, RigidError::NonFinite { what: "the inertia", .. }), "{error}");
    let error = PlanarMass::of(1e150, &plane(1.0, 1e200)).unwrap_err();
    assert!(matches!(error, RigidError::NonFinite { what: "the inertia", .. }), "{error}");
}

#[test]
fn an_inertia_that_is_not_symmetric_is_refused_by_its_entry_and_rounding_is_not() {
    let mass = solid(2.0, block([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]));
    let turn = Rotation::exp(Vector3::new(0.3, -1.1, 0.7));
    let mut moved = mass.moved(&RigidMotion { translation: Vector3::x(), rotation: turn });
    moved.body().unwrap();
    moved.inertia[(2, 0)] += 1e-3;
    let error = moved.body().unwrap_err();
    assert!(matches!(error, RigidError::NotSymmetric { row: 2, column: 0, .. }), "{error}");
}
