//! The studies of the report, in the order of the page.

mod constraints;
mod contact;
mod choose;
mod choose_unseen;
mod convergence;
mod damping;
mod derivative;
mod elasticity;
mod error_estimates;
mod hamilton;
mod high_order;
mod laplacian;
mod long_run;
mod modal;
mod multiscale;
mod net_in_honey;
mod newmark_damping;
mod newton;
mod orbits;
mod oscillating;
mod phase_portrait;
mod reference;
mod rigid;
pub mod scene;
mod stability;
mod stability_regions;
mod stiff;
mod step_control;
mod table_4_1;
mod tolerance_honesty;
mod trials;
mod work_precision;

use crate::study::Entry;

/// Every study.
pub const STUDIES: &[Entry<'static>] = &[
    derivative::FIGURE_2_1,
    newton::WRONG_DERIVATIVES,
    newton::INITIAL_GUESSES,
    phase_portrait::ONE_STEP,
    convergence::KEPLER,
    convergence::PENDULUM,
    work_precision::KEPLER,
    work_precision::OUTER_SOLAR_SYSTEM,
    high_order::KEPLER_ORDERS,
    high_order::PENDULUM_ORDERS,
    high_order::HENON_HEILES_ORDERS,
    high_order::KEPLER_WORK,
    high_order::PLANETS_WORK,
    orbits::WORK_PRECISION,
    long_run::KEPLER,
    table_4_1::TABLE,
    oscillating::FERMI_PASTA_ULAM,
    oscillating::SPRING_CHAIN,
    stability::OSCILLATOR,
    stability::SPRING_PENDULUM,
    modal::membrane::STUDY,
    modal::frequencies::STUDY,
    modal::needed::STUDY,
    modal::reduced::STUDY,
    modal::pendulum::STUDY,
    modal::turning::STUDY,
    stability_regions::REGIONS,
    damping::STUDY,
    stiff::WORK_PRECISION,
    net_in_honey::STUDY,
    step_control::STUDY,
    tolerance_honesty::STUDY,
    error_estimates::STUDY,
    multiscale::STUDY,
    newmark_damping::STUDY,
    hamilton::BOUNDARY_VALUE,
    hamilton::IMPULSE_LIMIT,
    constraints::PENDULUM_WAYS,
    constraints::PENDULUM_ENERGY,
    constraints::PENALTY_STABILITY,
    constraints::ACCELERATION_DRIFT,
    constraints::FOUR_BAR,
    constraints::CHAIN_COST,
    constraints::WHERE_THEY_FAIL,
    rigid::ACCURACY,
    rigid::GIMBAL_LOCK,
    rigid::RODS_OR_BODY,
    rigid::LONG_RUN,
    rigid::WORK_PRECISION,
    rigid::RACKET,
    rigid::NUTATION,
    rigid::KOVALEVSKAYA,
    rigid::JOINTED,
    contact::IMPACT_LAWS,
    contact::BOUNCING_BALL,
    contact::CONTACT_PENALTY,
    contact::TUNNELLING,
    contact::DETECTION_COST,
    contact::PILE_SOLVERS,
    contact::FRICTION_THRESHOLD,
    contact::MASONRY_ARCH,
    elasticity::ORDERS,
    elasticity::MEMBRANE,
    elasticity::CANTILEVER,
    elasticity::LOCKING,
    elasticity::COMPRESSION,
    elasticity::DISPERSION,
    elasticity::SLINKY,
    elasticity::SLIVERS,
    elasticity::EXPLICIT_LIMIT,
    elasticity::FACTOR_OR_ITERATE,
    laplacian::spectrum::STUDY,
    laplacian::border::STUDY,
    laplacian::cost::STUDY,
    laplacian::maximum::STUDY,
    laplacian::distance::STUDY,
    choose::STUDY,
    choose_unseen::STUDY,
    trials::STUDY,
];

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
