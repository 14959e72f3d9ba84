//! The answer as JSON, for programs: `choose --json FILE`.
//!
//! Errors are relative to the observable's scale. What is not known is `null`.

use serde::Serialize;
use stationary_choose::{Answer, MeshError, Row, Verdict};

#[derive(Serialize)]
struct Told<'a> {
    question: &'a str,
    tolerance: f64,
    verdict: &'static str,
    why: Option<String>,
    choice: Option<Run<'a>>,
    whole_way: Option<WholeWay<'a>>,
    mesh: Option<Mesh<'a>>,
    runners_up: Vec<Run<'a>>,
    rejected: Vec<Run<'a>>,
    reference: Option<Reference<'a>>,
    cost: Cost,
}

#[derive(Serialize)]
struct Run<'a> {
    method: &'a str,
    setting: &'a str,
    error: Option<f64>,
    work: u64,
    seconds: f64,
    reason: String,
}

/// What the choice was seen to be in each of its steps.
#[derive(Serialize)]
struct WholeWay<'a> {
    error: f64,
    energy: Option<f64>,
    positions: Option<f64>,
    /// The thing whose position is off the most.
    farthest: Option<&'a str>,
}

#[derive(Serialize)]
struct Mesh<'a> {
    error: Option<f64>,
    finer: Option<&'a str>,
    finer_error: Option<f64>,
    finer_work: Option<f64>,
    said: String,
}

#[derive(Serialize)]
struct Reference<'a> {
    made: &'a str,
    uncertainty: f64,
    confirmed: bool,
    scale: f64,
}

#[derive(Serialize)]
struct Cost {
    search: u64,
    choice: Option<u64>,
}

/// The answer with all that was run.
///
/// # Errors
/// None but those of the writer of JSON.
pub fn json(answer: &Answer) -> serde_json::Result<String> {
    let choice = answer.choice();
    let told = Told {
        question: &answer.heading,
        tolerance: answer.tolerance,
        verdict: match answer.verdict {
            Verdict::Chosen(_) => "chosen",
            Verdict::Unconfirmed(_) => "not confirmed",
            Verdict::NoneMeets => "none meets it",
            Verdict::Uncertain => "uncertain",
            Verdict::Doubtful(_) => "doubtful",
            Verdict::Still => "hardly moves",
        },
        why: match &answer.verdict {
            Verdict::Doubtful(doubt) => Some(doubt.to_string()),
            _ => None,
        },
        choice: choice.map(run),
        whole_way: answer.seen.map(|seen| WholeWay {
            error: seen.error,
            energy: seen.energy,
            positions: seen.places,
            farthest: seen
                .place
                .and_then(|place| answer.placed.get(place.thing))
                .map(String::as_str),
        }),
        mesh: answer.mesh.as_ref().map(mesh),
        runners_up: answer.runners_up().into_iter().map(run).collect(),
        rejected: answer.failed().into_iter().map(run).collect(),
        reference: answer.reference.as_ref().map(|reference| Reference {
            made: &answer.made,
            uncertainty: reference.uncertainty,
            confirmed: reference.is_confirmed,
            scale: reference.course.scale,
        }),
        cost: Cost { search: answer.spent.total(), choice: choice.map(|row| row.work) },
    };
    serde_json::to_string_pretty(&told).map(|text| text + "\n")
}

fn run(row: &Row) -> Run<'_> {
    Run {
        method: &row.method,
        setting: &row.setting,
        error: row.error(),
        work: row.work,
        seconds: row.wall.as_secs_f64(),
        reason: row.word(),
    }
}

fn mesh(mesh: &MeshError) -> Mesh<'_> {
    let seen = match mesh {
        MeshError::Measured(seen) => Some(seen),
        MeshError::Restless(_) | MeshError::Unknown(_) => None,
    };
    Mesh {
        error: seen.map(|seen| seen.error),
        finer: seen.map(|seen| seen.words.as_str()),
        finer_error: seen.map(|seen| seen.halved),
        finer_work: seen.map(|seen| seen.work),
        said: mesh.to_string(),
    }
}
