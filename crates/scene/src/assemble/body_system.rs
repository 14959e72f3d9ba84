//! The mechanical system of a scene of bodies, and what steps it.
//!
//! ```text
//! in space       M = diag(m, m, m, I1, I2, I3) a body, in its axes     7 numbers store 6 freedoms
//! in the plane   M = diag(m, m, I) a body, flat                        (x, y, theta)
//! V = uniform gravity, springs between points and at joints,     g = joints
//! joints alone are held by RATTLE, or are the coordinates; with contact they are solved with gaps and friction
//! ```

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Metric, Number, Potential, System};
use stationary_integrators::State;
use stationary_rigid::{
    Along, Body, BodyMetric, BodyMotion, BodySpace, Drive, Free, Joint, JointEnd, JointKind,
    LieGroup, PlanarDrive, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarWeight, PointMass, Poses,
    RigidMotion, Rotation, Schedule, TorsionSpring, Weight,
};

use crate::JointKind as SceneJointKind;
use crate::assemble::attraction::BodyAttraction;
use crate::assemble::error::AssemblyError;
use crate::assemble::led::Led;
#[cfg(feature = "elasticity")]
use crate::assemble::point_springs::PointSprings;
use crate::assemble::turn_springs::{PlanarTurnSpring, Several};
use crate::model::drives::{Motor, MotorDrive};
use crate::model::items::{RigidBody, Rod, SceneJoint};
use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::model::strength::Strength;

/// What a run asks of bodies in space and in the plane alike.
pub(crate) trait BodySystem {
    /// Where they start.
    fn initial(&self) -> &State<Vec<f64>>;

    /// Their kinetic and their potential energy.
    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2];

    /// Adds the differential of their potential energy.
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>);

    /// How a body moves, as a body in space.
    fn motion(&self, state: &State<Vec<f64>>, body: usize) -> BodyMotion;

    /// What they attract each other by, where they do.
    fn attraction(&self) -> Option<&BodyAttraction>;

    /// Appends its orientation, velocity and angular velocity, as a sample keeps them.
    fn append_field(&self, state: &State<Vec<f64>>, body: usize, field: &mut Vec<f64>);
}

/// Bodies in space.
pub(crate) struct InSpace {
    pub(crate) system: SpatialSystem,
    pub(crate) joints: SpatialJoints,
    pub(crate) initial: State<Vec<f64>>,
}

/// Joints, and the motors that have a speed.
pub(crate) type SpatialJoints = (Vec<Led<Joint<Poses>>>, Vec<Drive<Poses, Turned>>);
pub(crate) type PlanarJoints = (Vec<Led<PlanarJoint>>, Vec<PlanarDrive<Turned>>);

/// The turn that a motor makes: the integral of its speed.
#[derive(Clone, Debug)]
pub(crate) struct Turned(pub(crate) Strength);

impl Schedule for Turned {
    fn at<R: Number>(&self, t: R) -> R {
        self.0.integral_of(t)
    }
}

type Load = (Gravity<Weight<Poses>>, Free, Springs<TorsionSpring<Poses>>);
type PlanarLoad = (Gravity<PlanarWeight>, Free, Springs<PlanarTurnSpring>);
/// A uniform field, and attraction.
type Gravity<W> = (Option<W>, Option<BodyAttraction>);
#[cfg(not(feature = "elasticity"))]
type PointSprings = Free;
/// Springs between points, and at joints.
type Springs<T> = (PointSprings, Several<T>);
pub(crate) type SpatialSystem = System<BodyMetric<Poses>, Load, Poses>;
pub(crate) type PlanarSystem = System<DiagonalMetric<Vec<f64>>, PlanarLoad>;

/// Bodies in the plane.
pub(crate) struct InThePlane {
    pub(crate) system: PlanarSystem,
    pub(crate) joints: PlanarJoints,
    pub(crate) initial: State<Vec<f64>>,
}

impl BodySystem for InSpace {
    fn initial(&self) -> &State<Vec<f64>> {
        &self.initial
    }

    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2] {
        let kinetic = self.system.metric().kinetic_energy(state.p.view());
        [kinetic, self.system.potential().energy(&state.q)]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.system.potential().add_differential(q, dv);
    }

    fn motion(&self, state: &State<Vec<f64>>, body: usize) -> BodyMotion {
        let (of, p) = (self.system.metric().bodies()[body], &state.p.0[6 * body..][..6]);
        BodyMotion {
            pose: Poses::pose_at(&state.q, body),
            velocity: Vector3::from_column_slice(&p[..3]) / of.mass(),
            angular_velocity: of.angular_velocity(&Vector3::from_column_slice(&p[3..])),
        }
    }

    fn attraction(&self) -> Option<&BodyAttraction> {
        self.system.potential().0.1.as_ref()
    }

    fn append_field(&self, state: &State<Vec<f64>>, body: usize, field: &mut Vec<f64>) {
        let BodyMotion { pose, velocity, angular_velocity } = self.motion(state, body);
        field.extend(pose.rotation.quaternion());
        field.extend(velocity.iter().chain(&angular_velocity));
    }
}

