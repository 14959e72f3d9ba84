//! Heat in closed form, waves through the integrators, and the maximum principle on bad triangles.

use std::f64::consts::PI;

use nalgebra::Vector3;
use stationary_calculus::{Covector, System};
use stationary_integrators::{Integrator, State, StormerVerlet};
use stationary_laplacian::problems::{interval, square};
use stationary_laplacian::{
    Domain, Elements, ExactHeat, GeodesicDistance, Heat, HeatMethod, LaplacianError, harmonic,
    lowest_modes,
};
use stationary_mesh::{
    Diagonals, IntrinsicSurface, Mesh, MeshError, Places, bar, rectangle, torus,
};

#[test]
fn exact_heat_is_what_small_steps_approach_and_reaches_any_time() {
    let problem = square(5).unwrap();
    let metric = problem.domain.lumped().unwrap();
    let modes = lowest_modes(&problem.domain, &metric, problem.domain.dim()).unwrap();
    let f: Vec<f64> = (0..problem.domain.dim()).map(|k| ((k * k) as f64).sin()).collect();
    let exact = ExactHeat::new(&modes, &metric, 0.3, &f).unwrap();
    assert!(exact.left_out() < 1e-12);
    let back = exact.at(0.0).unwrap();
    assert!(back.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-12));
    let method = HeatMethod::CrankNicolson;
    let mut heat = Heat::new(&metric, problem.domain.dirichlet(), method, 0.3, 1e-4).unwrap();
    let mut stepped = f.clone();
    (0..1000).for_each(|_| heat.step(&mut stepped).unwrap());
    let at = exact.at(0.1).unwrap();
    assert!(at.iter().zip(&stepped).all(|(a, b)| (a - b).abs() < 1e-6));
    let late = exact.at(1e9).unwrap();
    assert!(late.iter().all(|x| (x - late[0]).abs() < 1e-13), "only the constant is left");
    assert!(matches!(exact.at(-1.0), Err(LaplacianError::Parameter { .. })));
}

#[test]
fn few_modes_leave_something_out_and_say_how_much() {
    let problem = interval(50).unwrap();
    let metric = problem.domain.lumped().unwrap();
    let modes = lowest_modes(&problem.domain, &metric, 6).unwrap();
    let step: Vec<f64> = (0..=50).map(|k| if k < 25 { 1.0 } else { 0.0 }).collect();
    let few = ExactHeat::new(&modes, &metric, 1.0, &step).unwrap();
    assert!(few.left_out() > 0.1);
    let all = lowest_modes(&problem.domain, &metric, 51).unwrap();
    let all = ExactHeat::new(&all, &metric, 1.0, &step).unwrap();
    let error = |t: f64| {
        let (few, all) = (few.at(t).unwrap(), all.at(t).unwrap());
        few.iter().zip(&all).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(error(0.05) < 1e-5 * error(0.0), "what is missing dies first");
}

#[test]
fn a_mode_of_a_string_swings_at_the_frequency_of_its_eigenvalue() {
    let (n, c) = (40, 3.0);
    let elements = Elements::of(&bar(1.0, n).unwrap()).unwrap().scaled(c * c).unwrap();
    let domain = Domain::held(elements, &[(0, 0.0), (n, 0.0)]).unwrap();
    let lambda = 4.0 * (n * n) as f64 * (0.5 * PI / n as f64).sin().powi(2);
    let omega = c * lambda.sqrt();
    let string = domain.elements().scaled(1.0 / (c * c)).unwrap();
    let mass = Domain::held(string, &[(0, 0.0), (n, 0.0)]).unwrap().lumped().unwrap();
    let system = System::new(mass, domain.dirichlet()).unwrap();
    let shape: Vec<f64> = (1..n).map(|k| (PI * k as f64 / n as f64).sin()).collect();
    let steps = 2000;
    let h = 2.0 * PI / omega / f64::from(steps);
    let mut verlet = StormerVerlet::new(&system).unwrap();
    let mut state = State::new(shape.clone(), Covector(vec![0.0; n - 1]));
    for _ in 0..steps {
        verlet.step(&mut state, h).unwrap();
    }
    assert!(state.q.iter().zip(&shape).all(|(a, b)| (a - b).abs() < 1e-5));
    assert!((omega / (c * PI) - 1.0).abs() < 1e-3, "and that is close to the string's");
}

/// A torus drawn out and sheared: closed, with angles far beyond a right one.
fn sheared_torus() -> Mesh<3, 3> {
    let torus = torus([2.0, 0.7], [24, 12]).unwrap();
    torus.mapped(|x| Vector3::new(x.x, x.y, 3.0 * x.z + 2.0 * x.y)).unwrap()
}

/// The smallest value within a few steps from a spike at one vertex.
fn lowest(domain: &Domain<3>, method: HeatMethod, h: f64, spike: usize) -> f64 {
    let metric = domain.lumped().unwrap();
    let mut heat = Heat::new(&metric, domain.dirichlet(), method, 1.0, h).unwrap();
    let mut f = vec![0.0; domain.dim()];
    f[spike] = 1.0;
    let mut lowest = 0.0_f64;
    for _ in 0..5 {
        heat.step(&mut f).unwrap();
        lowest = f.iter().copied().fold(lowest, f64::min);
    }
    lowest
}

#[test]
fn plain_cotangents_break_the_maximum_principle_and_delaunay_edges_keep_it() {
    let mesh = sheared_torus();
    let plain = Domain::free(Elements::of(&mesh).unwrap()).unwrap();
    let mut surface = IntrinsicSurface::of(&mesh).unwrap();
    surface.flip_to_delaunay().unwrap();
    let delaunay = Domain::free(Elements::of_surface(&surface).unwrap()).unwrap();
    let worst = |domain: &Domain<3>, method: HeatMethod, h: f64| {
        (0..mesh.vertices().len()).map(|s| lowest(domain, method, h, s)).fold(0.0, f64::min)
    };
    let plain = worst(&plain, HeatMethod::ImplicitEuler, 0.02);
    assert!(plain < -1e-4, "{plain:e}");
    assert!(worst(&delaunay, HeatMethod::ImplicitEuler, 0.02) > -1e-15);
    let ringing = worst(&delaunay, HeatMethod::CrankNicolson, 1.0);
    assert!(ringing < -1e-2, "{ringing:e}");
}

#[test]
fn splits_keep_the_maximum_principle_on_a_surface_with_a_boundary() {
    let sheared = |x: &nalgebra::Vector2<f64>| Vector3::new(4.0 * x.x + 3.0 * x.y, 0.5 * x.y, 0.0);
    let mesh = rectangle([1.0, 1.0], [8, 8], Diagonals::Same).unwrap().mapped(sheared).unwrap();
    let mut surface = IntrinsicSurface::of(&mesh).unwrap();
    surface.flip_to_delaunay().unwrap();
    let worst = |surface: &IntrinsicSurface| {
        let domain = Domain::free(Elements::of_surface(surface).unwrap()).unwrap();
        let spikes = 0..mesh.vertices().len();
        let of = |spike| lowest(&domain, HeatMethod::ImplicitEuler, 0.02, spike);
        spikes.map(of).fold(0.0, f64::min)
    };
    assert!(worst(&surface) < -1e-4, "flips alone do not do");
    let splits = surface.split_obtuse_boundary().unwrap();
    assert!(!splits.is_empty() && worst(&surface) > -1e-15);
}

#[test]
fn galerkin_mass_breaks_the_maximum_principle_at_a_short_step() {
    let problem = interval(20).unwrap();
    let metric = problem.domain.galerkin().unwrap();
    let method = HeatMethod::ImplicitEuler;
    let mut heat = Heat::new(&metric, problem.domain.dirichlet(), method, 1.0, 1e-5).unwrap();
    let mut f = vec![0.0; 21];
    f[10] = 1.0;
    heat.step(&mut f).unwrap();
    assert!(f.iter().copied().fold(0.0, f64::min) < -1e-3);
}

#[test]
fn mixed_boundaries_give_the_straight_line_between_what_is_held() {
    let problem = square(8).unwrap();
    let numbered = problem.mesh.vertices().iter().enumerate();
    let sides = numbered.filter(|(_, x)| x.x == 0.0 || x.x == 1.0);
    let held: Vec<(usize, f64)> = sides.map(|(v, x)| (v, 2.0 * x.x)).collect();
    let domain = Domain::held(Elements::of(&problem.mesh).unwrap(), &held).unwrap();
    let u = harmonic(&domain).unwrap();
    assert!(u.iter().zip(problem.mesh.vertices()).all(|(u, x)| (u - 2.0 * x.x).abs() < 1e-13));
    // Heat comes to rest there, from anywhere.
    let metric = domain.galerkin().unwrap();
    let mut f = vec![5.0; domain.dim()];
    let method = HeatMethod::ImplicitEuler;
    let mut heat = Heat::new(&metric, domain.dirichlet(), method, 1.0, 10.0).unwrap();
    (0..20).for_each(|_| heat.step(&mut f).unwrap());
    let rest = domain.on_vertices(&f).unwrap();
    assert!(rest.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-13));
}

