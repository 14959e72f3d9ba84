//! The stages of one Runge-Kutta-Nystrom step, and the distance between its two ends.
//!
//! ```text
//! u_i = h^2 M^-1 dV(q_i)                 q_i = q + c_i h v - sum_{j<i} a_ij u_j
//! ```
//! Everything is a displacement, in the unit of the configuration: what a stage's force moves the
//! system by within the step. The metric enters once a stage, to turn dV into `u`, and once a sum of
//! them, to turn it back into momentum.
//!
//! Each stage is compiled by itself, so that its coefficients are constants in the code and those
//! that are zero leave no trace; it adds the last stage's displacement last, so that the sum waits
//! for nothing else.

use std::array;
use std::marker::PhantomData;

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage, System, Vector};

use super::NystromPair;
use crate::State;
use crate::first_order::{CLOCK, ErrorScale};
use crate::integrator::zeros;

/// The memory of a step of the pair `T` on a system, which computes it.
#[derive(Clone, Debug)]
pub struct NystromStages<'s, T, M, P, C, const S: usize> {
    pub(super) system: &'s System<M, P>,
    /// dV at the last stage.
    pub(super) differential: Covector<C>,
    displacements: [Vector<C>; S],
    velocity: Vector<C>,
    sum: Vector<C>,
    momentum: Covector<C>,
    stage: C,
    pair: PhantomData<T>,
}

/// What is tolerated of the configuration and of the momentum.
#[derive(Clone, Debug)]
pub(super) struct Tolerated<C> {
    pub configuration: ErrorScale<C>,
    pub momentum: ErrorScale<C>,
}

impl<'s, T, M, P, C, const S: usize> NystromStages<'s, T, M, P, C, S>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    C: Storage,
{
    pub(super) fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        let zero: C = zeros(system.dim())?;
        Ok(NystromStages {
            system,
            differential: Covector(zero.clone()),
            displacements: array::from_fn(|_| Vector(zero.clone())),
            velocity: Vector(zero.clone()),
            sum: Vector(zero.clone()),
            momentum: Covector(zero.clone()),
            stage: zero,
            pair: PhantomData,
        })
    }

    /// Writes dV(q).
    #[inline]
    pub(super) fn differential_at(&self, q: &C, dv: &mut Covector<C>) {
        dv.clear();
        self.system.potential().add_differential(q.as_ref(), dv.view_mut());
    }

    /// From `state`, where dV is `first`, to `next`, `h` seconds later.
    #[inline]
    pub(super) fn advance(
        &mut self,
        state: &State<C>,
        first: &Covector<C>,
        h: f64,
        next: &mut State<C>,
    ) {
        const { assert!(S <= 17) };
        let metric = self.system.metric();
        metric.drift(h, state.p.view(), self.velocity.view_mut());
        metric.drift(h * h, first.view(), self.displacements[0].view_mut());
        macro_rules! stages {
            ($($i:literal)+) => {
                $(if $i < S { self.stage::<$i>(&state.q, h); })+
            };
        }
        stages!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
        self.configuration(&state.q, 1.0, |j| T::B[j]);
        next.q.clone_from(&self.stage);
        self.sum(|j| T::B_MOMENTUM[j]);
        metric.flat(self.sum.view(), next.p.view_mut());
        let p = next.p.components_mut();
        let (n, per_second) = (p.len(), h.recip());
        for (p, before) in p.iter_mut().zip(&state.p.components()[..n]) {
            *p = before - per_second * *p;
        }
        next.t = state.t + h;
    }

    #[inline]
    fn stage<const I: usize>(&mut self, q: &C, h: f64) {
        self.configuration(q, T::NODES[I], |j| if j < I { T::A[I][j] } else { 0.0 });
        self.differential.clear();
        let dv = self.differential.view_mut();
        self.system.potential().add_differential(self.stage.as_ref(), dv);
        let u = self.displacements[I].view_mut();
        self.system.metric().drift(h * h, self.differential.view(), u);
    }

    /// `stage = q + c h v - sum_j w_j u_j`.
    #[inline(always)]
    fn configuration(&mut self, q: &C, c: f64, weight: impl Fn(usize) -> f64) {
        let stage = self.stage.as_mut();
        let n = stage.len();
        let (q, v) = (&q.as_ref()[..n], &self.velocity.components()[..n]);
        let u: [&[f64]; S] = array::from_fn(|j| &self.displacements[j].components()[..n]);
        for k in 0..n {
            let mut total = q[k] + c * v[k];
            for (j, u) in u.iter().enumerate() {
                if weight(j) != 0.0 {
                    total -= weight(j) * u[k];
                }
            }
            stage[k] = total;
        }
    }

    /// `sum = sum_j w_j u_j`.
    #[inline(always)]
    fn sum(&mut self, weight: impl Fn(usize) -> f64) {
        let sum = self.sum.components_mut();
        let n = sum.len();
        let u: [&[f64]; S] = array::from_fn(|j| &self.displacements[j].components()[..n]);
        for k in 0..n {
            let mut total = 0.0;
            for (j, u) in u.iter().enumerate() {
                if weight(j) != 0.0 {
                    total += weight(j) * u[k];
                }
            }
            sum[k] = total;
        }
    }

    /// How far the ends of the step of `h` seconds from `state` to `next` are apart, in units of what
    /// is tolerated: the largest of the difference of the configurations, of what the difference of
    /// the velocities moves in `h`, and of the difference of the momenta.
    #[inline]
    pub(super) fn error(
        &mut self,
        state: &State<C>,
        next: &State<C>,
        h: f64,
        tolerated: &Tolerated<C>,
    ) -> f64 {
        let Tolerated { configuration, momentum } = tolerated;
        let (q, q_next) = (state.q.as_ref(), next.q.as_ref());
        self.sum(|j| T::ERROR[j]);
        let place = size(self.sum.components(), q, q_next, configuration);
        self.sum(|j| T::ERROR_MOMENTUM[j]);
        let moved = size(self.sum.components(), q, q_next, configuration);
        self.system.metric().flat(self.sum.view(), self.momentum.view_mut());
        let (p, p_next) = (state.p.components(), next.p.components());
        let kicked = size(self.momentum.components(), p, p_next, momentum) / h;
        // `max` ignores what is not a number, which this must not.
        let largest = place.max(moved).max(kicked);
        if (place + moved + kicked).is_nan() { f64::NAN } else { largest }
    }

    /// A first step, from how fast the state moves: the shortest of the times in which velocity
    /// and acceleration move it by its own size, and in which acceleration changes the velocity by
    /// its own size, shortened as far as the tolerance lies below the motion in that time. A place
    /// that is zero to the tolerance has no size, and no step is as short as the rounding of time.
    pub(super) fn first_step(
        &mut self,
        state: &State<C>,
        first: &Covector<C>,
        scale: &ErrorScale<C>,
    ) -> f64 {
        let q = state.q.as_ref();
        let size_of = |u: &[f64]| size(u, q, q, scale);
        let place = size_of(q);
        self.system.metric().sharp(state.p.view(), self.sum.view_mut());
        let speed = size_of(self.sum.components());
        self.system.metric().sharp(first.view(), self.sum.view_mut());
        let acceleration = size_of(self.sum.components());
        let crossed = if place > 1.0 { place / speed } else { 0.0 };
        let times = [crossed, (place / acceleration).sqrt(), speed / acceleration];
        let moves = times.into_iter().filter(|time| *time > 0.0 && time.is_finite());
        let time = moves.fold(f64::INFINITY, f64::min);
        if time == f64::INFINITY {
            return f64::MAX;
        }
        let motion = (speed * time).max(acceleration * time * time).max(1.0);
        let short = time * motion.powf(-1.0 / f64::from(T::ORDERS.1 + 1));
        short.max(CLOCK * state.t.abs())
    }
}