impl BodySystem for InThePlane {
    fn initial(&self) -> &State<Vec<f64>> {
        &self.initial
    }

    fn energies(&self, state: &State<Vec<f64>>) -> [f64; 2] {
        let kinetic = self.system.metric().kinetic_energy(state.p.view());
        [kinetic, self.system.potential().energy(&state.q)]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.system.potential().add_differential(q, dv);
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

    fn attraction(&self) -> Option<&BodyAttraction> {
        self.system.potential().0.1.as_ref()
    }

    fn append_field(&self, state: &State<Vec<f64>>, body: usize, field: &mut Vec<f64>) {
        let BodyMotion { velocity, angular_velocity, .. } = self.motion(state, body);
        field.extend([state.q[3 * body + 2], velocity.x, velocity.y, angular_velocity.z]);
    }
}

/// The ends of a joint where it stands.
pub(crate) fn ends_in_space(bodies: &[RigidBody], joint: &SceneJoint) -> [JointEnd; 2] {
    let frame = RigidMotion { translation: joint.place.into(), rotation: Rotation::identity() };
    joint.between.map(|end| match end {
        None => JointEnd { body: None, frame },
        Some(index) => {
            let body = &bodies[index];
            let pose = RigidMotion { translation: body.position.into(), rotation: body.turned() };
            JointEnd::where_it_stands(index, &pose, &frame)
        }
    })
}

fn joint_in_space(bodies: &[RigidBody], joint: &SceneJoint) -> Result<Joint<Poses>, AssemblyError> {
    let ends = ends_in_space(bodies, joint);
    let kind = match joint.kind {
        SceneJointKind::Ball => JointKind::Ball,
        SceneJointKind::Hinge => JointKind::Hinge { axis: joint.axis.into() },
        SceneJointKind::Slider => JointKind::Slider { axis: joint.axis.into() },
        SceneJointKind::Fixed => JointKind::Weld,
    };
    Ok(Joint::new(Poses, bodies.len(), kind, ends)?)
}

pub(crate) fn ends_in_the_plane(bodies: &[RigidBody], joint: &SceneJoint) -> [PlanarEnd; 2] {
    let place = Vector3::from(joint.place).xy();
    joint.between.map(|end| match end {
        None => PlanarEnd::world(place),
        Some(index) => {
            let RigidBody { position: [x, y, _], rotation: [.., angle], .. } = bodies[index];
            PlanarEnd::where_it_stands(index, [x, y, angle], place)
        }
    })
}

fn joint_in_the_plane(
    bodies: &[RigidBody],
    joint: &SceneJoint,
) -> Result<PlanarJoint, AssemblyError> {
    let ends = ends_in_the_plane(bodies, joint);
    let kind = match joint.kind {
        SceneJointKind::Fixed => PlanarJointKind::Weld,
        SceneJointKind::Slider => PlanarJointKind::Slider { axis: Vector3::from(joint.axis).xy() },
        _ => PlanarJointKind::Pin,
    };
    Ok(PlanarJoint::new(bodies.len(), kind, ends)?)
}

impl Scene {
    /// No springs between points without the crate that has their law.
    #[cfg(not(feature = "elasticity"))]
    fn point_springs(&self, each: usize) -> Result<PointSprings, AssemblyError> {
        Ok(Free { freedoms: each * self.bodies.len() })
    }

    /// Where a rod ends: points of bodies, or places of the world.
    pub(crate) fn rod_ends(&self, rod: &Rod) -> [JointEnd; 2] {
        let rotation = Rotation::identity();
        rod.ends.map(|end| {
            let (body, place) = match self.particles[end].motion {
                Motion::Carried { body, point } => (Some(body), point),
                _ => (None, self.particles[end].position),
            };
            JointEnd { body, frame: RigidMotion { translation: place.into(), rotation } }
        })
    }

