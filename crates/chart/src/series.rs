//! A named series of points, and what is left of it once axes give its points a place.

use crate::axis::{Axis, Place, Scale, is_number, measure};
use crate::canvas::Canvas;
use crate::frame::Frame;
use crate::label::significant;
use crate::path::polyline;
use crate::style::Style;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mark {
    /// A line; its points show when pointed at.
    Line,
    /// Markers alone.
    Markers,
    /// A line with markers.
    LineAndMarkers,
}

/// How much of a chart a series takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Weight {
    /// A colour, and a name on the chart.
    #[default]
    Full,
    /// One of many that are thin and grey together; its points say its name when pointed at.
    Rest,
}

/// A named series of points. The name decides colour and marker throughout the report.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Series {
    /// The name, as every other chart spells it.
    pub name: String,
    /// The points, in the order of the line. A point that is not finite counts as a failure.
    pub points: Vec<(f64, f64)>,
    /// Where there is no point: at which x, and why.
    pub failures: Vec<(f64, String)>,
    /// How it is drawn.
    pub mark: Mark,
    /// What each point says besides its numbers, in the order of the points; may be shorter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub notes: Vec<String>,
    /// How much of the chart it takes.
    #[cfg_attr(feature = "serde", serde(default))]
    pub weight: Weight,
}

impl Series {
    /// A line with markers, or a line alone when the points are too many for markers.
    pub fn new(name: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points: Vec<(f64, f64)> = points.into_iter().collect();
        let mark = if points.len() <= 40 { Mark::LineAndMarkers } else { Mark::Line };
        Series {
            name: name.into(),
            points,
            failures: Vec::new(),
            mark,
            notes: Vec::new(),
            weight: Weight::Full,
        }
    }

    /// Adds a failure, which stays on the chart with its reason.
    #[must_use]
    pub fn failed(mut self, x: f64, reason: impl Into<String>) -> Self {
        self.failures.push((x, reason.into()));
        self
    }

    /// Draws it as `mark`.
    #[must_use]
    pub fn marked(mut self, mark: Mark) -> Self {
        self.mark = mark;
        self
    }

    /// Says these words at its points, in their order, besides their numbers.
    #[must_use]
    pub fn noted(mut self, notes: impl IntoIterator<Item = String>) -> Self {
        self.notes = notes.into_iter().collect();
        self
    }

    /// Draws it thin and grey, as one of the rest.
    #[must_use]
    pub fn as_rest(mut self) -> Self {
        self.weight = Weight::Rest;
        self
    }

    /// The points that the axes can show.
    pub(crate) fn shown<'a>(
        &'a self,
        x: Scale,
        y: Scale,
    ) -> impl Iterator<Item = (f64, f64)> + Clone + use<'a> {
        let placed = move |p: &&(f64, f64)| measure(x, p.0).is_some() && measure(y, p.1).is_some();
        self.points.iter().filter(placed).copied()
    }

    /// Given failures and points without a finite value, of which each run counts once.
    pub(crate) fn all_failures(&self) -> Vec<(f64, String)> {
        let finite = |p: &(f64, f64)| is_number(p.0) && is_number(p.1);
        let mut failures = self.failures.clone();
        for (i, point) in self.points.iter().enumerate() {
            let first_of_run = i == 0 || finite(&self.points[i - 1]);
            if !finite(point) && first_of_run {
                failures.push((point.0, format!("the value is {:?}", point.1)));
            }
        }
        failures
    }
}

