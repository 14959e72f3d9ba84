//! Frequencies of a bar, a block and two beams against closed forms.

use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::problems::{
    BeamTheory, Ends, bar_frequencies, sliding_block, sliding_block_frequencies, vibrating_bar,
    vibrating_beam,
};
use stationary_elasticity::{
    ElasticityError, LinearSegment, LinearTetrahedron, LinearTriangle, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle,
};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{
    Diagonals, Mesh, MeshError, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, bar,
    cuboid, rectangle,
};
use stationary_modal::ModalError;

use super::lowest::frequencies;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Errors of frequencies against the size of a cell.
pub const STUDY: Entry<'static> = Entry {
    id: "frequencies",
    krate: "modal",
    chapter: "14.2",
    kind: Kind::Convergence,
    title: "Bar, block and beams: error of frequencies against the size of cells",
    tested: Tested::ByReport,
    run: &study,
};

#[derive(Debug, thiserror::Error)]
enum Failed {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Elasticity(#[from] ElasticityError),
    #[error(transparent)]
    Modal(#[from] ModalError),
}

/// A body on meshes of some numbers of cells.
struct Family {
    name: &'static str,
    cells: &'static [usize],
    /// One frequency over the exact one, minus one.
    error: fn(usize) -> Result<f64, Failed>,
    order: f64,
    /// The signs that its errors must have.
    sign: f64,
}

/// Which frequency of the bar and of the block is looked at, counted from zero.
const WHICH: usize = 3;
const BLOCK: [f64; 3] = [1.0, 0.8, 0.6];

fn of_bar(found: &[f64], cells: usize) -> Result<f64, Failed> {
    Ok(found[WHICH] / bar_frequencies(1.0, cells, WHICH + 1)?[0] - 1.0)
}

fn of_block(found: &[f64]) -> Result<f64, Failed> {
    Ok(found[WHICH] / sliding_block_frequencies(BLOCK, WHICH + 1)?[WHICH] - 1.0)
}

const FAMILIES: [Family; 5] = [
    Family {
        name: "bar, linear, lumped mass",
        cells: &[12, 24, 48, 96],
        error: |n| {
            let body = vibrating_bar(LinearSegment, &bar(1.0, n)?)?;
            let found = frequencies::<1>(&body.lumped, &body.solid, &body.q, WHICH + 1)?;
            of_bar(&found, n)
        },
        order: 2.0,
        sign: -1.0,
    },
    Family {
        name: "bar, linear",
        cells: &[12, 24, 48, 96],
        error: |n| {
            let body = vibrating_bar(LinearSegment, &bar(1.0, n)?)?;
            let found = frequencies::<1>(&body.galerkin, &body.solid, &body.q, WHICH + 1)?;
            of_bar(&found, n)
        },
        order: 2.0,
        sign: 1.0,
    },
    Family {
        name: "bar, quadratic",
        cells: &[6, 12, 24, 48],
        error: |n| {
            let mesh = QuadraticSegments::straight(&bar(1.0, n)?);
            let body = vibrating_bar(QuadraticSegment, &mesh)?;
            let found = frequencies::<1>(&body.galerkin, &body.solid, &body.q, WHICH + 1)?;
            of_bar(&found, n)
        },
        order: 4.0,
        sign: 1.0,
    },
    Family {
        name: "block, linear",
        cells: &[4, 6, 8, 12],
        error: |n| {
            let body = sliding_block(LinearTetrahedron, &cuboid(BLOCK, [n; 3])?, BLOCK)?;
            of_block(&frequencies::<3>(&body.galerkin, &body.solid, &body.q, WHICH + 1)?)
        },
        order: 2.0,
        sign: 1.0,
    },
    Family {
        name: "block, quadratic",
        cells: &[2, 3, 4, 6],
        error: |n| {
            let mesh = QuadraticTetrahedra::straight(&cuboid(BLOCK, [n; 3])?);
            let body = sliding_block(QuadraticTetrahedron, &mesh, BLOCK)?;
            of_block(&frequencies::<3>(&body.galerkin, &body.solid, &body.q, WHICH + 1)?)
        },
        order: 4.0,
        sign: 1.0,
    },
];

/// The mesh of a sheet of some cells across it.
fn sheet(height: f64, across: usize) -> Result<Mesh<2, 3>, Failed> {
    let along = (across as f64 / height).round() as usize;
    Ok(rectangle([1.0, height], [along, across], Diagonals::Alternating)?)
}

/// The lowest frequency of a sheet, quadratic elements.
fn beam(ends: Ends, height: f64, across: usize) -> Result<f64, Failed> {
    let mesh = QuadraticTriangles::straight(&sheet(height, across)?);
    let body = vibrating_beam(QuadraticTriangle, &mesh, ends)?;
    Ok(frequencies::<2>(&body.galerkin, &body.solid, &body.q, 1)?[0])
}

type Frequency = fn(Ends, f64, usize) -> Result<f64, Failed>;

/// The same by linear ones.
fn linear_beam(ends: Ends, height: f64, across: usize) -> Result<f64, Failed> {
    let body = vibrating_beam(LinearTriangle, &sheet(height, across)?, ends)?;
    Ok(frequencies::<2>(&body.galerkin, &body.solid, &body.q, 1)?[0])
}

const ENDS: [(&str, Ends); 2] = [("clamped beam", Ends::Clamped), ("free beam", Ends::Free)];
const HEIGHTS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];

/// Beams on finer and finer meshes: cells across them, and across the one that they are held against.
const REFINED: [usize; 3] = [1, 2, 4];
const FINEST: usize = 10;
const REFINED_HEIGHT: f64 = 0.2;

fn study(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("body"),
        Column::rounded("size of a cell", 3, 0.0),
        Column::rounded("error", 3, 1e-10),
    ]);
    let mut claims = Vec::new();
    let waves = convergence(&mut table, &mut claims).map_err(StudyError::at("waves"))?;
    let refined = refined(&mut table, &mut claims).map_err(StudyError::at("refined beams"))?;
    let beams = theories(&mut table, &mut claims).map_err(StudyError::at("beams"))?;
    Ok(Study {
        conclusion: "The fourth frequency of a bar held at one end, and of a block whose faces slide, \
                     against those of waves: linear elements come closer with the square of the size of \
                     a cell, quadratic ones with its fourth power, and Galerkin's mass always from above. \
                     Only the lumped mass of the bar is promised to be below. The same orders hold for a free and for \
                     a clamped beam, against a mesh that is finer still. The lowest frequency of a \
                     sheet against two theories of beams: Euler and Bernoulli's is off by the square \
                     of height over length, Timoshenko's by far less, so that a solid is needed \
                     for stocky beams only."
            .into(),
        table,
        charts: vec![waves.into(), refined.into(), beams.into()],
        claims,
        ..STUDY.heading()
    })
}

