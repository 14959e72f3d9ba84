//! Outlines with whole coordinates, judged pair by pair in whole numbers.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use stationary_mesh::{MeshError, Polygon};

use crate::{Draw, Verdict};

type Point = [i64; 2];
type Outline = Vec<Point>;

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.01) {
        return large_comb(draw);
    }
    let mut outlines = match draw.below(8) {
        0 => vec![scattered(draw, 3)],
        1 => vec![scattered(draw, 8)],
        2 => vec![star(draw)],
        3 => vec![comb(draw.between(1, 12), draw.between(1, 30) as i64)],
        4 => nested(draw),
        5 => vec![staircase(draw)],
        6 => (0..draw.between(1, 6)).map(|_| star(draw)).collect(),
        _ => vec![spoiled(draw)],
    };
    // Turned, moved and mirrored, by whole numbers.
    let turns: [[i64; 4]; 6] =
        [[1, 0, 0, 1], [0, -1, 1, 0], [-1, 0, 0, 1], [3, -4, 4, 3], [1, 5, 0, 1], [1, 0, 7, 1]];
    let m = draw.one_of(&turns);
    let shift = [draw.between(0, 2000) as i64 - 1000, draw.between(0, 2000) as i64 - 1000];
    for [x, y] in outlines.iter_mut().flatten() {
        [*x, *y] = [m[0] * *x + m[1] * *y + shift[0], m[2] * *x + m[3] * *y + shift[1]];
    }
    draw.note(format!("{outlines:?}"));
    let power = draw.between(0, 80) as i32 - 40;
    let size = if draw.chance(0.2) { 2.0_f64.powi(power) } else { 1.0 };
    judge(draw, &outlines, size)
}

/// Corners anywhere on a small grid: most such outlines cross or touch themselves.
fn scattered(draw: &mut Draw, most: usize) -> Outline {
    let grid = draw.one_of(&[3, 10, 1000]);
    (0..draw.between(3, most)).map(|_| [draw.below(grid) as i64, draw.below(grid) as i64]).collect()
}

/// Rays from the middle in rising order of angle, rounded to the grid.
fn star(draw: &mut Draw) -> Outline {
    let corners = draw.between(3, 24);
    let size = draw.one_of(&[5.0, 50.0, 1e6]);
    let middle = [draw.symmetric() * 3.0 * size, draw.symmetric() * 3.0 * size];
    (0..corners)
        .map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / corners as f64;
            let r = size * draw.uniform(0.1, 1.0);
            [
                (middle[0] + r * angle.cos()).round() as i64,
                (middle[1] + r * angle.sin()).round() as i64,
            ]
        })
        .collect()
}

/// Teeth upright on a bar.
fn comb(teeth: usize, height: i64) -> Outline {
    let width = 2 * teeth as i64;
    let mut corners = vec![[width, -1], [0, -1]];
    for tooth in 0..teeth as i64 {
        corners.extend([[2 * tooth, height], [2 * tooth + 1, height], [2 * tooth + 1, 0]]);
        corners.push([2 * tooth + 2, 0]);
    }
    corners.pop();
    corners.push([width, 0]);
    corners
}

/// Corners in rows on lines: where a corner meets an edge of the same direction nothing is wrong.
fn staircase(draw: &mut Draw) -> Outline {
    let steps = draw.between(1, 10) as i64;
    let mut corners = vec![[0, 0]];
    for step in 0..steps {
        corners.push([step + 1, step]);
        corners.push([step + 1, step + 1]);
    }
    corners.push([0, steps]);
    if draw.chance(0.5) {
        corners.insert(1, [0, -3]);
        corners.insert(2, [1, -3]);
    }
    corners
}

fn square(x: i64, y: i64, side: i64) -> Outline {
    vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
}

/// Squares within squares, and beside each other, some of them touching.
fn nested(draw: &mut Draw) -> Vec<Outline> {
    let depth = draw.between(1, 5) as i64;
    let mut outlines: Vec<Outline> = (0..depth).map(|k| square(2 * k, 2 * k, 40 - 4 * k)).collect();
    for _ in 0..draw.below(4) {
        outlines.push(square(
            draw.below(60) as i64,
            draw.below(60) as i64,
            1 + draw.below(3) as i64,
        ));
    }
    for outline in &mut outlines {
        if draw.chance(0.4) {
            outline.reverse();
        }
    }
    outlines
}

/// A star with a corner put on another edge, on another corner, or back along its own edge.
fn spoiled(draw: &mut Draw) -> Outline {
    let mut corners = star(draw);
    let (here, there) = (draw.below(corners.len()), draw.below(corners.len()));
    let next = corners[(there + 1) % corners.len()];
    let on = [(corners[there][0] + next[0]) / 2, (corners[there][1] + next[1]) / 2];
    match draw.below(3) {
        0 => corners[here] = on,
        1 => corners.insert(here, on),
        _ => corners.insert(here, corners[there]),
    }
    corners
}

