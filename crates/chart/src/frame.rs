//! The frame of a chart: title, axes, grid, and the rectangle that is left for the data.

use crate::axis::{Along, Axis, Ruler, Ticks};
use crate::canvas::{Anchor, Canvas};
use crate::label::{LINE, Label, TEXT, text_width, wrapped};
use crate::path::polyline;
use crate::place::Rect;
use crate::stroke::{arrow, hatching};
use crate::style::Style;

/// For which width a chart is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// A column of text on a desk.
    Wide,
    /// A phone held upright.
    Narrow,
}

impl Layout {
    /// Width in pixels.
    pub fn width(self) -> f64 {
        match self {
            Layout::Wide => 720.0,
            Layout::Narrow => 360.0,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Layout::Wide => "wide",
            Layout::Narrow => "narrow",
        }
    }

    pub(crate) fn plot_height(self) -> f64 {
        match self {
            Layout::Wide => 360.0,
            Layout::Narrow => 290.0,
        }
    }
}

/// How the plot fills its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// As wide as there is room.
    Free,
    /// A unit is as long along x as along y.
    Equal,
}

/// What a frame is made from.
pub(crate) struct Plan<'a> {
    pub(crate) layout: Layout,
    pub(crate) title: &'a str,
    pub(crate) axes: (&'a Axis, &'a Axis),
    /// Extents; their pixels are not used.
    pub(crate) x: Ruler,
    pub(crate) y: Ruler,
    /// Names of the whole numbers from 0 along x, where it has no numbers of its own.
    pub(crate) categories: &'a [String],
    /// Room kept for labels right of the plot.
    pub(crate) right: f64,
    pub(crate) aspect: Aspect,
}

/// Axes in place.
pub(crate) struct Frame {
    pub(crate) plot: Rect,
    /// The plot without the lane of failures.
    pub(crate) data: Rect,
    pub(crate) x: Ruler,
    pub(crate) y: Ruler,
    /// Where the drawing may go on below the axes.
    pub(crate) below: f64,
}

const FAILED: &str = "failed";
/// A plot of equal scales may be this many times as tall as others.
const TALLER: f64 = 1.25;
/// Keeps the topmost tick label clear of the word beside the lane.
const BELOW_LANE: f64 = 10.0;

impl Frame {
    /// Draws title, axes and grid. `lane` says how much of the top the failures need, once it is
    /// known where they are on the x axis.
    pub(crate) fn draw(canvas: &mut Canvas, plan: Plan, lane: impl FnOnce(&Ruler) -> f64) -> Self {
        let width = plan.layout.width();
        let height = plan.layout.plot_height();
        let tallest = match plan.aspect {
            Aspect::Free => height,
            Aspect::Equal => TALLER * height,
        };
        let rough = plan.y.over((tallest, 0.0)).ticks(Along::Vertical);
        let left = rough.widest().max(text_width(FAILED, TEXT)).max(28.0) + 12.0;
        let room = width - left - plan.right;
        let (room, height) = match plan.aspect {
            Aspect::Free => (room, height),
            Aspect::Equal => {
                let scale = (room / plan.x.extent()).min(tallest / plan.y.extent());
                (scale * plan.x.extent(), scale * plan.y.extent())
            }
        };
        let x = plan.x.over((left, left + room));
        let lane = lane(&x);
        let clear = if lane > 0.0 { BELOW_LANE } else { 0.0 };
        // The ticks, and the power of ten that they leave out, are those of what the lane leaves.
        let y_ticks = plan.y.over((height - lane - clear, 0.0)).ticks(Along::Vertical);
        let heading = plan.axes.1.heading(y_ticks.left_out, width - 8.0);
        let top = draw_head(canvas, plan.title, &heading, width);
        let plot = Rect { left, top, right: left + room, bottom: top + height };
        let y = plan.y.over((plot.bottom, plot.top + lane + clear));
        let y_ticks = y_ticks.moved(plot.top + lane + clear);
        let data = Rect { top: plot.top + lane, ..plot };
        if lane > 0.0 {
            canvas.rect("lane", plot.left, plot.top, room, lane);
            let at = (plot.left - 8.0, plot.top + 0.5 * lane + 4.5);
            canvas.label("muted", at, Anchor::End, &Label::plain(FAILED));
        }
        let x_ticks = match plan.categories {
            [] => x.ticks(Along::Horizontal),
            names => x.named_ticks(names),
        };
        draw_grid(canvas, &data, &x_ticks, &y_ticks, width);
        let mut below = plot.bottom + 22.0;
        for line in plan.axes.0.heading(x_ticks.left_out, width - 8.0) {
            below += LINE;
            let half = 0.5 * line.width();
            let middle = (0.5 * (plot.left + plot.right)).max(half + 4.0).min(width - half - 4.0);
            canvas.label("muted", (middle, below), Anchor::Middle, &line);
        }
        Frame { plot, data, x, y, below: below + 16.0 }
    }
}

