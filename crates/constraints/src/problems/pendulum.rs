//! A pendulum in the plane: a unit mass on a unit rod, pushed sideways where it hangs.
//!
//! ```text
//! k = speed/2 < 1    theta = 2 asin(k sn(t, k))      it swings to and fro, period 4 K(k)
//! k > 1              theta = 2 am(k t, 1/k)          it goes round, period 2 K(1/k)/k
//! T = speed^2 - 2 + 3 cos theta                      tension of the rod        (m = L = g = 1)
//! ```
//! `theta` the angle from hanging, counterclockwise, radians. Jacobi's functions by the descending
//! Landen transformation (Abramowitz and Stegun 16.4, 22.2). Source: notes 6; errata 0.1.

use stationary_calculus::Covector;
use stationary_integrators::State;

use super::{RodProblem, hanging};
use crate::{ConstraintError, Rod, Rods};

/// A pendulum and its exact motion.
#[derive(Clone, Debug)]
pub struct Pendulum {
    /// Its system, rod and initial data: hanging, moving to the right.
    pub problem: RodProblem<[f64; 2]>,
    /// The time of one swing to and fro, or of one revolution.
    pub period: f64,
    speed: f64,
}

/// The pendulum that passes the bottom with a speed, positive and not 2, where it would take
/// forever to reach the top.
///
/// # Errors
/// [`ConstraintError::Parameter`] for a speed that is not positive and finite, or within 1e-6 of 2.
pub fn pendulum(speed: f64) -> Result<Pendulum, ConstraintError> {
    if !(speed > 0.0 && speed.is_finite() && (speed - 2.0).abs() > 1e-6) {
        let range = "positive, finite and not 2";
        return Err(ConstraintError::Parameter { what: "speed", value: speed, range });
    }
    let rods = Rods::new(1, vec![[0.0, 0.0]], vec![Rod::new([1, 0], 1.0)])?;
    let problem = hanging([0.0, -1.0], [speed, 0.0], 1.0, rods)?;
    let k = 0.5 * speed;
    let quarter = |k| Landen::new(k).quarter_period();
    let period = if k < 1.0 { 4.0 * quarter(k) } else { 2.0 * quarter(k.recip()) / k };
    Ok(Pendulum { problem, period, speed })
}

impl Pendulum {
    /// The angle at a time, from hanging, radians.
    pub fn angle(&self, t: f64) -> f64 {
        let k = 0.5 * self.speed;
        let turns = (t / self.period).round();
        let rest = t - turns * self.period;
        if k < 1.0 {
            2.0 * (k * Landen::new(k).amplitude(rest).sin()).asin()
        } else {
            let amplitude = Landen::new(k.recip()).amplitude(k * rest);
            2.0 * (amplitude + turns * std::f64::consts::PI)
        }
    }

    /// The place at a time.
    pub fn place(&self, t: f64) -> [f64; 2] {
        let (s, c) = self.angle(t).sin_cos();
        [s, -c]
    }

    /// The rate of the angle at a time, radians a second.
    pub fn rate(&self, t: f64) -> f64 {
        let k = 0.5 * self.speed;
        let rest = t - (t / self.period).round() * self.period;
        if k < 1.0 {
            self.speed * Landen::new(k).amplitude(rest).cos()
        } else {
            let sine = Landen::new(k.recip()).amplitude(k * rest).sin() / k;
            self.speed * ((1.0 - sine) * (1.0 + sine)).sqrt()
        }
    }

    /// The true state at a time.
    pub fn state(&self, t: f64) -> State<[f64; 2]> {
        let (s, c) = self.angle(t).sin_cos();
        let mut state = State::new([s, -c], Covector([self.rate(t) * c, self.rate(t) * s]));
        state.t = t;
        state
    }

    /// The distance from the true place at a time.
    pub fn error(&self, t: f64, q: &[f64; 2]) -> f64 {
        let [x, y] = self.place(t);
        (q[0] - x).hypot(q[1] - y)
    }

    /// The rod's tension at a time.
    pub fn tension(&self, t: f64) -> f64 {
        self.speed * self.speed - 2.0 + 3.0 * self.angle(t).cos()
    }
}

/// Halvings of the arithmetic-geometric mean: it doubles its digits each time.
const HALVINGS: usize = 9;

/// The scale of arithmetic-geometric means that belongs to a modulus below 1.
struct Landen {
    a: [f64; HALVINGS],
    c: [f64; HALVINGS],
}

impl Landen {
    fn new(k: f64) -> Self {
        let (mut a, mut c) = ([1.0; HALVINGS], [k; HALVINGS]);
        let mut b = ((1.0 - k) * (1.0 + k)).sqrt();
        for i in 1..HALVINGS {
            a[i] = 0.5 * (a[i - 1] + b);
            c[i] = 0.5 * (a[i - 1] - b);
            b = (a[i - 1] * b).sqrt();
        }
        Landen { a, c }
    }

    /// K(k).
    fn quarter_period(&self) -> f64 {
        std::f64::consts::FRAC_PI_2 / self.a[HALVINGS - 1]
    }

    /// am(u, k).
    fn amplitude(&self, u: f64) -> f64 {
        let last = HALVINGS - 1;
        let mut phi = f64::from(1_u32 << last) * self.a[last] * u;
        for i in (1..HALVINGS).rev() {
            phi = 0.5 * (phi + (self.c[i] / self.a[i] * phi.sin()).asin());
        }
        phi
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_satisfies_its_equation_to_and_fro_and_round() {
        for speed in [0.1, 1.9, 2.1, 5.0] {
            let pendulum = pendulum(speed).unwrap();
            let h = 1e-3;
            for i in 0..60 {
                let t = 0.17 * f64::from(i);
                let at = |t| pendulum.angle(t);
                let acceleration = (at(t + h) - 2.0 * at(t) + at(t - h)) / (h * h);
                assert!((acceleration + at(t).sin()).abs() < 2e-5, "{speed} at {t}");
                let rate = (at(t + h) - at(t - h)) / (2.0 * h);
                assert!((rate - pendulum.rate(t)).abs() < 1e-5 * speed.max(1.0).powi(3));
                let energy = 0.5 * rate * rate - at(t).cos();
                assert!((energy - (0.5 * speed * speed - 1.0)).abs() < 1e-4, "{speed} at {t}");
            }
        }
    }

    #[test]
    fn it_comes_back_after_its_period() {
        let swinging = pendulum(1.5).unwrap();
        assert!(swinging.angle(swinging.period).abs() < 1e-13);
        assert!(swinging.angle(0.5 * swinging.period).abs() < 1e-13);
        let circling = pendulum(2.5).unwrap();
        let turn = 2.0 * std::f64::consts::PI;
        assert!((circling.angle(circling.period) - turn).abs() < 1e-13);
        assert!((circling.angle(0.5 * circling.period) - 0.5 * turn).abs() < 1e-13);
    }

    #[test]
    fn the_push_that_just_reaches_the_top_is_refused() {
        for speed in [0.0, -1.0, 2.0, f64::NAN] {
            assert!(pendulum(speed).is_err());
        }
    }
}
