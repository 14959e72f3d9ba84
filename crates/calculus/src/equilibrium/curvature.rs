//! The direction in which an energy bends least, by inverse iteration with the factor of a shifted
//! Hessian.
//!
//! ```text
//! x <- (H + sigma M)^-1 M x,    rho = <H x, x> / <M x, x>
//! ```
//! `sigma` is lowered as far as the shifted matrix stays definite, which brings the lowest eigenvalue
//! apart from the others. rho is negative where it exceeds what rounding makes of its terms.
//! Source: Parlett, The symmetric eigenvalue problem, chapter 4.

use super::asked::Asked;
use super::terms::{dot, length};
use crate::{Rung, Unsolvable};
use stationary_measure::SplitMix64;

/// Rounds of inverse iteration, with a smaller shift each.
const ROUNDS: u32 = 8;
/// Products a round.
const POWERS: u32 = 6;
/// Rounds more with the last shift, until the quotient changes by less than a part of itself: the
/// direction is then known to the root of it.
const POLISH: u32 = 6;
const SETTLED: f64 = 1e-13;
/// What a Rayleigh quotient must exceed, relative to its terms, to have a sign.
const ROUNDING: f64 = 1e-10;
/// The smallest shift, relative to the Hessian's scale.
const SMALLEST: f64 = 1e-12;

/// The lowest curvature that was found.
#[derive(Clone, Debug)]
pub(super) struct Lowest {
    /// Its direction, of length 1 in the metric.
    pub(super) direction: Vec<f64>,
    /// `<H x, x>`, 1/s^2.
    pub(super) curvature: f64,
    /// Whether it is negative beyond rounding.
    pub(super) is_negative: bool,
    /// The shift with which the solver is left, 1/s^2.
    pub(super) sigma: f64,
}

/// Finds the lowest curvature at q. The solver is left with the factor of `H + sigma M`, for the
/// smallest sigma for which it is known to be definite; `None` where there is none.
pub(super) fn lowest(
    asked: &mut dyn Asked,
    q: &[f64],
    scale: f64,
) -> Result<Option<Lowest>, Unsolvable> {
    let Some(mut sigma) = definite_shift(asked, q, scale)? else {
        return Ok(None);
    };
    let mut random = SplitMix64::new(7);
    let mut x: Vec<f64> = (0..q.len()).map(|_| random.symmetric()).collect();
    let mut found = iterate(asked, q, &mut x);
    for _ in 0..ROUNDS {
        let smaller = if found.is_negative {
            1.5 * found.curvature.abs()
        } else {
            (1e-2 * sigma).max(SMALLEST * scale)
        };
        if smaller > 0.5 * sigma {
            break;
        }
        if factors(asked, q, smaller)? {
            sigma = smaller;
            found = iterate(asked, q, &mut x);
        } else {
            // Some eigenvalue is below -smaller: the shift in between shows it.
            let between = (sigma * smaller).sqrt();
            if between < 0.5 * sigma && factors(asked, q, between)? {
                sigma = between;
            } else if !factors(asked, q, sigma)? {
                return Ok(None);
            }
            let next = iterate(asked, q, &mut x);
            let settled = found.is_negative
                && (next.curvature - found.curvature).abs() <= 0.1 * found.curvature.abs();
            found = next;
            if settled {
                break;
            }
        }
    }
    for _ in 0..POLISH {
        let before = found.curvature;
        if !found.is_negative {
            break;
        }
        found = iterate(asked, q, &mut x);
        if (found.curvature - before).abs() <= SETTLED * before.abs() {
            break;
        }
    }
    found.sigma = sigma;
    Ok(Some(found))
}

/// Factors the shifted Hessian; whether it is definite.
fn factors(asked: &mut dyn Asked, q: &[f64], sigma: f64) -> Result<bool, Unsolvable> {
    match asked.factor(sigma, q) {
        Ok(rung) => Ok(rung == Rung::Cholesky),
        Err(Unsolvable::Singular | Unsolvable::Untrusted { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// The first shift of a ladder for which the shifted Hessian is definite.
fn definite_shift(asked: &mut dyn Asked, q: &[f64], scale: f64) -> Result<Option<f64>, Unsolvable> {
    if !(scale > 0.0 && scale.is_finite()) {
        return Ok(None);
    }
    for multiple in [SMALLEST, 1e-7, 1e-2, 2.0, 200.0, 2e4] {
        if factors(asked, q, multiple * scale)? {
            return Ok(Some(multiple * scale));
        }
    }
    Ok(None)
}

/// A few powers of the inverse, from x on, and the quotient there.
fn iterate(asked: &mut dyn Asked, q: &[f64], x: &mut [f64]) -> Lowest {
    let n = x.len();
    let mut y = vec![0.0; n];
    for _ in 0..POWERS {
        asked.flat(x, &mut y);
        asked.solve(&mut y);
        let size = length(asked, &y, x);
        if !(size > 0.0 && size.is_finite()) {
            break;
        }
        x.iter_mut().zip(&y).for_each(|(x, y)| *x = y / size);
    }
    let size = length(asked, x, &mut y);
    if size > 0.0 {
        x.iter_mut().for_each(|x| *x /= size);
    }
    y.fill(0.0);
    asked.add_product(q, x, &mut y);
    let curvature = dot(&y, x);
    let mut terms = vec![0.0; n];
    asked.magnitudes(q, x, &mut terms);
    let size: f64 = terms.iter().zip(&*x).map(|(t, x)| t * x.abs()).sum();
    Lowest {
        direction: x.to_vec(),
        curvature,
        is_negative: curvature < -ROUNDING * size,
        sigma: 0.0,
    }
}
