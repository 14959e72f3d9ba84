//! A ladder: settings of methods, each with its cost and its error, and the one that is chosen.
//!
//! ```text
//! the choice is the cheapest rung whose error is at most the tolerance
//! ```
//! What meets the tolerance is tinted, the choice is ringed, and the Pareto front of all rungs has its
//! halo. A rung that failed is a cross above its cost, with its setting and its reason.

use crate::axis::{Axis, is_number};
use crate::chart::Drawing;
use crate::error::ChartError;
use crate::frame::Layout;
use crate::lines::{Judgement, Lines};
use crate::series::Series;
use crate::style::Styles;

/// Settings of methods, of which one is to be chosen for a tolerance.
///
/// ```
/// use stationary_chart::{Axis, Chart, Judged, Ladder};
///
/// let ladder = Ladder::new("", Axis::log("work", "evaluations"), Axis::log("error", ""), 1e-3)
///     .rung("euler", "step = 0.5 s", 100.0, Judged::Failed("fell over".into()))
///     .rung("euler", "step = 0.01 s", 5000.0, Judged::Error(4e-2))
///     .rung("rk4", "step = 0.5 s", 400.0, Judged::Error(3e-4))
///     .choose(2);
/// let svg = Chart::from(ladder).file("rk4 at half a second is enough")?;
/// assert!(svg.contains(">chosen: rk4, step = 0.5 s</text>") && svg.contains("step = 0.5 s: fell over"));
/// # Ok::<(), stationary_chart::ChartError>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ladder {
    /// What is seen; may be empty where it is said elsewhere.
    pub title: String,
    /// What a rung costs.
    pub cost: Axis,
    /// How wrong it is.
    pub error: Axis,
    /// The error that may be made.
    pub tolerance: f64,
    /// The settings that were tried.
    pub rungs: Vec<Rung>,
    /// The place of the one that is chosen.
    pub choice: Option<usize>,
}

/// A setting of a method.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rung {
    /// The method.
    pub method: String,
    /// Its step, its tolerance, or whatever tells its rungs apart.
    pub setting: String,
    /// What it costs. Where that is no number on the axis, a failure stands at the start of the axis.
    pub cost: f64,
    /// What came of it.
    pub judged: Judged,
}

/// What came of a rung.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Judged {
    /// Its error.
    Error(f64),
    /// Why it has none.
    Failed(String),
}

impl Ladder {
    /// A ladder without rungs.
    #[must_use]
    pub fn new(title: &str, cost: Axis, error: Axis, tolerance: f64) -> Self {
        Ladder { title: title.into(), cost, error, tolerance, rungs: Vec::new(), choice: None }
    }

    /// Adds a rung; those of one method are joined in the order in which they are added.
    #[must_use]
    pub fn rung(mut self, method: &str, setting: &str, cost: f64, judged: Judged) -> Self {
        self.rungs.push(Rung { method: method.into(), setting: setting.into(), cost, judged });
        self
    }

    /// Chooses the rung at this place, counted from 0.
    #[must_use]
    pub fn choose(mut self, place: usize) -> Self {
        self.choice = Some(place);
        self
    }

    /// The names that have a look of their own: the methods, in order of appearance.
    pub(crate) fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for rung in &self.rungs {
            if !names.contains(&rung.method) {
                names.push(rung.method.clone());
            }
        }
        names
    }

    pub(crate) fn check(&self) -> Result<(), ChartError> {
        let rungs = self.rungs.len();
        if !(self.tolerance > 0.0 && is_number(self.tolerance)) {
            return Err(ChartError::Tolerance(self.tolerance));
        }
        match self.choice.filter(|&place| place >= rungs) {
            Some(place) => Err(ChartError::Choice { place, rungs }),
            None => Ok(()),
        }
    }

    pub(crate) fn draw(&self, layout: Layout, styles: &Styles) -> Drawing {
        let choice = self.choice.and_then(|place| self.rungs.get(place)).and_then(chosen);
        let judgement = Judgement { tolerance: Some(self.tolerance), choice };
        self.lines().draw_judged(layout, styles, &judgement)
    }

    /// A series a method.
    fn lines(&self) -> Lines {
        let lines = Lines::new(&self.title, self.cost.clone(), self.error.clone()).mark_front();
        self.names().iter().fold(lines, |lines, name| lines.with(self.series(name)))
    }

    fn series(&self, method: &str) -> Series {
        let own = || self.rungs.iter().filter(|rung| rung.method == method);
        let judged = own().filter_map(|rung| match rung.judged {
            Judged::Error(error) => Some(((rung.cost, error), rung.setting.clone())),
            Judged::Failed(_) => None,
        });
        let (points, notes): (Vec<(f64, f64)>, Vec<String>) = judged.unzip();
        let failures = own().filter_map(|rung| match &rung.judged {
            Judged::Failed(why) => Some((rung.cost, format!("{}: {why}", rung.setting))),
            Judged::Error(_) => None,
        });
        failures
            .fold(Series::new(method, points).noted(notes), |s, (cost, why)| s.failed(cost, why))
    }
}

/// Where the choice is, and what it says; a choice that failed has no place.
fn chosen(rung: &Rung) -> Option<((f64, f64), String)> {
    match rung.judged {
        Judged::Error(error) => {
            Some(((rung.cost, error), format!("{}, {}", rung.method, rung.setting)))
        }
        Judged::Failed(_) => None,
    }
}
