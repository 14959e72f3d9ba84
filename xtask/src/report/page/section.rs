//! A study on the page: its charts, what to conclude, and folded away its claims and numbers.

use std::fmt::Write;

use stationary_chart::{Chart, Layout, Medium, Styles, escaped, significant};
use stationary_measure::{Cell, Column, Precision, Table};

use super::super::inline::inline;
use super::super::{Outcome, chart_file};
use super::{chapter_words, title};
use crate::study::{Claim, Evidence, Study};

/// Longer tables are cut; the CSV has all of them.
const LONGEST_TABLE: usize = 200;

pub(super) fn section(outcome: &Outcome<'_>, styles: &Styles) -> String {
    let entry = &outcome.entry;
    let body = match &outcome.result {
        Ok(study) => study_body(study, styles),
        Err(error) => {
            let error = escaped(&error.to_string());
            format!("<p class=\"broken\">{} This study has no result: {error}.</p>\n", sign(false))
        }
    };
    let (krate, kind) = (escaped(entry.krate), entry.kind.words());
    format!(
        "<article id=\"{}\" data-crate=\"{krate}\" data-kind=\"{kind}\">\n<p class=\"eyebrow\">{krate} · \
         {} · {kind}</p>\n<h3>{}</h3>\n{body}</article>\n",
        escaped(entry.id),
        escaped(&chapter_words(entry.chapter)),
        escaped(title(outcome)),
    )
}

fn study_body(study: &Study, styles: &Styles) -> String {
    // One chart has the width of the page; several stand side by side, each as wide as a phone.
    let layouts: &[Layout] = match study.charts.len() {
        1 => &[Layout::Wide, Layout::Narrow],
        _ => &[Layout::Narrow],
    };
    let charts: String =
        study.charts.iter().map(|one| chart(study, one, styles, layouts)).collect();
    let charts = match study.charts.len() {
        0 => String::new(),
        1 => format!("<div>{charts}</div>\n"),
        // Two rows of two, or of three, leave no hole.
        2 | 4 => format!("<div class=\"several\">{charts}</div>\n"),
        _ => format!("<div class=\"several many\">{charts}</div>\n"),
    };
    let (held, broken): (Vec<&Claim>, Vec<&Claim>) = study.claims.iter().partition(|c| c.holds());
    format!(
        "<figure>{charts}<figcaption>{}{}</figcaption></figure>\n<div class=\"more\">\n{}{}<p>{}</p></div>\n",
        escaped(&study.conclusion),
        if broken.is_empty() { String::new() } else { claims(&broken) },
        held_claims(&held),
        numbers(&study.table),
        file_links(study),
    )
}

/// A chart in the first of the layouts; the second is for narrow windows.
pub(super) fn chart(study: &Study, chart: &Chart, styles: &Styles, layouts: &[Layout]) -> String {
    let description = if chart.title().is_empty() { study.title.as_str() } else { chart.title() };
    let mut drawn = layouts.iter().map(|&layout| {
        match chart.svg(layout, Medium::Inline, styles, description) {
            Ok(svg) => inline(&svg),
            Err(error) => {
                format!("<p class=\"broken\">No chart: {}.</p>", escaped(&error.to_string()))
            }
        }
    });
    let first = drawn.next().unwrap_or_default();
    let narrow: String = drawn.map(|svg| format!("<template>{svg}</template>")).collect();
    format!("<div class=\"chart-box\">{first}{narrow}</div>")
}

pub(super) fn sign(holds: bool) -> &'static str {
    if holds {
        "<span class=\"yes\" role=\"img\" aria-label=\"holds\">✓</span>"
    } else {
        "<span class=\"no\" role=\"img\" aria-label=\"does not hold\">✗</span>"
    }
}

/// Claims that hold are folded away; broken ones never are.
fn held_claims(held: &[&Claim]) -> String {
    let count = match held.len() {
        0 => return String::new(),
        1 => "1 claim holds".to_owned(),
        many => format!("{many} claims hold"),
    };
    let (sign, claims) = (sign(true), claims(held));
    format!("<details><summary>{sign} {count}</summary>\n{claims}</details>\n")
}

fn claims(claims: &[&Claim]) -> String {
    let items: String = claims.iter().map(|one| claim(one)).collect();
    format!("<ul class=\"claims\">\n{items}</ul>\n")
}

fn claim(claim: &Claim) -> String {
    let accepted = match &claim.evidence {
        Evidence::Words(_) => String::new(),
        Evidence::Number { band, .. } => format!(" · accepted {}", band_words(*band)),
    };
    let words = escaped(&format!(
        "measured {} · expected {}{accepted}",
        claim.evidence.words(),
        claim.expected
    ));
    let text = escaped(&claim.text);
    if claim.holds() {
        format!("<li>{text}<small>{words}</small></li>\n")
    } else {
        format!("<li class=\"broken\">{} {text}<small>{words}</small></li>\n", sign(false))
    }
}

