//! Hulls of points as referees know them: every direction along which two of them can be farthest apart.
//!
//! ```text
//! gap = max s(n)/|n|,     s(n) = min n.y - max n.x        x y the corners of the first, the second
//! n = e1 x e2,   w - e (w.e)/e.e,   w                     e edges, w from a corner to a corner
//! ```
//! Two edges of one hull give its faces. The largest is among them: the closest points, or what a hull
//! leaves the other by, are on a face, an edge or a corner of each. Any other direction bounds the gap from
//! below, and so it does no harm to try too many.

use stationary_rigid::RigidMotion;

use super::solids::{Form, Number, Solid, Three, cross, dot, exactly, minus, norm, unit};
use crate::kinds::rigid::double_double::{Twofold, add};

/// Two corners, by their numbers.
pub(super) type Line = [usize; 2];

/// A hull of points.
#[derive(Clone, Debug)]
pub(super) struct Hull<T> {
    pub(super) corners: Vec<Three<T>>,
    /// What may be an edge.
    lines: Vec<Line>,
    /// The same without those that are parallel to one before.
    directions: Vec<Line>,
    /// Pairs of lines that may span a face.
    faces: Vec<[Line; 2]>,
    /// Of a polygon, whose third coordinates are zero: what may be a side.
    sides: Vec<Line>,
}

/// How a direction is made from two hulls.
#[derive(Clone, Copy, Debug)]
pub(super) enum Way {
    /// Across two lines, each of the hull of this number; the sign is the last.
    Cross([(usize, Line); 2], bool),
    /// Across a line of a polygon, in its plane; the sign is the last.
    Side((usize, Line), bool),
    /// From a corner of the first to one of the second, across a line of the hull of this number.
    Across([usize; 2], (usize, Line)),
    /// From a corner of the first to one of the second.
    Between([usize; 2]),
}

/// Vectors shorter than this part of what they could be have lost digits, and are not judged by 16.
const ROUGH: f64 = 1e-6;
/// Directions that are worse by more than this part of the size, by 16 digits, are not the best by 32.
const CLEARLY: f64 = 1e-7;

impl Hull<Twofold> {
    /// What a ball, a capsule, a box or a hull is all points within a radius of.
    pub(super) fn core(form: &Form, pose: &RigidMotion) -> Self {
        let (centre, quaternion) = (pose.translation.into(), pose.rotation.quaternion());
        let solid = Solid::<Twofold>::new(form, centre, quaternion);
        let there = |own: [f64; 3]| add(&solid.outwards(&exactly(own)), &exactly(centre));
        match form {
            Form::Capsule(half, _) => {
                Self::new([-half, *half].map(|z| there([0.0, 0.0, z])).to_vec())
            }
            Form::Box(_) => Self::block(form.corners().into_iter().map(there).collect()),
            Form::Hull(_) => Self::new(form.corners().into_iter().map(there).collect()),
            _ => Self::new(vec![there([0.0; 3])]),
        }
    }
}

impl<T: Number> Hull<T> {
    /// Of any points: each two of them may be an edge.
    pub(super) fn new(corners: Vec<Three<T>>) -> Self {
        let count = corners.len();
        let lines: Vec<Line> = (0..count).flat_map(|j| (0..j).map(move |i| [i, j])).collect();
        let face = |k: usize| (0..k).flat_map(move |j| (0..j).map(move |i| [[i, j], [i, k]]));
        let faces = (0..count).flat_map(face).collect();
        Hull { corners, directions: lines.clone(), lines, faces, sides: Vec::new() }
    }

    /// Of the eight corners of a box, whose numbers are the signs of their coordinates.
    pub(super) fn block(corners: Vec<Three<T>>) -> Self {
        let lines = (0..8_usize).flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit]));
        let lines: Vec<Line> = lines.filter(|[i, j]| i != j).collect();
        let directions = [1, 2, 4].map(|bit| [0, bit]).to_vec();
        let faces = vec![[[0, 1], [0, 2]], [[0, 2], [0, 4]], [[0, 1], [0, 4]]];
        Hull { corners, lines, directions, faces, sides: Vec::new() }
    }

    /// Of the corners of a convex polygon, in their order.
    pub(super) fn polygon(corners: Vec<Three<T>>) -> Self {
        let sides = (0..corners.len()).map(|k| [k, (k + 1) % corners.len()]).collect();
        let (lines, directions, faces) = (Vec::new(), Vec::new(), Vec::new());
        Hull { corners, lines, directions, faces, sides }
    }

    pub(super) fn with<U: Number>(&self, number: impl Fn(&T) -> U) -> Hull<U> {
        let corners = self.corners.iter().map(|c| [0, 1, 2].map(|k| number(&c[k]))).collect();
        let Hull { lines, directions, faces, sides, .. } = self.clone();
        Hull { corners, lines, directions, faces, sides }
    }

    fn along(&self, [from, to]: Line) -> Three<T> {
        minus(&self.corners[to], &self.corners[from])
    }

    fn reach(&self, n: &Three<T>) -> T {
        let mut reaches = self.corners.iter().map(|c| dot(c, n));
        let first = reaches.next().unwrap_or(T::from(0.0));
        reaches.fold(first, |a, b| if (a - b).value() >= 0.0 { a } else { b })
    }
}

