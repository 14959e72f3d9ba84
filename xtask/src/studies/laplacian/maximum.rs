//! Heat that turns colder than anything was: the maximum principle on bad triangles.

use nalgebra::Vector3;
use stationary_calculus::{Column, Metric, Table};
use stationary_laplacian::{Domain, Elements, Heat, HeatMethod, LaplacianError};
use stationary_mesh::{IntrinsicSurface, Mesh, torus};

use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};

/// Undershoot against shear.
pub const STUDY: Entry<'static> = Entry {
    id: "maximum-principle",
    krate: "laplacian",
    chapter: "15.3",
    kind: Kind::Ladder,
    title: "Heat below the coldest: what slivers, masses and steps do to the maximum principle",
    run: &study,
};

const WAYS: [&str; 4] = [
    "plain cotangents",
    "Delaunay edges",
    "Delaunay edges, exact mass",
    "Delaunay edges, crank-nicolson",
];

/// By how much a spike's heat falls below zero, over spikes at some vertices.
fn undershoot(
    domain: &Domain<3>,
    metric: &impl Metric,
    method: HeatMethod,
) -> Result<f64, LaplacianError> {
    let mut heat = Heat::new(metric, domain.dirichlet(), method, 1.0, 0.05)?;
    let mut lowest = 0.0_f64;
    for spike in (0..domain.dim()).step_by(11) {
        let mut f = vec![0.0; domain.dim()];
        f[spike] = 1.0;
        for _ in 0..5 {
            heat.step(&mut f)?;
            lowest = f.iter().copied().fold(lowest, f64::min);
        }
    }
    // Not minus the lowest: that would be a negative zero.
    Ok(0.0 - lowest)
}

/// The four ways on one mesh, and how obtuse the mesh is: its largest angle in degrees.
fn row(mesh: &Mesh<3, 3>) -> Result<(f64, [f64; 4]), LaplacianError> {
    let angles = mesh.quality(stationary_mesh::Quality::LargestAngle);
    let angle = angles.into_iter().fold(0.0, f64::max).to_degrees();
    let plain = Domain::free(Elements::of(mesh)?)?;
    let mut surface = IntrinsicSurface::of(mesh)?;
    surface.flip_to_delaunay()?;
    let delaunay = Domain::free(Elements::of_surface(&surface)?)?;
    let (implicit, lumped) = (HeatMethod::ImplicitEuler, delaunay.lumped()?);
    Ok((
        angle,
        [
            undershoot(&plain, &plain.lumped()?, implicit)?,
            undershoot(&delaunay, &lumped, implicit)?,
            undershoot(&delaunay, &delaunay.galerkin()?, implicit)?,
            undershoot(&delaunay, &lumped, HeatMethod::CrankNicolson)?,
        ],
    ))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (cells, shears) = match size {
        Size::Default => ([30, 16], 9),
        Size::Full => ([60, 32], 25),
    };
    let mut table = Table::new([
        Column::rounded("largest angle [deg]", 4, 0.0),
        Column::rounded(WAYS[0], 3, 1e-14),
        Column::rounded(WAYS[1], 3, 1e-14),
        Column::rounded(WAYS[2], 3, 1e-14),
        Column::rounded(WAYS[3], 3, 1e-14),
    ]);
    let mut series = [const { Vec::new() }; 4];
    let mut worst = [0.0_f64; 4];
    for k in 0..shears {
        let shear = 3.0 * f64::from(k) / f64::from(shears - 1);
        let mesh = torus([2.0, 0.7], cells)
            .and_then(|mesh| mesh.mapped(|x| Vector3::new(x.x, x.y, x.z + shear * x.y)))
            .map_err(StudyError::at("the torus"))?;
        let (angle, lows) = row(&mesh).map_err(StudyError::at("heat"))?;
        table.push([angle.into(), lows[0].into(), lows[1].into(), lows[2].into(), lows[3].into()]);
        for (way, low) in lows.into_iter().enumerate() {
            series[way].push((angle, low.max(1e-18)));
            worst[way] = worst[way].max(low);
        }
    }
    let axes = (
        Axis::linear("largest angle of the mesh", "degrees"),
        Axis::log("how far heat falls below zero", ""),
    );
    let mut chart = Lines::new("", axes.0, axes.1);
    for (name, points) in WAYS.into_iter().zip(series) {
        chart = chart.with(Series::new(name, points));
    }
    let broken = |text: &str, way: usize| {
        Claim::number(text, "more than 1e-4", worst[way], (1e-4, f64::INFINITY))
    };
    Ok(Study {
        id: STUDY.id,
        krate: STUDY.krate,
        chapter: STUDY.chapter,
        kind: STUDY.kind,
        title: STUDY.title.into(),
        conclusion: "A spike of heat on a torus that is sheared more and more. Nothing may turn \
                     colder than zero. Implicit Euler with lumped mass keeps that once the edges \
                     are Delaunay, however bad the triangles were: the surface is the same, only \
                     its edges are others. Plain cotangents go negative on obtuse angles, and \
                     the exact mass and Crank-Nicolson break the principle on any mesh. What is \
                     exactly zero is drawn at 1e-18."
            .into(),
        table,
        charts: vec![chart.into()],
        claims: vec![
            broken("plain cotangents break the maximum principle on slivers, by", 0),
            Claim::number(
                "Delaunay edges keep it to rounding, with implicit Euler and lumped mass: by",
                "below 1e-14",
                worst[1],
                (0.0, 1e-14),
            ),
            broken("the exact mass breaks it, by", 2),
            broken("Crank-Nicolson breaks it, by", 3),
        ],
    })
}
