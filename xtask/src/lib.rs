//! The project's tools, run as `cargo xtask <task>`: what is measured, what is allowed, what it costs.
//!
//! - [`report`]: runs the studies and writes the page that shows them; [`studies`] is a folder a crate.
//! - [`sweep`]: runs the family of a scene, one table and one chart.
//! - [`choosing`]: random questions to `choose`, judged by the scene's own motion.
//!
//! The checks of the house, in a folder of their own:
//! - [`check_page`]: opens pages in a browser and complains about what a reader would.
//! - [`layers`]: which crate may depend on what.
//! - [`readme`]: the README of each crate from its front page.
//! - [`mentions`]: the studies of a crate on its page of the docs.
//! - [`licenses`]: what the dependencies ask of whoever uses the crates.
//! - [`cost`]: how many packages each crate pulls in, and how long it takes to build.
//! - [`kernels`]: what the hot kernels take as Cargo's own release profile builds them.
//! - [`cargo`]: how these ask cargo.
//!
//! A study is a [`study::Study`]: a table, its [charts](stationary_chart) and its claims; the list of them is
//! [`studies::STUDIES`]. All but that list knows nothing of physics.

#![allow(clippy::missing_errors_doc, reason = "an unpublished tool: its errors end in a message")]

pub mod choosing;
pub mod report;
pub mod studies;
pub mod study;
pub mod sweep;

mod house;
mod timing;

pub use house::{cargo, check_page, cost, kernels, layers, licenses, mentions, readme};
pub use timing::{Wall, median_wall};
