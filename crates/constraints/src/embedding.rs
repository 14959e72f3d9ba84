//! Reduced coordinates: places as a function of fewer freedoms, so that nothing is left to
//! constrain.
//!
//! ```text
//! q = q(s)                         N places from S freedoms                                (6.1)
//! M_s = Dq^T M Dq                  the pulled-back metric, S x S
//! V_s(s) = V(q(s))                 the pulled-back potential
//! p_s = Dq^T p                     the pulled-back momentum
//! L_d(s0, s1) = 1/2 |q(s1) - q(s0)|_M^2 / h^2 - V      the chord's kinetic energy
//! ```
//! `s` reduced coordinates (S), `q` places (N), `M = diag(m)` their masses, `V` their [`Energy`] in
//! joules. Kinetic energy belongs to the moving masses, not to the rates of s: here it is that of
//! the straight way from one place to the next, as in the notes. The integrator is
//! [`Variational`](stationary_integrators::Variational): the constraint holds exactly, and the
//! coordinates must be regular. Where Dq has not full rank (a pole of a sphere, or where q folds)
//! M_s is singular, and so is the step.
//!
//! With V at the later end the step is of order 1, and for one rod it is the explicit arcsine form;
//! with the mean of both ends it is symmetric and of order 2, and visits the configurations of
//! [`Rattle`](crate::Rattle): both make the same sum stationary on the same surface.
//! Source: notes 6.1; errata 6.1.

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector, SMatrix};
use stationary_calculus::{
    Covector, DenseMetric, DiagonalMetric, Energy, MetricError, Number, Vector, array,
    directional_derivative, first_non_finite, least_norm,
};
use stationary_integrators::{DiscreteLagrangian, Facts, Stability, VARIATIONAL};

use crate::ConstraintError;
use crate::multipliers::DEPENDENT;

/// N places as functions of S reduced coordinates, written once over any [`Number`].
pub trait Embedding<const S: usize, const N: usize> {
    /// The places.
    fn places<R: Number>(&self, s: [R; S]) -> [R; N];
}

/// Where in a step the potential of a chord is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// At the later end: the notes' choice, order 1.
    Later,
    /// At both ends, and the mean is taken: order 2.
    Both,
}

/// A system in reduced coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced<Q, E, const S: usize, const N: usize> {
    embedding: Q,
    masses: [f64; N],
    energy: E,
    sampling: Sampling,
}

impl<Q: Embedding<S, N>, E: Energy<N>, const S: usize, const N: usize> Reduced<Q, E, S, N> {
    /// An embedding, a mass (kg) for each of its numbers, and an energy of the places.
    ///
    /// # Errors
    /// Where a mass is not positive and finite.
    pub fn new(
        embedding: Q,
        masses: [f64; N],
        energy: E,
        sampling: Sampling,
    ) -> Result<Self, MetricError> {
        DiagonalMetric::new(masses)?;
        Ok(Reduced { embedding, masses, energy, sampling })
    }

    /// The places at reduced coordinates.
    pub fn places(&self, s: [f64; S]) -> [f64; N] {
        self.embedding.places(s)
    }

    /// The embedding's differential Dq, N x S.
    pub fn differential(&self, s: [f64; S]) -> SMatrix<f64, N, S> {
        let columns: [[f64; N]; S] = array(|i| {
            let mut along = [0.0; S];
            along[i] = 1.0;
            directional_derivative(|s| self.embedding.places(s), s, Vector(along))
        });
        SMatrix::from_fn(|i, j| columns[j][i])
    }

    /// The velocity of the places at a rate of the reduced coordinates.
    pub fn velocity(&self, s: [f64; S], rate: Vector<[f64; S]>) -> Vector<[f64; N]> {
        Vector(directional_derivative(|s| self.embedding.places(s), s, rate))
    }

    /// The momentum of the reduced coordinates at a rate of theirs, `Dq^T M Dq s.`.
    pub fn momentum(&self, s: [f64; S], rate: Vector<[f64; S]>) -> Covector<[f64; S]> {
        let v = self.velocity(s, rate);
        let p = SMatrix::<f64, N, 1>::from_fn(|i, _| self.masses[i] * v.0[i]);
        let pulled = self.differential(s).transpose() * p;
        Covector(array(|i| pulled[i]))
    }

