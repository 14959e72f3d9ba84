//! The solver of equalities against a singular value decomposition: cost by the number of equations.

use std::hint::black_box;

use nalgebra::{DMatrix, DVector};
use stationary_calculus::DiagonalMetric;
use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_constraints::{
    Constraint, Linear, Multipliers, Redundancy, Rows, Solver, SparseDiagonal,
};
use stationary_measure::{Cell, Column, SplitMix64, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// Time and numbers of a factor against the number of equations.
pub const EQUALITY_COST: Entry<'static> = Entry {
    id: "equality-cost",
    krate: "constraints",
    chapter: "6.5",
    kind: Kind::WorkPrecision,
    title: "Chains, full and redundant equations: cost of one solve against their number",
    tested: Tested::Table,
    run: &study,
};

/// Which equations share freedoms.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// Each with the next.
    Chain,
    /// All with all.
    Full,
    /// A chain, a third of whose equations are sums of two before them.
    Redundant,
}

impl Shape {
    fn name(self) -> &'static str {
        match self {
            Shape::Chain => "chain",
            Shape::Full => "full",
            Shape::Redundant => "redundant chain",
        }
    }

    /// The entries of so many equations, and how many freedoms they have.
    fn rows(self, count: usize) -> (Vec<Vec<(usize, f64)>>, usize) {
        let mut random = SplitMix64::new(28);
        let mut draw = || random.symmetric();
        match self {
            Shape::Chain => {
                let row = |i: usize| (2 * i..2 * i + 4).map(|f| (f, draw())).collect();
                ((0..count).map(row).collect(), 2 * count + 2)
            }
            Shape::Full => {
                let row = |_| (0..2 * count).map(|f| (f, draw())).collect();
                ((0..count).map(row).collect(), 2 * count)
            }
            Shape::Redundant => {
                let (mut rows, freedoms) = Shape::Chain.rows(count - count / 3);
                for i in 0..count / 3 {
                    // Neighbours share two freedoms.
                    let (one, two) = (&rows[2 * i], &rows[2 * i + 1]);
                    let sum = |f: usize| {
                        let of = |row: &[(usize, f64)]| {
                            row.iter().find(|(own, _)| *own == f).map_or(0.0, |(_, a)| *a)
                        };
                        (f, of(one) + of(two))
                    };
                    rows.push((4 * i..4 * i + 6).map(sum).collect());
                }
                (rows, freedoms)
            }
        }
    }
}

struct Dense(DMatrix<f64>);

impl Rows for Dense {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.0[(row, freedom)] += value;
    }
}

/// The shortest multipliers in reference scales by a singular value decomposition of `D^-1 J M^-1/2`.
fn by_singular_values(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let svd = a.clone().svd(true, false);
    let u = svd.u?;
    let largest = svd.singular_values.max();
    let mut along = u.tr_mul(b);
    for (along, sigma) in along.iter_mut().zip(&svd.singular_values) {
        *along = if *sigma > 1e-9 * largest { *along / (sigma * sigma) } else { 0.0 };
    }
    Some(u * along)
}

struct Page {
    table: Table,
    claims: Vec<Claim>,
    charts: Vec<Chart>,
    ratios: Vec<String>,
}

