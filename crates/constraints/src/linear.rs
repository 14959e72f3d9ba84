//! Linear equations in the freedoms of a flat space.
//!
//! ```text
//! g_i = sum_f a_if q_f - b_i
//! ```
//! `a` given row by row by its entries, `b` a number a row. A pulley: `x_1 + x_2 = const`; a
//! slider: `y = 0`; a gear: `r_1 theta_1 + r_2 theta_2 = 0`.

use stationary_calculus::{Flat, Sink, SizeError};

use crate::{
    Constraint, ConstraintError, ConstraintOn, Rows, Scale, check_multipliers, check_read,
    check_values,
};

/// An equation: its entries as (freedom, coefficient), and its right-hand side.
type Equation = (Vec<(usize, f64)>, f64);

/// Linear equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    equations: Vec<Equation>,
    /// The freedoms that they read.
    dim: usize,
}

impl Linear {
    /// Equations, each with its entries as (freedom, coefficient) and its right-hand side.
    ///
    /// # Errors
    /// A number that is not finite, a freedom named twice in an equation, and an equation whose
    /// coefficients are all zero.
    pub fn new(equations: Vec<Equation>) -> Result<Self, ConstraintError> {
        for (row, (entries, right)) in equations.iter().enumerate() {
            let finite = entries.iter().all(|(_, a)| a.is_finite()) && right.is_finite();
            let some = entries.iter().any(|&(_, a)| a != 0.0);
            let mut freedoms: Vec<usize> = entries.iter().map(|&(freedom, _)| freedom).collect();
            freedoms.sort_unstable();
            let repeated = freedoms.windows(2).any(|two| two[0] == two[1]);
            if !finite || !some || repeated {
                return Err(ConstraintError::Equation { row });
            }
        }
        let freedoms = equations.iter().flat_map(|(entries, _)| entries);
        let dim = freedoms.map(|&(freedom, _)| freedom.saturating_add(1)).max().unwrap_or(0);
        Ok(Linear { equations, dim })
    }
}

impl ConstraintOn<Flat> for Linear {}

impl Constraint for Linear {
    fn dim(&self) -> usize {
        self.dim
    }

    fn count(&self) -> usize {
        self.equations.len()
    }

    fn value(&self, _: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.equations.len(), g)?;
        check_read(self.dim, q)?;
        for (g, (entries, right)) in g.iter_mut().zip(&self.equations) {
            *g = entries.iter().map(|&(freedom, a)| a * q[freedom]).sum::<f64>() - right;
        }
        Ok(())
    }

    fn differential(&self, _: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim, q)?;
        for (row, (entries, _)) in self.equations.iter().enumerate() {
            for &(freedom, a) in entries {
                rows.add(row, freedom, a);
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        q: &[f64],
        lambda: &[f64],
        _: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.equations.len(), lambda)?;
        check_read(self.dim, q)
    }

    fn scale(&self, row: usize) -> Scale {
        let Some((entries, _)) = self.equations.get(row) else { return Scale::default() };
        let slope = entries.iter().map(|(_, a)| a * a).sum::<f64>().sqrt();
        Scale { slope, ..Scale::default() }
    }
}
