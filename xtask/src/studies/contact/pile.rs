//! A row of balls runs into a wall and stops: three solvers on a growing number of contacts.

use stationary_calculus::{Column, DiagonalMetric, Table, Vector, loglog_slope};
use stationary_contact::{ContactError, ContactRows, Impact, ImpactLaw, InverseMass};

use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};

/// Work of each solver against the number of balls.
pub const PILE_SOLVERS: Entry<'static> = Entry {
    id: "pile-solvers",
    krate: "contact",
    chapter: "11.5.1",
    kind: Kind::WorkPrecision,
    title: "Stopping a pile",
    run: &study,
};

/// Approach that counts as stopped, m/s.
const STOPPED: f64 = 1e-10;

/// Balls of unequal masses in a row against a wall, all moving at 1 m/s towards it, inelastic.
fn pile(balls: usize) -> Result<Impact, ContactError> {
    let masses: Vec<f64> = (0..balls).map(|ball| 1.0 + 0.5 * (ball as f64).sin()).collect();
    let metric = DiagonalMetric::new(masses).map_err(|_| ContactError::Mass { freedom: 0 })?;
    let mut rows = ContactRows::new();
    rows.push([(0, 1.0)]);
    (1..balls).for_each(|ball| rows.push([(ball - 1, -1.0), (ball, 1.0)]));
    Impact::new(rows, &InverseMass::of(&metric)?, vec![0.0; balls])
}

/// Passes until nothing approaches by more than [`STOPPED`], what approach is left, and contacts or
/// systems solved.
fn stop(law: ImpactLaw, impact: &Impact, bound: usize) -> Result<[f64; 3], ContactError> {
    let mut v = Vector(vec![-1.0; impact.len()]);
    let (mut passes, mut solves) = (0, 0);
    while impact.approach(v.view()) > STOPPED && passes < bound {
        match law.apply_within(impact, 1, v.view_mut()) {
            Ok(report) => solves += report.solves,
            Err(ContactError::NotConverged { velocity, .. }) => {
                v.0 = velocity;
                solves += impact.len();
            }
            Err(error) => return Err(error),
        }
        passes += 1;
    }
    Ok([passes as f64, impact.approach(v.view()), solves as f64])
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (sizes, bound): (&[usize], usize) = match size {
        Size::Default => (&[2, 4, 8, 16, 32, 64], 100_000),
        Size::Full => (&[2, 4, 8, 16, 32, 64, 128, 256], 3_000_000),
    };
    let mut table = Table::new([
        Column::exact("solver"),
        Column::exact("balls"),
        Column::exact("passes"),
        Column::rounded("approach left [m/s]", 2, 1e-12),
        Column::exact("contacts or systems solved"),
    ]);
    let axes = (Axis::log("balls", ""), Axis::log("passes", ""));
    let mut chart = Lines::new("Passes until everything has stopped", axes.0, axes.1);
    let mut claims = Vec::new();
    for law in [ImpactLaw::GaussSeidel, ImpactLaw::Inelastic] {
        let name = law.facts().name;
        let (mut points, mut left) = (Vec::new(), 0.0_f64);
        for &balls in sizes {
            let impact = pile(balls).map_err(StudyError::at("a pile"))?;
            let [passes, approach, solves] =
                stop(law, &impact, bound).map_err(StudyError::at(name))?;
            left = left.max(approach);
            points.push((balls as f64, passes));
            let counts = [passes, solves].map(|count| count as u64);
            table.push([
                name.into(),
                (balls as u64).into(),
                counts[0].into(),
                approach.into(),
                counts[1].into(),
            ]);
        }
        claims.push(if law == ImpactLaw::Inelastic {
            let most = points.iter().map(|p| p.1).fold(0.0, f64::max);
            Claim::number("passes of the projection, however many balls", "1", most, (1.0, 1.0))
        } else {
            let slope = loglog_slope(&points[points.len() / 2..]).unwrap_or(f64::NAN);
            let text = "power of the number of balls with which Gauss-Seidel's passes grow";
            Claim::number(text, "2", slope, (1.8, 2.1))
        });
        let text = format!("{name}: approach left, m/s");
        claims.push(Claim::number(text, "below 1e-10", left, (0.0, STOPPED)));
        chart = chart.with(Series::new(name, points));
    }
    let impact = pile(3).map_err(StudyError::at("a pile"))?;
    let [_, left, _] = stop(ImpactLaw::Jacobi, &impact, 1_000).map_err(StudyError::at("jacobi"))?;
    table.push(["jacobi".into(), 3_u64.into(), 1_000_u64.into(), left.into(), 3_000_u64.into()]);
    Ok(Study {
        id: PILE_SOLVERS.id,
        krate: PILE_SOLVERS.krate,
        chapter: PILE_SOLVERS.chapter,
        kind: PILE_SOLVERS.kind,
        title: PILE_SOLVERS.title.into(),
        conclusion: "Balls of unequal masses in a row run into a wall without restitution. \
                     Gauss-Seidel hands their momentum on one contact at a time and needs passes that \
                     grow with the square of their number; the projection stops them all at once, to \
                     rounding. Jacobi's impulses count shared balls twice; what is left of the \
                     approach of three balls is in the table."
            .into(),
        table,
        charts: vec![chart.slope(2.0, (16.0, 1e3)).into()],
        claims,
    })
}
