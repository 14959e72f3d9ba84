//! From where, and in which units, a scene is written down.

use nalgebra::{UnitQuaternion, Vector3};

/// Length, time and mass: the powers in which a number has them.
pub(super) type Powers = [i32; 3];

pub(super) const NUMBER: Powers = [0, 0, 0];
pub(super) const LENGTH: Powers = [1, 0, 0];
pub(super) const TIME: Powers = [0, 1, 0];
pub(super) const MASS: Powers = [0, 0, 1];
pub(super) const VELOCITY: Powers = [1, -1, 0];
pub(super) const TURNING: Powers = [0, -1, 0];
pub(super) const ACCELERATION: Powers = [1, -2, 0];
pub(super) const FORCE: Powers = [1, -2, 1];
pub(super) const STIFFNESS: Powers = [0, -2, 1];
pub(super) const DAMPING: Powers = [0, -1, 1];
pub(super) const ENERGY: Powers = [2, -2, 1];

/// Turned about the origin, then shifted, then in other units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) dimension: usize,
    /// In the plane about the third axis.
    pub(super) turn: UnitQuaternion<f64>,
    pub(super) shift: Vector3<f64>,
    /// How large the old units of length, time and mass are in the new ones: powers of 2.
    pub(super) units: [f64; 3],
}

impl Seen {
    /// As it is.
    pub(super) fn plainly(dimension: usize) -> Self {
        let (turn, shift) = (UnitQuaternion::identity(), Vector3::zeros());
        Seen { dimension, turn, shift, units: [1.0; 3] }
    }

    pub(super) fn unit(&self, powers: Powers) -> f64 {
        self.units.iter().zip(powers).map(|(unit, power)| unit.powi(power)).product()
    }

    pub(super) fn number(&self, x: f64, powers: Powers) -> String {
        format!("{:?}", x * self.unit(powers))
    }

    /// Numbers of a body's own axes.
    pub(super) fn own(&self, x: &[f64], powers: Powers) -> String {
        let written: Vec<_> = x.iter().map(|&x| self.number(x, powers)).collect();
        format!("[{}]", written.join(", "))
    }

    pub(super) fn vector(&self, x: Vector3<f64>, powers: Powers) -> String {
        self.own(&(self.turn * x).as_slice()[..self.dimension], powers)
    }

    pub(super) fn place(&self, x: Vector3<f64>) -> String {
        self.own(&self.moved(x).as_slice()[..self.dimension], LENGTH)
    }

    /// Where a place of the old frame is in the new one, in old units.
    pub(super) fn moved(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.turn * x + self.shift
    }

    /// A turn of a body, axis times angle.
    pub(super) fn rotation(&self, turn: Vector3<f64>) -> String {
        let turned = (self.turn * UnitQuaternion::from_scaled_axis(turn)).scaled_axis();
        match self.dimension {
            2 => self.number(turned.z, NUMBER),
            _ => self.own(turned.as_slice(), NUMBER),
        }
    }
}
