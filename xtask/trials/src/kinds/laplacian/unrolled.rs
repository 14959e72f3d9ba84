//! Surfaces whose shortest paths are known: flat ones, those that unroll to flat ones, spheres, and
//! any other by a graph with many points on each edge.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix2, Vector2, Vector3};
use stationary_mesh::icosphere;

use super::edge_graph::through_edges;
use super::shapes::{Shape, bumpy_ball, halves};
use crate::Draw;

/// The distance of every vertex to the nearest of some, and how well that is known.
pub type Truth = Box<dyn Fn(&[usize]) -> Vec<(f64, f64)>>;

/// A surface and the truth about it.
pub struct Known {
    pub shape: Shape<3>,
    pub truth: Truth,
}

/// Closed forms are known to this, relative to the distance.
const ROUNDING: f64 = 1e-11;

impl Known {
    /// Distances of pairs by a closed form.
    fn pairs(shape: Shape<3>, distance: impl Fn(usize, usize) -> f64 + 'static) -> Self {
        let n = shape.vertices.len();
        let truth = move |sources: &[usize]| {
            let nearest =
                |v: usize| sources.iter().map(|&s| distance(s, v)).fold(f64::INFINITY, f64::min);
            (0..n).map(|v| (nearest(v), ROUNDING * nearest(v))).collect()
        };
        Known { shape, truth: Box::new(truth) }
    }

    /// The two side by side: no path leads from one to the other.
    fn beside(self, other: Self) -> Self {
        let n = self.shape.vertices.len();
        let mut shape = self.shape;
        let m = other.shape.vertices.len();
        shape.add(&other.shape);
        let (one, two) = (self.truth, other.truth);
        let truth = move |sources: &[usize]| {
            let here: Vec<usize> = sources.iter().copied().filter(|&s| s < n).collect();
            let there: Vec<usize> = sources.iter().filter(|&&s| s >= n).map(|s| s - n).collect();
            let of = |truth: &Truth, sources: &[usize], n: usize| {
                if sources.is_empty() { vec![(f64::INFINITY, 0.0); n] } else { truth(sources) }
            };
            [of(&one, &here, n), of(&two, &there, m)].concat()
        };
        Known { shape, truth: Box::new(truth) }
    }
}

/// A random surface of one piece or two.
pub fn known(draw: &mut Draw) -> Known {
    let one = piece(draw);
    if draw.chance(0.2) { one.beside(piece(draw)) } else { one }
}

fn piece(draw: &mut Draw) -> Known {
    match draw.below(9) {
        0 | 1 => parallelogram(draw),
        2 => polygon(draw),
        3 => notched(draw),
        4 => prism(draw),
        5 => cone(draw),
        6 => pillow(draw),
        7 => sphere(draw),
        _ => bumpy(draw),
    }
}

fn flat(x: Vector2<f64>) -> Vector3<f64> {
    Vector3::new(x.x, x.y, 0.0)
}

/// Sides up to 1000:1, and a shear.
fn affine(draw: &mut Draw) -> Matrix2<f64> {
    let stretch = match draw.below(3) {
        0 => 1.0,
        1 => draw.log_uniform(1.0, 30.0),
        _ => draw.log_uniform(30.0, 1000.0),
    };
    let shear = if draw.chance(0.4) { 3.0 * draw.symmetric() } else { 0.0 };
    let scale = if draw.chance(0.2) { draw.log_uniform(1e-6, 1e6) } else { 1.0 };
    draw.note(format!("stretched {stretch:.3e}, sheared {shear:.2}, scaled {scale:.1e}"));
    Matrix2::new(stretch, shear, 0.0, 1.0) * scale
}

/// Cells of a grid: square-like, or long rows of few.
fn cells(draw: &mut Draw) -> [usize; 2] {
    if draw.chance(0.3) {
        [draw.between(10, 80), draw.between(1, 2)]
    } else {
        [draw.between(1, 12), draw.between(1, 12)]
    }
}

fn grid(
    draw: &mut Draw,
    [m, n]: [usize; 2],
    is_there: impl Fn(usize, usize) -> bool,
) -> Vec<[usize; 3]> {
    let regular = draw.chance(0.3);
    let at = |i: usize, j: usize| i + j * (m + 1);
    let mut triangles = Vec::new();
    for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
        if is_there(i, j) {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend(halves(corners, !regular && draw.chance(0.5)));
        }
    }
    triangles
}