    /// The pulled-back metric Dq^T M Dq at reduced coordinates. Takes memory.
    ///
    /// # Errors
    /// [`ConstraintError::SingularCoordinates`] where the differential has not full rank, and
    /// [`ConstraintError::NonFinite`] where it is not finite, with the place.
    pub fn metric(&self, s: [f64; S]) -> Result<DenseMetric, ConstraintError> {
        let d = self.differential(s);
        let rooted = DMatrix::from_fn(N, S, |i, j| self.masses[i].sqrt() * d[(i, j)]);
        let what = "embedding's differential";
        let index = first_non_finite(rooted.as_slice()).map_or(0, |entry| entry % N.max(1));
        let spectrum = least_norm(&rooted, &DVector::zeros(N), 0.0)
            .map_err(|_| ConstraintError::NonFinite { what, index })?
            .singular_values;
        let ratio = if S > N { 0.0 } else { spectrum.min() / spectrum.max() };
        let singular = ConstraintError::SingularCoordinates { ratio };
        // Not `<`: what is not a number is singular.
        if !matches!(ratio.partial_cmp(&DEPENDENT), Some(Ordering::Greater)) {
            return Err(singular);
        }
        DenseMetric::new(rooted.transpose() * &rooted).map_err(|_| singular)
    }

    /// The energy at a rate of the reduced coordinates, joules.
    pub fn total_energy(&self, s: [f64; S], rate: Vector<[f64; S]>) -> f64 {
        let v = self.velocity(s, rate);
        let twice: f64 = v.0.iter().zip(&self.masses).map(|(v, m)| m * v * v).sum();
        0.5 * twice + self.energy(s)
    }
}

/// The pulled-back potential.
impl<Q: Embedding<S, N>, E: Energy<N>, const S: usize, const N: usize> Energy<S>
    for Reduced<Q, E, S, N>
{
    fn energy<R: Number>(&self, s: [R; S]) -> R {
        self.energy.energy(self.embedding.places(s))
    }
}

impl<Q: Embedding<S, N>, E: Energy<N>, const S: usize, const N: usize> DiscreteLagrangian<S>
    for Reduced<Q, E, S, N>
{
    fn value<R: Number>(&self, s0: [R; S], s1: [R; S], h: f64) -> R {
        let (q0, q1) = (self.embedding.places(s0), self.embedding.places(s1));
        let twice = (0..N).fold(R::from(0.0), |sum, i| {
            let v = (q1[i] - q0[i]) / h;
            sum + v * v * self.masses[i]
        });
        let later = self.energy.energy(q1);
        let potential = match self.sampling {
            Sampling::Later => later,
            Sampling::Both => (self.energy.energy(q0) + later) * 0.5,
        };
        twice * 0.5 - potential
    }

    fn facts(&self) -> Facts {
        let facts = Facts { stability: Stability::Below(2.0), ..VARIATIONAL };
        match self.sampling {
            Sampling::Later => Facts { name: "reduced-later", ..facts },
            Sampling::Both => Facts { name: "reduced-both", order: 2, symmetric: true, ..facts },
        }
    }
}

/// A chain of links from a hook at the origin, each with its angle from hanging, radians,
/// counterclockwise: a pendulum for one link, a double pendulum for two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links<const S: usize> {
    lengths: [f64; S],
}

impl<const S: usize> Links<S> {
    /// Links of these lengths, metres.
    pub fn new(lengths: [f64; S]) -> Self {
        Links { lengths }
    }
}

/// N must be 2 S: two coordinates a link.
impl<const S: usize, const N: usize> Embedding<S, N> for Links<S> {
    fn places<R: Number>(&self, s: [R; S]) -> [R; N] {
        const { assert!(N == 2 * S, "two coordinates a link") }
        let mut end = [R::from(0.0); 2];
        let mut places = [R::from(0.0); N];
        for ((angle, length), place) in
            s.iter().zip(self.lengths).zip(places.as_chunks_mut::<2>().0)
        {
            end[0] += angle.sin() * length;
            end[1] -= angle.cos() * length;
            *place = end;
        }
        places
    }
}

/// Weights in the plane: `V = g sum_i m_i y_i`, with a mass for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct Weight<const POINTS: usize> {
    /// Masses, kg.
    pub masses: [f64; POINTS],
    /// Gravity, m/s^2, downward where positive.
    pub gravity: f64,
}

/// N must be twice the points.
impl<const POINTS: usize, const N: usize> Energy<N> for Weight<POINTS> {
    fn energy<R: Number>(&self, q: [R; N]) -> R {
        const { assert!(N == 2 * POINTS, "two coordinates a point") }
        let points = q.as_chunks::<2>().0.iter().zip(self.masses);
        points.fold(R::from(0.0), |sum, (x, m)| sum + x[1] * (m * self.gravity))
    }
}
