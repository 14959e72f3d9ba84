//! A study: a table that a person wants to see, its charts, and the claims that it proves or breaks.

use std::error::Error;
use std::fmt;

use serde::{Deserialize, Serialize};
use stationary_chart::{Chart, ChartError, significant};
use stationary_measure::Table;

/// How much of a study to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Size {
    /// Short horizons, so that the whole report ends within three minutes.
    Default,
    /// Horizons as long as the claims deserve.
    Full,
}

/// What a study compares with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Error of a finite difference against its step.
    Derivative,
    /// Error against step or mesh size.
    Convergence,
    /// Error against cost. Studies of this kind run alone, so that they can time.
    WorkPrecision,
    /// Energy, momentum or global error against time.
    LongRun,
    /// What survives in a plane of two parameters.
    StabilityMap,
    /// Error against cost over models of growing fidelity.
    Ladder,
    /// Where a method or a model gives way, along one parameter.
    Limit,
    /// What is said where there is no answer.
    Errors,
    /// Promises on random cases.
    Trials,
}

impl Kind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Kind; 9] = [
        Kind::Derivative,
        Kind::Convergence,
        Kind::WorkPrecision,
        Kind::LongRun,
        Kind::StabilityMap,
        Kind::Ladder,
        Kind::Limit,
        Kind::Errors,
        Kind::Trials,
    ];

    /// The kind in words, for a reader.
    pub fn words(self) -> &'static str {
        match self {
            Kind::Derivative => "derivative",
            Kind::Convergence => "convergence",
            Kind::WorkPrecision => "work-precision",
            Kind::LongRun => "long run",
            Kind::StabilityMap => "stability map",
            Kind::Ladder => "ladder",
            Kind::Limit => "limit",
            Kind::Errors => "errors",
            Kind::Trials => "trials",
        }
    }
}

/// What `cargo test` asks of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tested {
    /// Its table, which is the same on every processor, and its claims.
    Table,
    /// Its claims.
    Claims,
    /// Its table and its claims where ignored tests are asked for: it takes longer than a second.
    LongTable,
    /// Nothing: it takes longer than a second, or it times. The report says whether its claims hold.
    ByReport,
}

/// What a run measured.
#[derive(Clone, Debug)]
pub struct Study {
    /// Name in kebab-case, also of the files: `kepler-work-precision`.
    pub id: &'static str,
    /// The crate whose promise this is: `integrators`.
    pub krate: &'static str,
    /// The chapter of the notes, or a topic.
    pub chapter: &'static str,
    /// What is compared with what.
    pub kind: Kind,
    /// The heading.
    pub title: String,
    /// The caption: what to conclude, in words.
    pub conclusion: String,
    /// The measured numbers.
    pub table: Table,
    /// Pictures of the table.
    pub charts: Vec<Chart>,
    /// What the numbers must show.
    pub claims: Vec<Claim>,
    /// What the numbers answer to who asks for a method. They stand on the page's first screen.
    pub answers: Vec<Answer>,
}

/// Which method for which question, in words that are made of the run's own numbers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// What is asked: `Orbits with close encounters, to 1e-9`.
    pub question: String,
    /// Which method to take.
    pub method: String,
    /// The figure that shows it: `at 0.35 of the evaluations of dormand-prince-853`.
    pub figure: String,
}

/// A sentence that the run's numbers prove or break.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Claim {
    /// The sentence, true when it holds.
    pub text: String,
    /// What theory says, in words or as a number.
    pub expected: String,
    /// What the run says.
    pub evidence: Evidence,
}

/// What a run says to a claim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Evidence {
    /// A number that must lie in a band, ends included.
    Number {
        /// The number.
        measured: f64,
        /// The smallest and the largest number that prove the claim.
        band: (f64, f64),
    },
    /// Words that must equal the expected words.
    Words(String),
}

impl Evidence {
    /// The measured number or words, for a reader.
    pub fn words(&self) -> String {
        match self {
            Evidence::Number { measured, .. } => significant(*measured, 4),
            Evidence::Words(words) => words.clone(),
        }
    }
}

impl Claim {
    /// A claim on a number.
    pub fn number(
        text: impl Into<String>,
        expected: impl Into<String>,
        measured: f64,
        band: (f64, f64),
    ) -> Self {
        let evidence = Evidence::Number { measured, band };
        Claim { text: text.into(), expected: expected.into(), evidence }
    }

    /// A claim on words: the methods on a front, the lowest rung that meets a tolerance.
    pub fn words(
        text: impl Into<String>,
        expected: impl Into<String>,
        measured: impl Into<String>,
    ) -> Self {
        let evidence = Evidence::Words(measured.into());
        Claim { text: text.into(), expected: expected.into(), evidence }
    }

    /// Whether the run proves the claim. A number that is not finite proves nothing.
    pub fn holds(&self) -> bool {
        match &self.evidence {
            Evidence::Number { measured, band: (low, high) } => {
                measured.is_finite() && low <= measured && measured <= high
            }
            Evidence::Words(measured) => *measured == self.expected,
        }
    }
}

