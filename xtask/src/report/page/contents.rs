//! The contents, which stay in sight, and the filter by crate and kind above them.

use std::fmt::Write;

use stationary_chart::escaped;

use super::{Crate, chapter_words, title};
use crate::study::Kind;

/// The bar at the side, or on a phone at the top.
pub(super) fn contents(crates: &[Crate<'_>]) -> String {
    let mut text = String::from(
        "<nav aria-label=\"Contents\"><details id=\"contents\" open>\
         <summary>Contents and filter</summary>\n",
    );
    text += &filter(crates);
    for one in crates {
        let krate = escaped(one.name);
        let _ = write!(text, "<h2><a href=\"#crate-{krate}\">{krate}</a></h2>\n<ul>\n");
        for outcome in &one.outcomes {
            let (id, title) = (escaped(outcome.entry.id), escaped(title(outcome)));
            let chapter = escaped(&chapter_words(outcome.entry.chapter));
            let broken = if outcome.failures().is_empty() { "" } else { "✗ " };
            let _ = writeln!(
                text,
                "<li title=\"{chapter}\"><a href=\"#{id}\">{broken}{title}</a></li>"
            );
        }
        text += "</ul>\n";
    }
    text + "</details></nav>"
}

fn filter(crates: &[Crate<'_>]) -> String {
    let of = |kind: &Kind| crates.iter().flat_map(|c| &c.outcomes).any(|o| o.entry.kind == *kind);
    let kinds = Kind::ALL.iter().filter(|kind| of(kind)).map(|kind| kind.words());
    format!(
        "<form id=\"filter\" aria-label=\"Filter\">{}{}<output></output></form>\n",
        choice("crate", "all crates", crates.iter().map(|one| one.name)),
        choice("kind", "all kinds", kinds),
    )
}

fn choice<'a>(name: &str, all: &str, options: impl Iterator<Item = &'a str>) -> String {
    let options: String =
        options.map(|option| format!("<option>{}</option>", escaped(option))).collect();
    format!(
        "<select name=\"{name}\" aria-label=\"{name}\"><option value=\"\">{all}</option>{options}\
         </select>"
    )
}
