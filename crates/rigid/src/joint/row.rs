//! One equation of a joint, and its derivatives along the motions of its two bodies.
//!
//! ```text
//! together   <e, d>                   dx_i = v_i + R_i (w_i x c_i),     d = x_1 - x_2
//! across     <R_1 a, d>
//! angle      <R_1 a, R_2 b> - cosine
//! distance   (|d|^2 - L^2) / 2L
//! coordinate -a <R_1 n, d> + b atan2(<R_1 v, R_2 u>, <R_1 u, R_2 u>)     u v n right-handed
//! ```
//! `c_i` the joint's points and `a b u v n` unit directions in the axes of their end, `e` an axis of
//! the world; `v_i w_i` velocities (world axes) and turns (body axes). A differential is a [`Wrench`]
//! for each end, which a unit of the multiplier exerts with its sign turned: the multiplier of an
//! angle is a torque, of the others a force. A coordinate is a shift (`a = 1, b = 0`), a turn (0, 1), or
//! what a screw of pitch p keeps (1, -p); a turn is known up to whole ones, and the coordinate the one
//! nearest to what is asked for. Hessians are those along exponentials, which are symmetric.
//!
//! Source: Haug, Computer Aided Kinematics and Dynamics (1989), 9.4.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use stationary_constraints::{BodyNumbers, Measure, Rows, Scale};

use super::end::Placed;
use super::{JointEnd, JointKind};
use crate::{BodySpace, Wrench};

/// An equation between two ends; directions of length 1, in the axes of their end's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Row {
    Together { axis: usize },
    Across { a: Vector3<f64> },
    Angle { a: Vector3<f64>, b: Vector3<f64>, cosine: f64 },
    Distance { length: f64 },
    Coordinate { first: [Vector3<f64>; 3], second: Vector3<f64>, shift: f64, turn: f64 },
}

/// What a coordinate of a joint measures along its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The turn about it, radians.
    Turn,
    /// The shift along it, metres.
    Shift,
}

impl Along {
    /// How a message names what drives it.
    pub(crate) fn drive(self) -> &'static str {
        match self {
            Along::Turn => "turning drive",
            Along::Shift => "shifting drive",
        }
    }
}

use JointKind::{
    Ball, Cylinder, Free, Hinge, OnCircle, OnLine, Planar, Rod, Screw, Slider, Universal, Weld,
};

/// Along `v_1 w_1 v_2 w_2`.
pub(crate) type Local = SMatrix<f64, 12, 12>;

/// Two directions perpendicular to a unit axis and to each other, and the axis: right-handed.
pub(crate) fn triad(axis: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let mut across = Vector3::zeros();
    across[axis.iamin()] = 1.0;
    let u = axis.cross(&across).normalize();
    [u, axis.cross(&u), *axis]
}

impl Row {
    /// The equations of a checked joint between these ends.
    pub(crate) fn all(kind: &JointKind, ends: &[JointEnd; 2]) -> Vec<Row> {
        let [first, second] = [0, 1]
            .map(|end: usize| move |axis: &Vector3<f64>| ends[end].frame.rotation.rotate(axis));
        let triads = |axis: &Vector3<f64>| {
            let axes = triad(axis);
            (axes.each_ref().map(&first), axes.each_ref().map(&second))
        };
        let together = [0, 1, 2].map(|axis| Row::Together { axis });
        let right = |a: Vector3<f64>, b: Vector3<f64>| Row::Angle { a, b, cosine: 0.0 };
        // The third axes stay parallel; the first ones, too.
        let parallel =
            |a: &[Vector3<f64>; 3], b: &[Vector3<f64>; 3]| [right(a[2], b[0]), right(a[2], b[1])];
        let weld = |a: &[Vector3<f64>; 3], b: &[Vector3<f64>; 3]| {
            [0, 1, 2].map(|k| right(a[k], b[(k + 1) % 3]))
        };
        let across = |a: &[Vector3<f64>; 3]| [Row::Across { a: a[0] }, Row::Across { a: a[1] }];
        match kind {
            Free => Vec::new(),
            Ball => together.to_vec(),
            Weld => {
                let (a, b) = triads(&Vector3::z());
                [together, weld(&a, &b)].concat()
            }
            Hinge { axis } => {
                let (a, b) = triads(axis);
                [&together[..], &parallel(&a, &b)].concat()
            }
            Slider { axis } => {
                let (a, b) = triads(axis);
                [&across(&a)[..], &weld(&a, &b)].concat()
            }
            Cylinder { axis } => {
                let (a, b) = triads(axis);
                [across(&a), parallel(&a, &b)].concat()
            }
            Screw { axis, pitch } => {
                let (a, b) = triads(axis);
                let screw = Row::Coordinate { first: a, second: b[0], shift: 1.0, turn: -pitch };
                [&across(&a)[..], &parallel(&a, &b), &[screw]].concat()
            }
            Universal { axes: [a, b] } => {
                let angle = Row::Angle { a: first(a), b: second(b), cosine: a.dot(b) };
                [&together[..], &[angle]].concat()
            }
            Planar { axes: [a, b] } => {
                let (a, b) = triads(&a.cross(b).normalize());
                [&[Row::Across { a: a[2] }][..], &parallel(&a, &b)].concat()
            }
            Rod { length } => vec![Row::Distance { length: *length }],
            OnLine { axis } => across(&triads(axis).0).to_vec(),
            OnCircle { axis, radius } => {
                vec![Row::Across { a: first(axis) }, Row::Distance { length: *radius }]
            }
        }
    }