/// What measures a study. Several may run side by side.
pub type Measure<'a> = dyn Fn(Size) -> Result<Study, StudyError> + Sync + 'a;

/// A study that can be run.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    /// Name in kebab-case, also of the files.
    pub id: &'static str,
    /// The crate whose promise this is.
    pub krate: &'static str,
    /// The chapter of the notes, or a topic.
    pub chapter: &'static str,
    /// What is compared with what.
    pub kind: Kind,
    /// The heading: what was measured on what.
    pub title: &'static str,
    /// What `cargo test` asks of it.
    pub tested: Tested,
    /// Measures.
    pub run: &'a Measure<'a>,
}

impl Entry<'_> {
    /// A study under this heading, in which nothing was found yet.
    pub fn heading(&self) -> Study {
        Study {
            id: self.id,
            krate: self.krate,
            chapter: self.chapter,
            kind: self.kind,
            title: self.title.to_owned(),
            conclusion: String::new(),
            table: Table::new([]),
            charts: Vec::new(),
            claims: Vec::new(),
            answers: Vec::new(),
        }
    }

    /// Runs the study and checks that it is the one which the list announces.
    ///
    /// # Errors
    /// What the study returns, [`StudyError::Chart`] and [`StudyError::Mislabelled`].
    pub fn measure(&self, size: Size) -> Result<Study, StudyError> {
        let study = (self.run)(size)?;
        let labels = [
            ("id", self.id, study.id),
            ("crate", self.krate, study.krate),
            ("chapter", self.chapter, study.chapter),
            ("kind", self.kind.words(), study.kind.words()),
        ];
        study.charts.iter().try_for_each(Chart::check)?;
        match labels.into_iter().find(|(_, listed, own)| listed != own) {
            Some((label, listed, own)) => Err(StudyError::Mislabelled { label, listed, own }),
            None => Ok(study),
        }
    }
}

impl fmt::Debug for Entry<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Entry").field("id", &self.id).finish_non_exhaustive()
    }
}

/// Why a study has no table.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A library call failed where the study needs it to succeed.
    #[error("{stage}: {source}")]
    Library {
        /// What the study was doing.
        stage: String,
        /// The library's own error.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A number that everything else rests on is not finite.
    #[error("{what} is {value}")]
    NotFinite {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
    },
    /// It was measured elsewhere, and failed there.
    #[error("{0}")]
    Elsewhere(String),
    /// A chart says what no drawing can show.
    #[error("a chart: {0}")]
    Chart(#[from] ChartError),
    /// The list of studies and the study disagree on what it is.
    #[error("the list says {label} `{listed}`, the study says `{own}`")]
    Mislabelled {
        /// Which label.
        label: &'static str,
        /// The list's word.
        listed: &'static str,
        /// The study's word.
        own: &'static str,
    },
}

impl StudyError {
    /// Wraps a library's error: `orbit.solve().map_err(StudyError::at("the reference orbit"))?`.
    pub fn at<E: Error + Send + Sync + 'static>(
        stage: impl Into<String>,
    ) -> impl FnOnce(E) -> StudyError {
        let stage = stage.into();
        |source| StudyError::Library { stage, source: Box::new(source) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(measured: f64) -> Claim {
        Claim::number("order two", "2", measured, (1.9, 2.1))
    }

    #[test]
    fn a_number_holds_inside_its_band_and_on_its_ends() {
        assert!(order(1.9).holds() && order(2.0).holds() && order(2.1).holds());
        assert!(!order(1.899).holds() && !order(2.101).holds());
    }

    #[test]
    fn a_number_that_is_not_finite_proves_nothing() {
        assert!(!order(f64::NAN).holds());
        let unbounded = Claim::number("grows", "", f64::INFINITY, (1.0, f64::INFINITY));
        assert!(!unbounded.holds());
    }

    #[test]
    fn words_hold_when_they_are_the_expected_words() {
        assert!(Claim::words("cheapest", "verlet", "verlet").holds());
        assert!(!Claim::words("cheapest", "verlet", "rk4").holds());
    }

    #[test]
    fn a_study_that_is_not_the_listed_one_is_an_error() {
        fn other(_: Size) -> Result<Study, StudyError> {
            Ok(Study {
                id: "other",
                krate: "calculus",
                chapter: "2",
                kind: Kind::Derivative,
                title: String::new(),
                conclusion: String::new(),
                table: Table::new([]),
                charts: Vec::new(),
                claims: Vec::new(),
                answers: Vec::new(),
            })
        }
        let entry = Entry {
            id: "one",
            krate: "calculus",
            chapter: "2",
            kind: Kind::Derivative,
            title: "",
            tested: Tested::ByReport,
            run: &other,
        };
        let error = entry.measure(Size::Default).unwrap_err();
        assert_eq!(error.to_string(), "the list says id `one`, the study says `other`");
    }
}
