//! Time integrators: maps from phase space to itself that approximate the flow of a system.
mod error;
mod explicit_euler;
mod facts;
mod gravity;
mod implicit_euler;
mod implicit_midpoint;
mod integrator;
mod method;
mod momentum;
pub mod problems;
mod runge_kutta_4;
mod simulate;
mod splitting;
mod stage;
mod state;
mod stormer_verlet;
mod symplectic_euler;
mod trapezoid;

pub use error::{HorizonError, SimulationError, StepError};
pub use explicit_euler::ExplicitEuler;
pub use facts::{
    Conservation, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};
pub use gravity::{CentralGravity, NewtonianGravity, UniformGravity};
pub use implicit_euler::ImplicitEuler;
pub use implicit_midpoint::ImplicitMidpoint;
pub use integrator::{Integrator, StepReport};
pub use method::{Method, UnknownMethod};
pub use momentum::{
    angular_momentum, angular_momentum_scale, linear_momentum, linear_momentum_scale,
};
pub use runge_kutta_4::RungeKutta4;
pub use simulate::{Cost, Horizon, Observation, simulate};
pub use state::State;
pub use stormer_verlet::StormerVerlet;
pub use symplectic_euler::{SymplecticEulerDriftKick, SymplecticEulerKickDrift};
pub use trapezoid::Trapezoid;
