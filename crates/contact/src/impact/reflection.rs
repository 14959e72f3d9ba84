//! Reflections about the inelastic projection: elastic impacts of many contacts at once.
//!
//! ```text
//! v= = v- + M^-1 dg^T lambda                    the projection (11.1), onto some of the contacts
//! v+ = v= + s M^-1 dg^T C lambda,  C = diag(c)  overshot by the restitution
//! T+ - T- = 1/2 (s^2 |C lambda|_A^2 - |lambda|_A^2),   A = dg M^-1 dg^T
//! s = min(1, |lambda|_A / |C lambda|_A)         1 wherever the restitutions agree
//! ```
//! With `c = 1` it is a reflection in the kinetic metric: energy is kept, as the projection is the
//! foot of the perpendicular (Moreau). Restitutions that differ could gain energy; `s` is the
//! largest overshoot that does not.
//!
//! Blended: the projection knows all contacts that touch (errata 11.5.1). Generalized reflections:
//! only those that approach, so that what merely touches is free to break away: Newton's cradle
//! comes out right. Either repeats until nothing approaches. Source: Smith, Kaufman, Vouga,
//! Tamstorf and Grinspun, "Reflections on simultaneous impact" (SIGGRAPH 2012), for the approaching
//! set at `c = 1`; the overshoot by contact and its cap are ours.

use stationary_calculus::Vector;

use crate::impact::projection::project_onto;
use crate::{ContactError, Impact, ImpactReport};

/// What approaches slower than this part of the fastest approach waits for a pass of its own: two
/// balls that fly side by side touch but for rounding, and an impact must not depend on that.
const SLOW: f64 = 1e-9;

/// The projection alone.
pub(crate) fn project(
    impact: &Impact,
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) -> Result<(), ContactError> {
    overshoot(impact, &all(impact), &vec![0.0; impact.len()], v, report)
}

/// The blended law.
pub(crate) fn overshoot_all(
    impact: &Impact,
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) -> Result<(), ContactError> {
    overshoot(impact, &all(impact), impact.restitution(), v, report)
}

/// Generalized reflections.
pub(crate) fn overshoot_approaching(
    impact: &Impact,
    rounding: f64,
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) -> Result<(), ContactError> {
    let fastest = (0..impact.len()).map(|i| -impact.relative_velocity(i, v.view()));
    let least = rounding.max(SLOW * fastest.fold(0.0, f64::max));
    let approaching = |&i: &usize| impact.relative_velocity(i, v.view()) < -least;
    let approaching: Vec<usize> = (0..impact.len()).filter(approaching).collect();
    overshoot(impact, &approaching, impact.restitution(), v, report)
}

fn all(impact: &Impact) -> Vec<usize> {
    (0..impact.len()).collect()
}

fn overshoot(
    impact: &Impact,
    contacts: &[usize],
    restitution: &[f64],
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) -> Result<(), ContactError> {
    let no_guess = vec![0.0; impact.len()];
    let before = v.clone();
    let done = project_onto(impact, contacts, &no_guess, v.view_mut())?;
    report.solves += done.solves;
    let mut beyond = Vector(vec![0.0; impact.freedoms()]);
    for &i in contacts {
        impact.push(i, restitution[i] * done.impulses[i], beyond.view_mut());
    }
    let square = |i: &usize| {
        let lambda = done.impulses[*i];
        let projected = -lambda * impact.relative_velocity(*i, before.view());
        let overshot = restitution[*i] * lambda * impact.relative_velocity(*i, beyond.view());
        (projected, overshot)
    };
    let squares = contacts.iter().map(square);
    let (projected, overshot) = squares.fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    // Rounding of the two sums must not scale an impact that keeps its energy.
    let capped = overshot > projected * (1.0 + 1e-12);
    let s = if capped { (projected / overshot).sqrt() } else { 1.0 };
    v.add_scaled(s, beyond.view());
    for &i in contacts {
        report.impulses[i] += (1.0 + s * restitution[i]) * done.impulses[i];
    }
    Ok(())
}
