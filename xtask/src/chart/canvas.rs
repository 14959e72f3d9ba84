//! Writes SVG: few elements, numbers with one decimal, every text escaped.

use std::fmt::Write;

use super::label::{Label, Run};

/// Where a text is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The inside of an SVG element, growing.
#[derive(Clone, Debug, Default)]
pub(super) struct Canvas(String);

impl Canvas {
    pub(super) fn finish(self) -> String {
        self.0
    }

    // Writing to a String cannot fail, so the results below are dropped.

    pub(super) fn line(&mut self, class: &str, a: (f64, f64), b: (f64, f64)) {
        self.path(class, &polyline(&[a, b]));
    }

    pub(super) fn path(&mut self, class: &str, d: &str) {
        let _ = write!(self.0, r#"<path class="{class}" d="{d}"/>"#);
    }

    pub(super) fn rect(&mut self, class: &str, x: f64, y: f64, width: f64, height: f64) {
        let [x, y, width, height] = [x, y, width, height].map(number);
        let _ = write!(
            self.0,
            r#"<rect class="{class}" x="{x}" y="{y}" width="{width}" height="{height}"/>"#
        );
    }

    pub(super) fn text(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor, label: &Label) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " mid",
            Anchor::End => " end",
        };
        let _ =
            write!(self.0, r#"<text class="{class}{anchor}" x="{}" y="{}">"#, number(x), number(y));
        let mut raised = false;
        for run in &label.0 {
            let _ = match run {
                Run::Raised(text) => {
                    raised = true;
                    write!(self.0, r#"<tspan class="sup" dy="-5">{}</tspan>"#, escaped(text))
                }
                // The shift of a raised run lasts until it is taken back.
                Run::Plain(text) if raised => {
                    raised = false;
                    write!(self.0, r#"<tspan dy="5">{}</tspan>"#, escaped(text))
                }
                Run::Plain(text) => write!(self.0, "{}", escaped(text)),
            };
        }
        self.0.push_str("</text>");
    }

    /// A mark that says its numbers when pointed at: the first line of `tip` is its name.
    pub(super) fn point(&mut self, class: &str, at: (f64, f64), tip: &str, mark: &str) {
        let _ = write!(
            self.0,
            r#"<g class="pt {class}" transform="translate({} {})"><title>{}</title>{mark}</g>"#,
            number(at.0),
            number(at.1),
            escaped(tip)
        );
    }

    /// A path that says its numbers when pointed at.
    pub(super) fn cell(&mut self, d: &str, tip: &str) {
        let _ =
            write!(self.0, r#"<path class="cell" d="{d}"><title>{}</title></path>"#, escaped(tip));
    }

    pub(super) fn group(&mut self, class: &str, inside: impl FnOnce(&mut Canvas)) {
        let _ = write!(self.0, r#"<g class="{class}">"#);
        inside(self);
        self.0.push_str("</g>");
    }
}

/// A coordinate with one decimal. What is not finite must not reach the file.
pub(super) fn number(x: f64) -> String {
    let x = if x.is_finite() { x } else { 0.0 };
    let text = format!("{x:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// Path data of a polyline.
pub(super) fn polyline(points: &[(f64, f64)]) -> String {
    let mut d = String::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        let _ = write!(d, "{letter}{} {}", number(x), number(y));
    }
    d
}

/// Text that is safe in HTML and in XML, as content and in a quoted attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\n' | '\t' => safe.push(letter),
            // XML has no way to write the other control characters.
            _ if letter.is_control() || matches!(letter, '\u{FFFE}' | '\u{FFFF}') => {
                safe.push('\u{FFFD}');
            }
            _ => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_leave_its_element_or_attribute() {
        assert_eq!(
            escaped(r#"</title><script a="1" b='2'>&"#),
            "&lt;/title&gt;&lt;script a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;"
        );
        assert_eq!(escaped("a\u{0}b\u{1b}"), "a\u{FFFD}b\u{FFFD}");
    }

    #[test]
    fn coordinates_are_short_and_always_numbers() {
        assert_eq!(number(1.0), "1");
        assert_eq!(number(-0.04), "0");
        assert_eq!(number(2.26), "2.3");
        assert_eq!(number(f64::NAN), "0");
    }

    #[test]
    fn a_raised_run_is_taken_back() {
        let mut canvas = Canvas::default();
        let label = Label::plain("a [").then(Label::power_of_ten(-6)).then(Label::plain(" J]"));
        canvas.text("t", (0.0, 0.0), Anchor::Start, &label);
        let svg = canvas.finish();
        assert!(svg.contains(r#"dy="-5">−6</tspan><tspan dy="5"> J]</tspan>"#), "{svg}");
    }
}
