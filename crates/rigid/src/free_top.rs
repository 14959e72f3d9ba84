//! The free asymmetric top in closed form: angular velocity and attitude at any time.
//!
//! ```text
//! mx = A cn(u),   my = B sn(u),   mz = C dn(u),     u = u0 + l t                   m. = m x I^-1 m
//! A^2 = Ix (2T Iz - L^2)/(Iz - Ix)         l^2 = (Iz - Iy)(L^2 - 2T Ix)/(Ix Iy Iz)
//! B^2 = Iy (2T Iz - L^2)/(Iz - Iy)         k^2 = (Iy - Ix)(2T Iz - L^2)/((Iz - Iy)(L^2 - 2T Ix))
//! C^2 = Iz (L^2 - 2T Ix)/(Iz - Ix)
//! psi = L t/Ix - L (L^2 - 2T Ix)/(Ix C^2 l) [Pi(u) - Pi(u0)],   Pi over 1 + (A/C)^2 sn^2
//! R(t) = R0 Q0^-1 exp(psi e3) Q(t),        Q m = L e3, and Q ex in the plane of e1 and e3
//! ```
//! `m` angular momentum in body axes, `L` its length, `T` the energy, `I` principal moments. `y` is
//! the axis of the middle moment, `z` that of the largest if `L^2 > 2T Iy` and of the smallest if
//! less: the one that `m` circles. `psi` is the turn of the axis `x` about the angular momentum,
//! which it never meets. Differences like `2T Iz - L^2` are summed from terms of one sign; only the
//! distance from the separatrix, `L^2 - 2T Iy`, cancels, as it must.
//!
//! Errors are roundings that grow with the angle turned. On the separatrix, where the period is
//! infinite, hyperbolic functions take over by themselves. Source: Landau and Lifshitz, Mechanics,
//! 37; Whittaker, Analytical Dynamics, 69.

use nalgebra::{Matrix3, Vector3};

use crate::elliptic::Modulus;
use crate::{Body, LieGroup, RigidError, Rotation};

/// A body that turns free of torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeTop {
    body: Body,
    start: Rotation,
    momentum: Vector3<f64>,
    motion: Motion,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// About a fixed axis.
    Steady,
    Tumbling(Tumble),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Tumble {
    /// The axes x, y and z.
    axes: [usize; 3],
    /// A, B and C with their signs.
    amplitudes: [f64; 3],
    /// l, rad/s.
    rate: f64,
    modulus: Modulus,
    /// u at time zero.
    phase: f64,
    /// Pi at time zero.
    integral: f64,
    /// `R0 Q0^-1`.
    frame: Rotation,
}

impl FreeTop {
    /// The body at orientation `start` with angular velocity `w` (rad/s, body axes) at time zero.
    pub fn new(body: Body, start: Rotation, w: Vector3<f64>) -> Result<Self, RigidError> {
        crate::error::check_finite("the angular velocity", w.as_slice())?;
        Ok(FreeTop::from_momentum(body, start, body.angular_momentum(&w)))
    }

    /// The body with this angular momentum (body axes) at time zero.
    pub(crate) fn from_momentum(body: Body, start: Rotation, momentum: Vector3<f64>) -> Self {
        let motion = match Tumble::new(&body, start, momentum) {
            Some(tumble) => Motion::Tumbling(tumble),
            None => Motion::Steady,
        };
        FreeTop { body, start, momentum, motion }
    }

    /// The angular momentum in body axes after `t` seconds.
    pub fn momentum(&self, t: f64) -> Vector3<f64> {
        match &self.motion {
            Motion::Steady => self.momentum,
            Motion::Tumbling(tumble) => tumble.momentum(t),
        }
    }

    /// The angular velocity in body axes after `t` seconds, rad/s.
    pub fn angular_velocity(&self, t: f64) -> Vector3<f64> {
        self.body.angular_velocity(&self.momentum(t))
    }

    /// The orientation after `t` seconds.
    pub fn orientation(&self, t: f64) -> Rotation {
        match &self.motion {
            Motion::Steady => self.start.walk(self.body.angular_velocity(&self.momentum) * t),
            Motion::Tumbling(tumble) => {
                tumble.orientation(t, self.momentum.norm(), self.body.moments())
            }
        }
    }

    /// The time after which the angular velocity comes back, seconds; `None` where it is steady or
    /// never does.
    pub fn period(&self) -> Option<f64> {
        match &self.motion {
            Motion::Tumbling(Tumble { modulus, rate, .. }) => {
                let period = 4.0 * modulus.quarter_period() / rate;
                period.is_finite().then_some(period)
            }
            Motion::Steady => None,
        }
    }
}

