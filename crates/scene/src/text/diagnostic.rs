//! A fault with its place: the line, a caret under the word, and the word that may have been meant.
//!
//! ```text
//! error: unknown field `stiffnes`
//!   --> net.toml:14:1
//!    |
//! 14 | stiffnes = 3.0
//!    | ^^^^^^^^ did you mean `stiffness`?
//!    = allowed here: `between`, `rest_length`, `stiffness`, `strain`
//! ```
//! Lines and columns count from 1, columns in characters. A line is shown in part where it is long.

use std::fmt;
use std::ops::Range;

use crate::text::fault::Fault;

/// Something in a scene's text that cannot be, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// The file, or the name that the text was given.
    pub file: String,
    /// What is wrong.
    pub fault: Fault,
    /// Where; the parser does not know it for keys of a hundred dots.
    pub place: Option<Place>,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: usize,
    /// The column, in characters from 1.
    pub column: usize,
    /// The line as it is shown, with blanks for tabs and control characters.
    shown: String,
    /// Characters of the shown line before the caret.
    before: usize,
    /// Characters under which the caret is drawn.
    width: usize,
}

/// A fault and the bytes of the text to which it belongs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Located {
    pub(crate) span: Option<Range<usize>>,
    pub(crate) fault: Fault,
}

/// A result whose error knows its place.
pub(crate) type Checked<T> = Result<T, Box<Located>>;

/// The fault at a place.
pub(crate) fn at(span: Range<usize>, fault: impl Into<Fault>) -> Box<Located> {
    Box::new(Located { span: Some(span), fault: fault.into() })
}

/// Characters of a line that are shown before the caret, and in all.
const BEFORE: usize = 60;
const SHOWN: usize = 100;

impl Place {
    /// The place of these bytes of the text.
    pub(crate) fn of(text: &str, span: Range<usize>) -> Self {
        let start = boundary(text, span.start);
        let end = boundary(text, span.end.max(start));
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |newline| start + newline);
        let column = text[line_start..start].chars().count();
        let hidden = column.saturating_sub(BEFORE);
        let visible = |c: char| if c.is_control() { ' ' } else { c };
        let line = text[line_start..line_end].trim_end();
        let shown: String = line.chars().skip(hidden).take(SHOWN).map(visible).collect();
        let before = column - hidden;
        let under = text[start..end.min(line_end)].trim_end().chars().count();
        Place {
            line: text[..start].matches('\n').count() + 1,
            column: column + 1,
            width: under.min((SHOWN - before).max(1)).max(1),
            shown,
            before,
        }
    }
}

/// The largest boundary between characters that is not beyond `index`.
fn boundary(text: &str, index: usize) -> usize {
    let mut index = index.min(text.len());
    while !text.is_char_boundary(index) {
        index -= 1;
    }
    index
}

impl Fault {
    fn nearest(&self) -> Option<&str> {
        match self {
            Fault::UnknownWord { nearest, .. } => nearest.as_deref(),
            _ => None,
        }
    }

    fn allowed(&self) -> &[String] {
        match self {
            Fault::UnknownWord { allowed, .. } => allowed,
            _ => &[],
        }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.fault)?;
        let Some(place) = &self.place else {
            return write!(f, "\n --> {}", self.file);
        };
        let Place { line, column, shown, before, width } = place;
        let margin = line.to_string().len();
        write!(f, "\n{:margin$}--> {}:{line}:{column}", "", self.file)?;
        write!(f, "\n{:margin$} |\n{line} | {shown}", "")?;
        write!(f, "\n{:margin$} | {:before$}{:^<width$}", "", "", "")?;
        if let Some(nearest) = self.fault.nearest() {
            write!(f, " did you mean `{nearest}`?")?;
        }
        if !self.fault.allowed().is_empty() {
            let words: Vec<String> =
                self.fault.allowed().iter().map(|word| format!("`{word}`")).collect();
            write!(f, "\n{:margin$} = allowed here: {}", "", words.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str, span: Range<usize>) -> String {
        let place = Some(Place::of(text, span));
        Diagnostic { file: "a.toml".to_owned(), fault: Fault::Empty, place }.to_string()
    }

    #[test]
    fn the_caret_is_under_the_word() {
        let text = "dimension = 2\n\tü = \"wörd\" # why\r\n";
        let start = text.find("\"w").unwrap();
        let lines = shown(text, start..start + 7);
        let lines: Vec<&str> = lines.lines().skip(1).collect();
        let expected = [" --> a.toml:2:6", "  |", "2 |  ü = \"wörd\" # why", "  |      ^^^^^^"];
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_long_line_is_shown_around_the_word() {
        let text = format!("{}=X{}", "a".repeat(5000), "b".repeat(5000));
        let lines = shown(&text, 5001..9000);
        assert!(lines.contains("a.toml:1:5002"));
        assert!(lines.lines().all(|line| line.chars().count() < 120));
        let caret = lines.lines().last().unwrap().find('^').unwrap();
        assert_eq!(&lines.lines().nth(3).unwrap()[caret..=caret], "X");
    }

    #[test]
    fn a_place_beyond_the_text_is_its_end() {
        assert!(shown("", 0..9).ends_with("--> a.toml:1:1\n  |\n1 | \n  | ^"));
        assert!(shown("ü", 1..1).contains("a.toml:1:1"));
        assert!(shown("a\n", 7..9).contains("a.toml:2:1"));
    }
}
