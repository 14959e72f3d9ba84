//! One pendulum, four ways: error and violation at the same step.
//!
//! `cargo run -p stationary-constraints --example four_ways`

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::problems::{Pendulum, RodProblem, pendulum};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedHamilton, ConstrainedIntegrator, Dense, Penalty, Rattle,
    Redundancy, StepAndProject,
};
use stationary_integrators::{Integrator, State, StormerVerlet};

type Place = [f64; 2];

/// Not at the bottom, where symmetry would flatter some.
const START: f64 = 0.7;

/// Error of the place and of the rod's length, at worst over a period.
fn worst(
    exact: &Pendulum,
    h: f64,
    mut step: impl FnMut(&mut State<Place>) -> Result<(), Box<dyn std::error::Error>>,
) -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let mut state = exact.state(START);
    let mut worst = [0.0_f64; 2];
    while state.t < START + exact.period {
        step(&mut state)?;
        worst[0] = worst[0].max(exact.error(state.t, &state.q));
        worst[1] = worst[1].max((state.q[0].hypot(state.q[1]) - 1.0).abs());
    }
    println!("  h = {h:<8} error {:9.2e}   violation {:9.2e}", worst[0], worst[1]);
    Ok(worst)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let exact = pendulum(1.5)?;
    let RodProblem { system, rods, .. } = &exact.problem;
    let initial = &exact.state(START);
    let few = Dense::<1>(Redundancy::Refuse);
    println!("reduced coordinates");
    let angle = ArcsinePendulum::new(1.0, 1.0, 1.0)?;
    let mut reduced = State::new([exact.angle(START)], Covector([exact.rate(START)]));
    reduced.t = START;
    worst(&exact, 0.01, |state| {
        angle.step(&mut reduced, 0.01)?;
        (state.t, state.q) = (reduced.t, [reduced.q[0].sin(), -reduced.q[0].cos()]);
        Ok(())
    })?;
    println!("penalty, k = 10,000 N/m");
    let spring = Penalty::new(rods.clone(), 1e4, 0.0)?;
    let stiff = System::new(DiagonalMetric::new([1.0; 2])?, (system.potential().clone(), spring))?;
    let mut verlet = StormerVerlet::new(&stiff)?;
    worst(&exact, 0.01, |state| Ok(verlet.step(state, 0.01).map(|_| ())?))?;
    println!("step and project");
    let verlet = StormerVerlet::new(system)?;
    let mut project = StepAndProject::new(verlet, system, rods.clone(), initial, few)?;
    worst(&exact, 0.01, |state| Ok(project.step(state, 0.01).map(|_| ())?))?;
    println!("constrained Hamilton principle");
    let mut hamilton = ConstrainedHamilton::new(system, rods.clone(), initial, few)?;
    worst(&exact, 0.01, |state| Ok(hamilton.step(state, 0.01).map(|_| ())?))?;
    println!("RATTLE");
    let mut rattle = Rattle::new(system, rods.clone(), initial, few)?;
    worst(&exact, 0.01, |state| Ok(rattle.step(state, 0.01).map(|_| ())?))?;
    Ok(())
}
