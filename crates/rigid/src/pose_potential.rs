//! Potentials of poses by automatic differentiation: an energy written once, its derivatives exact.
//!
//! ```text
//! x -> x + v,    R -> R (1 + [w] + [w]^2 / 2)         exp to second order, v w infinitesimal
//! dV(v, w),  d2V                                      along exponentials, as everywhere in the crate
//! ```
//! An energy is written over any [`Number`] as a function of the poses of B bodies: places of their
//! points, directions, turns about axes. A differential costs an evaluation for each freedom, a Hessian
//! one for each pair: right for a few bodies and as the oracle of what is written by hand.
//!
//! ```
//! use stationary_calculus::{Number, assert_derivatives_on};
//! use stationary_rigid::{PoseEnergy, PosePotential, Poses, PoseOf};
//!
//! /// Wilberforce's pendulum: a spring whose stretch and twist, in N/m and N m, are coupled.
//! struct Coil {
//!     stiffness: f64,
//!     torsion: f64,
//!     coupling: f64,
//! }
//! impl PoseEnergy<1> for Coil {
//!     fn energy<R: Number>(&self, [bob]: [PoseOf<R>; 1]) -> R {
//!         let (z, turn) = (bob.position[2], bob.turn_about([0.0, 0.0, 1.0]));
//!         (z * z * self.stiffness + turn * turn * self.torsion + z * turn * self.coupling) * 0.5
//!     }
//! }
//! let coil = Coil { stiffness: 2.8, torsion: 7.9e-4, coupling: 9.3e-3 };
//! let potential = PosePotential::new(Poses, 1, [0], coil)?;
//! assert_derivatives_on(&Poses, &potential, &[0.1, 0.2, 0.3, 0.8, 0.0, 0.36, 0.48]);
//! # Ok::<(), stationary_rigid::RigidError>(())
//! ```
//! Source: notes 2.4, 9.3.

use std::marker::PhantomData;

use stationary_calculus::{
    Covector, Number, Potential, PotentialOn, Sink, Vector, array, atan2, directional_derivative,
    second_differential,
};

use crate::joint::body_freedoms;
use crate::space::pose_or_none;
use crate::{BodySpace, LieGroup, RigidError};

/// The pose of a body in numbers of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseOf<R> {
    /// The centre in world axes, metres.
    pub position: [R; 3],
    /// The rotation's matrix by rows, from body axes into the world's.
    pub rotation: [[R; 3]; 3],
}

