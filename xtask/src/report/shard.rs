//! A share of a report, run on one of many machines: its outcomes in a file that joins with others.
//!
//! ```text
//! share I of N     the studies whose place in the list is I - 1, I - 1 + N, I - 1 + 2 N, ...
//! ```
//! The file, `shard.toml`, holds every bit of the tables and charts. TOML, unlike JSON, has numbers
//! that are not finite.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stationary_chart::Chart;
use stationary_measure::{Cell, Column, Precision, Table};

use super::files::Folder;
use super::measure::measure;
use super::{Machine, Outcome, Plan, ReportError};
use crate::study::{Answer, Claim, Entry, Size, Study, StudyError};

/// The name of the file.
pub(super) const FILE: &str = "shard.toml";

/// A share: the I-th of N.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which, from 1.
    pub share: usize,
    /// Of how many.
    pub of: usize,
}

/// A share that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no share; write I/N with 1 <= I <= N, such as 3/8")]
pub struct ShardError(String);

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let wrong = || ShardError(text.to_owned());
        let (share, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let shard = Shard { share: number(share)?, of: number(of)? };
        if (1..=shard.of).contains(&shard.share) { Ok(shard) } else { Err(wrong()) }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.share, self.of)
    }
}

/// What a share leaves for the others to join.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Stored {
    pub(super) shard: Shard,
    pub(super) size: Size,
    /// The studies of all shares, in the order of the page.
    pub(super) ids: Vec<String>,
    pub(super) machine: Machine,
    #[serde(default)]
    pub(super) outcomes: Vec<StoredOutcome>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct StoredOutcome {
    pub(super) id: String,
    seconds: f64,
    result: Result<StoredStudy, String>,
}

#[derive(Debug, Serialize, Deserialize)]
struct StoredStudy {
    title: String,
    conclusion: String,
    table: StoredTable,
    charts: Vec<Chart>,
    claims: Vec<Claim>,
    #[serde(default)]
    answers: Vec<Answer>,
}

#[derive(Debug, Serialize, Deserialize)]
struct StoredTable {
    columns: Vec<(String, StoredPrecision)>,
    rows: Vec<Vec<StoredCell>>,
}

#[derive(Debug, Serialize, Deserialize)]
enum StoredPrecision {
    Exact,
    Rounded(usize, f64),
    Volatile,
}

#[derive(Debug, Serialize, Deserialize)]
enum StoredCell {
    N(f64),
    C(u64),
    T(String),
}

/// Runs a share of the plan and leaves it in the plan's folder.
///
/// # Errors
/// [`ReportError::Unwritable`], before the first study is run if the folder is to blame.
pub fn shard<'a>(plan: &Plan<'a>, shard: Shard) -> Result<Vec<Outcome<'a>>, ReportError> {
    let folder = Folder::open(&plan.out)?;
    let ids = plan.entries.iter().map(|entry| entry.id.to_owned()).collect();
    let entries = plan.entries.iter().skip(shard.share - 1).step_by(shard.of).copied().collect();
    let outcomes = measure(&Plan { entries, ..plan.clone() });
    let stored = Stored {
        shard,
        size: plan.size,
        ids,
        machine: Machine::read(),
        outcomes: outcomes.iter().map(StoredOutcome::of).collect(),
    };
    folder.write(FILE, &toml::to_string(&stored)?)?;
    Ok(outcomes)
}

impl Stored {
    /// Whether its studies are those of the share: the file is not trusted.
    pub(super) fn is_sound(&self) -> bool {
        let Shard { share, of } = self.shard;
        let own = self.outcomes.iter().map(|outcome| &outcome.id);
        (1..=of).contains(&share) && own.eq(self.ids.iter().skip(share - 1).step_by(of))
    }
}

impl StoredOutcome {
    fn of(outcome: &Outcome<'_>) -> Self {
        let result = outcome.result.as_ref().map(StoredStudy::of);
        StoredOutcome {
            id: outcome.entry.id.to_owned(),
            seconds: outcome.wall.as_secs_f64(),
            result: result.map_err(ToString::to_string),
        }
    }

