//! Where each way fails, and what it says then.

use stationary_calculus::{Covector, Number};
use stationary_constraints::problems::{RodProblem, four_bar, pendulum, square};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedIntegrator, ConstraintError, Level, LevelSet, Projection, Rattle,
    Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// The failures.
pub const WHERE_THEY_FAIL: Entry<'static> = Entry {
    id: "constraint-failures",
    krate: "constraints",
    chapter: "6",
    kind: Kind::Errors,
    title: "Eleven calls on constraints without an answer, or nearly: what each one says",
    tested: Tested::Table,
    run: &|_| study(),
};

/// `(|x|^2 - 1)^2`: zero on the circle, and so is its differential.
#[derive(Clone, Debug)]
struct Squared;

impl Level<2> for Squared {
    fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
        (x * x + y * y - 1.0).powi(2)
    }
}

/// The kind of an error, in words.
fn words<T>(result: Result<T, ConstraintError>) -> &'static str {
    match result {
        Ok(_) => "done",
        Err(ConstraintError::Singular { .. }) => "not of full rank",
        Err(ConstraintError::NotConverged { .. } | ConstraintError::Diverged { .. }) => {
            "no feasible configuration found"
        }
        Err(ConstraintError::TooFast { .. }) => "too fast for its angle",
        Err(ConstraintError::Infeasible { .. }) => "not feasible",
        Err(_) => "another error",
    }
}

fn cases() -> Result<Vec<(&'static str, &'static str, &'static str)>, ConstraintError> {
    let few = SparseDiagonal(Redundancy::Refuse);
    let RodProblem { system, rods, initial } = pendulum(1.9)?.problem;
    let mut cases = Vec::new();
    let project = |q: [f64; 2]| {
        let mut state = State::new(q, Covector([0.0; 2]));
        let mut projection = Projection::new(&system, &rods, &state, few)?;
        projection.project(&mut state)
    };
    cases.push(("projection from twice the rod's length", "done", words(project([1.2, -1.6]))));
    let centre = words(project([0.0, 0.0]));
    cases.push(("projection from the circle's centre", "not of full rank", centre));
    let far = words(project([60.0, -80.0]));
    cases.push(("projection from a hundred rods away", "no feasible configuration found", far));
    let step = |h: f64| {
        let mut state = initial.clone();
        Rattle::new(&system, &rods, &initial, few)?.step(&mut state, h)
    };
    cases.push(("RATTLE, a tenth of a second", "done", words(step(0.1))));
    let long = words(step(3.0));
    cases.push(("RATTLE, three seconds", "no feasible configuration found", long));
    let squared = Rattle::new(&system, LevelSet::new(0, Squared), &initial, few);
    cases.push(("the square of a constraint", "not of full rank", words(squared)));
    let moved = State::new([0.0, -1.001], Covector([0.0; 2]));
    let moved = Rattle::new(&system, &rods, &moved, few);
    cases.push(("a rod that starts stretched", "not feasible", words(moved)));
    let twice = square(2, 1.0, [0.0; 2])?;
    let refused = Rattle::new(&twice.system, &twice.rods, &twice.initial, few);
    cases.push(("a square with both diagonals", "not of full rank", words(refused)));
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let shared = Rattle::new(&twice.system, &twice.rods, &twice.initial, shared);
    cases.push(("the same, sharing its force", "done", words(shared)));
    let linkage = four_bar(1.0, 1.0)?.problem;
    let regular = Rattle::new(&linkage.system, &linkage.rods, &linkage.initial, few);
    cases.push(("a four-bar linkage", "done", words(regular)));
    let angle = ArcsinePendulum::new(1.0, 1.0, 1.0)?;
    let fast = words(angle.step(&mut State::new([0.0], Covector([2.5])), 0.5));
    cases.push(("the angle, h speed/L = 1.25", "too fast for its angle", fast));
    Ok(cases)
}

fn study() -> Result<Study, StudyError> {
    let cases = cases().map_err(StudyError::at("a case"))?;
    let mut table = Table::new([Column::exact("case"), Column::exact("outcome")]);
    let mut claims = Vec::new();
    for (case, expected, outcome) in cases {
        table.push([case.into(), outcome.into()]);
        claims.push(Claim::words(case, expected, outcome));
    }
    Ok(Study {
        conclusion: "Each failure is an error of its own kind, and leaves the state as it was. No \
                     case returns numbers that only look like an answer."
            .into(),
        table,
        charts: Vec::new(),
        claims,
        ..WHERE_THEY_FAIL.heading()
    })
}
