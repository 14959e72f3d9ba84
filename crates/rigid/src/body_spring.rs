//! A spring between points of two bodies, or of a body and the world.
//!
//! ```text
//! V = k/2 (|d| - L)^2,   d = x_i - x_j,   x = t + R c,   u = d/|d|
//! dV = f dd,   f = k (d - L u);      dx(v, a) = v + R (a x c)                    (10.1.2)
//! d2V(., .) = k <dd, ((1 - L/|d|) 1 + L/|d| u u^T) dd>
//!             + sum of -+ [ (a.G)(b.c) + (a.c)(b.G) ]/2 - (G.c)(a.b),   G = R^T f
//! ```
//! `k` N/m, `L` the rest length (m), zero unless given. A spring with a rest length has no direction where its ends
//! meet, and its force is not a number there; `c` the point in body axes; `v` in world axes, `a b` turns in body axes. Between bodies
//! it keeps linear and angular momentum; tied to the world's origin it keeps the angular one.
//! Source: notes 3.1, 10.1.

use nalgebra::{Matrix3, SMatrix, Vector3};
use stationary_calculus::{Covector, FIXED, Potential, PotentialOn, Sink};

use crate::error::{check_finite, check_not_negative};
use crate::joint::{body_freedoms, curvature};
use crate::point_force::{add_wrench, force_at_point};
use crate::space::pose_or_none;
use crate::{BodySpace, LieGroup, RigidError};

/// An end of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attachment {
    /// A point of the world, metres.
    World(Vector3<f64>),
    /// A point of a body, metres, body axes.
    Body(usize, Vector3<f64>),
}

impl Attachment {
    pub(crate) fn vector(&self) -> Vector3<f64> {
        match *self {
            Attachment::World(v) | Attachment::Body(_, v) => v,
        }
    }

    /// An error where its body is not among `bodies`.
    pub(crate) fn check_body(&self, bodies: usize) -> Result<(), RigidError> {
        match *self {
            Attachment::Body(body, _) if body >= bodies => {
                Err(RigidError::NoSuchBody { body, bodies })
            }
            _ => Ok(()),
        }
    }
}

/// A spring between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySpring<S> {
    bodies: usize,
    stiffness: f64,
    rest: f64,
    ends: [Attachment; 2],
    space: S,
}

/// How an end moves with its body's six freedoms, and what its acceleration adds to a Hessian.
struct End {
    freedoms: [usize; 6],
    jacobian: SMatrix<f64, 3, 6>,
    curvature: Matrix3<f64>,
}

impl<S: BodySpace> BodySpring<S> {
    /// A spring of this stiffness (N/m) between two points, among `bodies` bodies that are free or turn
    /// about fixed points.
    ///
    /// # Errors
    /// A stiffness or a point that is not finite, and a body that is not there.
    pub fn new(
        space: S,
        bodies: usize,
        stiffness: f64,
        ends: [Attachment; 2],
    ) -> Result<Self, RigidError> {
        check_finite("the spring's stiffness", &[stiffness])?;
        for end in &ends {
            check_finite("the spring's point", end.vector().as_slice())?;
            end.check_body(bodies)?;
        }
        Ok(BodySpring { bodies, stiffness, rest: 0.0, ends, space })
    }

    /// The same with a rest length, metres.
    ///
    /// # Errors
    /// A length that is negative or not finite.
    pub fn with_rest_length(self, rest: f64) -> Result<Self, RigidError> {
        check_not_negative("the spring's rest length", rest)?;
        Ok(BodySpring { rest, ..self })
    }

    /// The force on the first end with its sign turned, and the share `L/|d|`.
    fn pull(&self, stretch: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let share = if self.rest == 0.0 { 0.0 } else { self.rest / stretch.norm() };
        (stretch * (self.stiffness * (1.0 - share)), share)
    }

    fn place(q: &[f64], end: &Attachment) -> Vector3<f64> {
        match *end {
            Attachment::World(x) => x,
            Attachment::Body(body, c) => pose_or_none::<S>(q, body).apply(&c),
        }
    }

    fn stretch(&self, q: &[f64]) -> Vector3<f64> {
        Self::place(q, &self.ends[0]) - Self::place(q, &self.ends[1])
    }

    /// An end that is pulled with the force `pull`, world axes.
    fn end(q: &[f64], end: &Attachment, pull: &Vector3<f64>) -> End {
        let mut jacobian = SMatrix::zeros();
        let Attachment::Body(body, c) = *end else {
            return End { freedoms: [FIXED; 6], jacobian, curvature: Matrix3::zeros() };
        };
        let rotation = pose_or_none::<S>(q, body).rotation;
        let turned = -(rotation.matrix() * c.cross_matrix());
        jacobian.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&turned);
        let g = rotation.rotate_back(pull);
        let curvature = curvature(&c, &g);
        End { freedoms: body_freedoms::<S>(body), jacobian, curvature }
    }
}

impl<S: BodySpace> PotentialOn<S> for BodySpring<S> {}

impl<S: BodySpace> Potential for BodySpring<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let stretch = self.stretch(q);
        if self.rest == 0.0 {
            return 0.5 * self.stiffness * stretch.norm_squared();
        }
        0.5 * self.stiffness * (stretch.norm() - self.rest).powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let (pull, _) = self.pull(&self.stretch(q));
        for (end, sign) in self.ends.iter().zip([1.0, -1.0]) {
            let Attachment::Body(body, c) = *end else { continue };
            let wrench = force_at_point(&pose_or_none::<S>(q, body), &c, pull);
            add_wrench::<S>(dv.0, Some(body), &wrench, sign);
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let stretch = self.stretch(q);
        let (pull, share) = self.pull(&stretch);
        let ends = [Self::end(q, &self.ends[0], &pull), Self::end(q, &self.ends[1], &-pull)];
        let mut whole = SMatrix::<f64, 3, 12>::zeros();
        whole.fixed_view_mut::<3, 6>(0, 0).copy_from(&ends[0].jacobian);
        whole.fixed_view_mut::<3, 6>(0, 6).copy_from(&-ends[1].jacobian);
        let mut across = Matrix3::from_diagonal_element(1.0 - share);
        if share != 0.0 {
            across += stretch * stretch.transpose() * (share / stretch.norm_squared());
        }
        let mut block = whole.transpose() * across * whole * self.stiffness;
        for (first, end) in [3, 9].into_iter().zip(&ends) {
            let mut turns = block.fixed_view_mut::<3, 3>(first, first);
            turns += end.curvature;
        }
        let mut freedoms = [FIXED; 12];
        freedoms[..6].copy_from_slice(&ends[0].freedoms);
        freedoms[6..].copy_from_slice(&ends[1].freedoms);
        hessian.add_symmetric(&freedoms, block.as_slice());
    }
}
