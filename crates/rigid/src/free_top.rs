//! The free asymmetric top in closed form: angular velocity and attitude at any time.
//!
//! ```text
//! mx = A cn(u),   my = B sn(u),   mz = C dn(u),     u = u0 + l t                   m. = m x I^-1 m
//! A^2 = Ix (2T Iz - L^2)/(Iz - Ix)         l^2 = (Iz - Iy)(L^2 - 2T Ix)/(Ix Iy Iz)
//! B^2 = Iy (2T Iz - L^2)/(Iz - Iy)         k^2 = (Iy - Ix)(2T Iz - L^2)/((Iz - Iy)(L^2 - 2T Ix))
//! C^2 = Iz (L^2 - 2T Ix)/(Iz - Ix)
//! psi = L t/Is + L (Is - Ia)/(Ix Iz l) [E_c(u) - E_c(u0)]
//!       a = x,  s = z,  c = (A/C)^2 if A <= C,       a = z,  s = x,  c = (k C/A)^2 if not
//! R(t) = R0 Q0^-1 exp(psi e3) Q(t),        Q m = L e3, and Q ea in the plane of e1 and e3
//! ```
//! `m` angular momentum in body axes, `L` its length, `T` the energy, `I` principal moments. `y` is
//! the axis of the middle moment, `z` that of the largest if `L^2 > 2T Iy` and of the smallest if
//! less: the one that `m` circles. `psi` is the turn about the angular momentum of the axis `a`, the one
//! of `x` and `z` that stays away from it, and `E_c(u) = int_0^u c sn^2/(1 + c sn^2)`: no term turns
//! faster than the body does, so that none cancels. Of short times psi is summed by Gauss's points
//! instead. Differences like `2T Iz - L^2` are summed from terms of one sign; only the distance from the
//! separatrix, `L^2 - 2T Iy`, cancels, and is summed from exact products.
//!
//! Errors are roundings that grow with the angle turned, times what the motion itself makes of a
//! rounding of its start: beside the separatrix that is `exp(l t)`. On the separatrix, where the period is
//! infinite, hyperbolic functions take over by themselves. Source: Landau and Lifshitz, Mechanics,
//! 37; Whittaker, Analytical Dynamics, 69; DLMF 19.7.8, which leads from one axis to the other.

use nalgebra::{Matrix3, Vector3};

use crate::elliptic::{Argument, Modulus};
use crate::error::check_finite;
use crate::rotation::length;
use crate::twofold::{Twofold, power_below};
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
    /// The axis a, whose turn about the angular momentum is followed.
    followed: usize,
    /// The axis s.
    steady: usize,
    /// c.
    eccentricity: f64,
    /// `L (Is - Ia)/(Ix Iz l)`
    gain: f64,
    /// E_c at time zero.
    integral: f64,
    /// `R0 Q0^-1`.
    frame: Rotation,
}

