//! The word `motions`: pinned particles that move as it says, whatever pulls.
//!
//! ```text
//! x(t) = x_0 + s(t) d          d `shift`, s `strength`
//! ```

use std::ops::Range;

use toml::Spanned;

use crate::model::drives::PinMotion;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::DriveFault;
use crate::text::number::Components;
use crate::words::draft::Draft;
use crate::words::strength::{self, StrengthDeclaration};
use crate::words::table::{Kind, table};
use crate::words::word::{ELASTICITY, Feature, Of, Word};

table! {
    /// A pinned particle that moves as it is told: springs pull at it, rods hold it, elements stretch to it, and where it has a mass it attracts from there.
    pub(crate) struct MotionDeclaration = "a motion" {
        /// The pinned particle.
        of: Spanned<String> = Kind::Name,
        /// How far from its place it is where the strength is 1.
        shift: Components = Kind::Vector,
        /// How it moves in time.
        strength: Spanned<StrengthDeclaration> = Kind::Strength,
    }
}

impl Word for Vec<MotionDeclaration> {
    const FEATURE: Option<Feature> = Some(ELASTICITY);
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.of.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        for motion in self {
            let motion = declare(draft, motion)?;
            draft.drives.motions.push(motion);
        }
        Ok(())
    }
}

fn declare(draft: &Draft<'_>, declared: &MotionDeclaration) -> Checked<PinMotion> {
    let particle = draft.particles.find(&declared.of)?;
    let place = declared.of.span();
    let name = || declared.of.get_ref().clone();
    let pin = &draft.particles.particles[particle];
    if pin.motion != Motion::Pinned {
        return Err(at(place, DriveFault::MotionOfFree(name())));
    }
    // Without contact a radius touches nothing, and beside bodies the pin is an obstacle.
    if pin.radius > 0.0 && draft.contact.is_some() && draft.bodies.is_empty() {
        return Err(at(place, DriveFault::MotionOfRound(name())));
    }
    if draft.drives.moves(particle) {
        return Err(at(place, DriveFault::TwoMotions(name())));
    }
    let shift = check::vector("the shift", draft.dimension, &declared.shift)?;
    let strength = strength::declare(draft.folder, Some(&declared.strength))?;
    if strength.at(0.0) != 0.0 {
        return Err(at(
            declared.strength.span(),
            DriveFault::MotionFromElsewhere(strength.at(0.0)),
        ));
    }
    Ok(PinMotion { particle, shift, strength })
}
