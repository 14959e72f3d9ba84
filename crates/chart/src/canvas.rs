//! Writes SVG: few elements, numbers with one decimal, every text escaped.
//!
//! Charts are drawn on it, and so is whatever else is to look like them: a picture of a scene, a film
//! strip. What is painted is said as a [`Tone`] and not as a colour.

use std::fmt::Write;

use crate::chart::Medium;
use crate::label::{Label, Run};
use crate::palette::{Tone, sheet};
use crate::path::{Path, polyline};

/// Where a text is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its first letter.
    Start,
    /// In its middle.
    Middle,
    /// At its last letter.
    End,
}

/// What a text is for, which decides how it is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lettering {
    /// The heading of a picture.
    Heading,
    /// A caption or a label.
    Plain,
    /// A scale or a remark.
    Remark,
    /// A name that stands over what is drawn, with a rim of paper.
    Name,
}

/// A drawing, growing: y points downward, a unit is a pixel.
///
/// ```
/// use stationary_chart::{Anchor, Canvas, Lettering, Medium, Path, Tone};
///
/// let mut canvas = Canvas::new(200.0, 100.0);
/// canvas.stroke(Tone::Hue(0), 2.0, &Path::line(&[(10.0, 80.0), (190.0, 20.0)]));
/// canvas.dot(Tone::Hue(1), (190.0, 20.0), 4.0);
/// canvas.text(Lettering::Plain, (10.0, 95.0), Anchor::Start, "a line & its end");
/// let svg = canvas.svg(Medium::File, "A line and its end");
/// assert!(svg.contains("a line &amp; its end"));
/// ```
///
/// A coordinate that is not finite is never written: a [`Path`] has a gap there, dots, rings and texts
/// are left out.
#[derive(Clone, Debug)]
pub struct Canvas {
    width: f64,
    height: f64,
    inside: String,
}

