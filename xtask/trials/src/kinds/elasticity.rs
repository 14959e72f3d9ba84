//! What elasticity promises, on random problems.

#![expect(clippy::needless_range_loop, reason = "tensors are written by their indices")]

mod bad_input;
mod body;
mod field;
mod hung;
mod law;
mod materials;
mod nodal_stress;
mod shapes;
mod statics;

use crate::Kind;

/// The kinds of trials of elasticity.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "materials",
        krate: "elasticity",
        rule: "energy, stress or second derivative off by more than 40 roundings of F - I make",
        in_tests: 2000,
        trial: materials::trial,
    },
    Kind {
        name: "nodal-stress",
        krate: "elasticity",
        rule: "Cauchy's stress of a uniform strain off by 1e-10, or plane stress by 1e-9",
        in_tests: 500,
        trial: nodal_stress::trial,
    },
    Kind {
        name: "statics",
        krate: "elasticity",
        rule: "Ok and off by 1e-6 of the displacement (beams 3 %), a saddle, or inside out",
        in_tests: 300,
        trial: statics::trial,
    },
    Kind {
        name: "statics-hung",
        krate: "elasticity",
        rule: "Ok and off by 1e-6 of the displacement, a saddle, or one of many places of rest",
        in_tests: 200,
        trial: hung::trial,
    },
    Kind {
        name: "bad-input-elasticity",
        krate: "elasticity",
        rule: "a panic, Ok with what is not finite, or Ok with sizes and supports that do not fit",
        in_tests: 2000,
        trial: bad_input::trial,
    },
];
