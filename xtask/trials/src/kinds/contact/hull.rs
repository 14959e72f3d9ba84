//! How deep two bodies are in each other, by axes that separate them: nothing of contact's is used.
//!
//! ```text
//! depth = min over axes n of   s_1(n) + s_2(-n),     s(n) = max over the body of n.x         m
//! ```
//! Of convex bodies the least is taken at the normal of a face of either, or, in space, across an edge
//! of each; beside a ball also along the way to a corner or, in space, to an edge. Negative where they
//! are apart.

use nalgebra::{Matrix3, Vector3};

use super::case::{Form, Thing};

/// A convex body in its own axes: a ball where it has no corners.
#[derive(Clone, Debug)]
pub(super) struct Hull {
    flat: bool,
    /// The radius of a ball; of others, of one that holds them.
    pub(super) radius: f64,
    /// Half of how thin it is.
    pub(super) thin: f64,
    corners: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    /// Pairs of corners.
    edges: Vec<[Vector3<f64>; 2]>,
}

/// Where a body is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) x: Vector3<f64>,
    pub(super) r: Matrix3<f64>,
}

impl Hull {
    pub(super) fn of(thing: &Thing, flat: bool) -> Self {
        let [a, b, c] = thing.half;
        let corners = match (thing.form, flat) {
            (Form::Round, _) => Vec::new(),
            (Form::Simplex, _) => simplex(a, flat),
            (Form::Box, true) => {
                [[a, b], [-a, b], [-a, -b], [a, -b]].map(|[x, y]| Vector3::new(x, y, 0.0)).into()
            }
            (Form::Box, false) => (0..8)
                .map(|k| {
                    let sign = |bit: usize| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
                    Vector3::new(a * sign(0), b * sign(1), c * sign(2))
                })
                .collect(),
        };
        let (normals, edges) = match (thing.form, flat) {
            (Form::Round, _) => (Vec::new(), Vec::new()),
            (_, true) => {
                let next = |k: usize| corners[(k + 1) % corners.len()];
                let edges: Vec<_> = (0..corners.len()).map(|k| [corners[k], next(k)]).collect();
                let normal = |[p, q]: &[Vector3<f64>; 2]| {
                    let along = q - p;
                    Vector3::new(along.y, -along.x, 0.0).normalize()
                };
                (edges.iter().map(normal).collect(), edges)
            }
            (Form::Box, false) => {
                let close = |p: &Vector3<f64>, q: &Vector3<f64>| {
                    (0..3).filter(|&k| p[k] != q[k]).count() == 1
                };
                (vec![Vector3::x(), Vector3::y(), Vector3::z()], joined(&corners, close))
            }
            (Form::Simplex, false) => {
                (corners.iter().map(|c| -c.normalize()).collect(), joined(&corners, |_, _| true))
            }
        };
        let radius = corners.iter().map(|c| c.norm()).fold(0.0, f64::max);
        let radius = if corners.is_empty() { a } else { radius };
        let thin = match (thing.form, flat) {
            (Form::Round, _) => a,
            (Form::Box, true) => a.min(b),
            (Form::Box, false) => a.min(b).min(c),
            (Form::Simplex, _) => 0.5 * a,
        };
        Hull { flat, radius, thin, corners, normals, edges }
    }

