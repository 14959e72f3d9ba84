//! Steps of varying length that keep what makes symmetric methods good.
//!
//! ```text
//! rho_(n+1/2) = rho_n + G(q_n, v_n)/2        h = 1/rho_(n+1/2)       rho_0 = u(q_0)
//! rho_(n+1)   = rho_(n+1/2) + G(q_(n+1), v_(n+1))/2                 G = <du, v>/u
//! ```
//! `u(q)` the density of steps that is wished for, in steps a second, `du` its differential, `v`
//! velocity; `rho` the density that is used, which follows u (since `u. = <du, v>` and a step lasts
//! 1/u) and is part of the state. The map of (q, p, rho) is symmetric: with the momentum reversed
//! it returns (`reversed_in_time_it_returns_to_its_start`). On reversible systems energy errors
//! therefore stay bounded over long times, as with equal steps. Steps of length 1/u(q_n), chosen at
//! each step's start, spoil this: energy drifts
//! (`steps_chosen_at_their_start_let_the_energy_drift`).
//!
//! The method inside must be symmetric; the order is its own in the density's scale, and momenta
//! are kept as it keeps them. The whole is reversible but not symplectic. The times of the steps
//! follow from the motion and do not land on given ones. Each step costs one differential of u.
//! Source: Hairer and Soderlind 2005; Hairer, Lubich and Wanner, Geometric Numerical Integration,
//! VIII.3.2.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage, System, Vector};

use crate::integrator::zeros;
use crate::{Integrator, State, StepError, StepReport};

/// How many steps a second are wished for, as a function of the configuration.
pub trait StepDensity {
    /// The number of freedoms n.
    fn dim(&self) -> usize;

    /// The density u(q), in steps a second.
    fn density(&self, q: &[f64]) -> f64;

    /// Adds du(q) to `du`, which has n components and is zero.
    fn add_differential(&self, q: &[f64], du: Covector<&mut [f64]>);
}

/// A density `u = scale |V|^power`, for potentials that do not change their sign.
///
/// Under gravity the power 3/2 divides each encounter evenly: `|q|^(-3/2)` is one over the time
/// that a body at that distance needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PotentialPower<P> {
    /// The potential V.
    pub potential: P,
    /// The power.
    pub power: f64,
    /// Steps a second where |V| is 1 J.
    pub scale: f64,
}

impl<P: Potential> StepDensity for PotentialPower<P> {
    fn dim(&self) -> usize {
        self.potential.dim()
    }

    fn density(&self, q: &[f64]) -> f64 {
        self.scale * self.potential.energy(q).abs().powf(self.power)
    }

    fn add_differential(&self, q: &[f64], mut du: Covector<&mut [f64]>) {
        let factor = self.power * self.density(q) / self.potential.energy(q);
        self.potential.add_differential(q, du.view_mut());
        du.0.iter_mut().for_each(|du| *du *= factor);
    }
}

/// A symmetric method with steps that follow a density, reversibly.
#[derive(Clone, Debug)]
pub struct ReversibleSteps<'s, M, P, C, I, D> {
    system: &'s System<M, P>,
    method: I,
    density: D,
    /// rho, once it has begun.
    steps_a_second: Option<f64>,
    /// u and du at a configuration.
    at: Option<C>,
    u: f64,
    du: Covector<C>,
    velocity: Vector<C>,
}

