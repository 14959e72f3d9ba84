//! Bars: numbers of categories, side by side where several were measured.
//!
//! Categories have an order and no distance: nothing is drawn between them, as a line would. A bar begins
//! at zero, so that its length is its value.

use crate::axis::{Axis, Ruler, Scale, is_number};
use crate::canvas::{Anchor, Canvas, number};
use crate::chart::Drawing;
use crate::error::ChartError;
use crate::frame::{Aspect, Frame, Layout, LegendEntry, Plan, Swatch, draw_legend};
use crate::label::Label;
use crate::lines::ROW;
use crate::series::quantity;
use crate::style::Styles;

/// Numbers of categories.
///
/// ```
/// use stationary_chart::{Axis, BarSeries, Bars, Chart};
///
/// let bars = Bars::new("Two balls arrive", "ball", ["1", "2", "3"], Axis::linear("velocity", "m/s"))
///     .with(BarSeries::new("reflection", [0.0, 1.0, 1.0]))
///     .with(BarSeries::new("projection", [0.4, 0.8, f64::NAN]));
/// let svg = Chart::from(bars).file("Only the reflection sends out two")?;
/// assert!(svg.contains("projection\nball: 2\nvelocity: 0.8 m/s"));
/// # Ok::<(), stationary_chart::ChartError>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bars {
    /// What is seen; may be empty where it is said elsewhere.
    pub title: String,
    /// What a category is.
    pub category: String,
    /// The categories, from left to right.
    pub categories: Vec<String>,
    /// The vertical axis, which is linear.
    pub y: Axis,
    /// The measured values.
    pub series: Vec<BarSeries>,
}

/// A value a category, under a name.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BarSeries {
    /// The name, as every other chart spells it.
    pub name: String,
    /// The values, in the order of the categories; one that is not finite is a cross at the top.
    pub values: Vec<f64>,
}

impl BarSeries {
    /// A name and its values.
    #[must_use]
    pub fn new(name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        BarSeries { name: name.into(), values: values.into_iter().collect() }
    }
}

/// The part of a category's width that bars take.
const FILLED: f64 = 0.8;
/// A value of zero is seen as a line of this height.
const LEAST: f64 = 1.5;

impl Bars {
    /// Bars of these categories, without values.
    #[must_use]
    pub fn new<S: Into<String>>(
        title: &str,
        category: &str,
        categories: impl IntoIterator<Item = S>,
        y: Axis,
    ) -> Self {
        let categories = categories.into_iter().map(Into::into).collect();
        Bars { title: title.into(), category: category.into(), categories, y, series: Vec::new() }
    }

    /// Adds a value a category.
    #[must_use]
    pub fn with(mut self, series: BarSeries) -> Self {
        self.series.push(series);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ChartError> {
        if self.y.scale == Scale::Log {
            return Err(ChartError::Logarithmic { chart: "bars", axis: self.y.title.clone() });
        }
        let categories = self.categories.len();
        match self.series.iter().find(|series| series.values.len() != categories) {
            Some(BarSeries { name, values }) => {
                Err(ChartError::Categories { name: name.clone(), values: values.len(), categories })
            }
            None => Ok(()),
        }
    }

    pub(crate) fn draw(&self, layout: Layout, styles: &Styles) -> Drawing {
        let mut canvas = Canvas::new(layout.width(), 1.0);
        let values = || self.series.iter().flat_map(|series| series.values.iter().copied());
        let x_axis = Axis::linear(&self.category, "");
        let ends = [-0.5, self.categories.len().max(1) as f64 - 0.5];
        let plan = Plan {
            layout,
            title: &self.title,
            axes: (&x_axis, &self.y),
            x: Ruler::covering(Scale::Linear, ends, 0.0, (0.0, 1.0)),
            y: Ruler::covering(Scale::Linear, values().chain([0.0]), 0.045, (0.0, 1.0)),
            categories: &self.categories,
            right: 14.0,
            aspect: Aspect::Free,
        };
        let lane = if values().all(is_number) { 0.0 } else { ROW + 3.0 };
        let frame = Frame::draw(&mut canvas, plan, |_| lane);
        let zero = frame.y.at(0.0).unwrap_or(frame.plot.bottom);
        canvas.line("axis", (frame.plot.left, zero), (frame.plot.right, zero));
        for place in 0..self.series.len() {
            self.draw_series(&mut canvas, &frame, zero, place, styles);
        }
        if self.categories.is_empty() || self.series.is_empty() {
            let at = (0.5 * (frame.plot.left + frame.plot.right), frame.plot.top + 40.0);
            canvas.label("muted", at, Anchor::Middle, &Label::plain("no data"));
        }
        let entries: Vec<LegendEntry> = self
            .series
            .iter()
            .map(|series| LegendEntry {
                class: styles.of(&series.name).class(),
                text: series.name.clone(),
                swatch: Swatch::Bar,
            })
            .collect();
        let height = draw_legend(&mut canvas, &entries, frame.below, layout.width());
        Drawing { canvas, height }
    }

    fn draw_series(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        zero: f64,
        place: usize,
        styles: &Styles,
    ) {
        let series = &self.series[place];
        let width = FILLED / self.series.len() as f64;
        let left = |category: usize| category as f64 - 0.5 * FILLED + place as f64 * width;
        canvas.group(&styles.of(&series.name).class(), |canvas| {
            for (category, &value) in series.values.iter().enumerate() {
                let ends = [left(category), left(category) + 0.92 * width].map(|x| frame.x.at(x));
                let [Some(from), Some(to)] = ends else { continue };
                let name = format!("{}: {}", self.category, self.categories[category]);
                let Some(top) = frame.y.at(value) else {
                    let at = (0.5 * (from + to), frame.plot.top + 1.5 + 0.5 * ROW);
                    let tip = format!("{} failed\n{name}\nthe value is {value:?}", series.name);
                    canvas.point("", at, &tip, r#"<path class="fail" d="M-4 -4L4 4M-4 4L4 -4"/>"#);
                    continue;
                };
                let (high, low) = (top.min(zero), top.max(zero));
                let (high, low) =
                    if low - high < LEAST { (zero - LEAST, zero) } else { (high, low) };
                let [x, y, w, h] = [from, high, to - from, low - high].map(number);
                let tip = format!("{}\n{name}\n{}", series.name, quantity(&self.y, value));
                canvas.tipped("bar", &format!("M{x} {y}h{w}v{h}h-{w}z"), &tip);
            }
        });
    }
}
