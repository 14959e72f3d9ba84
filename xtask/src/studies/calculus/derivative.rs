//! Figure 2.1: the error of a finite difference against its step.

use stationary_calculus::{Vector, differences, hat, hat_differential};
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// The derivative of the hat function, right and wrong.
pub const FIGURE_2_1: Entry<'static> = Entry {
    id: "derivative-check",
    krate: "calculus",
    chapter: "2.5",
    kind: Kind::Derivative,
    title: "Finite differences of q/|q|: error against the step, of a right and of a wrong derivative",
    tested: Tested::Table,
    run: &|_| study(),
};

/// Where the derivative is checked, and along which direction.
const AT: [f64; 3] = [0.8, -0.5, 1.1];
const ALONG: [f64; 3] = [0.3, 0.9, -0.4];

/// The relative error planted in one entry of the wrong derivative.
const PLANTED: f64 = 1e-4;

fn study() -> Result<Study, StudyError> {
    let steps: Vec<f64> = (0..=48).map(|i| 10.0_f64.powf(-f64::from(i) / 3.0)).collect();
    let f = |q: &[f64]| hat([q[0], q[1], q[2]]).to_vec();
    let right = hat_differential(&AT.into());
    let mut wrong = right;
    wrong[(1, 1)] *= 1.0 + PLANTED;
    let dynamic =
        |df: nalgebra::Matrix3<f64>| nalgebra::DMatrix::from_column_slice(3, 3, df.as_slice());
    let along = Vector(ALONG);
    let stage = || StudyError::at("the hat function");
    let right = differences(f, &dynamic(right), &AT, along.view(), &steps).map_err(stage())?;
    let wrong = differences(f, &dynamic(wrong), &AT, along.view(), &steps).map_err(stage())?;
    // Cancellation is noise: below this times 1/step, another processor prints other digits.
    let mut table = Table::new([
        Column::rounded("step", 3, 0.0),
        Column::rounded("forward", 2, 1e-7),
        Column::rounded("centred", 2, 1e-9),
        Column::rounded("forward, wrong entry", 2, 1e-7),
        Column::rounded("centred, wrong entry", 2, 1e-9),
    ]);
    for (right, wrong) in right.rows().iter().zip(wrong.rows()) {
        table.push([
            right.step.into(),
            right.forward.into(),
            right.centred.into(),
            wrong.forward.into(),
            wrong.centred.into(),
        ]);
    }
    let chart = Lines::new("", Axis::log("difference step", ""), Axis::log("relative error", ""))
        .with(Series::new("forward", right.rows().iter().map(|row| (row.step, row.forward))))
        .with(Series::new("centred", right.rows().iter().map(|row| (row.step, row.centred))))
        .with(Series::new(
            "centred, one wrong entry",
            wrong.rows().iter().map(|row| (row.step, row.centred)),
        ))
        .slope(1.0, (1e-3, 3e-3))
        .slope(2.0, (1e-3, 2e-7));
    let slope = |slope: Option<f64>| slope.unwrap_or(f64::NAN);
    let floor =
        |rows: &stationary_calculus::Differences| rows.floor().map_or(f64::NAN, |row| row.centred);
    Ok(Study {
        conclusion: format!(
            "Finite differences of q/|q| against its differential. Where the differential is right, \
             the error of a forward difference falls with slope 1 and that of a centred one with \
             slope 2, until cancellation takes over and both rise again. With one entry off by \
             {PLANTED:e} the error stops at a plateau instead: that is what the check looks for."
        ),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "slope of the forward error",
                "1",
                slope(right.forward_slope()),
                (0.95, 1.05),
            ),
            Claim::number(
                "slope of the centred error",
                "2",
                slope(right.centred_slope()),
                (1.95, 2.05),
            ),
            Claim::number("smallest centred error", "below 1e-9", floor(&right), (0.0, 1e-9)),
            Claim::number(
                "smallest centred error with one entry off by 1e-4",
                "about 1e-4",
                floor(&wrong),
                (1e-6, 1e-3),
            ),
        ],
        ..FIGURE_2_1.heading()
    })
}