    /// The turn of the second end about an axis of the first, radians, or its shift along it, metres.
    pub(crate) fn coordinate(axis: &Vector3<f64>, along: Along, ends: &[JointEnd; 2]) -> Row {
        let axes = triad(axis);
        let first = axes.map(|axis| ends[0].frame.rotation.rotate(&axis));
        let second = ends[1].frame.rotation.rotate(&axes[0]);
        let (shift, turn) = match along {
            Along::Turn => (0.0, 1.0),
            Along::Shift => (1.0, 0.0),
        };
        Row::Coordinate { first, second, shift, turn }
    }

    /// Brings the row's differential, between these ends.
    #[inline]
    pub(crate) fn bring<S: BodySpace>(
        &self,
        number: usize,
        ends: &[JointEnd; 2],
        placed: &[Placed; 2],
        rows: &mut impl Rows,
    ) {
        let wrenches = self.differential(placed);
        let Range { start, end } = self.shifts();
        let shifts = start..end.min(S::TRANSLATION);
        for (end, wrench) in ends.iter().zip(&wrenches) {
            let Some(body) = end.body else { continue };
            let first = S::FREEDOMS * body;
            for k in shifts.clone() {
                rows.add(number, first + k, wrench.force[k]);
            }
            let turns = first + S::TRANSLATION;
            rows.add(number, turns, wrench.torque.x);
            rows.add(number, turns + 1, wrench.torque.y);
            rows.add(number, turns + 2, wrench.torque.z);
        }
    }

    /// The axes of the world along which a shift may change it, wherever the bodies are.
    #[inline]
    pub(crate) fn shifts(&self) -> Range<usize> {
        match self {
            Row::Together { axis } => *axis..axis + 1,
            Row::Angle { .. } | Row::Coordinate { shift: 0.0, .. } => 0..0,
            Row::Across { .. } | Row::Distance { .. } | Row::Coordinate { .. } => 0..3,
        }
    }

    /// How large its numbers are, between these ends among `bodies` bodies.
    pub(crate) fn scale<S: BodySpace>(&self, ends: &[JointEnd; 2], bodies: usize) -> Scale {
        let (stored, freedoms) = (S::STORED, S::FREEDOMS);
        let numbers = BodyNumbers { bodies, stored, freedoms, lengths: S::TRANSLATION };
        match self.length(ends.iter().map(JointEnd::reach).fold(0.0, f64::max)) {
            Some(length) => Scale { slope: 1.0, length, measure: Measure::Length(numbers) },
            None => Scale { slope: 1.0, length: 1.0, measure: Measure::Turn(numbers) },
        }
    }

    /// The length of what it holds, of ends whose longest arm is this, metres; none of an angle.
    pub(crate) fn length(&self, arm: f64) -> Option<f64> {
        match self {
            Row::Angle { .. } | Row::Coordinate { shift: 0.0, .. } => None,
            Row::Together { .. } | Row::Across { .. } => Some(arm),
            Row::Distance { length } => Some(arm.max(*length)),
            Row::Coordinate { turn, .. } => Some(arm.max(turn.abs())),
        }
    }

    /// The value, in metres or as the cosine of an angle.
    #[inline]
    pub(crate) fn value(&self, [one, other]: &[Placed; 2]) -> f64 {
        let d = one.place - other.place;
        match self {
            Row::Together { axis } => d[*axis],
            Row::Across { a } => (one.rotation * a).dot(&d),
            Row::Angle { a, b, cosine } => (one.rotation * a).dot(&(other.rotation * b)) - cosine,
            Row::Distance { length } => (d.norm() - length) * (d.norm() + length) / (2.0 * length),
            Row::Coordinate { .. } => self.value_beyond(&[*one, *other], 0.0),
        }
    }

