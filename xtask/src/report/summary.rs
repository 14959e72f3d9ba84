//! What a terminal is told: the list of studies, and what a run found.

use std::fmt::Write;

use super::Outcome;
use crate::study::Entry;

/// The studies, a line each.
pub fn catalogue(entries: &[Entry<'_>]) -> String {
    let rows: Vec<Vec<String>> = entries
        .iter()
        .map(|e| [e.id, e.krate, e.chapter, e.kind.words(), e.title].map(String::from).to_vec())
        .collect();
    aligned(&["study", "crate", "chapter", "kind", "title"], &rows)
}

/// What was run, how long it took and how many claims hold.
pub fn summary(outcomes: &[Outcome<'_>]) -> String {
    let rows: Vec<Vec<String>> = outcomes
        .iter()
        .map(|outcome| {
            let (held, claims) = outcome.held();
            let claims = match outcome.result {
                Ok(_) => format!("{held} of {claims}"),
                Err(_) => "no table".into(),
            };
            vec![outcome.entry.id.into(), format!("{:.1}", outcome.wall.as_secs_f64()), claims]
        })
        .collect();
    aligned(&["study", "seconds", "claims held"], &rows)
}

/// Columns under their names, two spaces apart.
pub(crate) fn aligned(names: &[&str], rows: &[Vec<String>]) -> String {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let width = |column: usize| {
        let cells = rows.iter().chain([&names]).map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..names.len()).map(width).collect();
    let mut text = String::new();
    for row in [&names].into_iter().chain(rows) {
        let cells: Vec<String> =
            row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}")).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", cells.join("  ").trim_end());
    }
    text
}
