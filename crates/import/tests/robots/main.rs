//! Descriptions as scenes that run: against closed forms, one format against the other, and what is refused.

mod read_otherwise;
mod refused;
mod unread_words;
mod urdf_words;
mod not_allowed;
mod run;
