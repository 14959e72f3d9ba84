//! Any constraint, written once as a function and differentiated automatically.
//!
//! ```text
//! g = f(t, x),    x = the N freedoms that it reads,    M equations
//! ```
//! `f` is written over any [`Number`] of a flat space's freedoms and of time, so that J, the second
//! differentials and dg/dt are exact: points on curves and surfaces, moving supports, motors. A row
//! of J costs N evaluations, a second differential N (N + 1)/2: right for a few freedoms.
//!
//! ```
//! use stationary_calculus::Number;
//! use stationary_constraints::{Constraint, Function, FunctionConstraint};
//! /// A bead on the parabola y = x^2.
//! struct Wire;
//! impl Function<2, 1> for Wire {
//!     fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> [R; 1] {
//!         [y - x * x]
//!     }
//! }
//! let wire = FunctionConstraint::new(Wire, [0, 1])?;
//! let mut g = [0.0];
//! wire.value(0.0, &[2.0, 5.0], &mut g)?;
//! assert_eq!(g, [1.0]);
//! # Ok::<(), stationary_constraints::ConstraintError>(())
//! ```

use stationary_calculus::{
    Flat, Number, Sink, SizeError, Vector, array, directional_derivative, second_differential,
};

use crate::{
    Constraint, ConstraintError, ConstraintOn, Rows, Scale, check_multipliers, check_read,
    check_values,
};

/// M functions of time and N freedoms, written once over any [`Number`].
pub trait Function<const N: usize, const M: usize> {
    /// The values, which the constraint keeps at zero.
    fn value<R: Number>(&self, t: R, x: [R; N]) -> [R; M];

    /// How large the numbers of equation `row` typically are.
    fn scale(&self, _row: usize) -> Scale {
        Scale::default()
    }
}

/// The constraint that a [`Function`] of N freedoms makes.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionConstraint<F, const N: usize, const M: usize> {
    function: F,
    freedoms: [usize; N],
}

impl<F: Function<N, M>, const N: usize, const M: usize> FunctionConstraint<F, N, M> {
    /// The constraint on the given freedoms.
    ///
    /// # Errors
    /// Where a freedom is named twice.
    pub fn new(function: F, freedoms: [usize; N]) -> Result<Self, ConstraintError> {
        for (place, freedom) in freedoms.iter().enumerate() {
            if freedoms[..place].contains(freedom) {
                return Err(ConstraintError::RepeatedFreedom { freedom: *freedom });
            }
        }
        Ok(FunctionConstraint::of_distinct(function, freedoms))
    }

    pub(crate) fn of_distinct(function: F, freedoms: [usize; N]) -> Self {
        FunctionConstraint { function, freedoms }
    }

    fn read(&self, q: &[f64]) -> Result<[f64; N], SizeError> {
        check_read(self.dim(), q)?;
        Ok(self.freedoms.map(|freedom| q[freedom]))
    }

    /// The derivatives of all equations along one of the freedoms.
    fn column(&self, t: f64, x: [f64; N], place: usize) -> [f64; M] {
        directional_derivative(
            |[s]: [_; 1]| self.function.value(s * 0.0 + t, moved(x, place, s)),
            [0.0],
            Vector([1.0]),
        )
    }
}

/// The freedoms with one of them moved by s.
fn moved<R: Number, const N: usize>(x: [f64; N], place: usize, s: R) -> [R; N] {
    let mut x = x.map(R::from);
    x[place] += s;
    x
}

impl<F: Function<N, M>, const N: usize, const M: usize> ConstraintOn<Flat>
    for FunctionConstraint<F, N, M>
{
}

impl<F: Function<N, M>, const N: usize, const M: usize> Constraint for FunctionConstraint<F, N, M> {
    fn dim(&self) -> usize {
        self.freedoms.iter().map(|freedom| freedom.saturating_add(1)).max().unwrap_or(0)
    }

    fn count(&self) -> usize {
        M
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(M, g)?;
        let values = self.function.value(t, self.read(q)?);
        g.copy_from_slice(&values);
        Ok(())
    }

    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        let x = self.read(q)?;
        let columns: [[f64; M]; N] = array(|place| self.column(t, x, place));
        for row in 0..M {
            for (column, &freedom) in columns.iter().zip(&self.freedoms) {
                rows.add(row, freedom, column[row]);
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(M, lambda)?;
        let x = self.read(q)?;
        let mut block = [[0.0; N]; N];
        for (i, j) in (0..N).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let along = |[r, s]: [_; 2]| {
                let mut y = moved(x, i, r);
                y[j] += s;
                self.function.value(r * 0.0 + t, y)
            };
            let (first, second) = (Vector([1.0, 0.0]), Vector([0.0, 1.0]));
            let seconds: [f64; M] = second_differential(along, [0.0; 2], first, second);
            let sum = seconds.iter().zip(lambda).map(|(d2g, lambda)| d2g * lambda).sum();
            (block[i][j], block[j][i]) = (sum, sum);
        }
        hessian.add_symmetric(&self.freedoms, block.as_flattened());
        Ok(())
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(M, rate)?;
        let x = self.read(q)?;
        let along: [f64; M] = directional_derivative(
            |[s]: [_; 1]| self.function.value(s, x.map(|x| s * 0.0 + x)),
            [t],
            Vector([1.0]),
        );
        rate.copy_from_slice(&along);
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        self.function.scale(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pairing;
    use stationary_calculus::assert_derivatives;

    /// A point on a turning circle's rim, and another on a sphere.
    #[derive(Debug)]
    struct Turning;

    impl Function<4, 2> for Turning {
        fn value<R: Number>(&self, t: R, [x, y, z, w]: [R; 4]) -> [R; 2] {
            [x * t.cos() + y * t.sin() - w * w, x * x + y * y + z * z - 1.0]
        }
    }

    #[test]
    fn the_differentials_are_those_of_the_function() {
        let constraint = FunctionConstraint::new(Turning, [4, 0, 2, 1]).unwrap();
        assert_eq!((constraint.dim(), constraint.count()), (5, 2));
        let pairing = Pairing::new(constraint, vec![0.7, -1.3], 0.4).unwrap();
        assert_derivatives(&pairing, &[0.5, -0.3, 0.8, 9.0, 0.1]);
    }

    #[test]
    fn the_rate_is_the_derivative_by_time() {
        let constraint = FunctionConstraint::new(Turning, [0, 1, 2, 3]).unwrap();
        let q = [0.5, -0.3, 0.8, 0.2];
        let at = |t: f64| {
            let mut g = [0.0; 2];
            constraint.value(t, &q, &mut g).unwrap();
            g
        };
        let mut rate = [0.0; 2];
        constraint.rate(0.4, &q, &mut rate).unwrap();
        let h = 1e-5;
        for (row, rate) in rate.iter().enumerate() {
            let difference = (at(0.4 + h)[row] - at(0.4 - h)[row]) / (2.0 * h);
            assert!((rate - difference).abs() < 1e-10);
        }
    }

    #[test]
    fn a_freedom_named_twice_is_refused() {
        let error = FunctionConstraint::new(Turning, [0, 1, 2, 1]).unwrap_err();
        assert_eq!(error, ConstraintError::RepeatedFreedom { freedom: 1 });
    }
}
