//! How does a system get from now to a moment later? Time integrators as maps of phase space.
//!
//! ```text
//! q. = M^-1 p,   p. = -dV(q)                     the equations of motion            (4.2)
//! (q, p) -> Phi_h(q, p), close to the flow       a time integrator                  (4.3)
//! M (x - y) + a dV(x) = 0, by Newton's method    what an implicit step solves       (4.4)
//! M y' = f(t, y)                                 systems of first order, steps chosen on the way
//! order, stability, energy, momentum             what makes a good one, as data     (4.5)
//! S = sum h L_d, p0 = -h d1 L_d, p1 = h d2 L_d   the same from one function    (5.4, 5.5)
//! <p, xi(q)> is constant where xi is a symmetry  Noether's theorem                  (8.3)
//! p0 + h d1 L_d + h/2 F = 0,   p <- p + J        forces and impulses         (10.1-10.3)
//! ```
//! `q` a configuration, `p` its momentum (a covector), `M` the metric, `V` the potential, `h` the
//! step in seconds; `L_d` a discrete Lagrangian, `S` the action, `xi` the generator of a symmetry,
//! `F` a force, `J` an impulse. The numbers name sections of the notes.
//!
//! ```
//! use std::ops::ControlFlow;
//! use stationary_integrators::{Horizon, StormerVerlet, problems::kepler, simulate};
//!
//! let planet = kepler(0.6)?;
//! let mut state = planet.initial.clone();
//! let mut verlet = StormerVerlet::new(&planet.system)?;
//! let mut worst = 0.0_f64;
//! simulate(&mut verlet, &mut state, Horizon::divided(planet.horizon, 10_000)?, |now| {
//!     worst = worst.max((planet.energy(now.state) + 0.5).abs());
//!     ControlFlow::Continue(())
//! })?;
//! assert!(worst < 2e-4 && (planet.energy(&state) + 0.5).abs() < 2e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: what a step is ([`State`], [`Integrator`], [`Facts`]); the methods of 4.3, from
//! [`ExplicitEuler`] to [`RungeKutta4`], with the two ideas that they share (kicks and drifts for the
//! explicit ones, one equation for the implicit ones); those of high order ([`Composition`],
//! [`GaussLegendre`]), those for stiff systems ([`Newmark`], [`Imex`], [`Gautschi`]), and steps that
//! vary reversibly ([`ReversibleSteps`]); [`Method`], which names those that a system alone makes; then
//! [`simulate`], and [`simulate_with_error`], which tells how far the motion is from the true one;
//! systems of first order ([`VectorField`], [`DormandPrince853`], [`DormandPrince54`], [`RadauIia5`],
//! [`BackwardDifferences`], [`integrate`]); orbits to many digits ([`Nystrom12`]); the potentials of
//! chapter 0, momenta with the symmetries that keep them ([`Symmetry`]), and [`problems`] with known
//! answers. Last, Hamilton's principle:
//! [`Lagrangian`], [`DiscreteLagrangian`] and its integrator [`Variational`], the [`Action`] and
//! motions between two ends, [`Drag`], [`Load`] and [`Impulse`].
//!
//! An integrator is bound to its system: sizes are checked and memory is taken when it is made. A
//! step allocates nothing, and a failed step leaves the state as it was. Every fact is asserted by
//! a test. The crate knows nothing of constraints, rotations or files.

mod error;
mod state;
mod integrator;
mod facts;
mod splitting;
mod explicit_euler;
mod symplectic_euler;
mod stormer_verlet;
mod runge_kutta_4;
mod nystrom_4;
mod scheme;
mod composition;
mod stage;
mod implicit_euler;
mod trapezoid;
mod implicit_midpoint;
mod collocation;
mod own_rounding;
mod gauss_legendre;
mod newmark_weights;
mod alpha_equation;
mod newmark;
mod imex;
mod gautschi;
mod reversible;
mod method;
mod facts_table;
mod simulate;
mod global_error;
mod first_order;
mod nystrom;
mod gravity;
mod noether;
mod momentum;
pub mod problems;
mod convergence;
mod lagrangian;
mod mechanical;
mod discrete_lagrangian;
mod quadrature;
mod variational;
mod action;
mod boundary_value;
mod damped_pattern;
mod drag;
mod load;
mod impulse;

pub use action::Action;
pub use boundary_value::{Stationary, StationaryPath};
pub use collocation::Nodes;
pub use composition::Composition;
pub use convergence::{Convergence, ConvergenceRow, Delivered, deliver};
pub use damped_pattern::DampedPattern;
pub use discrete_lagrangian::{DiscreteLagrangian, VARIATIONAL};
pub use drag::Drag;
pub use error::{
    ActionError, ForceError, HorizonError, ImpulseError, ParameterError, ResumeError,
    SimulationError, StepError, StudyError,
};
pub use explicit_euler::ExplicitEuler;
pub use facts::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};
pub use facts_table::{facts_table, first_order_facts_table};
pub use first_order::{
    AcceptedStep, AdaptiveError, AdaptiveMethod, BackwardDifferences, ControlError, Direction,
    DormandPrince54, DormandPrince853, EstimatedMoment, Event, FirstOrderFacts, FunctionField,
    Jacobian, MechanicalField, Moment, Outcome, OutputTimes, RadauIia5, Saved, StepControl,
    Tolerance, VectorField, Work, integrate, integrate_to_event, integrate_with_error,
};
pub use gauss_legendre::GaussLegendre;
pub use gautschi::{Filter, Gautschi, StiffnessError};
pub use global_error::{Estimated, Trust, simulate_with_error};
pub use gravity::{CentralGravity, NewtonianGravity, UniformGravity};
pub use imex::Imex;
pub use implicit_euler::ImplicitEuler;
pub use implicit_midpoint::ImplicitMidpoint;
pub use impulse::{Impulse, simulate_with_impulses};
pub use integrator::{Integrator, StepReport};
pub use lagrangian::{EulerLagrange, Lagrangian, LagrangianError};
pub use load::{Load, bump};
pub use mechanical::Mechanical;
pub use method::{Method, UnknownMethod};
pub use momentum::{
    Rotation, Translation, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale,
};
pub use newmark::Newmark;
pub use newmark_weights::NewmarkWeights;
pub use noether::{Asymmetry, Symmetry, discrete_momentum_map, momentum_map};
pub use nystrom::{
    Nystrom, Nystrom8, Nystrom12, NystromMethod, NystromMethod8, NystromMethod12, NystromPair,
    NystromStages, NystromStep, Pair8, Pair12,
};
pub use nystrom_4::Nystrom4;
pub use quadrature::{Quadrature, Sampled};
pub use reversible::{PotentialPower, ReversibleSteps, StepDensity};
pub use runge_kutta_4::RungeKutta4;
pub use scheme::Scheme;
pub use simulate::{Cost, Horizon, Observation, simulate};
pub use state::State;
pub use stormer_verlet::StormerVerlet;
pub use symplectic_euler::{SymplecticEulerDriftKick, SymplecticEulerKickDrift};
pub use trapezoid::Trapezoid;
pub use variational::Variational;
