//! The mechanical system of a scene of bodies, and what steps it.
//!
//! ```text
//! in space       M = diag(m, m, m, I1, I2, I3) a body, in its axes     7 numbers store 6 freedoms
//! in the plane   M = diag(m, m, I) a body, flat                        (x, y, theta)
//! V = uniform gravity,     g = joints, held by RATTLE,  or gaps, closed by impacts and friction
//! ```

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{DiagonalMetric, Metric, Potential, Space, System};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, Few, FreeMotion, Many, Rattle, Redundancy,
    Straight,
};
use stationary_contact::{
    Bodies, Collider, ImpactLaw, PlanarCollider, PlanarWorld, TouchingBodies,
};
use stationary_integrators::{Integrator, Saved, State, StepError, StepReport};
use stationary_rigid::{
    Attachment, AxisRotations, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace,
    ConstantVelocity, ExactRotation, Free, FreeBodies, Joint, LieGroup, PlanarAttachment,
    PlanarJoint, PlanarWeight, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::colliders::detector;
use crate::error::StepFailure;
use crate::stepper::Stepped;
use crate::{AssemblyError, JointKind, RigidBody, Scene, SceneJoint, Stepping};

/// What steps bodies.
pub(crate) enum Steps<'a> {
    /// A method, of bodies without joints.
    Free(Box<dyn Integrator<Vec<f64>> + 'a>),
    /// RATTLE, of bodies with joints.
    Held(Box<dyn ConstrainedIntegrator<Vec<f64>> + 'a>),
    /// Impacts and friction, of bodies that touch in space.
    Touching(Box<TouchingBodies<'a, Load>>),
    /// The same in the plane.
    PlanarTouching(Box<PlanarWorld<PlanarLoad>>),
}

impl Steps<'_> {
    /// Moves the state by a step.
    pub(crate) fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<Stepped, StepFailure> {
        match self {
            Steps::Free(integrator) => Ok(Stepped::done(integrator.step(state, h)?)),
            Steps::Held(rattle) => {
                let differentials = rattle.step(state, h)?.differentials;
                Ok(Stepped::done(StepReport { differentials, ..StepReport::default() }))
            }
            Steps::Touching(touching) => {
                let met = touching.step(state, h)?;
                Ok(Stepped::met(met.impacts, state.t))
            }
            Steps::PlanarTouching(world) => {
                let met = world.step(state, h)?;
                Ok(Stepped::met(met.impacts, state.t))
            }
        }
    }

    /// What the next steps depend on beside the state.
    pub(crate) fn save(&self) -> Saved {
        match self {
            Steps::Free(integrator) => integrator.save(),
            Steps::Held(rattle) => rattle.save(),
            Steps::Touching(touching) => touching.save(),
            Steps::PlanarTouching(world) => world.save(),
        }
    }

    /// Takes back what was saved.
    pub(crate) fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        match self {
            Steps::Free(integrator) => integrator.load(saved),
            Steps::Held(rattle) => rattle.load(saved),
            Steps::Touching(touching) => touching.load(saved),
            Steps::PlanarTouching(world) => world.load(saved),
        }
    }
}

/// What a run asks of bodies in space and in the plane alike.
pub(crate) trait BodySystem {
    /// Where they start.
    fn initial(&self) -> &State<Vec<f64>>;

    /// What steps them.
    fn steps(&self, method: Stepping) -> Result<Steps<'_>, AssemblyError>;

    /// Their kinetic and their potential energy.
    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2];

    /// How a body moves, as a body in space.
    fn motion(&self, state: &State<Vec<f64>>, body: usize) -> BodyMotion;
}

/// Bodies in space.
pub(crate) struct InSpace {
    system: Bodies<Load>,
    joints: Vec<Joint<Poses>>,
    contact: Option<(Vec<Collider>, ImpactLaw)>,
    initial: State<Vec<f64>>,
}

type Load = (Option<Weight<Poses>>, Free);
type PlanarLoad = (Option<PlanarWeight>, Free);

/// Bodies in the plane.
pub(crate) struct InThePlane {
    system: System<DiagonalMetric<Vec<f64>>, PlanarLoad>,
    joints: Vec<PlanarJoint>,
    contact: Option<(Vec<PlanarCollider>, ImpactLaw)>,
    initial: State<Vec<f64>>,
}

/// Equations up to which every one may depend on others, as in a planar loop of hinges.
const FEW: usize = 24;

