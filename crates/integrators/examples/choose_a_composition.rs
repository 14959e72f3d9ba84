//! Which composition is cheapest at a given accuracy? Ten years of a planet, by counted
//! evaluations.
//!
//! `cargo run --example choose_a_composition -p stationary-integrators`

use stationary_integrators::problems::kepler;
use stationary_integrators::{Composition, Horizon, Scheme, deliver};

/// The evaluations that a scheme needs for an error, by steps that grow finer by a tenth.
fn cost(scheme: Scheme, error: f64) -> Result<Option<u64>, Box<dyn std::error::Error>> {
    let planet = kepler(0.6)?;
    let mut steps = 500.0;
    while steps < 3e5 {
        let mut method = Composition::new(&planet.system, scheme)?;
        let horizon = Horizon::divided(planet.horizon, steps as u64)?;
        if let Ok(run) = deliver(&planet, &mut method, horizon)
            && run.error.is_some_and(|reached| reached < error)
        {
            return Ok(Some(run.cost.differentials));
        }
        steps *= 1.1;
    }
    Ok(None)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("evaluations for a largest error of");
    println!("{:22} {:>5} {:>9} {:>9} {:>9}", "scheme", "order", "1e-3", "1e-6", "1e-9");
    for scheme in Scheme::ALL {
        print!("{:22} {:>5}", scheme.facts().name, scheme.facts().order);
        for error in [1e-3, 1e-6, 1e-9] {
            match cost(scheme, error)? {
                Some(evaluations) => print!(" {evaluations:>9}"),
                None => print!(" {:>9}", "too many"),
            }
        }
        println!();
    }
    Ok(())
}
