//! Whether a choice keeps to the tolerance over its whole way, and whether its reference is trusted.
//!
//! ```text
//! error          max_t |x(t) - x*(t)| / scale        over its whole way (`way.rs`)
//! uncertainty    of x*, grown as its last two runs differ more at their samples than at the moments,
//!                and by what is lost where it is read off between them (`track.rs`)
//! ```
//! A reference is trusted where a run of another kind agrees with it over the whole way, and where it
//! keeps the energy ten times better than the tolerance asks if nothing takes any. Where
//! something does, or where there is but one kind of method, agreement alone is left: with another kind
//! to half of the tolerance, or with itself. What agrees with energies that are kept need come only as
//! near as the tolerance, and with a closed form not so near.

use std::fmt;
use std::sync::Arc;

use crate::agreement::{Agreement, Judged, agreement};
use crate::closer::{CLOSELY_BETWEEN, largest, largest_where_it_jumps};
use crate::effort::Purpose;
use crate::grid::{Grid, Within};
use crate::ladder::{At, Kind, MOMENTS};
use crate::look::{Look, apart, apart_where_own};
use crate::measured_runs::MeasuredRuns;
use crate::reference::{Extrapolated, Reference};
use crate::search::BARELY;
use crate::seen::{Seen, off_places};
use crate::way::{ONE_OF_ANOTHER, Way, nothing};

/// Why a reference is not trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// A run cannot be looked at over its whole way, or the budget is over.
    Unseen,
    /// It should keep its energy and does not.
    Energy(f64),
    /// Its own runs differ too much between the moments.
    Uncertain(f64),
    /// Another kind of method comes to something else.
    Disagrees(f64),
    /// Too many choices turned out to be wrong between the moments.
    Restless,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Doubt::Unseen => {
                f.write_str("a run could not be followed over its whole way within the budget")
            }
            Doubt::Energy(off) => write!(
                f,
                "nothing takes energy, but the reference's changes by {off:.1e} of the largest kinetic \
                 energy"
            ),
            Doubt::Uncertain(off) => {
                write!(f, "over the whole way the reference is uncertain by {off:.1e}")
            }
            Doubt::Disagrees(off) => write!(
                f,
                "over the whole way a method of another kind differs from the reference by {off:.1e}"
            ),
            Doubt::Restless => {
                f.write_str("every run that met it at the moments misses it between them")
            }
        }
    }
}

/// What is found.
pub enum Finding {
    /// The choice holds, by a reference that is trusted.
    Holds(Seen),
    /// The same, but no other kind of method was found to agree with the reference.
    Unconfirmed(Seen),
    /// The choice's error over the whole way, which is or may be beyond the tolerance.
    Beyond(f64),
    /// The scale is larger than the moments have shown.
    Larger(f64),
    /// The reference is not trusted.
    Doubtful(Doubt),
}

/// The part of the tolerance to which a reference keeps what is kept.
const KEPT: f64 = 0.1;
/// Scales that differ by less are the same.
const SAME_SCALE: f64 = 1.01;
/// How near another kind must come, in tolerances: to what keeps its energy, and to a closed form, where
/// it is never asked for more than a part of the scale. Energy alone does not do: one that is kept to a
/// part of its largest value, in a close encounter, is lost against the others.
const NEAR_KEPT: f64 = 1.0;
const NEAR_CLOSED: f64 = 100.0;
const NEAR: f64 = 0.1;
/// How much larger an error may be between two moments.
const BETWEEN: f64 = 1.05;
/// Moments at which another kind is compared: a twentieth of the horizon, halved so often.
pub const LEAST_HALVINGS: u32 = 1;
const MOST_HALVINGS: u32 = 7;
/// How far below the tolerance the error of another motion must be in some of its steps, so that the others are
/// not looked into as closely.
const SURELY: f64 = 4.0;
/// The part of the tolerance below which an error at three moments of a step is small enough where something may
/// happen at once.
const SURELY_JUMPING: f64 = 0.25;
/// Steps that a reference takes between two moments where there is more to see than these show.
const HURRIED: usize = 16;
/// Places that are off by this part of the largest way are those of another motion.
const ANOTHER: f64 = 0.1;
/// The part of the tolerance to which what is read off between samples is known.
const RESOLVED: f64 = 0.02;
/// What a run of adaptive steps may be off, in its distance from the looser one before it: where few steps pass an
/// encounter, both may err alike.
const ALIKE: f64 = 2.0;

