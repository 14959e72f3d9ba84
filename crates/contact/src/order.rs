//! Error that falls faster than the step: flight between impacts at their instant, and steps chosen by error.

pub(crate) mod step_forces;
pub(crate) mod flight_forces;
pub(crate) mod flight;
pub(crate) mod free_time;
pub(crate) mod event;
pub(crate) mod event_driven;
pub(crate) mod pieces;
pub(crate) mod ledger;
pub(crate) mod pushing;
pub(crate) mod swings;
pub(crate) mod error_controlled;
