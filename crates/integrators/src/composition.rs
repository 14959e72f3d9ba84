//! Compositions of kicks and drifts: symplectic methods of any even order.
//!
//! ```text
//! Phi_h = kick(b1 h) drift(a1 h) kick(b2 h) ... drift(a1 h) kick(b1 h)       or with drifts first
//! ```
//! `a b` the times of a [`Scheme`], palindromes, some of them negative: from order 3 on a
//! composition of kicks and drifts must go backward in part. Each is symplectic, symmetric and
//! explicit, and keeps linear and angular momentum to rounding, as kicks and drifts do.
//! Neighbouring kicks are made one, and the last kick's differential serves the next step's first.
//! Drifts cost next to nothing.
//!
//! The larger the backward part, the larger the error: at equal cost the triple jump's is some
//! thirty times that of Blanes and Moan's six stages (`at_equal_cost_the_optimized_schemes_win`).
//! Where the roles of kicks and drifts are exchanged the schemes named Nystrom lose their order:
//! `nystrom_schemes_lose_their_order_where_kicks_and_drifts_are_exchanged`. Source: Hairer, Lubich
//! and Wanner, Geometric Numerical Integration, V.3; see [`Scheme`].

use stationary_calculus::{Metric, Potential, SizeError, Storage, System};

use crate::scheme::{First, Scheme};
use crate::splitting::Splitting;
use crate::{Facts, Integrator, State, StepError, StepReport};

/// A composition of kicks and drifts with the coefficients of a [`Scheme`].
#[derive(Clone, Debug)]
pub struct Composition<'s, M, P, C> {
    splitting: Splitting<'s, M, P, C>,
    scheme: Scheme,
    first: First,
    times: Vec<f64>,
}

impl<'s, M: Metric, P: Potential, C: Storage> Composition<'s, M, P, C> {
    /// The composition on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>, scheme: Scheme) -> Result<Self, SizeError> {
        let (first, times) = scheme.times();
        Ok(Composition { splitting: Splitting::new(system)?, scheme, first, times })
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for Composition<'_, M, P, C> {
    fn facts(&self) -> Facts {
        self.scheme.facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let mut phase = self.splitting.begin(state, h)?;
        let pairs = self.times.as_chunks::<2>().0;
        // A palindrome of two flows in turn: an odd number of times, the last like the first.
        let last = self.times[0] * h;
        match self.first {
            First::Kick => {
                phase.kick_again(last);
                for (i, &[kick, drift]) in pairs.iter().enumerate() {
                    if i > 0 {
                        phase.kick(kick * h);
                    }
                    phase.drift(drift * h);
                }
                phase.kick_again(last);
            }
            First::Drift => {
                for &[drift, kick] in pairs {
                    phase.drift(drift * h);
                    phase.kick(kick * h);
                }
                phase.drift(last);
            }
        }
        phase.finish(state, h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{kepler, pendulum};
    use crate::{Horizon, StormerVerlet, deliver};
    use stationary_measure::loglog_slope;

    #[test]
    fn the_triple_jump_is_three_verlet_steps_two_forward_and_one_back() {
        let planet = kepler(0.3).unwrap();
        let h = 0.05;
        let outer = 1.0 / (2.0 - 2_f64.cbrt());
        let mut verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut jump = Composition::new(&planet.system, Scheme::TripleJump4).unwrap();
        let (mut a, mut b) = (planet.initial.clone(), planet.initial.clone());
        for _ in 0..100 {
            verlet.step(&mut a, outer * h).unwrap();
            // A step back is a step forward with the momentum reversed.
            a.p.0 = a.p.0.map(|p| -p);
            verlet.step(&mut a, (2.0 * outer - 1.0) * h).unwrap();
            a.p.0 = a.p.0.map(|p| -p);
            verlet.step(&mut a, outer * h).unwrap();
            jump.step(&mut b, h).unwrap();
            assert!((a.q[0] - b.q[0]).abs() < 1e-11 && (a.q[1] - b.q[1]).abs() < 1e-11);
        }
    }

    #[test]
    fn at_equal_cost_the_optimized_schemes_win() {
        let mut planet = kepler(0.6).unwrap();
        planet.horizon = planet.period;
        let error = |scheme: Scheme| {
            let mut method = Composition::new(&planet.system, scheme).unwrap();
            let steps = Horizon::divided(planet.horizon, 12_000 / u64::from(scheme.facts().stages));
            deliver(&planet, &mut method, steps.unwrap()).unwrap().error.unwrap()
        };
        let [jump, suzuki, blanes, nystrom] =
            [Scheme::TripleJump4, Scheme::Suzuki4, Scheme::BlanesMoan4, Scheme::BlanesMoanNystrom4]
                .map(error);
        assert!(jump > 2.0 * suzuki && suzuki > 5.0 * blanes, "{jump:e} {suzuki:e} {blanes:e}");
        assert!(blanes > nystrom, "{blanes:e} {nystrom:e}");
        let [yoshida, kahan, blanes, nystrom] =
            [Scheme::Yoshida6, Scheme::KahanLi6, Scheme::BlanesMoan6, Scheme::BlanesMoanNystrom6]
                .map(error);
        assert!(yoshida > kahan && kahan > blanes && blanes > nystrom, "order 6");
    }

    #[test]
    fn nystrom_schemes_lose_their_order_where_kicks_and_drifts_are_exchanged() {
        let swing = pendulum(2.0).unwrap();
        let order = |scheme: Scheme| {
            let points = [40, 57, 80, 113, 160].map(|steps| {
                let h = swing.period / f64::from(steps);
                let mut method = Composition::new(&swing.system, scheme).unwrap();
                method.first = match method.first {
                    First::Kick => First::Drift,
                    First::Drift => First::Kick,
                };
                let (mut state, mut error) = (swing.initial.clone(), 0.0_f64);
                for step in 1..=steps {
                    method.step(&mut state, h).unwrap();
                    error = error.max(swing.error(f64::from(step) * h, &state.q).unwrap());
                }
                (h, error)
            });
            loglog_slope(&points).unwrap()
        };
        let (nystrom, any) = (order(Scheme::BlanesMoanNystrom6), order(Scheme::BlanesMoan6));
        assert!((nystrom - 4.0).abs() < 0.3 && (any - 6.0).abs() < 0.3, "{nystrom} {any}");
    }
}