fn band_words((low, high): (f64, f64)) -> String {
    // As many digits as tell the ends apart.
    let digits = (4..=17).find(|&d| significant(low, d) != significant(high, d)).unwrap_or(4);
    let words = |x: f64| significant(x, digits);
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("{} to {}", words(low), words(high)),
        (true, false) => format!("{} or more", words(low)),
        (false, true) => format!("{} or less", words(high)),
        (false, false) => "any number".to_owned(),
    }
}

/// The data, and each chart as a file of its own.
fn file_links(study: &Study) -> String {
    let link = |file: String, words: String| {
        format!("<a href=\"{}\" download>{words}</a>", escaped(&file))
    };
    let charts = (0..study.charts.len()).map(|i| {
        let number = if i == 0 { String::new() } else { format!("&nbsp;{}", i + 1) };
        link(chart_file(study.id, i), format!("SVG{number}"))
    });
    let csv = link(format!("{}.csv", study.id), "CSV".to_owned());
    [csv].into_iter().chain(charts).collect::<Vec<_>>().join(" ")
}

/// The table as one text, which find and print see and which is one element where cells would be a
/// quarter of the page.
fn numbers(table: &Table) -> String {
    let names = table.columns().iter().map(|column| column.name.clone()).collect();
    let cells = |row: &Vec<Cell>| {
        row.iter().zip(table.columns()).map(|(cell, column)| words(cell, column)).collect()
    };
    let shown = table.rows().iter().take(LONGEST_TABLE).map(cells);
    let lines: Vec<Vec<String>> = std::iter::once(names).chain(shown).collect();
    let is_word = |column: usize| {
        table.rows().iter().any(|row| matches!(row.get(column), Some(Cell::Text(_))))
    };
    let columns: Vec<(usize, bool)> = (0..table.columns().len())
        .map(|column| {
            let cells = lines.iter().filter_map(|line| line.get(column));
            (cells.map(|cell| cell.chars().count()).max().unwrap_or(0), is_word(column))
        })
        .collect();
    let mut text = String::new();
    for (i, line) in lines.iter().enumerate() {
        let cells: Vec<String> = line
            .iter()
            .zip(&columns)
            .map(
                |(cell, &(width, word))| {
                    if word { format!("{cell:width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        let cells = escaped(cells.join("  ").trim_end());
        // Writing to a String cannot fail.
        let _ = if i == 0 { write!(text, "<b>{cells}</b>") } else { write!(text, "\n{cells}") };
    }
    let rows = table.rows().len();
    let cut = match rows.checked_sub(LONGEST_TABLE).filter(|&more| more > 0) {
        Some(more) => format!("\n{more} more rows are in the CSV file."),
        None => String::new(),
    };
    format!(
        "<details class=\"numbers\"><summary>The numbers ({rows} {})</summary>\n<pre \
         tabindex=\"0\">{text}{cut}</pre></details>\n",
        if rows == 1 { "row" } else { "rows" },
    )
}

fn words(cell: &Cell, column: &Column) -> String {
    match (cell, column.precision) {
        (Cell::Text(text), _) => text.clone(),
        (Cell::Count(count), _) => count.to_string(),
        (Cell::Number(x), Precision::Rounded { floor, .. }) if x.abs() < floor => {
            format!("<{floor:e}")
        }
        (Cell::Number(x), Precision::Rounded { digits, .. }) => significant(*x, digits),
        (Cell::Number(x), _) => significant(*x, 4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(claims: Vec<Claim>) -> Study {
        let mut study = super::super::fake::STUDIES[0].heading();
        study.claims = claims;
        study
    }

    #[test]
    fn claims_that_hold_are_folded_and_broken_ones_stay_in_sight() {
        let one = |measured| Claim::number("order", "2", measured, (1.9, 2.1));
        let mut many = vec![one(2.0); 9];
        many.push(one(3.0));
        let html = study_body(&study(many), &Styles::default());
        let (open, folded) = html.split_once("<details>").unwrap();
        assert!(open.contains("measured 3 · expected 2"), "{open}");
        assert!(folded.contains("9 claims hold") && !folded.contains("measured 3"));
    }

    #[test]
    fn bands_are_said_in_words() {
        assert_eq!(band_words((1.9, 2.1)), "1.9 to 2.1");
        assert_eq!(band_words((1.24999, 1.25001)), "1.24999 to 1.25001");
        assert_eq!(band_words((f64::NEG_INFINITY, 1e-9)), "1e-9 or less");
        assert_eq!(band_words((3.0, f64::INFINITY)), "3 or more");
    }

    #[test]
    fn a_table_is_one_text_of_aligned_columns() {
        let mut table = Table::new([Column::exact("name"), Column::exact("count")]);
        table.push(["a<b".into(), 10_u64.into()]);
        table.push(["long name".into(), 9_u64.into()]);
        let html = numbers(&table);
        let text = "<b>name       count</b>\na&lt;b           10\nlong name      9</pre>";
        assert!(html.contains(text), "{html}");
    }
}
