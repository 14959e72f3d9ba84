//! Curves and points over two axes, with reference slopes, failures and the Pareto front.

mod failures;
mod names;

use crate::axis::{Axis, FARTHEST, Ruler, Scale, is_number};
use crate::canvas::{Anchor, Canvas};
use crate::chart::Drawing;
use crate::error::ChartError;
use crate::frame::{Aspect, Frame, Layout, LegendEntry, Plan, Swatch, draw_legend, draw_words};
use crate::label::{Label, TEXT, significant, text_width};
use crate::pareto::pareto;
use crate::path::polyline;
use crate::place::{Crowd, Rect};
use crate::series::{Mark, Series, Trace, Weight};
use crate::style::Styles;

use failures::Failures;
pub(crate) use failures::ROW;
pub(crate) use names::draw_along;
use names::{COLUMN, End, GAP, draw_direct_labels};

/// Curves and points over two axes.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lines {
    /// What is seen; may be empty where the study's title says it.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The measured series.
    pub series: Vec<Series>,
    /// What theory predicts.
    pub guides: Vec<Guide>,
    /// Whether the Pareto front is marked.
    pub front: Front,
}

/// A thin dashed line that shows a prediction.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Guide {
    /// `y` grows as `x` to a power (on logarithmic axes), or with a constant slope (on linear ones).
    /// Left out where the point has no place.
    Slope {
        /// The power, or the slope.
        slope: f64,
        /// A point on the line.
        through: (f64, f64),
        /// What it says.
        label: String,
    },
    /// A curve through points; those without a place are left out.
    Curve {
        /// The points.
        points: Vec<(f64, f64)>,
        /// What it says.
        label: String,
    },
}

/// Whether the Pareto front is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Front {
    /// The chart is not a choice between methods.
    Unmarked,
    /// A halo joins the points of all series that no point beats on x and y.
    Marked,
}

