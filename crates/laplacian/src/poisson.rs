//! Poisson's problem, and functions that are harmonic.
//!
//! ```text
//! -Lap u = s:    dV(u) = M s,  u = g where held          harmonic: s = 0
//! ```
//! `s` the source on the free vertices (n), `u` m^2 times its unit, `g` the held values. A piece
//! where nothing is held has a solution only if its source adds up to nothing; then of all
//! solutions, which differ by a constant, the one of mean zero is given. Factored once for any
//! number of sources. With plain cotangents a harmonic function may leave the range of its held
//! values on obtuse triangles; with weights that are nowhere negative it cannot. Source: notes
//! 15.2-15.3.

use stationary_calculus::{
    Covector, Metric, Potential, SizeError, SparseCholesky, SymmetricMatrix, Vector,
};

use crate::error::check_finite;
use crate::{Domain, LaplacianError};

/// Poisson's problem on a domain, factored.
#[derive(Debug)]
pub struct Poisson<'a, const K: usize, M> {
    domain: &'a Domain<K>,
    metric: &'a M,
    grounded: Grounded,
}

/// The Hessian of the energy, factored, with a freedom held at zero in each piece that is held
/// nowhere.
#[derive(Debug)]
pub(crate) struct Grounded {
    factor: SparseCholesky,
    /// For each such piece its freedoms, the first of which stays at zero.
    floating: Vec<Vec<usize>>,
}

impl Grounded {
    pub(crate) fn new<const K: usize>(domain: &Domain<K>) -> Result<Self, LaplacianError> {
        let floating = floating(domain);
        let matrix = grounded(domain, &floating)?;
        let mut factor = SparseCholesky::analyse(&matrix)?;
        factor.factor(&matrix)?;
        Ok(Grounded { factor, floating })
    }

    /// From a load that is balanced on each floating piece to a function with it.
    pub(crate) fn solve(&mut self, load: &mut [f64]) {
        for piece in &self.floating {
            load[piece[0]] = 0.0;
        }
        self.factor.solve(load);
    }
}

/// A source may add up to this part of the sum of its sizes.
const BALANCED: f64 = 1e-10;

impl<'a, const K: usize, M: Metric> Poisson<'a, K, M> {
    /// Factors the problem.
    ///
    /// # Errors
    /// [`LaplacianError::Size`] and [`LaplacianError::Sparse`].
    pub fn new(domain: &'a Domain<K>, metric: &'a M) -> Result<Self, LaplacianError> {
        SizeError::check("the metric's freedoms", domain.dim(), metric.dim())?;
        Ok(Poisson { domain, metric, grounded: Grounded::new(domain)? })
    }

    /// The solution on the free vertices.
    ///
    /// # Errors
    /// [`LaplacianError::Incompatible`], [`LaplacianError::Size`] and
    /// [`LaplacianError::NonFinite`].
    pub fn solve(&mut self, source: &[f64]) -> Result<Vec<f64>, LaplacianError> {
        SizeError::check("the source's values", self.domain.dim(), source.len())?;
        let mut load = Covector(vec![0.0; source.len()]);
        self.metric.flat(Vector(source), load.view_mut());
        self.solve_load(load)
    }

    /// The solution of `dV(u) = load`: for sources that are known by their integrals.
    ///
    /// # Errors
    /// Those of [`Poisson::solve`].
    pub fn solve_load(&mut self, load: Covector<Vec<f64>>) -> Result<Vec<f64>, LaplacianError> {
        SizeError::check("the load's values", self.domain.dim(), load.0.len())?;
        check_finite(&load.0)?;
        self.check_balanced(&load.0)?;
        let zero = vec![0.0; load.0.len()];
        let mut held = Covector(zero.clone());
        self.domain.dirichlet().add_differential(&zero, held.view_mut());
        let mut u: Vec<f64> = load.0.iter().zip(&held.0).map(|(load, held)| load - held).collect();
        self.grounded.solve(&mut u);
        check_finite(&u)?;
        self.remove_means(&mut u);
        Ok(u)
    }

