//! The lowest eigenvalues of the Laplacian, through the crate modal.
//!
//! ```text
//! W v = lambda M v        Lap v = -lambda v,  lambda >= 0
//! ```
//! `W` the Hessian of the Dirichlet energy, `M` the mass; `lambda` in 1/m^2. Zero for the constant of each
//! piece of which nothing is held: that is known from how the elements hang together, not from numbers.
//! Source: notes 15.3.

use stationary_calculus::{Covector, Metric, Potential, Vector};
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
}
