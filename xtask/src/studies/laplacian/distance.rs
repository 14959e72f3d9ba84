//! Distances by heat and by shortest paths, against exact ones.

use std::f64::consts::PI;

use nalgebra::Vector2;
use stationary_chart::{Axis, Lines, Series};
use stationary_laplacian::{GeodesicDistance, LaplacianError, ShortestPaths};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{Diagonals, IntrinsicSurface, disc, icosphere, rectangle};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error and stated error against mesh size, heat time and mesh quality, and what the latter costs.
pub const STUDY: Entry<'static> = Entry {
    id: "geodesic-distance",
    krate: "laplacian",
    chapter: "15",
    kind: Kind::Convergence,
    title: "Distances from heat: measured and stated error against mesh size and heat time",
    tested: Tested::Claims,
    run: &study,
};

/// A surface and the exact distances from one vertex.
struct Known {
    surface: IntrinsicSurface,
    source: usize,
    exact: Vec<f64>,
}

impl Known {
    fn disc(rings: usize) -> Result<Self, LaplacianError> {
        let mesh = disc(1.0, rings)?;
        let exact = mesh.vertices().iter().map(|x| x.norm()).collect();
        Ok(Known { surface: IntrinsicSurface::of(&mesh)?, source: 0, exact })
    }

    fn sphere(levels: usize) -> Result<Self, LaplacianError> {
        let mesh = icosphere(1.0, levels)?;
        let pole = mesh.vertices()[0];
        let exact = mesh.vertices().iter().map(|x| x.angle(&pole)).collect();
        Ok(Known { surface: IntrinsicSurface::of(&mesh)?, source: 0, exact })
    }

    fn flat_torus(n: usize) -> Result<Self, LaplacianError> {
        let surface = IntrinsicSurface::flat_torus([1.0, 1.0], [n, n])?;
        let around = |k: usize| k.min(n - k) as f64 / n as f64;
        let exact = (0..n * n).map(|v| around(v % n).hypot(around(v / n))).collect();
        Ok(Known { surface, source: 0, exact })
    }

    /// A square cut into a grid whose lines wind, so that many of its triangles are slivers.
    fn slivers(n: usize) -> Result<Self, LaplacianError> {
        let mesh = rectangle([1.0, 1.0], [n, n], Diagonals::Same)?;
        let mesh = mesh.mapped(|x| {
            let aside = 0.3 * (PI * x.x).sin() * (4.0 * PI * x.y).sin();
            Vector2::new(x.x + aside, x.y)
        })?;
        let source = (n + 1) * (n / 2) + n / 2;
        let middle = mesh.vertices()[source];
        let exact = mesh.vertices().iter().map(|x| (x - middle).norm()).collect();
        Ok(Known { surface: IntrinsicSurface::of(&mesh)?, source, exact })
    }

    /// Largest error and largest estimate, relative to the largest distance; the heat time is this
    /// many times the one advised.
    fn errors(&self, times: f64) -> Result<(f64, f64), LaplacianError> {
        let time = times * GeodesicDistance::advised_time(&self.surface);
        let got = GeodesicDistance::new(&self.surface, time)?.from(&[self.source])?;
        let farthest = self.exact.iter().copied().fold(0.0, f64::max);
        let off = got.distance.iter().zip(&self.exact).map(|(d, e)| (d - e).abs());
        let estimate = got.estimate.into_iter().fold(0.0, f64::max);
        Ok((off.fold(0.0, f64::max) / farthest, estimate / farthest))
    }

    /// Largest error of the shortest paths, relative to the largest distance, and their windows.
    fn shortest(&self) -> Result<(f64, usize), LaplacianError> {
        let got = ShortestPaths::new(&self.surface).from(&[self.source])?;
        let farthest = self.exact.iter().copied().fold(0.0, f64::max);
        let off = got.distance.iter().zip(&self.exact).map(|(d, e)| (d - e).abs());
        Ok((off.fold(0.0, f64::max) / farthest, got.windows))
    }
}

