//! The largest eigenvalue, from above and from below, by what it costs.

use std::cell::Cell;

use stationary_calculus::{Covector, Metric, Potential, ProductSink, Sink, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_laplacian::problems::square;
use stationary_laplacian::{Heat, HeatMethod, LaplacianError, largest_eigenvalue};
use stationary_measure::{Column, SplitMix64, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error and products against vertices.
pub const STUDY: Entry<'static> = Entry {
    id: "largest-eigenvalue",
    krate: "laplacian",
    chapter: "15.3",
    kind: Kind::Convergence,
    title: "Largest eigenvalue of a square, from above and from below: error and cost against vertices",
    tested: Tested::ByReport,
    run: &study,
};

/// What is met is off by rounding.
const MET: f64 = 1e-12;
/// Vertices of the largest square on which no eigenvalues crowd below the largest so that they hide it.
const UNCROWDED: f64 = 4225.0;
/// Steps of heat at the border that a value promises, and cells a side.
const STEPS: usize = 4000;
const CELLS: usize = 32;

/// An energy that counts how often its Hessian is asked for.
struct Counted<'a, P> {
    energy: &'a P,
    products: Cell<usize>,
}

impl<P: Potential> Potential for Counted<'_, P> {
    fn dim(&self) -> usize {
        self.energy.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.energy.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.energy.add_differential(q, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.products.set(self.products.get() + 1);
        self.energy.add_hessian(q, hessian);
    }
}

/// A value from above, and the products that it took.
fn from_above(
    metric: &impl Metric,
    energy: &impl Potential,
) -> Result<(f64, usize), LaplacianError> {
    let counted = Counted { energy, products: Cell::new(0) };
    let above = largest_eigenvalue(metric, &counted)?;
    Ok((above, counted.products.get()))
}

/// Rayleigh's quotient after so many products with a random function: from below.
fn power_iteration(metric: &impl Metric, energy: &impl Potential, products: usize) -> f64 {
    let n = metric.dim();
    let mut random = SplitMix64::new(3);
    let mut x: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
    let mut quotient = 0.0;
    for _ in 0..products {
        let size = metric.inner(Vector(&x), Vector(&x)).sqrt();
        x.iter_mut().for_each(|x| *x /= size);
        let (mut dv, mut next) = (Covector(vec![0.0; n]), Vector(vec![0.0; n]));
        if let Some(mut sink) = ProductSink::new(1.0, &x, &mut dv.0) {
            energy.add_hessian(&x, &mut sink);
        }
        quotient = dv.apply(&Vector(&x));
        metric.sharp(dv.view(), next.view_mut());
        x = next.0;
    }
    quotient
}

/// How large heat is at last, of a start no larger than 1, in explicit steps at the border that a value promises.
fn at_the_border(value: f64) -> Result<f64, LaplacianError> {
    let domain = square(CELLS)?.domain;
    let metric = domain.lumped()?;
    let mut heat =
        Heat::new(&metric, domain.dirichlet(), HeatMethod::ExplicitEuler, 1.0, 2.0 / value)?;
    let mut random = SplitMix64::new(4);
    let mut f: Vec<f64> = (0..domain.dim()).map(|_| random.symmetric()).collect();
    for _ in 0..STEPS {
        if heat.step(&mut f).is_err() {
            return Ok(f64::INFINITY);
        }
    }
    Ok(f.iter().fold(0.0, |most, x| most.max(x.abs())))
}

/// Both masses on one square: the vertices, by how much the value from above is too high and that from below too low,
/// in parts of it, and the products that each took.
struct Row {
    vertices: f64,
    lumped: [f64; 2],
    exact: f64,
    products: [usize; 2],
    /// What an explicit step is bounded by from above and from below.
    values: [f64; 2],
}

fn row(n: usize) -> Result<Row, LaplacianError> {
    let domain = square(n)?.domain;
    let energy = domain.dirichlet();
    let (lumped, exact) = (domain.lumped()?, domain.galerkin()?);
    // Of vertices of four and of eight triangles by turns the largest eigenvalues are known.
    let known = [9.0, 36.0].map(|rate| rate * (n * n) as f64);
    let (above, products) = from_above(&lumped, energy)?;
    let below = power_iteration(&lumped, energy, products);
    let (of_exact, more) = from_above(&exact, energy)?;
    Ok(Row {
        vertices: domain.dim() as f64,
        lumped: [above / known[0] - 1.0, 1.0 - below / known[0]],
        exact: of_exact / known[1] - 1.0,
        products: [products, more],
        values: [above, below],
    })
}

