//! Which methods step bodies, and which of them hold joints or let bodies touch.

use stationary_integrators::Method;
use stationary_rigid::BodyMethod;

use crate::model::body_shape::BodyShape;
use crate::model::drives::PinMotion;
use crate::model::items::{RigidBody, Rod};
use crate::model::scene::Scene;
use crate::model::stepping::Stepping;
use crate::text::fault::{BodyFault, Fault};
use crate::words::word::CONTACT;

impl Scene {
    /// An error where the scene's method cannot step its bodies.
    pub(crate) fn check_bodies(&self) -> Result<(), Fault> {
        if self.steps_contact_alone() && !self.touches_as_bodies() {
            let what = "bodies that never meet";
            let instead = match self.dimension {
                3 => "add `[contact]`, or name `variational-rotation`",
                _ => "add `[contact]`, or name `stormer-verlet`",
            };
            return Err(Fault::MethodCannot { method: self.stepping.name(), what, instead });
        }
        if self.has_inequalities() {
            CONTACT.check("strength")?;
            return self.check_touching();
        }
        if self.moves_joints() {
            return self.check_joint_coordinates();
        }
        let (moves, holds) = match self.stepping {
            Stepping::Bodies(method) => (self.dimension == 3, follows_free_motion(method)),
            Stepping::Equal(method) => (self.dimension != 3, method == Method::StormerVerlet),
            _ => (false, false),
        };
        let name = || self.stepping.name().to_owned();
        let order = match self.stepping {
            Stepping::Bodies(method) => method.facts().order,
            Stepping::Equal(method) => method.facts().order,
            _ => 0,
        };
        if moves && self.is_driven() && order > 2 {
            let what = "loads, motors or changing gravity to its order";
            let instead =
                "name a method up to order 2, such as `stormer-verlet` or `axis-rotations`";
            return Err(Fault::MethodCannot { method: self.stepping.name(), what, instead });
        }
        match (moves, holds || (self.joints.is_empty() && self.rods.is_empty())) {
            (false, _) => Err(Fault::MethodOfAnother(name())),
            (true, false) => Err(Fault::MethodOfJoints(name())),
            (true, true) => Ok(()),
        }
    }

    /// Whether its method is one of bodies that touch, and of nothing else.
    fn steps_contact_alone(&self) -> bool {
        matches!(self.stepping, Stepping::EventDriven(_) | Stepping::ErrorControlled { .. })
    }

    /// Whether its method moves the coordinates of joints, not those of bodies.
    pub(crate) fn moves_joints(&self) -> bool {
        match self.stepping {
            Stepping::JointCoordinates => true,
            Stepping::Adaptive { method, .. } => method.is_explicit(),
            _ => false,
        }
    }

    /// An error where no coordinates of joints are left to follow motors, or a pin takes a rod along in no time.
    fn check_joint_coordinates(&self) -> Result<(), Fault> {
        let method = self.stepping.name();
        let refused = |what, instead| Err(Fault::MethodCannot { method, what, instead });
        if self.driven_closing_joint().is_some() {
            let instead = "leave the speed of one out: it follows from the others";
            return refused("motors with a speed at all joints of a loop", instead);
        }
        let jumps = |rod: &Rod| self.pin_of(rod).is_some_and(|pin| pin.strength.jumps());
        match self.stepping {
            Stepping::Adaptive { .. } if self.rods.iter().any(jumps) => {
                refused(JUMPS, "make it a `ramp`")
            }
            _ => Ok(()),
        }
    }

    /// An error where the scene's bodies cannot touch, or be held by limits, friction and what breaks.
    fn check_touching(&self) -> Result<(), Fault> {
        let method = self.stepping.name();
        let touches = self.touches_as_bodies();
        let bounds = "limits and friction of joints, or rods that break beside bodies";
        let what = if touches { "what touches" } else { bounds };
        let refused = |instead| Err(Fault::MethodCannot { method, what, instead });
        let only_moments =
            |body: &&RigidBody| touches && body.shape == BodyShape::Moments && !body.point_mass;
        let untouchable = self.bodies.iter().find(only_moments);
        if self.steps_contact_alone() && untouchable.is_none() {
            return self.check_contact_alone();
        }
        match (self.stepping, self.dimension, untouchable) {
            (_, _, Some(body)) => Err(Fault::Bodies(BodyFault::Untouchable(body.name.clone()))),
            (Stepping::Bodies(BodyMethod::VariationalRotation), 3, _)
            | (Stepping::Equal(Method::StormerVerlet), 2, _) => Ok(()),
            (_, 3, _) => refused("name `variational-rotation`"),
            _ => refused("name `stormer-verlet`"),
        }
    }

    /// An error where something acts on the scene's bodies for which such a method has no place.
    fn check_contact_alone(&self) -> Result<(), Fault> {
        let method = self.stepping.name();
        let refused = |what, instead| Err(Fault::MethodCannot { method, what, instead });
        let fixed = match self.dimension {
            3 => "name `variational-rotation`",
            _ => "name `stormer-verlet`",
        };
        if self.has_joints() && !self.chooses_contact_steps() {
            return refused("joints or rods", fixed);
        }
        let jumps = |motion: &PinMotion| {
            let touches = self.particles[motion.particle].radius > 0.0;
            let leads = self.rods.iter().any(|rod| rod.ends.contains(&motion.particle));
            motion.strength.jumps() && (touches || leads)
        };
        match self.drives.motions.iter().any(jumps) {
            _ if self.rods.iter().any(|rod| rod.strength.is_finite()) => {
                refused("rods that break", fixed)
            }
            true => refused(JUMPS, "make it a `ramp`"),
            false => Ok(()),
        }
    }
}

/// What no force and no impulse does.
const JUMPS: &str = "pins that jump and hold rods or touch, which takes an infinite speed";

/// Whether RATTLE can run along the method's free motion.
fn follows_free_motion(method: BodyMethod) -> bool {
    matches!(
        method,
        BodyMethod::VariationalRotation | BodyMethod::AxisRotations | BodyMethod::ExactRotation
    )
}
