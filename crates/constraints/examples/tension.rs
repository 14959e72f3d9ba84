//! What a rod carries: the tension of a pendulum that goes round, against its closed form.
//!
//! `cargo run -p stationary-constraints --example tension`

use stationary_constraints::problems::{RodProblem, pendulum};
use stationary_constraints::{ConstrainedIntegrator, ConstraintError, Dense, Rattle, Redundancy};

fn main() -> Result<(), ConstraintError> {
    let exact = pendulum(2.1)?;
    let RodProblem { system, rods, initial } = &exact.problem;
    let mut rattle = Rattle::new(system, rods.clone(), initial, Dense::<1>(Redundancy::Refuse))?;
    let mut state = initial.clone();
    let (steps, rod) = (1200, rods.rods()[0]);
    let h = exact.period / f64::from(steps);
    println!("{:>8} {:>10} {:>14} {:>10}", "t [s]", "angle", "tension [N]", "error");
    for step in 1..=steps {
        rattle.step(&mut state, h)?;
        if step % 100 == 0 {
            // The multipliers are those of the mean force: they belong to the middle of the step.
            let (tension, t) = (rod.tension(rattle.multipliers()[0]), state.t - 0.5 * h);
            let error = tension - exact.tension(t);
            println!("{t:8.3} {:10.4} {tension:14.6} {error:10.1e}", exact.angle(t));
        }
    }
    println!("at the top the rod pushes: a string would have gone slack");
    Ok(())
}