impl Page {
    fn measure(&mut self, shape: Shape, counts: &[usize], most: usize) -> Result<(), StudyError> {
        let (mut own, mut other, mut factors) = (Vec::new(), Vec::new(), Vec::new());
        let mut apart = 0.0_f64;
        for &count in counts {
            let (rows, freedoms) = shape.rows(count);
            let mut random = SplitMix64::new(count as u64);
            let mass: Vec<f64> = (0..freedoms).map(|_| 1.0 + 0.5 * random.symmetric()).collect();
            let metric = DiagonalMetric::new(mass.clone()).map_err(StudyError::at("the masses"))?;
            let equations = rows.into_iter().map(|row| (row, 0.0)).collect();
            let linear = Linear::new(equations).map_err(StudyError::at("the equations"))?;
            let q = vec![0.0; freedoms];
            let mut dense = Dense(DMatrix::zeros(count, freedoms));
            linear.differential(0.0, &q, &mut dense).map_err(StudyError::at("the rows"))?;
            for (f, mass) in mass.iter().enumerate() {
                dense.0.column_mut(f).scale_mut(mass.sqrt().recip());
            }
            let slopes = DVector::from_fn(count, |row, _| linear.scale(row).slope);
            let mut scaled = dense.0.clone();
            for (row, slope) in slopes.iter().enumerate() {
                scaled.row_mut(row).scale_mut(slope.recip());
            }
            // What a velocity asks of redundant equations does not contradict itself.
            let v = DVector::from_fn(freedoms, |_, _| 0.5 * random.symmetric());
            let b = &dense.0 * v;
            let choice = SparseDiagonal(Redundancy::LeastNorm);
            let mut solver = Solver::<Vec<f64>>::analyse(&choice, &metric, &linear, 0.0, &q)
                .map_err(StudyError::at("the analysis"))?;
            let mut lambda = vec![0.0; count];
            let mut solved = Ok(());
            let wall = median_wall(|| {
                lambda.copy_from_slice(b.as_slice());
                solved = solver
                    .prepare(&metric, &linear, 0.0, &q)
                    .and_then(|()| solver.solve(&mut lambda))
                    .and_then(|()| solver.share(&mut lambda));
            });
            solved.map_err(StudyError::at("a solve"))?;
            let (mut far, mut ratio): (Cell, Cell) = ("-".into(), "-".into());
            if count <= most {
                let mut found = None;
                let full = median_wall(|| {
                    found = black_box(by_singular_values(&scaled, &b.component_div(&slopes)))
                });
                let size = lambda.iter().fold(0.0_f64, |size, l| size.max(l.abs()));
                let found = found.map(|found| found.component_div(&slopes));
                let off = found.iter().flat_map(|found| found.iter().zip(&lambda));
                let off = off.fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / size;
                apart = apart.max(off);
                (far, ratio) = (off.into(), (full.median / wall.median).into());
                other.push((count as f64, full.median));
                if count == most {
                    self.ratios.push(format!("{} {:.0}", shape.name(), full.median / wall.median));
                }
            }
            let factor = solver.factor_len();
            let cells: [Cell; 7] = [
                shape.name().into(),
                (count as u64).into(),
                (solver.dependent() as u64).into(),
                (factor as u64).into(),
                far,
                wall.median.into(),
                ratio,
            ];
            self.table.push(cells);
            own.push((count as f64, wall.median));
            factors.push((count as f64, factor as f64));
        }
        let name = shape.name();
        let power = loglog_slope(&factors).unwrap_or(f64::NAN);
        let (expected, band) =
            if shape == Shape::Full { ("2", (1.7, 2.05)) } else { ("1", (0.95, 1.2)) };
        let text = format!("{name}: power of the equations by which the factor grows");
        self.claims.push(Claim::number(text, expected, power, band));
        let text =
            format!("{name}: multipliers, how far from those by singular values, of the largest");
        self.claims.push(Claim::number(text, "rounding", apart, (0.0, 1e-7)));
        let axes = (Axis::log("equations", ""), Axis::log("time of a solve", "s"));
        let chart = Lines::new(name, axes.0, axes.1)
            .with(Series::new("sparse factor that reveals the rank", own))
            .with(Series::new("singular values, dense", other));
        self.charts.push(chart.into());
        Ok(())
    }
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (long, full, most) = match size {
        Size::Default => (&[3, 6, 12, 30, 96, 300, 3_000][..], &[3, 6, 12, 30, 96][..], 96),
        Size::Full => {
            (&[3, 6, 12, 30, 96, 300, 3_000, 30_000][..], &[3, 6, 12, 30, 96, 300][..], 300)
        }
    };
    let mut page = Page {
        table: Table::new([
            Column::exact("equations share"),
            Column::exact("equations"),
            Column::exact("dependent"),
            Column::exact("numbers in the factor"),
            Column::rounded("apart", 1, 1e-8),
            Column::volatile("time [s]"),
            Column::volatile("singular values, times as long"),
        ]),
        claims: Vec::new(),
        charts: Vec::new(),
        ratios: Vec::new(),
    };
    for (shape, counts) in [(Shape::Chain, long), (Shape::Full, full), (Shape::Redundant, long)] {
        page.measure(shape, counts, most)?;
    }
    let Page { table, claims, charts, ratios } = page;
    Ok(Study {
        conclusion: format!(
            "One factorization and one solve, with the force shared among redundant equations. The factor grows with \
             the equations where each meets a few others, and with their square where all meet all. Singular \
             values of the dense rows give the same multipliers; with {most} equations they took, times as long: {}.",
            ratios.join(", ")
        ),
        table,
        charts,
        claims,
        ..EQUALITY_COST.heading()
    })
}