impl<'s, M: Metric, P: Potential, C: Storage, I: Integrator<C>, D: StepDensity>
    ReversibleSteps<'s, M, P, C, I, D>
{
    /// A symmetric method on a system, and the density of its steps.
    ///
    /// # Errors
    /// [`SizeError`] for a storage or a density of another size than the system's.
    pub fn new(system: &'s System<M, P>, method: I, density: D) -> Result<Self, SizeError> {
        let n = system.dim();
        SizeError::check("the density's freedoms", n, density.dim())?;
        Ok(ReversibleSteps {
            system,
            method,
            density,
            steps_a_second: None,
            at: None,
            u: 0.0,
            du: Covector(zeros(n)?),
            velocity: Vector(zeros(n)?),
        })
    }

    /// The density rho that belongs to the state, once there was a step.
    pub fn steps_a_second(&self) -> Option<f64> {
        self.steps_a_second
    }

    /// Forgets the density, for a state that does not follow the last one.
    pub fn restart(&mut self) {
        self.steps_a_second = None;
    }

    /// Moves `state` forward by one step, whose length is that of the time that passed. On an error
    /// the state is as it was.
    ///
    /// # Errors
    /// [`StepError::Size`] for a state of another size; [`StepError::Density`] for a density that
    /// is not positive or moves no time; those of the method's own step.
    pub fn advance(&mut self, state: &mut State<C>) -> Result<StepReport, StepError> {
        SizeError::check("the configuration's numbers", self.system.dim(), state.q.as_ref().len())?;
        SizeError::check(
            "the momentum's components",
            self.system.dim(),
            state.p.components().len(),
        )?;
        let mut evaluations = 0;
        let growth = self.growth(state, &mut evaluations);
        let half_way = self.steps_a_second.unwrap_or(self.u) + 0.5 * growth;
        let h = half_way.recip();
        if !(half_way > 0.0 && h.is_finite() && state.t + h > state.t) {
            return Err(StepError::Density { density: half_way });
        }
        let mut report = self.method.step(state, h)?;
        let growth = self.growth(state, &mut evaluations);
        self.steps_a_second = Some(half_way + 0.5 * growth);
        report.differentials += evaluations;
        Ok(report)
    }

    /// G at a state: by how much the density wished for grows in one step.
    fn growth(&mut self, state: &State<C>, evaluations: &mut u32) -> f64 {
        if self.at.as_ref() != Some(&state.q) {
            self.u = self.density.density(state.q.as_ref());
            self.du.clear();
            self.density.add_differential(state.q.as_ref(), self.du.view_mut());
            match &mut self.at {
                Some(at) => at.clone_from(&state.q),
                None => self.at = Some(state.q.clone()),
            }
            *evaluations += 1;
        }
        self.system.metric().sharp(state.p.view(), self.velocity.view_mut());
        self.du.apply(&self.velocity) / self.u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{SmallProblem, kepler};
    use crate::{CentralGravity, StormerVerlet};
    use std::f64::consts::TAU;

    type Planet = SmallProblem<CentralGravity<2>, 2>;

    /// Steps evenly spread over an encounter: `scale |q|^(-3/2)` a second.
    fn density(planet: &Planet, scale: f64) -> PotentialPower<CentralGravity<2>> {
        PotentialPower { potential: *planet.system.potential(), power: 1.5, scale }
    }

    #[test]
    fn reversed_in_time_it_returns_to_its_start() {
        let planet = kepler(0.9).unwrap();
        let verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut steps =
            ReversibleSteps::new(&planet.system, verlet, density(&planet, 20.0)).unwrap();
        let mut state = planet.initial.clone();
        for _ in 0..1030 {
            steps.advance(&mut state).unwrap();
        }
        let away = state.q[0].hypot(state.q[1]);
        state.p.0 = state.p.0.map(|p| -p);
        for _ in 0..1030 {
            steps.advance(&mut state).unwrap();
        }
        let miss = (state.q[0] - planet.initial.q[0]).hypot(state.q[1] - planet.initial.q[1]);
        assert!(away > 0.2 && miss < 1e-9, "{away} {miss:e}");
    }

    #[test]
    fn the_density_that_is_used_follows_the_one_that_is_wished_for() {
        let planet = kepler(0.9).unwrap();
        let wished = density(&planet, 40.0);
        let verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut steps = ReversibleSteps::new(&planet.system, verlet, wished).unwrap();
        let mut state = planet.initial.clone();
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        while state.t < 10.0 * TAU {
            let before = state.t;
            steps.advance(&mut state).unwrap();
            (shortest, longest) = (shortest.min(state.t - before), longest.max(state.t - before));
            let ratio = steps.steps_a_second().unwrap() / wished.density(&state.q);
            assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        }
        assert!(longest > 50.0 * shortest, "{shortest} {longest}");
    }

    /// The largest error of the energy in the first and in the last tenth of a number of orbits.
    fn energy_errors(
        planet: &Planet,
        orbits: f64,
        mut advance: impl FnMut(&mut State<[f64; 2]>),
    ) -> [f64; 2] {
        let mut state = planet.initial.clone();
        let start = planet.energy(&state);
        let mut worst = [0.0_f64; 2];
        while state.t < orbits * TAU {
            advance(&mut state);
            let error = (planet.energy(&state) - start).abs();
            if state.t < 0.1 * orbits * TAU {
                worst[0] = worst[0].max(error);
            } else if state.t > 0.9 * orbits * TAU {
                worst[1] = worst[1].max(error);
            }
        }
        worst
    }

    #[test]
    fn steps_chosen_at_their_start_let_the_energy_drift() {
        for e in [0.9, 0.99] {
            let planet = kepler(e).unwrap();
            let wished = density(&planet, 30.0);
            let mut verlet = StormerVerlet::new(&planet.system).unwrap();
            let naive = energy_errors(&planet, 200.0, |state| {
                let h = wished.density(&state.q).recip();
                verlet.step(state, h).unwrap();
            });
            let verlet = StormerVerlet::new(&planet.system).unwrap();
            let mut steps = ReversibleSteps::new(&planet.system, verlet, wished).unwrap();
            let reversible = energy_errors(&planet, 200.0, |state| {
                steps.advance(state).unwrap();
            });
            assert!(naive[1] > 3.0 * naive[0], "{e}: {naive:?}");
            assert!(reversible[1] < 1.05 * reversible[0], "{e}: {reversible:?}");
            assert!(naive[1] > 10.0 * reversible[1], "{e}: {naive:?} {reversible:?}");
        }
    }

    #[test]
    fn a_density_that_gives_no_step_is_named_and_the_state_is_as_it_was() {
        let planet = kepler(0.9).unwrap();
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            let verlet = StormerVerlet::new(&planet.system).unwrap();
            let wished = density(&planet, scale);
            let mut steps = ReversibleSteps::new(&planet.system, verlet, wished).unwrap();
            let mut state = State { t: 1.0, ..planet.initial.clone() };
            let before = state.clone();
            let error = steps.advance(&mut state).unwrap_err();
            assert!(matches!(error, StepError::Density { .. }), "{scale}: {error}");
            assert_eq!(state, before);
        }
    }
}