/// RATTLE with a solver that fits the number of equations.
fn held<'a, M: Metric, P: Potential, S: Space, K: Constraint>(
    motion: impl FreeMotion<M, S> + Clone + 'a,
    system: &'a System<M, P, S>,
    joints: &'a K,
    initial: &State<Vec<f64>>,
) -> Result<Steps<'a>, ConstraintError> {
    if joints.count() > FEW {
        let many = Many(Redundancy::LeastNorm);
        return Ok(Steps::Held(Box::new(Rattle::along(motion, system, joints, initial, many)?)));
    }
    let few = Few::<FEW>(Redundancy::LeastNorm);
    Ok(Steps::Held(Box::new(Rattle::along(motion, system, joints, initial, few)?)))
}

impl BodySystem for InSpace {
    fn initial(&self) -> &State<Vec<f64>> {
        &self.initial
    }

    fn steps(&self, method: Stepping) -> Result<Steps<'_>, AssemblyError> {
        let Stepping::Bodies(method) = method else {
            return Err(AssemblyError::Bodies);
        };
        let InSpace { system, joints, contact, initial } = self;
        if let Some((colliders, law)) = contact {
            let detector = detector(colliders, system.metric().bodies().len(), &initial.q)?;
            let touching = TouchingBodies::new(system, detector)?.with_law(*law);
            return Ok(Steps::Touching(Box::new(touching)));
        }
        if joints.is_empty() {
            return Ok(Steps::Free(method.integrator(system)?));
        }
        Ok(match method {
            BodyMethod::AxisRotations => held(FreeBodies(AxisRotations), system, joints, initial),
            BodyMethod::ExactRotation => held(FreeBodies(ExactRotation), system, joints, initial),
            _ => held(FreeBodies(ConstantVelocity), system, joints, initial),
        }?)
    }

    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2] {
        let kinetic = self.system.metric().kinetic_energy(state.p.view());
        [kinetic, self.system.potential().energy(&state.q)]
    }

    fn motion(&self, state: &State<Vec<f64>>, body: usize) -> BodyMotion {
        let (of, p) = (self.system.metric().bodies()[body], &state.p.0[6 * body..][..6]);
        BodyMotion {
            pose: Poses::pose(&state.q, body),
            velocity: Vector3::from_column_slice(&p[..3]) / of.mass(),
            angular_velocity: of.angular_velocity(&Vector3::from_column_slice(&p[3..])),
        }
    }
}

impl BodySystem for InThePlane {
    fn initial(&self) -> &State<Vec<f64>> {
        &self.initial
    }

    fn steps(&self, method: Stepping) -> Result<Steps<'_>, AssemblyError> {
        let Stepping::Equal(method) = method else {
            return Err(AssemblyError::Bodies);
        };
        if let Some((colliders, law)) = &self.contact {
            let detector = detector(colliders, self.system.dim() / 3, &self.initial.q)?;
            let world = PlanarWorld::new(self.system.clone(), detector)?.with_law(*law);
            return Ok(Steps::PlanarTouching(Box::new(world)));
        }
        if self.joints.is_empty() {
            return Ok(Steps::Free(method.integrator(&self.system)?));
        }
        Ok(held(Straight, &self.system, &self.joints, &self.initial)?)
    }

    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2] {
        let kinetic = self.system.metric().kinetic_energy(state.p.view());
        [kinetic, self.system.potential().energy(&state.q)]
    }

    fn motion(&self, state: &State<Vec<f64>>, body: usize) -> BodyMotion {
        let masses = &self.system.metric().masses()[3 * body..][..3];
        let (q, p) = (&state.q[3 * body..][..3], &state.p.0[3 * body..][..3]);
        let rotation = Rotation::exp(Vector3::z() * q[2]);
        BodyMotion {
            pose: RigidMotion { translation: Vector3::new(q[0], q[1], 0.0), rotation },
            velocity: Vector3::new(p[0] / masses[0], p[1] / masses[1], 0.0),
            angular_velocity: Vector3::z() * (p[2] / masses[2]),
        }
    }
}

/// A joint's place in the axes of an end, and the turn of that end.
fn seen(bodies: &[RigidBody], end: Option<usize>, place: [f64; 3]) -> (Vector3<f64>, Rotation) {
    match end {
        None => (place.into(), Rotation::identity()),
        Some(index) => {
            let body = &bodies[index];
            let arm = Vector3::from(place) - Vector3::from(body.position);
            (body.turned().rotate_back(&arm), body.turned())
        }
    }
}

