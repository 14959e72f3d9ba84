//! What games do: push the angular velocity, add it to the quaternion, divide by the length.
//!
//! ```text
//! P <- P - h dV,     m <- m + h (m x w - dV),     w = I^-1 m          and forces beside dV
//! t <- t + h P/m,    q <- (q + h/2 q w) / |.|
//! ```
//! `m` angular momentum and `w` angular velocity in body axes, `q` the quaternion, `w` on its right
//! a quaternion without scalar part. Here for contrast: order 1, explicit, neither symmetric nor
//! symplectic for the rotation. The push across `m` lengthens it, so a free body gains angular
//! momentum and energy without bound; a fast one tumbles to pieces within seconds. Source: the
//! semi-implicit Euler step of game engines, as in Catto's talks.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Force, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

use crate::metric::body_momentum;
use crate::step::{accept, check_step};
use crate::{BodyMetric, BodySpace, Rotation};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "renormalized-euler",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Grows,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Below(2.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// The semi-implicit Euler step of games.
#[derive(Clone, Debug)]
pub struct RenormalizedEuler<'s, P, S, F = ()> {
    system: &'s System<BodyMetric<S>, P, S>,
    force: F,
    velocity: Vector<Vec<f64>>,
    differential: Covector<Vec<f64>>,
    next: State<Vec<f64>>,
}

impl<'s, P: Potential, S: BodySpace> RenormalizedEuler<'s, P, S> {
    /// The method on a system of bodies.
    ///
    /// # Errors
    /// None: vectors hold every system of bodies.
    pub fn new(system: &'s System<BodyMetric<S>, P, S>) -> Result<Self, SizeError> {
        RenormalizedEuler::under(system, ())
    }
}

impl<'s, P: Potential, S: BodySpace, F: Force> RenormalizedEuler<'s, P, S, F> {
    /// The method on a system of bodies under a force that no potential gives.
    ///
    /// # Errors
    /// A force of another size than the system's.
    pub fn forced(system: &'s System<BodyMetric<S>, P, S>, force: F) -> Result<Self, SizeError> {
        SizeError::check("the force's freedoms", system.dim(), force.dim())?;
        RenormalizedEuler::under(system, force)
    }

    fn under(system: &'s System<BodyMetric<S>, P, S>, force: F) -> Result<Self, SizeError> {
        let n = system.dim();
        Ok(RenormalizedEuler {
            system,
            force,
            velocity: Vector(vec![0.0; n]),
            differential: Covector(vec![0.0; n]),
            next: State::new(vec![0.0; system.space().stored(n)], Covector(vec![0.0; n])),
        })
    }
}

impl<P: Potential, S: BodySpace, F: Force> Integrator<Vec<f64>> for RenormalizedEuler<'_, P, S, F> {
    fn facts(&self) -> Facts {
        FACTS
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        check_step::<S>(state, self.system.dim(), h)?;
        self.next.clone_from(state);
        self.differential.clear();
        self.system.potential().add_differential(&state.q, self.differential.view_mut());
        self.next.p.add_scaled(-h, self.differential.view());
        if self.force.dim() > 0 {
            self.system.metric().sharp(state.p.view(), self.velocity.view_mut());
            self.differential.clear();
            let (v, f) = (self.velocity.view(), self.differential.view_mut());
            self.force.add_force(state.t, &state.q, v, f);
            self.next.p.add_scaled(h, self.differential.view());
        }
        for (i, body) in self.system.metric().bodies().iter().enumerate() {
            let old = body_momentum::<S>(state.p.components(), i);
            let pushed = body_momentum::<S>(self.next.p.components(), i);
            let m = pushed + h * old.cross(&body.angular_velocity(&old));
            let half = body.angular_velocity(&m) * (0.5 * h);
            let q = &mut self.next.q[S::STORED * i..][..S::STORED];
            let p = &mut self.next.p.components_mut()[S::FREEDOMS * i..][..S::FREEDOMS];
            for c in 0..S::TRANSLATION {
                q[c] += h * body.inverse_mass() * p[c];
            }
            p[S::TRANSLATION..].copy_from_slice(m.as_slice());
            let turned = added(&q[S::TRANSLATION..], &half);
            q[S::TRANSLATION..].copy_from_slice(&turned.quaternion());
        }
        accept(state, &mut self.next, h)?;
        Ok(StepReport { differentials: 1, ..StepReport::default() })
    }
}

/// `(q + q half) / |.|`
#[inline]
fn added(q: &[f64], half: &Vector3<f64>) -> Rotation {
    let (w, x) = (q[0], Vector3::new(q[1], q[2], q[3]));
    let (dw, dx) = (-x.dot(half), half * w + x.cross(half));
    Rotation::unchecked([w + dw, x.x + dx.x, x.y + dx.y, x.z + dx.z]).normalized()
}
