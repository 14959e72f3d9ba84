//! Motion near an equilibrium in closed form, at any time for the same cost.
//!
//! ```text
//! d(t) = sum_i v_i (mu_i c_i(t) + nu_i s_i(t)),   mu_i = v_i^T M d(0),   nu_i = v_i^T M d'(0)
//! c = e^-zwt (cos ut + zw s~),  s = e^-zwt s~,  s~ = sin(ut)/u     z < 1,   u = w sqrt(1 - z^2)
//! c = e^-at (1 + a f),  s = e^-at f,  f = (1 - e^-gt)/g            z >= 1,  a = w/(z + r), g = 2 w r
//! c = cosh(wt),  s = sinh(wt)/w                                    lambda < 0: it leaves
//! c = 1,  s = t                                                    lambda = 0: it drifts
//! E_i = 1/2 (nu_i^2 + lambda_i mu_i^2)                             energy of a mode, joules
//! ```
//! `v_i lambda_i` the modes, `w = sqrt(|lambda|)`, `d` the displacement (n), `z` the mode's damping
//! ratio, `r = sqrt(z^2 - 1)`. Of two decays the slow one is factored out, and its rate is a quotient:
//! nothing cancels and nothing overflows that is not large. What the initial data have outside of the
//! modes is left out, and its size is kept. A phase is known to a turn in 1e16: where none of its
//! digits is left there is no answer.
//! Source: notes 14.2, with the order of the factors in the velocity's equation as in errata 14.2.

use stationary_calculus::{SizeError, SymmetricMatrix, Vector, first_non_finite};

use crate::{ModalError, Modes, dense};

/// A phase is lost where rounding may turn it by this much, radians.
pub(crate) const LOST: f64 = 0.01;

/// A motion as a sum of modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<'a> {
    modes: &'a Modes,
    displacements: Vec<f64>,
    rates: Vec<f64>,
    ratios: Vec<f64>,
    left_out: [f64; 2],
}

impl<'a> Motion<'a> {
    /// The motion from the displacement `d` and the velocity `v` at time zero.
    ///
    /// # Errors
    /// [`ModalError::Size`], and [`ModalError::Parameter`] for components that are not finite, or too
    /// large for their products with the mass.
    pub fn new(
        modes: &'a Modes,
        mass: &SymmetricMatrix,
        d: Vector<&[f64]>,
        v: Vector<&[f64]>,
    ) -> Result<Self, ModalError> {
        let n = modes.dim();
        SizeError::check("the mass matrix's size", n, mass.dim())?;
        SizeError::check("the displacement's components", n, d.0.len())?;
        SizeError::check("the velocity's components", n, v.0.len())?;
        let (displacements, no_displacement) =
            in_modes(modes, mass, d.0, "a component of the displacement")?;
        let (rates, no_velocity) = in_modes(modes, mass, v.0, "a component of the velocity")?;
        let ratios = vec![0.0; modes.len()];
        let left_out = [no_displacement, no_velocity];
        Ok(Motion { modes, displacements, rates, ratios, left_out })
    }

    /// The same start with damping ratios zeta: mode i decays like `exp(-zeta_i sqrt(lambda_i) t)`
    /// where its ratio is at most one, and does not swing where it is larger. Modes whose lambda is not
    /// positive are not damped.
    ///
    /// # Errors
    /// [`ModalError::Size`], and [`ModalError::Parameter`] for a ratio that is negative or not finite.
    pub fn with_damping(mut self, ratios: &[f64]) -> Result<Self, ModalError> {
        SizeError::check("the damping ratios", self.modes.len(), ratios.len())?;
        if let Some(&value) = ratios.iter().find(|zeta| !(**zeta >= 0.0 && zeta.is_finite())) {
            return Err(ModalError::Parameter { what: "a damping ratio", value });
        }
        self.ratios.copy_from_slice(ratios);
        Ok(self)
    }

    /// The part of the initial displacement outside of the modes, relative to all of it in the mass.
    pub fn left_out(&self) -> f64 {
        self.left_out[0]
    }

    /// The part of the initial velocity outside of the modes, relative to all of it in the mass.
    pub fn left_out_of_velocity(&self) -> f64 {
        self.left_out[1]
    }

