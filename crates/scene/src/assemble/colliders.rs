//! Bodies that touch as the contact crate has them: their shapes, walls, fixed balls and pins that have a size.
//!
//! Two bodies, and a body and what is fixed, have the scene's restitution and friction, or those of their
//! pair, or pass through each other, as do two bodies that a joint joins.

use nalgebra::{Vector2, Vector3};
use stationary_contact::{
    Collider, ColliderIn, ContactError, DetectorIn, Dimension, PlanarCollider, PlanarShape, Shape,
};
use stationary_rigid::{LieGroup, PlanarMotion, RigidMotion};

use crate::model::body_shape::BodyShape;
use crate::model::contact_side::ContactSide;
use crate::model::items::{SceneContact, ScenePair};
use crate::model::scene::Scene;

/// How many shapes there are: those of bodies, then walls, then fixed balls, then pins.
#[derive(Clone, Copy)]
pub(crate) struct Colliders {
    all: usize,
    fixed: usize,
    walls: usize,
    balls: usize,
}

impl Colliders {
    pub(crate) fn of<G: Dimension>(all: &[ColliderIn<G>], contact: &SceneContact) -> Self {
        let fixed = all.iter().filter(|collider| collider.body().is_none()).count();
        let (walls, balls) = (contact.walls.len(), contact.balls.len());
        Colliders { all: all.len(), fixed, walls, balls }
    }

    /// How many there are.
    pub(crate) fn count(self) -> usize {
        self.all
    }

    /// The collider of what takes part in contacts; a body that is only moments has none.
    pub(crate) fn of_side<G: Dimension>(
        self,
        side: ContactSide,
        all: &[ColliderIn<G>],
    ) -> Option<usize> {
        let fixed = all.len() - self.fixed;
        match side {
            ContactSide::Body(body) => all.iter().position(|other| other.body() == Some(body)),
            ContactSide::Wall(wall) => Some(fixed + wall),
            ContactSide::Ball(ball) => Some(fixed + self.walls + ball),
            ContactSide::Pin(_) | ContactSide::Particle(_) => None,
        }
    }

    /// What takes part in a contact.
    pub(crate) fn side(self, body: Option<usize>, collider: u32) -> ContactSide {
        let place = (collider as usize + self.fixed).saturating_sub(self.all);
        match (body, place.checked_sub(self.walls)) {
            (Some(body), _) => ContactSide::Body(body),
            (None, None) => ContactSide::Wall(place),
            (None, Some(ball)) if ball < self.balls => ContactSide::Ball(ball),
            (None, Some(pin)) => ContactSide::Pin(pin - self.balls),
        }
    }
}

impl Scene {
    /// What detects contacts. Bodies that a joint joins pass through each other, unless a pair says how they
    /// touch.
    pub(crate) fn detector<G: Dimension>(
        &self,
        colliders: &[ColliderIn<G>],
        contact: &SceneContact,
    ) -> Result<DetectorIn<G>, ContactError> {
        let mut detector = DetectorIn::new(colliders.to_vec(), self.bodies.len())?;
        let all = Colliders::of(colliders, contact);
        let of = |pair: [ContactSide; 2]| -> Option<[usize; 2]> {
            let [a, b] = pair.map(|side| all.of_side(side, colliders));
            Some([a?, b?])
        };
        for joint in &self.joints {
            let [Some(a), Some(b)] = joint.between else { continue };
            let sides = [ContactSide::Body(a), ContactSide::Body(b)];
            let own = |pair: &ScenePair| pair.of == sides || pair.of == [sides[1], sides[0]];
            if let Some(pair) = of(sides).filter(|_| !contact.pairs.iter().any(own)) {
                detector = detector.without_pair(pair)?;
            }
        }
        for pair in &contact.pairs {
            let Some(two) = of(pair.of) else { continue };
            detector =
                match pair.meets {
                    true => detector
                        .with_pair(two, pair.restitution, pair.friction)?
                        .with_rolling(two, pair.rolling, pair.torsion)?,
                    false => detector.without_pair(two)?,
                };
        }
        Ok(detector)
    }
}

