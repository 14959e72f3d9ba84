//! The frame of a chart: title, axes, grid, and the rectangle that is left for the data.

use super::axis::{Along, Axis, Ruler, Ticks};
use super::canvas::{Anchor, Canvas, polyline};
use super::label::{LINE, Label, TEXT, text_width, wrapped};
use super::place::Rect;
use super::stroke::{arrow, hatch};
use super::style::Style;

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

    pub(super) fn name(self) -> &'static str {
        match self {
            Layout::Wide => "wide",
            Layout::Narrow => "narrow",
        }
    }

    pub(super) fn plot_height(self) -> f64 {
        match self {
            Layout::Wide => 360.0,
            Layout::Narrow => 290.0,
        }
    }
}

/// How the plot fills its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aspect {
    /// As wide as there is room.
    Free,
    /// A unit is as long along x as along y.
    Equal,
}

/// What a frame is made from.
pub(super) struct Plan<'a> {
    pub(super) layout: Layout,
    pub(super) title: &'a str,
    pub(super) axes: (&'a Axis, &'a Axis),
    /// Extents; their pixels are not used.
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    /// Room kept for labels right of the plot.
    pub(super) right: f64,
    pub(super) aspect: Aspect,
}

/// Axes in place.
pub(super) struct Frame {
    pub(super) plot: Rect,
    /// The plot without the lane of failures.
    pub(super) data: Rect,
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    /// Where the drawing may go on below the axes.
    pub(super) below: f64,
}

const FAILED: &str = "failed";
/// Keeps the topmost tick label clear of the word beside the lane.
const BELOW_LANE: f64 = 10.0;

impl Frame {
    /// Draws title, axes and grid. `lane` says how much of the top the failures need, once it is
    /// known where they are on the x axis.
    pub(super) fn draw(canvas: &mut Canvas, plan: Plan, lane: impl FnOnce(&Ruler) -> f64) -> Self {
        let width = plan.layout.width();
        let height = plan.layout.plot_height();
        let rough = plan.y.over((height, 0.0)).ticks(Along::Vertical);
        let left = rough.widest().max(text_width(FAILED, TEXT)).max(28.0) + 12.0;
        let room = width - left - plan.right;
        let (room, height) = match plan.aspect {
            Aspect::Free => (room, height),
            Aspect::Equal => {
                let scale = (room / plan.x.extent()).min(1.25 * height / plan.y.extent());
                (scale * plan.x.extent(), scale * plan.y.extent())
            }
        };
        let heading = plan.axes.1.heading(rough.left_out, width - 8.0);
        let top = draw_head(canvas, plan.title, &heading, width);
        let plot = Rect { left, top, right: left + room, bottom: top + height };
        let x = plan.x.over((plot.left, plot.right));
        let lane = lane(&x);
        let clear = if lane > 0.0 { BELOW_LANE } else { 0.0 };
        let y = plan.y.over((plot.bottom, plot.top + lane + clear));
        let data = Rect { top: plot.top + lane, ..plot };
        if lane > 0.0 {
            canvas.rect("lane", plot.left, plot.top, room, lane);
            let at = (plot.left - 8.0, plot.top + 0.5 * lane + 4.5);
            canvas.text("muted", at, Anchor::End, &Label::plain(FAILED));
        }
        let (x_ticks, y_ticks) = (x.ticks(Along::Horizontal), y.ticks(Along::Vertical));
        draw_grid(canvas, &data, &x_ticks, &y_ticks, width);
        let mut below = plot.bottom + 22.0;
        for line in plan.axes.0.heading(x_ticks.left_out, width - 8.0) {
            below += LINE;
            let half = 0.5 * line.width();
            let middle = (0.5 * (plot.left + plot.right)).max(half + 4.0).min(width - half - 4.0);
            canvas.text("muted", (middle, below), Anchor::Middle, &line);
        }
        Frame { plot, data, x, y, below: below + 16.0 }
    }
}

fn draw_head(canvas: &mut Canvas, title: &str, heading: &[Label], width: f64) -> f64 {
    let mut baseline = 0.0;
    for line in wrapped(title, width - 8.0, 15.5) {
        baseline += 20.0;
        canvas.text("title", (0.0, baseline), Anchor::Start, &Label::plain(line));
    }
    baseline += if title.is_empty() { 0.0 } else { 6.0 };
    for line in heading {
        baseline += LINE;
        canvas.text("muted", (0.0, baseline), Anchor::Start, line);
    }
    baseline + 12.0
}

fn draw_grid(canvas: &mut Canvas, plot: &Rect, x: &Ticks, y: &Ticks, width: f64) {
    for tick in &x.ticks {
        if let Some(label) = &tick.label {
            canvas.line("grid", (tick.pixel, plot.top), (tick.pixel, plot.bottom));
            canvas.line("tick", (tick.pixel, plot.bottom), (tick.pixel, plot.bottom + 6.0));
            // A wide label at the end of the axis would leave the chart.
            let middle = tick.pixel.min(width - 0.5 * label.width() - 2.0);
            canvas.text("tl", (middle, plot.bottom + 20.0), Anchor::Middle, label);
        } else {
            canvas.line("tick", (tick.pixel, plot.bottom), (tick.pixel, plot.bottom + 3.0));
        }
    }
    for tick in &y.ticks {
        if let Some(label) = &tick.label {
            canvas.line("grid", (plot.left, tick.pixel), (plot.right, tick.pixel));
            canvas.text("tl", (plot.left - 8.0, tick.pixel + 4.5), Anchor::End, label);
        } else {
            canvas.line("tick", (plot.left - 3.0, tick.pixel), (plot.left, tick.pixel));
        }
    }
    let corner = (plot.left, plot.bottom);
    canvas.path("axis", &polyline(&[(plot.left, plot.top), corner, (plot.right, plot.bottom)]));
}

/// One entry of a legend.
pub(super) struct LegendEntry {
    pub(super) class: String,
    pub(super) text: String,
    pub(super) swatch: Swatch,
}

/// What stands before a legend's text.
pub(super) enum Swatch {
    /// A piece of line, with a marker where there is a style.
    Line(Option<Style>),
    /// An arrow.
    Arrow,
    /// A cell of the outcome at this place in its map's list.
    Cell(usize),
}

/// Draws a legend in rows from `top`, and says where it ends.
pub(super) fn draw_legend(
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
        canvas.group(&entry.class, |canvas| {
            let middle = y - 4.5;
            match &entry.swatch {
                Swatch::Line(style) => {
                    canvas.line("ln", (x + 1.0, middle), (x + 25.0, middle));
                    if let Some(style) = style {
                        canvas.path("mk", &style.outline((x + 13.0, middle)));
                    }
                }
                Swatch::Arrow => {
                    canvas.path("step", &arrow((x + 1.0, middle), (x + 25.0, middle)));
                }
                Swatch::Cell(place) => {
                    let (left, right) = (x, x + 24.0);
                    let (top, bottom) = (middle - 7.0, middle + 7.0);
                    canvas.path("cell", &format!("M{left} {top}H{right}V{bottom}H{left}z"));
                    for (l, r) in [(left, left + 12.0), (left + 12.0, right)] {
                        canvas.path("hatch", &hatch(*place, (l, top), (r, bottom)));
                    }
                }
            }
            canvas.text("name", (x + 32.0, y), Anchor::Start, &Label::plain(entry.text.clone()));
        });
        x += room;
    }
    y + 10.0
}
