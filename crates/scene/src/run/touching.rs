//! Bodies that touch, or whose joints have limits or friction: steps with inequalities, under whatever acts.
//!
//! ```text
//! v~ = v + h M^-1 (F - dV)          F loads, motors with a torque, drag, dampers, gravity in time
//! joints, contacts with friction    solved together
//! ```
//! The works of friction, impacts and joints are those of the [report](stationary_contact::WorldReport). What
//! is left of the energy's budget is the defect of steps of order 1.

use stationary_calculus::{Force, Potential, Vector};
use stationary_contact::{
    ColliderIn, ContactError, Detector, DetectorIn, Dimension, ImpactLaw, PlanarDetector,
    StepForces, Touch, World,
};
use stationary_integrators::{Saved, State};
use stationary_rigid::BodyMethod;

use crate::assemble::body_system::{InSpace, InThePlane};
use crate::assemble::colliders::Colliders;
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::contact_side::ContactSide;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::given::Given;
use crate::run::joint_set::JointSet;
use crate::run::joints;
use crate::run::stepper::{Stepped, Stepper};

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(scene: &Scene, of: &'a InSpace) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => spatial(scene, &with, &with.in_space()?),
        None => spatial(scene, scene, of),
    }
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(scene: &Scene, of: &'a InThePlane) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => planar(scene, &with, &with.in_the_plane()?),
        None => planar(scene, scene, of),
    }
}

/// A scene's steps, made of the scene with its obstacles.
fn spatial<'a>(own: &Scene, scene: &Scene, of: &InSpace) -> Made<'a> {
    let (detector, colliders) = detecting_in_space(scene, of)?;
    let joints = joints_in_space(scene, of)?;
    let world = World::new(of.system.clone(), detector)?.with_law(law(scene));
    Touching::over((own, scene), world, colliders, joints)
}

fn planar<'a>(own: &Scene, scene: &Scene, of: &InThePlane) -> Made<'a> {
    let (detector, colliders) = detecting_in_the_plane(scene, of)?;
    let joints = joints_in_the_plane(scene, of)?;
    let world = World::new(of.system.clone(), detector)?.with_law(law(scene));
    Touching::over((own, scene), world, colliders, joints)
}

/// What holds bodies in space. A start that moves against its joints is refused as without contact.
pub(crate) fn joints_in_space(scene: &Scene, of: &InSpace) -> Result<JointSet, AssemblyError> {
    if scene.has_joints() {
        let method = BodyMethod::VariationalRotation;
        joints::in_space(method, &of.system, &of.joints, (&of.initial, None))?;
    }
    JointSet::in_space(scene, of)
}

/// What holds them in the plane.
pub(crate) fn joints_in_the_plane(
    scene: &Scene,
    of: &InThePlane,
) -> Result<JointSet, AssemblyError> {
    if scene.has_joints() {
        joints::in_the_plane(&of.system, &of.joints, (&of.initial, None))?;
    }
    JointSet::in_the_plane(scene, of)
}

/// What detects the contacts of bodies in space, which are free at the start.
pub(crate) fn detecting_in_space(
    scene: &Scene,
    of: &InSpace,
) -> Result<(Detector, Colliders), AssemblyError> {
    let contact = scene.contact.as_ref();
    let shapes = contact.map(|contact| scene.colliders(contact)).transpose()?;
    let (mut detector, colliders) = detecting(scene, shapes.unwrap_or_default())?;
    check_free(&mut detector, scene.bodies.len(), &of.initial.q)?;
    Ok((detector, colliders))
}

/// What detects those of bodies in the plane.
pub(crate) fn detecting_in_the_plane(
    scene: &Scene,
    of: &InThePlane,
) -> Result<(PlanarDetector, Colliders), AssemblyError> {
    let contact = scene.contact.as_ref();
    let shapes = contact.map(|contact| scene.planar_colliders(contact)).transpose()?;
    let (mut detector, colliders) = detecting(scene, shapes.unwrap_or_default())?;
    check_free(&mut detector, scene.bodies.len(), &of.initial.q)?;
    Ok((detector, colliders))
}

/// What detects contacts; none without the word.
fn detecting<G: Dimension>(
    scene: &Scene,
    shapes: Vec<ColliderIn<G>>,
) -> Result<(DetectorIn<G>, Colliders), ContactError> {
    match &scene.contact {
        Some(contact) => Ok((scene.detector(&shapes, contact)?, Colliders::of(&shapes, contact))),
        None => Ok((DetectorIn::new(Vec::new(), scene.bodies.len())?, Colliders::default())),
    }
}

pub(crate) fn law(scene: &Scene) -> ImpactLaw {
    scene.contact.as_ref().map_or(ImpactLaw::GeneralizedReflections, |contact| contact.law)
}

