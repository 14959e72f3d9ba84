//! Figure 2.1 as data: the error of a finite difference against its step.
//!
//! ```text
//! forward    |f(q + e w) - f(q) - e [df] w| / e                ~ e/2   |d2f(w, w)|       slope 1
//! centred    |f(q + e w) - f(q - e w) - 2 e [df] w| / (2 e)    ~ e^2/6 |d3f(w, w, w)|    slope 2
//! rounding   ~ eps |f| / e                                                              slope -1
//! ```
//! `e` step, `eps` = 2^-52, errors relative to `|[df] w|` (absolute where that is zero). Down to
//! cancellation the errors of a right differential lie on lines of slope 1 and 2; of a wrong one they
//! stop at its error. A linear function has no truncation error, hence no slopes.
//! The change of `f` is compared with `[df]` times the step that floating point really took,
//! `(q + e w) - q`. Source: notes 2.5, figure 2.1; the constants from errata chapter 2.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use crate::{SizeError, Vector};
use stationary_measure::{Cell, Column, Table, loglog_slope, truncation_regime};

/// A difference of f is called rounding below this much of f: enough that what is printed of
/// larger ones is the same on every processor.
pub(super) const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The errors of both differences at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// The step e.
    pub step: f64,
    /// The error of the forward difference.
    pub forward: f64,
    /// The error of the centred difference.
    pub centred: f64,
    /// What rounding alone may contribute.
    pub rounding: f64,
}

/// The errors of both differences over a range of steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    pub(super) rows: Vec<Difference>,
}

impl Differences {
    /// One row for each step, in the given order.
    pub fn rows(&self) -> &[Difference] {
        &self.rows
    }

    /// The slope of the forward error in its truncation regime, 1 where the differential is right
    /// and the function bends.
    pub fn forward_slope(&self) -> Option<f64> {
        self.slope(|row| row.forward)
    }

    /// The slope of the centred error in its truncation regime, 2 where the differential is right
    /// and the third derivative does not vanish.
    pub fn centred_slope(&self) -> Option<f64> {
        self.slope(|row| row.centred)
    }

    fn slope(&self, error: fn(&Difference) -> f64) -> Option<f64> {
        let above = self.rows.iter().filter(|row| error(row) > row.rounding);
        let points: Vec<(f64, f64)> = above.map(|row| (row.step, error(row))).collect();
        loglog_slope(truncation_regime(&points))
    }

    /// The row where cancellation overtakes truncation: that of the smallest centred error.
    pub fn floor(&self) -> Option<&Difference> {
        self.rows.iter().min_by(|a, b| a.centred.total_cmp(&b.centred))
    }

    /// The rows as a table, with errors that may be rounding left as a word.
    pub fn table(&self) -> Table {
        let rounded = |name| Column::rounded(name, 2, 0.0);
        let names = ["step", "forward error", "centred error"];
        let mut table = Table::new(names.map(rounded));
        for row in &self.rows {
            let cell = |error: f64| -> Cell {
                if error > row.rounding { error.into() } else { "rounding".into() }
            };
            table.push([row.step.into(), cell(row.forward), cell(row.centred)]);
        }
        table
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.table())?;
        for (name, slope) in [("forward", self.forward_slope()), ("centred", self.centred_slope())]
        {
            match slope {
                Some(slope) => writeln!(f, "slope of the {name} error: {slope:.1}")?,
                None => writeln!(f, "slope of the {name} error: none, no truncation regime")?,
            }
        }
        Ok(())
    }
}

