//! The referee's own integrators: extrapolation to the limit, with steps of its own choice.
//!
//! ```text
//! T_j1 = the state after H in n_j small steps,     T_jk = T_j,k-1 + (T_j,k-1 - T_j-1,k-1) / (r - 1)
//! midpoint rule:            n_j = 2 j,   r = (n_j / n_j-k+1)^2
//! linearly implicit Euler:  n_j = j,     r = n_j / n_j-k+1,    (I - h J) (y' - y) = h f(t', y)
//! ```
//! Neither shares a formula with what it judges. A linearly implicit step resolves the fastest growth,
//! by the eigenvalues of J: else it may rest on an unstable equilibrium. Source: Hairer, Norsett, Wanner I (1993), II.9;
//! Hairer and Wanner II (1996), IV.9.

use nalgebra::{DMatrix, DVector, Schur};

pub use super::problem::{Derivative, Slope};

/// What is extrapolated.
#[derive(Clone, Copy)]
pub enum Extrapolation<'a> {
    /// The explicit midpoint rule (Gragg, Bulirsch and Stoer).
    Midpoint,
    /// The linearly implicit Euler method (Deuflhard), with the Jacobian.
    LinearlyImplicitEuler(&'a Derivative),
}

/// Rows of the tableau.
const ROWS: usize = 8;
/// What grows grows by less than e to this power in a step that is linearly implicit.
const GROWTH: f64 = 1.0;
/// Most steps before the reference gives up.
const MOST_STEPS: usize = 40_000;

/// A state and its time.
pub type Place = (f64, Vec<f64>);

/// What the reference found.
pub struct Followed {
    /// The states at the times that were asked for.
    pub states: Vec<Vec<f64>>,
    /// The ends of its own steps.
    pub way: Vec<Place>,
}

/// The states at ascending times after the start, or `None` where the reference does not get there.
/// The local error is held to `tolerance (size + |y|)` in each component.
pub fn follow(
    slope: &Slope,
    rule: Extrapolation<'_>,
    (start, sizes): (&Place, &[f64]),
    times: &[f64],
    tolerance: f64,
) -> Option<Followed> {
    let (mut t, mut y) = start.clone();
    let mut step = 1e-4 * (times.last()? - t);
    let mut states = Vec::with_capacity(times.len());
    let mut way = Vec::new();
    let mut tried = 0;
    let power = match rule {
        Extrapolation::Midpoint => 2 * ROWS as i32 - 1,
        Extrapolation::LinearlyImplicitEuler(_) => ROWS as i32,
    };
    for &end in times {
        while t < end {
            tried += 1;
            if tried > MOST_STEPS || step < 1e-15 * end.abs() {
                return None;
            }
            let h = if t + 1.01 * step >= end { end - t } else { step };
            let found = big_step(slope, rule, (t, &y), h);
            let error = found.as_ref().map_or(f64::NAN, |(next, change)| {
                let terms = next.iter().zip(&y).zip(change).zip(sizes);
                terms
                    .map(|(((a, b), d), s)| d.abs() / (tolerance * (s + a.abs().max(b.abs()))))
                    .fold(0.0, |worst: f64, e| if e > worst || e.is_nan() { e } else { worst })
            });
            let factor = 0.8 * error.max(1e-12).powf(-1.0 / f64::from(power));
            match found {
                Some((next, _)) if error <= 1.0 => {
                    y = next;
                    way.push((t + h, y.clone()));
                    t = if h == end - t { end } else { t + h };
                    // A last step that was cut short says little of the next one.
                    if h >= step {
                        step = h * factor.clamp(0.1, 4.0);
                    }
                }
                _ => step = h * if factor.is_nan() { 0.1 } else { factor.clamp(0.05, 0.7) },
            }
        }
        states.push(y.clone());
    }
    Some(Followed { states, way })
}

