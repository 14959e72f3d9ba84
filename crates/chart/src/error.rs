//! What a chart cannot show.

use std::error::Error;
use std::fmt;

use crate::axis::Scale;

/// A chart that says what no drawing can show. Numbers that are not finite are no such case: they are
/// failures, and are drawn as crosses or as gaps.
#[derive(Clone, Debug, PartialEq)]
pub enum ChartError {
    /// A kind of chart needs an axis of equal differences, and the axis is logarithmic.
    Logarithmic {
        /// The kind of chart.
        chart: &'static str,
        /// The title of the axis.
        axis: String,
    },
    /// A power law is straight on two logarithmic axes and a constant slope on two linear ones; on one
    /// of each neither is.
    Slope {
        /// The slope.
        slope: f64,
        /// The horizontal axis.
        x: Scale,
        /// The vertical axis.
        y: Scale,
    },
    /// A cell of a map has no place on its axes.
    Cell {
        /// Its place along x.
        x: f64,
        /// Its place along y.
        y: f64,
    },
    /// A cell of a map has an outcome that is not in the list.
    Outcome {
        /// The place in the list.
        place: usize,
        /// How long the list is.
        outcomes: usize,
    },
    /// A step of a portrait begins or ends where there is no place.
    Step {
        /// The method.
        name: String,
        /// Where it begins.
        from: (f64, f64),
        /// Where it ends.
        to: (f64, f64),
    },
    /// A series of bars has more or fewer values than there are categories.
    Categories {
        /// The series.
        name: String,
        /// How many values it has.
        values: usize,
        /// How many categories there are.
        categories: usize,
    },
    /// The tolerance of a ladder is not a positive number.
    Tolerance(f64),
    /// The choice of a ladder is not among its rungs.
    Choice {
        /// The place of the choice.
        place: usize,
        /// How many rungs there are.
        rungs: usize,
    },
}

impl fmt::Display for ChartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChartError::Logarithmic { chart, axis } => {
                write!(f, "{chart} need linear axes, and `{axis}` is logarithmic")
            }
            ChartError::Slope { slope, x, y } => {
                write!(f, "a slope of {slope} is no line on axes of which x is {x} and y is {y}")
            }
            ChartError::Cell { x, y } => {
                write!(f, "the cell at x = {x}, y = {y} has no place on the axes of its map")
            }
            ChartError::Outcome { place, outcomes } => {
                write!(f, "a cell has outcome {place}, and {outcomes} outcomes are listed")
            }
            ChartError::Step { name, from, to } => {
                write!(f, "the step of {name} from {from:?} to {to:?} has no place")
            }
            ChartError::Categories { name, values, categories } => {
                write!(f, "{name} has {values} values for {categories} categories")
            }
            ChartError::Tolerance(tolerance) => {
                write!(f, "the tolerance is {tolerance}, and must be a positive number")
            }
            ChartError::Choice { place, rungs } => {
                write!(f, "the choice is rung {place} of {rungs}, counted from 0")
            }
        }
    }
}

impl Error for ChartError {}
