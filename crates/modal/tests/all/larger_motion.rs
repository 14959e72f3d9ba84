//! Bodies on a subspace, and what few modes leave out of a motion.

use stationary_calculus::{
    Covector, DenseSink, DiagonalMetric, Potential, Sink, System, assert_derivatives,
};
use stationary_elasticity::{
    Freedoms, Lame, QuadraticTriangle, SaintVenantKirchhoff, Solid, lumped_mass,
};
use stationary_mesh::{Diagonals, QuadraticTriangles, rectangle};
use stationary_modal::problems::{fixed_chain, free_chain};
use stationary_modal::{Linearized, ModalError, Reduced, RigidMotions};

/// A bead in a bent valley: `1/2 x^2 + k/2 (y + x^2)^2`.
struct Valley(f64);

impl Potential for Valley {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * q[0] * q[0] + 0.5 * self.0 * (q[1] + q[0] * q[0]).powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let up = self.0 * (q[1] + q[0] * q[0]);
        dv.0[0] += q[0] + 2.0 * q[0] * up;
        dv.0[1] += up;
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let (k, x) = (self.0, q[0]);
        let xx = 1.0 + 2.0 * k * (q[1] + x * x) + 4.0 * k * x * x;
        hessian.add_symmetric(&[0, 1], &[xx, 2.0 * k * x, 2.0 * k * x, k]);
    }
}

