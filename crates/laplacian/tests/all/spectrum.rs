//! Eigenvalues against closed forms, on the line, the square, the disc and the sphere.

use nalgebra::{DMatrix, Vector2};
use stationary_calculus::{DenseSink, Metric, Potential};
use stationary_laplacian::problems::{
    Spectral, disc, interval, lumped_interval_spectrum, sphere, square,
};
use stationary_laplacian::{
    Domain, Elements, ExactHeat, LaplacianError, largest_eigenvalue, lowest_modes,
};
use stationary_measure::loglog_slope;
use stationary_mesh::{Diagonals, bar, rectangle};
use stationary_modal::ModalError;

#[test]
fn the_lumped_interval_has_its_closed_form() {
    let n = 60;
    let problem = interval(n).unwrap();
    let exact = lumped_interval_spectrum(n);
    let metric = problem.domain.lumped().unwrap();
    let modes = lowest_modes(&problem.domain, &metric, 10).unwrap();
    for (got, exact) in modes.values().iter().zip(&exact) {
        assert!((got - exact).abs() <= 1e-10 * exact, "{got} {exact}");
    }
    let mut matrix = vec![0.0; (n + 1) * (n + 1)];
    let mut sink = DenseSink::new(1.0, n + 1, &mut matrix).unwrap();
    problem.domain.dirichlet().add_hessian(&vec![0.0; n + 1], &mut sink);
    let mass = metric.masses();
    let scaled =
        DMatrix::from_fn(n + 1, n + 1, |i, j| matrix[i + (n + 1) * j] / (mass[i] * mass[j]).sqrt());
    let mut all = scaled.symmetric_eigenvalues().as_slice().to_vec();
    all.sort_by(f64::total_cmp);
    for (got, exact_value) in all.iter().zip(&exact) {
        assert!((got - exact_value).abs() < 1e-13 * exact[n], "{got} {exact_value}");
    }
    let largest = largest_eigenvalue(&metric, problem.domain.dirichlet()).unwrap();
    assert!((largest / exact[n] - 1.0).abs() < 1e-12);
}

/// The order at which an eigenvalue approaches that of the continuum, and the sign of the error
/// on the finer mesh.
fn order<const D: usize, const K: usize>(
    problem: impl Fn(usize) -> Result<Spectral<D, K>, LaplacianError>,
    sizes: [(usize, f64); 2],
    mode: usize,
) -> (f64, f64) {
    let error = |(fineness, h): (usize, f64)| {
        let problem = problem(fineness).unwrap();
        let metric = problem.domain.galerkin().unwrap();
        let modes = lowest_modes(&problem.domain, &metric, mode + 2).unwrap();
        (h, modes.values()[mode] - problem.spectrum[mode])
    };
    let errors = sizes.map(error);
    (loglog_slope(&errors.map(|(h, e)| (h, e.abs()))).unwrap(), errors[1].1.signum())
}

#[test]
fn galerkin_eigenvalues_approach_the_continuum_from_above_at_order_two() {
    let line = order(interval, [(20, 2.0), (40, 1.0)], 3);
    let plate = order(square, [(12, 2.0), (24, 1.0)], 4);
    let drum = order(disc, [(8, 2.0), (16, 1.0)], 5);
    for (order, sign) in [line, plate, drum] {
        assert!((order - 2.0).abs() < 0.1 && sign == 1.0, "{order} {sign}");
    }
    let (order, _) = order(sphere, [(2, 2.0), (3, 1.0)], 4);
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

#[test]
fn multiplicities_of_the_sphere_are_kept() {
    let problem = sphere(3).unwrap();
    let metric = problem.domain.lumped().unwrap();
    let modes = lowest_modes(&problem.domain, &metric, 16).unwrap();
    for (k, got) in modes.values().iter().enumerate() {
        let exact = problem.spectrum[k];
        assert!((got - exact).abs() <= 0.03 * exact, "{k}: {got} {exact}");
    }
    assert_eq!(modes.values()[0], 0.0);
}

#[test]
fn modes_carry_half_their_eigenvalue_of_energy_and_more_than_there_are_is_an_error() {
    let problem = square(6).unwrap();
    let metric = problem.domain.galerkin().unwrap();
    let modes = lowest_modes(&problem.domain, &metric, 8).unwrap();
    for k in 0..8 {
        let v = modes.vector(k).unwrap();
        assert!((metric.inner(v, v) - 1.0).abs() < 1e-12);
        let twice = 2.0 * problem.domain.dirichlet().energy(v.0);
        assert!((twice - modes.values()[k]).abs() < 1e-10);
    }
    for count in [0, 50] {
        let error = lowest_modes(&problem.domain, &metric, count).unwrap_err();
        assert!(matches!(error, LaplacianError::Modal(ModalError::Count { .. })));
    }
}

#[test]
fn where_vertices_are_held_no_constant_is_free_however_thin_the_cells_are() {
    for (thinnest, lowest) in [(1e-2, 2.4706), (1e-5, 2.470601), (1e-6, 2.4706)] {
        let layers = |y: f64| if y == 0.0 { 0.0 } else { f64::powf(thinnest, 1.0 - y) };
        let mesh = rectangle([1.0, 1.0], [12, 12], Diagonals::Same).unwrap();
        let mesh = mesh.mapped(|x| Vector2::new(x.x, layers(x.y))).unwrap();
        let left = mesh.vertices().iter().enumerate().filter(|(_, x)| x.x == 0.0);
        let held: Vec<(usize, f64)> = left.map(|(v, _)| (v, 0.0)).collect();
        let domain = Domain::held(Elements::of(&mesh).unwrap(), &held).unwrap();
        let metric = domain.galerkin().unwrap();
        let modes = lowest_modes(&domain, &metric, 2).unwrap();
        assert!((modes.values()[0] - lowest).abs() < 3e-4, "{thinnest}: {:?}", modes.values());
        // What was one all over has flowed out through the held side.
        let heat = ExactHeat::new(&modes, &metric, 1.0, &vec![1.0; domain.dim()]).unwrap();
        let late = heat.at(5.0).unwrap().into_iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        assert!(late < 2.0 * (-lowest * 5.0_f64).exp(), "{thinnest}: {late}");
    }
}

#[test]
fn of_several_pieces_those_of_which_nothing_is_held_have_their_constants() {
    let one = bar(1.0, 6).unwrap();
    let [two, three] = [3.0, 6.0].map(|x| one.mapped(|y| y.add_scalar(x)).unwrap());
    let three = one.beside(&two).beside(&three);
    for (held, constants) in
        [(vec![], 3), (vec![(8, 1.0)], 2), (vec![(0, 0.0), (7, 0.0), (20, 0.0)], 0)]
    {
        let domain = Domain::held(Elements::of(&three).unwrap(), &held).unwrap();
        let metric = domain.lumped().unwrap();
        let modes = lowest_modes(&domain, &metric, 4).unwrap();
        let zeros = modes.values().iter().take_while(|lambda| **lambda == 0.0).count();
        assert_eq!(zeros, constants);
        assert!(modes.values()[constants] > 1.0, "{:?}", modes.values());
    }
}