    /// The farthest that it reaches along a direction, from its centre.
    fn support(&self, r: &Matrix3<f64>, n: &Vector3<f64>) -> f64 {
        if self.corners.is_empty() {
            return self.radius;
        }
        let own = r.transpose() * n;
        self.corners.iter().map(|c| c.dot(&own)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// How deep it is below a plane through the origin.
    pub(super) fn below(&self, pose: &Pose, normal: &Vector3<f64>) -> f64 {
        self.support(&pose.r, &-normal) - pose.x.dot(normal)
    }

    /// Nearest points of the body's corners and edges to a place give these axes.
    fn axes_to(&self, pose: &Pose, place: &Vector3<f64>, axes: &mut Vec<Vector3<f64>>) {
        axes.extend(self.corners.iter().map(|c| place - (pose.x + pose.r * c)));
        if self.flat {
            return;
        }
        for [p, q] in &self.edges {
            let (p, along) = (pose.x + pose.r * p, pose.r * (q - p));
            let t = (place - p).dot(&along) / along.norm_squared();
            axes.push(place - (p + along * t));
        }
    }
}

/// How deep two bodies are in each other; negative where they are apart.
pub(super) fn depth(hulls: [&Hull; 2], poses: [&Pose; 2]) -> f64 {
    let between = poses[1].x - poses[0].x;
    // Where centres coincide any direction is as good.
    let first = if between == Vector3::zeros() { Vector3::x() } else { between };
    let mut axes = vec![first];
    for k in [0, 1] {
        axes.extend(hulls[k].normals.iter().map(|n| poses[k].r * n));
        if hulls[1 - k].corners.is_empty() {
            hulls[k].axes_to(poses[k], &poses[1 - k].x, &mut axes);
        }
    }
    if !hulls[0].flat {
        for a in &hulls[0].edges {
            let a = poses[0].r * (a[1] - a[0]);
            for b in &hulls[1].edges {
                let b = poses[1].r * (b[1] - b[0]);
                let across = a.cross(&b);
                if across.norm() > 1e-9 * a.norm() * b.norm() {
                    axes.push(across);
                }
            }
        }
    }
    let along = |axis: &Vector3<f64>| {
        let length = axis.norm();
        if length == 0.0 {
            return f64::INFINITY;
        }
        let n = axis / length;
        let overlap = |n: Vector3<f64>| {
            hulls[0].support(&poses[0].r, &n) + hulls[1].support(&poses[1].r, &-n) - between.dot(&n)
        };
        overlap(n).min(overlap(-n))
    };
    axes.iter().map(along).fold(f64::INFINITY, f64::min)
}

fn simplex(radius: f64, flat: bool) -> Vec<Vector3<f64>> {
    if flat {
        let corner = |k: u32| {
            let (s, c) = (std::f64::consts::FRAC_PI_2 * (1.0 + 4.0 * f64::from(k) / 3.0)).sin_cos();
            Vector3::new(c, s, 0.0) * radius
        };
        return (0..3).rev().map(corner).collect();
    }
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    corners.map(|c| Vector3::from(c) * (radius / 3.0_f64.sqrt())).into()
}

fn joined(
    corners: &[Vector3<f64>],
    close: impl Fn(&Vector3<f64>, &Vector3<f64>) -> bool,
) -> Vec<[Vector3<f64>; 2]> {
    let mut edges = Vec::new();
    for (k, p) in corners.iter().enumerate() {
        edges.extend(corners[..k].iter().filter(|q| close(p, q)).map(|q| [*q, *p]));
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing(form: Form, half: [f64; 3]) -> Thing {
        let none = Vector3::zeros();
        Thing {
            form,
            half,
            mass: 1.0,
            restitution: 0.0,
            friction: 0.0,
            place: none,
            turn: none,
            velocity: none,
            spin: none,
        }
    }

    #[test]
    fn depths_of_balls_boxes_and_simplices_are_those_of_closed_forms() {
        let at = |x: f64, y: f64, z: f64| Pose { x: Vector3::new(x, y, z), r: Matrix3::identity() };
        for flat in [true, false] {
            let ball = Hull::of(&thing(Form::Round, [1.0; 3]), flat);
            let cube = Hull::of(&thing(Form::Box, [1.0; 3]), flat);
            let simplex = Hull::of(&thing(Form::Simplex, [1.0; 3]), flat);
            let deep = |a: &Hull, b: &Hull, at: Pose, expected: f64| {
                let origin = Pose { x: Vector3::zeros(), r: Matrix3::identity() };
                let depth = depth([a, b], [&origin, &at]);
                assert!((depth - expected).abs() < 1e-12, "{depth} {expected}");
            };
            deep(&ball, &ball, at(1.5, 0.0, 0.0), 0.5);
            deep(&cube, &ball, at(1.5, 0.3, 0.0), 0.5);
            deep(&cube, &cube, at(1.5, 1.9, 0.0), 0.1);
            // Beside a corner, or an edge.
            deep(&cube, &ball, at(2.0, 2.0, 0.0), 1.0 - 2.0_f64.sqrt());
            let below = |hull: &Hull| hull.below(&at(0.0, 0.5, 0.5), &Vector3::y());
            assert!((below(&ball) - 0.5).abs() < 1e-12 && (below(&cube) - 0.5).abs() < 1e-12);
            let face = if flat { 0.5 } else { 1.0 / 3.0 };
            let down =
                if flat { -Vector3::y() } else { Vector3::new(-1.0, -1.0, -1.0).normalize() };
            let place = Pose { x: down * (face + 0.9), ..at(0.0, 0.0, 0.0) };
            deep(&simplex, &ball, place, 0.1);
        }
        // Edge across edge: cubes turned by an eighth about x and about z.
        let turn = |axis: Vector3<f64>| {
            let angle = nalgebra::Unit::new_normalize(axis);
            nalgebra::Rotation3::from_axis_angle(&angle, std::f64::consts::FRAC_PI_4).into_inner()
        };
        let cube = Hull::of(&thing(Form::Box, [1.0; 3]), false);
        let poses = [
            Pose { x: Vector3::zeros(), r: turn(Vector3::x()) },
            Pose { x: Vector3::y() * (2.0 * 2.0_f64.sqrt() - 0.1), r: turn(Vector3::z()) },
        ];
        let deep = depth([&cube, &cube], [&poses[0], &poses[1]]);
        assert!((deep - 0.1).abs() < 1e-12, "{deep}");
    }
}