fn draw_head(canvas: &mut Canvas, title: &str, heading: &[Label], width: f64) -> f64 {
    let mut baseline = 0.0;
    for line in wrapped(title, width - 8.0, 15.5) {
        baseline += 20.0;
        canvas.label("title", (0.0, baseline), Anchor::Start, &Label::plain(line));
    }
    baseline += if title.is_empty() { 0.0 } else { 6.0 };
    for line in heading {
        baseline += LINE;
        canvas.label("muted", (0.0, baseline), Anchor::Start, line);
    }
    baseline + 12.0
}

fn draw_grid(canvas: &mut Canvas, plot: &Rect, x: &Ticks, y: &Ticks, width: f64) {
    for tick in &x.ticks {
        if let Some(label) = &tick.label {
            canvas.line("grid", (tick.pixel, plot.top), (tick.pixel, plot.bottom));
            canvas.line("tick", (tick.pixel, plot.bottom), (tick.pixel, plot.bottom + 6.0));
            // A wide label at an end of the axis would leave the chart.
            let half = 0.5 * label.width() + 2.0;
            let middle = tick.pixel.min(width - half).max(half);
            canvas.label("tl", (middle, plot.bottom + 20.0), Anchor::Middle, label);
        } else {
            canvas.line("tick", (tick.pixel, plot.bottom), (tick.pixel, plot.bottom + 3.0));
        }
    }
    for tick in &y.ticks {
        if let Some(label) = &tick.label {
            canvas.line("grid", (plot.left, tick.pixel), (plot.right, tick.pixel));
            canvas.label("tl", (plot.left - 8.0, tick.pixel + 4.5), Anchor::End, label);
        } else {
            canvas.line("tick", (plot.left - 3.0, tick.pixel), (plot.left, tick.pixel));
        }
    }
    let corner = (plot.left, plot.bottom);
    canvas.path("axis", &polyline(&[(plot.left, plot.top), corner, (plot.right, plot.bottom)]));
}

/// One entry of a legend.
pub(crate) struct LegendEntry {
    pub(crate) class: String,
    pub(crate) text: String,
    pub(crate) swatch: Swatch,
}

/// What stands before a legend's text.
pub(crate) enum Swatch {
    /// A piece of line, with a marker where there is a style.
    Line(Option<Style>),
    /// An arrow.
    Arrow,
    /// A bar.
    Bar,
    /// A cell of the outcome at this place in its map's list.
    Cell(usize),
}

/// Draws a legend in rows from `top`, and says where it ends.
pub(crate) fn draw_legend(
    canvas: &mut Canvas,
    entries: &[LegendEntry],
    top: f64,
    width: f64,
) -> f64 {
    let (mut x, mut y) = (0.0, top + 14.0);
    for entry in entries {
        let room = 32.0 + text_width(&entry.text, TEXT) + 14.0;
        if x > 0.0 && x + room - 14.0 > width {
            (x, y) = (0.0, y + 22.0);
        }
        let mut last = y;
        canvas.group(&entry.class, |canvas| {
            let middle = y - 4.5;
            match &entry.swatch {
                Swatch::Line(style) => {
                    canvas.line("ln", (x + 1.5, middle), (x + 24.5, middle));
                    if let Some(style) = style {
                        canvas.path("mk", &style.outline((x + 13.0, middle)));
                    }
                }
                Swatch::Arrow => {
                    canvas.path("step", &arrow((x + 1.5, middle), (x + 24.5, middle)));
                }
                Swatch::Bar => {
                    let (top, bottom) = (middle - 7.0, middle + 7.0);
                    canvas.path("bar", &format!("M{x} {top}h24V{bottom}h-24z"));
                }
                Swatch::Cell(place) => {
                    let (left, right) = (x, x + 24.0);
                    let (top, bottom) = (middle - 7.0, middle + 7.0);
                    canvas.path("cell", &format!("M{left} {top}H{right}V{bottom}H{left}z"));
                    canvas.path("hatch", &hatching(*place, &[Rect { left, top, right, bottom }]));
                }
            }
            last = draw_words(canvas, &entry.text, (x + 32.0, y), width);
        });
        // Beside a name of several lines there is none.
        (x, y) = if last > y { (width, last) } else { (x + room, y) };
    }
    y + 10.0
}

/// Draws words on as many lines as the width asks for, and says where the last one stands.
pub(crate) fn draw_words(canvas: &mut Canvas, text: &str, (x, top): (f64, f64), width: f64) -> f64 {
    let mut baseline = top;
    for (k, line) in wrapped(text, width - x, TEXT).into_iter().enumerate() {
        baseline = top + k as f64 * LINE;
        canvas.label("name", (x, baseline), Anchor::Start, &Label::plain(line));
    }
    baseline
}
