//! Static assembly: a closed pose near a guess, or the plain word that there is none near.
//!
//! ```text
//! min 1/2 |D g(q)|^2,     (A A^T + mu diag(A A^T)) y = D g,    q <- q exp(-M^-1/2 A^T y)
//! ```
//! `A = D J M^-1/2`; `D` one over slope and length of each equation, so that gaps of metres and of radians are parts of
//! their own things; `mu` the damping of Levenberg and Marquardt, which falls where a
//! step helps and grows where it does not. Redundant equations do no harm. It ends at a closed pose, or
//! where the gap is smallest although open: then no pose near is closed. Heavy bodies move least; where
//! light ones alone find no way, all move alike, with radii of gyration for `M^-1/2`.

use nalgebra::DVector;
use stationary_calculus::Vector;
use stationary_constraints::{Constraint, Measure, equation_name};

use super::MechanismError;
use super::differential::{full, inverse_roots, lengths, scale, weights};
use super::error::check_finite;
use crate::{Body, BodyMetric, BodySpace};

/// A closed pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// The configuration.
    pub q: Vec<f64>,
    /// The largest gap that is left, metres or radians.
    pub gap: f64,
    /// Steps that were tried.
    pub iterations: u32,
}

/// Steps at most.
const ITERATIONS: u32 = 500;
/// A gap of this part of its equation's length is closed, and one of so many roundings of a place.
const CLOSED: f64 = 1e-13;
const ROUNDINGS: f64 = 8.0;
/// A gap whose slope is this part of itself does not close.
const LEVEL: f64 = 1e-7;

/// Moves a configuration to one where all equations hold at the time `t`.
///
/// # Errors
/// [`MechanismError::NotAssembled`] where the gap is smallest and open, [`MechanismError::TooFar`] after
/// too many steps; a guess with too few numbers, or numbers that are not finite.
pub fn assemble<S: BodySpace>(
    metric: &BodyMetric<S>,
    constraint: &impl Constraint,
    t: f64,
    guess: &[f64],
) -> Result<Assembly, MechanismError> {
    check_finite("the guess", guess)?;
    let gyration = |body: &Body| (body.moments().max() / body.mass()).sqrt();
    let reach = metric.bodies().iter().map(gyration).fold(0.0, f64::max);
    closed::<S>(&inverse_roots(metric), reach, constraint, t, guess).or_else(|error| match error {
        MechanismError::NotAssembled { .. } | MechanismError::TooFar { .. } => {
            closed::<S>(&lengths(metric), reach, constraint, t, guess)
        }
        _ => Err(error),
    })
}

/// The pose, with freedoms in these scales, of bodies with such a radius of gyration.
fn closed<S: BodySpace>(
    scales: &DVector<f64>,
    reach: f64,
    constraint: &impl Constraint,
    t: f64,
    guess: &[f64],
) -> Result<Assembly, MechanismError> {
    let (n, count) = (scales.len(), constraint.count());
    let measured: Vec<_> = (0..count).map(|row| constraint.scale(row)).collect();
    let is_turn = |row: usize| matches!(measured[row].measure, Measure::Turn(_));
    let of_none = |length: f64| if length > 0.0 { length } else { reach };
    let lengths = DVector::from_fn(count, |row, _| of_none(measured[row].length));
    // A turn makes a way at the size of the bodies, as far as places are rounded.
    let size =
        (0..count).filter(|&row| !is_turn(row)).fold(reach, |size, row| size.max(lengths[row]));
    let rounded = DVector::from_fn(count, |row, _| if is_turn(row) { size } else { lengths[row] });
    let weights = weights(constraint).component_div(&lengths);
    let values = |q: &[f64]| -> Result<DVector<f64>, MechanismError> {
        let mut g = vec![0.0; count];
        constraint.value(t, q, &mut g)?;
        Ok(DVector::from_vec(g).component_mul(&weights))
    };
    let is_closed = |q: &[f64], g: &DVector<f64>| {
        // A place is rounded, and a quaternion's numbers are no lengths.
        let places = q.chunks(S::STORED).flat_map(|q| q.iter().take(S::TRANSLATION));
        let far = places.fold(0.0_f64, |far, x| far.max(x.abs()));
        let allowed = |length: &f64| CLOSED + ROUNDINGS * f64::EPSILON * far / length;
        g.iter().zip(&rounded).all(|(g, length)| g.abs() <= allowed(length))
    };
    let mut q = guess.to_vec();
    let mut g = values(&q)?;
    let mut damping = 1e-6;
    for iterations in 0..ITERATIONS {
        check_finite("the gaps", g.as_slice())?;
        if is_closed(&q, &g) {
            let gap = g
                .iter()
                .zip(&lengths)
                .fold(0.0, |gap, (g, length)| f64::max(gap, g.abs() * length));
            return Ok(Assembly { q, gap, iterations });
        }
        let mut a = full(constraint, n, t, &q)?;
        scale(&mut a, &weights, scales)?;
        let slopes = DVector::from_iterator(count, a.row_iter().map(|row| row.norm()));
        if a.tr_mul(&g).norm() <= LEVEL * slopes.component_mul(&g).norm() {
            let (row, name, gap) = worst(constraint, &g, &lengths);
            return Err(MechanismError::NotAssembled { row, name, gap });
        }
        let mut matrix = &a * a.transpose();
        let least = f64::EPSILON * slopes.amax().powi(2) * f64::EPSILON;
        for k in 0..count {
            matrix[(k, k)] += damping * slopes[k].powi(2).max(least);
        }
        let step =
            matrix.cholesky().map(|factor| a.tr_mul(&factor.solve(&g)).component_mul(scales));
        let tried = step.map(|step| {
            let mut next = q.clone();
            S::SPACE.advance(&mut next, -1.0, Vector(step.as_slice()));
            values(&next).map(|g| (next, g))
        });
        match tried.transpose()? {
            Some((next, gaps)) if gaps.norm() < g.norm() => {
                (q, g) = (next, gaps);
                damping = f64::max(1e-15, 0.1 * damping);
            }
            _ => damping *= 10.0,
        }
        if damping > 1e15 {
            let (row, name, gap) = worst(constraint, &g, &lengths);
            return Err(MechanismError::NotAssembled { row, name, gap });
        }
    }
    let (row, name, gap) = worst(constraint, &g, &lengths);
    Err(MechanismError::TooFar { iterations: ITERATIONS, row, name, gap })
}

/// The equation that is open most beside its length, its name and by how much.
fn worst(
    constraint: &impl Constraint,
    g: &DVector<f64>,
    lengths: &DVector<f64>,
) -> (usize, String, f64) {
    let row = g.iamax();
    (row, equation_name(constraint, row), g[row].abs() * lengths[row])
}
