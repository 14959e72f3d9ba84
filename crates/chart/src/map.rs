//! Outcomes in a plane of two parameters, with predicted borders drawn over them.
//!
//! Neighbouring cells of one outcome are drawn as one rectangle: a page of maps with thousands of
//! cells each would take seconds to open.

use crate::axis::{Axis, LEAST_EXTENT, Ruler, Scale, measure};
use crate::canvas::{Anchor, Canvas, number};
use crate::chart::Drawing;
use crate::error::ChartError;
use crate::frame::{Aspect, Frame, Layout, LegendEntry, Plan, Swatch, draw_legend};
use crate::label::{Label, TEXT, significant, text_width};
use crate::lines::draw_along;
use crate::path::polyline;
use crate::place::{Crowd, Rect};
use crate::series::quantity;
use crate::stroke::hatching;

/// Outcomes in a plane of two parameters.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// A name of a border that is no wider stands beside it where it is bent.
const SHORT: f64 = 90.0;

/// A predicted border.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    pub(crate) fn check(&self) -> Result<(), ChartError> {
        for &(x, y, place) in &self.cells {
            if measure(self.x.scale, x).is_none() || measure(self.y.scale, y).is_none() {
                return Err(ChartError::Cell { x, y });
            }
            if place >= self.outcomes.len() {
                return Err(ChartError::Outcome { place, outcomes: self.outcomes.len() });
            }
        }
        Ok(())
    }

    pub(crate) fn draw(&self, layout: Layout) -> Drawing {
        let columns = Edges::between(self.x.scale, self.cells.iter().map(|c| c.0));
        let rows = Edges::between(self.y.scale, self.cells.iter().map(|c| c.1));
        let mut canvas = Canvas::new(layout.width(), 1.0);
        let plan = Plan {
            layout,
            title: &self.title,
            axes: (&self.x, &self.y),
            x: columns.ruler(),
            y: rows.ruler(),
            categories: &[],
            right: 14.0,
            aspect: Aspect::Free,
        };
        let frame = Frame::draw(&mut canvas, plan, |_| 0.0);
        for (place, outcome) in self.outcomes.iter().enumerate() {
            self.draw_outcome(&mut canvas, &frame, (&columns, &rows), (place, outcome));
        }
        let numbered = self.draw_borders(&mut canvas, &frame);
        self.name_the_only_outcome(&mut canvas, &frame);
        let entries: Vec<LegendEntry> = self
            .outcomes
            .iter()
            .enumerate()
            .filter(|(place, _)| self.cells.iter().any(|cell| cell.2 == *place))
            .map(|(place, outcome)| LegendEntry {
                class: class(place),
                text: outcome.clone(),
                swatch: Swatch::Cell(place),
            })
            .chain(numbered)
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
        let own = self.cells.iter().filter(|cell| cell.2 == place);
        let cells: Vec<[usize; 2]> =
            own.filter_map(|&(x, y, _)| Some([columns.index(x)?, rows.index(y)?])).collect();
        let corners = |block: &Block| {
            let [left, right] = columns.ends(block.columns).map(|x| frame.x.at(x).unwrap_or(0.0));
            let [bottom, top] = rows.ends(block.rows).map(|y| frame.y.at(y).unwrap_or(0.0));
            Rect { left, top, right, bottom }
        };
        canvas.group(&class(place), |canvas| {
            for block in blocks(&cells) {
                let area = corners(&block);
                let x = range(&self.x, columns.values(block.columns));
                let y = range(&self.y, rows.values(block.rows));
                canvas.tipped("cell", &cell_path(area), &format!("{outcome}\n{x}\n{y}"));
            }
        });
        let covered = blocks(&cells);
        let areas: Vec<Rect> = covered.iter().map(corners).collect();
        canvas.path("hatch", &hatching(place, &areas));
    }

    /// A plane of one colour looks as if nothing was drawn: it says what it is.
    fn name_the_only_outcome(&self, canvas: &mut Canvas, frame: &Frame) {
        let words = match self.cells.first() {
            None => "no data".to_owned(),
            Some(first) if self.cells.iter().all(|cell| cell.2 == first.2) => {
                format!("everywhere: {}", self.outcomes[first.2])
            }
            Some(_) => return,
        };
        let middle = (
            0.5 * (frame.plot.left + frame.plot.right),
            0.5 * (frame.plot.top + frame.plot.bottom) + 4.5,
        );
        canvas.label("name", middle, Anchor::Middle, &Label::plain(words));
    }

    /// Names each border along itself; one that is too short for its name has a number, which the legend
    /// explains.
    fn draw_borders(&self, canvas: &mut Canvas, frame: &Frame) -> Vec<LegendEntry> {
        let (mut crowd, mut numbered) = (Crowd::default(), Vec::new());
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
            let along = straight_parts(&points, text_width(&border.label, TEXT) + 8.0)
                .into_iter()
                .find(|part| crowd.has_no_label(&around(part)));
            match along {
                Some(part) => {
                    crowd.add_label(around(&part));
                    let label = Label::plain(border.label.clone());
                    canvas.label_along("name over", part, &label);
                }
                None if points.is_empty() => {}
                None if text_width(&border.label, TEXT) <= SHORT => {
                    draw_along(canvas, &mut crowd, &frame.data, &border.label, &points);
                }
                None => {
                    let number = (numbered.len() + 1).to_string();
                    draw_along(canvas, &mut crowd, &frame.data, &number, &points);
                    numbered.push(LegendEntry {
                        class: "ref".to_owned(),
                        text: format!("{number}: {}", border.label),
                        swatch: Swatch::Line(None),
                    });
                }
            }
        }
        numbered
    }
}

