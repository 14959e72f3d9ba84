//! What acts on a scene in time and no potential gives: loads, motors, pins that move, gravity that
//! changes, sources of heat. As data.

use serde::Serialize;
use stationary_calculus::array;

use crate::model::strength::Strength;

/// Everything in a scene that is driven.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Drives {
    /// Forces and torques.
    pub loads: Vec<SceneLoad>,
    /// Torques and speeds at joints.
    pub motors: Vec<Motor>,
    /// Pins that move.
    pub motions: Vec<PinMotion>,
    /// How the uniform gravity changes; none where it does not.
    pub gravity: Option<Strength>,
    /// Where heat flows in.
    pub sources: Vec<HeatSource>,
}

/// A force at a particle or a point of a body, and on a body a torque.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneLoad {
    /// The particle, by its place in [`Scene::particles`](crate::Scene::particles).
    pub on: usize,
    /// The force where the strength is 1, world axes.
    pub force: [f64; 3],
    /// The torque there, world axes.
    pub torque: [f64; 3],
    /// Its strength in time.
    pub strength: Strength,
}

/// What turns a pin or a hinge: the second body against the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motor {
    /// Its joint, by its place in [`Scene::joints`](crate::Scene::joints).
    pub joint: usize,
    /// What is given.
    pub drive: MotorDrive,
    /// Of the torque or the speed, in time.
    pub strength: Strength,
}

/// What a motor gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum MotorDrive {
    /// A torque.
    Torque,
    /// A speed, radians a unit of time, whatever it takes.
    Speed,
}

/// A pinned particle that moves all the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinMotion {
    /// The particle, by its place in [`Scene::particles`](crate::Scene::particles).
    pub particle: usize,
    /// How far it is from its place where the strength is 1.
    pub shift: [f64; 3],
    /// Its strength in time.
    pub strength: Strength,
}

/// Where heat flows in.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeatSource {
    /// How fast each vertex is warmed where the strength is 1, temperature over time.
    pub rates: Vec<f64>,
    /// Its strength in time.
    pub strength: Strength,
}

impl PinMotion {
    /// Where the pin is.
    pub(crate) fn place(&self, start: [f64; 3], t: f64) -> [f64; 3] {
        let strength = self.strength.at(t);
        array(|c| start[c] + strength * self.shift[c])
    }

    /// How far it is from where it starts, how fast it moves and how it accelerates.
    #[cfg(feature = "rigid")]
    pub(crate) fn path(&self, t: f64) -> [nalgebra::Vector3<f64>; 3] {
        [self.strength.at(t), self.strength.rate(t), self.strength.curvature(t)]
            .map(|strength| nalgebra::Vector3::from(self.shift) * strength)
    }

    /// How fast it moves.
    pub(crate) fn velocity(&self, t: f64) -> [f64; 3] {
        let rate = self.strength.rate(t);
        self.shift.map(|x| rate * x)
    }
}

impl Drives {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        *self == Drives::default()
    }

    /// Whether a motor has a speed.
    pub(crate) fn has_speeds(&self) -> bool {
        self.motors.iter().any(|motor| motor.drive == MotorDrive::Speed)
    }

    /// How a pin moves, where it does.
    pub(crate) fn motion_of(&self, particle: usize) -> Option<&PinMotion> {
        self.motions.iter().find(|motion| motion.particle == particle)
    }

    /// Whether a pin moves.
    pub(crate) fn moves(&self, particle: usize) -> bool {
        self.motion_of(particle).is_some()
    }
}