/// The state `h` later, and how far its last two extrapolations are apart.
fn big_step(
    slope: &Slope,
    rule: Extrapolation<'_>,
    (t, y): (f64, &[f64]),
    h: f64,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let jacobian = match rule {
        Extrapolation::Midpoint => None,
        Extrapolation::LinearlyImplicitEuler(derivative) => {
            let mut matrix = DMatrix::zeros(y.len(), y.len());
            derivative(t, y, matrix.as_mut_slice());
            if h * fastest_growth(&matrix)? > GROWTH {
                return None;
            }
            Some(matrix)
        }
    };
    let mut last: Vec<Vec<f64>> = Vec::new();
    for j in 1..=ROWS {
        let first = match &jacobian {
            None => midpoint(slope, (t, y), h, 2 * j),
            Some(jacobian) => implicit_euler(slope, jacobian, (t, y), h, j)?,
        };
        let mut row = vec![first];
        for k in 1..j {
            let quotient = j as f64 / (j - k) as f64;
            let ratio = if jacobian.is_none() { quotient * quotient } else { quotient };
            let improved = row[k - 1].iter().zip(&last[k - 1]);
            row.push(improved.map(|(a, b)| a + (a - b) / (ratio - 1.0)).collect());
        }
        last = row;
    }
    let best = last[ROWS - 1].clone();
    if best.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let change = best.iter().zip(&last[ROWS - 2]).map(|(a, b)| a - b).collect();
    Some((best, change))
}

/// The largest real part of the eigenvalues that is not rounding: a long implicit step lets what grows
/// decay, and no extrapolation notices where it begins small.
fn fastest_growth(matrix: &DMatrix<f64>) -> Option<f64> {
    let eigenvalues = Schur::try_new(matrix.clone(), f64::EPSILON, 1000)?.complex_eigenvalues();
    let rounding = 1e-12 * matrix.norm();
    let rates = eigenvalues.iter().map(|value| value.re).filter(|&rate| rate > rounding);
    Some(rates.fold(0.0, f64::max))
}

fn midpoint(slope: &Slope, (t, y): (f64, &[f64]), h: f64, count: usize) -> Vec<f64> {
    let small = h / count as f64;
    let mut f = vec![0.0; y.len()];
    slope(t, y, &mut f);
    let mut before = y.to_vec();
    let mut now: Vec<f64> = y.iter().zip(&f).map(|(y, f)| y + small * f).collect();
    for i in 1..count {
        slope(t + i as f64 * small, &now, &mut f);
        for ((before, now), f) in before.iter_mut().zip(&mut now).zip(&f) {
            let next = *before + 2.0 * small * f;
            *before = *now;
            *now = next;
        }
    }
    now
}

fn implicit_euler(
    slope: &Slope,
    jacobian: &DMatrix<f64>,
    (t, y): (f64, &[f64]),
    h: f64,
    count: usize,
) -> Option<Vec<f64>> {
    let (n, small) = (y.len(), h / count as f64);
    let lu = (DMatrix::identity(n, n) - small * jacobian).lu();
    let mut now = y.to_vec();
    let mut f = DVector::zeros(n);
    for i in 1..=count {
        slope(t + i as f64 * small, &now, f.as_mut_slice());
        let change = lu.solve(&(&f * small))?;
        now.iter_mut().zip(change.iter()).for_each(|(y, d)| *y += d);
    }
    Some(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_references_follow_a_decay_with_an_oscillation() {
        let slope: Slope = Box::new(|_, y, f| {
            f.copy_from_slice(&[-y[0] - 5.0 * y[1], 5.0 * y[0] - y[1], -1e4 * (y[2] - y[0])]);
        });
        let derivative: Derivative = Box::new(|_, _, df| {
            df.copy_from_slice(&[-1.0, 5.0, 1e4, -5.0, -1.0, 0.0, 0.0, 0.0, -1e4]);
        });
        let times = [0.3, 1.0];
        let start = (0.0, vec![1.0, 0.0, 1.0]);
        for rule in [Extrapolation::Midpoint, Extrapolation::LinearlyImplicitEuler(&derivative)] {
            let states = follow(&slope, rule, (&start, &[1.0; 3]), &times, 1e-12);
            let end = &states.unwrap().states[1];
            let decay = (-1.0_f64).exp();
            assert!((end[0] - decay * 5.0_f64.cos()).abs() < 1e-9, "{end:?}");
            assert!((end[1] - decay * 5.0_f64.sin()).abs() < 1e-9, "{end:?}");
        }
    }
}
