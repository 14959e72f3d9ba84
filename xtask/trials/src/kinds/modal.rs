//! What modal promises, on random problems.

mod bad_input;
mod motion;
mod prescribed;
mod rigid_motions;
mod spectra;

use crate::Kind;

/// The kinds of trials of modal.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "spectra",
        krate: "modal",
        rule: "Ok where the i-th value is farther from the i-th of the prescribed list than its stated \
               residual + 1e-12 n max|lambda|, a residual above 1e-8 max|lambda| or misstated, products \
               in the mass off by 1e-9, or a mode missing below `complete_below`",
        in_tests: 100,
        trial: spectra::trial,
    },
    Kind {
        name: "rigid-motions",
        krate: "modal",
        rule: "Ok with another number of rigid motions than the ranks of the held rows say, motions \
               that cost energy or are not orthonormal in the mass to 1e-8",
        in_tests: 500,
        trial: rigid_motions::trial,
    },
    Kind {
        name: "modal-motion",
        krate: "modal",
        rule: "Ok farther from the closed form of each oscillator than 1e-11 and 8 eps of the phase, \
               relative to its envelope at that time; NaN; an answer where no digit of the phase is left",
        in_tests: 1500,
        trial: motion::trial,
    },
    Kind {
        name: "bad-input-modal",
        krate: "modal",
        rule: "a panic; Ok with a number that is not finite; a state that is not finite after an error",
        in_tests: 1500,
        trial: bad_input::trial,
    },
];
