//! Sheets in the plane: a published stress, the deflection of a beam, and locking.

use std::time::Instant;

use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::problems::{Beam, LE1_STRESS, SheetFamily, elliptic_membrane_stress};
use stationary_elasticity::{ElasticityError, Lame};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::Diagonals;

use crate::studies::cheapest::Asked;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// NAFEMS LE1: error of a stress against freedoms.
pub const MEMBRANE: Entry<'static> = Entry {
    id: "nafems-le1",
    krate: "elasticity",
    chapter: "13.2",
    kind: Kind::Convergence,
    title: "Elliptic membrane (NAFEMS LE1): error of the stress against freedoms",
    tested: Tested::Claims,
    run: &membrane,
};

/// A beam's deflection: error against freedoms and time.
pub const CANTILEVER: Entry<'static> = Entry {
    id: "cantilever-work",
    krate: "elasticity",
    chapter: "13.2",
    kind: Kind::WorkPrecision,
    title: "Bent beam: error of linear and quadratic elements against freedoms and time",
    tested: Tested::Claims,
    run: &cantilever,
};

/// A beam's deflection as the material becomes incompressible.
pub const LOCKING: Entry<'static> = Entry {
    id: "locking",
    krate: "elasticity",
    chapter: "13.2",
    kind: Kind::Limit,
    title: "Nearly incompressible beam: deflection against Poisson's ratio",
    tested: Tested::Claims,
    run: &locking,
};

const FAMILIES: [(&str, SheetFamily); 2] =
    [("linear triangles", SheetFamily::Linear), ("quadratic triangles", SheetFamily::Quadratic)];

fn membrane(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("element"),
        Column::exact("freedoms"),
        Column::rounded("sigma_yy [MPa]", 4, 0.0),
        Column::rounded("error", 2, 1e-5),
    ]);
    let mut chart = Lines::new("", Axis::log("freedoms", ""), Axis::log("error of the stress", ""));
    let mut finest = Vec::new();
    for (name, family) in FAMILIES {
        let mut points = Vec::new();
        for n in [2, 4, 8, 16] {
            let sheet = elliptic_membrane_stress(family, [2 * n, 3 * n])
                .map_err(StudyError::at("the membrane"))?;
            let error = (sheet.value / LE1_STRESS - 1.0).abs();
            table.push([
                name.into(),
                (sheet.freedoms as u64).into(),
                (1e-6 * sheet.value).into(),
                error.into(),
            ]);
            points.push((sheet.freedoms as f64, error));
            finest.push((name, sheet.freedoms, sheet.value, error));
        }
        chart = chart.with(Series::new(name, points));
    }
    // The same number of freedoms: linear cells half the size.
    let at = |name: &str, least: usize| {
        let found = finest.iter().find(|(other, n, ..)| *other == name && *n > least);
        found.map_or(f64::NAN, |found| found.3)
    };
    let (quadratic, linear) = (at("quadratic triangles", 3000), at("linear triangles", 3000));
    let stress = finest.last().map_or(f64::NAN, |finest| 1e-6 * finest.2);
    let extrapolated = match finest.as_slice() {
        // Aitken's rule: the errors fall by one factor from mesh to mesh.
        [.., a, b, c] => 1e-6 * (c.2 - (c.2 - b.2).powi(2) / (c.2 - 2.0 * b.2 + a.2)),
        _ => f64::NAN,
    };
    Ok(Study {
        conclusion: "A quarter of an elliptic ring of steel, 0.1 m thick, pulled outward by 10 MPa: the \
                     stress at the end of the inner long axis, where NAFEMS gives 92.7 MPa. Stress is \
                     taken at the quadrature points, continued to the nodes and averaged. Linear \
                     triangles miss it by several percent on meshes where quadratic ones, with curved \
                     edges, miss it by one. Both approach it from below: it is the stress at one point, where stress varies fastest."
            .into(),
        table,
        charts: vec![chart.slope(-0.5, (1000.0, 0.1)).slope(-1.0, (1000.0, 0.02)).into()],
        claims: vec![
            Claim::number(
                "quadratic triangles: what the three finest meshes extrapolate to",
                "92.7 MPa",
                extrapolated,
                (92.5, 92.9),
            ),
            Claim::number(
                "quadratic triangles: the stress of the finest mesh",
                "92.7 MPa",
                stress,
                (92.7 * 0.994, 92.7 * 1.006),
            ),
            Claim::number(
                "at about 3000 freedoms linear triangles are farther off, by a factor",
                "more than 3",
                linear / quadratic,
                (3.0, 20.0),
            ),
        ],
        ..MEMBRANE.heading()
    })
}

fn pair(poisson: f64) -> Result<Lame<3>, StudyError> {
    Lame::from_young_poisson(1.0, poisson).map_err(StudyError::at("the material"))
}

fn beam(lame: Lame<2>, diagonals: Diagonals) -> Beam {
    Beam { size: [10.0, 1.0], lame, push: 1e-3, diagonals }
}