/// The errors of both differences of `f` at `q` along `w`, against its matrix `df` (M x N), for each
/// of the `steps`.
///
/// # Errors
/// Where q, w, the matrix or any value of the function has another size.
pub fn differences(
    f: impl Fn(&[f64]) -> Vec<f64>,
    df: &DMatrix<f64>,
    q: &[f64],
    w: Vector<&[f64]>,
    steps: &[f64],
) -> Result<Differences, SizeError> {
    SizeError::check("the Jacobian's columns", q.len(), df.ncols())?;
    SizeError::check("the direction's components", q.len(), w.0.len())?;
    let (q, w) = (DVector::from_column_slice(q), DVector::from_column_slice(w.0));
    let value = |q: &DVector<f64>| {
        let value = DVector::from_vec(f(q.as_slice()));
        SizeError::check("the function's numbers", df.nrows(), value.len())?;
        Ok(value)
    };
    let centre = value(&q)?;
    let slope = (df * &w).norm();
    let size = if slope > 0.0 { slope } else { 1.0 };
    let row = |&step: &f64| {
        let (ahead, behind) = (&q + &w * step, &q - &w * step);
        let (plus, minus) = (value(&ahead)?, value(&behind)?);
        Ok(Difference {
            step,
            forward: (&plus - &centre - df * (&ahead - &q)).norm() / (step * size),
            centred: (plus - minus - df * (ahead - behind)).norm() / (2.0 * step * size),
            rounding: ROUNDING * centre.norm() / (step * size),
        })
    };
    Ok(Differences { rows: steps.iter().map(row).collect::<Result<_, SizeError>>()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{directional_derivative, hat, hat_differential, second_differential};
    use nalgebra::{SVector, dmatrix};

    const Q: [f64; 3] = [0.6, -1.1, 0.4];
    const W: Vector<[f64; 3]> = Vector([0.3, 0.8, -0.5]);

    /// The function of figure 2.1 at eight steps a decade.
    fn figure() -> Differences {
        let df = hat_differential(&SVector::from(Q));
        let df = DMatrix::from_column_slice(3, 3, df.as_slice());
        let steps: Vec<f64> = (8..=128).map(|k| 10_f64.powf(-f64::from(k) / 8.0)).collect();
        differences(|q| hat([q[0], q[1], q[2]]).to_vec(), &df, &Q, W.view(), &steps).unwrap()
    }

    fn norm(v: &[f64]) -> f64 {
        v.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    #[test]
    fn the_slopes_of_figure_2_1_are_one_and_two() {
        let figure = figure();
        assert!((figure.forward_slope().unwrap() - 1.0).abs() < 0.01, "{figure}");
        assert!((figure.centred_slope().unwrap() - 2.0).abs() < 0.01, "{figure}");
        let floor = figure.floor().unwrap();
        assert!(floor.centred < 1e-10 && (1e-7..1e-4).contains(&floor.step), "{floor:?}");
    }

    #[test]
    fn the_constants_of_figure_2_1_are_a_half_and_a_sixth() {
        let step = 1e-3;
        let size = norm(&directional_derivative(hat, Q, W));
        let half = 0.5 * norm(&second_differential(hat, Q, W, W)) / size;
        // The third derivative, by a centred difference of the exact second one.
        let at = |s: f64| {
            let q = std::array::from_fn(|i| Q[i] + s * W.0[i]);
            SVector::from(second_differential(hat, q, W, W))
        };
        let sixth = ((at(1e-4) - at(-1e-4)) / 2e-4).norm() / 6.0 / size;
        let row = figure().rows.into_iter().find(|row| (row.step / step - 1.0).abs() < 1e-9);
        let row = row.unwrap();
        assert!((row.forward / (half * step) - 1.0).abs() < 2e-3);
        assert!((row.centred / (sixth * step * step) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_errors_of_a_wrong_differential_stop_at_its_error() {
        let f = |q: &[f64]| vec![q[0] * q[0] * q[0]];
        let steps: Vec<f64> = (1..12).map(|k| 10_f64.powi(-k)).collect();
        let wrong = differences(f, &dmatrix![3.003], &[1.0], Vector(&[1.0]), &steps).unwrap();
        for row in &wrong.rows[2..] {
            assert!((row.centred - 1e-3).abs() < 2e-4, "{wrong}");
        }
    }

    #[test]
    fn a_function_that_gives_another_number_of_values_later_is_refused() {
        let f = |q: &[f64]| vec![1.0; if q[0] == 0.5 { 1 } else { 2 }];
        let refused = differences(f, &dmatrix![1.0], &[0.5], Vector(&[1.0]), &[0.1]).unwrap_err();
        assert_eq!((refused.expected, refused.got), (1, 2));
    }

    #[test]
    fn the_table_shows_truncation_and_calls_rounding_by_its_name() {
        let cube = |q: &[f64]| vec![q[0].powi(3)];
        let steps = [1e-1, 1e-2, 1e-3, 1e-15];
        let study = differences(cube, &dmatrix![3.0], &[1.0], Vector(&[1.0]), &steps).unwrap();
        let expected = "\
step     forward error  centred error
1.0e-1   1.0e-1         3.3e-3
1.0e-2   1.0e-2         3.3e-5
1.0e-3   1.0e-3         3.3e-7
1.0e-15  rounding       rounding
";
        assert_eq!(study.table().to_string(), expected);
    }
}
