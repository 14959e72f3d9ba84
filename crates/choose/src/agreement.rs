//! Whether a run of another kind agrees with a reference over the whole way of a choice.
//!
//! At the moments it is looked for first (`confirm.rs`); what agrees there is read off along the way, or looked at
//! there, and finer runs are made until one does there too. The choice must keep to the tolerance by both: two runs
//! of one kind may come near each other by luck, where a third shows how far they are off.

use std::collections::BTreeMap;

use crate::confirm::{Confirmed, PATIENCE, confirmed, next_rung};
use crate::effort::Purpose;
use crate::grid::Within;
use crate::ladder::{At, Kind};
use crate::ladder_search::rungs_to_go;
use crate::look::{Look, apart, apart_where_own};
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

/// A choice and its reference at the moments of its way; bounds in the observable's unit.
pub struct Judged<'w> {
    /// The moments.
    pub way: &'w Way,
    /// The choice there.
    pub own: &'w Look,
    /// The reference there.
    pub truth: &'w Look,
    /// What the choice may be off.
    pub promised: f64,
    /// How near to the reference a run of another kind must come.
    pub near: f64,
    /// What reading that run off between its samples may lose.
    pub allowed: f64,
}

impl Judged<'_> {
    /// How far another run is from the reference, at all moments of the way; and whether the choice keeps to the
    /// tolerance by it.
    fn by(&self, other: &Look) -> (f64, bool) {
        (
            apart_where_own(other, self.truth),
            apart(&self.own.values, &other.values) <= self.promised,
        )
    }
}

/// A run of another kind, or what its runs lead to, that is near the reference over the whole way.
pub fn agreement(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    judged: &Judged<'_>,
    families: &[usize],
) -> Agreement {
    let scale = reference.course.scale;
    match confirmed(runs, reference, judged.near / scale, families) {
        Confirmed::Alone => Agreement::Alone,
        Confirmed::No => Agreement::None,
        Confirmed::Led(other) => {
            let at = At { family: other.family, rung: other.finest };
            let Some((other, _)) = whole_way(runs, &other, judged.way, judged.allowed) else {
                return Agreement::None;
            };
            match judged.by(&other) {
                (off, true) if off <= judged.near => Agreement::With(at, off / scale),
                _ => finer_agrees(runs, reference, judged, (at, families)),
            }
        }
        Confirmed::By(first) => finer_agrees(runs, reference, judged, (first, families)),
    }
}

/// Looks at ever finer runs of other kinds, the cheapest first, until one is near over the whole way.
fn finer_agrees(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    judged: &Judged<'_>,
    (first, families): (At, &[usize]),
) -> Agreement {
    let scale = reference.course.scale;
    let near = judged.near / scale;
    let most = PATIENCE * runs.spent();
    let mut least = f64::INFINITY;
    // The rung of each family that comes next.
    let mut next: BTreeMap<usize, usize> = BTreeMap::from([(first.family, first.rung)]);
    let mut at = first;
    for _ in 0..FINER {
        runs.measure(at);
        runs.turn_to(Purpose::WithinOther);
        let found = off_other(runs, reference, at, judged);
        runs.turn_to(Purpose::Confirmation);
        if let Some((off, holds)) = found {
            let off = off / scale;
            if holds && off <= near {
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

/// How far a run of another kind is from the reference, in the observable's unit, and whether the choice holds by it:
/// at all moments of a way where its samples tell it there, or it reads off its own steps; else at these samples.
fn off_other(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    judged: &Judged<'_>,
) -> Option<(f64, bool)> {
    let is_adaptive = runs.family(at.family).kind == Kind::Adaptive;
    let mut all: Option<Look> = None;
    for (grid, within) in &judged.way.grids {
        let read = runs.read_off(at, (grid, *within), judged.allowed).map(|(look, _)| look);
        let Some(look) =
            read.or_else(|| is_adaptive.then(|| runs.look(at, grid, *within)).flatten())
        else {
            let ends = samples(runs, at, LEAST_HALVINGS);
            let (other, _) = runs.read(at, (&ends, Within::Ends), 0.0)?;
            let of = (&ends, Within::Ends);
            let (truth, _) = told(runs, reference, of, judged.allowed, MeasuredRuns::read)?;
            return Some((apart_where_own(&other, &truth), true));
        };
        all = Some(all.map_or_else(|| Look::clone(&look), |before| before.and(&look)));
    }
    Some(judged.by(&all?))
}
