//! Distances along surfaces whose shortest paths are known.

use stationary_laplacian::{GeodesicDistance, LaplacianError, ShortestPaths};
use stationary_mesh::{IntrinsicSurface, Mesh};

use super::unrolled::known;
use crate::{Draw, Kind, Verdict};

pub const KIND: Kind = Kind {
    name: "distance",
    krate: "laplacian",
    rule: "a vertex whose true distance along the triangles lies outside of its stated error (and \
           1e-8 of the farthest), a largest stated error above twice the largest true one, a shortest \
           path off by more than 1e-9 of the farthest, a vertex that no path leads to and is not \
           told so",
    in_tests: 400,
    trial,
};

/// What is rounding, relative to the farthest distance.
const ROUNDING: f64 = 1e-8;

fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.07) {
        return on_flat_torus(draw);
    }
    let known = known(draw);
    let n = known.shape.vertices.len();
    let sources = sources(draw, n, &known.shape.simplices);
    let mesh = match Mesh::new(known.shape.vertices.clone(), known.shape.simplices.clone()) {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::refused(error),
    };
    let surface = match IntrinsicSurface::of(&mesh) {
        Ok(surface) => surface,
        Err(error) => return Verdict::refused(error),
    };
    judge(draw, surface, &sources, &(known.truth)(&sources))
}

/// One vertex, a few, all within a ring or two of edges, or all.
fn sources(draw: &mut Draw, n: usize, triangles: &[[usize; 3]]) -> Vec<usize> {
    let one = draw.below(n);
    let sources = match draw.below(8) {
        0..4 => vec![one],
        4 | 5 => (0..draw.between(2, 5)).map(|_| draw.below(n)).collect(),
        6 => {
            let mut near = vec![one];
            for _ in 0..draw.between(1, 3) {
                let touching = triangles.iter().filter(|t| t.iter().any(|v| near.contains(v)));
                let mut all = [near.clone(), touching.flatten().copied().collect()].concat();
                all.sort_unstable();
                all.dedup();
                near = all;
            }
            near
        }
        _ => {
            let share = draw.unit();
            let mut some: Vec<usize> = (0..n).filter(|_| draw.chance(share)).collect();
            some.push(one);
            some
        }
    };
    draw.note(format!("{n} vertices, sources {sources:?}"));
    sources
}

fn on_flat_torus(draw: &mut Draw) -> Verdict {
    let cells @ [m, n] = [draw.between(3, 12), draw.between(3, 12)];
    let size @ [a, b] = [1.0, draw.log_uniform(0.01, 1.0)];
    draw.note(format!("a flat torus of {m} x {n} cells, {a} by {b:.3}"));
    let surface = match IntrinsicSurface::flat_torus(size, cells) {
        Ok(surface) => surface,
        Err(error) => return Verdict::refused(error),
    };
    let sources = sources(draw, m * n, surface.triangles());
    let around =
        |i: usize, j: usize, of: usize| (i.abs_diff(j).min(of - i.abs_diff(j))) as f64 / of as f64;
    let distance =
        |u: usize, v: usize| (a * around(u % m, v % m, m)).hypot(b * around(u / m, v / m, n));
    let nearest = |v: usize| sources.iter().map(|&s| distance(s, v)).fold(f64::INFINITY, f64::min);
    let truth: Vec<(f64, f64)> = (0..m * n).map(|v| (nearest(v), 0.0)).collect();
    judge(draw, surface, &sources, &truth)
}

fn judge(
    draw: &mut Draw,
    mut surface: IntrinsicSurface,
    sources: &[usize],
    truth: &[(f64, f64)],
) -> Verdict {
    if draw.chance(0.5) {
        draw.note("with Delaunay edges");
        if let Err(error) = surface.flip_to_delaunay() {
            return Verdict::refused(error);
        }
    }
    let mut time = GeodesicDistance::advised_time(&surface);
    if draw.chance(0.2) {
        time *= draw.log_uniform(0.25, 8.0);
    }
    let paths = match ShortestPaths::new(&surface).from(sources) {
        Ok(found) => nearest(&found.distance, truth),
        Err(error) => return Verdict::refused(error),
    };
    let reachable = truth.iter().all(|t| t.0.is_finite());
    let found = GeodesicDistance::new(&surface, time).and_then(|mut heat| heat.from(sources));
    let found = match found {
        Ok(found) => found,
        Err(LaplacianError::Underflow { .. }) if !reachable => {
            return Verdict::wrong("where no path leads a longer time is advised");
        }
        Err(error) => return Verdict::refused(error),
    };
    paths.and(compare(&found.distance, &found.estimate, truth))
}

/// Shortest paths have no error but rounding.
fn nearest(distance: &[f64], truth: &[(f64, f64)]) -> Verdict {
    let finite = truth.iter().filter(|t| t.0.is_finite());
    let rounding = 1e-9 * finite.map(|t| t.0).fold(0.0, f64::max);
    let mut verdict = Verdict::due();
    for (v, (&d, &(exact, unsure))) in distance.iter().zip(truth).enumerate() {
        if d.is_infinite() != exact.is_infinite() {
            return Verdict::wrong(format!(
                "the shortest path to vertex {v} is {d:e}, not {exact:e}"
            ));
        }
        if exact.is_finite() {
            let off = ((d - exact).abs() - unsure).max(0.0);
            let what =
                if d > exact { "a path that is not the shortest" } else { "a path too short" };
            verdict = verdict.and(Verdict::of(off, rounding, what));
        }
    }
    verdict
}

fn compare(distance: &[f64], estimate: &[f64], truth: &[(f64, f64)]) -> Verdict {
    let finite = truth.iter().filter(|t| t.0.is_finite());
    let farthest = finite.map(|t| t.0).fold(0.0, f64::max);
    let rounding = ROUNDING * farthest;
    let (mut outside, mut largest, mut stated) = (Verdict::due(), 0.0_f64, 0.0_f64);
    for (v, (&(exact, unsure), (&d, &e))) in
        truth.iter().zip(distance.iter().zip(estimate)).enumerate()
    {
        if exact.is_infinite() {
            if d != f64::INFINITY {
                return Verdict::wrong(format!("no path leads to vertex {v}, which is {d:e} away"));
            }
            continue;
        }
        let off = (d - exact).abs();
        largest = largest.max(off + unsure);
        stated = stated.max(e);
        // Inside of its own uncertainty the referee finds no fault.
        let beyond = (off - unsure).max(0.0);
        outside =
            outside.and(Verdict::of(beyond, e + rounding, "a distance against its stated error"));
    }
    outside.and(Verdict::of(stated, 2.0 * largest + 10.0 * rounding, "the largest stated error"))
}
