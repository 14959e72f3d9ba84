//! The word `gravity`.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use toml::Spanned;

use crate::model::body_shape::BodyShape;
use crate::model::items::RigidBody;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Number};
use crate::words::draft::Draft;
use crate::words::particle_table::ParticleTable;
use crate::words::strength::{self, StrengthDeclaration};
use crate::words::table::{Kind, table};
use crate::words::word::{Of, Word};

table! {
    /// A uniform field of gravity.
    pub(crate) struct UniformGravityDeclaration = "a table with an acceleration" {
        /// The acceleration of what falls.
        acceleration: Components = Kind::Vector,
        /// How strong it is in time; 1 where it is missing.
        strength: Option<Spanned<StrengthDeclaration>> = Kind::Strength,
    }

    /// Attraction between every two particles and balls in space; a pinned one that has a mass attracts too.
    pub(crate) struct NewtonianGravityDeclaration = "a table with a constant" {
        /// The constant G.
        constant: Spanned<Number> = Kind::Positive,
    }
}

impl Word for Option<UniformGravityDeclaration> {
    const OF: Of = Of::Weight;

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().map(|gravity| gravity.acceleration.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        if let Some(uniform) = self {
            let g = check::vector("the acceleration", draft.dimension, &uniform.acceleration)?;
            draft.gravity.acceleration = Some(g);
            if let Some(strength) = &uniform.strength {
                draft.drives.gravity = Some(strength::declare(draft.folder, Some(strength))?);
            }
        }
        Ok(())
    }
}

impl Word for Option<NewtonianGravityDeclaration> {
    const OF: Of = Of::Attraction;

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().map(|gravity| gravity.constant.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        let Some(newtonian) = self else { return Ok(()) };
        draft.gravity.constant = Some(check::positive("the constant", &newtonian.constant)?);
        draft.gravity.fixed = draft.particles.pinned_masses.clone();
        let is_point = |body: &RigidBody| {
            let is_ball = matches!(body.shape, BodyShape::Ball(_)) && draft.dimension == 3;
            body.point_mass || is_ball
        };
        if let Some(other) = draft.bodies.iter().find(|declared| !is_point(&declared.body)) {
            let fault = Fault::BodyAttraction(other.body.name.clone());
            return Err(at(newtonian.constant.span(), fault));
        }
        check_that_no_two_meet(&draft.particles)
    }
}

fn check_that_no_two_meet(table: &ParticleTable) -> Checked<()> {
    let mut bodies = HashSet::new();
    let mut attracts = |index: usize| match table.particles[index].motion {
        Motion::Pinned => table.pinned_masses.iter().any(|&(pin, _)| pin == index),
        // Its centre comes before its points.
        Motion::Carried { body, .. } => bodies.insert(body),
        Motion::Free { .. } => true,
    };
    let mut by_position = HashMap::new();
    for (index, particle) in table.particles.iter().enumerate().filter(|(k, _)| attracts(*k)) {
        // Adding zero turns the negative zero into the positive one.
        let bits = particle.position.map(|x| (x + 0.0).to_bits());
        if let Some(first) = by_position.insert(bits, index) {
            let first = table.particles[first].name.clone();
            let fault = Fault::SamePlace { first, second: particle.name.clone() };
            return Err(at(table.places[index].clone(), fault));
        }
    }
    Ok(())
}