fn dot<R: Number>(a: [R; 3], b: [f64; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<R: Number> PoseOf<R> {
    /// Where a direction of the body points, world axes.
    pub fn direction(&self, a: [f64; 3]) -> [R; 3] {
        self.rotation.map(|row| dot(row, a))
    }

    /// Where a point of the body (m, body axes) is in the world.
    pub fn point(&self, c: [f64; 3]) -> [R; 3] {
        let arm = self.direction(c);
        [0, 1, 2].map(|k| self.position[k] + arm[k])
    }

    /// The turn about an axis of length 1, radians, within half a turn of zero: what is left of the
    /// rotation where the tilt of that axis is undone the short way.
    pub fn turn_about(&self, n: [f64; 3]) -> R {
        let r = &self.rotation;
        let vee = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
        let along = self.direction(n);
        let cosine = r[0][0] + r[1][1] + r[2][2] - dot(along, n);
        atan2(dot(vee, n), cosine)
    }
}

/// An energy of the poses of B bodies, written once over any [`Number`].
pub trait PoseEnergy<const B: usize> {
    /// The energy, joules.
    fn energy<R: Number>(&self, bodies: [PoseOf<R>; B]) -> R;
}

/// The potential of a [`PoseEnergy`] of B bodies among others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePotential<S, E, const B: usize> {
    bodies: usize,
    which: [usize; B],
    energy: E,
    space: PhantomData<S>,
}

/// Freedoms of a pose.
const SIX: usize = 6;

impl<S: BodySpace, E: PoseEnergy<B>, const B: usize> PosePotential<S, E, B> {
    /// The potential of an energy of these bodies, among `bodies`. Of bodies about fixed points the
    /// position is zero.
    ///
    /// # Errors
    /// A body that is not there.
    pub fn new(_space: S, bodies: usize, which: [usize; B], energy: E) -> Result<Self, RigidError> {
        match which.iter().find(|&&body| body >= bodies) {
            Some(&body) => Err(RigidError::NoSuchBody { body, bodies }),
            None => Ok(PosePotential { bodies, which, energy, space: PhantomData }),
        }
    }

    fn poses(&self, q: &[f64]) -> [PoseOf<f64>; B] {
        self.which.map(|body| {
            let pose = pose_or_none::<S>(q, body);
            let matrix = pose.rotation.matrix();
            let rotation = [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)]));
            PoseOf { position: pose.translation.into(), rotation }
        })
    }

    /// The energy where freedoms are moved by infinitesimal numbers.
    fn moved<R: Number>(&self, poses: &[PoseOf<f64>; B], moves: &[(usize, R)]) -> R {
        let bodies = array(|body| {
            let mut by = [R::from(0.0); SIX];
            for &(freedom, move_by) in moves {
                if freedom / SIX == body {
                    by[freedom % SIX] += move_by;
                }
            }
            advanced(&poses[body], by)
        });
        self.energy.energy(bodies)
    }

    /// The freedoms that move: of six for each body those of the space.
    fn freedoms() -> impl Iterator<Item = usize> + Clone {
        (0..SIX * B).filter(|k| k % SIX >= 3 - S::TRANSLATION)
    }
}

/// A pose moved along an infinitesimal velocity, to second order.
fn advanced<R: Number>(pose: &PoseOf<f64>, [x, y, z, a, b, c]: [R; SIX]) -> PoseOf<R> {
    let zero = R::from(0.0);
    let hat = [[zero, -c, b], [c, zero, -a], [-b, a, zero]];
    let square = |i: usize, j: usize| {
        (0..3).fold(zero, |sum, k| sum + hat[i][k] * hat[k][j]) * 0.5 + hat[i][j]
    };
    let rotation = pose.rotation.map(|row| {
        [0, 1, 2].map(|j| (0..3).fold(R::from(row[j]), |sum, k| sum + square(k, j) * row[k]))
    });
    let by = [x, y, z];
    PoseOf { position: [0, 1, 2].map(|k| by[k] + pose.position[k]), rotation }
}

impl<S: BodySpace, E: PoseEnergy<B>, const B: usize> PotentialOn<S> for PosePotential<S, E, B> {}

impl<S: BodySpace, E: PoseEnergy<B>, const B: usize> Potential for PosePotential<S, E, B> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.energy.energy(self.poses(q))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let poses = self.poses(q);
        for k in Self::freedoms() {
            let freedom = body_freedoms::<S>(self.which[k / SIX])[k % SIX];
            let along = |[s]: [_; 1]| self.moved(&poses, &[(k, s)]);
            if let Some(slot) = dv.0.get_mut(freedom) {
                *slot += directional_derivative(along, [0.0], Vector([1.0]));
            }
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let poses = self.poses(q);
        let mut block = [[[[0.0; SIX]; B]; SIX]; B];
        for i in Self::freedoms() {
            for j in Self::freedoms().take_while(|&j| j <= i) {
                let along = |[s, t]: [_; 2]| self.moved(&poses, &[(i, s), (j, t)]);
                let (first, second) = (Vector([1.0, 0.0]), Vector([0.0, 1.0]));
                let entry = second_differential(along, [0.0; 2], first, second);
                block[i / SIX][i % SIX][j / SIX][j % SIX] = entry;
                block[j / SIX][j % SIX][i / SIX][i % SIX] = entry;
            }
        }
        let freedoms = self.which.map(body_freedoms::<S>);
        let entries = block.as_flattened().as_flattened().as_flattened();
        hessian.add_symmetric(freedoms.as_flattened(), entries);
    }
}
