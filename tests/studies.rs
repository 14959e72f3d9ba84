//! Snapshots of the studies' tables and claims: every deterministic number of the report.
//!
//! A user's own study is tested in the same way: `insta::assert_snapshot!(convergence.table())`.

use stationary_measure::Precision;
use xtask::studies::STUDIES;
use xtask::study::{Kind, Size};

/// The text of a study that another processor reproduces.
fn text(id: &str) -> String {
    let entry = STUDIES.iter().find(|entry| entry.id == id).expect("a listed study");
    let study = entry.measure(Size::Default).expect("a study that runs");
    let times = study.table.columns().iter().any(|column| column.precision == Precision::Volatile);
    assert!(!times || study.kind == Kind::WorkPrecision, "{id} times, beside other studies");
    let claims: Vec<String> = study
        .claims
        .iter()
        .map(|claim| format!("{} {}", if claim.holds() { "holds:" } else { "BROKEN:" }, claim.text))
        .collect();
    assert!(study.claims.iter().all(xtask::study::Claim::holds), "{}", claims.join("\n"));
    format!("{}\n\n{}\n{}", study.title, study.table, claims.join("\n"))
}

macro_rules! snapshots {
    ($($name:ident: $id:literal),+ $(,)?) => {
        $(
            #[test]
            fn $name() {
                insta::assert_snapshot!(text($id));
            }
        )+
    };
}

snapshots! {
    derivative_check: "derivative-check",
    newton_wrong_derivatives: "newton-wrong-derivatives",
    newton_initial_guesses: "newton-initial-guesses",
    one_step: "one-step",
    pendulum_convergence: "pendulum-convergence",
    table_4_1: "table-4-1",
    constraint_failures: "constraint-failures",
}

/// Cells beside a border may turn with the last bit, and long runs take long: their claims are
/// tested, their tables are not.
#[test]
fn the_claims_of_the_other_quick_studies_hold() {
    for id in [
        "oscillator-stability",
        "spring-pendulum-stability",
        "kepler-long-run",
        "step-control",
        "multiscale-stability",
        "newmark-damping",
        "kepler-high-orders",
        "pendulum-high-orders",
        "henon-heiles-convergence",
        "stability-regions",
        "damping-stability",
        "action-boundary-value",
        "impulse-limit",
        "modes-needed",
        "modes-large-motion",
        "rotation-accuracy",
        "rods-or-rigid-body",
        "tennis-racket",
        "nodding-top",
        "kovalevskaya-top",
        "box-on-its-corner",
        "impact-laws",
        "bouncing-ball",
        "contact-penalty",
        "tunnelling",
        "pile-solvers",
        "friction-threshold",
        "masonry-arch",
        "laplacian-spectrum",
        "heat-border",
        "heat-work-precision",
        "maximum-principle",
        "geodesic-distance",
    ] {
        text(id);
    }
}

#[test]
fn every_study_has_a_name_of_its_own() {
    for (i, entry) in STUDIES.iter().enumerate() {
        assert!(STUDIES[..i].iter().all(|other| other.id != entry.id), "{}", entry.id);
    }
}

#[test]
fn each_kind_of_trial_has_a_row_and_a_claim() {
    let entry = STUDIES.iter().find(|entry| entry.id == "trials").expect("a listed study");
    let study = entry.measure(Size::Default).expect("a study that runs");
    let kinds = stationary_trials::Kind::all().count();
    assert_eq!([study.table.rows().len(), study.claims.len()], [kinds; 2]);
}
