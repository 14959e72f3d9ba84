//! A phase portrait: a vector field, curves, and steps from a point, on axes of equal scale.

use crate::axis::{Axis, Ruler, Scale, is_number};
use crate::canvas::{Anchor, Canvas};
use crate::chart::Drawing;
use crate::error::ChartError;
use crate::frame::{Aspect, Frame, Layout, LegendEntry, Plan, Swatch, draw_legend};
use crate::label::{Label, TEXT, text_width};
use crate::place::{Crowd, Rect};
use crate::series::{Series, Trace, tip};
use crate::stroke::arrow;
use crate::style::Styles;

/// A vector field with curves and steps, on axes of equal scale. Both axes are linear; arrows of the field
/// that are not finite are left out, curves have gaps there.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Portrait {
    /// What is seen; may be empty where the study's title says it.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Arrows: where, and the vector there. Their lengths are relative to the longest.
    pub field: Vec<((f64, f64), (f64, f64))>,
    /// Curves in the plane.
    pub curves: Vec<Series>,
    /// Steps of methods.
    pub steps: Vec<StepArrow>,
}

/// One step of a method, as an arrow.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepArrow {
    /// The method, as every other chart spells it.
    pub name: String,
    /// Where the step begins.
    pub from: (f64, f64),
    /// Where it ends.
    pub to: (f64, f64),
}

impl Portrait {
    /// An empty portrait.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        let (field, curves, steps) = (Vec::new(), Vec::new(), Vec::new());
        Portrait { title: title.into(), x, y, field, curves, steps }
    }

    /// Adds the arrows of a vector field.
    #[must_use]
    pub fn field(mut self, arrows: impl IntoIterator<Item = ((f64, f64), (f64, f64))>) -> Self {
        self.field.extend(arrows);
        self
    }

    /// Adds a curve.
    #[must_use]
    pub fn curve(mut self, curve: Series) -> Self {
        self.curves.push(curve);
        self
    }

    /// Adds a method's step.
    #[must_use]
    pub fn step(mut self, name: &str, from: (f64, f64), to: (f64, f64)) -> Self {
        self.steps.push(StepArrow { name: name.into(), from, to });
        self
    }

    /// The names that have a look of their own.
    pub(crate) fn names(&self) -> Vec<String> {
        let curves = self.curves.iter().map(|curve| curve.name.clone());
        curves.chain(self.steps.iter().map(|step| step.name.clone())).collect()
    }

    pub(crate) fn check(&self) -> Result<(), ChartError> {
        if let Some(axis) = [&self.x, &self.y].into_iter().find(|a| a.scale == Scale::Log) {
            return Err(ChartError::Logarithmic { chart: "portraits", axis: axis.title.clone() });
        }
        let placed = |(x, y): (f64, f64)| is_number(x) && is_number(y);
        match self.steps.iter().find(|step| !(placed(step.from) && placed(step.to))) {
            Some(StepArrow { name, from, to }) => {
                Err(ChartError::Step { name: name.clone(), from: *from, to: *to })
            }
            None => Ok(()),
        }
    }

    pub(crate) fn draw(&self, layout: Layout, styles: &Styles) -> Drawing {
        let mut canvas = Canvas::new(layout.width(), 1.0);
        let frame = Frame::draw(&mut canvas, self.plan(layout), |_| 0.0);
        self.draw_field(&mut canvas, &frame);
        let mut crowd = Crowd::default();
        let mut names: Vec<Name> = Vec::new();
        let trace =
            |curve: &Series| Trace::of(curve, (&self.x, &self.y), &frame, styles.of(&curve.name));
        let mut traces: Vec<Trace> = self.curves.iter().map(trace).collect();
        Trace::widen_what_is_covered(&mut traces);
        for (curve, trace) in self.curves.iter().zip(traces) {
            let style = styles.of(&curve.name);
            trace.draw(&mut canvas);
            trace.pieces.iter().for_each(|piece| crowd.add_polyline(piece));
            let path: Vec<(f64, f64)> = trace.pieces.into_iter().flatten().collect();
            names.push(Name { text: curve.name.clone(), class: style.class(), path });
        }
        for step in &self.steps {
            let at = |(x, y)| Some((frame.x.at(x)?, frame.y.at(y)?));
            let (Some(from), Some(to)) = (at(step.from), at(step.to)) else { continue };
            let class = styles.of(&step.name).class();
            canvas.group(&class, |canvas| canvas.path("step", &arrow(from, to)));
            let tip = tip(&step.name, (&self.x, &self.y), step.to);
            canvas.point(&class, to, &tip, r#"<circle class="hid" r="4"/>"#);
            canvas.point("", from, "start", r#"<circle class="from" r="3.5"/>"#);
            crowd.add_polyline(&[from, to]);
            names.push(Name { text: step.name.clone(), class, path: vec![to] });
        }
        let spots = match layout {
            Layout::Wide => spots(&mut crowd, &frame.plot, &names, layout.width()),
            // A phone's plot is too small to be written into.
            Layout::Narrow => None,
        };
        let below = match spots {
            Some(spots) => {
                names.iter().zip(spots).for_each(|(name, spot)| draw_name(&mut canvas, name, spot));
                frame.below
            }
            None => self.draw_legend(&mut canvas, &names, &frame, layout),
        };
        Drawing { canvas, height: below }
    }

    fn plan(&self, layout: Layout) -> Plan<'_> {
        let shown = || {
            let field = self.field.iter().map(|(at, _)| *at);
            let curves = self.curves.iter().flat_map(|c| c.shown(Scale::Linear, Scale::Linear));
            let steps = self.steps.iter().flat_map(|s| [s.from, s.to]);
            field.chain(curves).chain(steps)
        };
        let x = Ruler::covering(Scale::Linear, shown().map(|p| p.0), 0.06, (0.0, 1.0));
        let y = Ruler::covering(Scale::Linear, shown().map(|p| p.1), 0.06, (0.0, 1.0));
        let axes = (&self.x, &self.y);
        let (categories, right) = (&[][..], 14.0);
        Plan { layout, title: &self.title, axes, x, y, categories, right, aspect: Aspect::Equal }
    }

    fn draw_field(&self, canvas: &mut Canvas, frame: &Frame) {
        let longest = self.field.iter().map(|(_, v)| v.0.hypot(v.1)).filter(|l| l.is_finite());
        let longest = longest.fold(0.0, f64::max);
        if longest <= 0.0 {
            return;
        }
        let area = (frame.plot.right - frame.plot.left) * (frame.plot.bottom - frame.plot.top);
        let spacing = (area / self.field.len() as f64).sqrt();
        let scale = 0.82 * spacing / longest;
        let mut d = String::new();
        for &(at, (u, v)) in &self.field {
            let (Some(x), Some(y)) = (frame.x.at(at.0), frame.y.at(at.1)) else { continue };
            let (dx, dy) = (scale * u, -scale * v);
            if dx.hypot(dy) > 2.0 {
                d += &arrow((x - 0.5 * dx, y - 0.5 * dy), (x + 0.5 * dx, y + 0.5 * dy));
            }
        }
        canvas.path("field", &d);
    }

    fn draw_legend(
        &self,
        canvas: &mut Canvas,
        names: &[Name],
        frame: &Frame,
        layout: Layout,
    ) -> f64 {
        let is_step = |name: &Name| self.steps.iter().any(|step| step.name == name.text);
        let entries: Vec<LegendEntry> = names
            .iter()
            .map(|name| LegendEntry {
                class: name.class.clone(),
                text: name.text.clone(),
                swatch: if is_step(name) { Swatch::Arrow } else { Swatch::Line(None) },
            })
            .collect();
        draw_legend(canvas, &entries, frame.below, layout.width())
    }
}