    fn check_balanced(&self, load: &[f64]) -> Result<(), LaplacianError> {
        for piece in &self.grounded.floating {
            let total: f64 = piece.iter().map(|&freedom| load[freedom]).sum();
            let size: f64 = piece.iter().map(|&freedom| load[freedom].abs()).sum();
            if total.abs() > BALANCED * size {
                let vertex = self.domain.free_vertices()[piece[0]];
                return Err(LaplacianError::Incompatible { vertex, total });
            }
        }
        Ok(())
    }

    /// Takes from each floating piece its mean in the mass.
    fn remove_means(&self, u: &mut [f64]) {
        for piece in &self.grounded.floating {
            let mut on_piece = vec![0.0; u.len()];
            piece.iter().for_each(|&freedom| on_piece[freedom] = 1.0);
            let measure = self.metric.inner(Vector(&on_piece), Vector(&on_piece));
            let mean = self.metric.inner(Vector(&on_piece), Vector(u)) / measure;
            piece.iter().for_each(|&freedom| u[freedom] -= mean);
        }
    }
}

/// The harmonic function with the domain's held values, on all vertices.
///
/// # Errors
/// [`LaplacianError::NothingHeld`], and those of [`Poisson::solve`].
pub fn harmonic<const K: usize>(domain: &Domain<K>) -> Result<Vec<f64>, LaplacianError> {
    let metric = domain.lumped()?;
    let mut poisson = Poisson::new(domain, &metric)?;
    if let Some(piece) = poisson.grounded.floating.first() {
        return Err(LaplacianError::NothingHeld(domain.free_vertices()[piece[0]]));
    }
    let u = poisson.solve_load(Covector(vec![0.0; domain.dim()]))?;
    domain.on_vertices(&u)
}

/// The freedoms of each piece where nothing is held.
fn floating<const K: usize>(domain: &Domain<K>) -> Vec<Vec<usize>> {
    let roots = domain.pieces();
    let mut holds = vec![false; roots.len()];
    for (vertex, &root) in roots.iter().enumerate() {
        holds[root] |= domain.is_held(vertex);
    }
    let mut pieces = std::collections::BTreeMap::<usize, Vec<usize>>::new();
    for (freedom, &vertex) in domain.free_vertices().iter().enumerate() {
        if !holds[roots[vertex]] {
            pieces.entry(roots[vertex]).or_default().push(freedom);
        }
    }
    pieces.into_values().collect()
}

