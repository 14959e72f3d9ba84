//! Is the estimated error of a motion the true one, at every time at which it is said to be sure?
//!
//! ```text
//! 1/4 <= |estimate| / |truth - q| <= 4
//! ```

use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_integrators::{Horizon, Method, State, simulate_with_error};

use super::fixed_orders::{DOUBTS, TIMES, conservative, truth};
use super::runs::Forces;
use crate::{Draw, Verdict};

/// The estimate may be wrong by this factor.
const FACTOR: f64 = 4.0;
/// True errors below this part of the motion's size are rounding.
const ROUNDING: f64 = 1e-11;

/// Draws a method, a system and a step, and judges the estimate at sixteen times.
pub fn trial(draw: &mut Draw) -> Verdict {
    let method = draw.one_of(Method::ALL);
    let problem = conservative(draw);
    let between = draw.log_uniform(1.0, 200.0).round() as u64;
    draw.note(format!("{method}, {between} long steps between two of {TIMES} times"));
    let times: Vec<f64> = (1..=TIMES).map(|i| problem.end * i as f64 / TIMES as f64).collect();
    let Some((truth, doubt)) = truth((&problem, &problem.start), &times) else {
        return Verdict::not_judged("the reference does not reach the end");
    };
    let masses = problem.masses.clone().expect("mechanics");
    let metric = DiagonalMetric::new(masses).expect("masses");
    let system = System::new(metric, Forces(&problem)).expect("one size");
    let n = problem.start.len() / 2;
    let size = problem.sizes[..n].iter().map(|size| size * size).sum::<f64>().sqrt();
    let (q, p) = problem.start.split_at(n);
    let mut state = State::new(q.to_vec(), Covector(p.to_vec()));
    let horizon = Horizon::divided(problem.end, TIMES as u64 * between).expect("a horizon");
    let (mut worst, mut seen) = (None::<(f64, f64, f64)>, 0);
    let make = || method.integrator::<_, _, Vec<f64>>(&system);
    let run = simulate_with_error(make, &mut state, horizon, |now| {
        if now.step % between != 0 || !now.is_sure() {
            return ControlFlow::Continue(());
        }
        let truth = &truth[(now.step / between) as usize - 1][..n];
        let off = truth.iter().zip(&now.state.q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let off = off.sqrt();
        if off > (DOUBTS * doubt).max(ROUNDING) * size {
            let factor = (now.distance() / off).max(off / now.distance());
            seen += 1;
            if worst.is_none_or(|(before, ..)| factor > before) {
                worst = Some((factor, off / size, now.state.t));
            }
        }
        ControlFlow::Continue(())
    });
    match (run, worst) {
        // A step that is too long for an implicit method to be solved is an error by type.
        (Err(error), _) => Verdict::refused(error),
        (Ok(_), None) => Verdict::not_judged("no time at which the estimate is said to be sure"),
        (Ok(_), Some((factor, off, time))) => {
            let what = format!(
                "{method}: off by {off:.1e} at {time}, a factor of {factor:.2}, {seen} times"
            );
            Verdict::of(factor, FACTOR, &what)
        }
    }
}