impl Lines {
    /// An empty chart.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        let (series, guides) = (Vec::new(), Vec::new());
        Lines { title: title.into(), x, y, series, guides, front: Front::Unmarked }
    }

    /// Adds a series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a reference slope with the label `slope 2`.
    #[must_use]
    pub fn slope(mut self, slope: f64, through: (f64, f64)) -> Self {
        self.guides.push(Guide::Slope {
            slope,
            through,
            label: format!("slope {slope}").replace('-', "−"),
        });
        self
    }

    /// Adds a predicted curve.
    #[must_use]
    pub fn curve(mut self, label: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.guides
            .push(Guide::Curve { points: points.into_iter().collect(), label: label.into() });
        self
    }

    /// Marks the Pareto front of all series.
    #[must_use]
    pub fn mark_front(mut self) -> Self {
        self.front = Front::Marked;
        self
    }

    /// The points on the Pareto front, by increasing x, each with the name of its series.
    pub(crate) fn front_points(&self) -> Vec<(&str, (f64, f64))> {
        let named: Vec<(&str, (f64, f64))> = self
            .series
            .iter()
            .flat_map(|s| s.shown(self.x.scale, self.y.scale).map(|p| (s.name.as_str(), p)))
            .collect();
        let points: Vec<(f64, f64)> = named.iter().map(|(_, point)| *point).collect();
        pareto(&points).into_iter().map(|i| named[i]).collect()
    }

    /// The names that have a look of their own.
    pub(crate) fn names(&self) -> Vec<String> {
        self.named().map(|series| series.name.clone()).collect()
    }

    fn named(&self) -> impl Iterator<Item = &Series> {
        self.series.iter().filter(|series| series.weight == Weight::Full)
    }

    fn has_rest(&self) -> bool {
        self.series.iter().any(|series| series.weight == Weight::Rest)
    }

    pub(crate) fn check(&self) -> Result<(), ChartError> {
        for guide in &self.guides {
            if let Guide::Slope { slope, .. } = *guide
                && (self.x.scale != self.y.scale || !slope.is_finite())
            {
                return Err(ChartError::Slope { slope, x: self.x.scale, y: self.y.scale });
            }
        }
        Ok(())
    }

    pub(crate) fn draw(&self, layout: Layout, styles: &Styles) -> Drawing {
        self.draw_judged(layout, styles, &Judgement::default())
    }

    /// Draws with a tolerance and a choice over it.
    pub(crate) fn draw_judged(
        &self,
        layout: Layout,
        styles: &Styles,
        judgement: &Judgement,
    ) -> Drawing {
        let labels = self.labels(layout);
        let mut canvas = Canvas::new(layout.width(), 1.0);
        let plan = Plan {
            layout,
            title: &self.title,
            axes: (&self.x, &self.y),
            x: self.extent(self.x.scale, |(x, _)| x, self.failed_at()),
            y: self.extent(self.y.scale, |(_, y)| y, judgement.tolerance.into_iter().collect()),
            categories: &[],
            right: labels.room(),
            aspect: Aspect::Free,
        };
        let frame = Frame::draw(&mut canvas, plan, |x| Failures::of(self, x).lane());
        judgement.draw_region(&mut canvas, &frame);
        let mut traces: Vec<Trace> = self
            .series
            .iter()
            .map(|s| Trace::of(s, (&self.x, &self.y), &frame, styles.of(&s.name)))
            .collect();
        Trace::widen_what_is_covered(&mut traces);
        let mut crowd = Crowd::default();
        traces.iter().flat_map(|t| &t.pieces).for_each(|piece| crowd.add_polyline(piece));

        judgement.keep_clear(&mut crowd, &frame);
        let front = self.draw_front(&mut canvas, &frame);
        let guides = self.draw_guides(&mut canvas, &frame);
        guides.iter().for_each(|(_, path)| crowd.add_polyline(path));
        // What is thin and grey covers nothing.
        for weight in [Weight::Rest, Weight::Full] {
            let of_weight = self.series.iter().zip(&traces).filter(|(s, _)| s.weight == weight);
            of_weight.for_each(|(_, trace)| trace.draw(&mut canvas));
        }
        let failures = Failures::of(self, &frame.x);
        failures.draw(&mut canvas, self, &frame, styles);

        let below = match labels {
            Labels::Direct { .. } => {
                let ends = self.label_ends(&traces, &failures, &frame);
                draw_direct_labels(&mut canvas, &mut crowd, &frame, &ends);
                frame.below
            }
            Labels::Legend => self.draw_legend(&mut canvas, &frame, layout, styles),
        };
        // A prediction may be named right of the plot, in the column that is kept for names.
        let page = Rect { right: layout.width(), ..frame.data };
        for (text, path) in guides
            .iter()
            .map(|(t, p)| (t.as_str(), p))
            .chain(front.iter().map(|path| ("Pareto front", path)))
        {
            draw_along(&mut canvas, &mut crowd, &page, text, path);
        }
        let below = judgement.draw_choice(&mut canvas, &mut crowd, &frame, (below, layout.width()));
        if traces.iter().all(Trace::is_empty) && guides.iter().all(|(_, path)| path.is_empty()) {
            let middle = |a: f64, b: f64| 0.5 * (a + b);
            let at = (
                middle(frame.data.left, frame.data.right),
                middle(frame.data.top, frame.data.bottom),
            );
            canvas.label("muted", at, Anchor::Middle, &Label::plain("no data"));
        }
        Drawing { canvas, height: below }
    }

    fn labels(&self, layout: Layout) -> Labels {
        let widest = self.named().map(|s| text_width(&s.name, TEXT)).fold(0.0, f64::max);
        let fits = widest <= 190.0
            && self.named().count() as f64 * GAP <= layout.plot_height()
            && !self.has_rest();
        match layout {
            Layout::Wide if fits => Labels::Direct { room: widest + COLUMN + 4.0 },
            Layout::Wide | Layout::Narrow => Labels::Legend,
        }
    }

    fn extent(&self, scale: Scale, of: impl Fn((f64, f64)) -> f64, more: Vec<f64>) -> Ruler {
        // Zero and less on the other axis is drawn at its edge, and needs a place on this one.
        let drawn = |p: &(f64, f64)| is_number(p.0) && is_number(p.1);
        let points = self.series.iter().flat_map(|s| s.points.iter().copied().filter(drawn));
        Ruler::covering(scale, points.map(of).chain(more), 0.045, (0.0, 1.0))
    }

    fn failed_at(&self) -> Vec<f64> {
        self.series.iter().flat_map(Series::all_failures).map(|(x, _)| x).collect()
    }

    fn draw_front(&self, canvas: &mut Canvas, frame: &Frame) -> Option<Vec<(f64, f64)>> {
        if self.front == Front::Unmarked {
            return None;
        }
        let points = self.front_points().into_iter();
        let path: Vec<(f64, f64)> =
            points.filter_map(|(_, (x, y))| Some((frame.x.at(x)?, frame.y.at(y)?))).collect();
        // A front of one point is a dot: the round cap of a line without length.
        let drawn = if let [only] = path[..] { vec![only, only] } else { path.clone() };
        canvas.path("front", &polyline(&drawn));
        (!path.is_empty()).then_some(path)
    }

    fn draw_guides(&self, canvas: &mut Canvas, frame: &Frame) -> Vec<(String, Vec<(f64, f64)>)> {
        let mut drawn = Vec::new();
        for guide in &self.guides {
            let (label, path) = match guide {
                Guide::Slope { slope, through, label } => {
                    (label, slope_path(frame, *slope, *through))
                }
                Guide::Curve { points, label } => {
                    let at = |&(x, y): &(f64, f64)| Some((frame.x.at(x)?, frame.y.at(y)?));
                    (label, points.iter().filter_map(at).collect())
                }
            };
            let visible: Vec<[(f64, f64); 2]> =
                path.windows(2).filter_map(|p| frame.data.clip(p[0], p[1])).collect();
            canvas.path("guide", &visible.iter().map(|s| polyline(s)).collect::<String>());
            drawn.push((label.clone(), visible.into_iter().flatten().collect()));
        }
        drawn
    }

    /// Where the label of each series wants to be: at its end, or at its last failure.
    fn label_ends(&self, traces: &[Trace], failures: &Failures, frame: &Frame) -> Vec<End> {
        let named = self.series.iter().zip(traces).enumerate();
        named
            .filter_map(|(i, (series, trace))| {
                let failure = || failures.last_of(i, frame).map(|at| [at, at]);
                let [start, end] = trace.ends().or_else(failure)?;
                Some(End { name: series.name.clone(), class: trace.class.clone(), start, end })
            })
            .collect()
    }

    fn draw_legend(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        layout: Layout,
        styles: &Styles,
    ) -> f64 {
        let rest = self.has_rest().then(|| LegendEntry {
            class: "rest".to_owned(),
            text: "the others".to_owned(),
            swatch: Swatch::Line(None),
        });
        let entries: Vec<LegendEntry> = self
            .named()
            .map(|series| LegendEntry {
                class: styles.of(&series.name).class(),
                text: series.name.clone(),
                swatch: match series.mark {
                    Mark::Line => Swatch::Line(None),
                    Mark::Markers | Mark::LineAndMarkers => {
                        Swatch::Line(Some(styles.of(&series.name)))
                    }
                },
            })
            .chain(rest)
            .collect();
        draw_legend(canvas, &entries, frame.below, layout.width())
    }
}

