//! The solver of a world: contacts packed for many visits, island by island.

pub(crate) mod body_state;
pub(crate) mod rigid_contact;
pub(crate) mod friction;
pub(crate) mod islands;
pub(crate) mod block_cholesky;
pub(crate) mod grip;
pub(crate) mod proximal;
pub(crate) mod rolling;
pub(crate) mod rolling_rows;
pub(crate) mod sweeps;
pub(crate) mod unsettled_parts;
pub(crate) mod exact_projection;
pub(crate) mod polish;
pub(crate) mod island_solver;
