//! Joints between the bodies of a scene, closed where they start.
//!
//! ```text
//! x_a(p) = x_b(p),    v_a + w_a x (p - x_a) = v_b + w_b x (p - x_b)       at the start
//! ```
//! A joint is given by its place `p`, and a hinge by its axis too, as the world sees them at the
//! start: so it is closed there, whatever the bodies' poses. Velocities that are not given follow from
//! joints (`joint_velocities.rs`); where they cannot it is an error. `x` centres, `v` velocities, `w` angular
//! velocities in world axes.

#[cfg(feature = "rigid")]
use crate::words::draft::DeclaredBody;
use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Number};
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{CONSTRAINTS, CONTACT, Feature, Of, Word};

table! {
    /// A joint, given by its place at the start.
    pub(crate) struct JointDeclaration = "a joint" {
        /// In space ball, hinge, slider or fixed; in the plane pin, slider or weld.
        kind: Spanned<String> = Kind::OneOf(&["ball", "hinge", "slider", "fixed", "pin", "weld"]),
        /// Two names.
        between: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// Where it is at the start, as the world sees it.
        at: Components = Kind::Vector,
        /// The axis of a hinge, or the direction of a slider, at the start, as the world sees it.
        axis: Option<Components> = Kind::Vector,
        /// Of a spring at a pin or a hinge: torque over the turn of the second against the first.
        stiffness: Option<Spanned<Number>> = Kind::NotNegative,
        /// The turn from the start at which that spring is at rest, within half a turn; 0 where it is missing.
        rest: Option<Spanned<Number>> = Kind::Number,
        /// Of a damper at a pin or a hinge: torque over the rate of the turn.
        damping: Option<Spanned<Number>> = Kind::NotNegative,
        /// The least and the largest turn of the second against the first from the start, at a pin or a hinge; of a
        /// slider the least and the largest shift along its axis. What meets them stops.
        limits: Option<Spanned<Vec<Spanned<Number>>>> = Kind::List(&Kind::Number),
        /// The largest torque of dry friction at a pin or a hinge; of a slider the largest force.
        friction: Option<Spanned<Number>> = Kind::NotNegative,
    }
}

impl Word for Vec<JointDeclaration> {
    const FEATURE: Option<Feature> = Some(CONSTRAINTS);
    const OF: Of = Of::Joints;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.kind.span())
    }

    fn inner(&self) -> Option<(&'static str, Feature, Range<usize>)> {
        let limits = |joint: &JointDeclaration| Some(("limits", joint.limits.as_ref()?.span()));
        let friction =
            |joint: &JointDeclaration| Some(("friction", joint.friction.as_ref()?.span()));
        let first = self.iter().find_map(|joint| limits(joint).or_else(|| friction(joint)));
        first.map(|(word, place)| (word, CONTACT, place))
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "rigid")]
        draft.joints.extend(declare(draft.dimension, &mut draft.bodies, self)?);
        #[cfg(not(feature = "rigid"))]
        let _ = draft;
        Ok(())
    }
}

#[cfg(feature = "rigid")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "rigid")]
mod compiled {
    use super::*;
    use std::collections::HashMap;

    use toml::Spanned;

    use crate::model::items::{JointKind, SceneJoint};
    use crate::text::check;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::{BodyFault, DriveFault, Fault};
    use crate::words::bodies::WORLD;
    use crate::words::joint_velocities::{
        self, VELOCITY, fastest, fastest_turn, forbidden_shift, forbidden_turn,
    };

    const IN_SPACE: [(&str, JointKind); 4] = [
        ("ball", JointKind::Ball),
        ("hinge", JointKind::Hinge),
        ("slider", JointKind::Slider),
        ("fixed", JointKind::Fixed),
    ];
    const IN_THE_PLANE: [(&str, JointKind); 3] =
        [("pin", JointKind::Ball), ("slider", JointKind::Slider), ("weld", JointKind::Fixed)];

    /// The joints that are declared; velocities that are not given are made to fit them.
    pub(crate) fn declare(
        dimension: usize,
        bodies: &mut [DeclaredBody],
        all: &[JointDeclaration],
    ) -> Checked<Vec<SceneJoint>> {
        let by_name = by_name(bodies);
        let joints = all
            .iter()
            .map(|declared| joint(dimension, &by_name, declared))
            .collect::<Checked<Vec<_>>>()?;
        for (joint, declared) in joints.iter().zip(all) {
            for body in joint.between.into_iter().flatten() {
                let arm = joint.place.iter().zip(bodies[body].body.position).map(|(a, b)| a - b);
                let value = arm.map(|x| x * x).sum::<f64>();
                if !value.is_finite() {
                    let what = "the square of the distance from the joint to its body";
                    return Err(at(declared.at.span(), Fault::NotFinite { what, value }));
                }
            }
        }
        joint_velocities::complete(dimension, bodies, &joints);
        let (speed, turning) = (fastest(bodies, &joints), fastest_turn(bodies));
        for (joint, declared) in joints.iter().zip(all) {
            let torn = forbidden_shift(bodies, joint);
            if torn.norm() > VELOCITY * speed {
                let [first, second] = joint.between.map(|end| named(bodies, end));
                let fault = BodyFault::JointTorn { first, second, apart: torn.norm() };
                return Err(at(declared.at.span(), fault));
            }
            if let Some(turn) = forbidden_turn(bodies, joint, turning) {
                return Err(at(declared.between.span(), BodyFault::JointTurns { turn }));
            }
        }
        Ok(joints)
    }

