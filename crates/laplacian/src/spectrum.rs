//! Eigenvalues of the Laplacian: the lowest through the crate modal, the largest here.
//!
//! ```text
//! W v = lambda M v        Lap v = -lambda v,  lambda >= 0
//! Lanczos:  x_(k+1) ~ M^-1 W x_k, made orthogonal in M; the largest eigenvalue of the small matrix
//! ```
//! `W` the Hessian of the Dirichlet energy, `M` the mass; `lambda` in 1/m^2. The largest
//! eigenvalue is what an explicit step is bounded by. Source: notes 15.3; Parlett, The symmetric
//! eigenvalue problem, 1980.

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{Covector, Metric, Potential, SizeError, Vector};
use stationary_measure::SplitMix64;
use stationary_modal::{Linearized, ModalError, Modes, RigidMotions};

use crate::{Domain, LaplacianError};

/// The lowest modes of a domain in a mass, among them the constant of each connected piece of which
/// nothing is held.
///
/// # Errors
/// Those of [`Linearized::lowest`].
pub fn lowest_modes<const K: usize>(
    domain: &Domain<K>,
    metric: &impl Metric,
    count: usize,
) -> Result<Modes, LaplacianError> {
    let homogeneous = Homogeneous(domain);
    let rest = vec![0.0; domain.dim()];
    let mut linearized = Linearized::at(metric, &homogeneous, &rest, 0.0)?;
    let constants = RigidMotions::of_motions(&linearized, &domain.constants(count))?;
    if count == 0 || count > domain.dim() {
        return Err(ModalError::Count { asked: count, there: domain.dim() }.into());
    }
    // Where constants alone are asked for, the mode after them is found and let go.
    let others = count.saturating_sub(constants.len()).max(1);
    let mut modes = linearized.lowest(others, &constants)?.with_rigid(&constants)?;
    modes.truncate(count);
    Ok(modes)
}

/// The energy of the difference to the steady state: held values are zero.
struct Homogeneous<'a, const K: usize>(&'a Domain<K>);

impl<const K: usize> Potential for Homogeneous<'_, K> {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn energy(&self, f: &[f64]) -> f64 {
        let mut dv = Covector(vec![0.0; f.len()]);
        self.add_differential(f, dv.view_mut());
        0.5 * dv.apply(&Vector(f))
    }

    fn add_differential(&self, f: &[f64], dv: Covector<&mut [f64]>) {
        if let Some(mut sink) = stationary_calculus::ProductSink::new(1.0, f, dv.0) {
            self.add_hessian(f, &mut sink);
        }
    }

    fn add_hessian(&self, f: &[f64], hessian: &mut impl stationary_calculus::Sink) {
        self.0.dirichlet().add_hessian(f, hessian);
    }
}

/// Steps of Lanczos: the largest eigenvalue is the first to converge.
const STEPS: usize = 80;
/// Below this part of the largest, what is left of a vector is rounding.
const EXHAUSTED: f64 = 1e-12;

/// The largest eigenvalue, from below; for meshes it is met to ten digits and more.
///
/// # Errors
/// [`LaplacianError::Size`], and [`LaplacianError::Parameter`] for masses too large for a number.
pub fn largest_eigenvalue(
    metric: &impl Metric,
    dirichlet: &impl Potential,
) -> Result<f64, LaplacianError> {
    let n = metric.dim();
    SizeError::check("the energy's freedoms", n, dirichlet.dim())?;
    let anywhere = vec![0.0; n];
    let mut random = SplitMix64::new(15);
    let mut next: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
    let (mut basis, mut small): (Vec<Vec<f64>>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
    let mut largest = 0.0_f64;
    for _ in 0..STEPS.min(n) {
        for _ in 0..2 {
            for x in &basis {
                let part = metric.inner(Vector(x), Vector(&next));
                next.iter_mut().zip(x).for_each(|(next, x)| *next -= part * x);
            }
        }
        let size = metric.inner(Vector(&next), Vector(&next)).max(0.0).sqrt();
        if !size.is_finite() {
            let what = "the length of a vector in the metric";
            return Err(LaplacianError::Parameter { what, value: size });
        }
        largest = largest.max(size);
        if size <= EXHAUSTED * largest {
            break;
        }
        let x: Vec<f64> = next.iter().map(|value| value / size).collect();
        let (mut dv, mut moved) = (Covector(vec![0.0; n]), Vector(vec![0.0; n]));
        if let Some(mut sink) = stationary_calculus::ProductSink::new(1.0, &x, &mut dv.0) {
            dirichlet.add_hessian(&anywhere, &mut sink);
        }
        metric.sharp(dv.view(), moved.view_mut());
        small.push([dv.apply(&Vector(&x)), if basis.is_empty() { 0.0 } else { size }]);
        basis.push(x);
        next = moved.0;
    }
    let k = small.len();
    if k == 0 {
        return Ok(0.0);
    }
    let tridiagonal = DMatrix::from_fn(k, k, |i, j| match i.abs_diff(j) {
        0 => small[i][0],
        1 => small[i.max(j)][1],
        _ => 0.0,
    });
    Ok(SymmetricEigen::new(tridiagonal).eigenvalues.iter().copied().fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Elements;
    use stationary_mesh::bar;

    #[test]
    fn the_constants_of_the_pieces_may_be_asked_for_alone() {
        let one = bar(1.0, 4).unwrap();
        let two = one.beside(&one.mapped(|x| x.add_scalar(3.0)).unwrap());
        let domain = Domain::free(Elements::of(&two).unwrap()).unwrap();
        let metric = domain.lumped().unwrap();
        for count in 1..=3 {
            let modes = lowest_modes(&domain, &metric, count).unwrap();
            assert_eq!(modes.len(), count);
            let zeros = modes.values().iter().filter(|lambda| lambda.abs() < 1e-9).count();
            assert_eq!(zeros, count.min(2));
        }
        assert!(lowest_modes(&domain, &metric, 0).is_err());
        assert!(lowest_modes(&domain, &metric, 11).is_err());
    }

    #[test]
    fn the_largest_eigenvalue_is_refused_where_masses_are_too_large_and_zero_of_nothing() {
        let domain = Domain::free(Elements::of(&bar(1.0, 4).unwrap()).unwrap()).unwrap();
        let heavy = stationary_calculus::DiagonalMetric::new(vec![1.7e308; domain.dim()]).unwrap();
        let refused = largest_eigenvalue(&heavy, domain.dirichlet());
        assert!(matches!(refused, Err(LaplacianError::Parameter { .. })), "{refused:?}");
        let none = stationary_calculus::DiagonalMetric::new(Vec::<f64>::new()).unwrap();
        let nothing = Option::<&crate::Dirichlet<1>>::None;
        assert_eq!(largest_eigenvalue(&none, &nothing).unwrap(), 0.0);
    }
}