fn study(size: Size) -> Result<Study, StudyError> {
    let sizes: &[usize] = match size {
        Size::Default => &[4, 8, 16, CELLS, 64, 128],
        Size::Full => &[4, 8, 16, CELLS, 64, 128, 256],
    };
    let mut table = Table::new([
        Column::exact("vertices"),
        Column::exact("products, lumped mass"),
        Column::rounded("lumped mass: too high, a part", 2, MET),
        Column::rounded("power iteration: too low, a part", 2, MET),
        Column::exact("products, exact mass"),
        Column::rounded("exact mass: too high, a part", 2, MET),
    ]);
    let [mut lumped, mut exact, mut power] = [const { Vec::new() }; 3];
    let mut products = [const { Vec::new() }; 2];
    let [mut kept, mut grown] = [f64::NAN; 2];
    for &n in sizes {
        let row = row(n).map_err(StudyError::at("the largest eigenvalue"))?;
        table.push([
            (row.vertices as u64).into(),
            (row.products[0] as u64).into(),
            row.lumped[0].into(),
            row.lumped[1].into(),
            (row.products[1] as u64).into(),
            row.exact.into(),
        ]);
        lumped.push((row.vertices, row.lumped[0]));
        power.push((row.vertices, row.lumped[1]));
        exact.push((row.vertices, row.exact));
        for (points, count) in products.iter_mut().zip(row.products) {
            points.push((row.vertices, count as f64));
        }
        if n == CELLS {
            [kept, grown] = [
                at_the_border(row.values[0]).map_err(StudyError::at("heat"))?,
                at_the_border(row.values[1]).map_err(StudyError::at("heat"))?,
            ];
        }
    }
    let least = |points: &[(f64, f64)]| points.iter().fold(f64::INFINITY, |x, p| x.min(p.1));
    let most = |points: &mut dyn Iterator<Item = &(f64, f64)>| {
        points.fold(f64::NEG_INFINITY, |x, p| x.max(p.1))
    };
    let lowest = least(&lumped).min(least(&exact));
    let met = most(&mut lumped.iter().chain(exact.iter().filter(|p| p.0 <= UNCROWDED)));
    let crowded = most(&mut exact.iter().filter(|p| p.0 > UNCROWDED));
    let too_low = least(&power);
    let drawn = |points: &[(f64, f64)]| {
        points.iter().map(|&(x, off)| (x, off.max(MET))).collect::<Vec<_>>()
    };
    let vertices = || Axis::log("vertices", "");
    let errors = Lines::new("Error", vertices(), Axis::log("off, a part of the eigenvalue", ""))
        .with(Series::new("lumped mass, from above", drawn(&lumped)))
        .with(Series::new("exact mass, from above", drawn(&exact)))
        .with(Series::new("lumped mass, power iteration, from below", drawn(&power)));
    let [of_lumped, of_exact] = products;
    let costs = Lines::new("Cost", vertices(), Axis::log("products of the matrix", ""))
        .with(Series::new("lumped mass", of_lumped))
        .with(Series::new("exact mass", of_exact));
    Ok(Study {
        conclusion: format!(
            "The largest eigenvalue of a square's Laplacian, which bounds an explicit step, beside the known one; errors \
             below {MET:e} are drawn as that. Lanczos and rows together meet it. Where more than {UNCROWDED} \
             vertices have the exact mass, 400 products do not tell it from the many below, and it is bounded by \
             chance, a tenth of a percent too high. Power iteration of as many products is from below, by more \
             than a part of {:.0e}: {STEPS} explicit steps at the border that it promises on {CELLS} x {CELLS} cells \
             let heat grow to {grown:.0e}, and those of the value from above do not.",
            1e-4
        ),
        table,
        charts: vec![errors.into(), costs.into()],
        claims: vec![
            Claim::number(
                "no value is below the eigenvalue; the lowest is too high by a part of",
                "zero to rounding",
                lowest,
                (-MET, MET),
            ),
            Claim::number(
                "lumped masses, and exact ones on few vertices, have it met: too high by at most a part of",
                "below 1e-12",
                met,
                (-MET, MET),
            ),
            Claim::number(
                "where eigenvalues crowd below it, it is too high by at most a part of",
                "a quarter of a percent",
                crowded,
                (1e-6, 2.5e-3),
            ),
            Claim::number(
                "power iteration of as many products is too low by a part of more than",
                "1e-4",
                too_low,
                (1e-4, 1.0),
            ),
            Claim::number(
                "heat of size 1 in explicit steps at the border of the value from above stays below",
                "1",
                kept,
                (0.0, 1.0),
            ),
            Claim::number(
                "at that of the value from below it grows beyond",
                "1e3",
                grown,
                (1e3, f64::INFINITY),
            ),
        ],
        ..STUDY.heading()
    })
}