fn convergence(table: &mut Table, claims: &mut Vec<Claim>) -> Result<Lines, Failed> {
    let mut chart = Lines::new(
        "Waves in a bar and a block",
        Axis::log("size of a cell", ""),
        Axis::log("relative error of frequency 4", ""),
    );
    for family in FAMILIES {
        let mut points = Vec::new();
        let mut sided = true;
        for &n in family.cells {
            let (h, error) = (1.0 / n as f64, (family.error)(n)?);
            table.push([family.name.into(), h.into(), error.into()]);
            points.push((h, error.abs()));
            sided &= error * family.sign > 0.0;
        }
        let order = family.order;
        claims.push(Claim::number(
            format!("{}: the order of the frequency", family.name),
            format!("{order}"),
            loglog_slope(&points[1..]).unwrap_or(f64::NAN),
            (0.875 * order, 1.1 * order),
        ));
        let side = if family.sign > 0.0 { "above" } else { "below" };
        claims.push(Claim::words(
            format!("{}: on every mesh the frequency is on one side", family.name),
            side,
            if sided { side } else { "on both" },
        ));
        chart = chart.with(Series::new(family.name, points));
    }
    Ok(chart.slope(2.0, (0.03, 3e-3)).slope(4.0, (0.05, 2e-5)))
}

/// Free and clamped sheets on finer and finer meshes, against a mesh that is finer still.
fn refined(table: &mut Table, claims: &mut Vec<Claim>) -> Result<Lines, Failed> {
    let mut chart = Lines::new(
        "Beams on finer meshes",
        Axis::log("cells across", ""),
        Axis::log("relative error of the lowest frequency", ""),
    );
    for (name, ends) in ENDS {
        let exact = beam(ends, REFINED_HEIGHT, FINEST)?;
        let families = [("linear", linear_beam as Frequency), ("quadratic", beam)];
        // At its corners a clamped end is singular, which quadratic elements begin to feel.
        let bands = [(1.75, 2.1), if ends == Ends::Free { (3.6, 4.2) } else { (3.2, 4.2) }];
        for (((element, frequency), order), band) in families.into_iter().zip([2, 4]).zip(bands) {
            let mut points = Vec::new();
            for across in REFINED {
                let error = (frequency(ends, REFINED_HEIGHT, across)? / exact - 1.0).abs();
                let label = format!("{name}, {element}");
                table.push([label.into(), (REFINED_HEIGHT / across as f64).into(), error.into()]);
                points.push((across as f64, error));
            }
            claims.push(Claim::number(
                format!("{name}, {element}: the error falls with a power of the size of a cell"),
                format!("{order}"),
                -loglog_slope(&points[1..]).unwrap_or(f64::NAN),
                band,
            ));
            chart = chart.with(Series::new(&format!("{name}, {element}"), points));
        }
    }
    Ok(chart)
}

fn theories(table: &mut Table, claims: &mut Vec<Claim>) -> Result<Lines, Failed> {
    let mut chart = Lines::new(
        "Beams of growing height",
        Axis::log("height / length", ""),
        Axis::log("relative error of the theory", ""),
    );
    for (name, ends) in ENDS {
        let theories = [
            ("Euler-Bernoulli", BeamTheory::EulerBernoulli, 2.0),
            ("Timoshenko", BeamTheory::Timoshenko, 4.0),
        ];
        let mut sheets = Vec::new();
        for height in HEIGHTS {
            sheets.push((height, beam(ends, height, 4)?));
        }
        for (theory_name, theory, _) in theories {
            let points: Vec<(f64, f64)> = sheets
                .iter()
                .filter_map(|&(height, sheet)| {
                    let exact = theory.frequencies(ends, [1.0, height], 1);
                    exact.first().map(|exact| (height, (exact / sheet - 1.0).abs()))
                })
                .collect();
            let label = format!("{name}, {theory_name}");
            for &(height, error) in &points {
                table.push([label.clone().into(), height.into(), error.into()]);
            }
            if theory == BeamTheory::EulerBernoulli {
                claims.push(Claim::number(
                    format!("{name}: Euler and Bernoulli's error grows with a power of the height"),
                    "2",
                    loglog_slope(&points[1..]).unwrap_or(f64::NAN),
                    (1.8, 2.1),
                ));
            } else {
                claims.push(Claim::number(
                    format!("{name}: Timoshenko's error at a tenth of the length"),
                    "below 0.002",
                    points[1].1,
                    (0.0, 2e-3),
                ));
            }
            chart = chart.with(Series::new(&label, points));
        }
    }
    Ok(chart.slope(2.0, (0.05, 2e-3)))
}
