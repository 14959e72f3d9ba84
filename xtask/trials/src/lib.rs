//! Does each promise hold on cases that its author did not choose?
//!
//! A [`Kind`] is one kind of promise: a generator of random problems, ugly ones over-represented, and
//! a referee that knows the truth by another way: a closed form, another method at a far tighter
//! setting, exact rationals, a dense solve, a conservation law. A referee that shares code with what
//! it judges is none.
//!
//! ```text
//! right         the error is at most what the page promises for that call, or a refusal was due
//! refused       a typed error, or Ok with a sign that a caller cannot overlook
//! not judged    the referee itself does not know
//! apart         neither right nor wrong here: what is wrong, or cannot be, is another promise's
//! wrong         Ok, no sign, and a larger error; a panic, a hang, a NaN
//! ```
//!
//! Reading order: [`Draw`], where cases come from; [`Verdict`], what is said of one; [`Kind`] and the
//! list of them, [`KINDS`]; [`Plan`], which runs many; shrinking, which makes a wrong one small.
//!
//! Each kind writes down what it counts as wrong in its `rule` before its first run.

#![allow(clippy::missing_errors_doc, reason = "an unpublished tool: its errors end in a message")]

mod draw;
mod verdict;
mod kind;
mod shrink;
mod processor_time;
mod run;
mod command;

pub mod kinds;

pub use command::{Arguments, CommandError};
pub use draw::Draw;
pub use kind::{KINDS, Kind};
pub use run::{Fault, Plan, Tally};
pub use verdict::Verdict;
