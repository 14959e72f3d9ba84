//! Runge-Kutta of order 4 on poses, by Munthe-Kaas: the classical method in the algebra.
//!
//! ```text
//! R = R0 exp(u),    u. = T(u)^-1 w,     m. = m x w - dV        u = 0 at the start of each step
//! t. = P/m,         P. = -dV                            and forces beside the potential
//! ```
//! `u` a turn from the step's start, body axes; `w = I^-1 m` the angular velocity; `T` the right
//! Jacobian. The classical stages and weights act on (t, u, P, m), which is flat.
//! Order 4, explicit, four differentials a step; neither symmetric nor symplectic. The quaternion
//! needs no repair, but nothing else is kept: energy and angular momentum drift with h^5 t.
//! Source: Munthe-Kaas 1998.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Force, Metric, Potential, SizeError, System, Vector};
use stationary_integrators::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

use crate::metric::body_momentum;
use crate::right_jacobian_inverse;
use crate::step::{accept, check_step};
use crate::{BodyMetric, BodySpace};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "munthe-kaas-4",
    order: 4,
    stages: 4,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Decays,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Below(2.0 * std::f64::consts::SQRT_2),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// Runge-Kutta of order 4 on poses.
#[derive(Clone, Debug)]
pub struct MuntheKaas4<'s, P, S, F = ()> {
    system: &'s System<BodyMetric<S>, P, S>,
    outer: F,
    /// Where a stage is, seen from the start of the step.
    displacement: Vector<Vec<f64>>,
    velocity: Vector<Vec<f64>>,
    force: Covector<Vec<f64>>,
    /// The weighted sum of the velocities.
    path: Vector<Vec<f64>>,
    stage: State<Vec<f64>>,
    next: State<Vec<f64>>,
}

impl<'s, P: Potential, S: BodySpace> MuntheKaas4<'s, P, S> {
    /// The method on a system of bodies.
    ///
    /// # Errors
    /// None: vectors hold every system of bodies.
    pub fn new(system: &'s System<BodyMetric<S>, P, S>) -> Result<Self, SizeError> {
        MuntheKaas4::under(system, ())
    }
}

impl<'s, P: Potential, S: BodySpace, F: Force> MuntheKaas4<'s, P, S, F> {
    /// The method on a system of bodies under a force that no potential gives.
    ///
    /// # Errors
    /// A force of another size than the system's.
    pub fn forced(system: &'s System<BodyMetric<S>, P, S>, force: F) -> Result<Self, SizeError> {
        SizeError::check("the force's freedoms", system.dim(), force.dim())?;
        MuntheKaas4::under(system, force)
    }

    fn under(system: &'s System<BodyMetric<S>, P, S>, outer: F) -> Result<Self, SizeError> {
        let n = system.dim();
        let state = State::new(vec![0.0; system.space().stored(n)], Covector(vec![0.0; n]));
        Ok(MuntheKaas4 {
            system,
            outer,
            displacement: Vector(vec![0.0; n]),
            velocity: Vector(vec![0.0; n]),
            force: Covector(vec![0.0; n]),
            path: Vector(vec![0.0; n]),
            stage: state.clone(),
            next: state,
        })
    }

    /// Evaluates the field at `stage` and adds it to the step with this weight.
    fn add(&mut self, weight: f64) {
        let MuntheKaas4 { system, outer, displacement, velocity, force, stage, .. } = self;
        system.metric().sharp(stage.p.view(), velocity.view_mut());
        force.clear();
        system.potential().add_differential(&stage.q, force.view_mut());
        force.0.iter_mut().for_each(|f| *f = -*f);
        outer.add_force(stage.t, &stage.q, velocity.view(), force.view_mut());
        for body in 0..system.metric().bodies().len() {
            let turn = S::FREEDOMS * body + S::TRANSLATION..S::FREEDOMS * (body + 1);
            let three = |v: &[f64]| Vector3::new(v[0], v[1], v[2]);
            let (w, u) = (three(&velocity.0[turn.clone()]), three(&displacement.0[turn.clone()]));
            let gyroscopic = body_momentum::<S>(&stage.p.0, body).cross(&w);
            for (f, g) in force.0[turn.clone()].iter_mut().zip(gyroscopic.iter()) {
                *f += g;
            }
            velocity.0[turn].copy_from_slice((right_jacobian_inverse(&u) * w).as_slice());
        }
        self.path.add_scaled(weight, self.velocity.view());
        self.next.p.add_scaled(weight, self.force.view());
    }

    /// Puts `stage` at the start moved along the field evaluated last.
    fn place(&mut self, start: &State<Vec<f64>>, h: f64) {
        self.displacement.clear();
        self.displacement.add_scaled(h, self.velocity.view());
        self.stage.clone_from(start);
        self.stage.t = start.t + h;
        self.system.space().advance(&mut self.stage.q, 1.0, self.displacement.view());
        self.stage.p.add_scaled(h, self.force.view());
    }
}

impl<P: Potential, S: BodySpace, F: Force> Integrator<Vec<f64>> for MuntheKaas4<'_, P, S, F> {
    fn facts(&self) -> Facts {
        FACTS
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        check_step::<S>(state, self.system.dim(), h)?;
        self.stage.clone_from(state);
        self.next.clone_from(state);
        self.displacement.clear();
        self.path.clear();
        self.add(h / 6.0);
        self.place(state, h / 2.0);
        self.add(h / 3.0);
        self.place(state, h / 2.0);
        self.add(h / 3.0);
        self.place(state, h);
        self.add(h / 6.0);
        self.system.space().advance(&mut self.next.q, 1.0, self.path.view());
        accept(state, &mut self.next, h)?;
        Ok(StepReport { differentials: 4, ..StepReport::default() })
    }
}
