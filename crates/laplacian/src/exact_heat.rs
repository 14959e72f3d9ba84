//! Heat in closed form in the spectral basis: any time for the same cost.
//!
//! ```text
//! f(t) = sum_i v_i exp(-alpha lambda_i t) <v_i, M f(0)>
//! ```
//! `v_i lambda_i` modes of the Dirichlet energy in the mass M, `lambda >= 0`. Exact for the
//! discrete Laplacian if all modes are there; with the lowest only, what the start has outside of
//! them is left out, and its size kept: fast modes die first, so the error falls with time like
//! the first mode that is missing. Where vertices are held at other values than zero, f is the
//! difference to the steady state. Source: notes 15.2, 15.3; errata chapter 15 (the factor pi^2).

use stationary_calculus::{Metric, SizeError, Vector};
use stationary_modal::Modes;

use crate::LaplacianError;
use crate::error::{check_finite, positive};

/// Heat as a sum of modes.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactHeat<'a> {
    modes: &'a Modes,
    alpha: f64,
    coefficients: Vec<f64>,
    left_out: f64,
}

/// An eigenvalue may be this far below zero, relative to the largest of the modes or the next one.
const ROUNDING: f64 = 1e-6;

impl<'a> ExactHeat<'a> {
    /// Heat of diffusivity `alpha` m^2/s from `f` at time zero. Modes of rigid motions (constants)
    /// must be among the modes if they are to be kept.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`], [`LaplacianError::Size`], [`LaplacianError::NonFinite`] for a
    /// start that is not finite or too large for its square, and [`LaplacianError::Growing`] for
    /// modes that no heat has.
    pub fn new(
        modes: &'a Modes,
        metric: &impl Metric,
        alpha: f64,
        f: &[f64],
    ) -> Result<Self, LaplacianError> {
        positive("the diffusivity", alpha)?;
        SizeError::check("the modes' freedoms", metric.dim(), modes.dim())?;
        SizeError::check("the function's values", metric.dim(), f.len())?;
        check_finite(f)?;
        let values = modes.values();
        // Where constants alone are there, the next mode tells what is small.
        let scale = values.iter().copied().fold(0.0, f64::max).max(modes.complete_below());
        if let Some(&lambda) =
            values.iter().find(|&&lambda| lambda.is_nan() || lambda < -ROUNDING * scale)
        {
            return Err(LaplacianError::Growing { lambda });
        }
        let (mut coefficients, mut rest) = (Vec::new(), f.to_vec());
        for mode in (0..modes.len()).filter_map(|i| modes.vector(i)) {
            let part = metric.inner(mode, Vector(f));
            rest.iter_mut().zip(mode.0).for_each(|(rest, v)| *rest -= part * v);
            coefficients.push(part);
        }
        check_finite(&coefficients)?;
        // Relative to the largest value, neither square leaves the range of numbers.
        let largest = f.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let size = |f: &[f64]| {
            let f: Vec<f64> = f.iter().map(|x| x / largest).collect();
            metric.inner(Vector(&f), Vector(&f)).max(0.0).sqrt()
        };
        let left_out = if largest > 0.0 { size(&rest) / size(f) } else { 0.0 };
        check_finite(&[left_out])?;
        Ok(ExactHeat { modes, alpha, coefficients, left_out })
    }

    /// The part of the start outside of the modes, relative to all of it in the mass.
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// The function at time t, seconds.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`] for a time that is negative or not finite, and
    /// [`LaplacianError::NonFinite`].
    pub fn at(&self, t: f64) -> Result<Vec<f64>, LaplacianError> {
        if !(t >= 0.0 && t.is_finite()) {
            return Err(LaplacianError::Parameter { what: "the time", value: t });
        }
        let mut f = vec![0.0; self.modes.dim()];
        for (i, (lambda, start)) in self.modes.values().iter().zip(&self.coefficients).enumerate() {
            // A constant does not decay: what its lambda is off zero is rounding.
            let part = start * (-self.alpha * lambda.max(0.0) * t).exp();
            if let Some(mode) = self.modes.vector(i) {
                f.iter_mut().zip(mode.0).for_each(|(f, v)| *f += part * v);
            }
        }
        check_finite(&f)?;
        Ok(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, Elements, lowest_modes};
    use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink};
    use stationary_mesh::bar;
    use stationary_modal::{Linearized, RigidMotions};

    #[test]
    fn a_start_or_a_time_that_is_no_number_is_refused() {
        let domain = Domain::free(Elements::of(&bar(1.0, 4).unwrap()).unwrap()).unwrap();
        let metric = domain.lumped().unwrap();
        let modes = lowest_modes(&domain, &metric, 5).unwrap();
        for bad in [f64::NAN, f64::INFINITY] {
            let error = ExactHeat::new(&modes, &metric, 1.0, &[0.0, 1.0, bad, 0.0, 0.0]);
            assert!(matches!(error, Err(LaplacianError::NonFinite { freedom: 2, .. })));
        }
        let heat = ExactHeat::new(&modes, &metric, 1.0, &[1.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        assert!(matches!(heat.at(f64::NAN), Err(LaplacianError::Parameter { .. })));
        // The constant stays for ever, though its eigenvalue is only zero to rounding.
        let late = heat.at(1e300).unwrap();
        assert!(late.iter().all(|f| (f - 0.125).abs() < 1e-12), "{late:?}");
    }

    /// A ball on a hill in one direction and in a bowl in the other.
    struct Saddle;

    impl Potential for Saddle {
        fn dim(&self) -> usize {
            2
        }

        fn energy(&self, q: &[f64]) -> f64 {
            0.5 * (q[0] * q[0] - q[1] * q[1])
        }

        fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
            dv.0[0] += q[0];
            dv.0[1] -= q[1];
        }

        fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
            hessian.add_symmetric(&[0], &[1.0]);
            hessian.add_symmetric(&[1], &[-1.0]);
        }
    }

    #[test]
    fn modes_that_grow_are_none_of_heat() {
        let metric = DiagonalMetric::new(vec![1.0, 1.0]).unwrap();
        let mut linearized = Linearized::at(&metric, &Saddle, &[0.0, 0.0], 1e-9).unwrap();
        let modes = linearized.lowest(2, &RigidMotions::none()).unwrap();
        let error = ExactHeat::new(&modes, &metric, 1.0, &[1.0, 1.0]).unwrap_err();
        assert!(matches!(error, LaplacianError::Growing { lambda } if (lambda + 1.0).abs() < 1e-9));
    }

    #[test]
    fn what_is_left_out_of_a_huge_or_tiny_start_is_a_part_of_it() {
        let domain = Domain::free(Elements::of(&bar(1.0, 4).unwrap()).unwrap()).unwrap();
        let metric = domain.lumped().unwrap();
        let modes = lowest_modes(&domain, &metric, 3).unwrap();
        let left_out = |size: f64| {
            let f = [1.0, -1.0, 1.0, -1.0, 0.5].map(|f| size * f);
            ExactHeat::new(&modes, &metric, 1.0, &f).unwrap().left_out()
        };
        for size in [1e-250, 1e250] {
            assert!((left_out(size) - left_out(1.0)).abs() < 1e-12);
        }
    }
}
