//! Outcomes in a plane of two parameters, with predicted borders drawn over them.

use super::Drawing;
use super::axis::{Axis, Ruler, Scale, measure};
use super::canvas::{Canvas, number, polyline};
use super::frame::{Aspect, Frame, Layout, LegendEntry, Plan, Swatch, draw_legend};
use super::lines::draw_along;
use super::place::Crowd;
use super::series::tip;
use super::stroke::hatch;

/// Outcomes in a plane of two parameters.
#[derive(Clone, Debug)]
pub struct Map {
    /// What is seen; may be empty where the study's title says it.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Names of the outcomes. The first is calm and plain; the others are hatched.
    pub outcomes: Vec<String>,
    /// Cells: x, y, and the place of their outcome in the list.
    pub cells: Vec<(f64, f64, usize)>,
    /// Predicted borders between outcomes.
    pub borders: Vec<Border>,
}

/// A predicted border.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// What it says.
    pub label: String,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

impl Map {
    /// An empty map. The first outcome is the good one.
    pub fn new<const N: usize>(title: &str, x: Axis, y: Axis, outcomes: [&str; N]) -> Self {
        let outcomes = outcomes.map(str::to_owned).to_vec();
        Map { title: title.into(), x, y, outcomes, cells: Vec::new(), borders: Vec::new() }
    }

    /// Adds the cell around a pair of parameters. An outcome that is not listed is appended.
    pub fn cell(&mut self, x: f64, y: f64, outcome: &str) {
        let place = self.outcomes.iter().position(|listed| listed == outcome);
        let place = place.unwrap_or_else(|| {
            self.outcomes.push(outcome.to_owned());
            self.outcomes.len() - 1
        });
        self.cells.push((x, y, place));
    }

    /// Adds a predicted border.
    #[must_use]
    pub fn border(mut self, label: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.borders.push(Border { label: label.into(), points: points.into_iter().collect() });
        self
    }

    pub(super) fn draw(&self, layout: Layout) -> Drawing {
        let columns = Edges::between(self.x.scale, self.cells.iter().map(|c| c.0));
        let rows = Edges::between(self.y.scale, self.cells.iter().map(|c| c.1));
        let mut canvas = Canvas::default();
        let plan = Plan {
            layout,
            title: &self.title,
            axes: (&self.x, &self.y),
            x: columns.ruler(),
            y: rows.ruler(),
            right: 14.0,
            aspect: Aspect::Free,
        };
        let frame = Frame::draw(&mut canvas, plan, |_| 0.0);
        for (place, outcome) in self.outcomes.iter().enumerate() {
            self.draw_outcome(&mut canvas, &frame, (&columns, &rows), (place, outcome));
        }
        self.draw_borders(&mut canvas, &frame);
        let entries: Vec<LegendEntry> = self
            .outcomes
            .iter()
            .enumerate()
            .map(|(place, outcome)| LegendEntry {
                class: class(place),
                text: outcome.clone(),
                swatch: Swatch::Cell(place),
            })
            .collect();
        let height = draw_legend(&mut canvas, &entries, frame.below, layout.width());
        Drawing { canvas, height }
    }

    fn draw_outcome(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        (columns, rows): (&Edges, &Edges),
        (place, outcome): (usize, &str),
    ) {
        let mut hatched = String::new();
        canvas.group(&class(place), |canvas| {
            for &(x, y, _) in self.cells.iter().filter(|cell| cell.2 == place) {
                let (Some((left, right)), Some((low, high))) = (columns.around(x), rows.around(y))
                else {
                    continue;
                };
                let [left, right] = [left, right].map(|edge| frame.x.at(edge).unwrap_or(0.0));
                let [bottom, top] = [low, high].map(|edge| frame.y.at(edge).unwrap_or(0.0));
                let tip = tip(outcome, (&self.x, &self.y), (x, y));
                canvas.cell(&cell_path((left, top), (right, bottom)), &tip);
                hatched += &hatch(place, (left, top), (right, bottom));
            }
        });
        canvas.path("hatch", &hatched);
    }

