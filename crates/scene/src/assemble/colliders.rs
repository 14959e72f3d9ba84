//! Bodies that touch as the contact crate has them: their shapes, walls, fixed balls and pins that have a size.
//!
//! Two bodies, and a body and what is fixed, have the scene's restitution and friction, or those of their
//! pair, or pass through each other, as do two bodies that a joint joins.
//!
//! A particle without a radius is a point, here as among particles alone (`contacts.rs`): it enters nothing that has
//! a size, and passes through other points.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};
use stationary_contact::{
    Collider, ColliderIn, ContactError, DetectorIn, Dimension, PlanarCollider, PlanarShape, Shape,
};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation, RigidMotion, Rotation};

use crate::model::body_shape::{BodyPart, BodyShape};
use crate::model::contact_side::ContactSide;
use crate::model::items::{SceneContact, ScenePair};
use crate::model::scene::Scene;

/// The radius of a point, as a part of the scene's size: far below what contacts are solved to, and all that shapes
/// need to have one.
const POINT_RADIUS: f64 = 1e-9;
/// The group of points, which meet all others.
const POINTS: u32 = 1;

/// How many shapes there are: those of bodies, then walls, then fixed balls, then pins.
#[derive(Clone, Copy, Default)]
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

    /// The colliders of what takes part in contacts: one for each part of a body, and none of a body that
    /// is only moments.
    pub(crate) fn of_side<G: Dimension>(
        self,
        side: ContactSide,
        all: &[ColliderIn<G>],
    ) -> Range<usize> {
        let fixed = all.len() - self.fixed;
        let one = |place: usize| place..place + 1;
        match side {
            ContactSide::Body(body) => {
                // Those of a body stand together.
                let own = |other: &ColliderIn<G>| other.body() == Some(body);
                let first = all.iter().position(own).unwrap_or(all.len());
                first..first + all[first..].iter().take_while(|other| own(other)).count()
            }
            ContactSide::Wall(wall) => one(fixed + wall),
            ContactSide::Ball(ball) => one(fixed + self.walls + ball),
            ContactSide::Pin(_) | ContactSide::Particle(_) => 0..0,
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
        let of = |pair: [ContactSide; 2]| {
            let [first, second] = pair.map(|side| all.of_side(side, colliders));
            first.flat_map(move |a| second.clone().map(move |b| [a, b]))
        };
        for joint in &self.joints {
            let [Some(a), Some(b)] = joint.between else { continue };
            let sides = [ContactSide::Body(a), ContactSide::Body(b)];
            let own = |pair: &ScenePair| pair.of == sides || pair.of == [sides[1], sides[0]];
            if !contact.pairs.iter().any(own) {
                for two in of(sides) {
                    detector = detector.without_pair(two)?;
                }
            }
        }
        for pair in &contact.pairs {
            for two in of(pair.of) {
                detector = match pair.meets {
                    true => detector
                        .with_pair(two, pair.restitution, pair.friction)?
                        .with_rolling(two, pair.rolling, pair.torsion)?,
                    false => detector.without_pair(two)?,
                };
            }
        }
        Ok(detector)
    }
}

impl Scene {
    /// The shapes of bodies in space that touch, and of what is fixed.
    pub(crate) fn colliders(&self, contact: &SceneContact) -> Result<Vec<Collider>, ContactError> {
        let place = |part: &BodyPart| RigidMotion {
            translation: part.position.into(),
            rotation: Rotation::exp(part.rotation.into()),
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
        self.all_alike(contact, (in_space, place), fixed)
    }

    /// The shapes of bodies in the plane that touch, and of what is fixed.
    pub(crate) fn planar_colliders(
        &self,
        contact: &SceneContact,
    ) -> Result<Vec<PlanarCollider>, ContactError> {
        let place = |part: &BodyPart| {
            let [x, y, _] = part.position;
            let rotation = PlanarRotation::exp(part.rotation[2]);
            PlanarMotion { translation: Vector2::new(x, y), rotation }
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
        self.all_alike(contact, (in_the_plane, place), fixed)
    }

    fn all_alike<G: Dimension>(
        &self,
        contact: &SceneContact,
        (of_body, place): (
            impl Fn(&BodyShape) -> Result<Option<G::Shape>, ContactError>,
            impl Fn(&BodyPart) -> G::Motion,
        ),
        fixed: Vec<(G::Motion, G::Shape)>,
    ) -> Result<Vec<ColliderIn<G>>, ContactError> {
        let (mut colliders, size) = (Vec::new(), self.scale());
        for (index, body) in self.bodies.iter().enumerate() {
            if let BodyShape::Parts(parts) = &body.shape {
                for part in parts {
                    let shape = of_body(&part.shape)?;
                    let collider = shape.map(|shape| ColliderIn::on_body(index, shape));
                    let place = place(part);
                    colliders.extend(collider.map(|collider| ColliderIn { place, ..collider }));
                }
            } else if body.point_mass && body.shape == BodyShape::Moments {
                let ball = BodyShape::Ball(POINT_RADIUS * size);
                let shape = of_body(&ball)?;
                let point = |shape| ColliderIn::on_body(index, shape).in_groups(POINTS, !POINTS);
                colliders.extend(shape.map(point));
            } else if let Some(shape) = of_body(&body.shape)? {
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

/// A shape of space; none of moments alone.
fn in_space(shape: &BodyShape) -> Result<Option<Shape>, ContactError> {
    let shape = match shape {
        BodyShape::Box(sides) => Shape::cuboid(sides.map(|side| 0.5 * side)),
        BodyShape::Ball(radius) => Shape::ball(*radius),
        BodyShape::Capsule { length, radius } => Shape::capsule(0.5 * length, *radius),
        BodyShape::Cylinder { length, radius } => Shape::cylinder(0.5 * length, *radius),
        BodyShape::Cone { height, radius } => Shape::cone(*height, *radius),
        BodyShape::Ellipsoid(half_axes) => Shape::ellipsoid(*half_axes),
        BodyShape::Hull { corners, .. } => {
            let corners: Vec<Vector3<f64>> = corners.iter().map(|&x| x.into()).collect();
            Shape::convex(&corners)
        }
        BodyShape::Polygon(_) | BodyShape::Moments | BodyShape::Parts(_) => return Ok(None),
    };
    shape.map(Some)
}

/// A shape of the plane; none of moments alone.
fn in_the_plane(shape: &BodyShape) -> Result<Option<PlanarShape>, ContactError> {
    let shape = match shape {
        BodyShape::Box([a, b, _]) => PlanarShape::cuboid([0.5 * a, 0.5 * b]),
        BodyShape::Ball(radius) => PlanarShape::disc(*radius),
        BodyShape::Capsule { length, radius } => PlanarShape::capsule(0.5 * length, *radius),
        BodyShape::Polygon(corners) => {
            let corners: Vec<Vector2<f64>> = corners.iter().map(|&x| x.into()).collect();
            PlanarShape::polygon(&corners)
        }
        _ => return Ok(None),
    };
    shape.map(Some)
}
