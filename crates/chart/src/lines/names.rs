//! Names beside their lines, where they cover nothing, and words along a path.

use crate::canvas::{Anchor, Canvas};
use crate::frame::Frame;
use crate::label::{Label, TEXT, text_width};
use crate::path::polyline;
use crate::place::{Crowd, Rect, spread};

/// From the plot's right edge to the column of labels.
pub(super) const COLUMN: f64 = 22.0;
/// Distance between two labels in the column.
pub(super) const GAP: f64 = 17.0;

/// A line's name and where the line begins and ends.
pub(super) struct End {
    pub(super) name: String,
    pub(super) class: String,
    pub(super) start: (f64, f64),
    pub(super) end: (f64, f64),
}

/// A name stands beside an end of its line where that covers nothing, else in the column at the
/// right with a leader to the end.
pub(super) fn draw_direct_labels(
    canvas: &mut Canvas,
    crowd: &mut Crowd,
    frame: &Frame,
    ends: &[End],
) {
    let plot = &frame.data;
    let mut column: Vec<&End> = Vec::new();
    for label in ends {
        let width = text_width(&label.name, TEXT);
        let spot = if label.end.0 > plot.right - 40.0 {
            None
        } else {
            crowd.free(beside(label.end, label.start, width), plot)
        };
        match spot {
            Some(spot) => {
                crowd.add_label(spot);
                draw_name(canvas, label, (spot.left, spot.bottom - 4.0));
            }
            None => column.push(label),
        }
    }
    let ideal: Vec<f64> = column.iter().map(|label| label.end.1).collect();
    let heights = spread(&ideal, GAP, plot.top + 6.0, plot.bottom - 6.0);
    for (label, y) in column.into_iter().zip(heights) {
        let (x, end) = (label.end.0 + 7.0, label.end.1);
        let turn = (plot.right.max(x) + 4.0, end);
        let leader = [(x, end), turn, (plot.right + COLUMN - 6.0, y)];
        crowd.add_polyline(&leader);
        canvas.group(&label.class, |canvas| canvas.path("leader", &polyline(&leader)));
        let left = plot.right + COLUMN;
        let width = text_width(&label.name, TEXT);
        crowd.add_label(Rect { left, top: y - 8.0, right: left + width, bottom: y + 8.0 });
        draw_name(canvas, label, (left, y + 4.5));
    }
}

/// Spots around the right end of a line, then around its left end.
fn beside(end: (f64, f64), start: (f64, f64), width: f64) -> impl Iterator<Item = Rect> {
    let half = 0.5 * width;
    let around = move |(x, y): (f64, f64), side: f64| {
        [
            (x + side * (half + 11.0), y),
            (x + side * (half + 6.0), y - 13.0),
            (x + side * (half + 6.0), y + 13.0),
            (x, y - 17.0),
            (x, y + 17.0),
        ]
    };
    let centres = around(end, 1.0).into_iter().chain(around(start, -1.0));
    centres.map(move |centre| Rect::around(centre, width, 16.0))
}

fn draw_name(canvas: &mut Canvas, label: &End, at: (f64, f64)) {
    canvas.group(&label.class, |canvas| {
        canvas.label("name over", at, Anchor::Start, &Label::plain(label.name.clone()));
    });
}

/// A label in muted ink beside a path, where it covers least.
pub(crate) fn draw_along(
    canvas: &mut Canvas,
    crowd: &mut Crowd,
    page: &Rect,
    text: &str,
    path: &[(f64, f64)],
) {
    let width = text_width(text, TEXT);
    let half = 0.5 * width;
    let offsets = [
        (half + 8.0, 0.0),
        (half + 5.0, -13.0),
        (half + 5.0, 13.0),
        (0.0, -15.0),
        (0.0, 15.0),
        (-half - 5.0, -13.0),
        (-half - 5.0, 13.0),
        (-half - 8.0, 0.0),
    ];
    let spots = along(path)
        .into_iter()
        .flat_map(|(x, y)| offsets.map(|(dx, dy)| Rect::around((x + dx, y + dy), width, 16.0)));
    if let Some(spot) = crowd.best(spots, page) {
        crowd.add_label(spot);
        let at = (spot.left, spot.bottom - 4.0);
        canvas.label("muted over", at, Anchor::Start, &Label::plain(text));
    }
}

/// Points along a path, the far end first.
fn along(path: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = path
        .windows(2)
        .flat_map(|p| {
            (0..8)
                .map(move |i| f64::from(i) / 8.0)
                .map(move |t| (p[0].0 + t * (p[1].0 - p[0].0), p[0].1 + t * (p[1].1 - p[0].1)))
        })
        .collect();
    points.extend(path.last());
    points.reverse();
    points
}