/// Axes in ascending order of their moments.
fn ascending(moments: &Vector3<f64>) -> [usize; 3] {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| moments[a].total_cmp(&moments[b]));
    axes
}

impl Tumble {
    /// `None` where the axis of rotation is steady.
    fn new(body: &Body, start: Rotation, m: Vector3<f64>) -> Option<Self> {
        let i = body.moments();
        let [a, b, c] = ascending(&i);
        // L^2 - 2T Iy: on which side of the separatrix.
        let side = m[c] * m[c] * (i[c] - i[b]) / i[c] - m[a] * m[a] * (i[b] - i[a]) / i[a];
        let [x, y, z] = if side > 0.0 { [a, b, c] } else { [c, b, a] };
        // 2T Iz - L^2 and L^2 - 2T Ix, both of the sign of Iz - Iy.
        let wobble = m[x] * m[x] * (i[z] - i[x]) / i[x] + m[y] * m[y] * (i[z] - i[y]) / i[y];
        let spin = m[y] * m[y] * (i[y] - i[x]) / i[y] + m[z] * m[z] * (i[z] - i[x]) / i[z];
        let rate = ((i[z] - i[y]) * spin / (i[x] * i[y] * i[z])).sqrt();
        if rate.is_nan() || rate == 0.0 || wobble == 0.0 {
            return None;
        }
        let denominator = (i[z] - i[y]) * spin;
        let k2 = ((i[y] - i[x]) * wobble / denominator).min(1.0);
        let kc2 = ((i[z] - i[x]) * side / denominator).clamp(0.0, 1.0);
        let modulus = Modulus { k2, kc2 };
        let parity = if (x + 1) % 3 == y { 1.0 } else { -1.0 };
        // On the separatrix cn never changes sign, and A has that of mx.
        let upright = if kc2 == 0.0 { m[x].signum() } else { 1.0 };
        let forward = parity * upright * m[z].signum() * (i[z] - i[y]).signum();
        let amplitudes = [
            (i[x] * wobble / (i[z] - i[x])).sqrt() * upright,
            (i[y] * wobble / (i[z] - i[y])).sqrt() * forward,
            (i[z] * spin / (i[z] - i[x])).sqrt() * m[z].signum(),
        ];
        let phase = modulus.argument_of(m[y] / amplitudes[1], m[x] / amplitudes[0]);
        if !phase.is_finite() {
            // On the axis of the middle moment, which the separatrix takes for ever to leave.
            return None;
        }
        let mut tumble = Tumble {
            axes: [x, y, z],
            amplitudes,
            rate,
            modulus,
            phase,
            integral: 0.0,
            frame: start.compose(&to_momentum(&m, x).inverse()),
        };
        tumble.integral = modulus.third_integral(&modulus.argument(phase), tumble.eccentricity());
        Some(tumble)
    }

    /// `(A/C)^2`
    fn eccentricity(&self) -> f64 {
        (self.amplitudes[0] / self.amplitudes[2]).powi(2)
    }

    fn momentum(&self, t: f64) -> Vector3<f64> {
        let [sn, cn, dn] = self.modulus.argument(self.phase + self.rate * t).functions();
        let mut m = Vector3::zeros();
        for (axis, value) in self.axes.into_iter().zip([cn, sn, dn]) {
            m[axis] = value;
        }
        for (axis, amplitude) in self.axes.into_iter().zip(self.amplitudes) {
            m[axis] *= amplitude;
        }
        m
    }

    fn orientation(&self, t: f64, length: f64, i: Vector3<f64>) -> Rotation {
        let [x, _, z] = self.axes;
        let u = self.modulus.argument(self.phase + self.rate * t);
        let passed = self.modulus.third_integral(&u, self.eccentricity()) - self.integral;
        // (L^2 - 2T Ix)/C^2, from C^2 itself.
        let ratio = (i[z] - i[x]) / i[z];
        let psi = length / i[x] * (t - ratio * passed / self.rate);
        let precession = Rotation::exp(Vector3::z() * psi);
        let now = to_momentum(&self.momentum(t), x);
        self.frame.compose(&precession).compose(&now).normalized()
    }
}

/// The turn Q that brings `m` to the third axis and the axis x into the plane of the first and
/// third.
fn to_momentum(m: &Vector3<f64>, x: usize) -> Rotation {
    let mut axis = Vector3::zeros();
    axis[x] = 1.0;
    let third = m.normalize();
    let second = third.cross(&axis).normalize();
    let rows = Matrix3::from_columns(&[second.cross(&third), second, third]);
    Rotation::from_orthogonal(&rows.transpose())
}
