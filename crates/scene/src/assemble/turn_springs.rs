//! Springs at joints in the plane, and several potentials of one kind.
//!
//! ```text
//! V = k/2 (theta_2 - theta_1 - (theta_2 - theta_1 at the start) - rest)^2
//! ```
//! `theta` the angles of the two bodies, zero of the world; whole turns count.

use stationary_calculus::{Covector, Potential, PotentialOn, Sink};
use stationary_rigid::{Poses, TorsionSpring};

use crate::model::items::{RigidBody, SceneJoint};

/// A spring that resists the turn of a pin.
#[derive(Clone, Debug)]
pub(crate) struct PlanarTurnSpring {
    bodies: [Option<usize>; 2],
    stiffness: f64,
    /// The difference of the angles at which it is at rest.
    rest: f64,
}

impl PlanarTurnSpring {
    pub(crate) fn new(bodies: &[RigidBody], joint: &SceneJoint) -> Self {
        let [a, b] = joint.between.map(|end| end.map_or(0.0, |body| bodies[body].rotation[2]));
        let (bodies, stiffness) = (joint.between, joint.stiffness);
        PlanarTurnSpring { bodies, stiffness, rest: b - a + joint.rest }
    }

    fn turned(&self, q: &[f64]) -> f64 {
        let [a, b] = self.bodies.map(|end| end.map_or(0.0, |body| q[3 * body + 2]));
        b - a - self.rest
    }
}

impl Potential for PlanarTurnSpring {
    fn dim(&self) -> usize {
        self.bodies.into_iter().flatten().max().map_or(0, |body| 3 * body + 3)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * self.stiffness * self.turned(q).powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let torque = self.stiffness * self.turned(q);
        for (end, sign) in self.bodies.into_iter().zip([-1.0, 1.0]) {
            if let Some(body) = end {
                dv.0[3 * body + 2] += sign * torque;
            }
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        let angles: Vec<usize> =
            self.bodies.into_iter().flatten().map(|body| 3 * body + 2).collect();
        let k = self.stiffness;
        let block = [k, -k, -k, k];
        hessian.add_symmetric(&angles, if angles.len() == 2 { &block } else { &block[..1] });
    }
}

/// Several potentials of one kind: their sum.
#[derive(Clone, Debug)]
pub(crate) struct Several<P>(pub(crate) Vec<P>);

impl PotentialOn<Poses> for Several<TorsionSpring<Poses>> {}

impl<P: Potential> Potential for Several<P> {
    fn dim(&self) -> usize {
        self.0.iter().map(Potential::dim).max().unwrap_or(0)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.0.iter().map(|one| one.energy(q)).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let mut dv = dv;
        self.0.iter().for_each(|one| one.add_differential(q, dv.view_mut()));
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.0.iter().for_each(|one| one.add_hessian(q, hessian));
    }
}

#[cfg(test)]
mod tests {
    use stationary_calculus::{Flat, assert_derivatives_on};

    use super::*;

    #[test]
    fn the_differential_and_the_hessian_are_those_of_the_energy() {
        let one = |bodies| PlanarTurnSpring { bodies, stiffness: 3.0, rest: 0.4 };
        let springs = Several(vec![one([None, Some(1)]), one([Some(1), Some(0)])]);
        assert_derivatives_on(&Flat, &springs, &[0.1, 0.2, 0.7, 1.3, -0.4, -2.1]);
    }
}
