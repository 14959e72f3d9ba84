//! One spring pulled from half its length to twice: where the two strains agree, and where not.
//!
//! `cargo run --example stretch -p stationary-elasticity`

use stationary_calculus::{Curvature, Stencil};
use stationary_elasticity::{Spring, Strain};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cauchy = Spring::new([0, 1], 1.0, 1.0, Strain::Cauchy)?;
    let green = Spring::new([0, 1], 1.0, 1.0, Strain::Green)?;
    println!("k = 1 N/m, L = 1 m     force [N]             sideways stiffness [N/m]");
    println!("{:>10} {:>10} {:>10} {:>14} {:>10}", "length", "Cauchy", "Green", "Cauchy", "Green");
    for length in [0.01, 0.5, 0.9, 0.99, 1.0, 1.01, 1.1, 1.5, 2.0] {
        let x = [[0.0, 0.0], [length, 0.0]];
        let force = |spring: &Spring| spring.differential(&x)[1][0];
        let sideways = |spring: &Spring| spring.hessian(&x, Curvature::Exact)[1][1][1][1];
        println!(
            "{length:10} {:10.4} {:10.4} {:14.4} {:10.4}",
            force(&cauchy),
            force(&green),
            sideways(&cauchy),
            sideways(&green)
        );
    }
    println!("\na compressed spring wants to buckle: its sideways stiffness is negative");
    Ok(())
}
