//! The cost of a step against the size of the system: a row of masses on springs.
//!
//! `cargo bench --bench size` prints nanoseconds a step and freedom from 100 to 1,000,000 freedoms,
//! and the power of the size that the time grows with: 1 where a step is linear in it, a little more
//! where the state no longer fits a cache.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use stationary_calculus::{Newton, SparseSolver};
use stationary_integrators::problems::{LargeProblem, SpringChain, spring_chain};
use stationary_integrators::{
    ImplicitMidpoint, Integrator, Nystrom12, RungeKutta4, State, StormerVerlet, Tolerance,
};
use stationary_measure::loglog_slope;

const SIZES: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
/// Freedoms times steps of one measurement, so that it takes some tens of milliseconds.
const WORK: usize = 3_000_000;
/// Measurements, of which the median counts.
const RUNS: usize = 7;
/// An eighth of the shortest period at k = 1.
const EXPLICIT: f64 = 0.4;
/// A step that does not resolve the fast modes.
const IMPLICIT: f64 = 4.0;

type Chain = LargeProblem<SpringChain>;

/// The median time of `steps` steps, each.
fn seconds_a_step(steps: usize, mut run: impl FnMut(usize)) -> f64 {
    run(1);
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run(steps);
            start.elapsed().as_secs_f64() / steps as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

fn fixed(mut integrator: impl Integrator<Vec<f64>>, chain: &Chain, h: f64) -> f64 {
    let mut state = chain.initial.clone();
    let steps = (WORK / state.q.len()).max(2);
    seconds_a_step(steps, |steps| {
        for _ in 0..steps {
            integrator.step(&mut state, h).expect("a step");
        }
        black_box(&state);
    })
}

fn adaptive(chain: &Chain) -> f64 {
    let tolerance = Tolerance::new(1e-6, 1e-6).expect("a tolerance");
    let mut nystrom = Nystrom12::new(&chain.system, tolerance.into()).expect("a chain");
    let mut state = chain.initial.clone();
    let steps = (WORK / 10 / state.q.len()).max(2) as u64;
    seconds_a_step(steps as usize, |steps| {
        let far = state.t + 1e3 * steps as f64;
        let until = |step: stationary_integrators::NystromStep<'_, _, _>| match step.number {
            number if number == steps as u64 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        nystrom.run(&mut state, far, until).expect("a run");
    })
}

fn report(name: &str, time: impl Fn(&Chain) -> f64) {
    let mut times = Vec::new();
    print!("{name:28}");
    for size in SIZES {
        let chain = spring_chain(size, 1.0).expect("a chain");
        let seconds = time(&chain);
        print!("{:12.2}", 1e9 * seconds / size as f64);
        times.push((size as f64, seconds));
    }
    println!("{:12.3}", loglog_slope(&times).expect("five sizes"));
}

fn main() {
    print!("{:28}", "ns a step and freedom");
    SIZES.iter().for_each(|size| print!("{size:12}"));
    println!("{:>12}", "power");
    report("stormer-verlet", |chain| {
        fixed(StormerVerlet::new(&chain.system).expect("a chain"), chain, EXPLICIT)
    });
    report("runge-kutta-4", |chain| {
        fixed(RungeKutta4::new(&chain.system).expect("a chain"), chain, EXPLICIT)
    });
    report("nystrom 12, adaptive", adaptive);
    report("implicit-midpoint, sparse", |chain| {
        let State { q, .. } = &chain.initial;
        let (metric, potential) = (chain.system.metric(), chain.system.potential());
        let solver = SparseSolver::new(metric, potential, q).expect("a chain");
        let midpoint = ImplicitMidpoint::with_solver(&chain.system, solver).expect("a chain");
        // The residual of a large system stagnates at rounding, above the usual tolerance.
        let newton = Newton { tolerance: 1e-12, iterations: 10 };
        fixed(midpoint.with_newton(newton).expect("a tolerance"), chain, IMPLICIT)
    });
}