/// How a run is read at the moments of a grid: [`MeasuredRuns::read`] or [`MeasuredRuns::read_off`].
pub type Read<'e> = fn(&mut MeasuredRuns<'e>, At, (&Grid, Within), f64) -> Option<(Arc<Look>, f64)>;

/// A reference at the moments of a grid, and how far it may be off since it is read off between its
/// samples, where these tell it to within `allowed` of the observable.
pub fn told<'e>(
    runs: &mut MeasuredRuns<'e>,
    reference: &Reference,
    (grid, within): (&Grid, Within),
    allowed: f64,
    read: Read<'e>,
) -> Option<(Look, f64)> {
    let at = |rung: usize| At { family: reference.family, rung };
    let (fine, off) = read(runs, at(reference.finest), (grid, within), allowed)?;
    let mut best = Look::clone(&fine);
    if reference.extrapolated == Extrapolated::No {
        return Some((best, off));
    }
    let weight = 1.0 / (f64::from(1_u32 << runs.family(reference.family).order) - 1.0);
    let (middle, other) = read(runs, at(reference.before), (grid, within), allowed / weight)?;
    let led = |fine: f64, coarse: f64| fine + weight * (fine - coarse);
    for (best, other) in [(&mut best.values, &middle.values), (&mut best.places, &middle.places)] {
        for (x, y) in best.iter_mut().flatten().zip(other.iter().flatten()) {
            *x = led(*x, *y);
        }
    }
    best.energies.iter_mut().zip(&middle.energies).for_each(|(x, y)| *x = led(*x, *y));
    Some((best, off + weight * other))
}

/// The uncertainty of a reference over its whole way, in the observable's own unit: grown as its last two
/// runs differ more there than at the moments. Those of equal steps are compared at their samples, and along the way
/// where the moments may hide how they differ; those of adaptive steps have few samples, and an encounter may lie
/// between two of them.
fn uncertainty(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    way: &Way,
    allowed: f64,
) -> Option<f64> {
    let at = |rung: usize| At { family: reference.family, rung };
    let (fine, middle) = (at(reference.finest), at(reference.before));
    let is_sampled = runs.family(reference.family).kind != Kind::Adaptive
        && runs.seen(middle).is_some_and(|run| run.track.is_some());
    let mut grids = Vec::new();
    if is_sampled {
        grids.push(((samples(runs, middle, way.halvings()), Within::Ends), 0.0));
    }
    if reference.may_hide {
        grids.extend(way.grids.iter().map(|of| (of.clone(), allowed)));
    } else if !is_sampled {
        grids.push((way.grids.first()?.clone(), 0.0));
    }
    let mut differs = 0.0_f64;
    for ((grid, within), allowed) in &grids {
        let (fine, _) = runs.read(fine, (grid, *within), *allowed)?;
        let (middle, _) = runs.read(middle, (grid, *within), *allowed)?;
        differs = differs.max(apart_where_own(&fine, &middle));
    }
    let own = reference.uncertainty * reference.course.scale;
    let grown = if reference.apart > 0.0 { (differs / reference.apart).max(1.0) } else { 1.0 };
    let most = if own > 0.0 { own * grown } else { differs };
    Some(alike(runs, reference) * most)
}

/// What a reference may be off, in the distance of its last two runs.
fn alike(runs: &MeasuredRuns<'_>, reference: &Reference) -> f64 {
    if runs.family(reference.family).kind == Kind::Adaptive { ALIKE } else { 1.0 }
}

