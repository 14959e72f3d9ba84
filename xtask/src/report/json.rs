//! `report.json`: every number of a report, for programs.
//!
//! Numbers that are not finite have no JSON form and are the strings `NaN`, `inf` and `-inf`. A study
//! without a table is one claim that does not hold, with its error as the measured word.

use serde::Serialize;
use stationary_measure::Cell;

use super::{Machine, Outcome};
use crate::study::{Answer, Claim, Evidence, Kind, Study};

#[derive(Serialize)]
struct Report<'a> {
    machine: &'a Machine,
    studies: Vec<StudyNumbers<'a>>,
}

#[derive(Serialize)]
struct StudyNumbers<'a> {
    id: &'a str,
    #[serde(rename = "crate")]
    krate: &'a str,
    chapter: &'a str,
    kind: Kind,
    title: &'a str,
    columns: Vec<&'a str>,
    rows: Vec<Vec<Value<'a>>>,
    claims: Vec<ClaimNumbers<'a>>,
    answers: &'a [Answer],
}

#[derive(Serialize)]
struct ClaimNumbers<'a> {
    text: &'a str,
    expected: &'a str,
    measured: Value<'a>,
    band: Option<[Value<'a>; 2]>,
    holds: bool,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Value<'a> {
    Number(f64),
    Count(u64),
    Text(&'a str),
    Owned(String),
}

impl From<f64> for Value<'_> {
    fn from(x: f64) -> Self {
        if x.is_finite() { Value::Number(x) } else { Value::Owned(x.to_string()) }
    }
}

/// The report as JSON, a study at a time readable by a person too.
pub(super) fn json(machine: &Machine, outcomes: &[Outcome<'_>]) -> serde_json::Result<String> {
    let studies = outcomes.iter().map(study_numbers).collect();
    serde_json::to_string_pretty(&Report { machine, studies }).map(|text| text + "\n")
}

fn study_numbers<'a>(outcome: &'a Outcome<'_>) -> StudyNumbers<'a> {
    let entry = &outcome.entry;
    let (title, columns, rows, claims, answers) = match &outcome.result {
        Ok(study) => (
            study.title.as_str(),
            columns(study),
            rows(study),
            claims(study),
            study.answers.as_slice(),
        ),
        Err(error) => {
            let claim = ClaimNumbers {
                text: "the study runs",
                expected: "a table",
                measured: Value::Owned(error.to_string()),
                band: None,
                holds: false,
            };
            (entry.title, Vec::new(), Vec::new(), vec![claim], &[][..])
        }
    };
    let (id, krate, chapter, kind) = (entry.id, entry.krate, entry.chapter, entry.kind);
    StudyNumbers { id, krate, chapter, kind, title, columns, rows, claims, answers }
}

fn columns(study: &Study) -> Vec<&str> {
    study.table.columns().iter().map(|column| column.name.as_str()).collect()
}

fn rows(study: &Study) -> Vec<Vec<Value<'_>>> {
    let value = |cell| match cell {
        &Cell::Number(x) => x.into(),
        &Cell::Count(count) => Value::Count(count),
        Cell::Text(text) => Value::Text(text),
    };
    study.table.rows().iter().map(|row| row.iter().map(value).collect()).collect()
}

fn claims(study: &Study) -> Vec<ClaimNumbers<'_>> {
    study.claims.iter().map(claim_numbers).collect()
}

fn claim_numbers(claim: &Claim) -> ClaimNumbers<'_> {
    let (measured, band) = match &claim.evidence {
        &Evidence::Number { measured, band: (low, high) } => {
            (measured.into(), Some([low.into(), high.into()]))
        }
        Evidence::Words(words) => (Value::Text(words), None),
    };
    let (text, expected) = (&claim.text, &claim.expected);
    ClaimNumbers { text, expected, measured, band, holds: claim.holds() }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::report::fake;
    use crate::study::Size;

    #[test]
    fn the_shape_is_the_documented_one() {
        let entry = fake::STUDIES[0];
        let result = entry.measure(Size::Default);
        let outcome = Outcome { entry, wall: Duration::ZERO, result };
        let text = json(&Machine::read(), &[outcome]).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        let keys = |value: &serde_json::Value| -> Vec<String> {
            value.as_object().unwrap().keys().cloned().collect()
        };
        assert_eq!(keys(&report), ["machine", "studies"]);
        let study = &report["studies"][0];
        let mut expected =
            ["id", "crate", "chapter", "kind", "title", "columns", "rows", "claims", "answers"]
                .map(String::from);
        expected.sort();
        assert_eq!(keys(study), expected);
        assert_eq!(study["kind"], "work-precision");
        assert_eq!(
            study["rows"][0].as_array().unwrap().len(),
            study["columns"].as_array().unwrap().len()
        );
        let claim = &study["claims"][0];
        let mut expected = ["text", "expected", "measured", "band", "holds"].map(String::from);
        expected.sort();
        assert_eq!(keys(claim), expected);
        assert_eq!(claim["band"].as_array().unwrap().len(), 2);
        assert_eq!(keys(&study["answers"][0]), ["figure", "method", "question"]);
    }

    #[test]
    fn numbers_that_are_not_finite_are_words() {
        let words: Vec<String> = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
            .map(|x| serde_json::to_string(&Value::from(x)).unwrap())
            .to_vec();
        assert_eq!(words, ["\"NaN\"", "\"inf\"", "\"-inf\""]);
    }
}
