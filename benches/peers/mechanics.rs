//! Mechanical problems for every solver: ours on (q, p), theirs on y = (q, p) with the same force.

use std::array::from_fn;
use std::cell::Cell;
use std::ops::ControlFlow;

use diffsol::{NalgebraMat, OdeBuilder, OdeSolverMethod};
use ode_solvers::{Dop853, OutputType, SVector};
use stationary_calculus::{Covector, Metric, Potential, Vector};
use stationary_integrators::problems::Problem;
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, MechanicalField, Moment, Nystrom, NystromPair, NystromStep,
    Pair8, Pair12, Tolerance, integrate,
};

use crate::contest::{Contestant, Outcome};

/// A problem of N freedoms on the stack.
pub type Small<M, P, const N: usize> = Problem<M, P, [f64; N]>;

/// `y. = (M^-1 p, -dV(q))`, written for the peers; D is 2 N.
fn right_hand_side<M: Metric, P: Potential, const N: usize>(
    problem: &Small<M, P, N>,
    y: &[f64],
    dy: &mut [f64],
) {
    let (q, p) = y.split_at(N);
    let (dq, dp) = dy.split_at_mut(N);
    dp.fill(-0.0);
    problem.system.potential().add_differential(q, Covector(&mut *dp));
    dp.iter_mut().for_each(|x| *x = -*x);
    problem.system.metric().sharp(Covector(p), Vector(dq));
}

fn start<M, P, const N: usize>(problem: &Small<M, P, N>, i: usize) -> f64 {
    if i < N { problem.initial.q[i] } else { problem.initial.p.0[i - N] }
}

/// A pair of ours.
pub fn nystrom<T: NystromPair<S>, M: Metric, P: Potential, const N: usize, const S: usize>(
    problem: &Small<M, P, N>,
) -> Contestant<'_> {
    let run = |tolerance: f64| {
        let tolerance = Tolerance::new(tolerance, tolerance).ok()?;
        let mut nystrom = Nystrom::<T, M, P, _, S>::new(&problem.system, tolerance.into()).ok()?;
        let mut state = problem.initial.clone();
        let on = |_: NystromStep<'_, _, _>| ControlFlow::Continue(());
        let work = nystrom.run(&mut state, problem.horizon, on).ok()?;
        Some(Outcome { end: state.q.to_vec(), evaluations: work.evaluations })
    };
    Contestant { name: T::NAME, ours: true, run: Box::new(run) }
}

/// Our DOP853, on arrays on the stack; D is 2 N.
pub fn our_dop853<M: Metric, P: Potential, const N: usize, const D: usize>(
    problem: &Small<M, P, N>,
) -> Contestant<'_> {
    const { assert!(D == 2 * N) };
    let run = |tolerance: f64| {
        let tolerance = Tolerance::new(tolerance, tolerance).ok()?;
        let field = MechanicalField::new(&problem.system);
        let moment = Moment::new(0.0, from_fn::<_, D, _>(|i| start(problem, i)));
        let mut method = DormandPrince853::new(field, tolerance.into(), moment).ok()?;
        integrate(&mut method, problem.horizon, |_| ControlFlow::Continue(())).ok()?;
        let end = method.moment().y[..N].to_vec();
        Some(Outcome { end, evaluations: method.work().evaluations })
    };
    Contestant { name: "our dop853", ours: true, run: Box::new(run) }
}

/// The right-hand side as `ode_solvers` wants it.
struct Counted<'a, M, P, const N: usize> {
    problem: &'a Small<M, P, N>,
    evaluations: &'a Cell<u64>,
}

impl<M: Metric, P: Potential, const N: usize, const D: usize>
    ode_solvers::System<f64, SVector<f64, D>> for Counted<'_, M, P, N>
{
    fn system(&self, _t: f64, y: &SVector<f64, D>, dy: &mut SVector<f64, D>) {
        self.evaluations.set(self.evaluations.get() + 1);
        right_hand_side(self.problem, y.as_slice(), dy.as_mut_slice());
    }
}

/// `ode_solvers`' DOP853, on vectors on the stack; D is 2 N.
pub fn their_dop853<M: Metric, P: Potential, const N: usize, const D: usize>(
    problem: &Small<M, P, N>,
) -> Contestant<'_> {
    const { assert!(D == 2 * N) };
    let run = |tolerance: f64| {
        let evaluations = Cell::new(0);
        let y = SVector::<f64, D>::from_fn(|i, _| start(problem, i));
        let counted = Counted { problem, evaluations: &evaluations };
        let end = problem.horizon;
        // As its own defaults, with no bound on the steps and with no points of output but its own.
        let mut solver = Dop853::from_param(
            counted,
            0.0,
            end,
            end,
            y,
            tolerance,
            tolerance,
            0.9,
            0.0,
            0.333,
            6.0,
            end,
            0.0,
            u32::MAX,
            1000,
            OutputType::Sparse,
        );
        solver.integrate().ok()?;
        let end = solver.y_out().last()?.as_slice()[..N].to_vec();
        Some(Outcome { end, evaluations: evaluations.get() })
    };
    Contestant { name: "ode_solvers dop853", ours: false, run: Box::new(run) }
}

/// `diffsol`'s explicit method.
pub fn their_tsit45<M: Metric, P: Potential, const N: usize>(
    problem: &Small<M, P, N>,
) -> Contestant<'_> {
    let run = |tolerance: f64| {
        let evaluations = Cell::new(0);
        let stated = OdeBuilder::<NalgebraMat<f64>>::new()
            .rtol(tolerance)
            .atol([tolerance])
            .rhs(|y: &[f64], _p: &[f64], _t: f64, dy: &mut [f64]| {
                evaluations.set(evaluations.get() + 1);
                right_hand_side(problem, y, dy);
            })
            .init(
                |_p: &[f64], _t: f64, y: &mut [f64]| {
                    y.iter_mut().enumerate().for_each(|(i, y)| *y = start(problem, i));
                },
                2 * N,
            )
            .build()
            .ok()?;
        let mut solver = stated.tsit45().ok()?;
        solver.set_stop_time(problem.horizon).ok()?;
        while solver.state().t < problem.horizon {
            solver.step().ok()?;
        }
        let end = solver.state().y.batch_as_slice(0)[..N].to_vec();
        Some(Outcome { end, evaluations: evaluations.get() })
    };
    Contestant { name: "diffsol tsit45", ours: false, run: Box::new(run) }
}

/// Every solver on a problem, ours first; D is 2 N.
pub fn contestants<M: Metric, P: Potential, const N: usize, const D: usize>(
    problem: &Small<M, P, N>,
) -> [Contestant<'_>; 5] {
    [
        nystrom::<Pair12, _, _, N, 17>(problem),
        nystrom::<Pair8, _, _, N, 9>(problem),
        our_dop853::<_, _, N, D>(problem),
        their_dop853::<_, _, N, D>(problem),
        their_tsit45(problem),
    ]
}
