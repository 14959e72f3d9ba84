//! How does a system move when not every configuration is allowed?
//!
//! ```text
//! g(t, q) = 0,    J = dg of full row rank                       a constraint            (6, 8.1)
//! q = q(s)                                                      reduced coordinates     (6.1)
//! V + k/2 |g|^2                                                 penalty                 (6.2)
//! q~ = Phi_h(q),    q' closest to q~ with g = 0                 step and project        (6.3)
//! df = lambda^T dg,    g = 0                                    Lagrange multipliers    (6.4)
//! sum_i h (L_d(q_i, q_i+1) - <lambda_i, g(q_i)>) stationary     constrained Hamilton    (6.5)
//! F = -J^T lambda                                               the force that it takes
//! ```
//! `q` a configuration, `J` m x n for m equations and n freedoms of velocities, `lambda`
//! multipliers (m), `h` the step in seconds. The numbers name sections of the notes.
//!
//! ```
//! use stationary_constraints::problems::{RodProblem, pendulum};
//! use stationary_constraints::{ConstrainedIntegrator, Dense, Rattle, Redundancy};
//!
//! // A unit mass on a unit rod, pushed at the bottom hard enough to go round.
//! let RodProblem { system, rods, initial } = pendulum(2.5)?.problem;
//! let mut rattle = Rattle::new(&system, rods.clone(), &initial, Dense::<1>(Redundancy::Refuse))?;
//! let mut state = initial;
//! for _ in 0..1000 {
//!     rattle.step(&mut state, 0.01)?;
//! }
//! let tension = rods.rods()[0].tension(rattle.multipliers()[0]); // newtons
//! assert!((state.q[0].hypot(state.q[1]) - 1.0).abs() < 1e-14 && tension.is_finite());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: what a [`Constraint`] is, sets of them, and the ones that are there ([`Rods`],
//! [`FixedPoint`], [`Linear`], any [`Function`], a point on a [`LevelSet`]); the linear system behind all
//! of it, solved by [`Dense`] for up to three equations, by [`SparseDiagonal`] for any number, or by
//! `SparseGeneral` under a metric that couples freedoms; [`VelocityRows`], which hand equalities and
//! inequalities to whoever solves both; then the ways to keep a constraint in the notes' order:
//! [`Reduced`] coordinates and the [`ArcsinePendulum`], [`Penalty`], [`Projection`] and [`StepAndProject`], [`critical_point`], [`ConstrainedHamilton`]
//! and [`Rattle`], rods that break; and [`problems`] with known answers.
//!
//! | way | feasible | order | energy | what it asks for |
//! | --- | --- | --- | --- | --- |
//! | [`Reduced`] | exactly | 1 or 2 | bounded | coordinates that are regular on the way |
//! | [`Penalty`] | to F/k | the integrator's | the integrator's | a step like 1/sqrt(k) |
//! | [`StepAndProject`] | to rounding | 1 | decays | full rank on the way |
//! | [`ConstrainedHamilton`] | configurations | 1 | bounded | full rank on the way |
//! | [`Rattle`] | to rounding | 2 | bounded | full rank on the way |
//!
//! Configurations move through the system's `Space` only, so that the same code serves rotations;
//! where momenta turn on the way, [`Rattle`] takes a [`FreeMotion`] that knows how. A state that is
//! not feasible is an error that says by how much, and [`Projection`] mends it on request. A step
//! allocates nothing, and a failed one leaves the state as it was. Iterations start from the last steps'
//! impulses, continued by an [`Extrapolation`]; `save` and `load` carry them along.
//!
//! The rank is examined at each accepted configuration. A linkage passes a singular one between two of them, or the
//! step is an error that names the equations which depend on each other there. [`Dense`] and [`SparseDiagonal`] tell a row
//! that depends on others from one that is independent by a part in 1e7 of its size, or say that they
//! cannot; `SparseGeneral` sees what makes its matrix singular to working precision, and how near that is. The crate states
//! inequalities and solves none; it knows nothing of contact or files.

mod error;
mod constraint;
mod rows;
mod set;
mod pairing;
mod rods;
mod points;
mod linear;
mod function;
mod level_set;
mod feasible;
mod checks;
mod multipliers;
mod carried_sum;
mod dense;
mod entries;
mod elimination;
mod products;
mod rank_revealing;
mod sparse_diagonal;
#[cfg(feature = "sparse")]
mod sparse_general;
mod velocity_rows;
mod embedding;
mod arcsine;
mod penalty;
mod projection;
mod integrator;
mod step_and_project;
mod critical_point;
mod free_motion;
mod force_kicks;
mod forced;
mod secants;
mod extrapolation;
mod warm_start;
mod rattle_core;
mod hamilton;
mod rattle;
mod parts;
mod halving;
mod adaptive;
mod composed;
mod breaking;
pub mod problems;

pub use adaptive::{Adaptive, AdaptiveReport, StepTolerance};
pub use arcsine::ArcsinePendulum;
pub use breaking::Broken;
pub use composed::Composed;
pub use constraint::{
    BodyNumbers, Constraint, ConstraintOn, Measure, Rows, Scale, check_multipliers, check_read,
    check_values, equation_name,
};
pub use critical_point::{CriticalPoint, Kind, critical_point};
pub use dense::{Dense, DenseMultipliers, SmallVec};
pub use embedding::{Embedding, Links, Reduced, Sampling, Weight};
pub use error::ConstraintError;
pub use extrapolation::Extrapolation;
pub use force_kicks::ForceKicks;
pub use forced::Forced;
pub use free_motion::{FreeMotion, Straight};
pub use function::{Function, FunctionConstraint};
pub use halving::Halving;
pub use hamilton::ConstrainedHamilton;
pub use integrator::{ConstrainedIntegrator, ConstrainedReport};
pub use level_set::{Level, LevelSet};
pub use linear::Linear;
pub use multipliers::{Multipliers, Redundancy, Solver};
pub use pairing::Pairing;
pub use penalty::Penalty;
pub use points::FixedPoint;
pub use projection::{Projection, ProjectionReport};
pub use rattle::Rattle;
pub use rods::{Hooks, Rod, Rods};
pub use sparse_diagonal::{DiagonalMultipliers, SparseDiagonal};
#[cfg(feature = "sparse")]
pub use sparse_general::{GeneralMultipliers, SparseGeneral};
pub use step_and_project::StepAndProject;
pub use velocity_rows::{RowLaw, VelocityRows};
