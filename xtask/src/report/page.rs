//! `index.html`: one file that needs nothing else, on a desk, on a phone and on paper.
//!
//! The first screen answers: which method for which question, from the studies' own numbers. Then each
//! crate in a sentence, then every study.

mod contents;
mod first;
mod section;

use std::fmt::Write;

use stationary_chart::{Styles, escaped, sheet};

#[cfg(test)]
use super::fake;
use super::{Machine, Outcome};
use crate::studies::CONCLUSIONS;
use crate::study::Size;
use section::section;

/// Lets the browser enforce what the page promises: nothing is loaded from anywhere.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// The studies of a crate.
struct Crate<'a> {
    name: &'a str,
    outcomes: Vec<&'a Outcome<'a>>,
}

/// The page.
pub(super) fn page(
    machine: &Machine,
    size: Size,
    outcomes: &[Outcome<'_>],
    styles: &Styles,
) -> String {
    let crates = by_crate(outcomes);
    let studies: String = crates.iter().map(|one| of_crate(one, styles)).collect();
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
<main>
{}{}{}{studies}<footer>{}</footer>
</main>
<p id="keys" hidden>Arrow keys read the numbers of the chart.</p>
<div id="tip" role="status" hidden></div>
<script>
{}</script>
</body>
</html>
"#,
        sheet(),
        include_str!("page.css"),
        contents::contents(&crates),
        header(machine, size, outcomes),
        first::answers(&crates, styles),
        first::conclusions(&crates),
        "Every number on this page was measured in the run that wrote it; none is stored in the \
         source. All of them are in <a href=\"report.json\">report.json</a>.",
        include_str!("page.js"),
    )
}

/// The crates in the order of their conclusions; the studies of each in the order of the list.
fn by_crate<'a>(outcomes: &'a [Outcome<'a>]) -> Vec<Crate<'a>> {
    let mut crates: Vec<Crate<'a>> = Vec::new();
    for outcome in outcomes {
        let name = outcome.entry.krate;
        match crates.iter_mut().find(|one| one.name == name) {
            Some(one) => one.outcomes.push(outcome),
            None => crates.push(Crate { name, outcomes: vec![outcome] }),
        }
    }
    let place = |one: &Crate<'_>| CONCLUSIONS.iter().position(|c| c.krate == one.name);
    crates.sort_by_key(|one| place(one).unwrap_or(usize::MAX));
    crates
}

fn of_crate(one: &Crate<'_>, styles: &Styles) -> String {
    let name = escaped(one.name);
    let articles: String = one.outcomes.iter().map(|outcome| section(outcome, styles)).collect();
    format!("<section class=\"crate\" id=\"crate-{name}\"><h2>{name}</h2>\n{articles}</section>\n")
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
         do. Each study runs the library on a problem whose answer is known. A claim is a sentence \
         that its numbers prove <span class=\"yes\">✓</span> or break <span \
         class=\"no\">✗</span>. Point at a chart, tap it, or use the arrow keys, to read its \
         numbers; a cross at its top is a run that failed.</p>\n<p \
         class=\"facts\"><strong>{verdict}</strong> ({horizon}), measured on {}.</p>\n</header>\n",
        escaped(&machine.words())
    )
}

fn studies(count: usize) -> String {
    if count == 1 { "1 study".into() } else { format!("{count} studies") }
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

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
        assert!(page.contains("Orbits to &lt;1e-4&gt;"));
    }

    #[test]
    fn each_study_can_be_jumped_to() {
        let page = fake_page();
        for entry in fake::STUDIES {
            assert!(page.contains(&format!("href=\"#{}\"", entry.id)));
            assert!(page.contains(&format!("<article id=\"{}\" ", entry.id)));
        }
    }

    #[test]
    fn the_first_screen_answers_from_the_studies_own_numbers() {
        let page = fake_page();
        let (first, studies) = page.split_once("<section class=\"crate\"").unwrap();
        assert!(first.contains("<strong>symplectic 4</strong> at 0.30 of the evaluations of RK4"));
        assert!(first.contains("<svg ") && !studies.contains("at 0.30 of the evaluations"));
    }

    #[test]
    fn crates_stand_in_the_order_of_their_conclusions() {
        let page = fake_page();
        let place = |krate: &str| page.find(&format!("id=\"crate-{krate}\"")).unwrap();
        let crates = ["calculus", "integrators", "constraints", "elasticity"].map(place);
        assert!(crates.is_sorted());
    }
}
