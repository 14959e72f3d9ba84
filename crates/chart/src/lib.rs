//! How is a measurement shown so that nobody is misled? Charts as SVG, from numbers to text.
//!
//! ```text
//! Lines      curves and points over two axes, reference slopes, the Pareto front
//! Ladder     settings of methods: cost against error, a tolerance, and the cheapest that meets it
//! Map        what becomes of a run, in a plane of two parameters, with predicted borders
//! Bars       numbers of categories
//! Portrait   a vector field with curves and steps, on axes of equal scale
//! Canvas     lines, dots and words of one's own, in the same palette and type
//! ```
//!
//! Two methods at four steps; the second fails at the largest:
//!
//! ```
//! use stationary_chart::{Axis, Chart, Lines, Series};
//!
//! let verlet = [(0.1, 2.1e-4), (0.2, 8.5e-4), (0.4, 3.4e-3), (0.8, 1.4e-2)];
//! let euler = [(0.1, 0.03), (0.2, 0.07), (0.4, 0.19)];
//! let chart: Chart = Lines::new("A pendulum", Axis::log("step", "s"), Axis::log("error", "rad"))
//!     .with(Series::new("verlet", verlet))
//!     .with(Series::new("euler", euler).failed(0.8, "over the top at t = 3 s"))
//!     .slope(2.0, (0.2, 2e-3))
//!     .into();
//! let svg = chart.file("Verlet's error falls with the square of the step.")?;
//! assert!(svg.contains("euler failed\nstep: 0.8 s\nover the top at t = 3 s"));
//! # Ok::<(), stationary_chart::ChartError>(())
//! ```
//!
//! - **A failure stays on the chart.** A run without a number is a cross at the top, with its reason;
//!   so is a point that is NaN or infinite. On a logarithmic axis zero and less are an arrow at the
//!   edge, and a line has a gap there. A chart without a single number says so. What no drawing can
//!   show, such as a slope on mixed axes, is a [`ChartError`].
//! - **Whatever renders it.** Every colour has a plain value, and a variable for pages: light, dark, and
//!   in print. Programs without style variables (resvg, librsvg) show the plain values. Names have a
//!   marker and a dash as well, for those who see fewer hues.
//! - **A name looks the same on every chart**: [`Styles`] are assigned once for a page. Each point says
//!   its numbers with units when pointed at, and every text is escaped.
//! - A chart is drawn for a desk or for a phone ([`Layout`]), with text of the same size.
//!
//! Reading order: [`Chart`] and where it stands ([`Medium`]); [`Axis`] and [`Series`]; [`Lines`],
//! [`Ladder`], [`Map`], [`Bars`], [`Portrait`]; [`pareto`] fronts; [`Styles`]; the [`Canvas`] beneath, its
//! [`Path`]s and [`Tone`]s; the [`sheet`] of a page.
//!
//! The crate knows nothing of physics or files: a chart goes in, a string comes out.

mod chart;
mod error;
mod axis;
mod series;
mod lines;
mod pareto;
mod ladder;
mod map;
mod bars;
mod portrait;
mod frame;
mod place;
mod label;
mod style;
mod stroke;
mod canvas;
mod path;
mod palette;

pub use axis::{Axis, Scale};
pub use bars::{BarSeries, Bars};
pub use canvas::{Anchor, Canvas, Lettering, escaped};
pub use chart::{Chart, Medium};
pub use error::ChartError;
pub use frame::Layout;
pub use label::significant;
pub use ladder::{Judged, Ladder, Rung};
pub use lines::{Front, Guide, Lines};
pub use map::{Border, Map};
pub use palette::{HUES, Tone, sheet, variables};
pub use pareto::pareto;
pub use path::Path;
pub use portrait::{Portrait, StepArrow};
pub use series::{Mark, Series, Weight};
pub use style::{Style, Styles};

#[cfg(test)]
mod tests;