#[test]
fn the_derivative_of_a_mode_is_the_curvature_of_the_valley_that_it_follows() {
    let (metric, valley) = (DiagonalMetric::new([1.0, 1.0]).unwrap(), Valley(100.0));
    let mut bead = Linearized::at(&metric, &valley, &[0.0, 0.0], 0.0).unwrap();
    let modes = bead.lowest(1, &RigidMotions::none()).unwrap();
    let line = bead.subspace(&modes).unwrap();
    let bent = bead.subspace_with_derivatives(&modes, 1e-3).unwrap();
    assert_eq!((line.dim(), bent.dim()), (1, 2));
    // y = -x^2 is v x + 1/2 theta x^2 with theta = (0, -2): the energy there is x^2/2 alone.
    let x: f64 = 0.4;
    let place = [x, -x * x];
    let a = bent.pulled_back(Covector(&place)).unwrap();
    let mut back = [0.0; 2];
    bent.configuration(&a.0, &mut back).unwrap();
    assert!(place.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!((bent.energy(&a.0) - 0.5 * x * x).abs() < 1e-12);
    // In the line alone it must climb the wall.
    assert!(line.energy(&[x]) > 1.0);
}

/// A clamped sheet of quadratic triangles that may turn.
fn sheet() -> (Solid<SaintVenantKirchhoff<2>, 6, 2, 2, 3>, DiagonalMetric<Vec<f64>>, Vec<f64>) {
    let mesh = rectangle([5.0, 1.0], [5, 1], Diagonals::Alternating).unwrap();
    let mesh = QuadraticTriangles::straight(&mesh);
    let nodes: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| (*x).into()).collect();
    let freedoms = Freedoms::held_where(&nodes, |x, _| x[0] == 0.0).unwrap();
    let lame = Lame::<3>::from_young_poisson(1.0, 0.3).unwrap().plane_stress();
    let rubber = SaintVenantKirchhoff::new(lame);
    let metric = lumped_mass(QuadraticTriangle, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let q = freedoms.gathered(&nodes).unwrap();
    (Solid::new(QuadraticTriangle, &mesh, 1.0, rubber, freedoms).unwrap(), metric, q)
}

#[test]
fn a_subspace_is_a_potential_with_the_right_derivatives_and_the_modes_eigenvalues() {
    let (solid, metric, q) = sheet();
    let mut near_rest = Linearized::at(&metric, &solid, &q, 1e-12).unwrap();
    let modes = near_rest.lowest(3, &RigidMotions::none()).unwrap();
    let subspace = near_rest.subspace_with_derivatives(&modes, 1e-2).unwrap();
    assert_eq!(subspace.dim(), 3 + 6);
    let a: Vec<f64> = (0..9).map(|k| 0.3 * (k as f64 + 1.0).sin()).collect();
    assert_derivatives(&subspace, &a);
    let r = subspace.dim();
    let mut hessian = vec![0.0; r * r];
    subspace.add_hessian(&vec![0.0; r], &mut DenseSink::new(1.0, r, &mut hessian).unwrap());
    for (i, lambda) in modes.values().iter().enumerate() {
        assert!((hessian[i * (r + 1)] / lambda - 1.0).abs() < 1e-9);
    }
    // It is half of a system: any integrator steps it.
    let unit = DiagonalMetric::new(vec![1.0; r]).unwrap();
    assert_eq!(System::new(unit, &subspace).unwrap().dim(), r);
}

#[test]
fn on_an_energy_of_degree_four_the_reach_of_the_differences_does_not_matter() {
    let (solid, metric, q) = sheet();
    let mut near_rest = Linearized::at(&metric, &solid, &q, 1e-12).unwrap();
    let modes = near_rest.lowest(2, &RigidMotions::none()).unwrap();
    let [near, far] =
        [1e-3, 1.0].map(|reach| near_rest.subspace_with_derivatives(&modes, reach).unwrap());
    // The same span: what one of them says of a place, the other does.
    for k in 0..near.dim() {
        let mut a = vec![0.0; near.dim()];
        a[k] = 0.1;
        let mut place = vec![0.0; q.len()];
        near.configuration(&a, &mut place).unwrap();
        let momentum: Vec<f64> =
            place.iter().zip(&q).zip(metric.masses()).map(|((x, q), m)| m * (x - q)).collect();
        let b = far.pulled_back(Covector(&momentum)).unwrap();
        let length: f64 = b.0.iter().map(|b| b * b).sum();
        assert!((length.sqrt() / 0.1 - 1.0).abs() < 1e-8, "{k}: {}", length.sqrt());
    }
}

#[test]
fn what_few_modes_leave_out_of_a_motion_stays_below_its_bound_at_all_times() {
    let n = 60;
    let problem = fixed_chain(n).unwrap();
    let mut chain = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12).unwrap();
    let all = chain.lowest(n, &RigidMotions::none()).unwrap();
    let load: Vec<f64> = (0..n).map(|i| if (12..30).contains(&i) { 1.0 } else { 0.0 }).collect();
    let observable: Vec<f64> = (0..n).map(|i| if i == 40 { 1.0 } else { 0.0 }).collect();
    let answer = chain.answer(&all, Covector(&load), Covector(&observable)).unwrap();
    let at = |count: usize, t: f64| {
        let mut few = all.clone();
        few.truncate(count);
        let mut body = Reduced::at_rest(&few);
        body.step(t, Covector(&load[..])).unwrap();
        let mut d = stationary_calculus::Vector(vec![0.0; n]);
        body.displacement(d.view_mut()).unwrap();
        d.0[40]
    };
    let mut close = f64::INFINITY;
    for count in [1, 2, 4, 8, 16, 32] {
        let times = (1..400).map(|k| 0.7 * f64::from(k));
        let worst = times.map(|t| (at(n, t) - at(count, t)).abs()).fold(0.0, f64::max);
        let bound = answer.bounds[count] * answer.whole.abs();
        assert!(worst <= bound, "{count}: {worst} {bound}");
        close = close.min(bound / worst);
    }
    assert!(close < 10.0, "a bound that says something: {close}");
    let least = answer.least_modes_in_motion(0.1).unwrap();
    assert!(answer.bounds[least] <= 0.1 && answer.bounds[least - 1] > 0.1);
    assert!(answer.least_modes_in_motion(1e-15).is_none());
}

#[test]
fn derivatives_of_a_body_that_is_not_held_are_refused() {
    let problem = free_chain(6).unwrap();
    let mut chain = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12).unwrap();
    let rigid =
        RigidMotions::of_points::<1>(&chain, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|x| [x])).unwrap();
    let modes = chain.lowest(2, &rigid).unwrap();
    let refused = chain.subspace_with_derivatives(&modes, 1e-3).unwrap_err();
    assert!(matches!(refused, ModalError::Stiffness(_)), "{refused}");
    let refused = chain.subspace_with_derivatives(&modes, f64::NAN).unwrap_err();
    assert!(matches!(refused, ModalError::Parameter { .. }), "{refused}");
    let mut none = modes.clone();
    none.truncate(0);
    assert_eq!(chain.subspace(&none).unwrap_err(), ModalError::Count { asked: 0, there: 6 });
    let subspace = chain.subspace(&modes).unwrap();
    assert!(subspace.configuration(&[0.0; 3], &mut [0.0; 6]).is_err());
    assert!(subspace.pulled_back(Covector(&[0.0; 5])).is_err());
}
