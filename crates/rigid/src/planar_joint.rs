//! Joints of the plane as data, and as constraints on bodies of the plane.
//!
//! | joint | rows | equations |
//! | --- | --- | --- |
//! | pin | 2 | `x_1 - x_2 = 0` |
//! | weld | 3 | and `theta_1 - theta_2 = 0` |
//! | slider | 2 | `<n_1, x_1 - x_2> = 0`, `theta_1 - theta_2 = 0` |
//! | pin in a slot | 1 | `<n_1, x_1 - x_2> = 0` |
//! | rod | 1 | `(\|x_1 - x_2\|^2 - L^2) / 2L = 0` |
//! | rolling | 2 | `<n_1, x_2 - x_1> = r`, `<a_1, x_2 - x_1> + r (theta_2 - theta_1) = 0` |
//!
//! `x` the origins of the joint's frames (m) and `theta` their angles in the world (rad), `a` the
//! axis and `n` the same a quarter turn further, both of the first end. A body has the freedoms (x,
//! y, theta) and a metric that is constant on flat space, so that every method of flat spaces moves
//! jointed bodies rightly. Multipliers are the force of end 2 on end 1 with its sign turned (N), and
//! torques (N m). What rolls without slipping does so by an equation between places: the plane has
//! no other kind of rolling. Source: notes 6, 7.4.

mod drive;
mod row;

use nalgebra::Vector2;
use stationary_calculus::{FIXED, Flat, Sink, SizeError, array};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_read, check_values,
};

use crate::{JointFault, JointName, LieGroup, PlanarRotation, RigidError};
use row::{Local, Placed, Row};

pub use drive::{PlanarCoordinate, PlanarDrive};

/// What a joint of the plane leaves free; axes are told in the joint's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarJointKind {
    /// A turn about a point.
    Pin,
    /// Nothing.
    Weld,
    /// A shift along an axis.
    Slider {
        /// The axis.
        axis: Vector2<f64>,
    },
    /// A shift along an axis and a turn: a pin in a straight slot.
    PinInSlot {
        /// The axis of the slot.
        axis: Vector2<f64>,
    },
    /// What keeps the distance of two points.
    Rod {
        /// The distance, metres.
        length: f64,
    },
    /// A wheel about the second end's point that rolls, without slipping, along a straight line of
    /// the first: on the side to which a quarter turn of the axis points.
    Rolling {
        /// The direction of the line, which passes through the first end's point.
        axis: Vector2<f64>,
        /// The radius of the wheel, metres.
        radius: f64,
    },
}

/// Where the frame of a joint is held: at a point of a body, turned by an angle, or in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarEnd {
    /// The body; `None` is the world.
    pub body: Option<usize>,
    /// The origin of the joint's frame, metres, in the axes of the body or of the world.
    pub point: Vector2<f64>,
    /// The angle of the joint's axes in those, radians.
    pub angle: f64,
}

impl PlanarEnd {
    /// A point of the plane (m), the joint's axes along the world's.
    pub fn world(point: Vector2<f64>) -> Self {
        PlanarEnd { body: None, point, angle: 0.0 }
    }

    /// A point of a body (m, body axes), the joint's axes along the body's.
    pub fn on(body: usize, point: Vector2<f64>) -> Self {
        PlanarEnd { body: Some(body), point, angle: 0.0 }
    }

    /// The same with the joint's axes turned, radians.
    pub fn turned(self, angle: f64) -> Self {
        PlanarEnd { angle, ..self }
    }

    /// The end on a body that stands at `(x, y, theta)`, of a joint at a point of the world whose
    /// axes are the world's.
    pub fn where_it_stands(body: usize, [x, y, theta]: [f64; 3], point: Vector2<f64>) -> Self {
        let point = PlanarRotation::exp(theta).rotate_back(&(point - Vector2::new(x, y)));
        PlanarEnd { body: Some(body), point, angle: -theta }
    }

    fn check(&self, bodies: usize) -> Result<(), JointFault> {
        let numbers = [("its point", self.point.x), ("its point", self.point.y)];
        for (what, value) in numbers.into_iter().chain([("its angle", self.angle)]) {
            if !value.is_finite() {
                return Err(JointFault::NotFinite { what, value });
            }
        }
        match self.body {
            Some(body) if body >= bodies => Err(JointFault::NoSuchBody { body, bodies }),
            _ => Ok(()),
        }
    }

