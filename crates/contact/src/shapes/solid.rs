//! A convex solid as the hull of points, circles and ellipsoids, and everything within a radius of it.
//!
//! ```text
//! h(n) = max over its parts of h_k(n) + r |n|                     how far it reaches along n
//! point       n.p                       circle      n.c + rho |n - (n.a) a|
//! ellipsoid   n.c + |A R^T n|           A = diag(a_1, a_2, a_3), R its axes
//! ```
//! A ball is a point and a radius, a capsule two points and a radius; a box and a hull are their
//! corners, a cylinder two circles, a cone a point and a circle. Metres, `n` a unit vector, `a` the
//! axis of a circle of radius `rho` about `c`. Source: Rockafellar, Convex Analysis (1970), sections
//! 13 and 16: the support function of a hull is the largest of its parts', that of a sum their sum.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use parry3d_f64::math::Pose;

use crate::shapes::convert::{from_vector, vector};
use crate::shapes::polytope::Polytope;

type V = Vector3<f64>;

/// A part of which a solid is the hull.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Point(V),
    Circle {
        centre: V,
        axis: V,
        radius: f64,
    },
    /// Columns: the half axes.
    Ellipsoid {
        centre: V,
        axes: Matrix3<f64>,
    },
}

/// What lies flat or along a line on a solid, and can lie so on another.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// A point, or a smooth solid.
    Smooth,
    /// Two points.
    Segment,
    /// Two circles about z.
    Cylinder,
    /// A circle about z, and the apex.
    Cone,
    /// Corners of polygons.
    Polytope,
}

/// A convex solid.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    pub(crate) parts: Vec<Part>,
    /// Everything within this distance of the hull belongs to it, m.
    pub(crate) rounding: f64,
    pub(crate) form: Form,
    /// Directions that its faces look in.
    pub(crate) faces: Vec<V>,
    /// Its axis, or none.
    pub(crate) axis: Option<V>,
    /// The farthest that it reaches from its origin, m.
    pub(crate) size: f64,
}

impl Solid {
    pub(crate) fn ball(radius: f64) -> Self {
        let parts = vec![Part::Point(V::zeros())];
        let faces = Vec::new();
        Solid { parts, rounding: radius, form: Form::Smooth, faces, axis: None, size: radius }
    }

    pub(crate) fn capsule(half: f64, radius: f64) -> Self {
        let parts = [-half, half].map(|z| Part::Point(V::z() * z)).to_vec();
        let (form, axis) = (Form::Segment, Some(V::z()));
        Solid { parts, rounding: radius, form, faces: Vec::new(), axis, size: half + radius }
    }

    pub(crate) fn cylinder(half: f64, radius: f64) -> Self {
        let circle = |z: f64| Part::Circle { centre: V::z() * z, axis: V::z(), radius };
        let faces = vec![-V::z(), V::z()];
        let size = half.hypot(radius);
        let (form, axis) = (Form::Cylinder, Some(V::z()));
        Solid { parts: [-half, half].map(circle).to_vec(), rounding: 0.0, form, faces, axis, size }
    }

    /// Its centre of mass is the origin.
    pub(crate) fn cone(height: f64, radius: f64) -> Self {
        let (base, apex) = (V::z() * (-0.25 * height), V::z() * (0.75 * height));
        let parts = vec![Part::Circle { centre: base, axis: V::z(), radius }, Part::Point(apex)];
        let size = (0.25 * height).hypot(radius).max(0.75 * height);
        let (form, axis) = (Form::Cone, Some(V::z()));
        Solid { parts, rounding: 0.0, form, faces: vec![-V::z()], axis, size }
    }

    pub(crate) fn ellipsoid(half: [f64; 3]) -> Self {
        let axes = Matrix3::from_diagonal(&V::from(half));
        let parts = vec![Part::Ellipsoid { centre: V::zeros(), axes }];
        let size = half.into_iter().fold(0.0, f64::max);
        Solid { parts, rounding: 0.0, form: Form::Smooth, faces: Vec::new(), axis: None, size }
    }

    pub(crate) fn polytope(polytope: &Polytope) -> Self {
        let parts = polytope.corners.iter().map(|c| Part::Point(*c)).collect();
        let faces = polytope.faces.iter().map(|face| face.normal).collect();
        let size = polytope.corners.iter().map(|c| c.norm()).fold(0.0, f64::max);
        Solid { parts, rounding: 0.0, form: Form::Polytope, faces, axis: None, size }
    }

    /// How far it reaches along a direction of any length.
    pub(crate) fn reach(&self, n: &V) -> f64 {
        let hull = self.parts.iter().map(|part| part.reach(n)).fold(f64::NEG_INFINITY, f64::max);
        hull + self.rounding * n.norm()
    }