    /// How far a coordinate is beyond a target: of a turn the short way. Of other rows the value.
    pub(crate) fn value_beyond(&self, ends: &[Placed; 2], target: f64) -> f64 {
        let Row::Coordinate { first: [u, v, n], second, shift, turn } = self else {
            return self.value(ends);
        };
        let [one, other] = ends;
        let mut value = -target;
        if *shift != 0.0 {
            value -= shift * (one.rotation * n).dot(&(one.place - other.place));
        }
        if *turn != 0.0 {
            let seen = one.rotation.tr_mul(&(other.rotation * second));
            value += turn * v.dot(&seen).atan2(u.dot(&seen));
            let whole = TAU * turn.abs();
            value -= whole * (value / whole).round();
        }
        value
    }

    /// The differential: a wrench for each end.
    #[inline]
    pub(crate) fn differential(&self, ends: &[Placed; 2]) -> [Wrench; 2] {
        let [one, other] = ends;
        match self {
            Row::Together { axis } => {
                let e = Vector3::ith(*axis, 1.0);
                // What a body sees of the world's axis is a row of its matrix.
                let seen = [one, other].map(|end| end.rotation.row(*axis).transpose());
                [
                    Wrench { force: e, torque: one.arm.cross(&seen[0]) },
                    Wrench { force: -e, torque: seen[1].cross(&other.arm) },
                ]
            }
            Row::Across { a } => {
                let along = one.rotation * a;
                let d = one.rotation.tr_mul(&(one.place - other.place));
                let mut wrench = one.pushed(along);
                wrench.torque += a.cross(&d);
                [wrench, other.pushed(-along)]
            }
            Row::Angle { a, b, .. } => turned(ends, a, b),
            Row::Distance { length } => {
                let along = (one.place - other.place) / *length;
                [one.pushed(along), other.pushed(-along)]
            }
            Row::Coordinate { first: [u, v, n], second, shift: by_shift, turn: by_turn } => {
                let [shift, shifted] = Row::Across { a: *n }.differential(ends);
                let (angle, across) = (Angle::of(ends, u, v, second), [u, v]);
                let [cosine, sine] = across.map(|a| turned(ends, a, second));
                let bent = |shift: Wrench, cosine: Wrench, sine: Wrench| Wrench {
                    force: -shift.force * *by_shift,
                    torque: (sine.torque * angle.by_sine + cosine.torque * angle.by_cosine)
                        * *by_turn
                        - shift.torque * *by_shift,
                };
                [bent(shift, cosine[0], sine[0]), bent(shifted, cosine[1], sine[1])]
            }
        }
    }

    /// Adds `scale` times the second derivatives.
    pub(crate) fn add_hessian(&self, ends: &[Placed; 2], scale: f64, hessian: &mut Local) {
        let [one, other] = ends;
        let d = one.place - other.place;
        match self {
            Row::Together { axis } => {
                let e = Vector3::ith(*axis, scale);
                add_turn(hessian, W1, curvature(&one.arm, &one.rotation.tr_mul(&e)));
                add_turn(hessian, W2, -curvature(&other.arm, &other.rotation.tr_mul(&e)));
            }
            Row::Across { a } => {
                let along = (one.rotation * a) * scale;
                let seen = one.rotation.tr_mul(&d) * scale;
                let both = a.cross_matrix().transpose() * one.arm.cross_matrix() * scale;
                let own = curvature(a, &seen) + curvature(&one.arm, &(a * scale));
                add_turn(hessian, W1, own + both + both.transpose());
                add_turn(hessian, W2, -curvature(&other.arm, &other.rotation.tr_mul(&along)));
                let moved = a.cross_matrix() * one.rotation.transpose() * scale;
                add_pair(hessian, W1, V1, moved);
                add_pair(hessian, W1, V2, -moved);
                let swung = moved * other.rotation * other.arm.cross_matrix();
                add_pair(hessian, W1, W2, swung);
            }
            Row::Angle { a, b, .. } => add_turned(hessian, ends, a, b, scale),
            Row::Distance { length } => {
                let scale = scale / length;
                let mut slope = SMatrix::<f64, 3, 12>::zeros();
                for (end, first, sign) in [(one, V1, 1.0), (other, V2, -1.0)] {
                    slope.fixed_view_mut::<3, 3>(0, first).fill_diagonal(sign);
                    let turn = end.rotation * end.arm.cross_matrix() * -sign;
                    slope.fixed_view_mut::<3, 3>(0, first + 3).copy_from(&turn);
                    let pull = end.rotation.tr_mul(&d) * (sign * scale);
                    add_turn(hessian, first + 3, curvature(&end.arm, &pull));
                }
                *hessian += slope.transpose() * slope * scale;
            }
            Row::Coordinate { first: [u, v, n], second, shift, turn } => {
                Row::Across { a: *n }.add_hessian(ends, -scale * shift, hessian);
                let angle = Angle::of(ends, u, v, second);
                let scale = scale * turn;
                add_turned(hessian, ends, v, second, scale * angle.by_sine);
                add_turned(hessian, ends, u, second, scale * angle.by_cosine);
                let [c, s] = [u, v].map(|a| along(&turned(ends, a, second)));
                let mixed = c * s.transpose();
                let bent = (c * c.transpose() - s * s.transpose()) * angle.bend
                    + (mixed + mixed.transpose()) * angle.twist;
                *hessian += bent * scale;
            }
        }
    }
}

