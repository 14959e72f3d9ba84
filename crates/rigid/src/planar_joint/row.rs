//! One equation of a joint of the plane, and its derivatives.
//!
//! ```text
//! together   <e, d>                               dx_i = v_i + Z r_i dtheta_i,   d = x_1 - x_2
//! across     <a, d> + offset                      da = Z a dtheta_1
//! turn       theta_1 - theta_2
//! distance   (|d|^2 - L^2) / 2L
//! rolling    -<a, d> + r (theta_2 - theta_1)
//! ```
//! `r_i` from a body's centre to its end and `a` a direction of the first end, both in the world; `Z`
//! a quarter turn.

use nalgebra::{SMatrix, SVector, Vector2};
use stationary_constraints::{BodyNumbers, Measure, Scale};

use super::PlanarJointKind;
use crate::{JointFault, LieGroup, PlanarRotation};

/// An end as it stands in the world; a body's numbers are zero of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub rotation: PlanarRotation,
    /// From the body's centre to the end.
    pub arm: Vector2<f64>,
    pub place: Vector2<f64>,
    /// The angle of the joint's axes.
    pub angle: f64,
}

/// An equation; directions of length 1, in the axes of the first end's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Row {
    Together { axis: usize },
    Across { a: Vector2<f64>, offset: f64 },
    Turn,
    Distance { length: f64 },
    Rolling { a: Vector2<f64>, radius: f64 },
}

/// Along `v_1 theta_1 v_2 theta_2`.
pub(super) type Local = SMatrix<f64, 6, 6>;

fn quarter(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

pub(super) fn unit(axis: Vector2<f64>) -> Result<Vector2<f64>, JointFault> {
    let largest = axis.amax();
    if !axis.iter().all(|c| c.is_finite()) || largest == 0.0 {
        return Err(JointFault::NoAxis([axis.x, axis.y, 0.0]));
    }
    Ok((axis / largest).normalize())
}

impl Row {
    /// The equations of a joint whose axes are turned by `angle` from those of its first body.
    pub(super) fn all(kind: &PlanarJointKind, angle: f64) -> Result<Vec<Row>, JointFault> {
        let along = |axis| unit(axis).map(|axis| PlanarRotation::exp(angle).rotate(&axis));
        let across = |axis| along(axis).map(|a| Row::Across { a: quarter(a), offset: 0.0 });
        let together = [Row::Together { axis: 0 }, Row::Together { axis: 1 }];
        Ok(match *kind {
            PlanarJointKind::Pin => together.to_vec(),
            PlanarJointKind::Weld => [&together[..], &[Row::Turn]].concat(),
            PlanarJointKind::Slider { axis } => vec![across(axis)?, Row::Turn],
            PlanarJointKind::PinInSlot { axis } => vec![across(axis)?],
            PlanarJointKind::Rod { length } => {
                vec![Row::Distance { length: JointFault::positive("the length", length)? }]
            }
            PlanarJointKind::Rolling { axis, radius } => {
                let (a, radius) = (along(axis)?, JointFault::positive("the radius", radius)?);
                vec![Row::Across { a: quarter(a), offset: radius }, Row::Rolling { a, radius }]
            }
        })
    }

    /// Whether a freedom of a body may change it, wherever the bodies are.
    pub(super) fn moves_along(&self, k: usize) -> bool {
        match self {
            Row::Together { axis } => k == *axis || k == 2,
            Row::Turn => k == 2,
            _ => true,
        }
    }

    /// How large its numbers are, of ends whose longest arm is this, metres, among `bodies` bodies.
    pub(super) fn scale(&self, arm: f64, bodies: usize) -> Scale {
        let numbers = BodyNumbers { bodies, stored: 3, freedoms: 3, lengths: 2 };
        let length = match self {
            Row::Turn => return Scale { slope: 1.0, length: 1.0, measure: Measure::Turn(numbers) },
            Row::Together { .. } => arm,
            Row::Across { offset, .. } => arm.max(*offset),
            Row::Distance { length } => arm.max(*length),
            Row::Rolling { radius, .. } => arm.max(*radius),
        };
        Scale { slope: 1.0, length, measure: Measure::Length(numbers) }
    }

    /// The value, in metres or radians.
    pub(super) fn value(&self, [one, other]: &[Placed; 2]) -> f64 {
        let d = one.place - other.place;
        match self {
            Row::Together { axis } => d[*axis],
            Row::Across { a, offset } => one.rotation.rotate(a).dot(&d) + offset,
            Row::Turn => one.angle - other.angle,
            Row::Distance { length } => (d.norm() - length) * (d.norm() + length) / (2.0 * length),
            Row::Rolling { a, radius } => {
                radius * (other.angle - one.angle) - one.rotation.rotate(a).dot(&d)
            }
        }
    }

    /// The differential along `v_1 theta_1 v_2 theta_2`.
    pub(super) fn differential(&self, ends: &[Placed; 2]) -> [f64; 6] {
        let [one, other] = ends;
        match self {
            Row::Together { axis } => pulled(ends, Vector2::ith(*axis, 1.0)),
            Row::Across { a, .. } => {
                let a = one.rotation.rotate(a);
                let mut slope = pulled(ends, a);
                slope[2] += quarter(a).dot(&(one.place - other.place));
                slope
            }
            Row::Turn => [0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
            Row::Distance { length } => pulled(ends, (one.place - other.place) / *length),
            Row::Rolling { a, radius } => {
                let mut slope = Row::Across { a: *a, offset: 0.0 }.differential(ends).map(|s| -s);
                slope[2] -= radius;
                slope[5] += radius;
                slope
            }
        }
    }

    /// Adds `scale` times the second derivatives.
    pub(super) fn add_hessian(&self, ends: &[Placed; 2], scale: f64, hessian: &mut Local) {
        let [one, other] = ends;
        let d = one.place - other.place;
        match self {
            Row::Together { axis } => {
                hessian[(2, 2)] -= scale * one.arm[*axis];
                hessian[(5, 5)] += scale * other.arm[*axis];
            }
            Row::Turn => {}
            Row::Across { a, .. } => {
                let a = one.rotation.rotate(a) * scale;
                hessian[(2, 2)] += a.dot(&(one.arm - d));
                hessian[(5, 5)] += a.dot(&other.arm);
                let turned = quarter(a);
                let pairs = [
                    (0, turned.x),
                    (1, turned.y),
                    (3, -turned.x),
                    (4, -turned.y),
                    (5, -a.dot(&other.arm)),
                ];
                for (k, entry) in pairs {
                    hessian[(2, k)] += entry;
                    hessian[(k, 2)] += entry;
                }
            }
            Row::Distance { length } => {
                let scale = scale / length;
                let rows = [Vector2::x(), Vector2::y()].map(|e| SVector::from(pulled(ends, e)));
                rows.iter().for_each(|row| *hessian += row * row.transpose() * scale);
                hessian[(2, 2)] -= scale * d.dot(&one.arm);
                hessian[(5, 5)] += scale * d.dot(&other.arm);
            }
            Row::Rolling { a, .. } => {
                Row::Across { a: *a, offset: 0.0 }.add_hessian(ends, -scale, hessian);
            }
        }
    }
}

/// What a direction at the first end, and its opposite at the second, do to their bodies.
fn pulled([one, other]: &[Placed; 2], a: Vector2<f64>) -> [f64; 6] {
    [a.x, a.y, a.dot(&quarter(one.arm)), -a.x, -a.y, -a.dot(&quarter(other.arm))]
}
