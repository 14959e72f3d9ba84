//! `index.html`: one file that needs nothing else, on a desk, on a phone and on paper.

use std::fmt::Write;

use stationary_chart::{Layout, Medium, Styles, escaped, sheet, significant};
use stationary_measure::{Cell, Column, Precision, Table};

use super::{Machine, Outcome, chart_file};
use crate::study::{Claim, Evidence, Size, Study};

/// Longer tables are cut; the CSV has all of them.
const LONGEST_TABLE: usize = 200;
/// More claims that hold than this are folded away; broken ones never are.
const MOST_CLAIMS: usize = 6;

/// Lets the browser enforce what the page promises: nothing is loaded from anywhere.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// The page.
pub(super) fn page(
    machine: &Machine,
    size: Size,
    outcomes: &[Outcome<'_>],
    styles: &Styles,
) -> String {
    let sections: String = outcomes.iter().map(|outcome| section(outcome, styles)).collect();
    format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<link rel="icon" href="data:,">
<title>Stationary: the studies</title>
<style>
{}
{}</style>
</head>
<body>
{}
{}
<main>
{sections}</main>
<footer>{}</footer>
<div id="tip" role="status" hidden></div>
<script>
{}</script>
</body>
</html>
"#,
        sheet(),
        include_str!("page.css"),
        header(machine, size, outcomes),
        contents(outcomes),
        "<p>Every number on this page was measured in the run that wrote it; none is stored in the \
         source. All of them are in <a href=\"report.json\">report.json</a>.</p>",
        include_str!("page.js"),
    )
}

