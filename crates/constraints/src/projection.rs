//! Projection in the mass metric: the closest feasible configuration, the closest feasible
//! velocity.
//!
//! ```text
//! min 1/2 |delta|_M^2   with  g(t, q~ exp(delta)) = 0      delta = -M^-1 J(q)^T lambda    (6.3)
//! min 1/2 |v - v~|_M^2  with  J v + dg/dt = 0                v = v~ - M^-1 J^T mu
//! ```
//! `q~` and `v~` what is given, `q` and `v` what comes out, `J` at q itself, so that delta is
//! normal there. Solved by Newton's method on the conditions for a minimum, without the
//! constraint's second differential: each iteration is one solve with `J M^-1 J^T`, and the error
//! shrinks by the curvature times the distance. From far away that is more than one, and the result
//! is an error, not a guess.
//!
//! Heavy particles move less than light ones: a Euclidean projection would push on both alike and
//! change linear momentum. Source: notes 6.3; errata 6.3 (velocities are projected as well).

use stationary_calculus::{
    Covector, Metric, Potential, SizeError, Space, Storage, System, Vector, first_non_finite,
};
use stationary_integrators::State;

use crate::checks::{check_sizes, check_state, zeros};
use crate::feasible::{Flight, Scales};
use crate::{Constraint, ConstraintError, ConstraintOn, Multipliers, Solver};

/// More iterations than this are a configuration too far away.
const ITERATIONS: u32 = 60;

/// Projects states onto a feasible set.
#[derive(Clone, Debug)]
pub struct Projection<'s, M, P, S, K, C, X: Multipliers> {
    system: &'s System<M, P, S>,
    constraint: K,
    pub(crate) scales: Scales,
    solver: X,
    given: C,
    pub(crate) displacement: Vector<C>,
    last: Vector<C>,
    force: Covector<C>,
    /// The multipliers of the configuration's displacement and of the velocity's impulse.
    pub(crate) lambda: X::Numbers,
    pub(crate) impulse: X::Numbers,
    rate: X::Numbers,
}

/// What a projection did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProjectionReport {
    /// Iterations towards the closest configuration, each one factorization.
    pub iterations: u32,
    /// The largest violation that is left, relative to its equation's length.
    pub violation: f64,
    /// How far the configuration was moved, in the mass metric: kg^1/2 m.
    pub distance: f64,
}

