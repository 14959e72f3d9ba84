//! Newton's method against wrong derivatives and far guesses.

use stationary_calculus::{newton_against_initial_guesses, newton_against_wrong_derivatives};
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Cell, Table};

use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// Iterations against an injected error of the derivative.
pub const WRONG_DERIVATIVES: Entry<'static> = Entry {
    id: "newton-wrong-derivatives",
    krate: "calculus",
    chapter: "4.4",
    kind: Kind::Convergence,
    title: "Newton's method: iterations against the error of its derivative",
    tested: Tested::Table,
    run: &|_| wrong_derivatives(),
};

/// Iterations and outcome against the initial guess.
pub const INITIAL_GUESSES: Entry<'static> = Entry {
    id: "newton-initial-guesses",
    krate: "calculus",
    chapter: "4.4",
    kind: Kind::Convergence,
    title: "Newton's method: iterations and root against the initial guess",
    tested: Tested::Table,
    run: &|_| initial_guesses(),
};

/// The numbers of a column, NaN where a cell has none.
fn numbers(table: &Table, column: usize) -> Vec<f64> {
    let number = |row: &Vec<Cell>| match row[column] {
        Cell::Number(x) => x,
        Cell::Count(n) => n as f64,
        Cell::Text(_) => f64::NAN,
    };
    table.rows().iter().map(number).collect()
}

fn wrong_derivatives() -> Result<Study, StudyError> {
    let table = newton_against_wrong_derivatives();
    let (errors, iterations) = (numbers(&table, 0), numbers(&table, 1));
    let points = |sign: f64| {
        let pairs = errors.iter().zip(&iterations).filter(move |(e, _)| sign * **e > 0.0);
        pairs.map(|(e, n)| (e.abs(), *n)).collect::<Vec<_>>()
    };
    let chart = Lines::new(
        "",
        Axis::log("size of the relative error of the derivative", ""),
        Axis::log("iterations to rounding", ""),
    )
    .with(Series::new("derivative too large", points(1.0)))
    .with(Series::new("derivative too small", points(-1.0)));
    let at = |error: f64| {
        let found = errors.iter().zip(&iterations).find(|(e, _)| **e == error);
        found.map_or(f64::NAN, |(_, n)| *n)
    };
    let exact = at(0.0);
    let claims = vec![
        Claim::number("iterations with the exact derivative", "a handful", exact, (1.0, 7.0)),
        Claim::number(
            "iterations with an error of 1e-4, more than with none",
            "a few",
            at(1e-4) - exact,
            (0.0, 4.0),
        ),
        Claim::number(
            "iterations with an error of one half: more than the dozen of the notes",
            "more than 12",
            at(0.5),
            (13.0, 100.0),
        ),
    ];
    Ok(Study {
        conclusion: "One implicit Euler step of a pendulum, solved to rounding with a derivative \
                     that is off by a factor. A small error costs nothing, an error of a tenth \
                     doubles the work, and a derivative wrong by half still finds the root: the \
                     answer looks right, and only the count of iterations tells. That is why more \
                     than a dozen iterations in a step are reported as suspect."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..WRONG_DERIVATIVES.heading()
    })
}

fn initial_guesses() -> Result<Study, StudyError> {
    let table = newton_against_initial_guesses();
    let (stiffness, guesses) = (numbers(&table, 0), numbers(&table, 1));
    let (iterations, roots) = (numbers(&table, 2), numbers(&table, 4));
    // The table has the small step first, then the large one.
    let (soft, stiff): (Vec<usize>, Vec<usize>) =
        (0..roots.len()).partition(|&i| stiffness[i] == stiffness[0]);
    let series = |name: &str, rows: &[usize]| {
        let mut points: Vec<_> =
            rows.iter().map(|&i| (guesses[i].abs().max(0.1), iterations[i])).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series::new(name, points)
    };
    let chart = Lines::new(
        "",
        Axis::log("size of the guess (0.1 or less at the left)", "rad"),
        Axis::log("iterations to rounding", ""),
    )
    .with(series("one root", &soft))
    .with(series("several roots", &stiff));
    let spread = |rows: &[usize]| {
        let found = rows.iter().map(|&i| roots[i]);
        let (least, most) =
            found.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| (a.min(q), b.max(q)));
        most - least
    };
    let claims = vec![
        Claim::number(
            "spread of the roots found where there is one, rad",
            "rounding",
            spread(&soft),
            (0.0, 1e-10),
        ),
        Claim::number(
            "spread of the roots found where there are several, rad",
            "more than 1: the guess decides",
            spread(&stiff),
            (1.0, f64::INFINITY),
        ),
        Claim::number(
            "most iterations from any guess",
            "bounded by 200",
            iterations.iter().copied().fold(0.0, f64::max),
            (1.0, 200.0),
        ),
    ];
    Ok(Study {
        conclusion:
            "The same step from guesses near and far. A small step has one root, and the line \
             search finds it from every guess in the table. A large step has several: an implicit \
             step is no longer unique, the guess decides which root is taken, and from far away \
             the search may stall, which it says."
                .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..INITIAL_GUESSES.heading()
    })
}
