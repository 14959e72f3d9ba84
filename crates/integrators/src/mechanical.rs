//! The Lagrangian of a mechanical system: constant masses, and an energy written once.
//!
//! ```text
//! L(q, v) = 1/2 <M v, v> - V(q),    M = diag(m_1, ..., m_N)
//! ```
//! `m` masses (N, kg, or kg m^2 for angles), `V` an [`Energy`] in joules. The same V makes a
//! potential through `Automatic`, so that one definition serves this recipe and every method of
//! chapter 4. Source: notes 5.3 (example), 5.5.

use stationary_calculus::{DiagonalMetric, Energy, MetricError, Number};

use crate::Lagrangian;

/// Masses and an energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanical<E, const N: usize> {
    mass: [f64; N],
    energy: E,
}

impl<E: Energy<N>, const N: usize> Mechanical<E, N> {
    /// A mass for each freedom and an energy.
    ///
    /// # Errors
    /// Where a mass is not positive and finite.
    pub fn new(mass: [f64; N], energy: E) -> Result<Self, MetricError> {
        DiagonalMetric::new(mass)?;
        Ok(Mechanical { mass, energy })
    }
}

impl<E: Energy<N>, const N: usize> Lagrangian<N> for Mechanical<E, N> {
    fn value<R: Number>(&self, q: [R; N], v: [R; N]) -> R {
        let twice = v.iter().zip(self.mass).fold(R::from(0.0), |sum, (&v, m)| sum + v * v * m);
        twice * 0.5 - self.energy.energy(q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EulerLagrange;
    use stationary_calculus::Vector;

    #[derive(Debug)]
    struct Well;

    impl Energy<2> for Well {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            x.powi(4) - x * y
        }
    }

    #[test]
    fn the_euler_lagrange_equations_are_newtons_second_law() {
        let mut equations = EulerLagrange::new(Mechanical::new([2.0, 5.0], Well).unwrap());
        let [x, y] = [0.7, -0.3];
        let a = equations.acceleration([x, y], Vector([1.0, 4.0])).unwrap();
        assert!((2.0 * a.0[0] + 4.0 * x * x * x - y).abs() < 1e-14);
        assert!((5.0 * a.0[1] - x).abs() < 1e-14);
    }

    #[test]
    fn a_mass_that_is_not_positive_is_refused_by_name() {
        let error = Mechanical::new([1.0, -1.0], Well).unwrap_err();
        assert_eq!(error, MetricError::NotAMass { freedom: 1, mass: -1.0 });
    }
}