fn joint_in_space(bodies: &[RigidBody], joint: &SceneJoint) -> Result<Joint<Poses>, AssemblyError> {
    let sides = joint.between.map(|end| seen(bodies, end, joint.place));
    let ends = [0, 1].map(|side| match joint.between[side] {
        None => Attachment::World(sides[side].0),
        Some(body) => Attachment::Body(body, sides[side].0),
    });
    let (count, axis) = (bodies.len(), Vector3::from(joint.axis));
    Ok(match joint.kind {
        JointKind::Ball => Joint::ball(Poses, count, ends),
        JointKind::Hinge => {
            Joint::hinge(Poses, count, ends, [0, 1].map(|side| sides[side].1.rotate_back(&axis)))
        }
        JointKind::Fixed => {
            Joint::fixed(Poses, count, ends, [0, 1].map(|side| sides[side].1.inverse()))
        }
    }?)
}

fn joint_in_the_plane(
    bodies: &[RigidBody],
    joint: &SceneJoint,
) -> Result<PlanarJoint, AssemblyError> {
    let ends = joint.between.map(|end| {
        let place = seen(bodies, end, joint.place).0.xy();
        match end {
            None => PlanarAttachment::World(place),
            Some(body) => PlanarAttachment::Body(body, place),
        }
    });
    let [a, b] = joint.between.map(|end| end.map_or(0.0, |index| bodies[index].rotation[2]));
    Ok(match joint.kind {
        JointKind::Fixed => PlanarJoint::weld(bodies.len(), ends, a - b),
        _ => PlanarJoint::pin(bodies.len(), ends),
    }?)
}

impl Scene {
    /// The scene's bodies in space.
    pub(crate) fn in_space(&self) -> Result<InSpace, AssemblyError> {
        let made = self.bodies.iter().map(|body| Body::new(body.mass, body.moments));
        let metric = BodyMetric::<Poses>::new(made.collect::<Result<Vec<_>, _>>()?);
        let motion = |body: &RigidBody| BodyMotion {
            pose: RigidMotion { translation: body.position.into(), rotation: body.turned() },
            velocity: body.velocity.into(),
            angular_velocity: body.angular_velocity.into(),
        };
        let initial = metric.state(&self.bodies.iter().map(motion).collect::<Vec<_>>())?;
        let load = |body: &RigidBody| PointMass { mass: body.mass, point: Vector3::zeros() };
        let weight = self.gravity.acceleration.map(|gravity| Weight {
            gravity: gravity.into(),
            masses: self.bodies.iter().map(load).collect(),
            space: Poses,
        });
        let free = Free { freedoms: 6 * self.bodies.len() };
        let joints = self.joints.iter().map(|joint| joint_in_space(&self.bodies, joint));
        Ok(InSpace {
            system: metric.under((weight, free))?,
            joints: joints.collect::<Result<_, _>>()?,
            contact: match &self.contact {
                Some(contact) => Some((self.colliders(contact)?, contact.law)),
                None => None,
            },
            initial,
        })
    }

    /// The scene's bodies in the plane.
    pub(crate) fn in_the_plane(&self) -> Result<InThePlane, AssemblyError> {
        let inertia = |body: &RigidBody| [body.mass, body.mass, body.moments[2]];
        let masses: Vec<f64> = self.bodies.iter().flat_map(inertia).collect();
        let place = |body: &RigidBody| [body.position[0], body.position[1], body.rotation[2]];
        let rates = |b: &RigidBody| [b.velocity[0], b.velocity[1], b.angular_velocity[2]];
        let q = self.bodies.iter().flat_map(place).collect();
        let v = self.bodies.iter().flat_map(rates);
        let p = v.zip(&masses).map(|(v, mass)| v * mass).collect();
        let weight = self.gravity.acceleration.map(|[x, y, _]| PlanarWeight {
            gravity: Vector2::new(x, y),
            masses: self.bodies.iter().map(|body| body.mass).collect(),
        });
        let free = Free { freedoms: masses.len() };
        let joints = self.joints.iter().map(|joint| joint_in_the_plane(&self.bodies, joint));
        Ok(InThePlane {
            system: System::new(DiagonalMetric::new(masses)?, (weight, free))?,
            joints: joints.collect::<Result<_, _>>()?,
            contact: match &self.contact {
                Some(contact) => Some((self.planar_colliders(contact)?, contact.law)),
                None => None,
            },
            initial: State::new(q, p),
        })
    }
}
