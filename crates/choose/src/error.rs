//! Why a question has no answer before anything is run.

use std::time::Duration;

use stationary_calculus::{Readable, SizeError};

use crate::ladder::Ladder;

/// A question that cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuestionError {
    /// A tolerance is a part of one.
    #[error("the tolerance must be at least 1e-12 and less than 1 (got {})", Readable(.0))]
    Tolerance(f64),
    /// Nothing can be run in no time.
    #[error("the budget must be positive (got {0:?})")]
    Budget(Duration),
    /// A horizon to which nothing runs.
    #[error("the horizon must be positive and finite (got {})", Readable(.0))]
    Horizon(f64),
    /// The start, or what is observed there, is not finite.
    #[error("{what} has a number that is not finite at the start, the one at place {place} from 0")]
    NotFinite {
        /// Which numbers.
        what: &'static str,
        /// The first that is not finite.
        place: usize,
    },
    /// Nothing is observed.
    #[error("the observable has no numbers")]
    NothingObserved,
    /// A start of another size than what moves.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A ladder on which nothing comes nearer to what was asked about.
    #[error("no family of the ladder converges to what was asked about itself")]
    NoFamily,
    /// A family without rungs.
    #[error("the family `{0}` has no rungs")]
    NoSetting(String),
    /// The rungs of a family must become finer, and each take some work.
    #[error(
        "rung {rung} of the family `{family}` is no finer than the one before, or takes no work"
    )]
    Order {
        /// The family's name.
        family: String,
        /// The rung, from 0.
        rung: usize,
    },
}

impl QuestionError {
    /// An error where a ladder cannot be searched.
    pub(crate) fn check(ladder: &Ladder) -> Result<(), QuestionError> {
        crate::motion::check_horizon(ladder.horizon)?;
        for family in &ladder.families {
            if family.rungs.is_empty() {
                return Err(QuestionError::NoSetting(family.name.clone()));
            }
            let is_finer = |pair: &[crate::Setting]| {
                let [coarse, fine] = [pair[0].setting, pair[1].setting];
                match family.kind {
                    crate::Kind::Modes => fine > coarse,
                    _ => fine < coarse,
                }
            };
            let order = |rung: usize| QuestionError::Order { family: family.name.clone(), rung };
            if let Some(rung) = family.rungs.iter().position(|rung| rung.least_work == 0) {
                return Err(order(rung));
            }
            if let Some(rung) = family.rungs.windows(2).position(|pair| !is_finer(pair)) {
                return Err(order(rung + 1));
            }
        }
        match ladder.families.iter().any(crate::Family::converges) {
            true => Ok(()),
            false => Err(QuestionError::NoFamily),
        }
    }
}
