//! The stages of one Runge-Kutta-Nystrom step, and the distance between its two ends.
//!
//! ```text
//! u_i = h^2 M^-1 dV(q_i)                 q_i = q + c_i h v - sum_{j<i} a_ij u_j
//! ```
//! Everything is a displacement, in the unit of the configuration: what a stage's force moves the
//! system by within the step. So is the step's error. The metric enters once a stage, to turn dV
//! into `u`, and once a step, to turn a sum of them back into momentum.
//!
//! Each stage is compiled by itself, so that its coefficients are constants in the code and those
//! that are zero leave no trace; it adds the last stage's displacement last, so that the sum waits
//! for nothing else. All memory is lent by value for the length of a run: a small state stays in
//! registers.

use std::array;

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage, System, Vector};

use super::NystromPair;
use crate::State;
use crate::first_order::ErrorScale;
use crate::integrator::zeros;

/// The memory of a step.
#[derive(Clone, Debug)]
pub(super) struct Stages<C, const S: usize> {
    /// dV at the start of the step.
    pub first: Covector<C>,
    /// dV at the end of the step.
    pub last: Covector<C>,
    /// The end of the step.
    pub next: State<C>,
    displacements: [Vector<C>; S],
    velocity: Vector<C>,
    sum: Vector<C>,
    stage: C,
}

impl<C: Storage, const S: usize> Stages<C, S> {
    pub fn new(n: usize) -> Result<Self, SizeError> {
        let zero: C = zeros(n)?;
        Ok(Stages {
            first: Covector(zero.clone()),
            last: Covector(zero.clone()),
            next: State::new(zero.clone(), Covector(zero.clone())),
            displacements: array::from_fn(|_| Vector(zero.clone())),
            velocity: Vector(zero.clone()),
            sum: Vector(zero.clone()),
            stage: zero,
        })
    }

    /// dV at the state that a run starts from.
    #[inline]
    pub fn begin<M: Metric, P: Potential>(&mut self, system: &System<M, P>, q: &C) {
        self.first.clear();
        system.potential().add_differential(q.as_ref(), self.first.view_mut());
    }

    /// From `state` to `next`, `h` seconds later. The first differential is known, and the last is
    /// where the pair has it for nothing.
    #[inline]
    pub fn advance<T: NystromPair<S>, M: Metric, P: Potential>(
        &mut self,
        system: &System<M, P>,
        state: &State<C>,
        h: f64,
    ) {
        const { assert!(S <= 17) };
        system.metric().drift(h, state.p.view(), self.velocity.view_mut());
        system.metric().drift(h * h, self.first.view(), self.displacements[0].view_mut());
        macro_rules! stages {
            ($($i:literal)+) => {
                $(if $i < S { self.stage::<T, M, P, $i>(system, &state.q, h); })+
            };
        }
        stages!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
        self.configuration(&state.q, 1.0, |j| T::B[j]);
        self.next.q.clone_from(&self.stage);
        self.sum(|j| T::B_MOMENTUM[j]);
        system.metric().flat(self.sum.view(), self.next.p.view_mut());
        let p = self.next.p.components_mut();
        let (n, per_second) = (p.len(), h.recip());
        for (p, before) in p.iter_mut().zip(&state.p.components()[..n]) {
            *p = before - per_second * *p;
        }
    }

    #[inline]
    fn stage<T: NystromPair<S>, M: Metric, P: Potential, const I: usize>(
        &mut self,
        system: &System<M, P>,
        q: &C,
        h: f64,
    ) {
        self.configuration(q, T::NODES[I], |j| if j < I { T::A[I][j] } else { 0.0 });
        self.last.clear();
        system.potential().add_differential(self.stage.as_ref(), self.last.view_mut());
        system.metric().drift(h * h, self.last.view(), self.displacements[I].view_mut());
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

    /// dV at the end of the step, in how many evaluations.
    #[inline]
    pub fn finish<T: NystromPair<S>, M: Metric, P: Potential>(
        &mut self,
        system: &System<M, P>,
    ) -> u64 {
        if T::FIRST_SAME_AS_LAST {
            return 0;
        }
        self.last.clear();
        system.potential().add_differential(self.next.q.as_ref(), self.last.view_mut());
        1
    }

    /// How far the step's two ends are apart, in units of what is tolerated: the larger one of the
    /// difference of the configurations and of what the difference of the velocities moves in `h`.
    #[inline]
    pub fn error<T: NystromPair<S>>(&mut self, state: &State<C>, scale: &ErrorScale<C>) -> f64 {
        self.sum(|j| T::ERROR[j]);
        let configuration = self.size(state, scale);
        self.sum(|j| T::ERROR_MOMENTUM[j]);
        configuration.max(self.size(state, scale))
    }

    /// The root mean square of `sum`, in units of what is tolerated there.
    #[inline(always)]
    fn size(&self, state: &State<C>, scale: &ErrorScale<C>) -> f64 {
        let u = self.sum.components();
        let n = u.len();
        let (before, after) = (&state.q.as_ref()[..n], &self.next.q.as_ref()[..n]);
        let absolute = &scale.absolute.as_ref()[..n];
        let mut squares = 0.0;
        for k in 0..n {
            let tolerated = absolute[k] + scale.relative * before[k].abs().max(after[k].abs());
            squares += (u[k] / tolerated) * (u[k] / tolerated);
        }
        (squares / n as f64).sqrt()
    }

    /// A first step, from how fast the state moves: the shortest of the times in which velocity
    /// and acceleration move it by its own size, and in which acceleration changes the velocity by
    /// its own size, shortened as far as the tolerance lies below the motion in that time.
    pub fn first_step<T: NystromPair<S>, M: Metric, P: Potential>(
        &mut self,
        system: &System<M, P>,
        state: &State<C>,
        scale: &ErrorScale<C>,
        left: f64,
    ) -> f64 {
        self.next.q.clone_from(&state.q);
        self.sum.components_mut().copy_from_slice(state.q.as_ref());
        let size = self.size(state, scale);
        system.metric().sharp(state.p.view(), self.sum.view_mut());
        let speed = self.size(state, scale);
        system.metric().sharp(self.first.view(), self.sum.view_mut());
        let acceleration = self.size(state, scale);
        let times = [size / speed, (size / acceleration).sqrt(), speed / acceleration];
        let moves = times.into_iter().filter(|time| *time > 0.0 && time.is_finite());
        let time = moves.fold(f64::INFINITY, f64::min);
        if time == f64::INFINITY {
            return left;
        }
        let motion = (speed * time).max(acceleration * time * time).max(1.0);
        (time * motion.powf(-1.0 / f64::from(T::ORDERS.1 + 1))).min(left)
    }
}

#[cfg(test)]
mod tests {
    use stationary_calculus::loglog_slope;

    use super::*;
    use crate::problems::kepler;
    use crate::{Pair8, Pair12};

    /// The largest error along an orbit in this many equal steps. It is nearly a circle: on a long
    /// ellipse a method of order 12 meets rounding before its error follows a power of the step.
    fn error_in_equal_steps<T: NystromPair<S>, const S: usize>(steps: u32) -> f64 {
        let problem = kepler(0.05).unwrap();
        let mut stages = Stages::<[f64; 2], S>::new(2).unwrap();
        let mut state = problem.initial.clone();
        let h = problem.period / f64::from(steps);
        let mut worst = 0.0_f64;
        for step in 1..=steps {
            stages.begin(&problem.system, &state.q);
            stages.advance::<T, _, _>(&problem.system, &state, h);
            std::mem::swap(&mut state, &mut stages.next);
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
