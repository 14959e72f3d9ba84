//! What a check says: where everything agrees, or which entry is wrong and by how much.

use std::fmt;

use super::differences::Differences;
use crate::{Readable, SizeError};

/// A derivative that can be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derivative {
    /// dV of a potential.
    Differential,
    /// d2V of a potential.
    Hessian,
    /// The matrix of the differential of a function with several numbers as its value.
    Jacobian,
    /// dV or d2V: they do not go together, and the energy is too noisy to tell which is wrong.
    DifferentialOrHessian,
}

impl fmt::Display for Derivative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Derivative::Differential => "differential",
            Derivative::Hessian => "Hessian",
            Derivative::Jacobian => "Jacobian",
            Derivative::DifferentialOrHessian => "differential or the Hessian",
        })
    }
}

/// What was checked and found right.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One part for each derivative.
    pub agreements: Vec<Agreement>,
}

/// A derivative that agrees with differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Which derivative.
    pub derivative: Derivative,
    /// The number of freedoms.
    pub freedoms: usize,
    /// How many configurations it was checked at, the given one included.
    pub configurations: usize,
    /// Entries off by less than this, relative to the largest of their row, may have stayed unseen.
    pub unseen: f64,
    /// The differences along the freedom of the largest entry at the given configuration, with
    /// errors relative to it.
    pub differences: Differences,
}

impl Report {
    /// The largest [`Agreement::unseen`]: how blind the check was.
    pub fn unseen(&self) -> f64 {
        self.agreements.iter().map(|part| part.unseen).fold(0.0, f64::max)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in &self.agreements {
            let Agreement { derivative, freedoms, configurations, unseen, differences } = part;
            // A power of ten, so that the text is the same on every processor.
            let decade = 10_f64.powf((unseen.log10() - 0.2).ceil());
            writeln!(
                f,
                "{derivative}: right at {configurations} configurations of {freedoms} freedoms, \
                 but for errors below about {decade:.0e} of a row's largest entry"
            )?;
            write!(f, "{differences}")?;
        }
        Ok(())
    }
}

/// An entry of a derivative that disagrees with differences.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongEntry {
    /// Which derivative.
    pub derivative: Derivative,
    /// The row: 0 for a differential, which has only one.
    pub row: usize,
    /// The column: the freedom that is varied.
    pub column: usize,
    /// What the code says.
    pub claimed: f64,
    /// What differences say.
    pub measured: f64,
    /// How far differences may be off.
    pub uncertainty: f64,
    /// Where another derivative gives it away, the freedom along which: the differential's slope is
    /// `claimed`; `measured` is that of the energy's, or of the freedom's own component, which ought to be
    /// the same; and the Hessian agrees with it.
    pub along: Option<usize>,
    /// How many other entries (of more than 32 freedoms: other rows) are known to be wrong as well.
    pub others: usize,
    /// The configuration.
    pub q: Vec<f64>,
    /// 0 for the given configuration, else the number of the random one.
    pub configuration: usize,
    /// The errors of differences against the claim, relative to the row's largest entry.
    pub differences: Differences,
}

impl fmt::Display for WrongEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let WrongEntry { derivative, row, column, claimed, measured, uncertainty, .. } = self;
        match derivative {
            Derivative::Differential => {
                writeln!(f, "the differential is wrong at freedom {column}")?;
                if let Some(along) = self.along {
                    writeln!(f, "  its slope  along freedom {along}, against what it has to be:")?;
                }
            }
            _ => writeln!(f, "the {derivative} is wrong at row {row}, column {column}")?,
        }
        writeln!(f, "  claimed   {claimed:.6e}")?;
        writeln!(f, "  measured  {measured:.6e}, within {uncertainty:.0e}")?;
        writeln!(f, "  off by    {:.3e}", claimed - measured)?;
        if *claimed != 0.0 {
            writeln!(f, "  measured  {:.6} times the claim", measured / claimed)?;
        }
        match self.configuration {
            0 => writeln!(f, "  where     at the given configuration")?,
            number => writeln!(f, "  where     at random configuration {number}, a move away")?,
        }
        if self.others > 0 {
            writeln!(f, "  as well   {} others", self.others)?;
        }
        writeln!(f, "  q         {}", shown(&self.q))?;
        writeln!(f, "errors of differences against the claim, over the row's largest entry:")?;
        write!(f, "{}", self.differences.table())
    }
}

/// The first dozen numbers, with every digit.
fn shown(q: &[f64]) -> String {
    let numbers: Vec<String> = q.iter().take(12).map(|x| format!("{x:?}")).collect();
    let rest = if q.len() > numbers.len() { ", ..." } else { "" };
    format!("[{}{rest}]", numbers.join(", "))
}

/// A derivative that is wrong, or cannot be checked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DerivativeError {
    /// The configuration, or what a function gave, has the wrong size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Something is not finite at a configuration where the energy is.
    #[error("{what} is not finite, first at place {place}, where q is {}", shown(q))]
    NotFinite {
        /// What is not finite: "the energy", "the differential", ...
        what: &'static str,
        /// The first bad place: a freedom, or a row.
        place: usize,
        /// The configuration.
        q: Vec<f64>,
    },
    /// A setting of the check is no number that it can use.
    #[error("the {setting} is {value}; it must be {rule}", value = Readable(value))]
    Setting {
        /// Which setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// The differential is written over what was there, where it has to be added.
    #[error(
        "the differential is assigned at freedom {freedom}, where it must be added to what is there"
    )]
    Assigned {
        /// The freedom.
        freedom: usize,
    },
    /// The Hessian's blocks are not the same, in the same order, at every configuration.
    #[error(
        "block {block} of the Hessian is not where it was at the given configuration, where q is {}",
        shown(q)
    )]
    PatternChanged {
        /// The first block that differs, counted from 0.
        block: usize,
        /// The configuration.
        q: Vec<f64>,
    },
    /// A block of k freedoms, at least one, has k x k entries.
    #[error("block {block} of the Hessian has {entries} entries for {freedoms} freedoms")]
    BlockSize {
        /// The block, counted from 0.
        block: usize,
        /// Its entries.
        entries: usize,
        /// Its freedoms.
        freedoms: usize,
    },
    /// A block of the Hessian names a freedom that the potential does not have.
    #[error("the Hessian has a block at freedom {freedom}, but there are only {freedoms} freedoms")]
    UnknownFreedom {
        /// The freedom.
        freedom: usize,
        /// How many there are.
        freedoms: usize,
    },
    /// A block of the Hessian is not symmetric.
    #[error(
        "a block of the Hessian is not symmetric: entry ({row}, {column}) is {entry}, its mirror {mirror}",
        entry = Readable(entry), mirror = Readable(mirror)
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
        /// The entry at (column, row) of the same block.
        mirror: f64,
    },
    /// An entry disagrees with differences.
    #[error("{0}")]
    Wrong(Box<WrongEntry>),
}
