//! Joints between bodies in the plane: pins and welds.
//!
//! ```text
//! pin     x_1 - x_2 = 0,    x = t + R(theta) c             2 equations
//! weld    and  theta_1 - theta_2 = angle                   3
//! dx = dt + Z R c dtheta,   d2x = -R c dtheta^2            Z a quarter turn
//! ```
//! `t` a centre, `c` a point in the body's axes (m); `theta` an angle in radians, of the world
//! zero. A body has the freedoms (x, y, theta) and a metric that is constant on flat space, so that
//! every method of flat spaces moves jointed bodies rightly. Multipliers are the force of end 2 on
//! end 1 with its sign turned (N), and a torque (N m). Source: notes 6, 7.4.

use nalgebra::Vector2;
use stationary_calculus::{Flat, Sink, SizeError};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_read, check_values,
};

use crate::error::check_finite;
use crate::{LieGroup, PlanarRotation, RigidError};

/// An end of a joint in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarAttachment {
    /// A point of the plane, metres.
    World(Vector2<f64>),
    /// A point of a body, metres, body axes.
    Body(usize, Vector2<f64>),
}

/// A joint between two planar bodies, or a body and the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarJoint {
    bodies: usize,
    ends: [PlanarAttachment; 2],
    /// The angle that a weld holds.
    angle: Option<f64>,
}

impl PlanarAttachment {
    fn body(&self) -> Option<usize> {
        match *self {
            PlanarAttachment::World(_) => None,
            PlanarAttachment::Body(body, _) => Some(body),
        }
    }

    fn vector(&self) -> Vector2<f64> {
        match *self {
            PlanarAttachment::World(v) | PlanarAttachment::Body(_, v) => v,
        }
    }

    /// From the body's centre to the end, in the world.
    fn arm(&self, q: &[f64]) -> Vector2<f64> {
        match *self {
            PlanarAttachment::World(_) => Vector2::zeros(),
            PlanarAttachment::Body(body, c) => PlanarRotation::exp(q[3 * body + 2]).rotate(&c),
        }
    }

    fn place(&self, q: &[f64]) -> Vector2<f64> {
        match *self {
            PlanarAttachment::World(x) => x,
            PlanarAttachment::Body(body, _) => {
                Vector2::new(q[3 * body], q[3 * body + 1]) + self.arm(q)
            }
        }
    }

    fn turn(&self, q: &[f64]) -> f64 {
        self.body().map_or(0.0, |body| q[3 * body + 2])
    }
}

impl PlanarJoint {
    /// Two points that stay together, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for a point that is not finite; [`RigidError::NoSuchBody`];
    /// [`RigidError::JoinedToItself`] for two ends on one body, or on the world.
    pub fn pin(bodies: usize, ends: [PlanarAttachment; 2]) -> Result<Self, RigidError> {
        for end in &ends {
            check_finite("the joint's point", end.vector().as_slice())?;
            if let Some(body) = end.body().filter(|&body| body >= bodies) {
                return Err(RigidError::NoSuchBody { body, bodies });
            }
        }
        if ends[0].body() == ends[1].body() {
            return Err(RigidError::JoinedToItself { ends: ends.map(|end| end.body()) });
        }
        Ok(PlanarJoint { bodies, ends, angle: None })
    }

    /// A pin whose ends do not turn against each other, either: the first end's body is ahead by
    /// `angle` radians.
    ///
    /// # Errors
    /// Those of [`PlanarJoint::pin`]; [`RigidError::NonFinite`] for an angle that is not finite.
    pub fn weld(
        bodies: usize,
        ends: [PlanarAttachment; 2],
        angle: f64,
    ) -> Result<Self, RigidError> {
        check_finite("the joint's angle", &[angle])?;
        Ok(PlanarJoint { angle: Some(angle), ..PlanarJoint::pin(bodies, ends)? })
    }
}

impl ConstraintOn<Flat> for PlanarJoint {}

impl Constraint for PlanarJoint {
    fn dim(&self) -> usize {
        self.bodies.saturating_mul(3)
    }

    fn count(&self) -> usize {
        2 + usize::from(self.angle.is_some())
    }

    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        check_read(self.dim(), q)?;
        let [a, b] = &self.ends;
        let gap = a.place(q) - b.place(q);
        let turn = self.angle.map(|angle| a.turn(q) - b.turn(q) - angle);
        let values = gap.iter().copied().chain(turn);
        g.iter_mut().zip(values).for_each(|(g, value)| *g = value);
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        for row in 0..self.count() {
            for (end, sign) in self.ends.iter().zip([1.0, -1.0]) {
                let Some(body) = end.body() else { continue };
                let arm = end.arm(q);
                match row {
                    0 => rows.add(0, 3 * body + 2, -sign * arm.y),
                    1 => rows.add(1, 3 * body + 2, sign * arm.x),
                    _ => rows.add(2, 3 * body + 2, sign),
                }
                if row < 2 {
                    rows.add(row, 3 * body + row, sign);
                }
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        check_read(self.dim(), q)?;
        for (end, sign) in self.ends.iter().zip([1.0, -1.0]) {
            let Some(body) = end.body() else { continue };
            let arm = end.arm(q);
            let bend = -sign * (lambda[0] * arm.x + lambda[1] * arm.y);
            hessian.add_symmetric(&[3 * body + 2], &[bend]);
        }
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        let arms = self.ends.iter().filter(|end| end.body().is_some());
        let arm = arms.map(|end| end.vector().norm()).fold(0.0, f64::max);
        match row {
            0 | 1 if arm > 0.0 => Scale { slope: 1.0, length: arm },
            _ => Scale::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::assert_derivatives;
    use stationary_constraints::Pairing;

    const POINT: Vector2<f64> = Vector2::new(0.3, -0.7);

    #[test]
    fn the_derivatives_of_pins_and_welds_are_right() {
        let q = [0.4, -0.2, 0.9, -0.5, 0.1, 2.3];
        let multipliers = || vec![0.7, -1.3, 2.0];
        let between = [PlanarAttachment::Body(0, POINT), PlanarAttachment::Body(1, -2.0 * POINT)];
        let hung = [PlanarAttachment::World(POINT), PlanarAttachment::Body(1, POINT)];
        for ends in [between, hung] {
            let constraint = PlanarJoint::weld(2, ends, 0.3).unwrap();
            assert_derivatives(&Pairing::new(constraint, multipliers(), 0.0).unwrap(), &q);
            let constraint = PlanarJoint::pin(2, ends).unwrap();
            let multipliers = multipliers()[..2].to_vec();
            assert_derivatives(&Pairing::new(constraint, multipliers, 0.0).unwrap(), &q);
        }
    }

    #[test]
    fn pins_that_join_nothing_are_refused() {
        let body = |k| PlanarAttachment::Body(k, POINT);
        let same = PlanarJoint::pin(2, [body(1), body(1)]);
        assert!(matches!(same, Err(RigidError::JoinedToItself { .. })));
        let absent = PlanarJoint::weld(2, [body(0), body(2)], 0.0);
        assert!(matches!(absent, Err(RigidError::NoSuchBody { body: 2, bodies: 2 })));
        let nowhere = PlanarJoint::weld(2, [body(0), body(1)], f64::NAN);
        assert!(matches!(nowhere, Err(RigidError::NonFinite { .. })));
    }
}