/// What a label above a line takes, upright.
fn around([a, b]: &[(f64, f64); 2]) -> Rect {
    const HEIGHT: f64 = 18.0;
    Rect {
        left: a.0.min(b.0),
        top: a.1.min(b.1) - HEIGHT,
        right: a.0.max(b.0),
        bottom: a.1.max(b.1),
    }
}

/// The ends of parts of the path that are as long as asked and bend by less than half a letter, those
/// near the path's middle first.
fn straight_parts(path: &[(f64, f64)], long: f64) -> Vec<[(f64, f64); 2]> {
    const BEND: f64 = 5.0;
    let length = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1);
    let total: f64 = path.windows(2).map(|pair| length(pair[0], pair[1])).sum();
    let at = |distance: f64| {
        let mut left = distance;
        path.windows(2).find_map(|pair| {
            let own = length(pair[0], pair[1]);
            if left <= own && own > 0.0 {
                let t = left / own;
                let along = |a: f64, b: f64| a + t * (b - a);
                return Some((along(pair[0].0, pair[1].0), along(pair[0].1, pair[1].1)));
            }
            left -= own;
            None
        })
    };
    let slack = total - long;
    if slack.is_nan() || slack < 0.0 {
        return Vec::new();
    }
    let parts = [0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0].into_iter().filter_map(|share| {
        let start = share * slack;
        let (a, b) = (at(start)?, at(start + 0.999 * long)?);
        let chord = length(a, b);
        // How far the path's own points between leave the chord.
        let bent = (1..8).filter_map(|k| at(start + 0.125 * f64::from(k) * long)).any(|p| {
            let across = (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
            across.abs() > BEND * chord
        });
        (!bent && chord > 0.95 * 0.999 * long).then_some([a, b])
    });
    parts.collect()
}

fn class(place: usize) -> String {
    format!("o{}", place % 5)
}

/// Cells from a first to a last column and row, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    columns: [usize; 2],
    rows: [usize; 2],
}

/// Rectangles that cover these cells of a grid, each once: runs along rows, and equal runs of rows
/// above each other.
fn blocks(cells: &[[usize; 2]]) -> Vec<Block> {
    let mut cells: Vec<[usize; 2]> = cells.iter().map(|&[x, y]| [y, x]).collect();
    cells.sort_unstable();
    cells.dedup();
    let mut blocks: Vec<Block> = Vec::new();
    for run in cells.chunk_by(|a, b| a[0] == b[0] && a[1] + 1 == b[1]) {
        let (row, columns) = (run[0][0], [run[0][1], run[run.len() - 1][1]]);
        let below = |block: &&mut Block| block.columns == columns && block.rows[1] + 1 == row;
        match blocks.iter_mut().find(below) {
            Some(block) => block.rows[1] = row,
            None => blocks.push(Block { columns, rows: [row, row] }),
        }
    }
    blocks
}

/// `step: 0.125 s`, or `step: 0.125 to 0.25 s`
fn range(axis: &Axis, [first, last]: [f64; 2]) -> String {
    if first == last {
        return quantity(axis, first);
    }
    let (first, last) = (significant(first, 4), significant(last, 4));
    format!("{}: {first} to {last} {}", axis.title, axis.unit).trim_end().to_owned()
}

/// Path data of a cell, a hair larger than it is so that neighbours leave no seam.
fn cell_path(Rect { left, top, right, bottom }: Rect) -> String {
    let (w, h) = (number(right - left + 0.3), number(bottom - top + 0.3));
    format!("M{} {}h{w}v{h}h-{w}z", number(left), number(top))
}

