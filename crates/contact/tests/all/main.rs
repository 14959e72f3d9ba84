//! What holds of `stationary-contact`, in one binary: what is generic is compiled once.

#[cfg(any(feature = "2d", feature = "3d"))]
mod apart;
mod at_the_instant;
#[cfg(all(feature = "2d", feature = "3d"))]
mod bad_input;
#[cfg(all(feature = "2d", feature = "3d"))]
mod clearance;
#[cfg(feature = "3d")]
mod compounds;
#[cfg(all(feature = "2d", feature = "3d"))]
mod curved_seams;
#[cfg(feature = "3d")]
mod degenerate;
mod detection;
#[cfg(all(feature = "2d", feature = "3d"))]
mod event_driven;
#[cfg(all(feature = "2d", feature = "3d"))]
mod equalities;
mod error_controlled;
mod exact_friction;
#[cfg(all(feature = "2d", feature = "3d"))]
mod foreseen;
#[cfg(all(feature = "2d", feature = "3d"))]
mod heavy_stacks;
mod impact_laws;
#[cfg(feature = "3d")]
mod standing;
#[cfg(feature = "3d")]
mod jointed;
#[cfg(feature = "3d")]
mod jointed_space;
mod landing_chains;
#[cfg(feature = "3d")]
mod lifting;
#[cfg(feature = "3d")]
mod kinds_and_steppers;
#[cfg(all(feature = "2d", feature = "3d"))]
mod joint_limits;
mod no_allocation;
#[cfg(feature = "2d")]
mod planar_detection;
#[cfg(feature = "2d")]
mod planar_kinds_and_steppers;
#[cfg(feature = "3d")]
mod polytopes;
#[cfg(all(feature = "2d", feature = "3d"))]
mod push_apart;
mod queries;
#[cfg(all(feature = "2d", feature = "3d"))]
mod resuming;
#[cfg(all(feature = "2d", feature = "3d"))]
mod rigid_time_of_impact;
#[cfg(feature = "3d")]
mod round_solids;
#[cfg(feature = "2d")]
mod rough_impacts;
#[cfg(all(feature = "2d", feature = "3d"))]
mod rolling;
#[cfg(feature = "2d")]
mod small_steps;
#[cfg(feature = "3d")]
mod sizes;
#[cfg(all(feature = "2d", feature = "3d"))]
mod seams;
#[cfg(all(feature = "2d", feature = "3d"))]
mod steps;
mod swinging_forces;
mod sheet_on_a_box;
mod thin_sheet;
mod to_and_fro;
mod time_of_impact;
#[cfg(feature = "3d")]
mod touching;
mod towers;
mod when;
#[cfg(all(feature = "2d", feature = "3d"))]
mod world;
