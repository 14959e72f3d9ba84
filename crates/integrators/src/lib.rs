//! How does a system get from now to a moment later? Time integrators as maps of phase space.
//!
//! ```text
//! q. = M^-1 p,   p. = -dV(q)                     the equations of motion            (4.2)
//! (q, p) -> Phi_h(q, p), close to the flow       a time integrator                  (4.3)
//! M (x - y) + a dV(x) = 0, by Newton's method    what an implicit step solves       (4.4)
//! order, stability, energy, momentum             what makes a good one, as data     (4.5)
//! ```
//! `q` a configuration, `p` its momentum (a covector), `M` the metric, `V` the potential, `h` the
//! step in seconds. The numbers name sections of the notes.
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
//! [`ExplicitEuler`] to [`RungeKutta4`], with the two ideas that they share (kicks and drifts for
//! the explicit ones, one equation for the implicit ones); those of high order ([`Composition`],
//! [`GaussLegendre`]), those for stiff systems ([`Newmark`], [`Imex`], [`Gautschi`]), and steps
//! that vary reversibly ([`ReversibleSteps`]); [`Method`], which names those that a system alone
//! makes; then [`simulate`], the potentials of chapter 0, momenta, and [`problems`] with known
//! answers.
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
mod nystrom;
mod scheme;
mod composition;
mod stage;
mod implicit_euler;
mod trapezoid;
mod implicit_midpoint;
mod collocation;
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
mod gravity;
mod momentum;
pub mod problems;
mod convergence;

pub use alpha_equation::Unforced;
pub use collocation::Nodes;
pub use composition::Composition;
pub use convergence::{Convergence, ConvergenceRow, Delivered, deliver};
pub use error::{HorizonError, ParameterError, SimulationError, StepError, StudyError};
pub use explicit_euler::ExplicitEuler;
pub use facts::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};
pub use facts_table::facts_table;
pub use gauss_legendre::GaussLegendre;
pub use gautschi::{Filter, Gautschi, StiffnessError};
pub use gravity::{CentralGravity, NewtonianGravity, UniformGravity};
pub use imex::Imex;
pub use implicit_euler::ImplicitEuler;
pub use implicit_midpoint::ImplicitMidpoint;
pub use integrator::{Integrator, StepReport};
pub use method::{Method, UnknownMethod};
pub use momentum::{
    angular_momentum, angular_momentum_scale, linear_momentum, linear_momentum_scale,
};
pub use newmark::Newmark;
pub use newmark_weights::NewmarkWeights;
pub use nystrom::Nystrom4;
pub use reversible::{PotentialPower, ReversibleSteps, StepDensity};
pub use runge_kutta_4::RungeKutta4;
pub use scheme::Scheme;
pub use simulate::{Cost, Horizon, Observation, simulate};
pub use state::State;
pub use stormer_verlet::StormerVerlet;
pub use symplectic_euler::{SymplecticEulerDriftKick, SymplecticEulerKickDrift};
pub use trapezoid::Trapezoid;
