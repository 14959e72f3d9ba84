//! Our solvers and other people's at equal final error, timed in turn.
//!
//! `cargo bench --bench peers --features peers` prints, for each problem and each error, the
//! tolerance that each solver needs for it, the error it then has, its evaluations, and the ratios of
//! times. The peers are the crates `ode_solvers` (DOP853) and `diffsol` (Tsitouras 5(4), BDF).

mod in_turn;
#[path = "peers/contest.rs"]
mod contest;
#[path = "peers/mechanics.rs"]
mod mechanics;
#[path = "peers/stiff.rs"]
mod stiff;

use contest::contest;
use mechanics::{Small, contestants, nystrom, their_dop853};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_integrators::problems::{Problem, kepler, pleiades, van_der_pol};
use stationary_integrators::{Pair12, State};
use stationary_scene::{ScenePotential, SceneProblem, problems::outer_solar_system};

/// The final errors at which solvers are compared, relative to a problem's scale.
const TARGETS: [f64; 2] = [1e-6, 1e-9];
/// A tolerance at which rounding is all that is left.
const TIGHT: f64 = 1e-14;

/// The sun and five planets, of 18 freedoms on the stack, with its force as the scene states it.
type Planets<'a> = Small<DiagonalMetric<[f64; 18]>, &'a ScenePotential, 18>;

fn on_the_stack(planets: &SceneProblem) -> Planets<'_> {
    let eighteen = |x: &[f64]| <[f64; 18]>::try_from(x).expect("18 freedoms");
    let masses = DiagonalMetric::new(eighteen(planets.system.metric().masses())).expect("masses");
    Problem {
        name: planets.name,
        system: System::new(masses, planets.system.potential()).expect("18 freedoms"),
        initial: State::new(eighteen(&planets.initial.q), Covector(eighteen(&planets.initial.p.0))),
        horizon: planets.horizon,
        period: planets.period,
        scale: planets.scale,
        solution: Box::new(|_| None),
        solution_error: f64::INFINITY,
    }
}

/// The distance of two configurations.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

fn main() {
    for e in [0.6, 0.9] {
        let planet = kepler(e).expect("an ellipse");
        let error = |q: &[f64]| {
            let q = q.try_into().expect("two freedoms");
            planet.error(planet.horizon, q).expect("known at every time")
        };
        for target in TARGETS {
            let name = format!("kepler, e = {e}");
            contest(&name, target, &error, &contestants::<_, _, 2, 4>(&planet));
        }
    }
    let stars = pleiades().expect("seven stars");
    let error = |q: &[f64]| {
        let q = q.try_into().expect("fourteen freedoms");
        stars.error(stars.horizon, q).expect("known at its end")
    };
    for target in TARGETS {
        contest(stars.name, target, &error, &contestants::<_, _, 14, 28>(&stars));
    }
    let planets = outer_solar_system().expect("the shipped scene");
    let planets = on_the_stack(&planets);
    // No closed form: a peer's tightest run, and how far ours is from it.
    let reference = (their_dop853::<_, _, 18, 36>(&planets).run)(TIGHT).expect("a reference");
    let ours = (nystrom::<Pair12, _, _, 18, 17>(&planets).run)(TIGHT).expect("a reference");
    let error = |q: &[f64]| distance(q, &reference.end) / planets.scale;
    println!("\n{}: two tight runs differ by {:.1e}", planets.name, error(&ours.end));
    for target in TARGETS {
        contest(planets.name, target, &error, &contestants::<_, _, 18, 36>(&planets));
    }
    let oscillator = van_der_pol(1000.0).expect("an oscillator");
    let error =
        |y: &[f64]| oscillator.error(y.try_into().expect("two numbers")).expect("known at its end");
    contest("van der pol, mu = 1000", TARGETS[0], &error, &stiff::contestants(&oscillator));
}
