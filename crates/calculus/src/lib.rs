//! Vectors and covectors, differentials and Hessians.

mod error;
mod fit;
mod hessian_solver;
mod metric;
mod newton;
mod potential;
mod sink;
mod stencil;
mod system;
mod table;
mod vectors;

pub use error::{MetricError, SizeError};
pub use fit::loglog_slope;
pub use hessian_solver::{DenseSolver, HessianSolver, Rung};
pub use metric::{DenseMetric, DiagonalMetric, Metric};
pub use newton::{
    Equation, Newton, NewtonError, NewtonFailure, NewtonMemory, NewtonReport, Unsolvable,
};
pub use potential::Potential;
pub use sink::{DenseSink, FIXED, ProductSink, Sink};
pub use stencil::{Curvature, Stencil, StencilHessian, Stencils, UnknownVertex};
pub use system::{Flat, Space, System};
pub use table::{Cell, Column, Precision, Table};
pub use vectors::{Covector, Storage, Vector, first_non_finite};
