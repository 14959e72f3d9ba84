//! The word `contact`.

use crate::model::items::{SceneBall, SceneContact, SceneWall};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::{ContactDeclaration, Declaration};
use stationary_contact::{ImpactLaw, When};

/// The contact that is declared.
pub(crate) fn declare(declared: &Declaration, dimension: usize) -> Checked<Option<SceneContact>> {
    let Some(contact) = &declared.contact else {
        return Ok(None);
    };
    let ContactDeclaration { restitution, friction, law, when, walls, balls, .. } = contact;
    let stiffness = stiffness(declared, contact)?;
    let restitution = match restitution {
        Some(given) => {
            let value = check::finite("the restitution", given)?;
            if !(0.0..=1.0).contains(&value) {
                return Err(at(given.span(), Fault::Restitution(value)));
            }
            value
        }
        None => 0.0,
    };
    let friction = match friction {
        Some(given) if declared.bodies.is_empty() => {
            return Err(at(given.span(), Fault::FrictionOfParticles));
        }
        Some(given) => check::positive("the friction", given)?,
        None => 0.0,
    };
    let law = match law {
        Some(word) => {
            let laws: Vec<_> = ImpactLaw::ALL.iter().map(|&law| (law.facts().name, law)).collect();
            check::word("law of impact", word.get_ref(), word.span(), &laws)?
        }
        None => ImpactLaw::GeneralizedReflections,
    };
    let when = match when {
        Some(word) if !declared.bodies.is_empty() => {
            return Err(at(word.span(), Fault::WhenOfBodies));
        }
        Some(word) => {
            let moments: Vec<_> = When::ALL.iter().map(|&when| (when.name(), when)).collect();
            check::word("moment of impact", word.get_ref(), word.span(), &moments)?
        }
        None => When::AtTheInstant,
    };
    let walls = walls.iter().flatten().map(|wall| {
        let normal = check::direction("the normal", dimension, &wall.normal)?;
        let place = check::vector("the wall's place", dimension, &wall.at)?;
        let offset = normal.iter().zip(&place).map(|(n, x)| n * x).sum();
        Ok(SceneWall { normal, offset })
    });
    let walls = walls.collect::<Checked<_>>()?;
    let balls = balls.iter().flatten().map(|ball| {
        let centre = check::vector("the ball's place", dimension, &ball.at)?;
        Ok(SceneBall { centre, radius: check::positive("the radius", &ball.radius)? })
    });
    let balls = balls.collect::<Checked<_>>()?;
    Ok(Some(SceneContact { restitution, friction, law, when, stiffness, walls, balls }))
}

/// The stiffness that is declared, where nothing is that only impulses have.
fn stiffness(declared: &Declaration, contact: &ContactDeclaration) -> Checked<Option<f64>> {
    let Some(given) = &contact.stiffness else {
        return Ok(None);
    };
    let words = [("law", &contact.law), ("when", &contact.when)];
    let of_impulses = words.into_iter().find_map(|(key, word)| Some((key, word.as_ref()?.span())));
    let restitution = contact.restitution.as_ref().map(|c| ("restitution", c.span()));
    match of_impulses.or(restitution) {
        _ if !declared.bodies.is_empty() => Err(at(given.span(), Fault::StiffnessOfBodies)),
        Some((key, place)) => Err(at(place, Fault::ImpulseOfSprings(key))),
        None => check::positive("the stiffness", given).map(Some),
    }
}
