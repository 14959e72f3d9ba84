//! What does an energy do when its configuration moves, and is what I wrote down right?
//!
//! ```text
//! [v]~ = T^-1 [v]   [nu]~ = [nu] T   [g]~ = T^T [g] T     vectors, covectors, forms       (1.1-1.4)
//! <nu, v>,   p = M v,   v = M^-1 p,   T = 1/2 <M v, v>    pairing and metric              (1.2-1.5)
//! [f] v = lambda [g] v,   V^T g V = I                     eigenvectors of a form          (1.4.1)
//! {df}(w) = d/ds f(q + s w),   {d2f}(v, w)                differentials                   (2.1-2.4)
//! (V(q + h w) - V(q - h w)) / 2h -> {dV}(w)               the check, over all h           (2.5)
//! V = sum W_s,   dV = sum dW_s,   d2V = sum d2W_s         energies of few vertices each   (3.3)
//! df(x) delta = -f(x),   x <- x + t delta                 Newton's method                 (4.4)
//! (m M + a d2V) x = r                                     what an implicit step solves    (4.4)
//! atan2(|u x v|, <u, v>)                                  angles                          (A.2)
//! ```
//! `q` a configuration, `v w` vectors, `nu p` covectors, `M g` metrics, `V W` energies in joules. The
//! numbers name sections of the notes.
//!
//! ```
//! use stationary_calculus::{Covector, Potential, Sink, assert_derivatives};
//!
//! struct Pendulum; // V(theta) = -m g l cos theta, with m g l = 1 J
//! impl Potential for Pendulum {
//!     fn dim(&self) -> usize { 1 }
//!     fn energy(&self, q: &[f64]) -> f64 { -q[0].cos() }
//!     fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) { dv.0[0] += q[0].sin(); }
//!     fn add_hessian(&self, q: &[f64], h: &mut impl Sink) { h.add_symmetric(&[0], &[q[0].cos()]); }
//! }
//! assert_derivatives(&Pendulum, &[0.3]); // a wrong entry is a panic that names it
//! ```
//!
//! Reading order: vectors and changes of basis; differentials, exact ones and the worked ones of 2.3;
//! metrics and forms; potentials, their stencils and the sinks that Hessians flow into; the check of
//! them all; a [`System`] of metric and potential; Newton's method with its solvers, dense and, with
//! the feature `sparse`, sparse; equilibria and the shortest solution of a system of any rank.
//!
//! The crate knows nothing of time, of meshes or of files.

mod array;
mod error;
mod vectors;
mod basis;
mod differential;
mod worked;
mod angle;
mod metric;
mod eigen;
mod potential;
mod sink;
mod parts;
mod readable;
mod scaled;
mod stencil;
mod automatic;
mod check;
mod force;
mod system;
mod equation;
mod newton;
mod function_equation;
mod hessian_solver;
mod pivots;
mod dense_solver;
mod dense_lu;
mod semidefinite;
#[cfg(feature = "sparse")]
mod sparse;
mod equilibrium;
mod least_norm;
mod span;
mod newton_study;

pub use angle::{angle, signed_angle};
pub use array::array;
pub use automatic::{Automatic, AutomaticStencil, Energy, StencilEnergy};
pub use basis::{
    BasisError, BilinearForm, ChangeOfBasis, ContravariantTensor, LinearTransformation,
};
pub use check::{
    Agreement, Derivative, DerivativeCheck, DerivativeError, Difference, Differences, Report,
    WrongEntry, assert_derivatives, assert_derivatives_on, assert_jacobian, check_jacobian,
    check_potential, check_potential_on, differences,
};
pub use dense_lu::DenseLu;
pub use dense_solver::DenseSolver;
pub use differential::{
    Number, atan2, differential, directional_derivative, gradient, hessian, jacobian,
    jacobian_of_matrix, second_differential,
};
pub use eigen::{EigenError, Eigenpairs};
pub use equation::{Equation, Unsolvable};
pub use equilibrium::{Equilibrium, EquilibriumReport, Stationary};
pub use error::{MetricError, SizeError};
pub use force::Force;
pub use function_equation::FunctionEquation;
pub use hessian_solver::{HessianSolver, Rung};
pub use least_norm::{LeastNorm, LeastNormError, least_norm};
pub use metric::{DenseMetric, DiagonalMetric, Metric};
pub use newton::{Newton, NewtonEnd, NewtonError, NewtonFailure, NewtonMemory, NewtonReport};
pub use newton_study::{newton_against_initial_guesses, newton_against_wrong_derivatives};
pub use parts::{Parts, in_parts, side_by_side};
pub use potential::Potential;
pub use readable::Readable;
pub use scaled::Scaled;
pub use semidefinite::project_semidefinite;
pub use sink::{DenseSink, FIXED, ProductSink, Sink};
pub use span::{complement, independent_rows};
#[cfg(feature = "sparse")]
pub use sparse::{
    ConjugateGradient, ConjugateGradientReport, Inertia, IterativeSolver, JacobianEntries, Ladder,
    Ordering, PatternSink, Pivoting, RefillSink, Refined, SparseCholesky, SparseEquation,
    SparseError, SparseIndefinite, SparseJacobian, SparseMetric, SparseSolver, SymmetricMatrix,
};
pub use stencil::{Curvature, Stencil, StencilHessian, Stencils, UnknownVertex};
pub use system::{Curved, Flat, PotentialOn, Space, System};
pub use vectors::{Covector, Storage, Vector, first_non_finite};
pub use worked::{
    cross_differential, cross_matrix, dot_differential, hat, hat_differential,
    inverse_differential, norm, norm_differential,
};
