//! Vectors and covectors, differentials and Hessians.

mod angle;
mod automatic;
mod basis;
mod check;
mod dense_lu;
mod differential;
mod eigen;
mod equilibrium;
mod error;
mod fit;
mod function_equation;
mod hessian_solver;
mod least_norm;
mod metric;
mod newton;
mod newton_study;
mod potential;
mod random;
mod semidefinite;
mod sink;
#[cfg(feature = "sparse")]
mod sparse;
mod stencil;
mod system;
mod table;
mod vectors;
mod worked;

pub use angle::{angle, signed_angle};
pub use automatic::{Automatic, AutomaticStencil, Energy, StencilEnergy};
pub use basis::{
    BasisError, BilinearForm, ChangeOfBasis, ContravariantTensor, LinearTransformation,
};
pub use check::{
    Agreement, Derivative, DerivativeCheck, DerivativeError, Difference, Differences, Report,
    WrongEntry, assert_derivatives, assert_derivatives_on, assert_jacobian, check_jacobian,
    check_potential, check_potential_on, differences,
};
pub use differential::{
    Number, differential, directional_derivative, gradient, hessian, jacobian, jacobian_of_matrix,
    second_differential,
};
pub use eigen::{EigenError, Eigenpairs};
pub use equilibrium::{Equilibrium, EquilibriumReport};
pub use error::{MetricError, SizeError};
pub use fit::{loglog_slope, truncation_regime};
pub use function_equation::FunctionEquation;
pub use hessian_solver::{DenseSolver, HessianSolver, Rung};
pub use least_norm::{LeastNorm, LeastNormError, least_norm};
pub use metric::{DenseMetric, DiagonalMetric, Metric};
pub use newton::{
    Equation, Merit, Newton, NewtonEnd, NewtonError, NewtonFailure, NewtonMemory, NewtonReport,
    Unsolvable,
};
pub use newton_study::{newton_against_initial_guesses, newton_against_wrong_derivatives};
pub use potential::Potential;
pub use random::SplitMix64;
pub use semidefinite::project_semidefinite;
pub use sink::{DenseSink, FIXED, ProductSink, Sink};
#[cfg(feature = "sparse")]
pub use sparse::{
    ConjugateGradient, ConjugateGradientReport, JacobianEntries, Ladder, PatternSink, Pivoting,
    RefillSink, Refined, SparseCholesky, SparseEquation, SparseError, SparseIndefinite,
    SparseJacobian, SparseMetric, SparseSolver, SymmetricMatrix,
};
pub use stencil::{Curvature, Stencil, StencilHessian, Stencils, UnknownVertex};
pub use system::{Flat, Space, System};
pub use table::{Cell, Column, Precision, Table};
pub use vectors::{Covector, Storage, Vector, first_non_finite};
pub use worked::{
    cross_differential, cross_matrix, dot_differential, hat, hat_differential,
    inverse_differential, norm, norm_differential,
};