    fn placed(&self, q: &[f64]) -> Placed {
        let Some(body) = self.body else {
            let rotation = PlanarRotation::identity();
            return Placed {
                rotation,
                arm: Vector2::zeros(),
                place: self.point,
                angle: self.angle,
            };
        };
        let [x, y, theta] = [0, 1, 2].map(|k| q[3 * body + k]);
        let rotation = PlanarRotation::exp(theta);
        let arm = rotation.rotate(&self.point);
        Placed { rotation, arm, place: Vector2::new(x, y) + arm, angle: theta + self.angle }
    }
}

impl PlanarJointKind {
    /// The kind in a word or two.
    pub fn name(&self) -> &'static str {
        match self {
            PlanarJointKind::Pin => "pin",
            PlanarJointKind::Weld => "weld",
            PlanarJointKind::Slider { .. } => "slider",
            PlanarJointKind::PinInSlot { .. } => "pin in a slot",
            PlanarJointKind::Rod { .. } => "rod",
            PlanarJointKind::Rolling { .. } => "rolling wheel",
        }
    }
}

/// A joint between two bodies of the plane, or a body and the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarJoint {
    bodies: usize,
    kind: PlanarJointKind,
    ends: [PlanarEnd; 2],
    rows: Vec<Row>,
}

impl PlanarJoint {
    /// A joint of this kind between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with it.
    pub fn new(
        bodies: usize,
        kind: PlanarJointKind,
        ends: [PlanarEnd; 2],
    ) -> Result<Self, RigidError> {
        let joint = JointName { kind: kind.name(), bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        check_ends(&ends, bodies).map_err(fault)?;
        let rows = Row::all(&kind, ends[0].angle).map_err(fault)?;
        Ok(PlanarJoint { bodies, kind, ends, rows })
    }

    /// What it leaves free.
    pub fn kind(&self) -> &PlanarJointKind {
        &self.kind
    }

    /// Its ends.
    pub fn ends(&self) -> &[PlanarEnd; 2] {
        &self.ends
    }

    /// How a message names it.
    pub fn name(&self) -> JointName {
        JointName { kind: self.kind.name(), bodies: self.ends.map(|end| end.body) }
    }

    fn placed(&self, q: &[f64]) -> Result<[Placed; 2], SizeError> {
        check_read(self.dim(), q)?;
        Ok(self.ends.each_ref().map(|end| end.placed(q)))
    }
}

impl ConstraintOn<Flat> for PlanarJoint {}

impl Constraint for PlanarJoint {
    fn dim(&self) -> usize {
        self.bodies.saturating_mul(3)
    }

    fn count(&self) -> usize {
        self.rows.len()
    }

    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        let ends = self.placed(q)?;
        g.iter_mut().zip(&self.rows).for_each(|(g, row)| *g = row.value(&ends));
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        for (number, row) in self.rows.iter().enumerate() {
            bring(row, 1.0, number, (&self.ends, q), rows);
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        let ends = self.placed(q)?;
        let mut local = Local::zeros();
        for (row, &lambda) in self.rows.iter().zip(lambda) {
            row.add_hessian(&ends, lambda, &mut local);
        }
        hessian.add_symmetric(&pair_freedoms(&self.ends), local.as_slice());
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        self.rows
            .get(row)
            .map_or_else(Scale::default, |row| row.scale(arm(&self.ends), self.bodies))
    }

    fn describe(&self, _row: usize) -> Option<String> {
        Some(self.name().to_string())
    }
}

/// An error unless the ends are those of two bodies, or of one and the world.
fn check_ends(ends: &[PlanarEnd; 2], bodies: usize) -> Result<(), JointFault> {
    ends.iter().try_for_each(|end| end.check(bodies))?;
    if ends[0].body == ends[1].body { Err(JointFault::ToItself) } else { Ok(()) }
}

/// Brings the differential of a row, times a sign.
fn bring(
    row: &Row,
    sign: f64,
    number: usize,
    (ends, q): (&[PlanarEnd; 2], &[f64]),
    rows: &mut impl Rows,
) {
    let differential = row.differential(&ends.each_ref().map(|end| end.placed(q)));
    for (end, slope) in ends.iter().zip(differential.as_chunks::<3>().0) {
        let Some(body) = end.body else { continue };
        for k in (0..3).filter(|&k| row.moves_along(k)) {
            rows.add(number, 3 * body + k, sign * slope[k]);
        }
    }
}

/// The freedoms of both ends.
fn pair_freedoms(ends: &[PlanarEnd; 2]) -> [usize; 6] {
    array(|k| ends[k / 3].body.map_or(FIXED, |body| 3 * body + k % 3))
}

/// The longest arm, metres.
fn arm(ends: &[PlanarEnd; 2]) -> f64 {
    let reach = |end: &PlanarEnd| end.body.map_or(0.0, |_| end.point.norm());
    ends.iter().map(reach).fold(0.0, f64::max)
}
