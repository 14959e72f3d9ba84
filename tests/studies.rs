//! One test a study, made from the list of studies: its table, or its claims alone, as its entry says.
//! Those that take longer than a second are listed as ignored: the report runs them, and so does
//! `cargo test --test studies -- --ignored kepler`.
//!
//! A user's own study is tested in the same way: `insta::assert_snapshot!(convergence.table())`.

use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use stationary_measure::Precision;
use xtask::studies::{CONCLUSIONS, STUDIES};
use xtask::study::{Claim, Entry, Kind, Size, Study, Tested};

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let mut trials: Vec<Trial> = STUDIES.iter().map(trial).collect();
    trials.push(Trial::test("every_study_has_a_name_of_its_own", || {
        every_study_has_a_name_of_its_own();
        Ok(())
    }));
    trials.push(Trial::test("each_crate_has_a_conclusion_that_its_studies_show", || {
        each_crate_has_a_conclusion_that_its_studies_show();
        Ok(())
    }));
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(entry: &'static Entry<'static>) -> Trial {
    let test = move || -> Result<(), Failed> {
        let study = measured(entry);
        if matches!(entry.tested, Tested::Table | Tested::LongTable) {
            insta::assert_snapshot!(entry.id, text(&study));
        }
        Ok(())
    };
    let long = matches!(entry.tested, Tested::LongTable | Tested::ByReport);
    Trial::test(entry.id, test).with_ignored_flag(long)
}

/// The study, whose claims hold.
fn measured(entry: &Entry<'_>) -> Study {
    let study = entry.measure(Size::Default).expect("a study that runs");
    let times = study.table.columns().iter().any(|column| column.precision == Precision::Volatile);
    let id = entry.id;
    assert!(!times || study.kind == Kind::WorkPrecision, "{id} times, beside other studies");
    assert!(study.claims.iter().all(Claim::holds), "{}", claims(&study));
    study
}

fn claims(study: &Study) -> String {
    let claims = study.claims.iter().map(|claim| {
        format!("{} {}", if claim.holds() { "holds:" } else { "BROKEN:" }, claim.text)
    });
    claims.collect::<Vec<_>>().join("\n")
}

/// The text of a study that another processor reproduces.
fn text(study: &Study) -> String {
    format!("{}\n\n{}\n{}", study.title, study.table, claims(study))
}

fn every_study_has_a_name_of_its_own() {
    for (i, entry) in STUDIES.iter().enumerate() {
        assert!(STUDIES[..i].iter().all(|other| other.id != entry.id), "{}", entry.id);
    }
}

fn each_crate_has_a_conclusion_that_its_studies_show() {
    for entry in STUDIES {
        let said = CONCLUSIONS.iter().filter(|conclusion| conclusion.krate == entry.krate).count();
        assert_eq!(said, 1, "{}", entry.krate);
    }
    for conclusion in CONCLUSIONS {
        assert!(!conclusion.shown_by.is_empty(), "{}", conclusion.krate);
        for id in conclusion.shown_by {
            let entry = STUDIES.iter().find(|entry| entry.id == *id);
            assert_eq!(entry.map(|entry| entry.krate), Some(conclusion.krate), "{id}");
        }
    }
}