    /// Places its parts and directions as somebody else sees them.
    pub(crate) fn place(&self, pose: &Pose, seen: &mut Placed) {
        let turn = |v: &V| from_vector(pose.rotation * vector(v));
        let there = |v: &V| from_vector(pose * vector(v));
        seen.parts.clear();
        seen.parts.extend(self.parts.iter().map(|part| match part {
            Part::Point(p) => Part::Point(there(p)),
            Part::Circle { centre, axis, radius } => {
                Part::Circle { centre: there(centre), axis: turn(axis), radius: *radius }
            }
            Part::Ellipsoid { centre, axes } => {
                let columns = [0, 1, 2].map(|k| turn(&axes.column(k).into_owned()));
                Part::Ellipsoid { centre: there(centre), axes: Matrix3::from_columns(&columns) }
            }
        }));
        seen.faces.clear();
        seen.faces.extend(self.faces.iter().map(turn));
        seen.axis = self.axis.as_ref().map(turn);
        seen.centre = from_vector(pose.translation);
        seen.rounding = self.rounding;
        seen.size = self.size;
    }
}

/// A solid at a place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Placed {
    pub(crate) parts: Vec<Part>,
    pub(crate) faces: Vec<V>,
    pub(crate) axis: Option<V>,
    pub(crate) centre: V,
    pub(crate) rounding: f64,
    pub(crate) size: f64,
}

impl Placed {
    /// The part that reaches farthest along a unit vector, and how far, without the rounding.
    pub(crate) fn farthest(&self, n: &V) -> (usize, f64) {
        let mut best = (0, f64::NEG_INFINITY);
        for (k, part) in self.parts.iter().enumerate() {
            let reach = part.reach(n);
            if reach > best.1 {
                best = (k, reach);
            }
        }
        best
    }
}

impl Part {
    pub(crate) fn reach(&self, n: &V) -> f64 {
        match self {
            Part::Point(p) => n.dot(p),
            Part::Circle { centre, axis, radius } => {
                n.dot(centre) + radius * (n - axis * n.dot(axis)).norm()
            }
            Part::Ellipsoid { centre, axes } => n.dot(centre) + axes.tr_mul(n).norm(),
        }
    }

    /// Its point that reaches farthest along a direction.
    pub(crate) fn point(&self, n: &V) -> V {
        match self {
            Part::Point(p) => *p,
            Part::Circle { centre, axis, radius } => {
                let across = across(n, axis);
                let length = across.norm();
                if length > 0.0 { centre + across * (radius / length) } else { *centre }
            }
            Part::Ellipsoid { centre, axes } => {
                let own = axes.tr_mul(n);
                centre + axes * (own / own.norm())
            }
        }
    }

    /// How its farthest point moves as a unit vector turns: the Hessian of its reach.
    pub(crate) fn bend(&self, n: &V) -> Matrix3<f64> {
        match self {
            Part::Point(_) => Matrix3::zeros(),
            Part::Circle { axis, radius, .. } => {
                let across = across(n, axis);
                let length = across.norm();
                if length == 0.0 {
                    return Matrix3::zeros();
                }
                let around = axis.cross(&(across / length));
                around * around.transpose() * (radius / length)
            }
            Part::Ellipsoid { axes, .. } => {
                let own = axes.tr_mul(n);
                let length = own.norm();
                let own = own / length;
                let across = Matrix3::identity() - own * own.transpose();
                axes * across * axes.transpose() / length
            }
        }
    }
}

/// What of a direction is across an axis: each time rounding and the axis's own length leave some along it, until
/// hardly any is; nothing where that is never.
pub(crate) fn across(n: &V, axis: &V) -> V {
    let part = |v: &V| v - axis * v.dot(axis);
    let mut once = part(n);
    for _ in 0..3 {
        let again = part(&once);
        if again.norm_squared() > 0.1 * once.norm_squared() {
            return again;
        }
        once = again;
    }
    V::zeros()
}

/// Points on a circle that stand for its disc, counterclockwise about its axis, the first along the
/// direction `from` across it.
pub(crate) fn around(centre: &V, axis: &V, from: &V, radius: f64, count: u32) -> Vec<V> {
    let other = axis.cross(from);
    let at = |k: u32| {
        let (s, c) = (TAU * f64::from(k) / f64::from(count)).sin_cos();
        centre + (from * c + other * s) * radius
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_measure::SplitMix64;

    /// Along directions that are the axis to rounding the point of a circle that reaches farthest is on it.
    #[test]
    fn a_circles_farthest_point_lies_on_it_whatever_the_direction() {
        let mut random = SplitMix64::new(3);
        let mut found = 0;
        for case in 0..200_000 {
            let lean = 10_f64.powf(8.5 * (random.symmetric() - 1.0));
            let axis = V::from_fn(|k, _| if k == 2 { 1.0 } else { lean * random.symmetric() });
            // As a product of rotations leaves it.
            let axis = axis.normalize() * (1.0 + 1e-13 * random.symmetric());
            let off = 10_f64.powf(2.0 * random.symmetric() - 15.0);
            let off = V::from_fn(|_, _| random.symmetric()) * off;
            let n = (axis + off).normalize();
            let circle = Part::Circle { centre: V::zeros(), axis, radius: 1.0 };
            let point = circle.point(&n);
            let height = point.dot(&axis).abs();
            assert!(height < 1e-12, "case {case}: {height:e} above the circle, axis {axis:?}");
            found += usize::from(point != V::zeros());
        }
        assert!(found > 50_000, "only {found} had a farthest point");
    }
}
