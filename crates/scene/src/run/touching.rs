//! Bodies that touch: the steps with impacts, friction and joints, under whatever acts on them.
//!
//! ```text
//! v~ = v + h M^-1 (F - dV)          F loads, motors with a torque, drag, dampers, gravity in time
//! joints, contacts with friction    solved together
//! W_k = <h F_k, (v+ + v')/2>        v+ after impacts, v' at the end of the step
//! ```
//! The works of friction, impacts and joints are those of the [report](stationary_contact::WorldReport). What
//! is left of the energy's budget is the defect of steps of order 1.

use stationary_calculus::{Covector, Force, Potential, Vector};
use stationary_constraints::Constraint;
use stationary_contact::{ContactError, DetectorIn, Dimension, Kept, Touch, World};
use stationary_integrators::{Saved, State};
use stationary_rigid::BodyMethod;

use crate::assemble::acting::{Acting, Impulses};
use crate::assemble::body_system::{InSpace, InThePlane};
use crate::assemble::colliders::Colliders;
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::contact_side::ContactSide;
use crate::model::items::SceneContact;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::joints;
use crate::run::stepper::{Stepped, Stepper};

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(scene: &Scene, contact: &SceneContact, of: &'a InSpace) -> Made<'a> {
    let colliders = scene.colliders(contact)?;
    let mut detector = scene.detector(&colliders, contact)?;
    check_free(&mut detector, scene.bodies.len(), &of.initial.q)?;
    if scene.has_joints() {
        // A start that moves against its joints is refused as without contact.
        let method = BodyMethod::VariationalRotation;
        joints::in_space(method, &of.system, &of.joints, (&of.initial, None))?;
    }
    let world = World::new(of.system.clone(), detector)?.with_law(contact.law);
    Ok(Touching::over(scene, world, Colliders::of(&colliders, contact), &of.joints))
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    scene: &Scene,
    contact: &SceneContact,
    of: &'a InThePlane,
) -> Made<'a> {
    let colliders = scene.planar_colliders(contact)?;
    let mut detector = scene.detector(&colliders, contact)?;
    check_free(&mut detector, scene.bodies.len(), &of.initial.q)?;
    if scene.has_joints() {
        joints::in_the_plane(&of.system, &of.joints, (&of.initial, None))?;
    }
    let world = World::new(of.system.clone(), detector)?.with_law(contact.law);
    Ok(Touching::over(scene, world, Colliders::of(&colliders, contact), &of.joints))
}

/// What steps bodies that touch.
struct Touching<G: Dimension, P, K> {
    world: World<G, P>,
    joints: Kept<K>,
    equations: usize,
    colliders: Colliders,
    /// The pins that have a size, by their places in the scene.
    pins: Vec<usize>,
    acting: Option<Acting>,
    given: Impulses,
    /// What acts, then friction, impacts, lifting and joints, as [`Scene::works_of`] names them.
    works: Vec<f64>,
}

impl<'a, G: Dimension, P: Potential + 'a, K: Constraint> Touching<G, P, &'a K> {
    fn over(
        scene: &Scene,
        world: World<G, P>,
        colliders: Colliders,
        joints: &'a K,
    ) -> Box<dyn Stepper + 'a> {
        Box::new(Touching {
            world,
            joints: Kept(joints),
            equations: joints.count(),
            colliders,
            pins: scene.round_pins().collect(),
            acting: Acting::of(scene),
            given: Impulses::default(),
            works: Vec::new(),
        })
    }
}

/// The impulse of a contact on its second side.
fn push<G: Dimension>(
    (colliders, pins): (Colliders, &[usize]),
    touch: &Touch<G>,
    time: f64,
) -> Push {
    let contact = &touch.contact;
    let in_space = |x: &G::Vector| {
        let mut components = [0.0; 3];
        (0..G::TRANSLATION).for_each(|k| components[k] = x[k]);
        components
    };
    let whole = contact.normal * (touch.impact + touch.normal) + touch.friction;
    let [a, b] = contact.points;
    Push {
        between: [0, 1].map(|k| match colliders.side(contact.bodies[k], contact.id.colliders[k]) {
            ContactSide::Pin(pin) => ContactSide::Pin(pins[pin]),
            other => other,
        }),
        time,
        point: in_space(&((a + b) * 0.5)),
        normal: in_space(&contact.normal),
        impulse: in_space(&whole),
    }
}

/// Impulses of a step as a force that lasts through it.
struct Over<'a> {
    impulses: &'a Impulses,
    h: f64,
}

impl Force for Over<'_> {
    fn dim(&self) -> usize {
        self.impulses.dim()
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for &(freedom, impulse) in self.impulses.entries() {
            f.0[freedom] += impulse / self.h;
        }
    }
}

impl<G: Dimension, P: Potential, K: Constraint> Stepper for Touching<G, P, K> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        self.given.clear();
        if let Some(acting) = &self.acting {
            let over = (state.t, h);
            acting.give(over, &state.q, state.p.components(), &mut self.given);
        }
        let forces = Over { impulses: &self.given, h };
        let met = self.world.step_under(state, h, &self.joints, &forces)?;
        self.works.clear();
        let [before, after] = self.world.velocities();
        self.works.extend(self.given.works(|freedom| 0.5 * (before.0[freedom] + after.0[freedom])));
        self.works.extend([-met.friction_energy, -met.impact_energy, met.lifting_energy]);
        self.works.extend((self.equations > 0).then_some(-met.joint_energy));
        let unsettled = (!met.settled).then_some(met.residual.max(met.coulomb));
        Ok(Stepped { unsettled, ..Stepped::met(met.impacts, state.t) })
    }

    fn works(&self) -> &[f64] {
        &self.works
    }

    fn save(&mut self) -> Saved {
        self.world.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        Ok(self.world.load(&before.memory)?)
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        let of = (self.colliders, &self.pins[..]);
        self.world.touches().for_each(|touch| see(push(of, &touch, time)));
    }

    fn built(&self) -> Built {
        let (colliders, equations) = (self.colliders.count() as u64, self.equations as u64);
        Built { colliders, equations, ..Built::default() }
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