fn cantilever(size: Size) -> Result<Study, StudyError> {
    let beam = beam(pair(0.3)?.plane_stress(), Diagonals::Alternating);
    let failed = || StudyError::at::<ElasticityError>("the beam");
    let fine = match size {
        Size::Default => 16,
        Size::Full => 32,
    };
    let reference = beam.solved(SheetFamily::Quadratic, [10 * fine, fine]).map_err(failed())?.value;
    let mut table = Table::new([
        Column::exact("element"),
        Column::exact("freedoms"),
        Column::rounded("error of the tip", 3, 1e-5),
        Column::volatile("time [ms]"),
    ]);
    let error = || Axis::log("error of the tip", "");
    let mut by_freedoms = Lines::new("By freedoms", Axis::log("freedoms", ""), error());
    let mut by_time = Lines::new("By time", Axis::log("time", "ms"), error());
    let mut all = Vec::new();
    for ((name, family), cells) in FAMILIES.into_iter().zip([[2, 4, 8, 16], [1, 2, 4, 8]]) {
        let (mut freedoms, mut times) = (Vec::new(), Vec::new());
        for n in cells {
            // A first solve warms up the caches.
            beam.solved(family, [10 * n, n]).map_err(failed())?;
            let start = Instant::now();
            let sheet = beam.solved(family, [10 * n, n]).map_err(failed())?;
            let time = 1e3 * start.elapsed().as_secs_f64();
            let error = (sheet.value / reference - 1.0).abs();
            table.push([name.into(), (sheet.freedoms as u64).into(), error.into(), time.into()]);
            freedoms.push((sheet.freedoms as f64, error));
            times.push((time, error));
        }
        all.push(freedoms.clone());
        by_freedoms = by_freedoms.with(Series::new(name, freedoms));
        by_time = by_time.with(Series::new(name, times));
    }
    let slope = |points: &[(f64, f64)]| loglog_slope(points).unwrap_or(f64::NAN);
    let asked = Asked {
        question: "Bending of an elastic beam, to one percent",
        error: 0.01,
        cost: "freedoms",
        rival: "linear triangles",
    };
    Ok(Study {
        conclusion: format!(
            "A beam ten times as long as high, clamped and pushed at its tip, against quadratic \
             triangles on a mesh of {fine} cells across. One layer of quadratic triangles bends better \
             than sixteen of linear ones: their strain is constant, and bending is strain that is not. \
             Take quadratic elements. Beam theory with shear agrees with the reference to {:.2} %.",
            100.0 * (beam.deflection() / reference - 1.0).abs()
        ),
        answers: asked.of(&by_freedoms).into_iter().collect(),
        table,
        charts: vec![by_freedoms.slope(-1.0, (1000.0, 0.1)).into(), by_time.into()],
        claims: vec![
            Claim::number(
                "the reference and Timoshenko's beam, as a ratio",
                "1",
                reference / beam.deflection(),
                (0.99, 1.01),
            ),
            Claim::number(
                "linear triangles: error by freedoms, slope",
                "-1",
                slope(&all[0]),
                (-1.2, -0.8),
            ),
            Claim::number(
                "one layer of quadratic triangles against sixteen of linear ones, error",
                "less",
                all[1][0].1 / all[0][3].1,
                (0.0, 1.0),
            ),
        ],
        ..CANTILEVER.heading()
    })
}

fn locking(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("element"),
        Column::rounded("1 - 2 nu", 2, 0.0),
        Column::rounded("deflection / beam theory", 3, 1e-6),
    ]);
    let axis = Axis::log("deflection / beam theory", "");
    let mut chart = Lines::new("", Axis::log("1 - 2 nu", ""), axis);
    let kinds = [
        ("linear, cells cut alike", SheetFamily::Linear, Diagonals::Same),
        ("linear, cut in turn", SheetFamily::Linear, Diagonals::Alternating),
        ("quadratic", SheetFamily::Quadratic, Diagonals::Same),
    ];
    let mut ends = Vec::new();
    for (name, family, diagonals) in kinds {
        let mut points = Vec::new();
        for exponent in 1..=6 {
            let gap = 10.0_f64.powi(-exponent);
            let beam = beam(pair(0.5 * (1.0 - gap))?.plane_strain(), diagonals);
            let sheet = beam.solved(family, [40, 4]).map_err(StudyError::at("the beam"))?;
            let ratio = sheet.value / beam.deflection();
            table.push([name.into(), gap.into(), ratio.into()]);
            points.push((gap, ratio));
        }
        ends.push((points[0].1, points[5].1));
        chart = chart.with(Series::new(name, points));
    }
    Ok(Study {
        conclusion: "The beam in plane strain, 40 x 4 cells, as Poisson's ratio goes to one half. Linear \
                     triangles that are all cut alike keep each its own area, which leaves them next to \
                     no way to bend; cut in turn, four around a vertex find one. Quadratic triangles \
                     hardly notice. A locked mesh gives no sign of it: the solve succeeds, and the beam is far \
                     too stiff."
            .into(),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "linear triangles cut alike keep less than this of their deflection",
                "below 0.3",
                ends[0].1 / ends[0].0,
                (0.0, 0.3),
            ),
            Claim::number(
                "quadratic triangles keep this of theirs",
                "more than 0.95",
                ends[2].1 / ends[2].0,
                (0.95, 1.05),
            ),
        ],
        ..LOCKING.heading()
    })
}
