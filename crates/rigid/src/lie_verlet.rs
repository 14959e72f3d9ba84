//! Kick, turn freely, kick: Stormer-Verlet on poses.
//!
//! ```text
//! p  <- p - h/2 dV(q),   then + h/2 F        forces and torques
//! t  <- t + h P/m,   (R, m) <- turned        free motion, the rotation by a map of its own
//! p  <- p + h/2 F,       then - h/2 dV(q)
//! ```
//! `q = (t, R)` poses or orientations, `p = (P, m)` momenta, linear in world axes, angular in body
//! axes; `dV` in the same axes. The free rotation is a [`FreeRotation`]: with [`ConstantVelocity`]
//! this is the variational integrator of 9.5 with the potential shared by both ends of a step, with
//! [`AxisRotations`] it is explicit.
//!
//! Order 2, symmetric, symplectic; one differential a step. Keeps linear momentum, and spatial
//! angular momentum about any axis that the potential does not feel, to rounding; energy stays
//! within a bound that falls with h^2, while the turn of a step is small. The notes' own update
//! kicks once a step, at its later end: the same orientations, seen half a kick apart, and order 1
//! in the momenta. Source: notes 9.5; errata 5.5, 9.4.
//!
//! [`ConstantVelocity`]: crate::ConstantVelocity
//! [`AxisRotations`]: crate::AxisRotations

use std::marker::PhantomData;

use stationary_calculus::{Covector, Force, Potential, SizeError, System};
use stationary_constraints::ForceKicks;
use stationary_integrators::{Facts, Integrator, State, StepError, StepReport, Symplecticity};

use crate::free_bodies::move_freely;
use crate::free_rotation::FreeRotation;
use crate::step::{accept, check_step};
use crate::{BodyMetric, BodySpace};

/// Stormer-Verlet on poses, with a map for free rotation, under forces beside the potential.
#[derive(Clone, Debug)]
pub struct LieVerlet<'s, P, S, R, F = ()> {
    system: &'s System<BodyMetric<S>, P, S>,
    /// The configuration at which `differential` was evaluated.
    evaluated: Vec<f64>,
    differential: Covector<Vec<f64>>,
    kicks: ForceKicks<F>,
    next: State<Vec<f64>>,
    rotation: PhantomData<R>,
}

impl<'s, P: Potential, S: BodySpace, R: FreeRotation> LieVerlet<'s, P, S, R> {
    /// The method on a system of bodies.
    ///
    /// # Errors
    /// None: vectors hold every system of bodies.
    pub fn new(system: &'s System<BodyMetric<S>, P, S>) -> Result<Self, SizeError> {
        LieVerlet::under(system, ())
    }
}

impl<'s, P: Potential, S: BodySpace, R: FreeRotation, F: Force> LieVerlet<'s, P, S, R, F> {
    /// The method on a system of bodies under a force that no potential gives; its kicks are those of
    /// [`ForceKicks`].
    ///
    /// # Errors
    /// A force of another size than the system's.
    pub fn forced(system: &'s System<BodyMetric<S>, P, S>, force: F) -> Result<Self, SizeError> {
        SizeError::check("the force's freedoms", system.dim(), force.dim())?;
        LieVerlet::under(system, force)
    }

    /// The work of each thing that acts, in the last step that was made, joules.
    pub fn works(&self) -> &[f64] {
        self.kicks.works()
    }

    fn under(system: &'s System<BodyMetric<S>, P, S>, force: F) -> Result<Self, SizeError> {
        let n = system.dim();
        let stored = system.space().stored(n);
        Ok(LieVerlet {
            system,
            evaluated: Vec::with_capacity(stored),
            differential: Covector(vec![0.0; n]),
            kicks: ForceKicks::new(force),
            next: State::new(vec![0.0; stored], Covector(vec![0.0; n])),
            rotation: PhantomData,
        })
    }

    #[inline]
    fn kick(&mut self, h: f64, differentials: &mut u32) {
        if self.evaluated != self.next.q {
            self.differential.clear();
            self.system.potential().add_differential(&self.next.q, self.differential.view_mut());
            self.evaluated.clone_from(&self.next.q);
            *differentials += 1;
        }
        self.next.p.add_scaled(-h, self.differential.view());
    }
}

impl<P: Potential, S: BodySpace, R: FreeRotation, F: Force> Integrator<Vec<f64>>
    for LieVerlet<'_, P, S, R, F>
{
    fn facts(&self) -> Facts {
        unless_forced(R::FACTS, self.kicks.force())
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        check_step::<S>(state, self.system.dim(), h)?;
        self.next.clone_from(state);
        let mut differentials = 0;
        self.kick(0.5 * h, &mut differentials);
        let State { t, q, p } = &mut self.next;
        let (metric, interval) = (self.system.metric(), (*t, h));
        let solved = self.kicks.before(metric, interval, q, &mut p.view_mut())?;
        let report = move_freely::<S, R>(metric, h, q, p.components_mut())?;
        self.kicks.after(metric, interval, q, &mut p.view_mut());
        self.kick(0.5 * h, &mut differentials);
        accept(state, &mut self.next, h)?;
        self.kicks.accept();
        let hessians = report.hessians.max(solved);
        Ok(StepReport { differentials, hessians, ..report })
    }
}

/// Facts of a method where a force may act beside the potential: no symplectic map has friction.
pub(crate) fn unless_forced(facts: Facts, force: &impl Force) -> Facts {
    match force.dim() {
        0 => facts,
        _ => Facts { symplecticity: Symplecticity::No, ..facts },
    }
}