    fn draw_borders(&self, canvas: &mut Canvas, frame: &Frame) {
        let mut crowd = Crowd::default();
        for border in &self.borders {
            let at = |&(x, y): &(f64, f64)| Some((frame.x.at(x)?, frame.y.at(y)?));
            let path: Vec<(f64, f64)> = border.points.iter().filter_map(at).collect();
            let visible: Vec<[(f64, f64); 2]> =
                path.windows(2).filter_map(|p| frame.data.clip(p[0], p[1])).collect();
            let d: String = visible.iter().map(|s| polyline(s)).collect();
            canvas.path("under", &d);
            canvas.path("border", &d);
            let points: Vec<(f64, f64)> = visible.into_iter().flatten().collect();
            crowd.add_polyline(&points);
            draw_along(canvas, &mut crowd, &frame.data, &border.label, &points);
        }
    }
}

fn class(place: usize) -> String {
    format!("o{}", place % 5)
}

/// Path data of a cell, a hair larger than it is so that neighbours leave no seam.
fn cell_path((left, top): (f64, f64), (right, bottom): (f64, f64)) -> String {
    let (w, h) = (number(right - left + 0.3), number(bottom - top + 0.3));
    format!("M{} {}h{w}v{h}h-{w}z", number(left), number(top))
}

/// Borders between neighbouring values of an axis, halfway as the axis measures.
struct Edges {
    scale: Scale,
    values: Vec<f64>,
    edges: Vec<f64>,
}

impl Edges {
    fn between(scale: Scale, values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.filter_map(|value| measure(scale, value)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let middles = values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let mut edges: Vec<f64> = middles.collect();
        if let (Some(&first), Some(&last)) = (values.first(), values.last()) {
            // The outermost cells are as wide beyond their value as before it.
            let before = edges.first().map_or(first - 0.5, |&edge| 2.0 * first - edge);
            let after = edges.last().map_or(last + 0.5, |&edge| 2.0 * last - edge);
            edges.insert(0, before);
            edges.push(after);
        }
        Edges { scale, values, edges }
    }

    fn value(&self, measure: f64) -> f64 {
        match self.scale {
            Scale::Linear => measure,
            Scale::Log => 10_f64.powf(measure),
        }
    }

    fn ruler(&self) -> Ruler {
        let values = self.edges.iter().map(|&edge| self.value(edge));
        Ruler::covering(self.scale, values, 0.0, (0.0, 1.0))
    }

    /// The edges of the cell that holds `value`.
    fn around(&self, value: f64) -> Option<(f64, f64)> {
        let measure = measure(self.scale, value)?;
        let i = self.values.iter().position(|&own| own == measure)?;
        Some((self.value(self.edges[i]), self.value(self.edges[i + 1])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_meet_halfway_as_their_axis_measures() {
        let edges = Edges::between(Scale::Log, [1.0, 100.0, 10.0, 10.0].into_iter());
        let (low, high) = edges.around(10.0).unwrap();
        assert!((low - 10_f64.sqrt()).abs() < 1e-12 && (high - 1000_f64.sqrt()).abs() < 1e-10);
        assert_eq!(edges.around(0.0), None);
        assert_eq!(edges.around(f64::NAN), None);
    }

    #[test]
    fn a_single_cell_and_no_cell_have_an_extent() {
        for values in [vec![], vec![2.0], vec![f64::NAN]] {
            let ruler = Edges::between(Scale::Linear, values.into_iter()).ruler();
            assert!(ruler.extent() > 0.0);
        }
    }

    #[test]
    fn an_outcome_that_is_not_listed_is_appended() {
        let axis = || Axis::linear("a", "");
        let mut map = Map::new("", axis(), axis(), ["stable"]);
        map.cell(0.0, 0.0, "stable");
        map.cell(1.0, 0.0, "diverged");
        assert_eq!(map.outcomes, ["stable", "diverged"]);
        assert_eq!(map.cells[1].2, 1);
    }
}