/// The root mean square of `u`, in units of what is tolerated between two states.
#[inline(always)]
fn size<C: Storage>(u: &[f64], before: &[f64], after: &[f64], scale: &ErrorScale<C>) -> f64 {
    let n = u.len();
    let (before, after) = (&before[..n], &after[..n]);
    let absolute = &scale.absolute.as_ref()[..n];
    let mut squares = 0.0;
    for k in 0..n {
        let tolerated = absolute[k] + scale.relative * before[k].abs().max(after[k].abs());
        squares += (u[k] / tolerated) * (u[k] / tolerated);
    }
    (squares / n.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use stationary_measure::loglog_slope;

    use super::*;
    use crate::problems::kepler;
    use crate::{Pair8, Pair12};

    /// The largest error along an orbit in this many equal steps. It is nearly a circle: on a long
    /// ellipse a method of order 12 meets rounding before its error follows a power of the step.
    fn error_in_equal_steps<T: NystromPair<S>, const S: usize>(steps: u32) -> f64 {
        let problem = kepler(0.05).unwrap();
        let mut stages = NystromStages::<T, _, _, [f64; 2], S>::new(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        let (mut next, mut first) = (state.clone(), Covector([0.0; 2]));
        let h = problem.period / f64::from(steps);
        let mut worst = 0.0_f64;
        for step in 1..=steps {
            stages.differential_at(&state.q, &mut first);
            stages.advance(&state, &first, h, &mut next);
            std::mem::swap(&mut state, &mut next);
            state.t = f64::from(step) * h;
            worst = worst.max(problem.error(state.t, &state.q).unwrap());
        }
        worst
    }

    /// The slope of the error over three decades or more, in steps of about 2^(1/4).
    fn order<T: NystromPair<S>, const S: usize>(coarsest: f64) -> f64 {
        let steps = (0..).map(|i| (coarsest * 2_f64.powf(0.25 * f64::from(i))).round() as u32);
        let errors = steps.map(|n| (1.0 / f64::from(n), error_in_equal_steps::<T, S>(n)));
        let errors: Vec<_> = errors.take_while(|&(_, error)| error > 1e-12).collect();
        assert!(errors[0].1 > 1e3 * errors[errors.len() - 1].1, "{errors:?}");
        loglog_slope(&errors).unwrap()
    }

    #[test]
    fn the_measured_order_is_the_claimed_one() {
        let (eight, twelve) = (order::<Pair8, 9>(11.0), order::<Pair12, 17>(5.0));
        assert!((eight - 8.0).abs() < 0.3 && (twelve - 12.0).abs() < 0.3, "{eight} {twelve}");
    }
}
