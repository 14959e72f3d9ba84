//! Bodies that touch: the steps with impacts and friction.

use stationary_calculus::Potential;
use stationary_contact::{ContactError, DetectorIn, Dimension, Touch, World};
use stationary_integrators::{Saved, State};

use crate::assemble::body_system::{PlanarSystem, SpatialSystem};
use crate::assemble::colliders::{Colliders, detector};
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
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
    let mut detector = detector(&colliders, contact, scene.bodies.len())?;
    check_free(&mut detector, scene.bodies.len(), &initial.q)?;
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
    let mut detector = detector(&colliders, contact, scene.bodies.len())?;
    check_free(&mut detector, scene.bodies.len(), &initial.q)?;
    let touching = World::new(system.clone(), detector)?.with_law(contact.law);
    Ok(Box::new(Touching { touching, colliders: Colliders::of(&colliders, contact) }))
}

/// What steps bodies that touch.
struct Touching<G: Dimension, P> {
    touching: World<G, P>,
    colliders: Colliders,
}

/// The impulse of a contact on its second side.
fn push<G: Dimension>(colliders: Colliders, touch: &Touch<G>, time: f64) -> Push {
    let contact = &touch.contact;
    let in_space = |x: &G::Vector| {
        let mut components = [0.0; 3];
        (0..G::TRANSLATION).for_each(|k| components[k] = x[k]);
        components
    };
    let whole = contact.normal * (touch.impact + touch.normal) + touch.friction;
    let [a, b] = contact.points;
    Push {
        between: [0, 1].map(|k| colliders.side(contact.bodies[k], contact.id.colliders[k])),
        time,
        point: in_space(&((a + b) * 0.5)),
        normal: in_space(&contact.normal),
        impulse: in_space(&whole),
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
        self.touching.touches().for_each(|touch| see(push(self.colliders, &touch, time)));
    }

    fn built(&self) -> Built {
        Built { colliders: self.colliders.count() as u64, ..Built::default() }
    }
}

/// Overlap at the start that is rounding, relative to the size of the bodies.
const ROUNDING: f64 = 1e-9;

/// An error where bodies overlap at the start.
fn check_free<G: Dimension>(
    detector: &mut DetectorIn<G>,
    bodies: usize,
    q: &[f64],
) -> Result<(), ContactError> {
    let mut largest = 0.0_f64;
    for body in 0..bodies {
        largest = largest.max(detector.radius(body)?);
    }
    detector.check_free(q, ROUNDING * largest)
}
