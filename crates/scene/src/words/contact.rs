//! The word `contact`.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Number};
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{CONTACT, Feature, Word};

table! {
    /// How things with a radius, or bodies, touch.
    pub(crate) struct ContactDeclaration = "a table of how things touch" {
        /// Separating over approaching speed; 0 where it is missing.
        restitution: Option<Spanned<Number>> = Kind::Share,
        /// Coulomb's coefficient, between bodies.
        friction: Option<Spanned<Number>> = Kind::Positive,
        /// What happens where several contacts meet.
        law: Option<Spanned<String>> = Kind::OneOf(&["generalized-reflections", "gauss-seidel", "jacobi", "inelastic", "blended"]),
        /// At which moment particles are given impulses.
        when: Option<Spanned<String>> = Kind::OneOf(&["after-overlap", "at-the-instant", "velocity-filter"]),
        /// Of springs that push apart particles that overlap, instead of impulses.
        stiffness: Option<Spanned<Number>> = Kind::Positive,
        /// Half-spaces that nothing enters.
        walls: Option<Vec<WallDeclaration>> = Kind::List(&Kind::Table(&WallDeclaration::TABLE)),
        /// Balls that nothing enters and nothing moves.
        balls: Option<Vec<FixedBallDeclaration>> = Kind::List(&Kind::Table(&FixedBallDeclaration::TABLE)),
    }

    /// A wall.
    pub(crate) struct WallDeclaration = "a wall with `normal` and `at`" {
        /// The direction to the free side.
        normal: Components = Kind::Vector,
        /// A point of it.
        at: Components = Kind::Vector,
    }

    /// A ball that stays.
    pub(crate) struct FixedBallDeclaration = "a fixed ball with `at` and `radius`" {
        /// Its centre.
        at: Components = Kind::Vector,
        /// Its radius.
        radius: Spanned<Number> = Kind::Positive,
    }
}

impl Word for Option<ContactDeclaration> {
    const FEATURE: Option<Feature> = Some(CONTACT);

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().and_then(ContactDeclaration::place)
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "contact")]
        if let Some(contact) = self {
            draft.contact = Some(declare(contact, draft)?);
        }
        #[cfg(not(feature = "contact"))]
        let _ = draft;
        Ok(())
    }
}

impl ContactDeclaration {
    /// Where the text speaks of contact, for faults of all of it.
    pub(crate) fn place(&self) -> Option<Range<usize>> {
        let wall = self.walls.iter().flatten().next().map(|wall| wall.normal.span());
        let ball = self.balls.iter().flatten().next().map(|ball| ball.at.span());
        let word = self.law.as_ref().or(self.when.as_ref()).map(|word| word.span());
        let number = self.restitution.as_ref().or(self.friction.as_ref()).map(|n| n.span());
        number.or(word).or(wall).or(ball)
    }
}

#[cfg(feature = "contact")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "contact")]
mod compiled {
    use super::*;
    use crate::model::items::{SceneBall, SceneContact, SceneWall};
    use crate::text::check;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use stationary_contact::{ImpactLaw, When};

    /// The contact that is declared.
    pub(crate) fn declare(
        contact: &ContactDeclaration,
        draft: &Draft<'_>,
    ) -> Checked<SceneContact> {
        let (dimension, of_bodies) = (draft.dimension, !draft.bodies.is_empty());
        let ContactDeclaration { restitution, friction, law, when, walls, balls, .. } = contact;
        let stiffness = stiffness(draft, contact)?;
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
            Some(given) if !of_bodies => {
                return Err(at(given.span(), Fault::FrictionOfParticles));
            }
            Some(given) => check::positive("the friction", given)?,
            None => 0.0,
        };
        let law = match law {
            Some(word) => {
                let laws: Vec<_> =
                    ImpactLaw::ALL.iter().map(|&law| (law.facts().name, law)).collect();
                check::word("law of impact", word.get_ref(), word.span(), &laws)?
            }
            None => ImpactLaw::GeneralizedReflections,
        };
        let when = match when {
            Some(word) if of_bodies => {
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
        Ok(SceneContact { restitution, friction, law, when, stiffness, walls, balls })
    }

    /// The stiffness that is declared, where nothing is that only impulses have.
    fn stiffness(draft: &Draft<'_>, contact: &ContactDeclaration) -> Checked<Option<f64>> {
        let Some(given) = &contact.stiffness else {
            return Ok(None);
        };
        let words = [("law", &contact.law), ("when", &contact.when)];
        let of_impulses =
            words.into_iter().find_map(|(key, word)| Some((key, word.as_ref()?.span())));
        let restitution = contact.restitution.as_ref().map(|c| ("restitution", c.span()));
        match of_impulses.or(restitution) {
            _ if !draft.bodies.is_empty() => Err(at(given.span(), Fault::StiffnessOfBodies)),
            Some((key, place)) => Err(at(place, Fault::ImpulseOfSprings(key))),
            None => check::positive("the stiffness", given).map(Some),
        }
    }
}
