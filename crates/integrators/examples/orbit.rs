//! One planet, every method: ten years, two thousand steps a year, and what is left of the orbit.
//!
//! `cargo run --example orbit -p stationary-integrators`

use stationary_integrators::problems::kepler;
use stationary_integrators::{Horizon, Method, deliver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let planet = kepler(0.6)?;
    println!("{:30} {:>10} {:>12} {:>14}", "method", "error", "energy error", "differentials");
    for method in Method::TABLE_4_1 {
        let mut integrator = method.integrator(&planet.system)?;
        let steps = Horizon::divided(planet.horizon, 20_000)?;
        match deliver(&planet, &mut *integrator, steps) {
            Ok(run) => println!(
                "{:30} {:10.1e} {:12.1e} {:14}",
                method.facts().name,
                run.error.unwrap_or(f64::NAN),
                run.energy_error,
                run.cost.differentials
            ),
            Err(error) => println!("{:30} failed at t = {:.2}", method.facts().name, error.time),
        }
    }
    Ok(())
}
