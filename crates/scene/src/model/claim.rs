//! What a scene claims of its own run, each with the source that says so.
//!
//! ```text
//! |m - s| <= w        m what is measured, s what is said, w the band within which it must be
//! ```

use std::ops::Range;

/// The part of the horizon by which a time may miss that of a sample.
pub(crate) const SAME_TIME: f64 = 1e-9;

/// A sentence about a run that is true or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What is measured.
    pub of: Measured,
    /// s: what it is said to be; zero of a drift and of a rise.
    pub is: f64,
    /// w: how far off it may be.
    pub within: f64,
    /// Where the sentence is from.
    pub source: String,
    /// The horizon of the file: samples up to there are looked at, also of a run that goes on.
    pub until: f64,
}

/// A number of a run. Columns are those of [`Run::observed`](crate::Run::observed).
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// A column at a time.
    Value {
        /// The column.
        column: usize,
        /// The time of a sample.
        time: f64,
    },
    /// The least number of a column.
    Least {
        /// The column.
        column: usize,
    },
    /// The largest number of a column.
    Largest {
        /// The column.
        column: usize,
    },
    /// The most by which a column is above any earlier sample of itself.
    Rise {
        /// The column.
        column: usize,
    },
    /// The largest distance of an observable from where it started.
    Drift {
        /// Its columns.
        columns: Range<usize>,
        /// What it is divided by.
        over: Scale,
    },
    /// The time of the first event of a kind.
    Time(Event),
}

/// What a drift is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Nothing.
    One,
    /// The largest kinetic energy.
    KineticEnergy,
    /// The largest sum of the magnitudes of momenta.
    LinearMomentum,
    /// The largest sum of the magnitudes of momenta times places.
    AngularMomentum,
    /// The largest magnitude of the observable itself.
    Itself,
}

/// Something that happens at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Things meet.
    FirstImpact,
    /// A rod breaks.
    FirstBreak,
}
