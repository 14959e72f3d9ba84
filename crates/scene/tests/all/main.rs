//! What holds of `stationary-scene`, in one binary: what is generic is compiled once.

mod any_input;
mod bodies;
mod body_diagnostics;
mod built;
mod checkpoints;
mod claims;
mod diagnostics;
mod driven;
mod failed_runs;
mod faces_and_walls;
mod fields;
mod files;
mod heat;
mod jointed_contact;
mod output;
mod pairs;
mod parameters;
mod quadratic;
mod runs;
mod schema;
mod solids;
mod steppings;
mod touching;
mod touching_bodies;
mod unstable_steps;
mod wrong_values;
