//! Two faces of boxes that look at each other: the corners of what they share, as seen along a direction.
//!
//! ```text
//! x = c + s a + t b + d n,   |s| <= 1, |t| <= 1               a face, seen along n
//! s = alpha.(x - c),   t = beta.(x - c)                        alpha a = beta b = 1, alpha b = beta a = 0
//! p + u (q - p),   s_p + u (s_q - s_p) = +-1                   where the edge from p to q crosses another
//! ```
//! `c` the centre, `a b` the half edges (m), `alpha beta` their duals across `n`. A corner faces the point of the other
//! face that is seen in the same place; where two edges cross, the point of the first face's is the one that is seen
//! where the second's is, so that points face each other to rounding however nearly parallel the edges are.
//!
//! Source: Sutherland and Hodgman 1974, "Reentrant polygon clipping", for two parallelograms.

use parry3d_f64::math::Vector;
use parry3d_f64::shape::PackedFeatureId;

/// Places of corners in a face, each joined to the next by an edge.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
/// The edge after each corner: which coordinate it keeps, and at what.
const EDGES: [(usize, f64); 4] = [(1, -1.0), (0, 1.0), (1, 1.0), (0, -1.0)];
/// Edges at a smaller sine to each other are parallel: corners say where they end.
const PARALLEL: f64 = 2e-8;

/// The face of a box that looks most along a direction, seen along it.
pub(crate) struct Face {
    /// The number of the axis that it is across, and whether it looks against it.
    across: usize,
    against: bool,
    centre: Vector,
    halves: [Vector; 2],
    duals: [Vector; 2],
    /// The normal `m` over `n.m`.
    slope: Vector,
}

impl Face {
    /// That of a box of these half sizes and axes, with its centre at `from`, which looks along `towards` in its own
    /// axes, seen along `n`.
    #[inline]
    pub(crate) fn of(
        half: Vector,
        axes: &[Vector; 3],
        from: Vector,
        towards: Vector,
        n: Vector,
    ) -> Self {
        let (half, towards) = (half.to_array(), towards.to_array());
        let across = (1..3).fold(0, |most, k| match towards[k].abs() > towards[most].abs() {
            true => k,
            false => most,
        });
        let against = towards[across] < 0.0;
        let [normal, a, b] = [0, 1, 2].map(|k| axes[(across + k) % 3] * half[(across + k) % 3]);
        let centre = if against { from - normal } else { from + normal };
        let (across_b, across_a) = (b.cross(n), n.cross(a));
        let duals = [across_b / a.dot(across_b), across_a / b.dot(across_a)];
        let slope = normal / n.dot(normal);
        Face { across, against, centre, halves: [a, b], duals, slope }
    }

    /// The number of a corner in its box, a bit for each axis along which it is behind the centre.
    fn number(&self, corner: usize) -> u32 {
        let [s, t] = CORNERS[corner].map(|side| side < 0.0);
        let bit = |k: usize, behind: bool| u32::from(behind) << ((self.across + k) % 3);
        bit(0, self.against) | bit(1, s) | bit(2, t)
    }

    fn corner(&self, corner: usize) -> u32 {
        PackedFeatureId::vertex(self.number(corner)).0
    }

    /// The name of the edge after a corner.
    fn edge(&self, corner: usize) -> u32 {
        let [a, b] = [corner, (corner + 1) % 4].map(|corner| self.number(corner));
        PackedFeatureId::edge(8 * a.min(b) + a.max(b)).0
    }

    fn name(&self) -> u32 {
        PackedFeatureId::face(2 * self.across as u32 + u32::from(self.against)).0
    }

    #[inline]
    fn at(&self, [s, t]: [f64; 2]) -> Vector {
        self.centre + self.halves[0] * s + self.halves[1] * t
    }

    /// Where a direction leads in this face.
    #[inline]
    fn seen(&self, direction: Vector) -> [f64; 2] {
        [direction.dot(self.duals[0]), direction.dot(self.duals[1])]
    }

