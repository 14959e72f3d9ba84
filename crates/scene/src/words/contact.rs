//! The word `contact`.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Number};
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{CONTACT, Feature, Of, Word};

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
        /// Bodies, or a body and what is fixed, that touch in a way of their own.
        pairs: Option<Vec<PairDeclaration>> = Kind::List(&Kind::Table(&PairDeclaration::TABLE)),
        /// Pairs that touch at the start, one after the other: the first of each is moved straight, until it does.
        touching: Option<Vec<Spanned<Vec<Spanned<String>>>>> = Kind::List(&Kind::Pair),
    }

    /// A wall.
    pub(crate) struct WallDeclaration = "a wall with `normal` and `at`" {
        /// Its name, by which pairs and tables call it.
        name: Option<Spanned<String>> = Kind::Name,
        /// The direction to the free side.
        normal: Components = Kind::Vector,
        /// A point of it.
        at: Components = Kind::Vector,
    }

    /// A ball that stays.
    pub(crate) struct FixedBallDeclaration = "a fixed ball with `at` and `radius`" {
        /// Its name, by which pairs and tables call it.
        name: Option<Spanned<String>> = Kind::Name,
        /// Its centre.
        at: Components = Kind::Vector,
        /// Its radius.
        radius: Spanned<Number> = Kind::Positive,
    }

    /// How two things touch, where it is not as all others do.
    pub(crate) struct PairDeclaration = "two names and how they touch" {
        /// Two bodies, or a body and a wall or fixed ball that has a name.
        of: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// Separating over approaching speed; that of all others where it is missing.
        restitution: Option<Spanned<Number>> = Kind::Share,
        /// Coulomb's coefficient; that of all others where it is missing.
        friction: Option<Spanned<Number>> = Kind::NotNegative,
        /// Length of rolling friction: a moment across the normal of at most this times the normal force.
        rolling: Option<Spanned<Number>> = Kind::NotNegative,
        /// Length of torsional friction: the same along the normal.
        torsion: Option<Spanned<Number>> = Kind::NotNegative,
        /// `false` where they pass through each other.
        meet: Option<Spanned<bool>> = Kind::Flag,
    }
}

impl Word for Option<ContactDeclaration> {
    const FEATURE: Option<Feature> = Some(CONTACT);
    const OF: Of = Of::Load;

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
        let pair = self.pairs.iter().flatten().next().map(|pair| pair.of.span());
        let pair = pair.or(self.touching.iter().flatten().next().map(Spanned::span));
        let number = self.restitution.as_ref().or(self.friction.as_ref()).map(|n| n.span());
        number.or(word).or(wall).or(ball).or(pair)
    }
}

