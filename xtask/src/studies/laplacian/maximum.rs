//! Heat that turns colder than anything was: the maximum principle on bad triangles.

use nalgebra::Vector3;
use stationary_calculus::Metric;
use stationary_chart::{Axis, Lines, Series};
use stationary_laplacian::{Domain, Elements, Heat, HeatMethod, LaplacianError};
use stationary_measure::{Column, Table};
use stationary_mesh::{Diagonals, IntrinsicSurface, Mesh, MeshError, rectangle, torus};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Undershoot against shear.
pub const STUDY: Entry<'static> = Entry {
    id: "maximum-principle",
    krate: "laplacian",
    chapter: "15.3",
    kind: Kind::Ladder,
    title: "Heat on sheared surfaces: how far below the coldest, against the largest angle",
    tested: Tested::Claims,
    run: &study,
};

const WAYS: [&str; 5] = [
    "plain cotangents",
    "Delaunay edges",
    "Delaunay edges, exact mass",
    "Delaunay edges, crank-nicolson",
    "Delaunay edges, boundary split",
];
/// Ways that a surface without a boundary has.
const CLOSED: usize = 4;

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

/// A surface that is sheared.
struct Family {
    name: &'static str,
    mesh: fn([usize; 2], f64) -> Result<Mesh<3, 3>, MeshError>,
    ways: usize,
}

const FAMILIES: [Family; 2] = [
    Family {
        name: "Torus",
        mesh: |cells, shear| {
            torus([2.0, 0.7], cells)?.mapped(|x| Vector3::new(x.x, x.y, x.z + shear * x.y))
        },
        ways: CLOSED,
    },
    Family {
        name: "Sheet",
        mesh: |cells, shear| {
            let sheet = rectangle([8.0, 4.0], cells, Diagonals::Same)?;
            sheet.mapped(|x| Vector3::new(x.x + shear * x.y, x.y, 0.0))
        },
        ways: WAYS.len(),
    },
];

/// All ways on one mesh, and how obtuse the mesh is: its largest angle in degrees.
fn row(mesh: &Mesh<3, 3>) -> Result<(f64, [f64; 5]), LaplacianError> {
    let angles = mesh.quality(stationary_mesh::Quality::LargestAngle);
    let angle = angles.into_iter().fold(0.0, f64::max).to_degrees();
    let plain = Domain::free(Elements::of(mesh)?)?;
    let mut surface = IntrinsicSurface::of(mesh)?;
    surface.flip_to_delaunay()?;
    let delaunay = Domain::free(Elements::of_surface(&surface)?)?;
    surface.split_obtuse_boundary()?;
    let split = Domain::free(Elements::of_surface(&surface)?)?;
    let (implicit, lumped) = (HeatMethod::ImplicitEuler, delaunay.lumped()?);
    Ok((
        angle,
        [
            undershoot(&plain, &plain.lumped()?, implicit)?,
            undershoot(&delaunay, &lumped, implicit)?,
            undershoot(&delaunay, &delaunay.galerkin()?, implicit)?,
            undershoot(&delaunay, &lumped, HeatMethod::CrankNicolson)?,
            undershoot(&split, &split.lumped()?, implicit)?,
        ],
    ))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (cells, shears) = match size {
        Size::Default => ([30, 16], 9),
        Size::Full => ([60, 32], 25),
    };
    let mut columns =
        vec![Column::exact("surface"), Column::rounded("largest angle [deg]", 4, 0.0)];
    columns.extend(WAYS.map(|way| Column::rounded(way, 3, 1e-14)));
    let mut table = Table::new(columns);
    let (mut charts, mut worst) = (Vec::new(), [[0.0_f64; WAYS.len()]; FAMILIES.len()]);
    for (family, worst) in FAMILIES.iter().zip(&mut worst) {
        let mut series = [const { Vec::new() }; WAYS.len()];
        for k in 0..shears {
            let shear = 3.0 * f64::from(k) / f64::from(shears - 1);
            let mesh = (family.mesh)(cells, shear).map_err(StudyError::at(family.name))?;
            let (angle, lows) = row(&mesh).map_err(StudyError::at("heat"))?;
            let cells = [family.name.into(), angle.into()];
            table.push(cells.into_iter().chain(lows.map(Into::into)).collect::<Vec<_>>());
            for (way, low) in lows.into_iter().enumerate() {
                series[way].push((angle, low));
                worst[way] = worst[way].max(low);
            }
        }
        let axes = (
            Axis::linear("largest angle of the mesh", "degrees"),
            Axis::log("how far heat falls below zero", ""),
        );
        let mut chart = Lines::new(family.name, axes.0, axes.1);
        for (name, points) in WAYS.into_iter().zip(series).take(family.ways) {
            chart = chart.with(Series::new(name, points));
        }
        charts.push(chart.into());
    }
    let [closed, bounded] = worst;
    let broken =
        |text: &str, low: f64| Claim::number(text, "more than 1e-4", low, (1e-4, f64::INFINITY));
    let kept = |text: &str, low: f64| Claim::number(text, "below 1e-14", low, (0.0, 1e-14));
    Ok(Study {
        conclusion: "A spike of heat on a torus, and on a sheet, that are sheared more and more. \
                     Nothing may turn colder than zero. On the torus implicit Euler with lumped \
                     mass keeps that once the edges are Delaunay, however bad the triangles were: \
                     the surface is the same, only its edges are others. The sheet has a boundary, \
                     whose sides no flip mends where they face an obtuse angle: there the sides \
                     must be split as well. Plain cotangents go negative on obtuse angles, and the \
                     exact mass and Crank-Nicolson break the principle on any mesh. Arrows \
                     at the foot stand for exactly zero."
            .into(),
        table,
        charts,
        claims: vec![
            broken("plain cotangents break the maximum principle on slivers, by", closed[0]),
            kept(
                "Delaunay edges keep it to rounding, with implicit Euler and lumped mass: by",
                closed[1],
            ),
            broken("the exact mass breaks it, by", closed[2]),
            broken("Crank-Nicolson breaks it, by", closed[3]),
            broken("at a boundary Delaunay edges alone break it, by", bounded[1]),
            kept("with the boundary's sides split they keep it there too: by", bounded[4]),
        ],
        ..STUDY.heading()
    })
}
