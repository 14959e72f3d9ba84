//! What a joint leaves free, as data.
//!
//! | joint | q | v | motion of the second frame, as seen from the first |
//! | --- | --- | --- | --- |
//! | weld | - | - | none |
//! | hinge | angle | rate | a turn about the axis n |
//! | slider | distance | rate | a shift along n |
//! | screw | angle | rate | both, `pitch` metres a radian |
//! | cylinder | distance, angle | rates | both, on their own |
//! | universal | two angles | rates | a turn about a, then one about b of the turned body |
//! | planar | two distances, angle | rates | shifts along a and b, then a turn across both |
//! | ball | quaternion | angular velocity in its axes | every turn |
//! | free | origin, quaternion | its velocity, angular velocity in its axes | every motion |
//! | rod, on a line, on a circle | | | what keeps the distance, the line, the circle |
//!
//! Metres, radians. The last row's are told by their equations alone: no tree hangs by them.

use nalgebra::Vector3;

use super::JointFault;

/// What a joint leaves free. Axes are told in the joint's frames and have any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Nothing.
    Weld,
    /// A turn about an axis.
    Hinge {
        /// The axis.
        axis: Vector3<f64>,
    },
    /// A shift along an axis.
    Slider {
        /// The axis.
        axis: Vector3<f64>,
    },
    /// A turn about an axis with a shift along it in proportion.
    Screw {
        /// The axis.
        axis: Vector3<f64>,
        /// The shift, metres a radian.
        pitch: f64,
    },
    /// A shift along an axis and a turn about it.
    Cylinder {
        /// The axis.
        axis: Vector3<f64>,
    },
    /// A turn about a first axis, and one about a second that turns with the first.
    Universal {
        /// The axis on the first end, and that on the second.
        axes: [Vector3<f64>; 2],
    },
    /// Shifts along two axes of the first end, and a turn about what is perpendicular to both.
    Planar {
        /// The two axes.
        axes: [Vector3<f64>; 2],
    },
    /// Every turn about a point.
    Ball,
    /// Every motion.
    Free,
    /// What keeps the distance of two points: a rod with a ball joint at either end.
    Rod {
        /// The distance, metres.
        length: f64,
    },
    /// What keeps a point of the second end on a straight line of the first.
    OnLine {
        /// The direction of the line, which passes through the origin of the frame.
        axis: Vector3<f64>,
    },
    /// What keeps a point of the second end on a circle of the first.
    OnCircle {
        /// The axis of the circle, which has its centre at the origin of the frame.
        axis: Vector3<f64>,
        /// The radius, metres.
        radius: f64,
    },
}

use JointKind::{
    Ball, Cylinder, Free, Hinge, OnCircle, OnLine, Planar, Rod, Screw, Slider, Universal, Weld,
};

/// Axes closer to parallel than this, as the sine of their angle, span no plane that rounding keeps.
const PARALLEL: f64 = 1e-8;

pub(crate) fn unit(axis: Vector3<f64>) -> Result<Vector3<f64>, JointFault> {
    let largest = axis.amax();
    if !axis.iter().all(|c| c.is_finite()) || largest == 0.0 {
        return Err(JointFault::NoAxis(axis.into()));
    }
    Ok((axis / largest).normalize())
}

fn pair(axes: [Vector3<f64>; 2]) -> Result<[Vector3<f64>; 2], JointFault> {
    let units = [unit(axes[0])?, unit(axes[1])?];
    if units[0].cross(&units[1]).norm() < PARALLEL {
        return Err(JointFault::Parallel(axes.map(Into::into)));
    }
    Ok(units)
}

impl JointKind {
    /// The kind in a word or two.
    pub fn name(&self) -> &'static str {
        match self {
            Weld => "weld",
            Hinge { .. } => "hinge",
            Slider { .. } => "slider",
            Screw { .. } => "screw",
            Cylinder { .. } => "cylinder",
            Universal { .. } => "universal joint",
            Planar { .. } => "planar joint",
            Ball => "ball joint",
            Free => "free joint",
            Rod { .. } => "rod",
            OnLine { .. } => "point on a line",
            OnCircle { .. } => "point on a circle",
        }
    }

    /// The freedoms that it leaves between its ends.
    pub fn freedoms(&self) -> usize {
        match self {
            Weld => 0,
            Hinge { .. } | Slider { .. } | Screw { .. } => 1,
            Cylinder { .. } | Universal { .. } => 2,
            Planar { .. } | Ball => 3,
            OnLine { .. } | OnCircle { .. } => 4,
            Rod { .. } => 5,
            Free => 6,
        }
    }

    /// The joint with axes of length 1.
    pub(crate) fn checked(self) -> Result<Self, JointFault> {
        Ok(match self {
            Hinge { axis } => Hinge { axis: unit(axis)? },
            Slider { axis } => Slider { axis: unit(axis)? },
            Cylinder { axis } => Cylinder { axis: unit(axis)? },
            Screw { pitch, .. } if !pitch.is_finite() => {
                return Err(JointFault::NotFinite { what: "the pitch", value: pitch });
            }
            Screw { axis, pitch } => Screw { axis: unit(axis)?, pitch },
            Universal { axes } => Universal { axes: pair(axes)? },
            Planar { axes } => Planar { axes: pair(axes)? },
            Rod { length } => Rod { length: JointFault::positive("the length", length)? },
            OnLine { axis } => OnLine { axis: unit(axis)? },
            OnCircle { axis, radius } => {
                OnCircle { axis: unit(axis)?, radius: JointFault::positive("the radius", radius)? }
            }
            Weld | Ball | Free => self,
        })
    }

    /// An error unless a body can hang by it.
    pub(crate) fn of_a_tree(self) -> Result<Self, JointFault> {
        match self {
            Rod { .. } | OnLine { .. } | OnCircle { .. } => Err(JointFault::RowsOnly),
            _ => Ok(self),
        }
    }
}
