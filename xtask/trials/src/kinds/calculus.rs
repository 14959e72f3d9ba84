//! What calculus promises, on random problems.
//!
//! `landscape` is the problem that most kinds share: a sum of terms whose differential and Hessian are
//! closed forms of the trial's own.

mod bad_input;
mod derivative_check;
mod equilibria;
mod landscape;
mod linear_solves;
mod newton;

use crate::Kind;

/// The kinds of trials of calculus.
pub const KINDS: &[Kind] =
    &[equilibria::KIND, derivative_check::KIND, linear_solves::KIND, newton::KIND, bad_input::KIND];
