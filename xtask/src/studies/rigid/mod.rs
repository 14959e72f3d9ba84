//! Rigid motion: what integrators keep, what accuracy costs, and what joints and charts do to it.

mod accuracy;
mod free_box;
mod gimbal_lock;
mod heavy_tops;
mod jointed;
mod racket;
mod rods_or_body;

pub use accuracy::ACCURACY;
pub use free_box::{LONG_RUN, WORK_PRECISION};
pub use gimbal_lock::GIMBAL_LOCK;
pub use heavy_tops::{KOVALEVSKAYA, NUTATION};
pub use jointed::JOINTED;
pub use racket::RACKET;
pub use rods_or_body::RODS_OR_BODY;
