//! The text of a scene with some of its keys said otherwise: all else stays, comments too.
//!
//! ```text
//! step = 10  # ten days      ->      step = 125.0  # ten days
//! ```
//! Only keys of the whole scene, such as `integrator`; what stands in tables is left alone.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::{Spanned, Value};

/// A key of a scene and what it says now: a value as TOML, or nothing where it is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// The key.
    pub key: &'static str,
    /// Its value as TOML.
    pub value: Option<String>,
}

impl Change {
    /// The key says this.
    pub fn to(key: &'static str, value: impl Into<String>) -> Self {
        Change { key, value: Some(value.into()) }
    }

    /// The key is left out.
    pub fn without(key: &'static str) -> Self {
        Change { key, value: None }
    }
}

type Keys = BTreeMap<Spanned<String>, Spanned<Value>>;

/// A number that TOML reads back as the same one.
pub fn number(x: f64) -> String {
    // Debug is the shortest form that does, and has a point or an exponent.
    format!("{x:?}")
}

/// The text with the changes made. A text that is no TOML stays as it is: its reader will say why.
pub fn changed(text: &str, changes: &[Change]) -> String {
    changes.iter().fold(text.to_owned(), |text, change| one_changed(&text, change))
}

fn one_changed(text: &str, change: &Change) -> String {
    let Ok(keys) = toml::from_str::<Keys>(text) else { return text.to_owned() };
    let found = keys.iter().find(|(key, _)| key.get_ref() == change.key);
    match (found, &change.value) {
        (Some((_, value)), Some(new)) => replaced(text, value.span(), new),
        (Some((key, value)), None) => {
            let start = line_start(text, key.span().start);
            let end = text[value.span().end..].find('\n');
            let end = end.map_or(text.len(), |newline| value.span().end + newline + 1);
            replaced(text, start..end, "")
        }
        (None, Some(new)) => {
            // Where the keys of the whole scene are: below the method, or else above all.
            let method = keys.iter().find(|(key, _)| key.get_ref() == "integrator");
            let end = |at: usize| text[at..].find('\n').map_or(text.len(), |line| at + line + 1);
            let at = method.map_or(0, |(_, value)| end(value.span().end));
            replaced(text, at..at, &format!("{} = {new}\n", change.key))
        }
        (None, None) => text.to_owned(),
    }
}

/// The text without what it claims: the claims are about the observables that it had, at times that its own
/// steps meet. What is not understood so stays, and its reader will say why.
pub fn without_claims(text: &str) -> String {
    let mut inside = false;
    let kept: String = text
        .split_inclusive('\n')
        .filter(|line| {
            if line.trim_start().starts_with('[') {
                inside = line.trim_start().starts_with("[[claims]]");
            }
            !inside
        })
        .collect();
    let kept = changed(&kept, &[Change::without("claims")]);
    if toml::from_str::<Keys>(&kept).is_ok() { kept } else { text.to_owned() }
}

/// The text with lines of comment above a key of the whole scene, or at its top.
pub fn commented(text: &str, key: &str, comment: &str) -> String {
    let keys = toml::from_str::<Keys>(text).unwrap_or_default();
    let found = keys.keys().find(|own| own.get_ref() == key);
    let start = found.map_or(0, |own| line_start(text, own.span().start));
    let lines: String =
        comment.lines().map(|line| format!("# {line}").trim_end().to_owned() + "\n").collect();
    replaced(text, start..start, &lines)
}

fn replaced(text: &str, range: Range<usize>, new: &str) -> String {
    format!("{}{new}{}", &text[..range.start], &text[range.end..])
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "# why\nstep = 10 # days\nobservables = [\n    \"energy\",\n]\n[units]\ntime = \"d\"\n";

    #[test]
    fn a_changed_key_keeps_its_comments_and_its_neighbours() {
        let text = changed(TEXT, &[Change::to("step", number(0.1 + 0.2))]);
        assert_eq!(text, TEXT.replace("10", "0.30000000000000004"));
        let text = changed(TEXT, &[Change::to("observables", "[\"kinetic-energy\"]")]);
        assert!(text.contains("days\nobservables = [\"kinetic-energy\"]\n[units]"), "{text}");
    }

    #[test]
    fn a_key_that_was_not_there_stands_before_every_table() {
        let text = changed("[units]\ntime = \"d\"\n", &[Change::to("tolerance", "1e-6")]);
        assert_eq!(text, "tolerance = 1e-6\n[units]\ntime = \"d\"\n");
    }

    #[test]
    fn a_key_that_goes_with_the_method_stands_below_it() {
        let text = "# why\nintegrator = \"bdf-5\" # stiff\nstep = 1\n";
        let text = changed(text, &[Change::to("tolerance", "1e-6")]);
        let expected = "# why\nintegrator = \"bdf-5\" # stiff\ntolerance = 1e-6\nstep = 1\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_key_that_is_left_out_takes_its_lines_with_it() {
        let text = changed(TEXT, &[Change::without("observables"), Change::without("title")]);
        assert_eq!(text, "# why\nstep = 10 # days\n[units]\ntime = \"d\"\n");
    }

    #[test]
    fn claims_are_left_out_and_what_follows_them_stays() {
        let text = "step = 1\n[[claims]]\nof = \"energy\"\n# why\n[[claims]]\nwithin = 1\n[units]\nx = 1\n";
        assert_eq!(without_claims(text), "step = 1\n[units]\nx = 1\n");
        assert_eq!(without_claims("claims = [\n{ within = 1 }]\nstep = 1\n"), "step = 1\n");
    }

    #[test]
    fn a_key_of_a_table_is_not_the_scenes() {
        let text = changed(TEXT, &[Change::to("time", "1.0")]);
        assert!(text.starts_with("time = 1.0\n") && text.ends_with("time = \"d\"\n"), "{text}");
    }

    #[test]
    fn a_comment_stands_above_its_key() {
        let text = commented(TEXT, "step", "one\n\ntwo");
        assert!(text.starts_with("# why\n# one\n#\n# two\nstep = 10"), "{text}");
    }
}
