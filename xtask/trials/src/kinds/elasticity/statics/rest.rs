//! Whether a place is one of rest, by a body of the trials' own.

use stationary_elasticity::{ElasticityError, Held};

use super::super::body::Body;
use super::EPS;
use super::problem::{Rest, free, plain};
use crate::Verdict;

/// What was found is at rest under its load, and stays there.
pub fn judged<const D: usize>(
    solved: Result<Rest<D>, ElasticityError>,
    body: &Body,
    places: &[[f64; D]],
    forces: &[[f64; D]],
    held: &[Held],
) -> Verdict {
    let rest = match solved {
        Ok(rest) => rest,
        Err(error) => return Verdict::refused(error),
    };
    let free = free(places.len(), D, held);
    judge_rest(body, &plain(&rest.positions), &plain(forces), &free, &plain(places))
}

/// Right where one more dense step of Newton's method moves nothing and the Hessian is definite.
fn judge_rest(
    body: &Body,
    x: &[Vec<f64>],
    forces: &[Vec<f64>],
    free: &[usize],
    before: &[Vec<f64>],
) -> Verdict {
    let Some(correction) = body.correction(x, forces, free) else {
        return Verdict::not_judged("eigenvalues");
    };
    let moved = x.iter().flatten().zip(before.iter().flatten());
    let moved = moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = before.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    let promised = 1e-6 * moved + 20.0 * correction.rounding + 20.0 * EPS * size;
    let verdict = Verdict::of(correction.length, promised, "distance from rest");
    if correction.least < -1e-9 {
        return Verdict::wrong(format!(
            "a saddle: the least eigenvalue is {:e} of the largest",
            correction.least
        ));
    }
    verdict
}
