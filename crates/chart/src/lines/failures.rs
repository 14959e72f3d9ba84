//! Crosses where runs failed, at the top of the plot.

use crate::axis::{Place, Ruler};
use crate::canvas::Canvas;
use crate::frame::Frame;
use crate::lines::Lines;
use crate::series::{Weight, quantity};
use crate::style::Styles;

/// Crosses in rows, so that none hides another.
pub(super) struct Failures(Vec<Cross>);

struct Cross {
    series: usize,
    x: f64,
    row: usize,
    tip: String,
}

pub(crate) const ROW: f64 = 17.0;
const ROWS: usize = 8;

impl Failures {
    /// The crosses of all series, at their places on the axis.
    pub(super) fn of(lines: &Lines, ruler: &Ruler) -> Self {
        let mut crosses: Vec<Cross> = Vec::new();
        for (series, one) in lines.series.iter().enumerate() {
            for (at, reason) in one.all_failures() {
                // Without a place on the axis, at the end where the axis begins.
                let x = match ruler.place(at) {
                    Place::At(pixel) => pixel,
                    Place::Before | Place::Nowhere => ruler.start() + 8.0,
                };
                let taken = |row| crosses.iter().any(|c| c.row == row && (c.x - x).abs() < 13.0);
                let row = (0..ROWS).find(|&row| !taken(row)).unwrap_or(ROWS - 1);
                let tip = format!("{} failed\n{}\n{reason}", one.name, quantity(&lines.x, at));
                crosses.push(Cross { series, x, row, tip });
            }
        }
        Failures(crosses)
    }

    /// How high the rows are together.
    pub(super) fn lane(&self) -> f64 {
        self.0.iter().map(|c| c.row + 1).max().map_or(0.0, |rows| rows as f64 * ROW + 3.0)
    }

    fn height(row: usize, frame: &Frame) -> f64 {
        frame.plot.top + 1.5 + (row as f64 + 0.5) * ROW
    }

    /// The rightmost cross of a series.
    pub(super) fn last_of(&self, series: usize, frame: &Frame) -> Option<(f64, f64)> {
        let own = self.0.iter().filter(|cross| cross.series == series);
        let cross = own.max_by(|a, b| a.x.total_cmp(&b.x))?;
        Some((cross.x, Failures::height(cross.row, frame)))
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, lines: &Lines, frame: &Frame, styles: &Styles) {
        for cross in &self.0 {
            let series = &lines.series[cross.series];
            let class = match series.weight {
                Weight::Full => styles.of(&series.name).class(),
                Weight::Rest => "rest".to_owned(),
            };
            let at = (cross.x, Failures::height(cross.row, frame));
            let mark = r#"<path class="fail" d="M-4 -4L4 4M-4 4L4 -4"/>"#;
            canvas.point(&class, at, &cross.tip, mark);
        }
    }
}
