//! The kinetic-energy metric of bodies, constant in the axes of 9.4.
//!
//! ```text
//! M = diag(m, m, m, I1, I2, I3) a pose,   diag(I1, I2, I3) an orientation
//! p = M v = (m t., I w),     T = 1/2 <p, M^-1 p>
//! L = sum t x m t. + R I w                       about the origin, constant where no torque acts
//! ```
//! `t.` world axes, `w` body axes; see [`BodySpace`]. Source: notes 9.4.

use std::marker::PhantomData;

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, PotentialOn, Sink, SizeError, System, Vector};
use stationary_integrators::State;

use crate::error::check_finite;
use crate::{Body, BodySpace, RigidError, RigidMotion};

/// The metric of bodies on a space of poses or orientations.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMetric<S> {
    bodies: Vec<Body>,
    space: PhantomData<S>,
}

/// How a body moves at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Where it is. A body on a fixed point keeps its translation at zero.
    pub pose: RigidMotion,
    /// The velocity of its centre, m/s, world axes.
    pub velocity: Vector3<f64>,
    /// Its angular velocity, rad/s, body axes.
    pub angular_velocity: Vector3<f64>,
}

impl<S: BodySpace> BodyMetric<S> {
    /// The metric of these bodies.
    pub fn new(bodies: Vec<Body>) -> Self {
        BodyMetric { bodies, space: PhantomData }
    }

    /// The bodies.
    #[inline]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The system of these bodies under a potential that reads their poses or orientations.
    ///
    /// One that reads flat coordinates does not fit, even where it has as many freedoms:
    /// ```compile_fail
    /// use stationary_integrators::UniformGravity;
    /// use stationary_rigid::{Body, BodyMetric, Poses};
    /// let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap()]);
    /// let flat = UniformGravity { acceleration: [0.0, 0.0, -9.8], masses: vec![1.0; 2] };
    /// metric.under(flat);
    /// ```
    ///
    /// # Errors
    /// A potential of another number of freedoms.
    pub fn under<P: PotentialOn<S>>(self, potential: P) -> Result<System<Self, P, S>, SizeError> {
        System::on(S::SPACE, self, potential)
    }

    /// The state of bodies that move like this.
    ///
    /// # Errors
    /// Another number of motions, numbers that are not finite, a quaternion whose length is not 1.
    pub fn state(&self, motions: &[BodyMotion]) -> Result<State<Vec<f64>>, RigidError> {
        SizeError::check("the bodies' motions", self.bodies.len(), motions.len())?;
        let (mut q, mut p) = (Vec::new(), Vec::new());
        for (body, motion) in self.bodies.iter().zip(motions) {
            let linear = motion.velocity * body.mass();
            let angular = body.angular_momentum(&motion.angular_velocity);
            let translation = motion.pose.translation;
            q.extend_from_slice(&translation.as_slice()[..S::TRANSLATION]);
            q.extend_from_slice(&motion.pose.rotation.quaternion());
            p.extend_from_slice(&linear.as_slice()[..S::TRANSLATION]);
            p.extend_from_slice(angular.as_slice());
        }
        S::check(&q)?;
        check_finite("the momentum", &p)?;
        Ok(State::new(q, Covector(p)))
    }
}

/// How many bodies a state holds; an error unless it is made of whole ones.
pub(crate) fn check_bodies<S: BodySpace>(state: &State<Vec<f64>>) -> Result<usize, SizeError> {
    let bodies = state.q.len() / S::STORED;
    SizeError::check("the configuration's numbers", S::STORED * bodies, state.q.len())?;
    SizeError::check("the momentum's components", S::FREEDOMS * bodies, state.p.0.len())?;
    Ok(bodies)
}

/// The angular momentum of a body in body axes, from all bodies' momenta.
#[inline]
pub(crate) fn body_momentum<S: BodySpace>(p: &[f64], body: usize) -> Vector3<f64> {
    let m = &p[S::FREEDOMS * body + S::TRANSLATION..][..3];
    Vector3::new(m[0], m[1], m[2])
}

/// The angular momentum of all bodies about the origin, in world axes, kg m^2/s.
///
/// # Errors
/// A momentum that has not the configuration's bodies.
pub fn spatial_angular_momentum<S: BodySpace>(
    state: &State<Vec<f64>>,
) -> Result<Vector3<f64>, SizeError> {
    let p = state.p.components();
    let bodies = check_bodies::<S>(state)?;
    let one = |body| {
        let pose = S::pose_at(&state.q, body);
        let spin = pose.rotation.rotate(&body_momentum::<S>(p, body));
        match S::TRANSLATION {
            0 => spin,
            _ => spin + pose.translation.cross(&Vector3::from_column_slice(&p[6 * body..][..3])),
        }
    };
    Ok((0..bodies).map(one).sum())
}

impl<S: BodySpace> Metric for BodyMetric<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS * self.bodies.len()
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        self.multiply(v.0, p.0, |body| (body.mass(), body.moments()));
    }

    #[inline]
    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        self.multiply(p.0, v.0, |body| (body.inverse_mass(), body.inverse_moments()));
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        for (i, body) in self.bodies.iter().enumerate() {
            for c in 0..S::TRANSLATION {
                sink.add_symmetric(&[S::FREEDOMS * i + c], &[body.mass()]);
            }
            for (c, &moment) in body.moments().iter().enumerate() {
                sink.add_symmetric(&[S::FREEDOMS * i + S::TRANSLATION + c], &[moment]);
            }
        }
    }

    fn kinetic_energy(&self, p: Covector<&[f64]>) -> f64 {
        let one = |(body, p): (&Body, &[f64])| {
            let (linear, angular) = p.split_at(S::TRANSLATION);
            let linear = linear.iter().map(|p| p * p).sum::<f64>() * body.inverse_mass();
            let weights = body.inverse_moments();
            linear + angular.iter().zip(weights.iter()).map(|(m, w)| m * m * w).sum::<f64>()
        };
        0.5 * self.bodies.iter().zip(p.0.chunks_exact(S::FREEDOMS)).map(one).sum::<f64>()
    }
}

impl<S: BodySpace> BodyMetric<S> {
    #[inline]
    fn multiply(&self, x: &[f64], y: &mut [f64], weights: impl Fn(&Body) -> (f64, Vector3<f64>)) {
        let bodies = x.chunks_exact(S::FREEDOMS).zip(y.chunks_exact_mut(S::FREEDOMS));
        for (body, (x, y)) in self.bodies.iter().zip(bodies) {
            let (mass, moments) = weights(body);
            for c in 0..S::TRANSLATION {
                y[c] = mass * x[c];
            }
            for c in 0..3 {
                y[S::TRANSLATION + c] = moments[c] * x[S::TRANSLATION + c];
            }
        }
    }
}
