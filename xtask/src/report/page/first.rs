//! The first screen: which method for which question, and what each crate shows.

use std::fmt::Write;

use stationary_chart::{Styles, escaped};

use super::super::Outcome;
use super::section::{chart, sign};
use super::{Crate, title};
use crate::studies::{CONCLUSIONS, Conclusion};
use crate::study::{Answer, Study};

/// The answers of all studies, beside the chart that shows the first of them.
pub(super) fn answers(crates: &[Crate<'_>], styles: &Styles) -> String {
    let outcomes = || crates.iter().flat_map(|one| &one.outcomes);
    let studies = outcomes().filter_map(|outcome| outcome.result.as_ref().ok());
    let answered: Vec<(&Study, &Answer)> =
        studies.flat_map(|study| study.answers.iter().map(move |answer| (study, answer))).collect();
    let Some(&(first, answer)) = answered.first() else { return String::new() };
    let rows: String = answered.iter().map(|(study, answer)| row(study, answer)).collect();
    let figure = first.charts.first().map_or(String::new(), |first_chart| {
        format!(
            "<figure>{}<figcaption><strong>{}</strong>: lower and further left is better. <a \
             href=\"#{}\">The study</a></figcaption></figure>\n",
            chart(first, first_chart, styles, &[stationary_chart::Layout::Narrow]),
            escaped(&answer.question),
            escaped(first.id),
        )
    });
    format!(
        "<section id=\"answers\"><h2>Which method for which question</h2>\n<div \
         class=\"first\"><table>\n{rows}</table>\n{figure}</div></section>\n"
    )
}

fn row(study: &Study, answer: &Answer) -> String {
    let [question, method, figure] =
        [&answer.question, &answer.method, &answer.figure].map(|words| escaped(words));
    let question = unbroken(&question);
    format!(
        "<tr><th scope=\"row\"><a href=\"#{}\">{question}</a></th><td><strong>{method}</strong> \
         {figure}</td></tr>\n",
        escaped(study.id),
    )
}

/// The words, where no number such as 1e-4 is broken at its sign.
fn unbroken(words: &str) -> String {
    let whole = |word: &str| match word.contains("e-") {
        true => format!("<span class=\"whole\">{word}</span>"),
        false => word.to_owned(),
    };
    words.split(' ').map(whole).collect::<Vec<_>>().join(" ")
}

/// Each crate in a sentence, where all studies that show it were run.
pub(super) fn conclusions(crates: &[Crate<'_>]) -> String {
    let rows: String = crates
        .iter()
        .filter_map(|one| Some((one.name, shown(one)?)))
        .map(|(name, (conclusion, shown))| {
            let links: Vec<String> = shown.iter().map(|outcome| link(outcome)).collect();
            let holds = shown.iter().all(|outcome| outcome.failures().is_empty());
            let (name, sentence) = (escaped(name), escaped(conclusion.sentence));
            format!(
                "<dt><a href=\"#crate-{name}\">{name}</a></dt><dd>{} {sentence} <small>{}</small></dd>\n",
                sign(holds),
                links.join(" · ")
            )
        })
        .collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<section id=\"conclusions\"><h2>What each crate shows</h2>\n<dl>\n{rows}</dl></section>\n"
    )
}

fn shown<'a, 'b>(one: &'b Crate<'a>) -> Option<(&'static Conclusion, Vec<&'b Outcome<'a>>)> {
    let conclusion = CONCLUSIONS.iter().find(|conclusion| conclusion.krate == one.name)?;
    let outcome = |id: &&str| one.outcomes.iter().copied().find(|outcome| outcome.entry.id == *id);
    let shown = conclusion.shown_by.iter().map(outcome).collect::<Option<Vec<_>>>()?;
    Some((conclusion, shown))
}

fn link(outcome: &Outcome<'_>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let (id, name) = (escaped(outcome.entry.id), escaped(title(outcome)));
    let _ = write!(text, "<a href=\"#{id}\" title=\"{name}\">{id}</a>");
    text
}