/// A convex domain: a rectangle under a linear map, vertices pushed about.
fn parallelogram(draw: &mut Draw) -> Known {
    let [m, n] = cells(draw);
    // With more a triangle might turn over.
    let jitter = if draw.chance(0.5) { 0.24 } else { 0.0 };
    draw.note(format!("a parallelogram of {m} x {n} cells, jitter {jitter}"));
    // Cells are square, or the whole is.
    let square = draw.chance(0.5);
    let map = affine(draw);
    let (mut places, mut vertices) = (Vec::new(), Vec::new());
    for (j, i) in (0..=n).flat_map(|j| (0..=m).map(move |i| (j, i))) {
        let off = |draw: &mut Draw, k: usize, of: usize| {
            if k == 0 || k == of { 0.0 } else { jitter * draw.symmetric() }
        };
        let x = Vector2::new(i as f64 + off(draw, i, m), j as f64 + off(draw, j, n));
        let x = if square { x } else { Vector2::new(x.x / m as f64, x.y / n as f64) };
        places.push(map * x);
        vertices.push(flat(map * x));
    }
    let simplices = grid(draw, [m, n], |_, _| true);
    Known::pairs(Shape { vertices, simplices }, move |a, b| (places[a] - places[b]).norm())
}

/// A regular polygon in rings about its centre, under a linear map.
fn polygon(draw: &mut Draw) -> Known {
    let [sides, rings] = [draw.between(3, 14), draw.between(1, 8)];
    draw.note(format!("a polygon of {sides} sides in {rings} rings"));
    let map = affine(draw);
    let mut places = vec![Vector2::zeros()];
    for (j, i) in (1..=rings).flat_map(|j| (0..sides).map(move |i| (j, i))) {
        let angle = TAU * i as f64 / sides as f64;
        places.push(map * Vector2::new(angle.cos(), angle.sin()) * j as f64 / rings as f64);
    }
    let simplices = about_a_point(draw, sides, rings);
    let vertices = places.iter().map(|x| flat(*x)).collect();
    Known::pairs(Shape { vertices, simplices }, move |a, b| (places[a] - places[b]).norm())
}

/// Triangles of rings about vertex 0.
fn about_a_point(draw: &mut Draw, sides: usize, rings: usize) -> Vec<[usize; 3]> {
    let at = |i: usize, j: usize| 1 + i % sides + (j - 1) * sides;
    let mut triangles = Vec::new();
    for i in 0..sides {
        triangles.push([0, at(i, 1), at(i + 1, 1)]);
        for j in 1..rings {
            let corners = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend(halves(corners, draw.chance(0.5)));
        }
    }
    triangles
}

/// A rectangle without a block of its cells: a hole, a notch or a corner.
fn notched(draw: &mut Draw) -> Known {
    let [m, n] = [draw.between(2, 10), draw.between(2, 10)];
    let [i, j] = [draw.below(m), draw.below(n)];
    let [k, l] = [draw.between(i + 1, m), draw.between(j + 1, n)];
    // Something is left on each side of the block, across and along.
    let [k, l] =
        [if i == 0 && k == m { m - 1 } else { k }, if j == 0 && l == n { n - 1 } else { l }];
    draw.note(format!("{m} x {n} cells without {i}..{k} x {j}..{l}"));
    let map = affine(draw);
    let triangles = grid(draw, [m, n], |x, y| !((i..k).contains(&x) && (j..l).contains(&y)));
    let mut numbers = vec![usize::MAX; (m + 1) * (n + 1)];
    let mut places: Vec<Vector2<f64>> = Vec::new();
    for &v in triangles.as_flattened() {
        if numbers[v] == usize::MAX {
            numbers[v] = places.len();
            places.push(Vector2::new((v % (m + 1)) as f64, (v / (m + 1)) as f64));
        }
    }
    let simplices = triangles.into_iter().map(|t| t.map(|v| numbers[v])).collect();
    let vertices = places.iter().map(|x| flat(map * x)).collect();
    // Beyond the rectangle the block goes on: nothing passes there.
    let beyond = |at: usize, end: usize, to: f64| if at == end { to } else { at as f64 };
    let low = Vector2::new(beyond(i, 0, -1.0), beyond(j, 0, -1.0));
    let high = Vector2::new(beyond(k, m, m as f64 + 1.0), beyond(l, n, n as f64 + 1.0));
    let corners: Vec<Vector2<f64>> = [low.x, high.x]
        .into_iter()
        .flat_map(|x| [low.y, high.y].map(|y| Vector2::new(x, y)))
        .filter(|c| (0.0..=m as f64).contains(&c.x) && (0.0..=n as f64).contains(&c.y))
        .collect();
    let seen = move |a: Vector2<f64>, b: Vector2<f64>| {
        if crosses(a, b, low, high) { f64::INFINITY } else { (map * (a - b)).norm() }
    };
    let count = corners.len();
    let mut between: Vec<Vec<f64>> =
        corners.iter().map(|a| corners.iter().map(|b| seen(*a, *b)).collect()).collect();
    for via in 0..count {
        for a in 0..count {
            for b in 0..count {
                between[a][b] = between[a][b].min(between[a][via] + between[via][b]);
            }
        }
    }
    Known::pairs(Shape { vertices, simplices }, move |s, v| {
        let mut least = seen(places[s], places[v]);
        for a in 0..count {
            for b in 0..count {
                let way = seen(places[s], corners[a]) + between[a][b] + seen(corners[b], places[v]);
                least = least.min(way);
            }
        }
        least
    })
}

