//! What integrators promises, on random problems.

mod bad_input;
mod encounters;
mod fixed_orders;
mod global_errors;
mod kinetics;
mod problem;
pub mod reference;
mod runs;
mod smooth;
mod tolerance;

use crate::Kind;

/// The kinds of trials of integrators.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "tolerance",
        krate: "integrators",
        rule: "adaptive methods: the error at the end, in the scale of the tolerance, above \
               min(0.1, 100 tol max(1, A)), of BDF held to order k <= 2 above \
               100 tol^(k/(k+1)) max(1, A), of reactions where 0.01 < A tol <= 0.1 above max(0.1, 5 A tol); a \
               collision that is passed",
        in_tests: 150,
        trial: tolerance::at_the_end,
    },
    Kind {
        name: "dense-output",
        krate: "integrators",
        rule: "the error of dense output at a random time, in the scale of the tolerance, above \
               min(0.1, 100 tol max(1, A)), of BDF held to order k <= 2 above \
               100 tol^(k/(k+1)) max(1, A), of Radau on stiff problems above 10 tol^(2/3) max(1, A)",
        in_tests: 150,
        trial: tolerance::between_the_steps,
    },
    Kind {
        name: "fixed-orders",
        krate: "integrators",
        rule: "fixed steps: the largest error along the way falls with one power of the step, from \
               1e-3 down to 1e-10 of the motion, and it is more than 0.4 below the order",
        in_tests: 60,
        trial: fixed_orders::trial,
    },
    Kind {
        name: "global-errors",
        krate: "integrators",
        rule: "fixed steps: the estimated error of the configuration, where it is said to be sure, off \
               by more than a factor of 4",
        in_tests: 100,
        trial: global_errors::trial,
    },
    Kind {
        name: "bad-input-integrators",
        krate: "integrators",
        rule: "any public function with bad numbers and sizes: a panic, or an Ok whose answer is \
               not finite",
        in_tests: 1000,
        trial: bad_input::trial,
    },
];