impl FreeTop {
    /// The body at orientation `start` with angular velocity `w` (rad/s, body axes) at time zero.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for an angular velocity or momentum that is not finite.
    pub fn new(body: Body, start: Rotation, w: Vector3<f64>) -> Result<Self, RigidError> {
        check_finite("the angular velocity", w.as_slice())?;
        let momentum = body.angular_momentum(&w);
        check_finite("the angular momentum", momentum.as_slice())?;
        Ok(FreeTop::from_momentum(body, start, momentum))
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
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for a time that is not finite; [`RigidError::PhaseLost`] for one after
    /// which rounding of the turn reaches a hundredth of a radian.
    pub fn momentum(&self, t: f64) -> Result<Vector3<f64>, RigidError> {
        self.check_turn(t)?;
        Ok(match &self.motion {
            Motion::Steady => self.momentum,
            Motion::Tumbling(tumble) => tumble.momentum(t),
        })
    }

    /// The angular velocity in body axes after `t` seconds, rad/s.
    ///
    /// # Errors
    /// Those of [`FreeTop::momentum`].
    pub fn angular_velocity(&self, t: f64) -> Result<Vector3<f64>, RigidError> {
        Ok(self.body.angular_velocity(&self.momentum(t)?))
    }

    /// The orientation after `t` seconds.
    ///
    /// # Errors
    /// Those of [`FreeTop::momentum`], of the body's own turn as well.
    pub fn orientation(&self, t: f64) -> Result<Rotation, RigidError> {
        self.check_turn(t)?;
        Ok(match &self.motion {
            Motion::Steady => self.start.walk(self.body.angular_velocity(&self.momentum) * t),
            Motion::Tumbling(tumble) => {
                tumble.orientation(t, length(&self.momentum), self.body.moments())?
            }
        })
    }

    fn check_turn(&self, t: f64) -> Result<(), RigidError> {
        check_finite("the time", &[t])?;
        check_phase(match &self.motion {
            Motion::Steady => self.body.angular_velocity(&self.momentum).norm() * t,
            Motion::Tumbling(tumble) => tumble.phase + tumble.rate * t,
        })
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

/// Beyond it, radians, half a rounding is a hundredth of a radian.
const LONGEST_TURN: f64 = 0.02 / f64::EPSILON;

fn check_phase(radians: f64) -> Result<(), RigidError> {
    match radians.abs() <= LONGEST_TURN {
        true => Ok(()),
        false => Err(RigidError::PhaseLost { radians }),
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
        if m.amax() == 0.0 {
            return None;
        }
        // In units, powers of two, in which neither squares nor products leave the range.
        let (size, unit) = (power_below(m.amax()), power_below(body.moments().amax()));
        let (i, m) = (body.moments() / unit, m / size);
        let [a, b, c] = ascending(&i);
        let side = side(&i, &m, [a, b, c]);
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
        let ratio = amplitudes[0] / amplitudes[2];
        if !phase.is_finite() || ratio.is_nan() {
            // On the axis of the middle moment, which the separatrix takes for ever to leave.
            return None;
        }
        let (followed, steady, eccentricity) = match ratio.abs() <= 1.0 {
            true => (x, z, ratio.powi(2)),
            false => (z, x, k2 / ratio.powi(2)),
        };
        let mut tumble = Tumble {
            axes: [x, y, z],
            amplitudes: amplitudes.map(|amplitude| amplitude * size),
            rate: rate * (size / unit),
            modulus,
            phase,
            followed,
            steady,
            eccentricity,
            gain: length(&m) * (i[steady] - i[followed]) / (i[x] * i[z] * rate),
            integral: 0.0,
            frame: start.compose(&to_momentum(&m, followed).inverse()),
        };
        tumble.integral = modulus.excess_integral(&modulus.argument(phase), eccentricity);
        Some(tumble)
    }

    /// The turn of the followed axis about the angular momentum after a time, radians.
    fn precession(&self, t: f64, u: &Argument, length: f64, i: &Vector3<f64>) -> f64 {
        let panels = (self.rate * t).abs() * (1.0 + self.eccentricity).sqrt() / PANEL;
        if panels < SHORT {
            // Small differences of the integral would be rounding, over a rate that may be smaller.
            return self.summed_precession(t, panels.ceil().max(1.0), length, i);
        }
        let passed = self.modulus.excess_integral(u, self.eccentricity) - self.integral;
        length / i[self.steady] * t + self.gain * passed
    }

    /// The precession by Gauss's points in so many panels.
    fn summed_precession(&self, t: f64, panels: f64, length: f64, i: &Vector3<f64>) -> f64 {
        let (y, s) = (self.axes[1], self.steady);
        let rate = |t: f64| {
            let m = self.momentum(t);
            let (my, ms) = (m[y] / length, m[s] / length);
            (my * my / i[y] + ms * ms / i[s]) / (my * my + ms * ms)
        };
        let half = 0.5 * t / panels;
        let panel = |k: usize| {
            let middle = half * (2 * k + 1) as f64;
            let pair = |(node, weight): &(f64, f64)| {
                weight * (rate(middle + half * node) + rate(middle - half * node))
            };
            GAUSS.iter().map(pair).sum::<f64>()
        };
        half * length * (0..panels as usize).map(panel).sum::<f64>()
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

    fn orientation(&self, t: f64, length: f64, i: Vector3<f64>) -> Result<Rotation, RigidError> {
        let u = self.modulus.argument(self.phase + self.rate * t);
        let psi = self.precession(t, &u, length, &i);
        // Where moments nearly agree the body turns far faster than its axis of rotation wanders.
        check_phase(psi)?;
        let precession = Rotation::exp(Vector3::z() * psi);
        let now = to_momentum(&self.momentum(t), self.followed);
        Ok(self.frame.compose(&precession).compose(&now).normalized())
    }
}

/// Within this part of the integrand's scale eight points integrate it to rounding.
const PANEL: f64 = 0.4;

/// Times of fewer panels are summed.
const SHORT: f64 = 8.0;

/// Gauss's eight points in (-1, 1), by pairs, with their weights.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// `L^2 - 2T Iy`: on which side of the separatrix, and how far. It cancels there, and so is summed
/// from exact products of what is given.
fn side(i: &Vector3<f64>, m: &Vector3<f64>, [a, b, c]: [usize; 3]) -> f64 {
    let term = |one: usize, apart: Twofold, other: usize| {
        let whole = Twofold { hi: i[other], lo: 0.0 };
        Twofold::product(m[one], m[one]).times(apart).times(whole)
    };
    let above = term(c, Twofold::sum(i[c], -i[b]), a);
    let below = term(a, Twofold::sum(i[a], -i[b]), c);
    above.plus(below).hi / i[a] / i[c]
}

/// The turn Q that brings `m` to the third axis and the followed axis into the plane of the first and
/// third.
fn to_momentum(m: &Vector3<f64>, followed: usize) -> Rotation {
    let mut axis = Vector3::zeros();
    axis[followed] = 1.0;
    let third = (m / power_below(m.amax())).normalize();
    let second = third.cross(&axis).normalize();
    let rows = Matrix3::from_columns(&[second.cross(&third), second, third]);
    Rotation::from_orthogonal(&rows.transpose())
}