const V1: usize = 0;
const W1: usize = 3;
const V2: usize = 6;
const W2: usize = 9;

impl Placed {
    /// What a force at the end's point, in world axes, does to its body.
    #[inline]
    fn pushed(&self, force: Vector3<f64>) -> Wrench {
        Wrench { force, torque: self.arm.cross(&self.rotation.tr_mul(&force)) }
    }
}

/// The derivatives of `atan2(s, c)` by its sine and cosine, and their own.
struct Angle {
    by_sine: f64,
    by_cosine: f64,
    /// By the cosine twice; by the sine twice with its sign turned.
    bend: f64,
    /// By both.
    twist: f64,
}

impl Angle {
    fn of(
        [one, other]: &[Placed; 2],
        u: &Vector3<f64>,
        v: &Vector3<f64>,
        b: &Vector3<f64>,
    ) -> Self {
        let seen = one.rotation.tr_mul(&(other.rotation * b));
        let (c, s) = (u.dot(&seen), v.dot(&seen));
        let square = c * c + s * s;
        Angle {
            by_sine: c / square,
            by_cosine: -s / square,
            bend: 2.0 * s * c / (square * square),
            twist: (s * s - c * c) / (square * square),
        }
    }
}

/// The differential of `<R_1 a, R_2 b>`.
#[inline]
fn turned([one, other]: &[Placed; 2], a: &Vector3<f64>, b: &Vector3<f64>) -> [Wrench; 2] {
    let b_seen = one.rotation.tr_mul(&(other.rotation * b));
    let a_seen = other.rotation.tr_mul(&(one.rotation * a));
    [a.cross(&b_seen), b.cross(&a_seen)].map(|torque| Wrench { force: Vector3::zeros(), torque })
}

/// Its second derivatives.
fn add_turned(
    hessian: &mut Local,
    [one, other]: &[Placed; 2],
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    scale: f64,
) {
    let b_seen = one.rotation.tr_mul(&(other.rotation * b));
    let a_seen = other.rotation.tr_mul(&(one.rotation * a));
    add_turn(hessian, W1, curvature(a, &(b_seen * scale)));
    add_turn(hessian, W2, curvature(b, &(a_seen * scale)));
    let moved = one.rotation * a.cross_matrix();
    let cross = moved.transpose() * other.rotation * b.cross_matrix();
    add_pair(hessian, W1, W2, cross * scale);
}

/// A differential as numbers along `v_1 w_1 v_2 w_2`.
pub(crate) fn along(wrenches: &[Wrench; 2]) -> SVector<f64, 12> {
    let mut along = SVector::<f64, 12>::zeros();
    for (first, wrench) in [V1, V2].into_iter().zip(wrenches) {
        along.fixed_rows_mut::<3>(first).copy_from(&wrench.force);
        along.fixed_rows_mut::<3>(first + 3).copy_from(&wrench.torque);
    }
    along
}

/// What the acceleration of a turning vector `v` adds to a Hessian where `g` multiplies it.
pub(crate) fn curvature(v: &Vector3<f64>, g: &Vector3<f64>) -> Matrix3<f64> {
    let product = g * v.transpose();
    (product + product.transpose()) * 0.5 - Matrix3::identity() * g.dot(v)
}

fn add_turn(hessian: &mut Local, at: usize, block: Matrix3<f64>) {
    let mut own = hessian.fixed_view_mut::<3, 3>(at, at);
    own += block;
}

fn add_pair(hessian: &mut Local, row: usize, column: usize, block: Matrix3<f64>) {
    let mut upper = hessian.fixed_view_mut::<3, 3>(row, column);
    upper += block;
    let mut lower = hessian.fixed_view_mut::<3, 3>(column, row);
    lower += block.transpose();
}