    /// The outcome of the entry.
    pub(super) fn outcome(self, entry: Entry<'_>) -> Outcome<'_> {
        let study = |stored: StoredStudy| Study {
            id: entry.id,
            krate: entry.krate,
            chapter: entry.chapter,
            kind: entry.kind,
            title: stored.title,
            conclusion: stored.conclusion,
            table: stored.table.table(),
            charts: stored.charts,
            claims: stored.claims,
            answers: stored.answers,
        };
        let wall = Duration::try_from_secs_f64(self.seconds).unwrap_or_default();
        Outcome { entry, wall, result: self.result.map(study).map_err(StudyError::Elsewhere) }
    }
}

impl StoredStudy {
    fn of(study: &Study) -> Self {
        StoredStudy {
            title: study.title.clone(),
            conclusion: study.conclusion.clone(),
            table: StoredTable::of(&study.table),
            charts: study.charts.clone(),
            claims: study.claims.clone(),
            answers: study.answers.clone(),
        }
    }
}

impl StoredTable {
    fn of(table: &Table) -> Self {
        let precision = |column: &Column| match column.precision {
            Precision::Exact => StoredPrecision::Exact,
            Precision::Rounded { digits, floor } => StoredPrecision::Rounded(digits, floor),
            Precision::Volatile => StoredPrecision::Volatile,
        };
        let cell = |cell: &Cell| match cell {
            Cell::Number(x) => StoredCell::N(*x),
            Cell::Count(count) => StoredCell::C(*count),
            Cell::Text(text) => StoredCell::T(text.clone()),
        };
        StoredTable {
            columns: table.columns().iter().map(|c| (c.name.clone(), precision(c))).collect(),
            rows: table.rows().iter().map(|row| row.iter().map(cell).collect()).collect(),
        }
    }

    fn table(self) -> Table {
        let column = |(name, precision): (String, StoredPrecision)| match precision {
            StoredPrecision::Exact => Column::exact(&name),
            StoredPrecision::Rounded(digits, floor) => Column::rounded(&name, digits, floor),
            StoredPrecision::Volatile => Column::volatile(&name),
        };
        let cell = |cell| match cell {
            StoredCell::N(x) => Cell::Number(x),
            StoredCell::C(count) => Cell::Count(count),
            StoredCell::T(text) => Cell::Text(text),
        };
        let mut table = Table::new(self.columns.into_iter().map(column));
        for row in self.rows {
            table.push(row.into_iter().map(cell));
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_one_of_some() {
        assert_eq!("3/8".parse(), Ok(Shard { share: 3, of: 8 }));
        for wrong in ["0/3", "4/3", "1/0", "3", "a/b", "-1/2", "1/2/3"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_number_comes_back_bit_for_bit() {
        let numbers = [0.1 + 0.2, -0.0, 5e-324, 1.7e308, 1e22, f64::INFINITY, f64::NEG_INFINITY];
        let mut table = Table::new([Column::rounded("x", 3, 1e-14), Column::volatile("\"t\"\n")]);
        for x in numbers {
            table.push([x.into(), 7_u64.into()]);
        }
        table.push([f64::NAN.into(), "a \"word\"".into()]);
        let text = toml::to_string(&StoredTable::of(&table)).unwrap();
        let back: StoredTable = toml::from_str(&text).unwrap();
        let back = back.table();
        assert_eq!(back.columns(), table.columns());
        for (own, back) in table.rows().iter().zip(back.rows()) {
            match (&own[0], &back[0]) {
                (Cell::Number(x), Cell::Number(y)) if x.is_nan() => assert!(y.is_nan()),
                (Cell::Number(x), Cell::Number(y)) => assert_eq!(x.to_bits(), y.to_bits()),
                other => panic!("{other:?}"),
            }
            assert_eq!(own[1], back[1]);
        }
    }
}