    /// Where the corners of another face are seen.
    #[inline]
    fn seen_corners(&self, other: &Self) -> [[f64; 2]; 4] {
        let [c, a, b] = [other.centre - self.centre, other.halves[0], other.halves[1]]
            .map(|direction| self.seen(direction));
        CORNERS.map(|[s, t]| [c[0] + s * a[0] + t * b[0], c[1] + s * a[1] + t * b[1]])
    }

    /// How far along the direction the face is from a point, m.
    #[inline]
    fn distance(&self, from: Vector) -> f64 {
        (self.centre - from).dot(self.slope)
    }
}

/// Says each corner of what two faces share: the names of its features, its points, axes of the first, and the gap.
#[inline]
pub(crate) fn share(
    [first, second]: [&Face; 2],
    n: Vector,
    mut say: impl FnMut([u32; 2], [Vector; 2], f64),
) {
    let inside = |[s, t]: [f64; 2]| s.abs() <= 1.0 && t.abs() <= 1.0;
    let of_first = second.seen_corners(first);
    for (k, _) in of_first.iter().enumerate().filter(|(_, place)| inside(**place)) {
        let corner = first.at(CORNERS[k]);
        let gap = second.distance(corner);
        say([first.corner(k), second.name()], [corner, corner + n * gap], gap);
    }
    let of_second = first.seen_corners(second);
    let lengths = first.halves.map(|half| half.length());
    for j in 0..4 {
        let (p, q) = (of_second[j], of_second[(j + 1) % 4]);
        if inside(p) && inside(q) {
            continue;
        }
        let along = [q[0] - p[0], q[1] - p[1]];
        for (i, &(kept, level)) in EDGES.iter().enumerate() {
            let free = 1 - kept;
            let (before, after) = (p[kept] - level, q[kept] - level);
            if (before < 0.0) == (after < 0.0) || before == 0.0 || after == 0.0 {
                continue;
            }
            let part = before / (before - after);
            let place = p[free] + part * along[free];
            let aside = along.map(f64::abs);
            let parallel = aside[kept] * lengths[kept] <= PARALLEL * aside[free] * lengths[free];
            if place.abs() >= 1.0 || parallel {
                continue;
            }
            let mut on_edge = [level; 2];
            on_edge[free] = place;
            let corners = [j, (j + 1) % 4].map(|k| second.at(CORNERS[k]));
            let points = [first.at(on_edge), corners[0] + (corners[1] - corners[0]) * part];
            let gap = (points[1] - points[0]).dot(n);
            say([first.edge(i), second.edge(j)], points, gap);
        }
    }
    for (k, _) in of_second.iter().enumerate().filter(|(_, place)| inside(**place)) {
        let corner = second.at(CORNERS[k]);
        let gap = -first.distance(corner);
        say([first.name(), second.corner(k)], [corner - n * gap, corner], gap);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d_f64::math::Pose;
    use stationary_measure::SplitMix64;

    type P = [f64; 2];

    fn cross(a: P, b: P) -> f64 {
        a[0] * b[1] - a[1] * b[0]
    }

    /// What is left of a polygon on the inner side of each edge of another, which turns to the left.
    fn clipped(polygon: &[P], by: &[P]) -> Vec<P> {
        let mut left = polygon.to_vec();
        for k in 0..by.len() {
            let (from, to) = (by[k], by[(k + 1) % by.len()]);
            let edge = [to[0] - from[0], to[1] - from[1]];
            let side = |p: P| cross(edge, [p[0] - from[0], p[1] - from[1]]);
            let whole = std::mem::take(&mut left);
            for (i, &p) in whole.iter().enumerate() {
                let q = whole[(i + 1) % whole.len()];
                if side(p) >= 0.0 {
                    left.push(p);
                }
                if (side(p) >= 0.0) != (side(q) >= 0.0) {
                    let part = side(p) / (side(p) - side(q));
                    left.push([p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1])]);
                }
            }
        }
        left
    }

    /// The corners of a face across `n`, turning to the left.
    fn seen(face: &Face, [u, v]: [Vector; 2]) -> Vec<P> {
        let corners = CORNERS.map(|place| face.at(place));
        let mut seen: Vec<P> = corners.iter().map(|c| [c.dot(u), c.dot(v)]).collect();
        let side = |a: P, b: P| [b[0] - a[0], b[1] - a[1]];
        if cross(side(seen[0], seen[1]), side(seen[1], seen[2])) < 0.0 {
            seen.reverse();
        }
        seen
    }

    #[test]
    fn two_faces_share_the_polygon_that_clipping_leaves_and_their_points_face_each_other() {
        let mut random = SplitMix64::new(12);
        let identity = [Vector::X, Vector::Y, Vector::Z];
        let (mut shared, mut nearly_parallel) = (0, 0);
        for k in 0..4_000 {
            let scale = 10_f64.powf(6.0 * random.symmetric());
            let mut three = |size: f64, shift: f64| {
                let x = [random.symmetric(), random.symmetric(), random.symmetric()];
                Vector::from_array(x) * size + Vector::splat(shift)
            };
            let halves = [three(0.4, 0.6), three(0.4, 0.6)].map(|half| half * scale);
            // Every other turns about the normal alone, some of them hardly.
            let turn = match k % 4 {
                0 => Vector::Z * 1e-9,
                1 => Vector::Z * three(2.0, 0.0).x,
                _ => three(0.5, 0.0),
            };
            let pose = Pose::new(three(0.8, 0.0) * scale, turn);
            let axes = identity.map(|axis| pose.rotation * axis);
            let from = pose.translation + Vector::Z * 1.2 * scale;
            let n = if k % 3 == 0 { axes[2] } else { Vector::Z };
            let own = Vector::from_array(axes.map(|axis| axis.dot(-n)));
            let faces = [
                Face::of(halves[0], &identity, Vector::ZERO, n, n),
                Face::of(halves[1], &axes, from, own, n),
            ];
            let across = [n.cross(Vector::Y).normalize(), n.cross(n.cross(Vector::Y).normalize())];
            let expected = clipped(&seen(&faces[0], across), &seen(&faces[1], across));
            let mut found: Vec<P> = Vec::new();
            share(faces.each_ref(), n, |_, [one, other], gap| {
                assert!((other - one - n * gap).length() < 1e-14 * scale, "{k}");
                found.push([one.dot(across[0]), one.dot(across[1])]);
                for (face, point) in faces.iter().zip([one, other]) {
                    let [s, t] = face.seen(point - face.centre);
                    assert!(s.abs().max(t.abs()) <= 1.0 + 1e-14, "{k} {s} {t}");
                    assert!(face.distance(point).abs() < 1e-14 * scale, "{k}");
                }
            });
            let near = |a: &P, b: &P| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-8 * scale;
            for point in &found {
                let on_border = |(i, a): (usize, &P)| {
                    let b = expected[(i + 1) % expected.len()];
                    let edge = [b[0] - a[0], b[1] - a[1]];
                    let length = edge[0].hypot(edge[1]);
                    cross(edge, [point[0] - a[0], point[1] - a[1]]).abs() < 1e-13 * scale * length
                        || length < 1e-14 * scale
                };
                assert!(expected.iter().enumerate().any(on_border), "{k} {point:?}");
            }
            // Where edges are nearly parallel a corner of the polygon is none that matters.
            for corner in expected.iter().filter(|_| k % 4 != 0) {
                assert!(found.iter().any(|point| near(point, corner)), "{k} {corner:?}");
            }
            shared += found.len();
            nearly_parallel += u32::from(k % 4 == 0 && !found.is_empty());
        }
        assert!(shared > 10_000 && nearly_parallel > 500, "{shared} {nearly_parallel}");
    }
}
