//! Eigenvalues of four domains against those of the continuum.

use stationary_chart::{Axis, Lines, Series};
use stationary_laplacian::problems::{
    Spectral, disc, interval, lumped_interval_spectrum, sphere, square,
};
use stationary_laplacian::{LaplacianError, lowest_modes};
use stationary_measure::{Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Relative error of an eigenvalue against mesh size.
pub const STUDY: Entry<'static> = Entry {
    id: "laplacian-spectrum",
    krate: "laplacian",
    chapter: "15.2-15.3",
    kind: Kind::Convergence,
    title: "Line, square, disc and sphere: error of eigenvalues against mesh size",
    tested: Tested::Claims,
    run: &study,
};

/// The error of an eigenvalue, exact mass and lumped, relative to its size; signed.
fn errors<const D: usize, const K: usize>(
    problem: &Spectral<D, K>,
    mode: usize,
) -> Result<[f64; 2], LaplacianError> {
    let exact = problem.spectrum[mode];
    let galerkin = lowest_modes(&problem.domain, &problem.domain.galerkin()?, mode + 2)?;
    let lumped = lowest_modes(&problem.domain, &problem.domain.lumped()?, mode + 2)?;
    Ok([galerkin, lumped].map(|modes| modes.values()[mode] / exact - 1.0))
}

/// Mesh sizes with the signed errors for both masses.
type Errors = Vec<(f64, [f64; 2])>;

fn domains(finer: u32) -> Result<[(&'static str, Errors); 4], LaplacianError> {
    let levels = || 0..3 + finer;
    let mut all = [const { Vec::new() }; 4];
    for level in levels() {
        let n = 12_usize << level;
        all[0].push((1.0 / n as f64, errors(&interval(n)?, 3)?));
        let n = 6_usize << level;
        all[1].push((1.0 / n as f64, errors(&square(n)?, 4)?));
        all[2].push((1.0 / n as f64, errors(&disc(n)?, 5)?));
        // The icosahedron's edge is 1.05 radii.
        all[3].push((1.05 / f64::from(2 << level), errors(&sphere(1 + level as usize)?, 4)?));
    }
    let [line, plate, drum, ball] = all;
    Ok([
        ("interval, mode 3", line),
        ("square, mode 4", plate),
        ("disc with its rim held, mode 5", drum),
        ("sphere, mode 4", ball),
    ])
}

/// Segments of the interval whose whole spectrum is looked at.
const SEGMENTS: usize = 100;

/// All eigenvalues of the lumped interval against their closed form: numbered, relative to the largest.
fn closed_form() -> Result<(Vec<(f64, f64)>, f64), LaplacianError> {
    let problem = interval(SEGMENTS)?;
    let exact = lumped_interval_spectrum(SEGMENTS);
    let modes = lowest_modes(&problem.domain, &problem.domain.lumped()?, SEGMENTS + 1)?;
    let off = |k: usize| (modes.values()[k] - exact[k]).abs();
    let points = (1..=SEGMENTS).map(|k| (k as f64, off(k) / exact[SEGMENTS])).collect();
    let lowest = (1..10).map(|k| off(k) / exact[k]).fold(0.0, f64::max);
    Ok((points, lowest))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let finer = match size {
        Size::Default => 0,
        Size::Full => 2,
    };
    let mut table = Table::new([
        Column::exact("domain"),
        Column::rounded("mesh size", 4, 0.0),
        Column::rounded("error, exact mass", 3, 1e-10),
        Column::rounded("error, lumped mass", 3, 1e-10),
    ]);
    let mut chart = Lines::new(
        "One eigenvalue against its known value",
        Axis::log("mesh size", ""),
        Axis::log("relative error of the eigenvalue, exact mass", ""),
    );
    let mut claims = Vec::new();
    for (name, rows) in domains(finer).map_err(StudyError::at("the spectra"))? {
        for (h, [galerkin, lumped]) in &rows {
            table.push([name.into(), (*h).into(), (*galerkin).into(), (*lumped).into()]);
        }
        let points: Vec<_> = rows.iter().map(|&(h, [error, _])| (h, error.abs())).collect();
        claims.push(Claim::number(
            format!("{name}: the error falls with the square of the mesh size"),
            "2",
            loglog_slope(&points[1..]).unwrap_or(f64::NAN),
            (1.9, 2.1),
        ));
        if name.starts_with("interval") {
            let signs = rows.iter().all(|(_, [above, below])| *above > 0.0 && *below < 0.0);
            let side = if signs { "exact above, lumped below" } else { "otherwise" };
            claims.push(Claim::words(
                "on the interval the two masses bracket the eigenvalue",
                "exact above, lumped below",
                side,
            ));
        }
        chart = chart.with(Series::new(name, points));
    }
    let (points, lowest) = closed_form().map_err(StudyError::at("the lumped interval"))?;
    let worst = points.iter().map(|point| point.1).fold(0.0, f64::max);
    claims.push(Claim::number(
        format!(
            "lumped interval of {SEGMENTS} segments: all off its closed form, over the largest"
        ),
        "at most 1e-13",
        worst,
        (0.0, 1e-13),
    ));
    claims.push(Claim::number(
        "lumped interval: the ten lowest off their closed form, each over itself",
        "at most 1e-10",
        lowest,
        (0.0, 1e-10),
    ));
    let discrete = Lines::new(
        "The whole spectrum of a lumped interval against its closed form",
        Axis::log("number of the eigenvalue", ""),
        Axis::log("error over the largest eigenvalue", ""),
    )
    .with(Series::new("difference", points.into_iter().filter(|point| point.1 > 0.0)));
    Ok(Study {
        conclusion: "Eigenvalues of linear elements against n^2 pi^2 (with the pi that the notes \
                     leave out), sums of two of these, squared zeros of Bessel's functions and \
                     l (l + 1). All fall with the square of the mesh size, whether what is \
                     approximated is the function alone or, on disc and sphere, the shape too. The \
                     discrete spectrum of the lumped interval, 4 N^2 sin^2(k pi / 2N), is met to \
                     rounding from the first to the last; what is met exactly is left out of the chart."
            .into(),
        table,
        charts: vec![chart.slope(2.0, (0.05, 2e-3)).into(), discrete.into()],
        claims,
        ..STUDY.heading()
    })
}