impl Scene {
    /// The shapes of bodies in space that touch, and of what is fixed.
    pub(crate) fn colliders(&self, contact: &SceneContact) -> Result<Vec<Collider>, ContactError> {
        let of_body = |shape: &BodyShape| match shape {
            BodyShape::Box(sides) => Shape::cuboid(sides.map(|side| 0.5 * side)).map(Some),
            BodyShape::Ball(radius) => Shape::ball(*radius).map(Some),
            BodyShape::Polygon(_) | BodyShape::Moments => Ok(None),
        };
        let at = |translation| RigidMotion { translation, ..RigidMotion::identity() };
        let mut fixed = Vec::new();
        for wall in &contact.walls {
            let normal = Vector3::from(wall.normal);
            fixed.push((at(normal * wall.offset), Shape::half_space(normal)?));
        }
        for ball in &contact.balls {
            fixed.push((at(ball.centre.into()), Shape::ball(ball.radius)?));
        }
        for pin in self.round_pins().map(|pin| &self.particles[pin]) {
            fixed.push((at(pin.position.into()), Shape::ball(pin.radius)?));
        }
        self.all_alike(contact, of_body, fixed)
    }

    /// The shapes of bodies in the plane that touch, and of what is fixed.
    pub(crate) fn planar_colliders(
        &self,
        contact: &SceneContact,
    ) -> Result<Vec<PlanarCollider>, ContactError> {
        let of_body = |shape: &BodyShape| match shape {
            BodyShape::Box([a, b, _]) => PlanarShape::cuboid([0.5 * a, 0.5 * b]).map(Some),
            BodyShape::Ball(radius) => PlanarShape::disc(*radius).map(Some),
            BodyShape::Polygon(corners) => {
                let corners: Vec<Vector2<f64>> = corners.iter().map(|&x| x.into()).collect();
                PlanarShape::polygon(&corners).map(Some)
            }
            BodyShape::Moments => Ok(None),
        };
        let at = |translation| PlanarMotion { translation, ..PlanarMotion::identity() };
        let mut fixed = Vec::new();
        for wall in &contact.walls {
            let normal = Vector3::from(wall.normal).xy();
            fixed.push((at(normal * wall.offset), PlanarShape::half_plane(normal)?));
        }
        for ball in &contact.balls {
            let centre = Vector3::from(ball.centre).xy();
            fixed.push((at(centre), PlanarShape::disc(ball.radius)?));
        }
        for pin in self.round_pins().map(|pin| &self.particles[pin]) {
            fixed.push((at(Vector3::from(pin.position).xy()), PlanarShape::disc(pin.radius)?));
        }
        self.all_alike(contact, of_body, fixed)
    }

    fn all_alike<G: Dimension>(
        &self,
        contact: &SceneContact,
        of_body: impl Fn(&BodyShape) -> Result<Option<G::Shape>, ContactError>,
        fixed: Vec<(G::Motion, G::Shape)>,
    ) -> Result<Vec<ColliderIn<G>>, ContactError> {
        let mut colliders = Vec::new();
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some(shape) = of_body(&body.shape)? {
                colliders.push(ColliderIn::on_body(index, shape));
            }
        }
        colliders.extend(fixed.into_iter().map(|(place, shape)| ColliderIn::fixed(place, shape)));
        let surface = |collider: ColliderIn<G>| {
            // A particle has no friction.
            let smooth = collider.body().is_some_and(|body| self.bodies[body].point_mass);
            let friction = if smooth { 0.0 } else { contact.friction };
            collider.with_restitution(contact.restitution).with_friction(friction)
        };
        Ok(colliders.into_iter().map(surface).collect())
    }
}
