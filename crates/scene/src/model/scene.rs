//! A scene: what a file has said, checked. It can be run, and run otherwise.

use serde::Serialize;

use crate::model::claim::Claim;
use crate::model::drives::{Drives, PinMotion};
use crate::model::elastic_body::{ElasticBody, HeatedBody};
use crate::model::items::{JointKind, Link, RigidBody, Rod, SceneContact, SceneJoint};
use crate::model::observable::Observable;
use crate::model::particle::{Motion, Particle};
use crate::model::stepping::Stepping;
use crate::model::timing::Timing;
use crate::model::units::Units;

/// Particles or bodies and what acts on them, a method, and what is asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    pub(crate) title: String,
    pub(crate) dimension: usize,
    pub(crate) units: Units,
    pub(crate) stepping: Stepping,
    pub(crate) timing: Timing,
    pub(crate) gravity: Gravity,
    pub(crate) drag: Option<f64>,
    pub(crate) frame: Option<[f64; 3]>,
    pub(crate) drives: Drives,
    pub(crate) contact: Option<SceneContact>,
    pub(crate) particles: Vec<Particle>,
    pub(crate) written_out: usize,
    pub(crate) links: Vec<Link>,
    pub(crate) rods: Vec<Rod>,
    pub(crate) bodies: Vec<RigidBody>,
    pub(crate) joints: Vec<SceneJoint>,
    pub(crate) solids: Vec<ElasticBody>,
    pub(crate) heat: Option<HeatedBody>,
    /// The particles that are held until the start.
    pub(crate) hung: Vec<usize>,
    /// Pairs of points of bodies and solids that a picture joins.
    pub(crate) edges: Vec<[usize; 2]>,
    /// Triangles on the outside of solids.
    pub(crate) faces: Vec<[usize; 3]>,
    pub(crate) observables: Vec<Observable>,
    pub(crate) view: [f64; 3],
    /// They change no number, and are no part of what a checkpoint is of.
    #[serde(skip)]
    pub(crate) claims: Vec<Claim>,
}

/// The gravity of a scene, where it has one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gravity {
    /// The acceleration of a uniform field. Components beyond the scene's dimension are zero.
    pub acceleration: Option<[f64; 3]>,
    /// The constant G of the attraction of every two particles.
    pub constant: Option<f64>,
    /// Pinned particles that attract, and their masses.
    pub fixed: Vec<(usize, f64)>,
}

impl Scene {
    /// Its title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Its dimension: 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The words for its units.
    pub fn units(&self) -> &Units {
        &self.units
    }

    /// How it is stepped.
    pub fn stepping(&self) -> Stepping {
        self.stepping
    }

    /// Its step, horizon and samples.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Its gravity.
    pub fn gravity(&self) -> &Gravity {
        &self.gravity
    }

    /// The acceleration of gravity, where it does not change in time.
    pub(crate) fn steady_gravity(&self) -> Option<[f64; 3]> {
        self.gravity.acceleration.filter(|_| self.drives.gravity.is_none())
    }

    /// The coefficient c of the drag `F = -c v` on every free particle, where it has one.
    pub fn drag(&self) -> Option<f64> {
        self.drag
    }

    /// The angular velocity of the frame in which it is seen, where that turns.
    pub fn frame(&self) -> Option<[f64; 3]> {
        self.frame
    }

    /// What is driven: loads, motors, pins that move, gravity and heat in time.
    pub fn drives(&self) -> &Drives {
        &self.drives
    }

    /// How its things touch, where they do.
    pub fn contact(&self) -> Option<&SceneContact> {
        self.contact.as_ref()
    }

    /// Its particles: those that are written out, in the file's order, then the vertices of nets
    /// and of solids; or the centres of its bodies, then their points.
    pub fn particles(&self) -> &[Particle] {
        &self.particles
    }

    /// Its springs: those of nets, then those that are written out.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Its rods.
    pub fn rods(&self) -> &[Rod] {
        &self.rods
    }

    /// Its rigid bodies, in the file's order, and beside them its particles, which do not turn.
    pub fn bodies(&self) -> &[RigidBody] {
        &self.bodies
    }

    /// Its joints, in the file's order.
    pub fn joints(&self) -> &[SceneJoint] {
        &self.joints
    }

    /// Its elastic bodies, in the file's order.
    pub fn solids(&self) -> &[ElasticBody] {
        &self.solids
    }

    /// The body through which heat flows, where there is one: then there is nothing else.
    pub fn heat(&self) -> Option<&HeatedBody> {
        self.heat.as_ref()
    }

