//! A chart: data until it is drawn, in one of two layouts, for a page or for a file.

use crate::bars::Bars;
use crate::canvas::Canvas;
use crate::error::ChartError;
use crate::frame::Layout;
use crate::ladder::Ladder;
use crate::lines::Lines;
use crate::map::Map;
use crate::portrait::Portrait;
use crate::style::Styles;

/// A picture of numbers.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Chart {
    /// Curves and points over two axes.
    Lines(Lines),
    /// Outcomes in a plane of two parameters.
    Map(Map),
    /// Numbers of categories.
    Bars(Bars),
    /// Settings of methods, of which one is to be chosen for a tolerance.
    Ladder(Ladder),
    /// A vector field with curves and steps, on axes of equal scale.
    Portrait(Portrait),
}

macro_rules! is_a_chart {
    ($($kind:ident)*) => {
        $(
            impl From<$kind> for Chart {
                fn from(chart: $kind) -> Self {
                    Chart::$kind(chart)
                }
            }
        )*
    };
}
is_a_chart!(Lines Map Bars Ladder Portrait);

/// Where a picture will stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// In a page that has the style sheet, [`sheet`](crate::sheet).
    Inline,
    /// In a file of its own, with the style sheet and the paper.
    File,
}

/// A finished drawing and its height.
pub(crate) struct Drawing {
    pub(crate) canvas: Canvas,
    pub(crate) height: f64,
}

impl Chart {
    /// The chart's own title.
    #[must_use]
    pub fn title(&self) -> &str {
        match self {
            Chart::Lines(lines) => &lines.title,
            Chart::Map(map) => &map.title,
            Chart::Bars(bars) => &bars.title,
            Chart::Ladder(ladder) => &ladder.title,
            Chart::Portrait(portrait) => &portrait.title,
        }
    }

    /// The names on the chart that have a look of their own.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match self {
            Chart::Lines(lines) => lines.names(),
            Chart::Map(_) => Vec::new(),
            Chart::Bars(bars) => bars.series.iter().map(|series| series.name.clone()).collect(),
            Chart::Ladder(ladder) => ladder.names(),
            Chart::Portrait(portrait) => portrait.names(),
        }
    }

    /// Whether it can be drawn at all.
    ///
    /// # Errors
    /// A [`ChartError`], where it says what no drawing can show. A number that is not finite is no
    /// error.
    pub fn check(&self) -> Result<(), ChartError> {
        match self {
            Chart::Lines(lines) => lines.check(),
            Chart::Map(map) => map.check(),
            Chart::Bars(bars) => bars.check(),
            Chart::Ladder(ladder) => ladder.check(),
            Chart::Portrait(portrait) => portrait.check(),
        }
    }

    /// The chart as the text of an SVG file, in the wide layout. `description` is what a reader who
    /// cannot see it is told.
    ///
    /// # Errors
    /// As [`Chart::check`].
    pub fn file(&self, description: &str) -> Result<String, ChartError> {
        let styles = Styles::assign(&[], &[self.names()]);
        self.svg(Layout::Wide, Medium::File, &styles, description)
    }

    /// Draws. `styles` are the looks of the names, shared by all charts of a page; `description` is
    /// what a reader who cannot see the chart is told.
    ///
    /// # Errors
    /// As [`Chart::check`].
    pub fn svg(
        &self,
        layout: Layout,
        medium: Medium,
        styles: &Styles,
        description: &str,
    ) -> Result<String, ChartError> {
        self.check()?;
        let drawing = match self {
            Chart::Lines(lines) => lines.draw(layout, styles),
            Chart::Map(map) => map.draw(layout),
            Chart::Bars(bars) => bars.draw(layout, styles),
            Chart::Ladder(ladder) => ladder.draw(layout, styles),
            Chart::Portrait(portrait) => portrait.draw(layout, styles),
        };
        let canvas = drawing.canvas.with_height(drawing.height);
        Ok(canvas.classified(layout.name(), medium, description))
    }
}
