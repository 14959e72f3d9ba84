//! The lowest modes of a membrane, most of which come in pairs, and the proof that none is missing.
//!
//! `cargo run -p stationary-modal --example spectrum`

use stationary_modal::problems::membrane;
use stationary_modal::{Linearized, ModalError, RigidMotions};

fn main() -> Result<(), ModalError> {
    let problem = membrane(40)?;
    let mut near_rest = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12)?;
    let modes = near_rest.lowest(10, &RigidMotions::none())?;
    println!("lambda [1/s^2]   exact            may be off by");
    for ((lambda, exact), off) in
        modes.values().iter().zip(&problem.spectrum).zip(modes.residuals())
    {
        println!("{lambda:.12}   {exact:.12}   {off:.0e}");
    }
    let limit = modes.complete_below();
    println!("below {limit:.12} there are {} modes", near_rest.count_below(limit)?);
    Ok(())
}
