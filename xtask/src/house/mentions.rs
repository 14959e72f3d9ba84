//! The studies of a crate on its page of the docs, written from the list of studies.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::layers::LayerError;
use crate::readme::Readme;
use crate::studies::{CONCLUSIONS, STUDIES};
use crate::study::Entry;

/// The first line of what is written.
const BEGIN: &str = "<!-- The studies, written by `cargo xtask readmes`. -->";
/// Its last line.
const END: &str = "<!-- End of the studies. -->";

/// The pages of all crates that have studies, each with its studies.
///
/// # Errors
/// A page that cannot be read.
pub fn mentions() -> Result<Vec<Readme>, LayerError> {
    CONCLUSIONS.iter().map(|conclusion| of(conclusion.krate)).collect()
}

fn of(krate: &str) -> Result<Readme, LayerError> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs");
    let path = docs.join("src").join(krate).with_extension("md");
    match fs::read_to_string(&path) {
        Ok(page) => Ok(Readme { text: with_studies(&page, &studies(krate)), path }),
        Err(source) => Err(LayerError::File { path, source }),
    }
}

fn studies(krate: &str) -> String {
    let of_crate = |entry: &&Entry<'_>| entry.krate == krate;
    let mut rows = String::from("| study | what is measured | kind |\n| --- | --- | --- |\n");
    for Entry { id, title, kind, .. } in STUDIES.iter().filter(of_crate) {
        // Writing to a String cannot fail.
        let _ = writeln!(rows, "| `{id}` | {title} | {} |", kind.words());
    }
    rows
}

/// The page with these rows between its two marks, or at its end where it has none.
fn with_studies(page: &str, rows: &str) -> String {
    let block = format!("{BEGIN}\n{rows}{END}");
    match (page.split_once(BEGIN), page.split_once(END)) {
        (Some((before, _)), Some((_, after))) => format!("{before}{block}{after}"),
        _ => format!(
            "{page}\n## Studies\n\n`cargo xtask report --only ID` runs one; \
             [how to read them](report.md).\n\n{block}\n"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_keeps_what_stands_around_its_studies() {
        let page = with_studies("# a\n", "| old |\n");
        assert!(page.starts_with("# a\n\n## Studies\n"));
        let after = format!("{page}\n## More\n");
        let page = with_studies(&after, "| new |\n");
        assert!(page.starts_with("# a\n") && page.ends_with("\n## More\n"));
        assert!(page.contains("| new |") && !page.contains("| old |"));
    }
}