fn header(machine: &Machine, size: Size, outcomes: &[Outcome<'_>]) -> String {
    let (held, claims) =
        outcomes.iter().map(Outcome::held).fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let broken = outcomes.iter().filter(|outcome| outcome.result.is_err()).count();
    let mut verdict = format!("{}, {held} of {claims} claims hold", studies(outcomes.len()));
    if broken > 0 {
        let _ = write!(verdict, ", {} without a result", studies(broken));
    }
    let horizon = match size {
        Size::Default => "short horizons",
        Size::Full => "full horizons",
    };
    format!(
        "<header>\n<h1>Stationary</h1>\n<p class=\"lead\">What the methods promise, and what they \
         do.</p>\n<p>Each study below runs the library on a problem whose answer is known, draws what \
         it measured, and says what to conclude. A claim is a sentence that the numbers prove \
         <span class=\"yes\">✓</span> or break <span class=\"no\">✗</span>. Point at a chart, or tap \
         it, to read its numbers. A cross at the top of a chart is a run that failed; it says why.</p>\
         \n<p class=\"facts\"><strong>{verdict}</strong> ({horizon}).<br>Measured on {}.</p>\n</header>",
        escaped(&machine.words())
    )
}

fn studies(count: usize) -> String {
    if count == 1 { "1 study".into() } else { format!("{count} studies") }
}

/// The table of contents, by crate and chapter in the order of their first study.
fn contents(outcomes: &[Outcome<'_>]) -> String {
    let mut text = String::from("<nav aria-label=\"Studies\">\n");
    for krate in in_order(outcomes.iter().map(|o| o.entry.krate)) {
        let of_crate: Vec<&Outcome<'_>> =
            outcomes.iter().filter(|o| o.entry.krate == krate).collect();
        let _ = writeln!(text, "<section><h2>{}</h2>", escaped(krate));
        for chapter in in_order(of_crate.iter().map(|o| o.entry.chapter)) {
            let _ = writeln!(text, "<h3>{}</h3>\n<ul>", escaped(&chapter_words(chapter)));
            for outcome in of_crate.iter().filter(|o| o.entry.chapter == chapter) {
                let (id, title) = (escaped(outcome.entry.id), escaped(title(outcome)));
                let sign = sign(outcome.failures().is_empty());
                let _ = writeln!(text, "<li>{sign} <a href=\"#{id}\">{title}</a></li>");
            }
            text += "</ul>\n";
        }
        text += "</section>\n";
    }
    text + "</nav>"
}

fn in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for name in names {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

/// `4.3` is a chapter of the notes; anything else is a topic and says so itself.
fn chapter_words(chapter: &str) -> String {
    if chapter.starts_with(|letter: char| letter.is_ascii_digit()) {
        format!("chapter {chapter}")
    } else {
        chapter.to_owned()
    }
}

fn title<'a>(outcome: &'a Outcome<'_>) -> &'a str {
    outcome.result.as_ref().map_or(outcome.entry.title, |study| study.title.as_str())
}

fn sign(holds: bool) -> &'static str {
    if holds {
        "<span class=\"yes\" role=\"img\" aria-label=\"holds\">✓</span>"
    } else {
        "<span class=\"no\" role=\"img\" aria-label=\"does not hold\">✗</span>"
    }
}

fn section(outcome: &Outcome<'_>, styles: &Styles) -> String {
    let entry = &outcome.entry;
    let body = match &outcome.result {
        Ok(study) => study_body(study, styles),
        Err(error) => {
            let error = escaped(&error.to_string());
            format!("<p class=\"broken\">{} This study has no result: {error}.</p>\n", sign(false))
        }
    };
    format!(
        "<article id=\"{}\">\n<p class=\"eyebrow\">{} · {} · {}</p>\n<h2>{}</h2>\n{body}</article>\n",
        escaped(entry.id),
        escaped(entry.krate),
        escaped(&chapter_words(entry.chapter)),
        entry.kind.words(),
        escaped(title(outcome)),
    )
}

fn study_body(study: &Study, styles: &Styles) -> String {
    let mut text = String::from("<figure>\n");
    for chart in &study.charts {
        for layout in [Layout::Wide, Layout::Narrow] {
            let description = described(study, chart.title());
            match chart.svg(layout, Medium::Inline, styles, &description) {
                Ok(svg) => text += &svg,
                Err(error) => {
                    let error = escaped(&error.to_string());
                    let _ = write!(text, "<p class=\"broken\">No chart: {error}.</p>");
                }
            }
            text.push('\n');
        }
    }
    let _ = writeln!(text, "<figcaption>{}</figcaption>\n</figure>", escaped(&study.conclusion));
    text += &claims(&study.claims);
    let rows = study.table.rows().len();
    let _ = writeln!(
        text,
        "<details class=\"numbers\"><summary>The numbers ({rows} {})</summary>\n{}</details>\n<p class=\"files\">{}</p>",
        if rows == 1 { "row" } else { "rows" },
        table(&study.table),
        file_links(study),
    );
    text
}

fn described(study: &Study, title: &str) -> String {
    [title, &study.conclusion].into_iter().filter(|t| !t.is_empty()).collect::<Vec<_>>().join(". ")
}

/// The claims, broken ones first.
fn claims(claims: &[Claim]) -> String {
    let list = |claims: &[&Claim]| {
        let items: String = claims.iter().map(|one| claim(one)).collect();
        format!("<ul class=\"claims\">\n{items}</ul>\n")
    };
    let (held, broken): (Vec<&Claim>, Vec<&Claim>) = claims.iter().partition(|c| c.holds());
    if claims.is_empty() {
        String::new()
    } else if held.len() <= MOST_CLAIMS {
        list(&[broken, held].concat())
    } else {
        let open = if broken.is_empty() { String::new() } else { list(&broken) };
        let (sign, count) = (sign(true), held.len());
        let folded = list(&held);
        format!(
            "{open}<details><summary>{sign} {count} claims hold</summary>\n{folded}</details>\n"
        )
    }
}

fn claim(claim: &Claim) -> String {
    let band = match &claim.evidence {
        Evidence::Words(_) => String::new(),
        Evidence::Number { band, .. } => pair("accepted", &band_words(*band)),
    };
    format!(
        "<li class=\"{}\">{}<div><p>{}</p><dl>{}{}{band}</dl></div></li>\n",
        if claim.holds() { "held" } else { "broken" },
        sign(claim.holds()),
        escaped(&claim.text),
        pair("measured", &claim.evidence.words()),
        pair("expected", &claim.expected),
    )
}

fn pair(term: &str, words: &str) -> String {
    format!("<div><dt>{term}</dt> <dd>{}</dd></div>", escaped(words))
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

fn file_links(study: &Study) -> String {
    let csv = format!("{}.csv", study.id);
    let charts = (0..study.charts.len()).map(|i| chart_file(study.id, i));
    let links = [csv].into_iter().chain(charts).map(|file| {
        let file = escaped(&file);
        format!("<a href=\"{file}\" download>{file}</a>")
    });
    links.collect::<Vec<_>>().join(" ")
}

fn table(table: &Table) -> String {
    let names: String =
        table.columns().iter().map(|c| format!("<th>{}</th>", escaped(&c.name))).collect();
    let mut text = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>{names}</tr></thead>\n<tbody>\n"
    );
    for row in table.rows().iter().take(LONGEST_TABLE) {
        let cells: String =
            row.iter().zip(table.columns()).map(|(cell, c)| data(cell, c)).collect();
        let _ = writeln!(text, "<tr>{cells}</tr>");
    }
    text += "</tbody></table></div>\n";
    if let Some(more) = table.rows().len().checked_sub(LONGEST_TABLE).filter(|&more| more > 0) {
        let _ = writeln!(text, "<p class=\"more\">{more} more rows are in the CSV file.</p>");
    }
    text
}

fn data(cell: &Cell, column: &Column) -> String {
    match (cell, column.precision) {
        (Cell::Text(text), _) => format!("<td class=\"word\">{}</td>", escaped(text)),
        (Cell::Count(count), _) => format!("<td>{count}</td>"),
        (Cell::Number(x), Precision::Rounded { digits, floor }) => {
            let text =
                if x.abs() < floor { format!("<{floor:e}") } else { significant(*x, digits) };
            format!("<td>{}</td>", escaped(&text))
        }
        (Cell::Number(x), _) => format!("<td>{}</td>", significant(*x, 4)),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::report::fake;

    fn fake_page() -> String {
        let outcomes: Vec<Outcome> = fake::STUDIES
            .iter()
            .map(|&entry| Outcome {
                entry,
                wall: Duration::ZERO,
                result: entry.measure(Size::Default),
            })
            .collect();
        page(&Machine::read(), Size::Default, &outcomes, &Styles::default())
    }

    #[test]
    fn the_page_needs_nothing_from_anywhere() {
        let page = fake_page();
        assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("url("));
        assert!(!page.contains("@import") && !page.contains("fetch("));
    }

    #[test]
    fn every_text_of_a_study_is_escaped() {
        let page = fake_page();
        assert!(page.contains("&lt;b&gt;bold&lt;/b&gt;") && !page.contains("<b>bold"));
    }

    #[test]
    fn each_study_can_be_jumped_to() {
        let page = fake_page();
        for entry in fake::STUDIES {
            assert!(page.contains(&format!("href=\"#{}\"", entry.id)));
            assert!(page.contains(&format!("<article id=\"{}\">", entry.id)));
        }
    }

    #[test]
    fn many_claims_are_folded_and_broken_ones_stay_in_sight() {
        let one = |measured| Claim::number("order", "2", measured, (1.9, 2.1));
        let mut many = vec![one(2.0); 9];
        many.push(one(3.0));
        let html = claims(&many);
        let (open, folded) = html.split_once("<details>").unwrap();
        assert!(open.contains("measured</dt> <dd>3</dd>"), "{open}");
        assert!(folded.contains("9 claims hold") && !folded.contains("<dd>3</dd>"));
        assert!(!claims(&[one(2.0)]).contains("<details>"));
    }

    #[test]
    fn bands_are_said_in_words() {
        assert_eq!(band_words((1.9, 2.1)), "1.9 to 2.1");
        assert_eq!(band_words((1.24999, 1.25001)), "1.24999 to 1.25001");
        assert_eq!(band_words((f64::NEG_INFINITY, 1e-9)), "1e-9 or less");
        assert_eq!(band_words((3.0, f64::INFINITY)), "3 or more");
    }
}
