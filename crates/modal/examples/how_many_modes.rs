//! How many modes does an answer need? Few under a load that reaches far, many under one at a point.
//!
//! `cargo run -p stationary-modal --example how_many_modes`

use stationary_calculus::Covector;
use stationary_modal::problems::fixed_chain;
use stationary_modal::{Linearized, ModalError, RigidMotions};

fn main() -> Result<(), ModalError> {
    let problem = fixed_chain(199)?;
    let mut near_rest = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12)?;
    let modes = near_rest.lowest(100, &RigidMotions::none())?;
    let middle: Vec<f64> = (0..199).map(|i| if i == 99 { 1.0 } else { 0.0 }).collect();
    for (name, load) in [("everywhere", vec![0.01; 199]), ("in the middle", middle.clone())] {
        let answer = near_rest.answer(&modes, Covector(&load), Covector(&middle))?;
        println!("pushed {name}, the middle moves by {:.4} m", answer.whole);
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            match answer.least_modes(tolerance) {
                Some(least) => println!("  to {tolerance:e}: {least} modes of 199"),
                None => println!("  to {tolerance:e}: more than {}", modes.len()),
            }
        }
    }
    Ok(())
}
