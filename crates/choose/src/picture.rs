//! Error against work of every rung that was run, as a ladder with the tolerance and the choice.

use stationary_chart::{Axis, Chart, ChartError, Judged};

use crate::answer::{Answer, Row};
use crate::ladder_search::Judgement;

/// Errors below this are rounding and are drawn there.
const ROUNDING: f64 = 1e-16;

/// The chart as data.
pub fn chart(answer: &Answer) -> Chart {
    let (work, error) = (Axis::log("counted work", "differentials"), Axis::log("error", ""));
    let shown = answer.rows.iter().filter(|row| row.error().is_some()).map(|row| row.work as f64);
    // What failed at once is shown at the least work of what did not.
    let least = shown.fold(f64::INFINITY, f64::min);
    let least = if least.is_finite() { least } else { 1.0 };
    let judged = |row: &Row| match (&row.judgement, row.error()) {
        (Some(Judgement::Failed(failure)), _) => {
            Some(((row.work as f64).max(least), Judged::Failed(failure.to_string())))
        }
        (_, Some(error)) => Some((row.work as f64, Judged::Error(error.max(ROUNDING)))),
        (_, None) => None,
    };
    let mut ladder = stationary_chart::Ladder::new("", work, error, answer.tolerance);
    for row in &answer.rows {
        let Some((cost, judged)) = judged(row) else { continue };
        if answer.choice().is_some_and(|choice| choice.at == row.at) {
            ladder.choice = Some(ladder.rungs.len());
        }
        ladder = ladder.rung(&row.method, &row.setting, cost, judged);
    }
    ladder.into()
}

/// The chart as the text of an SVG file.
///
/// # Errors
/// What [`Chart::svg`] refuses: a tolerance that is no positive number.
pub fn picture(answer: &Answer) -> Result<String, ChartError> {
    chart(answer).file(&answer.heading)
}