/// A series in pixels.
#[derive(Clone, Debug)]
pub(crate) struct Trace {
    style: Style,
    pub(crate) class: String,
    /// How many later curves cover it.
    covered: usize,
    /// The line, in pieces where it is interrupted.
    pub(crate) pieces: Vec<Vec<(f64, f64)>>,
    /// Points that can be pointed at, with what they say.
    points: Vec<((f64, f64), String)>,
    /// Points beyond the start of a logarithmic axis, moved to the edge.
    beyond: Vec<((f64, f64), String, &'static str)>,
    mark: Mark,
}

/// Closer points than this cannot be pointed at one by one.
const APART: f64 = 7.0;
/// More points than this on a line are too many for a page; the CSV has them all.
const MOST_POINTS: usize = 200;
/// A line of more points is thinned.
const LONG: usize = 1500;
/// A line longer than this, in pixels, goes up and down many times and is drawn finer.
const OSCILLATING: f64 = 4000.0;
/// Points closer than this are seen as one.
const HIDDEN: f64 = 2.0;
/// A curve is not drawn wider than for so many that cover it.
const MOST_COVERED: usize = 3;
/// Closer markers than this hide the line.
const MARKERS_APART: f64 = 13.0;

impl Trace {
    pub(crate) fn of(series: &Series, axes: (&Axis, &Axis), frame: &Frame, style: Style) -> Self {
        let mut trace = Trace {
            style,
            covered: 0,
            class: match series.weight {
                Weight::Full => style.class(),
                Weight::Rest => "rest".to_owned(),
            },
            pieces: vec![Vec::new()],
            points: Vec::new(),
            beyond: Vec::new(),
            mark: if series.weight == Weight::Full { series.mark } else { unmarked(series.mark) },
        };
        let stride = series.points.len().div_ceil(MOST_POINTS);
        for (i, &(x, y)) in series.points.iter().enumerate() {
            let note = series.notes.get(i).map(|note| format!("\n{note}")).unwrap_or_default();
            let tip = || tip(&series.name, axes, (x, y)) + &note;
            match (frame.x.place(x), frame.y.place(y)) {
                (Place::At(x), Place::At(y)) => {
                    if let Some(piece) = trace.pieces.last_mut() {
                        piece.push((x, y));
                    }
                    let apart = if trace.mark == Mark::Markers { 1.0 } else { APART };
                    let counts = trace.mark == Mark::Markers || i % stride == 0;
                    if counts && far_from_last(&trace.points, (x, y), apart) {
                        trace.points.push(((x, y), tip()));
                    }
                }
                (Place::Nowhere, _) | (_, Place::Nowhere) => trace.pieces.push(Vec::new()),
                (x, y) => {
                    let turn = if x == Place::Before { "rotate(90)" } else { "" };
                    trace.pieces.push(Vec::new());
                    let edge = (pixel_or(x, frame.plot.left), pixel_or(y, frame.plot.bottom));
                    if trace.beyond.last().is_none_or(|last| distance(last.0, edge) >= APART) {
                        trace.beyond.push((edge, tip() + "\nbeyond the axis", turn));
                    }
                }
            }
        }
        trace.pieces.retain(|piece| !piece.is_empty());
        trace
    }

    /// Curves that later ones cover are drawn wider, so that all of them are seen.
    pub(crate) fn widen_what_is_covered(traces: &mut [Trace]) {
        for place in 0..traces.len() {
            let (before, after) = traces.split_at_mut(place + 1);
            before[place].covered =
                after.iter().filter(|later| later.covers(&before[place])).count().min(MOST_COVERED);
        }
    }

    /// Whether each point of another curve is hidden by one of this.
    fn covers(&self, other: &Trace) -> bool {
        let points = |trace: &Trace| trace.pieces.iter().map(Vec::len).sum::<usize>();
        points(other) > 0
            && points(other) <= points(self)
            && self.pieces.len() == other.pieces.len()
            && self.pieces.iter().zip(&other.pieces).all(|(own, covered)| {
                own.len() == covered.len()
                    && own.iter().zip(covered).all(|(a, b)| distance(*a, *b) < HIDDEN)
            })
    }

    /// Whether nothing of it is seen.
    pub(crate) fn is_empty(&self) -> bool {
        self.pieces.is_empty() && self.beyond.is_empty()
    }

    /// The first and the last point that has a place, from left to right.
    pub(crate) fn ends(&self) -> Option<[(f64, f64); 2]> {
        let first = *self.pieces.first()?.first()?;
        let last = *self.pieces.last()?.last()?;
        Some(if first.0 <= last.0 { [first, last] } else { [last, first] })
    }

