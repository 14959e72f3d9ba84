//! Steps of varying length that keep what makes symmetric methods good.
//!
//! ```text
//! rho_(n+1/2) = rho_n + G(q_n, v_n)/2        h = 1/rho_(n+1/2)       rho_0 = u(q_0)
//! rho_(n+1)   = rho_(n+1/2) + G(q_(n+1), v_(n+1))/2                 G = <du, v>/u
//! ```
//! `u(q)` the density of steps that is wished for, in steps a second, `du` its differential, `v`
//! velocity; `rho` the density that is used, which follows u (since `u. = <du, v>` and a step lasts
//! 1/u) and is part of the state. The map of (q, p, rho) is symmetric: with the momentum reversed it
//! returns (`reversed_in_time_it_returns_to_its_start`). On reversible systems energy errors therefore
//! stay bounded over long times, as with equal steps. Steps of length 1/u(q_n), chosen at each
//! step's start, spoil this: energy drifts (`steps_chosen_at_their_start_let_the_energy_drift`).
//!
//! The method inside must be symmetric; the order is its own in the density's scale, and momenta are
//! kept as it keeps them. The whole is reversible but not symplectic. The times of the steps follow
//! from the motion and do not land on given ones. Each step costs one differential of u.
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
