//! What a scene can have in it, as data: there whether or not the crate that moves it is compiled.
//!
//! Vectors have three components; those beyond the scene's dimension are zero. Particles, rods,
//! elastic bodies and heat stand beside what reads them, which needs no other crate.

use serde::Serialize;

use crate::model::body_shape::BodyShape;
use crate::model::contact_side::ContactSide;
#[cfg(feature = "contact")]
use stationary_contact::{ImpactLaw, When};
#[cfg(feature = "elasticity")]
use stationary_elasticity::Strain;

/// A spring between two of the scene's particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Link {
    /// The particles at its ends, by their place in [`Scene::particles`](crate::Scene::particles).
    pub ends: [usize; 2],
    /// Its length at rest.
    pub rest_length: f64,
    /// Its stiffness, force per length.
    pub stiffness: f64,
    /// Of a damper along it, the force over the rate of its length.
    pub damping: f64,
    /// Its measure of stretch.
    #[cfg(feature = "elasticity")]
    #[serde(serialize_with = "crate::model::serialized::strain")]
    pub strain: Strain,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RigidBody {
    /// Its name; its points are called `name.0`, `name.1` and so on.
    pub name: String,
    /// Its mass.
    pub mass: f64,
    /// Its shape.
    pub shape: BodyShape,
    /// Its principal moments; in the plane the third, and the others are zero.
    pub moments: [f64; 3],
    /// Where its centre starts.
    pub position: [f64; 3],
    /// How it is turned at the start: axis times angle.
    pub rotation: [f64; 3],
    /// The velocity of its centre at the start.
    pub velocity: [f64; 3],
    /// Its angular velocity at the start, in body axes.
    pub angular_velocity: [f64; 3],
    /// The points that are followed, in body axes.
    pub points: Vec<[f64; 3]>,
    /// Whether it is a particle beside bodies: it does not turn, whatever touches it.
    pub point_mass: bool,
}

impl RigidBody {
    /// Up to here it is a ball that attracts as a point does.
    #[cfg(any(feature = "elasticity", feature = "rigid"))]
    pub(crate) fn attracting_radius(&self) -> f64 {
        match self.shape {
            // A particle is a point whose radius is for touching.
            BodyShape::Ball(radius) if !self.point_mass => radius,
            _ => 0.0,
        }
    }
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum JointKind {
    /// Every turn; in the plane the only one there is. Called `ball` in space, `pin` in the plane.
    Ball,
    /// Turns about an axis, in space.
    Hinge,
    /// A shift along an axis.
    Slider,
    /// Nothing. Called `fixed` in space, `weld` in the plane.
    Fixed,
}

/// A joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SceneJoint {
    /// What it leaves free.
    pub kind: JointKind,
    /// The bodies that it joins, by their place in [`Scene::bodies`](crate::Scene::bodies); `None`
    /// is the world.
    pub between: [Option<usize>; 2],
    /// Where it is at the start.
    pub place: [f64; 3],
    /// The axis of a hinge or a slider at the start, of length one; else the third axis.
    pub axis: [f64; 3],
    /// Of a spring that resists a turn, the torque over the turn; none where it is zero.
    pub stiffness: f64,
    /// The turn from the start at which that spring is at rest.
    pub rest: f64,
    /// Of a damper that resists a turn, the torque over its rate.
    pub damping: f64,
    /// The least and the largest turn, or shift of a slider, from the start.
    pub limits: Option<[f64; 2]>,
    /// The largest torque, of a slider the largest force, of dry friction.
    pub friction: f64,
}

/// How the things of a scene touch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneContact {
    /// Separating over approaching speed, 0 to 1.
    pub restitution: f64,
    /// Coulomb's coefficient, between bodies.
    pub friction: f64,
    /// What happens where several contacts meet.
    #[cfg(feature = "contact")]
    #[serde(serialize_with = "crate::model::serialized::law")]
    pub law: ImpactLaw,
    /// At which moment particles are given impulses.
    #[cfg(feature = "contact")]
    #[serde(serialize_with = "crate::model::serialized::when")]
    pub when: When,
    /// The stiffness of springs that push particles apart, instead of impulses.
    pub stiffness: Option<f64>,
    /// Half-spaces that nothing enters: what is on the side of the normal is free.
    pub walls: Vec<SceneWall>,
    /// Balls that nothing enters and nothing moves.
    pub balls: Vec<SceneBall>,
    /// Pairs that touch in a way of their own.
    pub pairs: Vec<ScenePair>,
    /// Pairs of which the first was placed so that it touches the second at the start.
    pub touching: Vec<[ContactSide; 2]>,
}

impl SceneContact {
    /// Whether an impact gives back all that it took, and nothing rubs.
    pub fn is_elastic(&self) -> bool {
        let elastic = |restitution: f64, friction: f64| restitution == 1.0 && friction == 0.0;
        let pair = |pair: &ScenePair| {
            let rubs = pair.friction.max(pair.rolling).max(pair.torsion);
            !pair.meets || elastic(pair.restitution, rubs)
        };
        elastic(self.restitution, self.friction) && self.pairs.iter().all(pair)
    }
}

/// How two bodies, or a body and what is fixed, touch, where it is not as all others do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScenePair {
    /// The two.
    pub of: [ContactSide; 2],
    /// Separating over approaching speed, 0 to 1.
    pub restitution: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Length of rolling friction.
    pub rolling: f64,
    /// Length of torsional friction.
    pub torsion: f64,
    /// Whether they touch at all, or pass through each other.
    pub meets: bool,
}

/// A half-space that nothing enters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneWall {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// Points to the side that is free, of length one.
    pub normal: [f64; 3],
    /// How far the wall is from the origin along it.
    pub offset: f64,
}

/// A ball that nothing enters and nothing moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneBall {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// Where it is.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

/// A rod between two of the scene's particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rod {
    /// The particles at its ends, by their place in [`Scene::particles`](crate::Scene::particles).
    pub ends: [usize; 2],
    /// Its length, the distance of its ends at the start.
    pub length: f64,
    /// The tension or thrust beyond which it breaks; infinite where it does not.
    pub strength: f64,
}

/// The components of a stress: xx, yy, zz, xy, yz, xz; those beyond the dimension are zero.
pub(crate) type Stress = [f64; 6];
