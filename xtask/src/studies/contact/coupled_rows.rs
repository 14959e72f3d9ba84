//! Joints, dry friction and corners at once: which method finds impulses, and where none does to rounding.

use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Column, SplitMix64, Table};

use super::friction_problems::problem::FrictionProblem;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// What coupled rows and Gauss-Seidel leave, against the number of boxes and the ratio of masses.
pub const COUPLED_ROWS: Entry<'static> = Entry {
    id: "coupled-rows",
    krate: "contact",
    chapter: "11.5.1",
    kind: Kind::Limit,
    title: "Joints and contacts at once: which chains are not settled, by length and ratio of masses",
    tested: Tested::Claims,
    run: &study,
};

/// Boxes of a chain.
const BOXES: [usize; 4] = [2, 4, 8, 16];
/// Masses are within so many powers of ten of 1 kg.
const SPREADS: [f64; 4] = [0.0, 1.5, 3.0, 4.5];
/// Up to here nearly all are to be settled.
const MODERATE: f64 = 1.5;
/// A residual that is rounding, m/s, of velocities of about 0.1 m/s.
const SETTLED: f64 = 1e-10;
/// Sweeps of Gauss-Seidel.
const SWEEPS: usize = 200;

fn study(size: Size) -> Result<Study, StudyError> {
    let count = if size == Size::Full { 100 } else { 6 };
    let mut random = SplitMix64::new(31);
    let mut table = Table::new([
        Column::exact("boxes"),
        Column::exact("largest ratio of masses"),
        Column::exact("led to by Newton"),
        Column::exact("pivots"),
        Column::exact("interior point"),
        Column::exact("sweeps"),
        Column::exact("not settled"),
        Column::rounded("systems, the middle one", 2, 0.0),
        Column::rounded("residual [m/s], the middle one", 1, 1e-10),
        Column::rounded("the worst", 1, 1e-10),
        Column::rounded("200 sweeps alone, the middle one", 1, 1e-10),
    ]);
    let axes = (Axis::log("largest ratio of masses", ""), Axis::linear("part not settled", ""));
    let mut chart = Lines::new("Chains that no method settles to 1e-10 m/s", axes.0, axes.1);
    let (mut moderate, mut settled, mut honest) = (0, 0, 0);
    for boxes in BOXES {
        let mut curve = Vec::new();
        for spread in SPREADS {
            let ratio = 10.0_f64.powf(2.0 * spread);
            let (mut methods, mut unsettled) = ([0_u64; 4], 0_u64);
            let [mut systems, mut residuals, mut swept] = [const { Vec::new() }; 3];
            for k in 0..count {
                let name = format!("joints-{k}");
                let problem = FrictionProblem::of_joints(name, boxes, spread, &mut random)
                    .map_err(StudyError::at("a chain"))?;
                let (x, report) = problem.solve(SETTLED).map_err(StudyError::at("a chain"))?;
                let residual = problem.residual(&x);
                match report.settled {
                    true => methods[report.method as usize] += 1,
                    false => unsettled += 1,
                }
                // Measured apart, by impulses alone: as the report says, but for the rounding of what is light.
                let said = report.residual.max(report.friction_residual);
                honest += usize::from(residual <= 10.0 * said + 1e-16 * ratio + 1e-12);
                systems.push(report.solved as f64);
                residuals.push(residual);
                swept.push(problem.residual(&problem.gauss_seidel(0.0, SWEEPS).0));
            }
            if spread <= MODERATE {
                moderate += count;
                settled += count - unsettled as usize;
            }
            curve.push((ratio, unsettled as f64 / count as f64));
            let worst = residuals.iter().copied().fold(0.0, f64::max);
            let mut cells = vec![(boxes as u64).into(), ratio.into()];
            cells.extend(methods.map(Into::into));
            cells.push(unsettled.into());
            let [systems, residual, swept] = [systems, residuals, swept].map(middle);
            cells.extend([systems, residual, worst, swept].map(Into::into));
            table.push(cells);
        }
        chart = chart.with(Series::new(&format!("{boxes} boxes"), curve));
    }
    let all = (count * BOXES.len() * SPREADS.len()) as f64;
    Ok(Study {
        conclusion: "Boxes on ball joints with dry friction land on a floor with all of their corners: more rows \
                     than freedoms, at their reach of friction. Newton's method alone leads to an answer in short \
                     chains; pivots find some of the others, and an interior point nearly all, but for long \
                     chains whose masses are 1e6 and more apart. What no method settles is said."
            .to_owned(),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "part of the chains that are settled to 1e-10 m/s, up to a ratio of masses of 1,000",
                "at least 0.95",
                settled as f64 / moderate as f64,
                (0.95, 1.0),
            ),
            Claim::number(
                "part of the chains whose residual, measured apart, is what is said",
                "1",
                honest as f64 / all,
                (1.0, 1.0),
            ),
        ],
        ..COUPLED_ROWS.heading()
    })
}

/// The number in the middle.
fn middle(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of.get(of.len() / 2).copied().unwrap_or_default()
}
