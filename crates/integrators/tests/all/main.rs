//! What holds of `stationary-integrators`, in one binary: what is generic is compiled once.

mod action;
mod bad_input;
mod discrete_lagrangians;
mod explosions;
mod facts;
mod first_order_allocation;
mod first_order_dense_output;
mod first_order_driven;
mod first_order_events;
mod first_order_facts;
mod first_order_methods;
mod first_order_runs;
mod forces;
mod global_errors;
mod gautschi;
mod hamilton;
mod long_momenta;
mod mass_matrices;
mod newmark;
mod no_allocation;
mod noether;
mod nystrom;
mod orders;
mod stability;
