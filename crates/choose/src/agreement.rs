//! Whether a run of another kind agrees with a reference over the whole way of a choice.
//!
//! At the moments it is looked for first (`confirm.rs`); what agrees there is read off along the way, and finer
//! runs are made until one does there too.

use std::collections::BTreeMap;

use crate::confirm::{Confirmed, PATIENCE, confirmed, next_rung};
use crate::effort::Purpose;
use crate::grid::Within;
use crate::ladder::At;
use crate::ladder_search::rungs_to_go;
use crate::look::{Look, apart_where_own};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::{LEAST_HALVINGS, samples, told, whole_way};
use crate::way::Way;

/// Runs of other kinds that are looked at where the first is too far between the moments.
const FINER: usize = 12;

/// Whether another kind agrees with a reference over the whole way.
pub enum Agreement {
    /// This run does, or what its family's runs lead to, to within so much.
    With(At, f64),
    /// The nearest differs by so much.
    Disagrees(f64),
    /// There is one kind only.
    Alone,
    /// None was found.
    None,
}

/// A run of another kind, or what its runs lead to, that is near the reference over the whole way.
pub fn agreement(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (near, way, allowed): (f64, &Way, f64),
    families: &[usize],
    truth: &Look,
) -> Agreement {
    let scale = reference.course.scale;
    match confirmed(runs, reference, near, families) {
        Confirmed::Alone => Agreement::Alone,
        Confirmed::No => Agreement::None,
        Confirmed::Led(other) => {
            let at = At { family: other.family, rung: other.finest };
            let Some((other, _)) = whole_way(runs, &other, way, allowed) else {
                return Agreement::None;
            };
            let off = apart_where_own(&other, truth) / scale;
            match off <= near {
                true => Agreement::With(at, off),
                false => finer_agrees(runs, reference, (near, way, allowed), (at, families), truth),
            }
        }
        Confirmed::By(first) => {
            finer_agrees(runs, reference, (near, way, allowed), (first, families), truth)
        }
    }
}

/// Looks at ever finer runs of other kinds, the cheapest first, until one is near over the whole way.
fn finer_agrees(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (near, way, allowed): (f64, &Way, f64),
    (first, families): (At, &[usize]),
    truth: &Look,
) -> Agreement {
    let most = PATIENCE * runs.spent();
    let mut least = f64::INFINITY;
    // The rung of each family that comes next.
    let mut next: BTreeMap<usize, usize> = BTreeMap::from([(first.family, first.rung)]);
    let mut at = first;
    for _ in 0..FINER {
        runs.measure(at);
        runs.turn_to(Purpose::WithinOther);
        let off = off_other(runs, reference, at, (way, truth), allowed);
        runs.turn_to(Purpose::Confirmation);
        if let Some(off) = off {
            let off = off / reference.course.scale;
            if off <= near {
                return Agreement::With(at, off);
            }
            least = least.min(off);
            next.insert(at.family, at.rung + rungs_to_go(runs.family(at.family), near, off));
        } else {
            next.insert(at.family, at.rung + 1);
        }
        let rung = |runs: &MeasuredRuns<'_>, family: usize| match next.get(&family) {
            Some(&rung) => {
                Some(At { family, rung }).filter(|at| at.rung < runs.family(family).rungs.len())
            }
            None => next_rung(runs, reference, near, family),
        };
        let others = families.iter().filter(|&&family| family != reference.family);
        let others = others.filter_map(|&family| rung(runs, family));
        let affordable = others.filter(|&at| runs.affords(at) && runs.predicted(at) <= most);
        match affordable.min_by_key(|&at| (runs.predicted(at), at)) {
            Some(cheapest) if !runs.late() => at = cheapest,
            _ => break,
        }
    }
    if least.is_finite() { Agreement::Disagrees(least) } else { Agreement::None }
}

/// How far a run of another kind is from the reference, in the observable's unit: at all moments of a way
/// where its samples tell it there, else at these samples.
fn off_other(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    (way, truth): (&Way, &Look),
    allowed: f64,
) -> Option<f64> {
    let track = runs.seen(at)?.track.clone();
    let mut all: Option<Look> = None;
    for (grid, within) in &way.grids {
        let moments = runs.moments(grid, *within)?;
        let reading = track.as_ref().map(|track| track.read(&moments.times));
        let Some(reading) = reading.filter(|reading| reading.off <= allowed) else {
            let ends = samples(runs, at, LEAST_HALVINGS);
            let (other, _) = runs.read(at, (&ends, Within::Ends), 0.0)?;
            let (truth, _) =
                told(runs, reference, (&ends, Within::Ends), allowed, MeasuredRuns::read)?;
            return Some(apart_where_own(&other, &truth));
        };
        all = Some(all.map_or_else(|| reading.look.clone(), |before| before.and(&reading.look)));
    }
    Some(apart_where_own(&all?, truth))
}
