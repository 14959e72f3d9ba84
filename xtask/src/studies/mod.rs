//! The studies of the report: a folder a crate, a file a study or a few that share their problem.
//!
//! A new study is a file and its line in the list below. From its [`Entry`] come its place on the page,
//! its mention on the page of its crate, and its test.

mod cheapest;
mod choose;
mod choose_unseen;
mod conclusions;
pub mod scene;
mod spaced;
mod trials;

pub use conclusions::{CONCLUSIONS, Conclusion};

use crate::study::Entry;

/// Declares the files of each folder, and lists their studies in the order of the page.
macro_rules! studies {
    (
        folders { $($folder:ident { $($file:ident: [$($study:ident),*],)+ })+ }
        besides { $($other:path,)+ }
    ) => {
        $(mod $folder { $(pub mod $file;)+ })+

        /// Every study.
        pub const STUDIES: &[Entry<'static>] = &[$($($($folder::$file::$study,)*)+)+ $($other,)+];

        /// The files of studies, from the folder of this one. `cargo fmt` does not find them.
        pub const FILES: &[&str] =
            &[$($(concat!(stringify!($folder), "/", stringify!($file), ".rs"),)+)+];
    };
}

studies! {
    folders {
        calculus {
            derivative: [FIGURE_2_1],
            newton: [WRONG_DERIVATIVES, INITIAL_GUESSES],
        }
        integrators {
            orbits: [WORK_PRECISION],
            work_precision: [KEPLER, OUTER_SOLAR_SYSTEM],
            high_order: [KEPLER_ORDERS, PENDULUM_ORDERS, HENON_HEILES_ORDERS, KEPLER_WORK, PLANETS_WORK],
            oscillating: [FERMI_PASTA_ULAM, SPRING_CHAIN],
            stiff: [WORK_PRECISION],
            net_in_honey: [STUDY],
            tolerance_honesty: [STUDY],
            error_estimates: [STUDY],
            step_control: [STUDY],
            long_run: [KEPLER],
            phase_portrait: [ONE_STEP],
            convergence: [KEPLER, PENDULUM],
            table_4_1: [TABLE],
            stability: [OSCILLATOR, SPRING_PENDULUM],
            stability_regions: [REGIONS],
            damping: [STUDY],
            multiscale: [STUDY],
            newmark_damping: [STUDY],
            hamilton: [BOUNDARY_VALUE, IMPULSE_LIMIT],
            reference: [],
        }
        constraints {
            pendulum: [PENDULUM_WAYS, PENDULUM_ENERGY],
            four_bar: [FOUR_BAR],
            chain: [CHAIN_COST],
            equality_cost: [EQUALITY_COST],
            penalty: [PENALTY_STABILITY],
            drift: [ACCELERATION_DRIFT],
            adaptive_edge: [ADAPTIVE_EDGE],
            failures: [WHERE_THEY_FAIL],
        }
        rigid {
            free_box: [WORK_PRECISION, LONG_RUN],
            accuracy: [ACCURACY],
            gimbal_lock: [GIMBAL_LOCK],
            rods_or_body: [RODS_OR_BODY],
            racket: [RACKET],
            heavy_tops: [NUTATION, KOVALEVSKAYA],
            jointed: [JOINTED],
            forced: [FORCED],
            joint_coordinates: [JOINT_COORDINATES],
            published: [PUBLISHED],
            small_motions: [SMALL_MOTIONS],
        }
        contact {
            laws: [IMPACT_LAWS],
            pile: [PILE_SOLVERS],
            cost: [DETECTION_COST],
            solids: [GAPS_OF_SOLIDS],
            towers: [TOWERS],
            tunnelling: [TUNNELLING],
            bounce: [BOUNCING_BALL],
            penalty: [CONTACT_PENALTY],
            friction: [FRICTION_THRESHOLD],
            arch: [MASONRY_ARCH],
            work_precision: [CONTACT_WORK_PRECISION],
            swinging: [SWINGING_PULL],
            friction_problems: [FRICTION_PROBLEMS],
            coupled_rows: [COUPLED_ROWS],
            rolling: [ROLLING_FRICTION],
        }
        elasticity {
            sheets: [CANTILEVER, MEMBRANE, LOCKING],
            factor_or_iterate: [STUDY],
            orders: [STUDY],
            hung_bar: [STUDY],
            compression: [STUDY],
            dispersion: [STUDY],
            slinky: [STUDY],
            slivers: [STUDY],
            explicit_limit: [STUDY],
        }
        modal {
            reduced: [STUDY],
            needed: [STUDY],
            membrane: [STUDY],
            frequencies: [STUDY],
            pendulum: [STUDY],
            turning: [STUDY],
            lowest: [],
        }
        laplacian {
            cost: [STUDY],
            spectrum: [STUDY],
            border: [STUDY],
            maximum: [STUDY],
            distance: [STUDY],
            largest: [STUDY],
        }
    }
    besides {
        choose::STUDY,
        choose_unseen::STUDY,
        trials::STUDY,
    }
}

/// Methods that keep their colour and marker whatever subset of the studies is run. The others are
/// given theirs in order of appearance.
pub const METHODS: &[&str] = &[
    "stormer-verlet",
    "runge-kutta-4",
    "implicit-midpoint",
    "explicit-euler",
    "implicit-euler",
    "trapezoid",
    "symplectic-euler-drift-kick",
    "symplectic-euler-kick-drift",
];