/// Whether a segment passes through the inside of a box.
fn crosses(a: Vector2<f64>, b: Vector2<f64>, low: Vector2<f64>, high: Vector2<f64>) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for c in 0..2 {
        let way = b[c] - a[c];
        if way == 0.0 {
            if a[c] <= low[c] || a[c] >= high[c] {
                return false;
            }
        } else {
            let [s, t] = [(low[c] - a[c]) / way, (high[c] - a[c]) / way];
            enter = enter.max(s.min(t));
            leave = leave.min(s.max(t));
        }
    }
    leave - enter > 1e-12
}

/// A tube of flat sides, open at both ends.
fn prism(draw: &mut Draw) -> Known {
    let [sides, rows] = [draw.between(3, 12), draw.between(1, 10)];
    let height = draw.log_uniform(0.05, 20.0);
    draw.note(format!("a prism of {sides} sides and {rows} rows, {height:.2} sides high"));
    let radius = 0.5 / (PI / sides as f64).sin();
    let (mut places, mut vertices) = (Vec::new(), Vec::new());
    for (j, i) in (0..=rows).flat_map(|j| (0..sides).map(move |i| (j, i))) {
        let off = if j == 0 || j == rows { 0.0 } else { 0.4 * draw.symmetric() };
        let z = height * (j as f64 + off) / rows as f64;
        let angle = TAU * i as f64 / sides as f64;
        places.push(Vector2::new(i as f64, z));
        vertices.push(Vector3::new(radius * angle.cos(), radius * angle.sin(), z));
    }
    let at = |i: usize, j: usize| i % sides + j * sides;
    let mut simplices = Vec::new();
    for (j, i) in (0..rows).flat_map(|j| (0..sides).map(move |i| (j, i))) {
        let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        simplices.extend(halves(corners, draw.chance(0.5)));
    }
    Known::pairs(Shape { vertices, simplices }, move |a, b| {
        let off = places[a] - places[b];
        let around = off.x.abs().min(sides as f64 - off.x.abs());
        around.hypot(off.y)
    })
}

/// A cone of flat sides about its apex, sharp or with more than a full turn about it.
fn cone(draw: &mut Draw) -> Known {
    let wavy = draw.chance(0.5);
    let rings = draw.between(1, 6);
    let sides = if wavy { 2 * draw.between(2, 6) } else { draw.between(3, 12) };
    let up = draw.uniform(0.05, 1.2);
    let direction = |i: usize| {
        let angle = TAU * i as f64 / sides as f64;
        let up = if wavy && i % 2 == 1 { -up } else { up };
        Vector3::new(up.cos() * angle.cos(), up.cos() * angle.sin(), up.sin())
    };
    let one = direction(0).angle(&direction(1));
    draw.note(format!(
        "a cone of {sides} sides, {:.3} turns about its apex",
        one * sides as f64 / TAU
    ));
    let mut vertices = vec![Vector3::zeros()];
    let mut places = vec![(0.0, 0)];
    for j in 1..=rings {
        for i in 0..sides {
            vertices.push(direction(i) * j as f64);
            places.push((j as f64, i));
        }
    }
    let simplices = about_a_point(draw, sides, rings);
    Known::pairs(Shape { vertices, simplices }, move |a, b| {
        let ((r, i), (s, k)) = (places[a], places[b]);
        let steps = i.abs_diff(k);
        let turn = steps.min(sides - steps) as f64 * one;
        if r == 0.0 || s == 0.0 || turn >= PI {
            return r + s;
        }
        (r - s).hypot(2.0 * (r * s).sqrt() * (turn / 2.0).sin())
    })
}