fn side(a: Point, b: Point, c: Point) -> i128 {
    let [a, b, c] = [a, b, c].map(|p| p.map(i128::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn on_segment(a: Point, b: Point, p: Point) -> bool {
    let within = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
    side(a, b, p) == 0 && within(0) && within(1)
}

fn meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    let crosses = side(a, b, c).signum() * side(a, b, d).signum() < 0
        && side(c, d, a).signum() * side(c, d, b).signum() < 0;
    crosses
        || on_segment(a, b, c)
        || on_segment(a, b, d)
        || on_segment(c, d, a)
        || on_segment(c, d, b)
}

type Edge = (usize, usize);

/// All pairs of edges that meet elsewhere than where one ends and the next begins.
fn crossings(outlines: &[Outline]) -> BTreeSet<(Edge, Edge)> {
    let mut edges = Vec::new();
    for (k, corners) in outlines.iter().enumerate() {
        for c in 0..corners.len() {
            edges.push(((k, c), corners[c], corners[(c + 1) % corners.len()], corners.len()));
        }
    }
    let mut found = BTreeSet::new();
    for (j, &(two, c, d, _)) in edges.iter().enumerate() {
        for &(one, a, b, count) in &edges[..j] {
            let bad = if one.0 == two.0 && one.1 + 1 == two.1 {
                on_segment(a, b, d) || on_segment(c, d, a)
            } else if one.0 == two.0 && one.1 == 0 && two.1 + 1 == count {
                on_segment(c, d, b) || on_segment(a, b, c)
            } else {
                meet(a, b, c, d)
            };
            if bad {
                found.insert((one, two));
            }
        }
    }
    found
}

fn twice_area(corners: &[Point]) -> i128 {
    let next = corners.iter().cycle().skip(1);
    let terms = corners.iter().zip(next).map(|(p, q)| side([0, 0], *p, *q));
    terms.sum()
}

/// Whether an outline goes around a point that is not on it.
fn winds(corners: &[Point], p: Point) -> bool {
    let mut odd = false;
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (low, high) = if a[1] <= b[1] { (*a, *b) } else { (*b, *a) };
        if low[1] <= p[1] && p[1] < high[1] && side(low, high, p) > 0 {
            odd = !odd;
        }
    }
    odd
}

fn judge(draw: &mut Draw, outlines: &[Outline], size: f64) -> Verdict {
    let place = |p: &Point| Vector2::new(p[0] as f64 * size, p[1] as f64 * size);
    let given: Vec<Vec<_>> =
        outlines.iter().map(|corners| corners.iter().map(place).collect()).collect();
    let repeats = outlines
        .iter()
        .any(|corners| (0..corners.len()).any(|c| corners[c] == corners[(c + 1) % corners.len()]));
    let expected = crossings(outlines);
    let polygon = match Polygon::new(given) {
        Ok(_) if repeats => return Verdict::wrong("a corner that repeats is accepted"),
        Ok(_) if !expected.is_empty() => return Verdict::wrong("outlines that meet are accepted"),
        Ok(polygon) => polygon,
        Err(MeshError::RepeatedCorner { .. }) if repeats => return Verdict::due(),
        Err(MeshError::Crossing(places)) if !expected.is_empty() => {
            let found: BTreeSet<_> = places.0.into_iter().collect();
            let all = expected.len() <= 1000;
            return if all && found != expected || !found.is_subset(&expected) {
                Verdict::wrong(format!("{found:?} listed instead of {expected:?}"))
            } else {
                Verdict::due()
            };
        }
        Err(error) => return Verdict::wrong(format!("simple outlines refused: {error}")),
    };
    let depth = |k: usize| {
        let others = outlines.iter().enumerate().filter(|(other, _)| *other != k);
        others.filter(|(_, corners)| winds(corners, outlines[k][0])).count()
    };
    let mut area = 0;
    let mut whole = 0;
    for (k, corners) in outlines.iter().enumerate() {
        let own = twice_area(corners).abs();
        if polygon.depths()[k] != depth(k) {
            return Verdict::wrong(format!("outline {k} at depth {}", polygon.depths()[k]));
        }
        area += if depth(k) % 2 == 0 { own } else { -own };
        whole += own;
    }
    let off = polygon.moments().measure - 0.5 * area as f64 * size * size;
    let verdict = Verdict::of(off.abs(), 1e-12 * whole as f64 * size * size, "the area");
    let p = [draw.between(0, 200) as i64 - 100, draw.between(0, 200) as i64 - 100];
    let on_edge = outlines.iter().any(|corners| {
        corners.iter().zip(corners.iter().cycle().skip(1)).any(|(a, b)| on_segment(*a, *b, p))
    });
    let inside = on_edge || outlines.iter().filter(|corners| winds(corners, p)).count() % 2 == 1;
    if polygon.contains(&place(&p)) == inside {
        verdict
    } else {
        Verdict::wrong(format!("{p:?} inside: {}", !inside))
    }
}

/// A comb of thousands of teeth, upright and lying down: simple, and of the area of its teeth and bar. What
/// it costs is counted in comparisons by the crate itself.
fn large_comb(draw: &mut Draw) -> Verdict {
    let (teeth, height) = (draw.between(1000, 2500), draw.between(10, 4000) as i64);
    draw.note(format!("a comb of {teeth} teeth, {height} high, upright and lying"));
    let corners = comb(teeth, height);
    let area = (teeth as i64 * (height + 2)) as f64;
    let judged = |turned: bool| {
        let place = |p: &Point| {
            let [x, y] = p.map(|x| x as f64);
            if turned { Vector2::new(-y, x) } else { Vector2::new(x, y) }
        };
        match Polygon::new(vec![corners.iter().map(place).collect()]) {
            Ok(polygon) => {
                let off = (polygon.moments().measure - area).abs();
                Verdict::of(off, 1e-12 * area, "the area of a comb")
            }
            Err(error) => Verdict::wrong(format!("a comb is refused: {error}")),
        }
    };
    judged(false).and(judged(true))
}
