//! Published answers, and the order at which elements reach the exact ones.

use stationary_elasticity::problems::{
    Beam, Errors, LE1_STRESS, PlaneWaves, SheetFamily, elliptic_membrane_stress,
    manufactured_errors,
};
use stationary_elasticity::{
    ElasticityError, Lame, LinearSegment, LinearTetrahedron, LinearTriangle, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle,
};
use stationary_mesh::{
    Diagonals, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, bar, cuboid, rectangle,
};

fn lame() -> Lame<3> {
    Lame::from_young_poisson(1.0, 0.3).unwrap()
}

/// Orders in the displacement and in the energy norm, from one mesh to one of half the size.
fn assert_orders(coarse: Errors, fine: Errors, expected: [f64; 2]) {
    let orders =
        [(coarse.displacement / fine.displacement).log2(), (coarse.energy / fine.energy).log2()];
    assert!((orders[0] - expected[0]).abs() < 0.3, "{orders:?}");
    assert!((orders[1] - expected[1]).abs() < 0.15, "{orders:?}");
}

#[test]
fn elements_on_a_line_converge_at_their_order() {
    let waves = PlaneWaves { amplitude: 0.1, waves: [[5.0]] };
    let pair = lame().uniaxial_stress();
    let linear = |cells| {
        manufactured_errors(LinearSegment, &bar(1.0, cells).unwrap(), pair, &waves).unwrap()
    };
    let quadratic = |cells| {
        let mesh = QuadraticSegments::straight(&bar(1.0, cells).unwrap());
        manufactured_errors(QuadraticSegment, &mesh, pair, &waves).unwrap()
    };
    assert_orders(linear(16), linear(32), [2.0, 1.0]);
    assert_orders(quadratic(16), quadratic(32), [3.0, 2.0]);
}

#[test]
fn a_displacement_that_is_zero_or_overflows_has_no_relative_error() {
    let mesh = bar(1.0, 4).unwrap();
    let errors = |amplitude: f64, wave: f64| {
        let waves = PlaneWaves { amplitude, waves: [[wave]] };
        manufactured_errors(LinearSegment, &mesh, lame().uniaxial_stress(), &waves)
    };
    for (amplitude, wave) in [(0.0, 5.0), (1e-150, 5.0), (0.1, 0.0)] {
        let error = errors(amplitude, wave).unwrap_err();
        assert!(matches!(error, ElasticityError::Integral { .. }), "{amplitude}, {wave}: {error}");
    }
    for (amplitude, wave) in [(1e160, 5.0), (f64::NAN, 5.0), (0.1, f64::NAN)] {
        assert!(errors(amplitude, wave).is_err(), "{amplitude}, {wave}");
    }
    let found = errors(1e-3, 5.0).unwrap();
    assert!(found.displacement > 0.0 && found.displacement < 0.2, "{found:?}");
}

#[test]
fn triangles_converge_at_their_order() {
    let waves = PlaneWaves { amplitude: 0.1, waves: [[3.0, 2.0], [-1.5, 2.5]] };
    let pair = lame().plane_stress();
    let mesh = |cells| rectangle([1.0, 1.0], [cells, cells], Diagonals::Alternating).unwrap();
    let linear = |cells| manufactured_errors(LinearTriangle, &mesh(cells), pair, &waves).unwrap();
    let quadratic = |cells| {
        let mesh = QuadraticTriangles::straight(&mesh(cells));
        manufactured_errors(QuadraticTriangle, &mesh, pair, &waves).unwrap()
    };
    assert_orders(linear(8), linear(16), [2.0, 1.0]);
    assert_orders(quadratic(8), quadratic(16), [3.0, 2.0]);
}

#[test]
fn tetrahedra_converge_at_their_order() {
    let waves =
        PlaneWaves { amplitude: 0.1, waves: [[3.0, 2.0, 1.0], [-1.5, 2.5, 1.0], [1.0, -2.0, 2.0]] };
    let mesh = |cells| cuboid([1.0; 3], [cells; 3]).unwrap();
    let linear =
        |cells| manufactured_errors(LinearTetrahedron, &mesh(cells), lame(), &waves).unwrap();
    let quadratic = |cells| {
        let mesh = QuadraticTetrahedra::straight(&mesh(cells));
        manufactured_errors(QuadraticTetrahedron, &mesh, lame(), &waves).unwrap()
    };
    assert_orders(linear(5), linear(10), [2.0, 1.0]);
    assert_orders(quadratic(3), quadratic(6), [3.0, 2.0]);
}

#[test]
fn the_elliptic_membrane_has_the_published_stress() {
    let error = |family, n: usize| {
        let sheet = elliptic_membrane_stress(family, [2 * n, 3 * n]).unwrap();
        sheet.value / LE1_STRESS - 1.0
    };
    let quadratic = [4, 8, 16].map(|n| error(SheetFamily::Quadratic, n));
    assert!(quadratic[2].abs() < 6e-3, "{quadratic:?}");
    assert!(quadratic.windows(2).all(|pair| pair[1].abs() < 0.4 * pair[0].abs()), "{quadratic:?}");
    let linear = [8, 16].map(|n| error(SheetFamily::Linear, n));
    assert!(linear[0].abs() > 3.0 * quadratic[1].abs(), "{linear:?} {quadratic:?}");
    assert!(linear[1].abs() < 0.7 * linear[0].abs(), "{linear:?}");
}

#[test]
fn a_cantilever_bends_as_timoshenko_says_and_linear_triangles_too_little() {
    let diagonals = Diagonals::Alternating;
    let beam = Beam { size: [10.0, 1.0], lame: lame().plane_stress(), push: 1e-3, diagonals };
    let of = |family, cells| beam.solved(family, cells).unwrap().value / beam.deflection();
    assert!((of(SheetFamily::Quadratic, [40, 4]) - 1.0).abs() < 3e-3);
    let linear = of(SheetFamily::Linear, [40, 4]);
    assert!(linear < 0.93 && linear > 0.7, "{linear}");
}

#[test]
fn linear_triangles_lock_as_the_material_becomes_incompressible_and_quadratic_ones_do_not() {
    let ratio = |family, poisson| {
        let lame = Lame::<3>::from_young_poisson(1.0, poisson).unwrap().plane_strain();
        let diagonals = Diagonals::Same;
        let beam = Beam { size: [10.0, 1.0], lame, push: 1e-3, diagonals };
        beam.solved(family, [20, 4]).unwrap().value / beam.deflection()
    };
    let linear = [0.3, 0.4999].map(|nu| ratio(SheetFamily::Linear, nu));
    let quadratic = [0.3, 0.4999].map(|nu| ratio(SheetFamily::Quadratic, nu));
    assert!(linear[1] < 0.5 * linear[0], "{linear:?}");
    assert!(quadratic[1] > 0.93, "{quadratic:?}");
}