/// Half the width of a cell that has no neighbours along a linear axis: a part of its value, to be seen there.
fn half_of_the_only(value: f64) -> f64 {
    if value.abs() < LEAST_EXTENT { 0.5 } else { 0.5 * value.abs() }
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
            let half = if scale == Scale::Log { 0.5 } else { half_of_the_only(first) };
            let before = edges.first().map_or(first - half, |&edge| 2.0 * first - edge);
            let after = edges.last().map_or(last + half, |&edge| 2.0 * last - edge);
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

    /// The place of the cell that holds `value`.
    fn index(&self, value: f64) -> Option<usize> {
        let measure = measure(self.scale, value)?;
        self.values.binary_search_by(|own| own.total_cmp(&measure)).ok()
    }

    /// The outer edges of a first and a last cell.
    fn ends(&self, [first, last]: [usize; 2]) -> [f64; 2] {
        [self.value(self.edges[first]), self.value(self.edges[last + 1])]
    }

    /// The values of a first and a last cell.
    fn values(&self, ends: [usize; 2]) -> [f64; 2] {
        ends.map(|place| self.value(self.values[place]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Chart;

    #[test]
    fn cells_meet_halfway_as_their_axis_measures() {
        let edges = Edges::between(Scale::Log, [1.0, 100.0, 10.0, 10.0].into_iter());
        let [low, high] = edges.ends([edges.index(10.0).unwrap(); 2]);
        assert!((low - 10_f64.sqrt()).abs() < 1e-12 && (high - 1000_f64.sqrt()).abs() < 1e-10);
        assert_eq!(edges.index(0.0), None);
        assert_eq!(edges.index(f64::NAN), None);
    }

    #[test]
    fn a_cell_without_neighbours_is_seen_at_any_value() {
        for value in [0.0, 3.0, -1e-9, 1e20, 1e-312, -5e299] {
            let edges = Edges::between(Scale::Linear, [value].into_iter());
            let ruler = edges.ruler().over((0.0, 300.0));
            let [low, high] = edges.ends([0, 0]).map(|edge| ruler.at(edge).unwrap());
            assert!(high - low > 200.0, "{value}: {low} to {high}");
            assert!((ruler.at(value).unwrap() - 150.0).abs() < 1.0, "{value}");
        }
    }

    #[test]
    fn blocks_cover_each_cell_once_and_no_other() {
        let inside = |x: usize, y: usize| (3 * x + 5 * y) % 7 < 4 || (4..9).contains(&x) && y > 3;
        let all = || (0..12).flat_map(|x| (0..10).map(move |y| [x, y]));
        let cells: Vec<[usize; 2]> = all().filter(|&[x, y]| inside(x, y)).collect();
        let blocks = blocks(&cells);
        for [x, y] in all() {
            let within = |ends: [usize; 2], i| (ends[0]..=ends[1]).contains(&i);
            let covering = blocks.iter().filter(|b| within(b.columns, x) && within(b.rows, y));
            assert_eq!(covering.count(), usize::from(inside(x, y)), "{x} {y}");
        }
        assert!(blocks.len() < cells.len() / 2);
    }

    #[test]
    fn a_map_of_one_outcome_is_one_rectangle() {
        let axis = || Axis::linear("a", "m");
        let mut map = Map::new("", axis(), axis(), ["stable"]);
        (0..30).for_each(|x| (0..20).for_each(|y| map.cell(f64::from(x), f64::from(y), "stable")));
        let svg = Chart::from(map).file("").unwrap();
        assert_eq!(svg.matches("<title>").count(), 2, "its own and the rectangle's");
        assert!(svg.contains(">everywhere: stable</text>"), "{svg}");
        assert!(svg.contains("<title>stable\na: 0 to 29 m\na: 0 to 19 m</title>"), "{svg}");
    }

    #[test]
    fn a_border_is_named_along_itself_where_it_is_straight() {
        let line: Vec<(f64, f64)> =
            (0..40).map(|i| f64::from(i) * 10.0).map(|x| (x, 0.5 * x)).collect();
        let [a, b] = straight_parts(&line, 100.0)[0];
        assert!(((b.0 - a.0).hypot(b.1 - a.1) - 100.0).abs() < 0.2);
        assert!((0.5 * (a.0 + b.0) - 195.0).abs() < 1.0, "in the middle");
        assert!(straight_parts(&line, 1000.0).is_empty());
        let bent: Vec<(f64, f64)> = (0..40)
            .map(|i| 0.08 * f64::from(i))
            .map(|turn| (40.0 * turn.cos(), 40.0 * turn.sin()))
            .collect();
        assert!(straight_parts(&bent, 100.0).is_empty());
    }

    #[test]
    fn a_border_too_short_for_its_name_has_a_number_that_the_legend_explains() {
        let axis = || Axis::linear("a", "m");
        let mut map = Map::new("", axis(), axis(), ["stable", "lost"])
            .border("a name that is far longer than its border", [(0.0, 0.0), (1.0, 1.0)])
            .border("short", [(0.0, 9.0), (9.0, 9.0)]);
        (0..10).for_each(|x| map.cell(f64::from(x), f64::from(x), "stable"));
        map.cell(0.0, 9.0, "lost");
        let svg = Chart::from(map).file("").unwrap();
        assert!(svg.contains(">1</text>") && svg.contains(">short</text>"), "{svg}");
        assert!(svg.contains(">1: a name that is far longer than its border</text>"), "{svg}");
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