#[cfg(feature = "contact")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "contact")]
mod compiled {
    use super::*;
    use crate::model::contact_side::ContactSide;
    use crate::model::items::{SceneBall, SceneContact, ScenePair, SceneWall};
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
        let ContactDeclaration {
            restitution,
            friction,
            law,
            when,
            walls,
            balls,
            pairs,
            touching,
            ..
        } = contact;
        let stiffness = stiffness(draft, contact)?;
        let restitution = share(restitution.as_ref())?.unwrap_or(0.0);
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
            let name = wall.name.as_ref().map(check::name).transpose()?;
            Ok(SceneWall { name, normal, offset })
        });
        let walls = walls.collect::<Checked<_>>()?;
        let balls = balls.iter().flatten().map(|ball| {
            let centre = check::vector("the ball's place", dimension, &ball.at)?;
            let name = ball.name.as_ref().map(check::name).transpose()?;
            Ok(SceneBall { name, centre, radius: check::positive("the radius", &ball.radius)? })
        });
        let balls = balls.collect::<Checked<_>>()?;
        let pairs = pairs.as_deref().unwrap_or_default();
        let touching = touching.as_deref().unwrap_or_default();
        let first = pairs.first().map(|pair| ("pairs", pair.of.span()));
        let first = first.or(touching.first().map(|pair| ("touching", pair.span())));
        if let Some((word, place)) = first.filter(|_| !of_bodies) {
            return Err(at(place, Fault::OfBodiesOnly(word)));
        }
        let named = by_name(draft, contact)?;
        let of_space = |pair: &&PairDeclaration| dimension == 2 && pair.torsion.is_some();
        if let Some(pair) = pairs.iter().find(of_space) {
            return Err(at(pair.of.span(), Fault::TorsionDimension));
        }
        let pairs = declare_pairs(pairs, &named, [restitution, friction])?;
        let touching = touching.iter().map(|pair| sides(pair, &named)).collect::<Checked<_>>()?;
        Ok(SceneContact {
            restitution,
            friction,
            law,
            when,
            stiffness,
            walls,
            balls,
            pairs,
            touching,
        })
    }

    /// A coefficient of restitution, where one is given.
    fn share(given: Option<&Spanned<Number>>) -> Checked<Option<f64>> {
        let Some(given) = given else { return Ok(None) };
        let value = check::finite("the restitution", given)?;
        if !(0.0..=1.0).contains(&value) {
            return Err(at(given.span(), Fault::Restitution(value)));
        }
        Ok(Some(value))
    }

    /// Bodies, walls and fixed balls by their names, in the scene's order.
    fn by_name<'a>(
        draft: &'a Draft<'_>,
        contact: &'a ContactDeclaration,
    ) -> Checked<Vec<(&'a str, ContactSide)>> {
        let bodies = draft.bodies.iter().enumerate();
        let mut named: Vec<(&str, ContactSide)> =
            bodies.map(|(k, d)| (d.body.name.as_str(), ContactSide::Body(k))).collect();
        let walls = contact.walls.iter().flatten().enumerate();
        let walls = walls.map(|(k, wall)| (&wall.name, ContactSide::Wall(k)));
        let balls = contact.balls.iter().flatten().enumerate();
        let balls = balls.map(|(k, ball)| (&ball.name, ContactSide::Ball(k)));
        for (name, side) in walls.chain(balls) {
            let Some(name) = name else { continue };
            if named.iter().any(|(other, _)| other == name.get_ref()) {
                return Err(at(name.span(), Fault::DuplicateSurface(name.get_ref().clone())));
            }
            named.push((name.get_ref(), side));
        }
        Ok(named)
    }

    /// Two different things, one of which moves.
    fn sides(
        pair: &Spanned<Vec<Spanned<String>>>,
        named: &[(&str, ContactSide)],
    ) -> Checked<[ContactSide; 2]> {
        let [a, b] = pair.get_ref().as_slice() else {
            return Err(at(pair.span(), Fault::PairEnds(pair.get_ref().len())));
        };
        let find = |name| check::named("body, wall or ball", name, named);
        let of = [find(a)?, find(b)?];
        if of[0] == of[1] || !of.iter().any(|side| side.moves()) {
            return Err(at(pair.span(), Fault::PairNeverMeets));
        }
        Ok(of)
    }

    /// Pairs, with the restitution and friction of all others where they have none of their own.
    fn declare_pairs(
        declared: &[PairDeclaration],
        named: &[(&str, ContactSide)],
        [restitution, friction]: [f64; 2],
    ) -> Checked<Vec<ScenePair>> {
        let mut pairs: Vec<ScenePair> = Vec::with_capacity(declared.len());
        for pair in declared {
            let place = pair.of.span();
            let of = sides(&pair.of, named)?;
            let same = |other: &ScenePair| other.of == of || other.of == [of[1], of[0]];
            if pairs.iter().any(same) {
                return Err(at(place, Fault::DuplicatePair));
            }
            let own = share(pair.restitution.as_ref())?;
            let length = |what, given: &Option<Spanned<Number>>| {
                given.as_ref().map(|given| check::not_negative(what, given)).transpose()
            };
            let rubs = length("the friction", &pair.friction)?;
            let rolling = length("the rolling friction", &pair.rolling)?;
            let torsion = length("the torsional friction", &pair.torsion)?;
            let meets = pair.meet.as_ref().is_none_or(|meet| *meet.get_ref());
            match (meets, own.or(rubs).or(rolling).or(torsion)) {
                (true, None) => return Err(at(place, Fault::PairSaysNothing)),
                (false, Some(_)) => return Err(at(place, Fault::SurfaceOfNoContact)),
                _ => {}
            }
            pairs.push(ScenePair {
                of,
                restitution: own.unwrap_or(restitution),
                friction: rubs.unwrap_or(friction),
                rolling: rolling.unwrap_or(0.0),
                torsion: torsion.unwrap_or(0.0),
                meets,
            });
        }
        Ok(pairs)
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
