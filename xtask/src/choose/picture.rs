//! Error against work of every rung that was run, with the tolerance as a line.

use super::answer::{Answer, Row};
use super::climb::Judgement;
use crate::chart::{Axis, Chart, Layout, Lines, Medium, Series, Styles};

/// Errors below this are rounding and are drawn there.
const ROUNDING: f64 = 1e-16;

/// The chart as data.
pub fn chart(answer: &Answer) -> Chart {
    let work = Axis::log("counted work", "differentials");
    let mut lines = Lines::new("", work, Axis::log("error", ""));
    let mut names: Vec<&str> = Vec::new();
    for row in &answer.rows {
        if !names.contains(&row.method.as_str()) {
            names.push(&row.method);
        }
    }
    let shown = answer.rows.iter().filter(|row| row.error().is_some()).map(|row| row.work as f64);
    let (least, most) = shown.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    for name in names {
        lines = lines.with(series(name, &answer.rows, if least < most { least } else { 1.0 }));
    }
    if least < most {
        let tolerance = answer.tolerance;
        lines = lines.curve("the tolerance", [(least, tolerance), (most, tolerance)]);
    }
    lines.mark_front().into()
}

/// A method's rungs; what failed at once is shown at the least work.
fn series(name: &str, rows: &[Row], least: f64) -> Series {
    let own = || rows.iter().filter(|row| row.method == name);
    let points = own().filter_map(|row| Some((row.work as f64, row.error()?.max(ROUNDING))));
    let mut series = Series::new(name, points);
    for row in own() {
        if let Some(Judgement::Failed(failure)) = &row.judgement {
            let why = format!("{}: {failure}", row.setting);
            series = series.failed((row.work as f64).max(least), why);
        }
    }
    series
}

/// The chart as the text of an SVG file.
pub fn picture(answer: &Answer) -> String {
    let chart = chart(answer);
    let styles = Styles::assign(crate::studies::METHODS, &[chart.names()]);
    chart.svg(Layout::Wide, Medium::File, &styles, &answer.heading)
}