/// What a ladder adds: an error that may be made, and the point that was chosen for it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Judgement {
    pub(crate) tolerance: Option<f64>,
    pub(crate) choice: Option<((f64, f64), String)>,
}

impl Judgement {
    /// What meets the tolerance, down to the axis.
    fn draw_region(&self, canvas: &mut Canvas, frame: &Frame) {
        let Some(y) = self.tolerance.and_then(|tolerance| frame.y.at(tolerance)) else { return };
        let Rect { left, right, bottom, .. } = frame.plot;
        canvas.rect("meets", left, y, right - left, (bottom - y).max(0.0));
        canvas.line("guide", (left, y), (right, y));
    }

    /// Names stand beside the ring.
    fn keep_clear(&self, crowd: &mut Crowd, frame: &Frame) {
        let Some(((x, y), _)) = self.choice else { return };
        if let (Some(x), Some(y)) = (frame.x.at(x), frame.y.at(y)) {
            crowd.add_label(Rect::around((x, y), 24.0, 24.0));
        }
    }

    /// Names the tolerance at its line and rings the choice, whose words stand from `below` on; says
    /// where they end.
    fn draw_choice(
        &self,
        canvas: &mut Canvas,
        crowd: &mut Crowd,
        frame: &Frame,
        (below, width): (f64, f64),
    ) -> f64 {
        if let Some((tolerance, y)) = self.tolerance.and_then(|t| Some((t, frame.y.at(t)?))) {
            let path = [(frame.plot.left, y), (frame.plot.right, y)];
            let text = format!("meets {} below", significant(tolerance, 3));
            draw_along(canvas, crowd, &frame.data, &text, &path);
        }
        let Some(((x, y), words)) = &self.choice else { return below };
        let (Some(x), Some(y)) = (frame.x.at(*x), frame.y.at(*y)) else { return below };
        canvas.circle("choice", (x, y), 9.0);
        canvas.circle("choice", (13.0, below + 9.5), 7.0);
        draw_words(canvas, &format!("chosen: {words}"), (32.0, below + 14.0), width) + 10.0
    }
}

/// How the series are named.
enum Labels {
    /// At their ends.
    Direct {
        /// Room right of the plot.
        room: f64,
    },
    /// In rows below the chart.
    Legend,
}

impl Labels {
    fn room(&self) -> f64 {
        match self {
            Labels::Direct { room } => *room,
            Labels::Legend => 14.0,
        }
    }
}

/// The straight line of a slope, from one side of the plot to the other.
fn slope_path(frame: &Frame, slope: f64, through: (f64, f64)) -> Vec<(f64, f64)> {
    let (Some(x), Some(y)) = (frame.x.beyond_start(through.0), frame.y.beyond_start(through.1))
    else {
        return Vec::new();
    };
    // As the axes measure, not in pixels: the point may be very many of them away.
    let at = |along: f64, side: f64| {
        let height = frame.y.density() * (y + slope * (along - x));
        (side, frame.y.start() - height.clamp(-FARTHEST, FARTHEST))
    };
    let ends = vec![at(0.0, frame.plot.left), at(frame.x.extent(), frame.plot.right)];
    if ends.iter().any(|end| end.1.is_nan()) { Vec::new() } else { ends }
}
