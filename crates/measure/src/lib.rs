//! How is a method measured? Tables that another processor prints alike, slopes, and seeded numbers.
//!
//! ```text
//! 1.2e-3, <1e-12                     what of a number can be reproduced, and rounding by its name
//! y ~ C x^k                          the order k of a method, by the slope of its errors
//! state <- state + constant          numbers that are the same in every run
//! ```
//! `x` a step or the size of a mesh, `y` an error, `C` a constant of the method, `k` its order.
//!
//! ```
//! use stationary_measure::{Column, Table, loglog_slope};
//!
//! let errors = [(0.1, 1.02e-2), (0.05, 2.51e-3), (0.025, 6.26e-4)];
//! assert!((loglog_slope(&errors).unwrap() - 2.0).abs() < 0.02);
//!
//! let mut table = Table::new([Column::exact("step"), Column::rounded("error", 2, 1e-14)]);
//! errors.iter().for_each(|&(step, error)| table.push([step.into(), error.into()]));
//! assert_eq!(table.to_string().lines().last(), Some("0.025  6.3e-4"));
//! ```
//!
//! Reading order: [`Table`], [`loglog_slope`] and [`truncation_regime`], [`SplitMix64`]. The crate depends on
//! nothing, knows no physics and opens no file; snapshot tests, studies and charts stand on it.

mod table;
mod slope;
mod random;

pub use random::SplitMix64;
pub use slope::{loglog_slope, truncation_regime};
pub use table::{Cell, Column, Precision, Table};
