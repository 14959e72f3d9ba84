//! An end of a joint: the joint's frame on a body, or in the world.
//!
//! ```text
//! frame = pose^-1 F          of a body at `pose`, for a joint whose frame is F in the world
//! ```

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::{FIXED, array};

use super::JointFault;
use crate::space::pose_or_none;
use crate::{BodySpace, LieGroup, RigidError, RigidMotion, Rotation};

/// Where the frame of a joint is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEnd {
    /// The body; `None` is the world.
    pub body: Option<usize>,
    /// From the joint's axes into those of the body, or of the world.
    pub frame: RigidMotion,
}

/// An end as it stands in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// The matrix of the body's rotation; the identity of the world.
    pub rotation: Matrix3<f64>,
    /// From the body's centre to the frame's origin, body axes; zero of the world.
    pub arm: Vector3<f64>,
    /// The frame's origin in the world.
    pub place: Vector3<f64>,
}

impl JointEnd {
    /// A point of the world (m), the joint's axes along the world's.
    pub fn world(point: Vector3<f64>) -> Self {
        JointEnd { body: None, frame: moved(point) }
    }

    /// A point of a body (m, body axes), the joint's axes along the body's.
    pub fn on(body: usize, point: Vector3<f64>) -> Self {
        JointEnd { body: Some(body), frame: moved(point) }
    }

    /// The end on a body that stands at `pose`, of a joint whose frame is `frame` in the world.
    pub fn where_it_stands(body: usize, pose: &RigidMotion, frame: &RigidMotion) -> Self {
        JointEnd { body: Some(body), frame: pose.inverse().compose(frame) }
    }

    /// The same with its axes turned: `rotation` leads from the joint's axes into those of the end.
    pub fn turned(self, rotation: Rotation) -> Self {
        JointEnd { frame: RigidMotion { rotation, ..self.frame }, ..self }
    }

    /// What is wrong with it where there are `bodies` bodies.
    pub(crate) fn check(&self, bodies: usize) -> Result<(), JointFault> {
        let RigidMotion { translation, rotation } = self.frame;
        for (what, numbers) in
            [("its point", translation.as_slice()), ("its rotation", &rotation.quaternion())]
        {
            if let Some(index) = stationary_calculus::first_non_finite(numbers) {
                return Err(JointFault::NotFinite { what, value: numbers[index] });
            }
        }
        match (Rotation::from_quaternion(rotation.quaternion()), self.body) {
            (Err(RigidError::NotUnit { length }), _) => Err(JointFault::NotUnit(length)),
            (_, Some(body)) if body >= bodies => Err(JointFault::NoSuchBody { body, bodies }),
            _ => Ok(()),
        }
    }

    /// What is wrong with two ends of one joint.
    pub(crate) fn check_pair(ends: &[JointEnd; 2], bodies: usize) -> Result<(), JointFault> {
        ends.iter().try_for_each(|end| end.check(bodies))?;
        if ends[0].body == ends[1].body { Err(JointFault::ToItself) } else { Ok(()) }
    }

    #[inline]
    pub(crate) fn placed<S: BodySpace>(&self, q: &[f64]) -> Placed {
        self.on_body(|body| S::pose_at(q, body))
    }

    /// The same where sizes were not checked: no numbers of a body that `q` does not hold.
    pub(crate) fn placed_or_none<S: BodySpace>(&self, q: &[f64]) -> Placed {
        self.on_body(|body| pose_or_none::<S>(q, body))
    }

    #[inline]
    fn on_body(&self, pose: impl Fn(usize) -> RigidMotion) -> Placed {
        let Some(body) = self.body else { return self.in_world() };
        let (pose, arm) = (pose(body), self.frame.translation);
        let rotation = pose.rotation.matrix();
        Placed { rotation, arm, place: pose.translation + rotation * arm }
    }

    pub(crate) fn in_world(&self) -> Placed {
        let place = self.frame.translation;
        Placed { rotation: Matrix3::identity(), arm: Vector3::zeros(), place }
    }

    /// How far the joint's point is from the body's centre, metres; zero of the world.
    pub(crate) fn reach(&self) -> f64 {
        self.body.map_or(0.0, |_| self.frame.translation.norm())
    }
}

/// The six freedoms of a body; the first three do not move where it turns about a fixed point.
pub(crate) fn body_freedoms<S: BodySpace>(body: usize) -> [usize; 6] {
    array(|k| match k {
        0..3 if S::TRANSLATION == 0 => FIXED,
        _ => S::FREEDOMS * body + k + S::TRANSLATION - 3,
    })
}

/// Those of two bodies, none of which move of the world.
pub(crate) fn pair_freedoms<S: BodySpace>(bodies: [Option<usize>; 2]) -> [usize; 12] {
    let freedoms = bodies.map(|body| body.map_or([FIXED; 6], body_freedoms::<S>));
    array(|k| freedoms[k / 6][k % 6])
}

fn moved(translation: Vector3<f64>) -> RigidMotion {
    RigidMotion { translation, rotation: Rotation::identity() }
}