/// A reference at all moments of a way, and how far it may be off there since it is read off.
pub fn whole_way(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    way: &Way,
    allowed: f64,
) -> Option<(Look, f64)> {
    let (mut all, mut most): (Option<Look>, f64) = (None, 0.0);
    for (grid, within) in &way.grids {
        let (next, off) = told(runs, reference, (grid, *within), allowed, MeasuredRuns::read)?;
        all = Some(all.map_or_else(|| next.clone(), |before| before.and(&next)));
        most = most.max(off);
    }
    Some((all?, most))
}

/// The samples of a run, and where these are few, parts of its steps too.
pub fn samples(runs: &MeasuredRuns<'_>, at: At, least: u32) -> Grid {
    let track = runs.seen(at).and_then(|run| run.track.as_ref());
    let has = |halvings: &u32| track.is_some_and(|track| track.has(MOMENTS << halvings));
    let halvings = (0..=MOST_HALVINGS).rev().find(has).unwrap_or(0);
    Grid::Equal { halvings: halvings.max(least.min(LEAST_HALVINGS)) }
}

/// What a run itself gives at all moments of a way: within steps, by parts of them.
fn own_on(runs: &mut MeasuredRuns<'_>, at: At, way: &Way) -> Option<Look> {
    let mut all: Option<Look> = None;
    for (grid, within) in &way.grids {
        let next = match within {
            Within::Ends => runs.read(at, (grid, *within), 0.0)?.0,
            Within::Parts => runs.look(at, grid, *within)?,
        };
        all = Some(all.map_or_else(|| Look::clone(&next), |before| before.and(&next)));
    }
    all
}

/// What may be lost by reading a run off between its samples, in the observable's unit.
fn allowed(reference: &Reference, tolerance: f64) -> f64 {
    RESOLVED * tolerance * reference.course.scale
}

/// The error of a run over its whole way by a reference, to a small part of the tolerance; nothing where
/// one of them has none.
pub fn way_error(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    tolerance: f64,
) -> Option<f64> {
    let grid = Grid::of(runs, at);
    let own = runs.look(at, &grid, Within::Parts)?;
    let allowed = allowed(reference, tolerance);
    let (truth, _) = told(runs, reference, (&grid, Within::Parts), allowed, MeasuredRuns::read)?;
    Some(apart(&own.values, &truth.values) / reference.course.scale)
}

/// Looks at a choice over its whole way.
pub fn verify(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    tolerance: f64,
    families: &[usize],
) -> Finding {
    runs.turn_to(Purpose::WithinReference);
    let least = nothing(&reference.course, tolerance);
    if let Some(some) = Way::some(runs, reference, at, (least, allowed(reference, tolerance)))
        && let Some(finding) = verify_on(runs, reference, (at, &some), tolerance, families)
    {
        return finding;
    }
    if let Some(error) = beyond(runs, reference, at, tolerance) {
        return Finding::Beyond(error);
    }
    let all = Way::all(runs, at);
    let finding = verify_on(runs, reference, (at, &all), tolerance, families);
    let finding = match finding {
        Some(Finding::Holds(seen)) if seen.places.is_some_and(is_another) => {
            verify_closely(runs, reference, (at, seen), tolerance, families)
        }
        other => other,
    };
    finding.unwrap_or(Finding::Doubtful(Doubt::Unseen))
}

/// Looks closely at a run of another motion that holds by a look into every step: into some of these where its
/// error is far below the tolerance, else into all.
fn verify_closely(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (at, seen): (At, Seen),
    tolerance: f64,
    families: &[usize],
) -> Option<Finding> {
    let Some(closely) = Way::closely(runs, at) else { return Some(Finding::Holds(seen)) };
    if let Some(some) = some_closely(runs, reference, at, tolerance) {
        match verify_on(runs, reference, (at, &some), tolerance, families) {
            Some(Finding::Holds(closer)) => {
                let both = seen.and(closer);
                if SURELY * both.error <= tolerance {
                    return Some(Finding::Holds(both));
                }
            }
            Some(Finding::Beyond(error)) => return Some(Finding::Beyond(error)),
            _ => {}
        }
    }
    verify_on(runs, reference, (at, &closely), tolerance, families)
}