/// How far two hulls are apart along a unit vector.
pub(super) fn separation<T: Number>([a, b]: [&Hull<T>; 2], n: &Three<T>) -> T {
    let back = n.map(|x| -x);
    -b.reach(&back) - a.reach(n)
}

fn ways<T: Number>([a, b]: [&Hull<T>; 2]) -> Vec<Way> {
    let mut ways = Vec::new();
    let both = |lines: [(usize, Line); 2]| [Way::Cross(lines, false), Way::Cross(lines, true)];
    for (k, hull) in [a, b].into_iter().enumerate() {
        ways.extend(hull.faces.iter().flat_map(|face| both(face.map(|line| (k, line)))));
        let side = |&line: &Line| [Way::Side((k, line), false), Way::Side((k, line), true)];
        ways.extend(hull.sides.iter().flat_map(side));
    }
    for &own in &a.directions {
        ways.extend(b.directions.iter().flat_map(|&other| both([(0, own), (1, other)])));
    }
    for i in 0..a.corners.len() {
        for j in 0..b.corners.len() {
            ways.push(Way::Between([i, j]));
            let at = |line: &&Line, corner: usize| line[0] == corner;
            // A line is taken at one of its ends.
            ways.extend(a.lines.iter().filter(|l| at(l, i)).map(|&l| Way::Across([i, j], (0, l))));
            ways.extend(b.lines.iter().filter(|l| at(l, j)).map(|&l| Way::Across([i, j], (1, l))));
        }
    }
    ways
}

/// The vector of a way, and how long it could be for hulls of a size: much shorter, it has lost digits.
fn vector<T: Number>(hulls: [&Hull<T>; 2], way: Way, size: f64) -> (Three<T>, f64) {
    let [a, b] = hulls;
    let between = |[i, j]: [usize; 2]| minus(&b.corners[j], &a.corners[i]);
    let along = |(k, line): (usize, Line)| hulls[k].along(line);
    match way {
        Way::Cross([e, f], turned) => {
            let (e, f) = (along(e), along(f));
            let n = cross(&e, &f);
            let most = norm(&e).value() * norm(&f).value();
            (if turned { n.map(|x| -x) } else { n }, most)
        }
        Way::Side(line, turned) => {
            let e = along(line);
            let n = [e[1], -e[0], T::from(0.0)];
            (if turned { n.map(|x| -x) } else { n }, norm(&e).value())
        }
        Way::Across(ends, line) => {
            let (e, w) = (along(line), between(ends));
            (cross(&cross(&e, &w), &e), norm(&e).value().powi(2) * size)
        }
        Way::Between(ends) => (between(ends), size),
    }
}

/// The ways by which the largest separation of two hulls may be made, and what each makes by 32 digits; the
/// largest first.
pub(super) fn farthest(hulls: [&Hull<Twofold>; 2]) -> Vec<(Twofold, Way)> {
    let coarse = hulls.map(|hull| hull.with(|x| x.value()));
    let seen = [&coarse[0], &coarse[1]];
    let width = |hull: &Hull<f64>| {
        hull.corners.iter().map(|c| norm(&minus(c, &hull.corners[0]))).fold(0.0, f64::max)
    };
    let size = width(seen[0]) + width(seen[1]);
    let judged = ways(seen).into_iter().map(|way| {
        let (n, most) = vector(seen, way, size);
        let rough = norm(&n) < ROUGH * most;
        (unit(&n).map_or(f64::NEG_INFINITY, |n| separation(seen, &n)), rough, way)
    });
    let judged: Vec<(f64, bool, Way)> = judged.collect();
    let best = judged.iter().map(|(value, ..)| *value).fold(f64::NEG_INFINITY, f64::max);
    let near = judged.iter().filter(|(value, rough, _)| *rough || *value >= best - CLEARLY * size);
    let finely = near.filter_map(|&(.., way)| {
        let n = unit(&vector(hulls, way, size).0)?;
        Some((separation(hulls, &n), way))
    });
    let mut finely: Vec<(Twofold, Way)> = finely.collect();
    finely.sort_by(|x, y| (y.0 - x.0).value().total_cmp(&0.0));
    finely
}