impl<'s, M, P, S, K, C, X> Projection<'s, M, P, S, K, C, X>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
{
    /// The projection of states of a system; `state` need not be feasible.
    ///
    /// # Errors
    /// Sizes that differ, numbers that are not finite, more equations than the solver has room for.
    pub fn new(
        system: &'s System<M, P, S>,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<Self, ConstraintError>
    where
        K: ConstraintOn<S>,
    {
        check_sizes(system, state)?;
        check_state(system.space(), state)?;
        let (n, stored) = (system.dim(), state.q.as_ref().len());
        let scales = Scales::new(&constraint, system.metric())?;
        let solver = choice.analyse(system.metric(), &constraint, state.t, state.q.as_ref())?;
        Ok(Projection {
            system,
            scales,
            constraint,
            given: zeros(stored)?,
            displacement: Vector(zeros(n)?),
            last: Vector(zeros(n)?),
            force: Covector(zeros(n)?),
            lambda: solver.numbers(),
            impulse: solver.numbers(),
            rate: solver.numbers(),
            solver,
        })
    }

    /// The constraint.
    pub fn constraint(&self) -> &K {
        &self.constraint
    }

    /// Moves a state to the closest feasible configuration, and its velocity to the closest that
    /// stays. The momentum's components are kept where the configuration moves.
    ///
    /// # Errors
    /// No feasible configuration found, or none with full rank; the state is then as it was.
    pub fn project(&mut self, state: &mut State<C>) -> Result<ProjectionReport, ConstraintError> {
        check_sizes(self.system, state)?;
        check_state(self.system.space(), state)?;
        let mut next = state.clone();
        let report = self.project_configuration(&mut next)?;
        self.project_velocity(&mut next)?;
        check_state(self.system.space(), &next)?;
        *state = next;
        Ok(report)
    }

    /// Moves the configuration; on an error it is where the iterations left it.
    pub(crate) fn project_configuration(
        &mut self,
        state: &mut State<C>,
    ) -> Result<ProjectionReport, ConstraintError> {
        let (t, q) = (state.t, &mut state.q);
        self.given.clone_from(q);
        self.displacement.clear();
        self.last.clear();
        let mut iterations = 0;
        let mut last = f64::INFINITY;
        let mut flight = Flight::default();
        loop {
            let change = self.change();
            let g = self.lambda.as_mut();
            self.constraint.value(t, q.as_ref(), g)?;
            if iterations > 0 {
                flight.check(
                    &self.scales,
                    (g, self.scales.largest_relative(g)),
                    self.solver.regularity(),
                )?;
            }
            let worst = self.scales.worst(g)?;
            flight.check(&self.scales, (g, self.scales.largest_relative(g)), None)?;
            let eps = self.scales.rounding(q.as_ref());
            let settled = iterations == ITERATIONS
                || change <= 0.25 * eps
                || (change > 0.5 * last && change <= 16.0 * eps);
            let done = if iterations == 0 { worst.distance == 0.0 } else { settled };
            if worst.excess <= eps && done {
                let violation = self.scales.largest_relative(g);
                return self.report(t, q, iterations, violation);
            }
            if iterations == ITERATIONS {
                let (violation, _) = self.scales.relative(worst.row, g, q.as_ref());
                return Err(ConstraintError::NotConverged {
                    iterations,
                    row: worst.row,
                    violation,
                });
            }
            last = change;
            self.improve(t, q)?;
            iterations += 1;
        }
    }

    /// How much the last iteration changed the displacement.
    fn change(&self) -> f64 {
        let pairs = self.displacement.components().iter().zip(self.last.components());
        let way = |(k, (a, b)): (usize, (&f64, &f64))| (a - b).abs() * self.scales.unit(k);
        pairs.enumerate().map(way).fold(0.0, f64::max)
    }

    /// One iteration: `S lambda = g - J delta`, `delta = -M^-1 J^T lambda`, from g in `lambda`.
    fn improve(&mut self, t: f64, q: &mut C) -> Result<(), ConstraintError> {
        let Projection { system, constraint, solver, displacement, last, force, lambda, .. } = self;
        solver.prepare(system.metric(), &*constraint, t, q.as_ref())?;
        let lambda = lambda.as_mut();
        last.copy_from(displacement.view());
        displacement.components_mut().iter_mut().for_each(|x| *x = -*x);
        solver.add_along(displacement.view(), lambda);
        solver.solve(lambda)?;
        force.clear();
        solver.add_pulled_back(-1.0, lambda, force.view_mut());
        system.metric().sharp(force.view(), displacement.view_mut());
        q.clone_from(&self.given);
        system.space().advance(q.as_mut(), 1.0, displacement.view());
        Ok(())
    }

    /// Prepares the solver where the configuration has come to rest.
    fn report(
        &mut self,
        t: f64,
        q: &C,
        iterations: u32,
        violation: f64,
    ) -> Result<ProjectionReport, ConstraintError> {
        let Projection { system, constraint, solver, displacement, force, lambda, .. } = self;
        solver.prepare(system.metric(), &*constraint, t, q.as_ref())?;
        system.metric().flat(displacement.view(), force.view_mut());
        // The multipliers of the displacement: -J M^-1 (M delta) = S lambda.
        let lambda = lambda.as_mut();
        lambda.fill(0.0);
        solver.add_along(displacement.view(), lambda);
        lambda.iter_mut().for_each(|x| *x = -*x);
        solver.solve(lambda)?;
        solver.share(lambda)?;
        let distance = force.apply(&*displacement).sqrt();
        Ok(ProjectionReport { iterations, violation, distance })
    }

    /// Takes away the part of the velocity that leaves; the solver must be prepared at q.
    pub(crate) fn project_velocity(&mut self, state: &mut State<C>) -> Result<(), ConstraintError> {
        let Projection { system, constraint, solver, last, impulse, .. } = self;
        let impulse = impulse.as_mut();
        system.metric().sharp(state.p.view(), last.view_mut());
        constraint.rate(state.t, state.q.as_ref(), impulse)?;
        solver.add_along(last.view(), impulse);
        solver.solve(impulse)?;
        solver.add_pulled_back(-1.0, impulse, state.p.view_mut());
        solver.share(impulse)?;
        match first_non_finite(state.p.components()) {
            Some(index) => Err(ConstraintError::NonFinite { what: "momentum", index }),
            None => Ok(()),
        }
    }

    /// An error unless the velocity stays on the feasible set; prepares the solver there.
    pub(crate) fn check_velocity(&mut self, state: &State<C>) -> Result<(), ConstraintError> {
        let Projection {
            system,
            constraint,
            solver,
            scales,
            last,
            displacement,
            force,
            impulse,
            ..
        } = self;
        let rates = impulse.as_mut();
        solver.prepare(system.metric(), &*constraint, state.t, state.q.as_ref())?;
        system.metric().sharp(state.p.view(), last.view_mut());
        constraint.rate(state.t, state.q.as_ref(), rates)?;
        solver.add_along(last.view(), rates);
        force.clear();
        system.potential().add_differential(state.q.as_ref(), force.view_mut());
        system.metric().sharp(force.view(), displacement.view_mut());
        scales.check_rates(rates, last.components(), displacement.components())
    }

    /// Adds the momentum of the displacement made in the time h: `M delta / h`.
    pub(crate) fn add_momentum_of_displacement(&mut self, h: f64, state: &mut State<C>) {
        self.system.metric().flat(self.displacement.view(), self.force.view_mut());
        state.p.add_scaled(h.recip(), self.force.view());
    }

    /// `<impulse, dg/dt>` of the last projections, made in the time h.
    pub(crate) fn work(&mut self, h: f64, state: &State<C>) -> Result<f64, SizeError> {
        let rate = self.rate.as_mut();
        self.constraint.rate(state.t, state.q.as_ref(), rate)?;
        let impulses = self.lambda.as_ref().iter().zip(self.impulse.as_ref());
        Ok(impulses.zip(rate).map(|((a, b), rate)| (a / h + b) * *rate).sum())
    }
}
