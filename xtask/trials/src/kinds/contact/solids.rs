//! Convex solids as the referee of contact points knows them: how far they reach along a direction, and
//! how far outside of them a point is. Nothing of contact's is used.
//!
//! ```text
//! s(n) = -h_2(-n) - h_1(n) <= gap           any unit n;  h(n) = max of n.x over the solid
//! ```

use std::ops::{Add, Mul, Neg, Sub};

use crate::kinds::rigid::double_double::Twofold;

/// Numbers of 16 digits, to search with, and of 32, to judge by.
pub(super) trait Number:
    Copy
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + From<f64>
{
    fn root(self) -> Self;
    fn over(self, other: Self) -> Self;
    fn value(self) -> f64;
}

impl Number for f64 {
    fn root(self) -> Self {
        self.max(0.0).sqrt()
    }

    fn over(self, other: Self) -> Self {
        self / other
    }

    fn value(self) -> f64 {
        self
    }
}

impl Number for Twofold {
    fn root(self) -> Self {
        self.sqrt()
    }

    fn over(self, other: Self) -> Self {
        self / other
    }

    fn value(self) -> f64 {
        Twofold::value(self)
    }
}

pub(super) type Three<T> = [T; 3];

pub(super) fn dot<T: Number>(a: &Three<T>, b: &Three<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<T: Number>(a: &Three<T>, b: &Three<T>) -> Three<T> {
    let at = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [at(1, 2), at(2, 0), at(0, 1)]
}

pub(super) fn minus<T: Number>(a: &Three<T>, b: &Three<T>) -> Three<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn norm<T: Number>(a: &Three<T>) -> T {
    dot(a, a).root()
}

/// A vector of length 1 along another; none along zero.
pub(super) fn unit<T: Number>(a: &Three<T>) -> Option<Three<T>> {
    let largest = a.iter().map(|x| x.value().abs()).fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let scaled = a.map(|x| x.over(T::from(largest)));
    let length = norm(&scaled);
    Some(scaled.map(|x| x.over(length)))
}

pub(super) fn exactly<T: Number>(a: [f64; 3]) -> Three<T> {
    a.map(T::from)
}

fn larger<T: Number>(a: T, b: T) -> T {
    if (a - b).value() >= 0.0 { a } else { b }
}

fn size<T: Number>(a: T) -> T {
    if a.value() < 0.0 { -a } else { a }
}

/// A solid in its own axes, m.
#[derive(Clone, Debug)]
pub enum Form {
    /// Its radius.
    Ball(f64),
    /// Half length along z and radius.
    Capsule(f64, f64),
    /// Half length along z and radius.
    Cylinder(f64, f64),
    /// Height along z and radius; the origin is its centre of mass.
    Cone(f64, f64),
    /// Half axes.
    Ellipsoid([f64; 3]),
    /// Half sizes.
    Box([f64; 3]),
    /// Its corners, and perhaps others within.
    Hull(Vec<[f64; 3]>),
    /// Below z = 0.
    Floor,
}

/// A solid at a place.
#[derive(Clone, Debug)]
pub(super) struct Solid<T> {
    pub(super) form: Form,
    centre: Three<T>,
    /// Columns of its rotation.
    axes: [Three<T>; 3],
    /// Corners of what has flat faces alone, world axes, from the centre.
    corners: Vec<Three<T>>,
    /// Normals of these faces.
    pub(super) normals: Vec<Three<T>>,
}

impl Form {
    /// The distance of its farthest point from its origin.
    pub(super) fn size(&self) -> f64 {
        match self {
            Form::Ball(r) => *r,
            Form::Capsule(a, r) => a + r,
            Form::Cylinder(a, r) => a.hypot(*r),
            Form::Cone(h, r) => (0.25 * h).hypot(*r).max(0.75 * h),
            Form::Ellipsoid(half) => half.iter().copied().fold(0.0, f64::max),
            Form::Box([a, b, c]) => a.hypot(*b).hypot(*c),
            Form::Hull(corners) => {
                corners.iter().map(|[x, y, z]| x.hypot(*y).hypot(*z)).fold(0.0, f64::max)
            }
            Form::Floor => 0.0,
        }
    }

    /// Half of how thin it is, or less.
    pub(super) fn thin(&self) -> f64 {
        match self {
            Form::Ball(r) => *r,
            Form::Capsule(a, r) | Form::Cylinder(a, r) => a.min(*r),
            Form::Cone(h, r) => 0.25 * h.min(*r),
            Form::Ellipsoid(half) | Form::Box(half) => {
                half.iter().copied().fold(f64::INFINITY, f64::min)
            }
            Form::Hull(_) => 1e-2 * self.size(),
            Form::Floor => f64::INFINITY,
        }
    }

    pub(super) fn corners(&self) -> Vec<[f64; 3]> {
        match self {
            Form::Box(half) => (0..8)
                .map(|k| [0, 1, 2].map(|c| if k >> c & 1 == 0 { half[c] } else { -half[c] }))
                .collect(),
            Form::Hull(corners) => corners.clone(),
            _ => Vec::new(),
        }
    }
}

impl<T: Number> Solid<T> {
    /// The rotation is that of the quaternion over its length.
    pub(super) fn new(form: &Form, centre: [f64; 3], quaternion: [f64; 4]) -> Self {
        let q = quaternion.map(T::from);
        let [w, x, y, z] = q;
        let square = w * w + x * x + y * y + z * z;
        let two = T::from(2.0);
        let (one, over) = (T::from(1.0), |a: T| (two * a).over(square));
        let axes = [
            [one - over(y * y + z * z), over(x * y + w * z), over(x * z - w * y)],
            [over(x * y - w * z), one - over(x * x + z * z), over(y * z + w * x)],
            [over(x * z + w * y), over(y * z - w * x), one - over(x * x + y * y)],
        ];
        let mut solid = Solid {
            form: form.clone(),
            centre: exactly(centre),
            axes,
            corners: Vec::new(),
            normals: Vec::new(),
        };
        solid.corners = form.corners().into_iter().map(|c| solid.outwards(&exactly(c))).collect();
        solid.normals = match form {
            Form::Box(_) => axes.iter().flat_map(|a| [*a, a.map(|x| -x)]).collect(),
            _ => solid.faces(),
        };
        solid
    }

    /// A direction of its own as the world sees it.
    pub(super) fn outwards(&self, own: &Three<T>) -> Three<T> {
        let [a, b, c] = &self.axes;
        [0, 1, 2].map(|k| a[k] * own[0] + b[k] * own[1] + c[k] * own[2])
    }

    fn inwards(&self, n: &Three<T>) -> Three<T> {
        [0, 1, 2].map(|k| dot(&self.axes[k], n))
    }

    /// Its axis, of what is round about z.
    pub(super) fn axis(&self) -> Option<Three<T>> {
        let round = matches!(self.form, Form::Capsule(..) | Form::Cylinder(..) | Form::Cone(..));
        round.then_some(self.axes[2])
    }

    /// Differences of corners.
    pub(super) fn edges(&self) -> Vec<Three<T>> {
        if let Form::Box(_) = self.form {
            return self.axes.to_vec();
        }
        let mut edges = Vec::new();
        for (k, a) in self.corners.iter().enumerate() {
            edges.extend(self.corners[..k].iter().map(|b| minus(a, b)));
        }
        edges
    }

    /// Normals of the planes of three corners that have all others on one side, outwards.
    fn faces(&self) -> Vec<Three<T>> {
        let corners = &self.corners;
        let size = self.form.size();
        let mut normals = Vec::new();
        for i in 0..corners.len() {
            for j in 0..i {
                for k in 0..j {
                    let (a, b) = (minus(&corners[j], &corners[i]), minus(&corners[k], &corners[i]));
                    let Some(n) = unit(&cross(&a, &b)) else { continue };
                    let off = corners.iter().map(|c| dot(&n, &minus(c, &corners[i])).value());
                    let (low, high) =
                        off.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
                    let slack = 1e-10 * size;
                    if high <= slack {
                        normals.push(n);
                    }
                    if low >= -slack {
                        normals.push(n.map(|x| -x));
                    }
                }
            }
        }
        normals
    }

    /// How far it reaches along a unit vector.
    pub(super) fn reach(&self, n: &Three<T>) -> T {
        let own = self.inwards(n);
        let [x, y, z] = own;
        let (zero, around) = (T::from(0.0), (x * x + y * y).root());
        let from_centre = match &self.form {
            Form::Ball(r) => T::from(*r),
            Form::Capsule(a, r) => T::from(*a) * size(z) + T::from(*r),
            Form::Cylinder(a, r) => T::from(*a) * size(z) + T::from(*r) * around,
            Form::Cone(h, r) => {
                let quarter = T::from(0.25) * T::from(*h);
                larger(T::from(3.0) * quarter * z, T::from(*r) * around - quarter * z)
            }
            Form::Ellipsoid(half) => {
                let [x, y, z] = [0, 1, 2].map(|k| own[k] * T::from(half[k]));
                (x * x + y * y + z * z).root()
            }
            Form::Box(half) => {
                [0, 1, 2].map(|k| size(own[k]) * T::from(half[k])).into_iter().fold(zero, T::add)
            }
            Form::Hull(_) => {
                let mut reaches = self.corners.iter().map(|c| dot(c, n));
                let first = reaches.next().unwrap_or(zero);
                reaches.fold(first, larger)
            }
            Form::Floor => zero,
        };
        from_centre + dot(&self.centre, n)
    }

    /// How far outside of it a point is, to first order; negative inside.
    pub(super) fn outside(&self, point: &Three<T>) -> f64 {
        let from = minus(point, &self.centre);
        let own = self.inwards(&from);
        let [x, y, z] = own;
        let around = (x * x + y * y).root();
        let less = |a: T, b: f64| (a - T::from(b)).value();
        match &self.form {
            Form::Ball(r) => less(norm(&own), *r),
            Form::Capsule(a, r) => {
                let off =
                    if less(size(z), *a) > 0.0 { size(z) - T::from(*a) } else { T::from(0.0) };
                less((x * x + y * y + off * off).root(), *r)
            }
            Form::Cylinder(a, r) => less(size(z), *a).max(less(around, *r)),
            Form::Cone(h, r) => {
                let quarter = T::from(0.25) * T::from(*h);
                // On the side h around + r z = 3/4 h r.
                let (h, r) = (T::from(*h), T::from(*r));
                let side = h * around + r * z - T::from(3.0) * quarter * r;
                let side = side.over((h * h + r * r).root()).value();
                side.max((-z - quarter).value())
            }
            Form::Ellipsoid(half) => {
                let scaled = [0, 1, 2].map(|k| own[k].over(T::from(half[k])));
                let level = norm(&scaled);
                let steep = [0, 1, 2].map(|k| scaled[k].over(T::from(half[k])));
                let steep = norm(&steep);
                if steep.value() == 0.0 {
                    return -self.form.thin();
                }
                ((level - T::from(1.0)) * level).over(steep).value()
            }
            Form::Box(half) => {
                [0, 1, 2].map(|k| less(size(own[k]), half[k])).into_iter().fold(f64::MIN, f64::max)
            }
            Form::Hull(_) => self
                .normals
                .iter()
                .map(|n| (dot(n, &from) - self.reach(n) + dot(&self.centre, n)).value())
                .fold(f64::MIN, f64::max),
            Form::Floor => z.value(),
        }
    }
}

/// A bound from below on the gap, by a unit vector from the first to the second.
pub(super) fn separation<T: Number>(solids: [&Solid<T>; 2], n: &Three<T>) -> T {
    let back = n.map(|x| -x);
    -solids[1].reach(&back) - solids[0].reach(n)
}