    /// A rod, led by its pin where that moves; `each` the stored numbers and the freedoms of a body.
    fn led<J>(&self, held: J, rod: &Rod, each: [usize; 2]) -> Led<J> {
        let pin = self.pin_of(rod);
        let body = rod.ends.iter().find_map(|&end| match self.particles[end].motion {
            Motion::Carried { body, .. } => Some(body),
            _ => None,
        });
        match pin.zip(body) {
            Some((pin, body)) => Led::by_pin(held, pin.clone(), body, each),
            None => Led::by_none(held),
        }
    }

    fn rod_in_space(&self, rod: &Rod) -> Result<Led<Joint<Poses>>, AssemblyError> {
        let kind = JointKind::Rod { length: rod.length };
        let held = Joint::new(Poses, self.bodies.len(), kind, self.rod_ends(rod))?;
        Ok(self.led(held, rod, [7, 6]))
    }

    fn rod_in_the_plane(&self, rod: &Rod) -> Result<Led<PlanarJoint>, AssemblyError> {
        let ends = rod.ends.map(|end| match self.particles[end].motion {
            Motion::Carried { body, point } => PlanarEnd::on(body, Vector3::from(point).xy()),
            _ => PlanarEnd::world(Vector3::from(self.particles[end].position).xy()),
        });
        let kind = PlanarJointKind::Rod { length: rod.length };
        Ok(self.led(PlanarJoint::new(self.bodies.len(), kind, ends)?, rod, [3, 3]))
    }

    /// Motors that have a speed.
    pub(crate) fn speeds(&self) -> impl Iterator<Item = &Motor> {
        self.drives.motors.iter().filter(|motor| motor.drive == MotorDrive::Speed)
    }

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
        let weight = self.steady_gravity().map(|gravity| Weight {
            gravity: gravity.into(),
            masses: self.bodies.iter().map(load).collect(),
            space: Poses,
        });
        let free = Free { freedoms: 6 * self.bodies.len() };
        let joints = self.joints.iter().map(|joint| joint_in_space(&self.bodies, joint));
        let joints = joints.map(|joint| joint.map(Led::by_none));
        let rods = self.rods.iter().map(|rod| self.rod_in_space(rod));
        let joints = joints.chain(rods);
        let drives = self.speeds().map(|motor| {
            let (joint, speed) = (&self.joints[motor.joint], Turned(motor.strength.clone()));
            let ends = ends_in_space(&self.bodies, joint);
            Drive::new(Poses, self.bodies.len(), Along::Turn, joint.axis.into(), ends, speed)
        });
        let turned = self.joints.iter().filter(|joint| joint.stiffness > 0.0).map(|joint| {
            let (ends, law) = (ends_in_space(&self.bodies, joint), [joint.stiffness, joint.rest]);
            TorsionSpring::new(
                Poses,
                self.bodies.len(),
                (Along::Turn, joint.axis.into()),
                ends,
                law,
            )
        });
        let springs = (self.point_springs(6)?, Several(turned.collect::<Result<_, _>>()?));
        Ok(InSpace {
            system: metric.under(((weight, self.body_attraction(6)), free, springs))?,
            joints: (joints.collect::<Result<_, _>>()?, drives.collect::<Result<_, _>>()?),
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
        let weight = self.steady_gravity().map(|[x, y, _]| PlanarWeight {
            gravity: Vector2::new(x, y),
            masses: self.bodies.iter().map(|body| body.mass).collect(),
        });
        let free = Free { freedoms: masses.len() };
        let joints = self.joints.iter().map(|joint| joint_in_the_plane(&self.bodies, joint));
        let joints = joints.map(|joint| joint.map(Led::by_none));
        let rods = self.rods.iter().map(|rod| self.rod_in_the_plane(rod));
        let joints = joints.chain(rods);
        let drives = self.speeds().map(|motor| {
            let (joint, speed) = (&self.joints[motor.joint], Turned(motor.strength.clone()));
            PlanarDrive::new(self.bodies.len(), ends_in_the_plane(&self.bodies, joint), speed)
        });
        let turned = self.joints.iter().filter(|joint| joint.stiffness > 0.0);
        let turned = turned.map(|joint| PlanarTurnSpring::new(&self.bodies, joint)).collect();
        let springs = (self.point_springs(3)?, Several(turned));
        let (metric, gravity) = (DiagonalMetric::new(masses)?, (weight, self.body_attraction(3)));
        Ok(InThePlane {
            system: System::new(metric, (gravity, free, springs))?,
            joints: (joints.collect::<Result<_, _>>()?, drives.collect::<Result<_, _>>()?),
            initial: State::new(q, Covector(p)),
        })
    }
}
