//! Bodies that overlap, pushed apart by the least motion that frees them.
//!
//! ```text
//! min 1/2 |d|^2 in the metric M,   g + dg d >= 0,   q <- q moved along d          again and again
//! ```
//! `g` gaps (m) of what overlaps or is near, `d` a motion of all bodies (m and rad), a light body
//! gives way to a heavy one. Gaps are linear in each round, so that a few rounds are needed; the
//! bound on them is reached where bodies are so deep in each other that their gaps lead nowhere.
//! Source: the projection of notes 11.5.1, on positions.

use stationary_calculus::{Potential, SizeError, Space, Vector};

use crate::impact::projection::project_biased;
use crate::{BodiesIn, ContactError, DetectorIn, Dimension, Impact, InverseMass, gap_rows};

/// Rounds after which bodies are given up.
const ROUNDS: usize = 100;

/// Moves bodies of a system until none overlaps by more than `depth` (m); says in how many rounds.
///
/// # Errors
/// A depth that is negative or no number, a detector of other bodies, poses that are none, and bodies that still overlap after
/// a hundred rounds; the poses are then as they were.
pub fn push_apart<G: Dimension, P: Potential>(
    system: &BodiesIn<G, P>,
    detector: &mut DetectorIn<G>,
    q: &mut [f64],
    depth: f64,
) -> Result<usize, ContactError> {
    if !(depth >= 0.0 && depth.is_finite()) {
        return Err(ContactError::Depth(depth));
    }
    SizeError::check("the detector's bodies", system.dim() / G::FREEDOMS, detector.bodies())?;
    SizeError::check("the poses' numbers", G::STORED * detector.bodies(), q.len())?;
    let mass = InverseMass::of(system.metric())?;
    let mut next = q.to_vec();
    let mut near = depth;
    for round in 0..ROUNDS {
        let contacts = detector.detect(&next, near)?;
        let deepest = contacts.iter().map(|contact| -contact.gap).fold(0.0, f64::max);
        if deepest <= depth {
            q.copy_from_slice(&next);
            return Ok(round);
        }
        // What is near could come to overlap.
        near = 2.0 * deepest;
        let contacts = detector.detect(&next, near)?;
        let gaps: Vec<f64> = contacts.iter().map(|contact| contact.gap).collect();
        let impact = Impact::new(gap_rows(contacts, &next), &mass, vec![0.0; gaps.len()])?;
        let mut motion = Vector(vec![0.0; system.dim()]);
        project_biased(&impact, &gaps, motion.view_mut())?;
        system.space().advance(&mut next, 1.0, motion.view());
    }
    detector.check_free(&next, depth)?;
    q.copy_from_slice(&next);
    Ok(ROUNDS)
}
