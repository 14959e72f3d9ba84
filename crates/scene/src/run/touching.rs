//! Bodies that touch: their shapes, walls and fixed balls, and the steps with impacts and friction.
//!
//! Two bodies, and a body and what is fixed, have the scene's restitution and friction, or those of their
//! pair, or pass through each other.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::Potential;
use stationary_contact::{
    Collider, ColliderIn, ContactError, DetectorIn, Dimension, PlanarCollider, PlanarShape, Shape,
    Touch, World,
};
use stationary_integrators::{Saved, State};
use stationary_rigid::{LieGroup, PlanarMotion, RigidMotion};

use crate::assemble::body_system::{PlanarSystem, SpatialSystem};
use crate::assemble::error::AssemblyError;
use crate::model::body_shape::BodyShape;
use crate::model::built::Built;
use crate::model::contact_side::ContactSide;
use crate::model::items::SceneContact;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(
    scene: &Scene,
    contact: &SceneContact,
    system: &'a SpatialSystem,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    let colliders = scene.colliders(contact)?;
    let detector = detector(&colliders, contact, scene.bodies.len(), &initial.q)?;
    let touching = World::new(system.clone(), detector)?.with_law(contact.law);
    Ok(Box::new(Touching { touching, colliders: Colliders::of(&colliders, contact) }))
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    scene: &Scene,
    contact: &SceneContact,
    system: &'a PlanarSystem,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    let colliders = scene.planar_colliders(contact)?;
    let detector = detector(&colliders, contact, scene.bodies.len(), &initial.q)?;
    let touching = World::new(system.clone(), detector)?.with_law(contact.law);
    Ok(Box::new(Touching { touching, colliders: Colliders::of(&colliders, contact) }))
}

/// What steps bodies that touch.
struct Touching<G: Dimension, P> {
    touching: World<G, P>,
    colliders: Colliders,
}

/// How many shapes there are: those of bodies, then walls, then fixed balls.
#[derive(Clone, Copy)]
struct Colliders {
    all: usize,
    fixed: usize,
    walls: usize,
}

impl Colliders {
    fn of<G: Dimension>(all: &[ColliderIn<G>], contact: &SceneContact) -> Self {
        let walls = contact.walls.len();
        Colliders { all: all.len(), fixed: walls + contact.balls.len(), walls }
    }

    /// The collider of what takes part in contacts; a body that is only moments has none.
    fn of_side<G: Dimension>(self, side: ContactSide, all: &[ColliderIn<G>]) -> Option<usize> {
        let fixed = all.len() - self.fixed;
        match side {
            ContactSide::Body(body) => all.iter().position(|other| other.body() == Some(body)),
            ContactSide::Wall(wall) => Some(fixed + wall),
            ContactSide::Ball(ball) => Some(fixed + self.walls + ball),
            ContactSide::Pin(_) | ContactSide::Particle(_) => None,
        }
    }

    /// What takes part in a contact.
    fn side(self, body: Option<usize>, collider: u32) -> ContactSide {
        let place = (collider as usize + self.fixed).saturating_sub(self.all);
        match (body, place.checked_sub(self.walls)) {
            (Some(body), _) => ContactSide::Body(body),
            (None, None) => ContactSide::Wall(place),
            (None, Some(ball)) => ContactSide::Ball(ball),
        }
    }

    /// The impulse of a contact on its second side.
    fn push<G: Dimension>(self, touch: &Touch<G>, time: f64) -> Push {
        let contact = &touch.contact;
        let in_space = |x: &G::Vector| {
            let mut components = [0.0; 3];
            (0..G::TRANSLATION).for_each(|k| components[k] = x[k]);
            components
        };
        let whole = contact.normal * (touch.impact + touch.normal) + touch.friction;
        let [a, b] = contact.points;
        Push {
            between: [0, 1].map(|k| self.side(contact.bodies[k], contact.id.colliders[k])),
            time,
            point: in_space(&((a + b) * 0.5)),
            normal: in_space(&contact.normal),
            impulse: in_space(&whole),
        }
    }
}

impl<G: Dimension, P: Potential> Stepper for Touching<G, P> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let met = self.touching.step(state, h)?;
        let unsettled = (!met.settled).then_some(met.residual.max(met.coulomb));
        Ok(Stepped { unsettled, ..Stepped::met(met.impacts, state.t) })
    }

    fn save(&mut self) -> Saved {
        self.touching.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        Ok(self.touching.load(&before.memory)?)
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        self.touching.touches().for_each(|touch| see(self.colliders.push(&touch, time)));
    }

    fn built(&self) -> Built {
        Built { colliders: self.colliders.all as u64, ..Built::default() }
    }
}

/// Overlap at the start that is rounding, relative to the size of the bodies.
const ROUNDING: f64 = 1e-9;

/// A detector of contacts, which there are none of at the start but by touching.
fn detector<G: Dimension>(
    colliders: &[ColliderIn<G>],
    contact: &SceneContact,
    bodies: usize,
    q: &[f64],
) -> Result<DetectorIn<G>, ContactError> {
    let mut detector = DetectorIn::new(colliders.to_vec(), bodies)?;
    let all = Colliders::of(colliders, contact);
    for pair in &contact.pairs {
        let [a, b] = pair.of.map(|side| all.of_side(side, colliders));
        let (Some(a), Some(b)) = (a, b) else { continue };
        detector = match pair.meets {
            true => detector.with_pair([a, b], pair.restitution, pair.friction)?.with_rolling(
                [a, b],
                pair.rolling,
                pair.torsion,
            )?,
            false => detector.without_pair([a, b])?,
        };
    }
    let mut largest = 0.0_f64;
    for body in 0..bodies {
        largest = largest.max(detector.radius(body)?);
    }
    detector.check_free(q, ROUNDING * largest)?;
    Ok(detector)
}

impl Scene {
    /// The shapes of bodies in space that touch, and of what is fixed.
    fn colliders(&self, contact: &SceneContact) -> Result<Vec<Collider>, ContactError> {
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
        self.all_alike(contact, of_body, fixed)
    }

    /// The shapes of bodies in the plane that touch, and of what is fixed.
    fn planar_colliders(
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
            collider.with_restitution(contact.restitution).with_friction(contact.friction)
        };
        Ok(colliders.into_iter().map(surface).collect())
    }
}
