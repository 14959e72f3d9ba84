//! The free body split into turns about its three axes, each of them exact.
//!
//! ```text
//! T = m1^2/2 I1 + m2^2/2 I2 + m3^2/2 I3
//! S = Sa(h/2) Sb(h/2) Sc(h) Sb(h/2) Sa(h/2),     Sk(h) = exp(h mk/Ik ek)
//! ```
//! `m` the angular momentum in body axes, as the turns before have left it; `I` the principal
//! moments. Each part of the energy alone turns the body steadily about its axis and leaves `mk`.
//! Order 2, explicit, symmetric, symplectic; keeps spatial angular momentum to rounding. Exact for
//! a turn about a principal axis, at any speed. Axis `a` is that of the smallest moment, `b c` the
//! next two in turn, whichever way time goes: on a box with moments 13 : 10 : 5 that order errs six
//! times less than the worst. Source: McLachlan 1993; Reich 1994; Hairer, Lubich and Wanner, Geometric Numerical
//! Integration, VII.5.

use nalgebra::Vector3;
use stationary_integrators::{Evaluation, Facts, StepError};

use crate::free_rotation::{FreeRotation, Turned};
use crate::stumpff::sine_cosine;
use crate::variational::ConstantVelocity;
use crate::{Body, Rotation};

/// The free body split into turns about its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisRotations;

/// An orientation and a momentum under way.
struct Spin {
    q: [f64; 4],
    m: Vector3<f64>,
}

impl Spin {
    /// Turns about axis `A` for the time that `rate` has been multiplied by.
    #[inline]
    fn turn<const A: usize>(&mut self, rate: f64) {
        let (b, c) = ((A + 1) % 3, (A + 2) % 3);
        let (sine, cosine) = sine_cosine(0.5 * rate * self.m[A]);
        // sin a and 1 - cos a of the whole angle: the turn's difference from no turn.
        let (turn, versine) = (2.0 * sine * cosine, 2.0 * sine * sine);
        let (mb, mc) = (self.m[b], self.m[c]);
        self.m[b] = mb + (turn * mc - versine * mb);
        self.m[c] = mc - (turn * mb + versine * mc);
        let [w, x] = [self.q[0], self.q[1 + A]];
        let [y, z] = [self.q[1 + b], self.q[1 + c]];
        self.q[0] = cosine * w - sine * x;
        self.q[1 + A] = cosine * x + sine * w;
        self.q[1 + b] = cosine * y + sine * z;
        self.q[1 + c] = cosine * z - sine * y;
    }
}

impl Spin {
    /// Half the turns about A and B, the turn about C, and back.
    #[inline]
    fn there_and_back<const A: usize, const B: usize, const C: usize>(
        &mut self,
        rate: &Vector3<f64>,
    ) {
        self.turn::<A>(0.5 * rate[A]);
        self.turn::<B>(0.5 * rate[B]);
        self.turn::<C>(rate[C]);
        self.turn::<B>(0.5 * rate[B]);
        self.turn::<A>(0.5 * rate[A]);
    }
}

/// The axis about which a body with these moments, told by one over each, turns first: that of the
/// smallest; where two are as small the third, or else the first.
#[inline]
pub(crate) fn first_axis(inverse: &Vector3<f64>) -> usize {
    if inverse[2] >= inverse[0] && inverse[2] >= inverse[1] {
        2
    } else if inverse[0] >= inverse[1] {
        0
    } else {
        1
    }
}

impl FreeRotation for AxisRotations {
    const FACTS: Facts = Facts {
        name: "axis-rotations",
        evaluation: Evaluation::Explicit,
        ..ConstantVelocity::FACTS
    };

    #[inline]
    fn turn(
        body: &Body,
        rotation: Rotation,
        momentum: Vector3<f64>,
        h: f64,
    ) -> Result<Turned, StepError> {
        let rate = body.inverse_moments() * h;
        let mut spin = Spin { q: rotation.quaternion(), m: momentum };
        match first_axis(&body.inverse_moments()) {
            0 => spin.there_and_back::<0, 1, 2>(&rate),
            1 => spin.there_and_back::<1, 2, 0>(&rate),
            _ => spin.there_and_back::<2, 0, 1>(&rate),
        }
        let rotation = Rotation::unchecked(spin.q).normalized();
        Ok(Turned { rotation, momentum: spin.m, iterations: 0, residual: 0.0 })
    }
}