impl Canvas {
    /// Empty paper of this size in pixels; a size that is not finite or below one pixel is one pixel.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let [width, height] = [width, height].map(|x| if x.is_finite() { x.max(1.0) } else { 1.0 });
        Canvas { width, height, inside: String::new() }
    }

    /// Paper of another height, with what is drawn.
    #[must_use]
    pub fn with_height(self, height: f64) -> Self {
        let height = if height.is_finite() { height.max(1.0) } else { 1.0 };
        Canvas { height, ..self }
    }

    /// The text of the picture; `description` is what a reader who cannot see it is told.
    #[must_use]
    pub fn svg(self, medium: Medium, description: &str) -> String {
        self.classified("", medium, description)
    }

    /// The same with a further class.
    pub(crate) fn classified(self, class: &str, medium: Medium, description: &str) -> String {
        let (width, height) = (number(self.width), number(self.height.ceil()));
        let size = match medium {
            Medium::Inline => String::new(),
            Medium::File => {
                format!(r#" xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}""#)
            }
        };
        let description = escaped(description);
        let mut svg = format!(
            r#"<svg class="{}" viewBox="0 0 {width} {height}"{size} role="img" aria-label="{description}">"#,
            format!("chart {class}").trim_end(),
        );
        // Writing to a String cannot fail, neither here nor below.
        if medium == Medium::File {
            let _ = write!(svg, "<title>{description}</title><style>{}", escaped_sheet());
            let _ = write!(svg, "svg{{max-width:100%;max-height:100vh}}</style>");
            let _ = write!(svg, r#"<rect class="paper" width="{width}" height="{height}"/>"#);
        }
        let end = if medium == Medium::File { "</svg>\n" } else { "</svg>" };
        svg + &self.inside + end
    }

    /// A line of this width along a path.
    pub fn stroke(&mut self, tone: Tone, width: f64, path: &Path) {
        let (class, width) = (tone.class(), number(width));
        let d = path.data();
        let _ =
            write!(self.inside, r#"<path class="{class} pen" stroke-width="{width}" d="{d}"/>"#);
    }

    /// What a path encloses, seen through where `opacity` is below one.
    pub fn fill(&mut self, tone: Tone, opacity: f64, path: &Path) {
        let (class, d) = (tone.class(), path.data());
        let opacity = if opacity.is_finite() { opacity.clamp(0.0, 1.0) } else { 1.0 };
        let _ =
            write!(self.inside, r#"<path class="{class} fill" opacity="{opacity:.2}" d="{d}"/>"#);
    }

    /// Paper over what a path encloses.
    pub fn cover(&mut self, path: &Path) {
        self.path("paper", path.data());
    }

    /// A filled circle with a rim of paper, which keeps it apart from what it covers.
    pub fn dot(&mut self, tone: Tone, centre: (f64, f64), radius: f64) {
        self.circle(&format!("{} dot", tone.class()), centre, radius);
    }

    /// A circle of paper within a line.
    pub fn ring(&mut self, tone: Tone, centre: (f64, f64), radius: f64) {
        self.circle(&format!("{} ring", tone.class()), centre, radius);
    }

    /// One line of text.
    pub fn text(&mut self, lettering: Lettering, at: (f64, f64), anchor: Anchor, text: &str) {
        let class = match lettering {
            Lettering::Heading => "title large",
            Lettering::Plain => "plain",
            Lettering::Remark => "muted",
            Lettering::Name => "name over",
        };
        if at.0.is_finite() && at.1.is_finite() {
            self.label(class, at, anchor, &Label::plain(text));
        }
    }

    /// What `inside` draws, moved to the right and downward.
    pub fn moved(&mut self, by: (f64, f64), inside: impl FnOnce(&mut Canvas)) {
        let [x, y] = [by.0, by.1].map(number);
        let _ = write!(self.inside, r#"<g transform="translate({x} {y})">"#);
        inside(self);
        self.inside.push_str("</g>");
    }

    pub(crate) fn circle(&mut self, class: &str, (x, y): (f64, f64), radius: f64) {
        if !(x.is_finite() && y.is_finite() && radius >= 0.0) {
            return;
        }
        let [x, y, radius] = [x, y, radius].map(number);
        let _ = write!(self.inside, r#"<circle class="{class}" cx="{x}" cy="{y}" r="{radius}"/>"#);
    }

    pub(crate) fn line(&mut self, class: &str, a: (f64, f64), b: (f64, f64)) {
        self.path(class, &polyline(&[a, b]));
    }

    pub(crate) fn path(&mut self, class: &str, d: &str) {
        let _ = write!(self.inside, r#"<path class="{class}" d="{d}"/>"#);
    }

    pub(crate) fn rect(&mut self, class: &str, x: f64, y: f64, width: f64, height: f64) {
        let [x, y, width, height] = [x, y, width, height].map(number);
        let _ = write!(
            self.inside,
            r#"<rect class="{class}" x="{x}" y="{y}" width="{width}" height="{height}"/>"#
        );
    }

    pub(crate) fn label(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor, label: &Label) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " mid",
            Anchor::End => " end",
        };
        let _ = write!(
            self.inside,
            r#"<text class="{class}{anchor}" x="{}" y="{}">"#,
            number(x),
            number(y)
        );
        let mut raised = false;
        for run in &label.0 {
            let _ = match run {
                Run::Raised(text) => {
                    raised = true;
                    write!(self.inside, r#"<tspan class="sup" dy="-5">{}</tspan>"#, escaped(text))
                }
                // The shift of a raised run lasts until it is taken back.
                Run::Plain(text) if raised => {
                    raised = false;
                    write!(self.inside, r#"<tspan dy="5">{}</tspan>"#, escaped(text))
                }
                Run::Plain(text) => write!(self.inside, "{}", escaped(text)),
            };
        }
        self.inside.push_str("</text>");
    }

    /// A label above the line from `a` to `b`, turned along it, upright.
    pub(crate) fn label_along(&mut self, class: &str, [a, b]: [(f64, f64); 2], label: &Label) {
        let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
        let turn = (b.1 - a.1).atan2(b.0 - a.0).to_degrees();
        let [x, y, turn] = [0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1), turn].map(number);
        let _ = write!(self.inside, r#"<g transform="translate({x} {y}) rotate({turn})">"#);
        self.label(class, (0.0, -6.0), Anchor::Middle, label);
        self.inside.push_str("</g>");
    }

    /// A mark that says its numbers when pointed at: the first line of `tip` is its name.
    pub(crate) fn point(&mut self, class: &str, at: (f64, f64), tip: &str, mark: &str) {
        let _ = write!(
            self.inside,
            r#"<g class="pt {class}" transform="translate({} {})"><title>{}</title>{mark}</g>"#,
            number(at.0),
            number(at.1),
            escaped(tip)
        );
    }

    /// A path that says its numbers when pointed at.
    pub(crate) fn tipped(&mut self, class: &str, d: &str, tip: &str) {
        let tip = escaped(tip);
        let _ = write!(self.inside, r#"<path class="{class}" d="{d}"><title>{tip}</title></path>"#);
    }

    pub(crate) fn group(&mut self, class: &str, inside: impl FnOnce(&mut Canvas)) {
        let _ = write!(self.inside, r#"<g class="{class}">"#);
        inside(self);
        self.inside.push_str("</g>");
    }
}

/// Beyond this many pixels nothing is seen, and some renderers lose their footing.
const FAR: f64 = 1e6;

/// A coordinate with one decimal. What is not finite must not reach the file.
pub(crate) fn number(x: f64) -> String {
    let x = if x.is_finite() { x.clamp(-FAR, FAR) } else { 0.0 };
    let text = format!("{x:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// Text that is safe in HTML and in XML, as content and in a quoted attribute.
#[must_use]
pub fn escaped(text: &str) -> String {
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

/// A style sheet inside XML: only `<` and `&` would end it.
fn escaped_sheet() -> String {
    sheet().replace('&', "&amp;").replace('<', "&lt;")
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
    fn what_has_no_place_is_not_drawn() {
        let nan = f64::NAN;
        let mut canvas = Canvas::new(f64::INFINITY, nan);
        canvas.dot(Tone::Ink, (nan, 0.0), 3.0);
        canvas.ring(Tone::Ink, (0.0, 0.0), nan);
        canvas.text(Lettering::Plain, (0.0, nan), Anchor::Start, "lost");
        canvas.stroke(Tone::Ink, 1.0, &Path::line(&[(nan, 0.0), (f64::INFINITY, 1.0)]));
        let svg = canvas.svg(Medium::Inline, "nothing");
        assert!(!svg.contains("<circle") && !svg.contains("lost"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(svg.contains(r#"d="""#), "{svg}");
    }

    #[test]
    fn a_raised_run_is_taken_back() {
        let mut canvas = Canvas::new(100.0, 100.0);
        let label = Label::plain("a [").then(Label::power_of_ten(-6)).then(Label::plain(" J]"));
        canvas.label("t", (0.0, 0.0), Anchor::Start, &label);
        let svg = canvas.svg(Medium::Inline, "");
        assert!(svg.contains(r#"dy="-5">−6</tspan><tspan dy="5"> J]</tspan>"#), "{svg}");
    }
}
