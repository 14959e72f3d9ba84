//! How many modes an answer needs.

use stationary_calculus::Covector;
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_modal::problems::fixed_chain;
use stationary_modal::{Answer, Linearized, RigidMotions};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of a chain's answer against the number of modes.
pub const STUDY: Entry<'static> = Entry {
    id: "modes-needed",
    krate: "modal",
    chapter: "14.3",
    kind: Kind::Ladder,
    title: "Pushed chain: error against the number of modes, by load",
    tested: Tested::Claims,
    run: &study,
};

const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];

fn study(size: Size) -> Result<Study, StudyError> {
    let (masses, count) = match size {
        Size::Default => (399, 300),
        Size::Full => (1999, 600),
    };
    let middle = masses / 2;
    let problem = fixed_chain(masses).map_err(StudyError::at("the chain"))?;
    let mut chain = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12)
        .map_err(StudyError::at("the chain"))?;
    let modes = chain.lowest(count, &RigidMotions::none()).map_err(StudyError::at("the modes"))?;
    let point: Vec<f64> = (0..masses).map(|i| if i == middle { 1.0 } else { 0.0 }).collect();
    let loads = [("load everywhere", vec![1.0; masses]), ("load at a point", point.clone())];
    let mut table = Table::new([
        Column::exact("load"),
        Column::exact("modes"),
        Column::rounded("error", 3, 1e-11),
    ]);
    let mut chart =
        Lines::new("", Axis::log("modes", ""), Axis::log("error of the middle's displacement", ""));
    let mut claims = Vec::new();
    for ((name, load), power) in loads.iter().zip([-3.0, -1.0]) {
        let answer: Answer = chain
            .answer(&modes, Covector(load), Covector(&point))
            .map_err(StudyError::at(*name))?;
        // The middle takes part in every other mode only.
        let points: Vec<(f64, f64)> =
            (1..=count).step_by(2).map(|n| (n as f64, answer.errors[n])).collect();
        for n in [1, 3, 9, 31, 99, 299] {
            table.push([(*name).into(), (n as u64).into(), answer.errors[n].into()]);
        }
        let fitted: Vec<_> = points
            .iter()
            .copied()
            .filter(|&(n, _)| (9.0..0.15 * masses as f64).contains(&n))
            .collect();
        claims.push(Claim::number(
            format!("{name}: the error falls like a power of the number of modes"),
            format!("{power}"),
            loglog_slope(&fitted).unwrap_or(f64::NAN),
            (power - 0.2, power + 0.2),
        ));
        for tolerance in TOLERANCES {
            let least = answer.least_modes(tolerance);
            table.push([
                format!("{name}, least for {tolerance:e}").into(),
                least.map_or_else(|| "more".into(), |least| (least as u64).into()),
            ]);
        }
        chart = chart.with(Series::new(name, points));
    }
    Ok(Study {
        conclusion: format!(
            "A chain of {masses} masses between two walls, pushed everywhere or in the middle, and \
             the error of the middle's displacement with the lowest modes only. A load that reaches \
             far is met by a few modes; a load at a point needs ten times as many for each digit."
        ),
        table,
        charts: vec![chart.slope(-3.0, (10.0, 3e-5)).slope(-1.0, (10.0, 0.15)).into()],
        claims,
        ..STUDY.heading()
    })
}