fn study(size: Size) -> Result<Study, StudyError> {
    let levels = match size {
        Size::Default => 3,
        Size::Full => 5,
    };
    let at = StudyError::at::<LaplacianError>;
    let mut table = Table::new([
        Column::exact("surface"),
        Column::exact("vertices"),
        Column::rounded("heat time / advised", 3, 0.0),
        Column::rounded("largest error", 3, 1e-9),
        Column::rounded("stated error", 3, 1e-9),
        Column::exact("windows"),
    ]);
    let axes = || Axis::log("error, relative to the largest distance", "");
    let mut by_size = Lines::new("Mesh size", Axis::log("vertices", ""), axes());
    let mut by_time = Lines::new("Heat time", Axis::log("heat time / advised", ""), axes());
    let (mut claims, mut ratios) = (Vec::new(), Vec::new());
    let mut by_windows =
        Lines::new("Work of the stated error", Axis::log("vertices", ""), Axis::log("windows", ""));
    for (name, known) in [
        ("disc", Known::disc as fn(usize) -> Result<Known, LaplacianError>),
        ("sphere", Known::sphere),
        ("flat torus", Known::flat_torus),
    ] {
        let (mut errors, mut estimates, mut windows) = (Vec::new(), Vec::new(), Vec::new());
        for level in 0..levels {
            let fineness = if name == "sphere" { 2 + level } else { 10 << level };
            let known = known(fineness).map_err(at(name))?;
            let (error, estimate) = known.errors(1.0).map_err(at(name))?;
            let vertices = known.exact.len();
            let row = [name.into(), (vertices as u64).into(), 1.0.into(), error.into()];
            let (paths, count) = known.shortest().map_err(at(name))?;
            table.push([row.as_slice(), &[estimate.into(), (count as u64).into()]].concat());
            windows.push((vertices as f64, count as f64));
            if name != "sphere" {
                claims.push(Claim::number(
                    format!("{name} of {vertices} vertices: error of the shortest paths"),
                    "rounding",
                    paths,
                    (0.0, 1e-12),
                ));
            }
            errors.push((vertices as f64, error));
            estimates.push((vertices as f64, estimate));
            ratios.push(estimate / error);
        }
        let order = -2.0 * loglog_slope(&errors).unwrap_or(f64::NAN);
        claims.push(Claim::number(
            format!("{name}: the error falls with the mesh size to a power"),
            "between a half (where fronts meet) and one",
            order,
            (0.5, 1.3),
        ));
        claims.push(Claim::number(
            format!("{name}: windows grow with the vertices to a power"),
            "about 3/2",
            loglog_slope(&windows).unwrap_or(f64::NAN),
            (1.0, 1.7),
        ));
        by_windows = by_windows.with(Series::new(name, windows));
        by_size = by_size.with(Series::new(name, errors));
        by_size = by_size.with(Series::new(&format!("{name}, as stated"), estimates));
        let known = known(if name == "sphere" { 3 } else { 20 }).map_err(at(name))?;
        let mut points = Vec::new();
        for k in -4..=6 {
            let times = 2.0_f64.powi(k);
            points.push((times, known.errors(times).map_err(at(name))?.0));
        }
        by_time = by_time.with(Series::new(name, points));
    }
    let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ratios.iter().copied().fold(0.0, f64::max);
    for (what, ratio) in [("least", low), ("largest", high)] {
        claims.push(Claim::number(
            format!("{what} ratio of the stated error to the true one"),
            "within a factor of two",
            ratio,
            (0.5, 2.0),
        ));
    }
    let slivers = Known::slivers(24).map_err(at("slivers"))?;
    let (error, stated) = slivers.errors(1.0).map_err(at("slivers"))?;
    claims.push(Claim::number(
        "on slivers, where plain cotangents give heat both signs, the error is",
        "below 0.1",
        error,
        (0.0, 0.1),
    ));
    claims.push(Claim::number(
        "and the ratio of the stated error to it",
        "within a factor of two",
        stated / error,
        (0.5, 2.0),
    ));
    Ok(Study {
        conclusion: format!(
            "The largest error of heat's distance to one vertex, and the error that is stated with \
             it: how far it is from the shortest path along the triangles, {low:.2} to {high:.2} \
             times the true one. The shortest paths are exact on flat triangles, and cost so many \
             windows. The advised time, the square of the mean edge, suits all three; where fronts \
             meet, as on the torus, shorter and longer ones are both worse. A square of slivers, on \
             which plain cotangents give heat both signs, is measured within {error:.3}: heat flows \
             on Delaunay edges."
        ),
        table,
        charts: vec![by_size.into(), by_time.into(), by_windows.into()],
        claims,
        ..STUDY.heading()
    })
}