#[test]
fn a_mode_that_is_not_there_grows_from_rounding_beyond_the_explicit_border() {
    let n = 32;
    let problem = interval(n).unwrap();
    let metric = problem.domain.lumped().unwrap();
    let h = 1.05 / (2 * n * n) as f64;
    let method = HeatMethod::ExplicitEuler;
    let mut heat = Heat::new(&metric, problem.domain.dirichlet(), method, 1.0, h).unwrap();
    let mut f: Vec<f64> = (0..=n).map(|k| (PI * k as f64 / n as f64).cos()).collect();
    let growth = method.amplification(-h * (4 * n * n) as f64).abs();
    let steps = (1e16_f64.ln() / growth.ln()) as usize;
    (0..steps / 4).for_each(|_| heat.step(&mut f).unwrap());
    assert!(f.iter().all(|x| x.abs() < 1.1), "nothing to be seen at first");
    (0..2 * steps).for_each(|_| heat.step(&mut f).unwrap());
    assert!(f.iter().any(|x| x.abs() > 1e3), "then the fastest mode takes over");
}

#[test]
fn a_torus_of_one_cell_has_no_mass_of_either_kind() {
    let torus = IntrinsicSurface::flat_torus([1.0, 1.0], [1, 1]).unwrap();
    let domain = Domain::free(Elements::of_surface(&torus).unwrap()).unwrap();
    let expected = LaplacianError::Mesh(MeshError::RepeatedVertex(Places(vec![0, 1])));
    assert_eq!(domain.lumped().unwrap_err(), expected);
    assert_eq!(domain.galerkin().unwrap_err(), expected);
    // One cell around the tube: each triangle has a side from a vertex to itself.
    let ring = IntrinsicSurface::flat_torus([1.0, 1.0], [3, 1]).unwrap();
    let error = GeodesicDistance::new(&ring, 1.0).unwrap_err();
    assert_eq!(error, LaplacianError::Mesh(MeshError::RepeatedVertex(Places((0..6).collect()))));
}