    pub(crate) fn draw(&self, canvas: &mut Canvas) {
        let class = match self.covered {
            0 => self.class.clone(),
            times => format!("{} wide{times}", self.class),
        };
        let larger = 1.0 + 0.5 * self.covered as f64;
        canvas.group(&class, |canvas| {
            if self.mark != Mark::Markers {
                let pieces: Vec<_> = self.pieces.iter().map(|piece| thinned(piece)).collect();
                let d: String = pieces.iter().map(|piece| polyline(piece)).collect();
                let ink: f64 = pieces.iter().map(|piece| length(piece)).sum();
                canvas.path(if ink > OSCILLATING { "ln fine" } else { "ln" }, &d);
            }
            let mut last_marked: Option<(f64, f64)> = None;
            for (at, tip) in &self.points {
                let clear = last_marked.is_none_or(|last| distance(last, *at) >= MARKERS_APART);
                let marked =
                    self.mark == Mark::Markers || self.mark == Mark::LineAndMarkers && clear;
                if marked {
                    last_marked = Some(*at);
                    canvas.point("", *at, tip, &self.style.mark(larger));
                } else {
                    canvas.point("", *at, tip, r#"<circle class="hid" r="4"/>"#);
                }
            }
            for (at, tip, turn) in &self.beyond {
                let mark =
                    format!(r#"<path class="off" d="M-4 -9L0 -3L4 -9" transform="{turn}"/>"#);
                canvas.point("", *at, tip, &mark);
            }
        });
    }
}

/// Markers of the rest would be as loud as those of the others.
fn unmarked(mark: Mark) -> Mark {
    if mark == Mark::LineAndMarkers { Mark::Line } else { mark }
}

/// What a point says when pointed at.
pub(crate) fn tip(name: &str, axes: (&Axis, &Axis), point: (f64, f64)) -> String {
    format!("{name}\n{}\n{}", quantity(axes.0, point.0), quantity(axes.1, point.1))
}

/// `step: 0.125 s`
pub(crate) fn quantity(axis: &Axis, value: f64) -> String {
    let text = format!("{}: {} {}", axis.title, significant(value, 4), axis.unit);
    text.trim_end().to_owned()
}

fn pixel_or(place: Place, edge: f64) -> f64 {
    match place {
        Place::At(pixel) => pixel,
        Place::Before | Place::Nowhere => edge,
    }
}

fn far_from_last(points: &[((f64, f64), String)], at: (f64, f64), apart: f64) -> bool {
    points.last().is_none_or(|(last, _)| distance(*last, at) >= apart)
}

fn distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn length(line: &[(f64, f64)]) -> f64 {
    line.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

/// A long line, with the first, lowest, highest and last point of each pixel column: it looks the
/// same and is shorter.
fn thinned(line: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if line.len() < LONG {
        return line.to_vec();
    }
    let mut thin = Vec::new();
    for column in line.chunk_by(|a, b| a.0.floor() == b.0.floor()) {
        let by_height = |&i: &usize, &j: &usize| column[i].1.total_cmp(&column[j].1);
        let mut kept = vec![0, column.len() - 1];
        kept.extend((0..column.len()).min_by(by_height));
        kept.extend((0..column.len()).max_by(by_height));
        kept.sort_unstable();
        kept.dedup();
        thin.extend(kept.into_iter().map(|i| column[i]));
    }
    thin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_run_of_points_that_are_not_finite_is_one_failure() {
        let nan = f64::NAN;
        let points = [(1.0, 1.0), (2.0, nan), (3.0, nan), (4.0, 1.0), (5.0, f64::INFINITY)];
        let series = Series::new("a", points).failed(9.0, "no pivot");
        let failures = series.all_failures();
        assert_eq!(failures.len(), 3);
        assert_eq!(failures[0], (9.0, "no pivot".to_owned()));
        assert_eq!(failures[1], (2.0, "the value is NaN".to_owned()));
    }

    #[test]
    fn a_value_that_no_axis_shows_is_told_with_an_exponent() {
        let failures = Series::new("a", [(1.0, -6e300)]).all_failures();
        assert_eq!(failures, [(1.0, "the value is -6e300".to_owned())]);
    }

    #[test]
    fn a_thinned_line_keeps_its_ends_and_extremes() {
        let line: Vec<(f64, f64)> =
            (0..100_000).map(|i| (f64::from(i) * 0.005, (f64::from(i) * 0.7).sin())).collect();
        let thin = thinned(&line);
        assert!(thin.len() <= 4 * 501);
        assert_eq!((thin.first(), thin.last()), (line.first(), line.last()));
        let highest = |l: &[(f64, f64)]| l.iter().map(|p| p.1).fold(0.0, f64::max);
        assert_eq!(highest(&thin), highest(&line));
    }
}