    /// Triangles on the outside of its elastic bodies, counterclockwise from there, by their places
    /// in [`Scene::particles`]; those of sheets are seen from one side.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.faces
    }

    /// What a run writes down besides the positions.
    pub fn observables(&self) -> &[Observable] {
        &self.observables
    }

    /// What it says of its own run.
    pub fn claims(&self) -> &[Claim] {
        &self.claims
    }

    /// The number of its freedoms, of which joints take some.
    pub fn freedoms(&self) -> usize {
        if let Some(body) = &self.heat {
            return body.held.iter().filter(|&&held| !held).count();
        }
        if !self.bodies.is_empty() {
            let rigid = self.rigid_bodies();
            let each = if self.dimension == 3 { 6 } else { 3 };
            return each * rigid + self.dimension * (self.bodies.len() - rigid);
        }
        let free = |particle: &&Particle| matches!(particle.motion, Motion::Free { .. });
        self.dimension * self.particles.iter().filter(free).count()
    }

    /// Whether joints, or rods that are held as joints are, take freedoms of its bodies.
    pub(crate) fn has_joints(&self) -> bool {
        let held = self.joints.len() + self.rods.len();
        !self.bodies.is_empty() && held > 0
    }

    /// How many equations a joint has.
    pub(crate) fn rows_of(&self, joint: &SceneJoint) -> usize {
        match (joint.kind, self.dimension) {
            (JointKind::Ball, dimension) => dimension,
            (JointKind::Slider, 2) => 2,
            (JointKind::Hinge | JointKind::Slider, _) => 5,
            (JointKind::Fixed, 3) => 6,
            (JointKind::Fixed, _) => 3,
        }
    }

    /// How many equations all joints have.
    pub(crate) fn rows_of_joints(&self) -> usize {
        self.joints.iter().map(|joint| self.rows_of(joint)).sum()
    }

    /// How many of its bodies turn: those that are particles come after them.
    pub(crate) fn rigid_bodies(&self) -> usize {
        self.bodies.iter().take_while(|body| !body.point_mass).count()
    }

    /// Whether a particle is a point of a body that turns.
    pub(crate) fn is_point_of_a_body(&self, particle: usize) -> bool {
        match self.particles[particle].motion {
            Motion::Carried { body, .. } => !self.bodies[body].point_mass,
            _ => false,
        }
    }

    /// The particle at the centre of a body.
    pub(crate) fn centre(&self, body: usize) -> usize {
        let centre =
            |p: &Particle| matches!(p.motion, Motion::Carried { body: own, .. } if own == body);
        self.particles.iter().position(centre).unwrap_or(body)
    }

    /// Whether a particle beside bodies is one that is written out: none of a net or a chain.
    fn is_lone_point_mass(&self, particle: &Particle) -> bool {
        let Motion::Carried { body, .. } = particle.motion else { return false };
        self.bodies[body].point_mass && !particle.name.contains('.')
    }

    /// The lines that a picture draws between particles: springs, or edges of bodies.
    pub(crate) fn lines(&self) -> impl Iterator<Item = [usize; 2]> {
        self.links.iter().map(|link| link.ends).chain(self.edges.iter().copied())
    }

    /// The particles whose paths a picture shows: those written out and those observed.
    pub(crate) fn followed(&self) -> Vec<usize> {
        let observed = self.observables.iter().filter_map(|observable| match *observable {
            Observable::Position(particle)
            | Observable::Velocity(particle)
            | Observable::Temperature(particle) => Some(particle),
            _ => None,
        });
        let mut followed: Vec<usize> =
            (0..self.written_out).chain(observed.filter(|&p| p >= self.written_out)).collect();
        let lone = |&p: &usize| self.is_lone_point_mass(&self.particles[p]);
        followed.extend((self.written_out..self.particles.len()).filter(lone));
        followed.sort_unstable();
        followed.dedup();
        followed
    }

    /// Pinned particles that attract and stay, with their masses.
    pub(crate) fn still_attractors(&self) -> impl Iterator<Item = (usize, f64)> {
        self.gravity.fixed.iter().copied().filter(|&(pin, _)| !self.drives.moves(pin))
    }

    /// Whether its things touch by impulses, and not by springs.
    pub(crate) fn has_impulses(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.stiffness.is_none())
    }

    /// Whether bodies touch, so that impacts, friction and joints are solved together.
    pub(crate) fn touches_as_bodies(&self) -> bool {
        self.contact.is_some() && !self.bodies.is_empty()
    }

    /// Whether bodies touch in steps that are chosen by their error.
    pub(crate) fn chooses_contact_steps(&self) -> bool {
        self.stepping.tolerance().is_some() && self.touches_as_bodies()
    }

    /// Whether its joints have limits or friction, or rods beside bodies break.
    pub(crate) fn has_bounds(&self) -> bool {
        let bounded = |joint: &SceneJoint| joint.limits.is_some() || joint.friction > 0.0;
        let breaks = self.rods.iter().any(|rod| rod.strength.is_finite());
        self.joints.iter().any(bounded) || (breaks && !self.bodies.is_empty())
    }

    /// Whether bodies are stepped with inequalities: what touches, limits, dry friction, rods that break.
    pub(crate) fn has_inequalities(&self) -> bool {
        self.touches_as_bodies() || self.has_bounds()
    }

    /// Whether a pin moves that holds a rod.
    pub(crate) fn moves_rods(&self) -> bool {
        self.rods.iter().any(|rod| self.pin_of(rod).is_some())
    }

    /// How the pin of a rod moves, where it does.
    pub(crate) fn pin_of(&self, rod: &Rod) -> Option<&PinMotion> {
        rod.ends.iter().find_map(|&end| self.drives.motion_of(end))
    }

    /// Whether a sample keeps the velocities of its particles: those of bodies follow from theirs.
    pub(crate) fn keeps_velocities(&self) -> bool {
        self.heat.is_none() && self.bodies.is_empty()
    }
}

/// Numbers that a sample keeps of each body.
pub(crate) fn numbers_of_a_body(dimension: usize) -> usize {
    // A quaternion, or an angle, and the two velocities.
    if dimension == 3 { 4 + 3 + 3 } else { 1 + 2 + 1 }
}

/// The names of the coordinates.
pub(crate) const COORDINATES: [&str; 3] = ["x", "y", "z"];