/// Some of the steps of a run that was looked into everywhere.
fn some_closely(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    tolerance: f64,
) -> Option<Way> {
    let all = Way::all(runs, at);
    let own = own_on(runs, at, &all)?;
    let (truth, _) = whole_way(runs, reference, &all, allowed(reference, tolerance))?;
    Way::some_closely(runs, at, (&own, &truth), ONE_OF_ANOTHER)
}

/// The error of a run where it is certainly too large by what is known of it at no cost: at the ends of its
/// steps, and where polynomials tell it, within them.
fn beyond(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    at: At,
    tolerance: f64,
) -> Option<f64> {
    let (grid, allowed) = (Grid::of(runs, at), allowed(reference, tolerance));
    let scale = reference.course.scale;
    let polynomials = Some(Within::Parts).filter(|_| !runs.is_joined(at));
    [Some(Within::Ends), polynomials].into_iter().flatten().find_map(|within| {
        let (own, off) = runs.read_off(at, (&grid, within), allowed)?;
        let read = MeasuredRuns::read_off;
        let (truth, other) = told(runs, reference, (&grid, within), allowed, read)?;
        let error = (apart(&own.values, &truth.values) - off - other) / scale;
        (error - reference.uncertainty > tolerance).then_some(error)
    })
}

/// Looks at a choice at the moments of a way; nothing where these do not tell.
fn verify_on(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (at, way): (At, &Way),
    tolerance: f64,
    families: &[usize],
) -> Option<Finding> {
    let allowed = allowed(reference, tolerance);
    runs.turn_to(Purpose::WithinChoice);
    let Some(own) = own_on(runs, at, way) else { return Some(Finding::Doubtful(Doubt::Unseen)) };
    runs.turn_to(Purpose::WithinReference);
    let Some(((truth, off), uncertain)) =
        whole_way(runs, reference, way, allowed).zip(uncertainty(runs, reference, way, allowed))
    else {
        return Some(Finding::Doubtful(Doubt::Unseen));
    };
    let keeps = runs.ladder().keeps_energy;
    let scale = truth.scale(runs.ladder().scale);
    if scale > SAME_SCALE * reference.course.scale {
        return Some(Finding::Larger(scale));
    }
    let scale = reference.course.scale;
    if keeps && truth.drift() > KEPT * tolerance {
        return Some(Finding::Doubtful(Doubt::Energy(truth.drift())));
    }
    let uncertainty = (off + uncertain) / scale;
    if uncertainty > BARELY * tolerance {
        return Some(Finding::Doubtful(Doubt::Uncertain(uncertainty)));
    }
    let mut error = apart(&own.values, &truth.values) / scale;
    let may_jump = way.is_all() && !runs.ladder().is_smooth && !runs.is_joined(at);
    if may_jump && error + uncertainty <= tolerance && error > SURELY_JUMPING * tolerance {
        runs.turn_to(Purpose::WithinChoice);
        let seen = (error * scale, allowed);
        if let Some(largest) = largest_where_it_jumps(runs, reference, (at, &own, &truth), seen) {
            error = largest / scale;
        }
    }
    if error + uncertainty <= tolerance
        && let Some(steps) = hurried(runs, reference, way)
    {
        runs.turn_to(Purpose::WithinChoice);
        let own = runs.look(at, &steps, Within::Ends)?;
        runs.turn_to(Purpose::WithinReference);
        let there = (&steps, Within::Ends);
        let (truth, off) = told(runs, reference, there, allowed, MeasuredRuns::read)?;
        error = error.max((apart(&own.values, &truth.values) + off) / scale);
    }
    // What is sampled may be larger in between.
    let mut most = BETWEEN * error;
    if most + uncertainty > tolerance && error + uncertainty <= tolerance {
        runs.turn_to(Purpose::WithinChoice);
        if let Some(largest) = largest(runs, reference, at, (error * scale, allowed)) {
            error = largest / scale;
            most = CLOSELY_BETWEEN * error;
        }
    }
    if most + uncertainty > tolerance {
        // Before a run is rejected because two others may err alike, these are made better.
        let is_surely = most + uncertainty / alike(runs, reference) > tolerance;
        return Some(match is_surely {
            true => Finding::Beyond(most.max(tolerance * (1.0 + f64::EPSILON))),
            false => Finding::Doubtful(Doubt::Uncertain(uncertainty)),
        });
    }
    let comparable = own.places.first().map(Vec::len) == truth.places.first().map(Vec::len);
    let (places, place) = match off_places(&own, &truth, runs.ladder().placed.len()) {
        Some((off, place)) => (Some(off), place),
        None => (None, None),
    };
    // What is another motion may do anything within a step, though its ends show none of it.
    if !way.is_all() && places.is_some_and(is_another) {
        return None;
    }
    let most = way.between().max(way.foretold(runs, &own, &truth));
    if most / scale + uncertainty > tolerance {
        return None;
    }
    let near = match runs.family(reference.family).is_closed {
        true => (BARELY * tolerance).max(NEAR.min(NEAR_CLOSED * tolerance)),
        false if keeps => NEAR_KEPT * tolerance,
        false => BARELY * tolerance,
    };
    runs.turn_to(Purpose::Confirmation);
    let (promised, near) = (tolerance * scale, near * scale);
    let judged = Judged { way, own: &own, truth: &truth, promised, near, allowed };
    let other = match agreement(runs, reference, &judged, families) {
        Agreement::With(other, off) => Some(Some((other, off))),
        Agreement::Alone => Some(None),
        Agreement::Disagrees(off) => return Some(Finding::Doubtful(Doubt::Disagrees(off))),
        Agreement::None => None,
    };
    let energy = (comparable && !own.energies.is_empty()).then(|| {
        let changes = own.energies.iter().zip(&truth.energies);
        let off = changes.map(|(a, b)| ((a - own.energies[0]) - (b - truth.energies[0])).abs());
        off.fold(0.0, f64::max) / truth.kinetic.max(f64::MIN_POSITIVE)
    });
    let every = way.grids.iter().filter_map(|(grid, within)| runs.moments(grid, *within));
    let every = every.map(|moments| moments.every).max().unwrap_or(1);
    // What the reference is made of is as wrong as that is uncertain.
    let is_reference = at == At { family: reference.family, rung: reference.finest };
    let error = if is_reference { error.max(uncertainty) } else { error };
    let (moments, steps) = (own.values.len() - 1, way.steps());
    let other_run = other.as_ref().and_then(|other| *other);
    let seen = Seen { moments, every, steps, error, energy, places, place, other: other_run };
    Some(match other {
        Some(_) => Finding::Holds(seen),
        None => Finding::Unconfirmed(seen),
    })
}

/// The steps of a reference that chooses them, where it takes so many between two moments of a way that these may
/// miss what happens there: an encounter.
fn hurried(runs: &mut MeasuredRuns<'_>, reference: &Reference, way: &Way) -> Option<Grid> {
    let at = At { family: reference.family, rung: reference.finest };
    let accepted = runs.seen(at)?.accepted.clone();
    if runs.family(at.family).kind != Kind::Adaptive {
        return None;
    }
    let mut times = way.times(runs);
    times.sort_by(f64::total_cmp);
    let before = |t: f64| times.partition_point(|moment| *moment <= t);
    let same = |pair: &[f64]| before(pair[0]) == before(pair[1]);
    accepted
        .windows(HURRIED)
        .any(|steps| same(&[steps[0], steps[HURRIED - 1]]))
        .then(|| Grid::of(runs, at))
}

/// Whether places are off by so much that the motion is another one.
fn is_another(off: f64) -> bool {
    off.is_nan() || off > ANOTHER
}