/// The Hessian with the first freedom of each floating piece held at zero.
fn grounded<const K: usize>(
    domain: &Domain<K>,
    floating: &[Vec<usize>],
) -> Result<SymmetricMatrix, LaplacianError> {
    let mut grounds = vec![false; domain.dim()];
    floating.iter().for_each(|piece| grounds[piece[0]] = true);
    let place = |vertex: usize| {
        let free = vertex < grounds.len() && !grounds[vertex];
        if free { vertex } else { stationary_calculus::FIXED }
    };
    let elements = domain.dirichlet().stencils().iter();
    let mut blocks: Vec<(Vec<usize>, Vec<f64>)> = elements
        .map(|e| (e.vertices.map(place).to_vec(), e.weights.as_flattened().to_vec()))
        .collect();
    blocks.extend(floating.iter().map(|piece| (vec![piece[0]], vec![1.0])));
    Ok(SymmetricMatrix::from_blocks(domain.dim(), &blocks)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Elements;
    use stationary_measure::loglog_slope;
    use stationary_mesh::{Diagonals, Mesh, bar, cuboid, icosphere, rectangle};
    use std::f64::consts::PI;

    fn boundary_values(mesh: &Mesh<2, 3>, g: impl Fn(f64, f64) -> f64) -> Vec<(usize, f64)> {
        let value = |&v: &usize| (v, g(mesh.vertices()[v].x, mesh.vertices()[v].y));
        mesh.boundary().vertices.iter().map(value).collect()
    }

    #[test]
    fn a_linear_function_is_harmonic_to_rounding() {
        let mesh = rectangle([1.0, 2.0], [5, 4], Diagonals::Alternating).unwrap();
        let g = |x: f64, y: f64| 3.0 * x - y + 0.5;
        let values = boundary_values(&mesh, g);
        let domain = Domain::held(Elements::of(&mesh).unwrap(), &values).unwrap();
        let u = harmonic(&domain).unwrap();
        assert!(u.iter().zip(mesh.vertices()).all(|(u, p)| (u - g(p.x, p.y)).abs() < 1e-13));
        let solid = cuboid([1.0; 3], [3, 3, 3]).unwrap();
        let boundary = solid.boundary().vertices;
        let values: Vec<_> = boundary.iter().map(|&v| (v, solid.vertices()[v].sum())).collect();
        let domain = Domain::held(Elements::of(&solid).unwrap(), &values).unwrap();
        let u = harmonic(&domain).unwrap();
        assert!(u.iter().zip(solid.vertices()).all(|(u, p)| (u - p.sum()).abs() < 1e-13));
    }

    #[test]
    fn a_manufactured_solution_is_met_at_order_two() {
        let error = |n: usize| {
            let mesh = rectangle([1.0, 1.0], [n, n], Diagonals::Alternating).unwrap();
            let exact = |x: f64, y: f64| (PI * x).sin() * (PI * y).sin();
            let values = boundary_values(&mesh, |_, _| 0.0);
            let domain = Domain::held(Elements::of(&mesh).unwrap(), &values).unwrap();
            let metric = domain.galerkin().unwrap();
            let at = |&v: &usize| exact(mesh.vertices()[v].x, mesh.vertices()[v].y);
            let exact: Vec<f64> = domain.free_vertices().iter().map(at).collect();
            let source: Vec<f64> = exact.iter().map(|u| 2.0 * PI * PI * u).collect();
            let u = Poisson::new(&domain, &metric).unwrap().solve(&source).unwrap();
            let worst = u.iter().zip(&exact).map(|(u, e)| (u - e).abs()).fold(0.0, f64::max);
            (1.0 / n as f64, worst)
        };
        let slope = loglog_slope(&[error(8), error(16), error(32)]).unwrap();
        assert!((slope - 2.0).abs() < 0.1, "{slope}");
    }

    #[test]
    fn on_a_closed_surface_a_balanced_source_has_an_answer_and_another_has_none() {
        let sphere = icosphere(1.0, 3).unwrap();
        let domain = Domain::free(Elements::of(&sphere).unwrap()).unwrap();
        let metric = domain.lumped().unwrap();
        let mut poisson = Poisson::new(&domain, &metric).unwrap();
        // z is an eigenfunction of the sphere: -Lap z = 2 z.
        let z: Vec<f64> = sphere.vertices().iter().map(|p| p.z).collect();
        let source: Vec<f64> = z.iter().map(|z| 2.0 * z).collect();
        let u = poisson.solve(&source).unwrap();
        assert!(u.iter().zip(&z).all(|(u, z)| (u - z).abs() < 0.02));
        let error = poisson.solve(&vec![1.0; domain.dim()]).unwrap_err();
        assert!(matches!(error, LaplacianError::Incompatible { vertex: 0, total } if total > 12.0));
    }

    #[test]
    fn each_piece_is_judged_by_itself() {
        let line = bar(1.0, 4).unwrap();
        let far = line.mapped(|x| x.add_scalar(5.0)).unwrap();
        let two = Elements::of(&line.beside(&far)).unwrap();
        let domain = Domain::held(two, &[(0, 1.0)]).unwrap();
        assert_eq!(harmonic(&domain), Err(LaplacianError::NothingHeld(5)));
        let metric = domain.lumped().unwrap();
        let mut poisson = Poisson::new(&domain, &metric).unwrap();
        let mut load = vec![0.0; 9];
        (load[4], load[8]) = (-1.0, 1.0);
        let u = poisson.solve_load(Covector(load.clone())).unwrap();
        // Unit flux through a bar of length one, and mean zero; the held piece stays at one.
        assert!((u[8] - u[4] - 1.0).abs() < 1e-14 && (u[8] + u[4]).abs() < 1e-14);
        assert!(u[..4].iter().all(|u| (u - 1.0).abs() < 1e-14));
        load[8] = 2.0;
        let error = poisson.solve_load(Covector(load)).unwrap_err();
        assert_eq!(error, LaplacianError::Incompatible { vertex: 5, total: 1.0 });
    }
}
