//! Charts: our own SVG, in two layouts, readable in light and dark, by colour and without.
//!
//! A chart is data; [`Chart::svg`] draws it. Text is always 13 pixels, so that a narrow layout is a
//! different drawing and not a smaller one.

mod axis;
mod canvas;
mod frame;
mod label;
mod lines;
mod map;
mod place;
mod portrait;
mod series;
mod stroke;
mod style;

pub use axis::{Axis, Scale};
pub use frame::Layout;
pub use lines::{Front, Guide, Lines};
pub use map::{Border, Map};
pub use portrait::{Portrait, StepArrow};
pub use series::{Mark, Series};
pub use style::{Style, Styles};

pub(crate) use canvas::escaped;
pub(crate) use label::significant;
pub(crate) use style::sheet;

use canvas::{Canvas, number};
use serde::{Deserialize, Serialize};

/// A picture of a table.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Chart {
    /// Curves and points over two axes.
    Lines(Lines),
    /// Outcomes in a plane of two parameters.
    Map(Map),
    /// A vector field with curves and steps, on axes of equal scale.
    Portrait(Portrait),
}

impl From<Lines> for Chart {
    fn from(lines: Lines) -> Self {
        Chart::Lines(lines)
    }
}

impl From<Map> for Chart {
    fn from(map: Map) -> Self {
        Chart::Map(map)
    }
}

impl From<Portrait> for Chart {
    fn from(portrait: Portrait) -> Self {
        Chart::Portrait(portrait)
    }
}

/// Where the picture will stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// In a page that has the style sheet.
    Inline,
    /// In a file of its own.
    File,
}

/// A finished drawing.
struct Drawing {
    canvas: Canvas,
    height: f64,
}

impl Chart {
    /// The chart's own title.
    pub fn title(&self) -> &str {
        match self {
            Chart::Lines(lines) => &lines.title,
            Chart::Map(map) => &map.title,
            Chart::Portrait(portrait) => &portrait.title,
        }
    }

    /// The names on the chart that have a look of their own.
    pub fn names(&self) -> Vec<String> {
        match self {
            Chart::Lines(lines) => lines.series.iter().map(|s| s.name.clone()).collect(),
            Chart::Map(_) => Vec::new(),
            Chart::Portrait(portrait) => {
                let curves = portrait.curves.iter().map(|curve| curve.name.clone());
                curves.chain(portrait.steps.iter().map(|step| step.name.clone())).collect()
            }
        }
    }

    /// Draws. `description` is what a reader who cannot see the chart is told.
    pub fn svg(
        &self,
        layout: Layout,
        medium: Medium,
        styles: &Styles,
        description: &str,
    ) -> String {
        let drawing = match self {
            Chart::Lines(lines) => lines.draw(layout, styles),
            Chart::Map(map) => map.draw(layout),
            Chart::Portrait(portrait) => portrait.draw(layout, styles),
        };
        let (width, height) = (number(layout.width()), number(drawing.height.ceil()));
        let (size, sheet) = match medium {
            Medium::Inline => (String::new(), String::new()),
            Medium::File => (
                format!(r#" xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}""#),
                format!("<style>{}</style>", escaped_sheet()),
            ),
        };
        format!(
            r#"<svg class="chart {}" viewBox="0 0 {width} {height}"{size} role="img" aria-label="{}">{sheet}{}</svg>"#,
            layout.name(),
            escaped(description),
            drawing.canvas.finish()
        )
    }
}

/// A style sheet inside XML: only `<` and `&` would end it.
fn escaped_sheet() -> String {
    sheet().replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests;