    /// Writes the displacement and the velocity at time t, seconds; t may be negative.
    ///
    /// # Errors
    /// [`ModalError::Size`]; [`ModalError::Parameter`] for a time that is not finite, or where the
    /// motion leaves the range of numbers; [`ModalError::PhaseLost`] where rounding of phases reaches a
    /// hundredth of a radian in modes that make up a hundredth of the motion.
    pub fn at(
        &self,
        t: f64,
        d: Vector<&mut [f64]>,
        v: Vector<&mut [f64]>,
    ) -> Result<(), ModalError> {
        SizeError::check("the displacement's components", self.modes.dim(), d.0.len())?;
        SizeError::check("the velocity's components", self.modes.dim(), v.0.len())?;
        check_time(t)?;
        self.check_phases(t)?;
        d.0.fill(0.0);
        v.0.fill(0.0);
        for i in 0..self.modes.len() {
            let (x, rate) = self.mode_at(i, t);
            dense::add_scaled(d.0, x, self.modes.column(i));
            dense::add_scaled(v.0, rate, self.modes.column(i));
        }
        match first_non_finite(d.0).or(first_non_finite(v.0)) {
            Some(_) => Err(ModalError::Parameter { what: OUT_OF_RANGE, value: t }),
            None => Ok(()),
        }
    }

    /// The energy of mode i at time t, joules.
    ///
    /// # Errors
    /// [`ModalError::Count`] where there are not so many, [`ModalError::Parameter`] as in
    /// [`Motion::at`].
    pub fn energy(&self, i: usize, t: f64) -> Result<f64, ModalError> {
        let there = self.modes.len();
        let lambda = *self
            .modes
            .values()
            .get(i)
            .ok_or(ModalError::Count { asked: i.saturating_add(1), there })?;
        check_time(t)?;
        let (x, rate) = self.mode_at(i, t);
        let energy = 0.5 * (rate * rate + lambda * x * x);
        if energy.is_finite() {
            Ok(energy)
        } else {
            Err(ModalError::Parameter { what: OUT_OF_RANGE, value: t })
        }
    }

    fn mode_at(&self, i: usize, t: f64) -> (f64, f64) {
        let propagator = Propagator::new(self.modes.values()[i], self.ratios[i], t);
        propagator.applied(self.displacements[i], self.rates[i])
    }

    /// An error where modes that swing, and have not died away, had a hundredth of the start, each by
    /// the root of its energy, and rounding has taken their phase.
    fn check_phases(&self, t: f64) -> Result<(), ModalError> {
        let (mut all, mut lost, mut worst) = (0.0, 0.0, None);
        for (i, &lambda) in self.modes.values().iter().enumerate() {
            let w = lambda.abs().sqrt();
            let size = (w * self.displacements[i]).hypot(self.rates[i]);
            all += size;
            let (zeta, radians) = (self.ratios[i], w * t.abs());
            let swings = lambda > 0.0 && zeta < 1.0;
            if swings && f64::EPSILON * radians > LOST {
                let decay = (-zeta * w * t).exp();
                if decay > f64::EPSILON && size > 0.0 {
                    lost += size;
                    worst = worst.or(Some((i, radians)));
                }
            }
        }
        match worst {
            Some((mode, radians)) if lost > LOST * all => {
                Err(ModalError::PhaseLost { mode, radians })
            }
            _ => Ok(()),
        }
    }
}

/// What is said of a motion that has left the range of numbers.
pub(crate) const OUT_OF_RANGE: &str = "a motion is no longer a number; the time";

fn check_time(t: f64) -> Result<(), ModalError> {
    if t.is_finite() { Ok(()) } else { Err(ModalError::Parameter { what: "the time", value: t }) }
}

/// The coefficients of a vector in the modes, and the part of it outside of them.
fn in_modes(
    modes: &Modes,
    mass: &SymmetricMatrix,
    x: &[f64],
    what: &'static str,
) -> Result<(Vec<f64>, f64), ModalError> {
    if let Some(&value) = x.iter().find(|x| !x.is_finite()) {
        return Err(ModalError::Parameter { what, value });
    }
    let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return Ok((vec![0.0; modes.len()], 0.0));
    }
    // Of length one about, so that squares stay in range.
    let mut rest: Vec<f64> = x.iter().map(|x| x / largest).collect();
    let moved = dense::times(mass, &rest);
    let all = dense::dot(&rest, &moved);
    let mut coefficients: Vec<f64> =
        (0..modes.len()).map(|i| dense::dot(modes.column(i), &moved)).collect();
    for (i, mu) in coefficients.iter().enumerate() {
        dense::add_scaled(&mut rest, -mu, modes.column(i));
    }
    let left = dense::dot(&rest, &dense::times(mass, &rest)).max(0.0);
    coefficients.iter_mut().for_each(|mu| *mu *= largest);
    let part = (left / all).sqrt();
    if part.is_finite() && coefficients.iter().all(|mu| mu.is_finite()) {
        Ok((coefficients, part))
    } else {
        Err(ModalError::Parameter { what, value: largest })
    }
}

/// What a mode's displacement and rate become over a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Propagator {
    c: f64,
    pub(crate) s: f64,
    c_rate: f64,
    s_rate: f64,
}