/// What steps bodies that touch, or that inequalities hold.
struct Touching<G: Dimension, P> {
    world: World<G, P>,
    joints: JointSet,
    /// The forces of joints and the tensions of rods in the last step.
    forces: Vec<f64>,
    touches: bool,
    rubs: bool,
    holds: bool,
    colliders: Colliders,
    pins: RoundPins,
    given: Given,
    /// The state with obstacles.
    with: State<Vec<f64>>,
    before: State<Vec<f64>>,
    mean: Vec<f64>,
    /// What acts, then friction, impacts, lifting and joints, as [`Scene::works_of`] names them.
    works: Vec<f64>,
}

impl<'a, G: Dimension, P: Potential + 'a> Touching<G, P> {
    fn over(
        (scene, with): (&Scene, &Scene),
        world: World<G, P>,
        colliders: Colliders,
        joints: JointSet,
    ) -> Made<'a> {
        let obstacles = (scene.bodies.len()..with.bodies.len()).collect();
        Ok(Box::new(Touching {
            world: world.with_obstacles(obstacles)?,
            joints,
            forces: Vec::new(),
            touches: scene.touches_as_bodies(),
            rubs: scene.joints.iter().any(|joint| joint.friction > 0.0),
            holds: scene.has_joints(),
            colliders,
            pins: RoundPins::of(scene),
            given: Given::of(scene),
            with: State::default(),
            before: State::default(),
            mean: Vec::new(),
            works: Vec::new(),
        }))
    }
}

/// The pins that have a size, by their places in the scene: those that stay, and those that move, which come after
/// so many bodies.
pub(crate) struct RoundPins {
    stay: Vec<usize>,
    bodies: usize,
    moving: Vec<usize>,
}

impl RoundPins {
    pub(crate) fn of(scene: &Scene) -> Self {
        let moving: Vec<usize> = scene.obstacles().collect();
        let stay = scene.round_pins().filter(|pin| !moving.contains(pin)).collect();
        RoundPins { stay, bodies: scene.bodies.len(), moving }
    }

    /// A side of the detector's as the scene has it.
    fn named(&self, side: ContactSide) -> ContactSide {
        match side {
            ContactSide::Pin(pin) => ContactSide::Pin(self.stay[pin]),
            ContactSide::Body(body) if body >= self.bodies => {
                ContactSide::Pin(self.moving[body - self.bodies])
            }
            other => other,
        }
    }
}

/// The impulse of a contact on its second side: what nothing moves stands first.
pub(crate) fn push<G: Dimension>(
    (colliders, pins): (Colliders, &RoundPins),
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
    let side = |k: usize| colliders.side(contact.bodies[k], contact.id.colliders[k]);
    let between = [0, 1].map(|k| pins.named(side(k)));
    let turned = between[0].moves() && !between[1].moves();
    let [first, second] = between;
    let sign = if turned { -1.0 } else { 1.0 };
    Push {
        between: if turned { [second, first] } else { between },
        time,
        point: in_space(&((a + b) * 0.5)),
        normal: in_space(&(contact.normal * sign)),
        impulse: in_space(&(whole * sign)),
    }
}

impl<G: Dimension, P: Potential> Stepper for Touching<G, P> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        self.before.clone_from(state);
        self.with.clone_from(state);
        self.given.prepare(&mut self.with, h);
        self.given.check_solved()?;
        let met = self.world.step_under(&mut self.with, h, &self.joints, &self.given)?;
        self.given.obstacles().leave_out(&mut self.with);
        std::mem::swap(state, &mut self.with);
        self.works.clear();
        self.works.resize(self.given.works(), 0.0);
        let [before, after] = self.world.velocities();
        self.mean.clear();
        self.mean
            .extend(before.0.iter().zip(after.0).map(|(before, after)| 0.5 * (before + after)));
        self.given.add_works([&self.before, state], Vector(&self.mean), &mut self.works);
        if self.touches {
            self.works.extend([-met.friction_energy, -met.impact_energy]);
        }
        self.works.extend((!self.given.obstacles().is_empty()).then_some(met.work));
        self.works.push(met.lifting_energy);
        self.works.extend(self.rubs.then_some(-met.joint_friction_energy));
        let of_joints = met.joint_friction_energy - met.joint_energy;
        self.works.extend(self.holds.then_some(of_joints));
        self.joints.forces(self.world.joint_impulses(), h, &mut self.forces);
        let broken = self.joints.break_one(&self.forces, to);
        let unsettled = (!met.settled).then_some(met.residual.max(met.coulomb));
        Ok(Stepped { unsettled, broken, ..Stepped::met(met.impacts, state.t) })
    }

    /// A rod that broke does not mend.
    fn takes_parts(&self) -> bool {
        !self.joints.breaks()
    }

    fn multipliers(&self) -> &[f64] {
        &self.forces
    }

    fn works(&self) -> &[f64] {
        &self.works
    }

    fn save(&mut self) -> Saved {
        self.world.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.joints.restore(&before.broken);
        Ok(self.world.load(&before.memory)?)
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        let of = (self.colliders, &self.pins);
        self.world.touches().for_each(|touch| see(push(of, &touch, time)));
    }

    fn built(&self) -> Built {
        let colliders = self.colliders.count() as u64;
        let equations = self.joints.equations() as u64;
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