/// Two rectangles sewn together along their rims.
fn pillow(draw: &mut Draw) -> Known {
    let [m, n] = [draw.between(2, 6), draw.between(2, 6)];
    let [a, b] = [1.0, draw.log_uniform(0.02, 1.0)];
    draw.note(format!("a pillow of {m} x {n} cells, {a} by {b:.3}"));
    let mut places: Vec<(Vector2<f64>, bool)> = Vec::new();
    for (j, i) in (0..=n).flat_map(|j| (0..=m).map(move |i| (j, i))) {
        places.push((Vector2::new(a * i as f64 / m as f64, b * j as f64 / n as f64), false));
    }
    // No edge leads from rim to rim but along it, where it would be one for both sides: in a corner's
    // cell the diagonal begins at the corner.
    let side = |draw: &mut Draw| {
        let at = |i: usize, j: usize| i + j * (m + 1);
        let mut triangles = Vec::new();
        for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let any = draw.chance(0.5);
            let other = match (i == 0, i == m - 1, j == 0, j == n - 1) {
                (true, _, true, _) | (_, true, _, true) => false,
                (_, true, true, _) | (true, _, _, true) => true,
                _ => any,
            };
            triangles.extend(halves(corners, other));
        }
        triangles
    };
    let front = side(draw);
    let mut behind: Vec<usize> = (0..places.len()).collect();
    for (j, i) in (1..n).flat_map(|j| (1..m).map(move |i| (j, i))) {
        behind[i + j * (m + 1)] = places.len();
        places.push((places[i + j * (m + 1)].0, true));
    }
    let back = side(draw).into_iter().map(|[x, y, z]| [y, x, z].map(|v| behind[v]));
    let simplices = front.into_iter().chain(back).collect();
    let vertices = places.iter().map(|x| flat(x.0)).collect();
    Known::pairs(Shape { vertices, simplices }, move |s, v| {
        let laid = |v: usize| {
            let (x, is_behind) = places[v];
            if is_behind { Vector2::new(-x.x, x.y) } else { x }
        };
        let (x, y) = (laid(s), laid(v));
        let mut least = f64::INFINITY;
        for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))) {
            let shift = Vector2::new(2.0 * a * f64::from(i), 2.0 * b * f64::from(j));
            least = least.min((y + shift - x).norm()).min((shift - y - x).norm());
        }
        least
    })
}

/// A sphere of triangles: paths on it are as long as great circles within the ratio of its inscribed
/// radius.
fn sphere(draw: &mut Draw) -> Known {
    let levels = draw.between(0, 3);
    draw.note(format!("a sphere refined {levels} times"));
    let Ok(mesh) = icosphere(1.0, levels) else { return bumpy(draw) };
    let vertices = mesh.vertices().to_vec();
    let shape = Shape { vertices: vertices.clone(), simplices: mesh.simplices().to_vec() };
    let height = |&[a, b, c]: &[usize; 3]| {
        let normal = (vertices[b] - vertices[a]).cross(&(vertices[c] - vertices[a])).normalize();
        normal.dot(&vertices[a]).abs()
    };
    let inner = mesh.simplices().iter().map(height).fold(1.0, f64::min);
    let truth = move |sources: &[usize]| {
        let nearest = |x: &Vector3<f64>| {
            sources.iter().map(|&s| x.angle(&vertices[s])).fold(f64::INFINITY, f64::min)
        };
        vertices.iter().map(|x| (nearest(x), nearest(x) * (1.0 / inner - 1.0 + ROUNDING))).collect()
    };
    Known { shape, truth: Box::new(truth) }
}

/// A ball with bumps, by a graph.
fn bumpy(draw: &mut Draw) -> Known {
    draw.note("a ball with bumps");
    let shape = bumpy_ball(draw);
    let own = shape.clone();
    let truth = move |sources: &[usize]| {
        let (rough, straight) = through_edges(&own, 60, sources);
        // A path over other edges may be shorter still, by less than the graph could tell; more so
        // where this one comes near a vertex that it might pass on the other side.
        let unsure =
            |r: f64, s: f64, caught: bool| 2.0 * (r - s) + s * if caught { 5e-2 } else { 3e-3 };
        let pairs = rough.into_iter().zip(straight);
        pairs.map(|(r, (s, caught))| (s, unsure(r, s, caught))).collect()
    };
    Known { shape, truth: Box::new(truth) }
}
