//! Problems with known spectra: one definition each for tests, studies and benches.
//!
//! | problem | system | lambda |
//! | --- | --- | --- |
//! | [`fixed_chain`] | n masses in a row between two walls | `4 sin^2(i pi / 2(n + 1))`, i = 1 ... n |
//! | [`free_chain`] | n masses in a row | `4 sin^2(i pi / 2n)`, i = 0 ... n - 1 |
//! | [`membrane`] | m x m masses that move across a plane, the border held | sums of two of the first |
//!
//! All have masses of 1 kg and linear springs of 1 N/m, with the rest state at zero.

use std::f64::consts::PI;

use stationary_calculus::{Covector, DiagonalMetric, FIXED, Potential, Sink};

use crate::ModalError;

/// The most masses of a problem.
const MOST: usize = 1 << 24;

/// Linear springs `1/2 (x_a - x_b)^2` between freedoms; an end may be held at zero.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearSprings {
    freedoms: usize,
    ends: Vec<[Option<usize>; 2]>,
}

impl Potential for LinearSprings {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.ends.iter().map(|ends| 0.5 * stretch(q, ends).powi(2)).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for ends in &self.ends {
            let stretch = stretch(q, ends);
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                if let Some(end) = *end {
                    dv.0[end] += sign * stretch;
                }
            }
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for ends in &self.ends {
            let freedoms = ends.map(|end| end.unwrap_or(FIXED));
            hessian.add_symmetric(&freedoms, &[1.0, -1.0, -1.0, 1.0]);
        }
    }
}

fn stretch(q: &[f64], [a, b]: &[Option<usize>; 2]) -> f64 {
    let at = |end: &Option<usize>| end.map_or(0.0, |end| q[end]);
    at(a) - at(b)
}

/// Springs, masses, and the state of rest.
#[derive(Clone, Debug)]
pub struct SpringProblem {
    /// The masses.
    pub metric: DiagonalMetric<Vec<f64>>,
    /// The springs.
    pub potential: LinearSprings,
    /// The equilibrium.
    pub q: Vec<f64>,
    /// All eigenvalues, ascending, 1/s^2.
    pub spectrum: Vec<f64>,
}

/// An error for no masses, and for more than memory holds.
fn check_count(masses: usize) -> Result<(), ModalError> {
    if (1..=MOST).contains(&masses) {
        Ok(())
    } else {
        Err(ModalError::Parameter { what: "the number of masses", value: masses as f64 })
    }
}

fn problem(
    freedoms: usize,
    ends: Vec<[Option<usize>; 2]>,
    mut spectrum: Vec<f64>,
) -> Result<SpringProblem, ModalError> {
    spectrum.sort_by(f64::total_cmp);
    let metric = DiagonalMetric::new(vec![1.0; freedoms])
        .map_err(|_| ModalError::Parameter { what: "the mass", value: 1.0 })?;
    let potential = LinearSprings { freedoms, ends };
    Ok(SpringProblem { metric, potential, q: vec![0.0; freedoms], spectrum })
}

/// `4 sin^2(i pi / 2m)`.
fn lambda(i: usize, m: usize) -> f64 {
    4.0 * (0.5 * PI * i as f64 / m as f64).sin().powi(2)
}

/// n masses in a row between two walls.
///
/// # Errors
/// [`ModalError::Parameter`] for no masses, or more than sixteen million.
pub fn fixed_chain(n: usize) -> Result<SpringProblem, ModalError> {
    check_count(n)?;
    let inside = |i: usize| (i >= 1 && i <= n).then(|| i - 1);
    let ends = (0..=n).map(|i| [inside(i), inside(i + 1)]).collect();
    problem(n, ends, (1..=n).map(|i| lambda(i, n + 1)).collect())
}

/// n masses in a row, free to drift.
///
/// # Errors
/// [`ModalError::Parameter`] for no masses, or more than sixteen million.
pub fn free_chain(n: usize) -> Result<SpringProblem, ModalError> {
    check_count(n)?;
    let ends = (1..n).map(|i| [Some(i - 1), Some(i)]).collect();
    problem(n, ends, (0..n).map(|i| lambda(i, n)).collect())
}

/// m x m masses that move across a plane, with the border held: most modes come in pairs.
///
/// # Errors
/// [`ModalError::Parameter`] for no masses, or more than sixteen million.
pub fn membrane(m: usize) -> Result<SpringProblem, ModalError> {
    check_count(m.saturating_mul(m))?;
    let inside = |row: usize, column: usize| {
        let within = (1..=m).contains(&row) && (1..=m).contains(&column);
        within.then(|| (row - 1) * m + column - 1)
    };
    let mut ends = Vec::new();
    for row in 0..=m {
        for column in 0..=m {
            let pairs = [(row, column + 1), (row + 1, column)];
            ends.extend(pairs.map(|(r, c)| [inside(row, column), inside(r, c)]));
        }
    }
    ends.retain(|ends| ends.iter().any(Option::is_some));
    let pairs = (1..=m).flat_map(|i| (1..=m).map(move |j| lambda(i, m + 1) + lambda(j, m + 1)));
    problem(m * m, ends, pairs.collect())
}
