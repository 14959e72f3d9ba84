//! The word `motors`: torques and speeds at pins and hinges.
//!
//! ```text
//! torque   m(t) on the second body about the axis, -m(t) on the first
//! speed    the turn of the second body against the first follows int_0^t speed, whatever it takes
//! ```

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::words::draft::Draft;
use crate::words::strength::StrengthDeclaration;
use crate::words::table::{Kind, table};
use crate::words::word::{CONSTRAINTS, Feature, Of, Word};

table! {
    /// A motor at a pin or a hinge: it turns the second of the two against the first.
    pub(crate) struct MotorDeclaration = "a motor" {
        /// The two names of its joint; a torque or a speed is of the second against the first.
        between: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// The torque, a number or one in time.
        torque: Option<Spanned<StrengthDeclaration>> = Kind::Strength,
        /// The speed in radians a unit of time, a number or one in time, whatever torque it takes.
        speed: Option<Spanned<StrengthDeclaration>> = Kind::Strength,
    }
}

impl Word for Vec<MotorDeclaration> {
    const FEATURE: Option<Feature> = Some(CONSTRAINTS);
    const OF: Of = Of::Joints;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.between.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "rigid")]
        for motor in self {
            let motor = compiled::declare(draft, motor)?;
            draft.drives.motors.push(motor);
        }
        #[cfg(not(feature = "rigid"))]
        let _ = draft;
        Ok(())
    }
}

/// What is compiled with the crate that the word is about.
#[cfg(feature = "rigid")]
mod compiled {
    use super::*;
    use crate::model::drives::{Motor, MotorDrive};
    use crate::model::items::JointKind;
    use crate::text::diagnostic::at;
    use crate::text::fault::{BodyFault, DriveFault};
    use crate::words::{joints, strength};

    /// The motor that is declared.
    pub(crate) fn declare(draft: &Draft<'_>, declared: &MotorDeclaration) -> Checked<Motor> {
        let place = declared.between.span();
        let (drive, given) = match (&declared.torque, &declared.speed) {
            (Some(torque), None) => (MotorDrive::Torque, torque),
            (None, Some(speed)) => (MotorDrive::Speed, speed),
            _ => return Err(at(place, DriveFault::TorqueOrSpeed)),
        };
        let names = declared.between.get_ref();
        let [a, b] = names.as_slice() else {
            return Err(at(place, BodyFault::JointEnds(names.len())));
        };
        let bodies = joints::by_name(&draft.bodies);
        let ends = [joints::find(&bodies, a)?, joints::find(&bodies, b)?];
        let turned = |joint: usize| {
            let between = draft.joints[joint].between;
            between == ends || between == [ends[1], ends[0]]
        };
        let Some(joint) = (0..draft.joints.len()).find(|&joint| turned(joint)) else {
            return Err(at(place, DriveFault::NoJoint));
        };
        let turns = match draft.joints[joint].kind {
            JointKind::Hinge => true,
            JointKind::Ball => draft.dimension == 2,
            JointKind::Fixed | JointKind::Slider => false,
        };
        if !turns {
            return Err(at(place, DriveFault::MotorWithoutAxis));
        }
        let driven = |motor: &Motor| motor.joint == joint && motor.drive == MotorDrive::Speed;
        if drive == MotorDrive::Speed && draft.drives.motors.iter().any(driven) {
            return Err(at(place, DriveFault::TwoSpeeds));
        }
        let mut strength = strength::declare(draft.folder, Some(given))?;
        if draft.joints[joint].between != ends {
            strength = strength.reversed();
        }
        Ok(Motor { joint, drive, strength })
    }
}