impl Propagator {
    pub(crate) fn new(lambda: f64, zeta: f64, t: f64) -> Self {
        let w = lambda.abs().sqrt();
        if lambda > 0.0 && zeta < 1.0 {
            Propagator::swinging(w, zeta, t)
        } else if lambda > 0.0 {
            Propagator::creeping(w, zeta, t)
        } else if lambda < 0.0 {
            let (c, s) = ((w * t).cosh(), (w * t).sinh());
            Propagator { c, s: s / w, c_rate: w * s, s_rate: c }
        } else {
            Propagator { c: 1.0, s: t, c_rate: 0.0, s_rate: 1.0 }
        }
    }

    fn swinging(w: f64, zeta: f64, t: f64) -> Self {
        let u = w * ((1.0 - zeta) * (1.0 + zeta)).sqrt();
        let s = if u * t == 0.0 { t } else { (u * t).sin() / u };
        let (decay, c) = ((-zeta * w * t).exp(), (u * t).cos());
        Propagator {
            c: decay * (c + zeta * w * s),
            s: decay * s,
            c_rate: -decay * (w * (w * s)),
            s_rate: decay * (c - zeta * w * s),
        }
    }

    fn creeping(w: f64, zeta: f64, t: f64) -> Self {
        let r = (zeta - 1.0).sqrt() * (zeta + 1.0).sqrt();
        // Both rates in units of w; their product is one.
        let fast = zeta + r;
        let slow = fast.recip();
        let gap = 2.0 * r * w * t;
        let f = if gap == 0.0 { t } else { t * (-(-gap).exp_m1() / gap) };
        let decay = (-slow * w * t).exp();
        // 1 - w fast f, where that cancels by what is left of the fast decay.
        let rest =
            if gap < 0.7 { 1.0 - fast * w * f } else { ((-gap).exp() * fast - slow) / (2.0 * r) };
        Propagator {
            c: decay * (1.0 + slow * w * f),
            s: decay * f,
            c_rate: -decay * (w * (w * f)),
            s_rate: decay * rest,
        }
    }

    pub(crate) fn applied(self, x: f64, rate: f64) -> (f64, f64) {
        (self.c * x + self.s * rate, self.c_rate * x + self.s_rate * rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overdamped_mode_creeps_and_does_not_blow_up_at_any_time() {
        // w = 1: the slow rate is 1/(z + r), for large z one over 2 z.
        for (zeta, t) in [(1.0, 800.0), (2.0, 1e4), (1e3, 1e9), (1e8, 1e3), (1e8, 1e20)] {
            let p = Propagator::new(1.0, zeta, t);
            let numbers = [p.c, p.s, p.c_rate, p.s_rate];
            assert!(numbers.iter().all(|x| x.is_finite()), "{zeta} {t}: {numbers:?}");
        }
        let p = Propagator::new(1.0, 1e4, 2e4);
        assert!((p.c - (-1.0_f64).exp()).abs() < 1e-7, "{}", p.c);
        let exact = -(-1.0_f64).exp() / 2e4;
        assert!((p.c_rate / exact - 1.0).abs() < 1e-7, "{}", p.c_rate);
    }

    #[test]
    fn motion_is_continuous_where_swinging_becomes_creeping() {
        for t in [1e-3, 1.0, 30.0] {
            let [below, at, above] = [1.0 - 1e-12, 1.0, 1.0 + 1e-12].map(|zeta| {
                let p = Propagator::new(4.0, zeta, t);
                [p.c, p.s, p.c_rate, p.s_rate]
            });
            let w = 2.0;
            let exact = |c: f64| (-w * t).exp() * c;
            let critical = [exact(1.0 + w * t), exact(t), exact(-w * w * t), exact(1.0 - w * t)];
            for k in 0..4 {
                let size = critical[k].abs().max((-w * t).exp());
                for p in [below, at, above] {
                    assert!((p[k] - critical[k]).abs() < 1e-8 * size, "{t} {k}");
                }
                assert!((at[k] - critical[k]).abs() < 1e-14 * size, "{t} {k}");
            }
        }
    }

    #[test]
    fn two_half_times_make_one() {
        for (lambda, zeta) in
            [(2.0, 0.0), (2.0, 0.3), (2.0, 1.0), (2.0, 1.5), (2.0, 30.0), (-0.5, 0.0), (0.0, 0.0)]
        {
            let (half, whole) =
                (Propagator::new(lambda, zeta, 0.8), Propagator::new(lambda, zeta, 1.6));
            let (x, v) = half.applied(0.3, -1.1);
            let (twice, once) = (half.applied(x, v), whole.applied(0.3, -1.1));
            assert!((twice.0 - once.0).abs() < 1e-14 && (twice.1 - once.1).abs() < 1e-13);
        }
    }
}
