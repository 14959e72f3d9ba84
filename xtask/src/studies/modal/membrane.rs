//! NAFEMS FV32: six frequencies of a tapered membrane.

use std::f64::consts::TAU;

use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::problems::{FV32_HERTZ, Vibration, fv32};
use stationary_elasticity::{ElasticityError, LinearTriangle, QuadraticTriangle};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{MeshError, QuadraticTriangles, tapered_membrane};

use super::lowest::frequencies;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Errors of the frequencies against freedoms.
pub const STUDY: Entry<'static> = Entry {
    id: "nafems-fv32",
    krate: "modal",
    chapter: "14.2",
    kind: Kind::Convergence,
    title: "Tapered membrane (NAFEMS FV32): six frequencies against freedoms",
    tested: Tested::Claims,
    run: &study,
};

/// Freedoms, and the six lowest frequencies in hertz.
type Hertz = (usize, [f64; 6]);

const NAMES: [&str; 2] = ["linear triangles", "quadratic triangles"];

/// On a mesh of some cells along and half as many across, by linear and by quadratic triangles.
fn hertz(across: usize) -> Result<[Hertz; 2], StudyError> {
    let mesh = tapered_membrane([2 * across, across])
        .map_err(StudyError::at::<MeshError>("the membrane"))?;
    let elastic = || StudyError::at::<ElasticityError>("the membrane");
    let linear = fv32(LinearTriangle, &mesh).map_err(elastic())?;
    let quadratic = QuadraticTriangles::straight(&mesh);
    let quadratic = fv32(QuadraticTriangle, &quadratic).map_err(elastic())?;
    Ok([lowest(&linear)?, lowest(&quadratic)?])
}

fn lowest<const N: usize, const Q: usize>(body: &Vibration<N, 2, Q>) -> Result<Hertz, StudyError> {
    let found = frequencies::<2>(&body.galerkin, &body.solid, &body.q, 6)
        .map_err(StudyError::at("the modes"))?;
    Ok((body.q.len(), std::array::from_fn(|k| found[k] / TAU)))
}

/// The largest relative distance from the published frequencies.
fn error(hertz: &[f64; 6]) -> f64 {
    hertz.iter().zip(FV32_HERTZ).map(|(f, exact)| (f / exact - 1.0).abs()).fold(0.0, f64::max)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let sizes: &[usize] = match size {
        Size::Default => &[2, 4, 8, 16],
        Size::Full => &[2, 4, 8, 16, 32, 64],
    };
    let mut columns = vec![Column::exact("element"), Column::exact("freedoms")];
    columns.extend((1..7).map(|k| Column::rounded(&format!("f{k} [Hz]"), 5, 0.0)));
    columns.push(Column::rounded("largest error", 2, 1e-6));
    let mut table = Table::new(columns);
    let mut of_families = [Vec::new(), Vec::new()];
    for &n in sizes {
        for (family, found) in of_families.iter_mut().zip(hertz(n)?) {
            family.push(found);
        }
    }
    let mut chart = Lines::new(
        "",
        Axis::log("freedoms", ""),
        Axis::log("largest error of six frequencies", ""),
    );
    for (name, family) in NAMES.iter().zip(&of_families) {
        for (freedoms, hertz) in family {
            let mut row = vec![(*name).into(), (*freedoms as u64).into()];
            row.extend(hertz.iter().map(|&f| f.into()));
            row.push(error(hertz).into());
            table.push(row);
        }
        let points = family.iter().map(|(n, hertz)| (*n as f64, error(hertz)));
        chart = chart.with(Series::new(name, points));
    }
    let [linear, quadratic] = &of_families;
    let finest = quadratic.last().map_or([f64::NAN; 6], |finest| finest.1);
    let falling = |family: &[Hertz]| {
        family.windows(2).all(|pair| pair[1].1.iter().zip(pair[0].1).all(|(f, c)| *f < c))
    };
    let above = falling(linear) && falling(quadratic);
    let points: Vec<_> = linear.iter().map(|(n, f)| (*n as f64, error(f))).collect();
    // Linear triangles have the nodes of quadratic ones of twice the size.
    let (coarse, fine) = (quadratic.iter().rev().nth(1), linear.last());
    let gain = match (coarse, fine) {
        (Some(one), Some(other)) if one.0 == other.0 => error(&other.1) / error(&one.1),
        _ => f64::NAN,
    };
    let mut claims: Vec<Claim> = (0..6)
        .map(|k| {
            let exact = FV32_HERTZ[k];
            Claim::number(
                format!("frequency {} of the finest quadratic mesh [Hz]", k + 1),
                format!("{exact}, within a thousandth"),
                finest[k],
                (exact * 0.999, exact * 1.001),
            )
        })
        .collect();
    claims.push(Claim::words(
        "with Galerkin's mass all frequencies fall from mesh to mesh",
        "all fall",
        if above { "all fall" } else { "some rise" },
    ));
    claims.push(Claim::number(
        "linear triangles: the error falls with a power of the freedoms",
        "-1: the square of a cell's size",
        loglog_slope(&points).unwrap_or(f64::NAN),
        (-1.15, -0.85),
    ));
    claims.push(Claim::number(
        "at equal freedoms, the error of linear over that of quadratic triangles",
        "more than 10",
        gain,
        (10.0, 1e4),
    ));
    Ok(Study {
        conclusion: "A membrane of steel, clamped at its high end: 10 m long, 5 m high at the wall and \
                     1 m at the tip, in plane stress. Quadratic triangles meet the six frequencies that \
                     NAFEMS publishes to a thousandth; linear ones of as many freedoms are off by two \
                     percent. Galerkin's mass comes from above on every mesh; the clamp's corners, where \
                     stress has no bound, keep the last digits coming slowly, and the published figures \
                     end there too."
            .into(),
        table,
        charts: vec![chart.slope(-1.0, (300.0, 0.05)).into()],
        claims,
        ..STUDY.heading()
    })
}
