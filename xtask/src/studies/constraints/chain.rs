//! A chain of rods: what a step costs, link by link.

use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::problems::{RodProblem, writhing_chain};
use stationary_constraints::{ConstrainedIntegrator, Rattle, Solver, SparseDiagonal};
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// Time and work of a step against the number of links.
pub const CHAIN_COST: Entry<'static> = Entry {
    id: "chain-cost",
    krate: "constraints",
    chapter: "6.5",
    kind: Kind::WorkPrecision,
    title: "Chain of 10 to 10,000 links: cost of a step against length",
    tested: Tested::Claims,
    run: &study,
};

/// How fast the links turn, radians a second, and the step.
const RATE: f64 = 100.0;
const STEP: f64 = 1e-4;

fn study(size: Size) -> Result<Study, StudyError> {
    let lengths: &[usize] = match size {
        Size::Default => &[10, 100, 1_000, 10_000],
        Size::Full => &[10, 100, 1_000, 10_000, 100_000],
    };
    let mut table = Table::new([
        Column::exact("links"),
        Column::exact("numbers in the factor"),
        Column::exact("iterations"),
        Column::rounded("violation", 1, 1e-11),
        Column::volatile("time of a step [s]"),
    ]);
    let (mut walls, mut factors, mut most, mut worst) = (Vec::new(), Vec::new(), 0, 0.0_f64);
    for &n in lengths {
        let RodProblem { system, rods, initial } =
            writhing_chain(n, RATE).map_err(StudyError::at("a chain"))?;
        let solver = Solver::<Vec<f64>>::analyse(
            &SparseDiagonal::default(),
            system.metric(),
            &rods,
            0.0,
            &initial.q,
        )
        .map_err(StudyError::at("a chain"))?;
        let mut rattle = Rattle::new(&system, rods, &initial, SparseDiagonal::default())
            .map_err(StudyError::at("a chain"))?;
        let mut state = initial.clone();
        let mut last = rattle.step(&mut state, STEP).map_err(StudyError::at("a step"))?;
        let mut failure = None;
        let mut count = 0_u64;
        // To and fro: RATTLE undoes its steps, and the motion stays as lively as it is.
        let wall = median_wall(|| {
            count += 1;
            if count.is_multiple_of(4) {
                state.p.0.iter_mut().for_each(|p| *p = -*p);
            }
            match rattle.step(&mut state, STEP) {
                Ok(report) => last = report,
                Err(error) => failure = Some(error),
            }
        });
        if let Some(error) = failure {
            return Err(StudyError::at("a step")(error));
        }
        let factor = solver.factor_len();
        let cells: [Cell; 5] = [
            (n as u64).into(),
            (factor as u64).into(),
            u64::from(last.iterations).into(),
            last.violation.into(),
            wall.median.into(),
        ];
        table.push(cells);
        walls.push((n as f64, wall.median));
        factors.push((n as f64, factor as f64));
        most = most.max(last.iterations);
        worst = worst.max(last.violation / (1e-12 + 8.0 * f64::EPSILON * n as f64));
    }
    let claims = vec![
        Claim::number(
            "power of the links by which the factor grows",
            "1",
            loglog_slope(&factors).unwrap_or(f64::NAN),
            (0.98, 1.1),
        ),
        Claim::number("most iterations of a step", "few", f64::from(most), (1.0, 10.0)),
        Claim::number("violation over 1e-12 + 8 eps n", "at most 1", worst, (0.0, 1.0)),
    ];
    let exponent = loglog_slope(&walls).unwrap_or(f64::NAN);
    let axes = (Axis::log("links", ""), Axis::log("time of a step", "s"));
    let chart = Lines::new("", axes.0, axes.1)
        .with(Series::new("RATTLE, sparse multipliers", walls))
        .slope(1.0, (100.0, 1e-4));
    Ok(Study {
        conclusion: format!(
            "Links that turn by up to a hundredth of a radian a step. The multipliers' matrix \
             couples neighbours only, and elimination leaves it so: in this run the time of a step \
             grew as the links to the power {exponent:.2}. The longest chain needs the fewest \
             iterations, because rounding is coarser ten thousand links from the hook."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..CHAIN_COST.heading()
    })
}