    /// The numbers of bodies by their names.
    pub(crate) fn by_name(bodies: &[DeclaredBody]) -> HashMap<&str, usize> {
        bodies.iter().enumerate().map(|(k, d)| (d.body.name.as_str(), k)).collect()
    }

    fn named(bodies: &[DeclaredBody], end: Option<usize>) -> String {
        end.map_or(WORLD, |body| bodies[body].body.name.as_str()).to_owned()
    }

    fn joint(
        dimension: usize,
        bodies: &HashMap<&str, usize>,
        declared: &JointDeclaration,
    ) -> Checked<SceneJoint> {
        let words: &[_] = if dimension == 3 { &IN_SPACE } else { &IN_THE_PLANE };
        let kind = check::word("joint", declared.kind.get_ref(), declared.kind.span(), words)?;
        let names = declared.between.get_ref();
        let [first, second] = names.as_slice() else {
            let fault = BodyFault::JointEnds(names.len());
            return Err(at(declared.between.span(), fault));
        };
        let between = [find(bodies, first)?, find(bodies, second)?];
        if between[0] == between[1] {
            return Err(at(
                declared.between.span(),
                BodyFault::JoinedToItself(first.get_ref().clone()),
            ));
        }
        let place = check::vector("the place of the joint", dimension, &declared.at)?;
        let axis = match (&declared.axis, kind) {
            (Some(axis), JointKind::Hinge | JointKind::Slider) => {
                check::direction("the axis", dimension, axis)?
            }
            (None, JointKind::Hinge | JointKind::Slider) => {
                return Err(at(declared.kind.span(), BodyFault::HingeAxis));
            }
            (Some(axis), _) => return Err(at(axis.span(), BodyFault::NoHinge)),
            (None, _) => [0.0, 0.0, 1.0],
        };
        let turns = kind == JointKind::Hinge || (kind == JointKind::Ball && dimension == 2);
        let number = |what, given: &Option<Spanned<Number>>| match given {
            Some(given) if !turns => Err(at(given.span(), BodyFault::SpringWithoutAxis)),
            Some(given) => check::finite(what, given),
            None => Ok(0.0),
        };
        let rest = number("the rest", &declared.rest)?;
        if let Some(given) = declared.rest.as_ref().filter(|_| rest.abs() > std::f64::consts::PI) {
            return Err(at(given.span(), BodyFault::BeyondHalfATurn(rest)));
        }
        let positive = |what, given: &Option<Spanned<Number>>| match given {
            Some(declared) => {
                number(what, given)?;
                check::not_negative(what, declared)
            }
            None => Ok(0.0),
        };
        let stiffness = positive("the stiffness", &declared.stiffness)?;
        let damping = positive("the damping", &declared.damping)?;
        if let (Some(given), true) = (&declared.rest, stiffness == 0.0) {
            return Err(at(given.span(), BodyFault::RestWithoutSpring));
        }
        let (limits, friction) = bounds(dimension, kind, declared)?;
        Ok(SceneJoint { kind, between, place, axis, stiffness, rest, damping, limits, friction })
    }

    /// Limits with the start between them, and the largest friction.
    fn bounds(
        dimension: usize,
        kind: JointKind,
        declared: &JointDeclaration,
    ) -> Checked<(Option<[f64; 2]>, f64)> {
        let (limits, friction) = (&declared.limits, &declared.friction);
        let turns = kind == JointKind::Hinge || (kind == JointKind::Ball && dimension == 2);
        let shifts = kind == JointKind::Slider;
        let place = limits.as_ref().map(Spanned::span);
        if let Some(place) = place.or(friction.as_ref().map(Spanned::span))
            && !(turns || shifts)
        {
            return Err(at(place, BodyFault::BoundsWithoutCoordinate));
        }
        let friction = friction.as_ref().map(|given| check::not_negative("the friction", given));
        let friction = friction.transpose()?.unwrap_or(0.0);
        let Some(given) = limits else { return Ok((None, friction)) };
        let [low, high] = given.get_ref().as_slice() else {
            let fault = DriveFault::TwoValues { key: "`limits`", got: given.get_ref().len() };
            return Err(at(given.span(), fault));
        };
        let mut limits = [0.0; 2];
        for (limit, given) in limits.iter_mut().zip([low, high]) {
            *limit = check::finite("the limit", given)?;
            // In space a turn is known up to whole ones.
            if dimension == 3 && turns && limit.abs() > std::f64::consts::PI {
                return Err(at(given.span(), BodyFault::BeyondHalfATurn(*limit)));
            }
        }
        let [low, high] = limits;
        if low > 0.0 || high < 0.0 || low >= high {
            return Err(at(given.span(), BodyFault::LimitsBesideTheStart { low, high }));
        }
        Ok((Some(limits), friction))
    }

    /// The body of this name, or the world.
    pub(crate) fn find(
        bodies: &HashMap<&str, usize>,
        name: &Spanned<String>,
    ) -> Checked<Option<usize>> {
        if name.get_ref() == WORLD {
            return Ok(None);
        }
        if let Some(&index) = bodies.get(name.get_ref().as_str()) {
            return Ok(Some(index));
        }
        let mut names: Vec<(&str, usize)> =
            bodies.iter().map(|(&name, &index)| (name, index)).collect();
        names.sort_by_key(|&(_, index)| index);
        let names = names.iter().map(|&(name, _)| name).chain([WORLD]);
        let fault = check::unknown("body", name.get_ref(), names, check::LISTED);
        Err(at(name.span(), fault))
    }
}