/// A name and the path that it names.
struct Name {
    text: String,
    class: String,
    path: Vec<(f64, f64)>,
}

/// A free spot beside each path, possibly right of the plot; `None` where one finds none, because
/// names that are half beside their paths and half in a legend are hard to read.
fn spots(crowd: &mut Crowd, plot: &Rect, names: &[Name], width: f64) -> Option<Vec<Rect>> {
    let page = Rect { right: width, ..*plot };
    let mut spots = Vec::new();
    for name in names {
        let width = text_width(&name.text, TEXT);
        let half = 0.5 * width;
        let beside = name.path.iter().flat_map(|&(x, y)| {
            let sides = [
                (half + 9.0, 0.0),
                (half + 7.0, 11.0),
                (half + 7.0, -11.0),
                (0.0, 15.0),
                (0.0, -15.0),
                (-half - 7.0, 11.0),
                (-half - 7.0, -11.0),
                (-half - 9.0, 0.0),
            ];
            sides.map(|(dx, dy)| Rect::around((x + dx, y + dy), width, 16.0))
        });
        let spot = crowd.free(beside, &page)?;
        crowd.add_label(spot);
        spots.push(spot);
    }
    Some(spots)
}

fn draw_name(canvas: &mut Canvas, name: &Name, spot: Rect) {
    let at = (spot.left, spot.bottom - 4.0);
    canvas.group(&name.class, |canvas| {
        canvas.label("name over", at, Anchor::Start, &Label::plain(name.text.clone()));
    });
}
