//! The word `loads`: forces at particles and points of bodies, torques on bodies.
//!
//! ```text
//! F(t) = s(t) f at x,    torque s(t) m          f `force`, m `torque` in world axes, s `strength`
//! ```

use std::ops::Range;

use toml::Spanned;

use crate::model::drives::SceneLoad;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::DriveFault;
use crate::text::number::Components;
use crate::text::turn::Turn;
use crate::words::draft::Draft;
use crate::words::strength::{self, StrengthDeclaration};
use crate::words::table::{Kind, table};
use crate::words::word::{Of, Word};

table! {
    /// A force at a particle or a point of a body, or a torque on a body.
    pub(crate) struct LoadDeclaration = "a load" {
        /// The particle, the body, or the point of a body.
        on: Spanned<String> = Kind::Name,
        /// The force, in world axes, where the strength is 1.
        force: Option<Components> = Kind::Vector,
        /// The torque on a body, in world axes, where the strength is 1.
        torque: Option<Turn> = Kind::Turn,
        /// How strong it is in time; 1 where it is missing.
        strength: Option<Spanned<StrengthDeclaration>> = Kind::Strength,
    }
}

impl Word for Vec<LoadDeclaration> {
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.on.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        for load in self {
            let load = declare(draft, load)?;
            draft.drives.loads.push(load);
        }
        Ok(())
    }
}

fn declare(draft: &Draft<'_>, declared: &LoadDeclaration) -> Checked<SceneLoad> {
    let on = draft.particles.find(&declared.on)?;
    let motion = draft.particles.particles[on].motion;
    if motion == Motion::Pinned {
        return Err(at(declared.on.span(), DriveFault::LoadOnPin(declared.on.get_ref().clone())));
    }
    if declared.force.is_none() && declared.torque.is_none() {
        return Err(at(declared.on.span(), DriveFault::NoLoad));
    }
    let force = match &declared.force {
        Some(force) => check::vector("the force", draft.dimension, force)?,
        None => [0.0; 3],
    };
    let torque = match (&declared.torque, motion) {
        (Some(torque), Motion::Carried { body, .. }) if !draft.bodies[body].body.point_mass => {
            torque.components("the torque", draft.dimension)?
        }
        (Some(torque), _) => {
            return Err(at(
                torque.span(),
                DriveFault::TorqueOnParticle(declared.on.get_ref().clone()),
            ));
        }
        (None, _) => [0.0; 3],
    };
    let strength = strength::declare(draft.folder, declared.strength.as_ref())?;
    Ok(SceneLoad { on, force, torque, strength })
}
