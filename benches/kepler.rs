//! The cost of the types: every method on one planet, against the same loop over plain arrays.
//!
//! `cargo bench --bench kepler` prints nanoseconds a step, then ratios of runs taken in turn.

mod by_hand;
mod in_turn;

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use stationary_integrators::problems::kepler;
use stationary_integrators::{
    ExplicitEuler, ImplicitEuler, ImplicitMidpoint, Integrator, RungeKutta4, State, StormerVerlet,
    SymplecticEulerDriftKick, SymplecticEulerKickDrift, Trapezoid,
};

const STEPS: usize = 1000;
const H: f64 = 1e-3;

fn ours(integrator: &mut impl Integrator<[f64; 2]>, initial: &State<[f64; 2]>) {
    let mut state = black_box(initial.clone());
    for _ in 0..STEPS {
        if let Err(error) = integrator.step(&mut state, H) {
            panic!("{error}");
        }
    }
    black_box(state);
}

macro_rules! compare {
    ($criterion:ident, $($method:ident : $by_hand:ident),+) => {
        let planet = kepler(0.6).expect("a planet");
        let mut group = $criterion.benchmark_group("kepler");
        group.throughput(Throughput::Elements(STEPS as u64));
        $({
            let mut method = $method::new(&planet.system).expect("two freedoms");
            let mut typed = || ours(&mut method, &planet.initial);
            let by_hand = || {
                let mut planet = black_box((planet.initial.q, planet.initial.p.0));
                by_hand::run(&mut planet, H, STEPS, by_hand::$by_hand);
                black_box(planet);
            };
            group.bench_function(concat!(stringify!($by_hand), "/typed"), |b| b.iter(&mut typed));
            group.bench_function(concat!(stringify!($by_hand), "/by hand"), |b| b.iter(by_hand));
        })+
        group.finish();
        println!("\ntyped / by hand, median of pairs (quartiles)");
        $({
            let mut method = $method::new(&planet.system).expect("two freedoms");
            in_turn::ratio(
                stringify!($by_hand),
                || ours(&mut method, &planet.initial),
                || {
                    let mut planet = black_box((planet.initial.q, planet.initial.p.0));
                    by_hand::run(&mut planet, H, STEPS, by_hand::$by_hand);
                    black_box(planet);
                },
            );
        })+
    };
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    compare!(
        criterion,
        ExplicitEuler: explicit_euler,
        SymplecticEulerDriftKick: drift_kick,
        SymplecticEulerKickDrift: kick_drift,
        StormerVerlet: stormer_verlet,
        RungeKutta4: runge_kutta_4,
        ImplicitEuler: implicit_euler,
        Trapezoid: trapezoid,
        ImplicitMidpoint: implicit_midpoint
    );
    criterion.final_summary();
}
