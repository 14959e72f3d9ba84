//! The mesh's own error, which no step and no method takes away, by meshes of shorter cells.
//!
//! ```text
//! d1 = max_k |x_h - x_h/2|,   d2 = max_k |x_h/2 - x_h/4|,   r = d1 / d2       at the moments
//! the written mesh errs by d1 r / (r - 1), the next finer one by d1 / (r - 1);   r = 4 with d1 alone
//! ```
//! All of one setting on the mesh as it is written, so that the errors of time nearly cancel.

use std::fmt;

use crate::ladder::{At, Kind};
use crate::ladder_search::Judgement;
use crate::measured::apart;
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;

/// What is known of the mesh's own error, relative to the observable's scale.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// By finer meshes.
    Measured(Refined),
    /// Differences of meshes do not shrink; the first of them.
    Restless(f64),
    /// Why finer meshes were not run.
    Unknown(&'static str),
}

/// What finer meshes say.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The error of the mesh as it is written.
    pub error: f64,
    /// The error with cells of half the length.
    pub halved: f64,
    /// That mesh in words, such as `with 20 x 4 cells`.
    pub words: String,
    /// Its work over that of the choice.
    pub work: f64,
    /// How many finer meshes were run.
    pub meshes: usize,
}

/// Settings that are tried on a finer mesh, where coarser ones are not stable.
const STABLE: usize = 4;
/// Runs of the written mesh that the first finer one may cost.
const WORTH: u64 = 10;
/// Below this ratio differences do not shrink.
const SHRINKING: f64 = 1.5;
/// The ratio of linear elements, where no second mesh shows it.
const SECOND_ORDER: f64 = 4.0;

/// Runs finer meshes beside a choice; nothing where that has no mesh.
pub fn mesh_error(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    chosen: At,
    judged: &dyn Fn(&MeasuredRuns<'_>, At) -> Option<Judgement>,
) -> Option<MeshError> {
    if !runs.family(chosen.family).on_mesh {
        return None;
    }
    let work = runs.seen(chosen)?.work;
    let finer = &runs.ladder().finer;
    let (count, words) = (finer.len(), finer.first().map(|mesh| mesh.words.clone()));
    let meets =
        |runs: &MeasuredRuns<'_>, at: At| matches!(judged(runs, at), Some(Judgement::Meets(_)));
    let written = runs.used().filter(|(at, run)| {
        runs.family(at.family).model == 0 && run.whole().is_some() && meets(runs, *at)
    });
    let Some(at) = written.min_by_key(|(_, run)| run.work).map(|(at, _)| at) else {
        return Some(MeshError::Unknown("no run of the mesh as it is written keeps to it"));
    };
    let (own, written_work) = (runs.seen(at)?.course.values.clone(), runs.seen(at)?.work);
    let mut courses = vec![own];
    let mut works = Vec::new();
    for model in 0..count {
        // As much again as was spent before, and no more, but that the first is worth some runs.
        let most = match model {
            0 => runs.spent().max(WORTH * written_work),
            _ => runs.spent() / 2,
        };
        let Some((values, work)) = run_finer(runs, reference, (model, at), most) else { break };
        courses.push(values);
        works.push(work);
    }
    let apart = |k: usize| {
        let fine = courses.get(k + 1)?;
        Some(apart(&courses[k], fine) / reference.course.scale)
    };
    let Some(first) = apart(0) else {
        return Some(MeshError::Unknown("no finer mesh could be run within the cost limit"));
    };
    let ratio = apart(1).map_or(SECOND_ORDER, |second| first / second.max(f64::MIN_POSITIVE));
    if ratio < SHRINKING {
        return Some(MeshError::Restless(first));
    }
    // What agrees by luck is not better than the order.
    let halved = first / (ratio.min(SECOND_ORDER) - 1.0);
    Some(MeshError::Measured(Refined {
        error: first + halved,
        halved,
        words: words?,
        work: works[0] as f64 / work.max(1) as f64,
        meshes: works.len(),
    }))
}

/// A setting on a finer mesh, or the coarsest finer one that is stable there.
fn run_finer(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (model, at): (usize, At),
    most: u64,
) -> Option<(Vec<Vec<f64>>, u64)> {
    let family = runs.family(at.family);
    let rungs = match family.kind {
        Kind::EqualSteps => at.rung..(at.rung + STABLE).min(family.rungs.len()),
        Kind::Adaptive | Kind::Modes => at.rung..at.rung + 1,
    };
    for rung in rungs {
        let run = runs.measure_finer(model, At { rung, ..at }, most)?;
        // What is not stable may come to its end all the same.
        if let Some(course) = run.whole()
            && reference.error(course).is_ok()
        {
            return Some((course.values.clone(), run.work));
        }
    }
    None
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshError::Measured(seen) => {
                let how = match seen.meshes {
                    1 => "by one finer mesh, as of order 2",
                    _ => "by two finer meshes",
                };
                write!(
                    f,
                    "the mesh as it is written errs by about {:.1e} itself ({how}); {} it would be \
                     {:.1e}, at {:.1} times the work",
                    seen.error, seen.words, seen.halved, seen.work
                )
            }
            MeshError::Restless(first) => write!(
                f,
                "the mesh as it is written is too coarse to tell its own error: with cells of half the \
                 length the answer differs by {first:.1e}, and by no less with the next"
            ),
            MeshError::Unknown(why) => write!(f, "the mesh's own error is not known: {why}"),
        }
    }
}
