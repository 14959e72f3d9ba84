//! Problems with known answers, shared by tests, studies and timings.
//!
//! ```text
//! manufactured   u chosen, b = -div sigma(u), u held on the boundary: the error is known    (13.2)
//! LE1            elliptic membrane under pressure: sigma_yy = 92.7 MPa at (2, 0)          NAFEMS
//! cantilever     a beam, clamped and pushed: P L^3/(3 E I) + 6 P L/(5 G A)            Timoshenko
//! FV32           tapered membrane: six frequencies from 44.623 Hz                         NAFEMS
//! vibrations     bar, beam and block at rest, with the frequencies of waves in them
//! ```
//! All in linear elasticity, so that what is measured is the element and not the material.

mod beam_theory;
mod cantilever;
mod elliptic_membrane;
mod manufactured;
mod vibration;

pub use beam_theory::{BeamTheory, Ends};
pub use cantilever::{Beam, Sheet, SheetFamily};
pub use elliptic_membrane::{LE1_STRESS, elliptic_membrane_stress};
pub use manufactured::{Errors, PlaneWaves, manufactured_errors};
pub use vibration::{
    FV32_HERTZ, Vibration, bar_frequencies, fv32, sliding_block, sliding_block_frequencies,
    vibrating_bar, vibrating_beam,
};
