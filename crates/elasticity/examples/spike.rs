//! What happens where the ends of a spring meet: a spike, refused; a smooth strain, passed.
//!
//! `cargo run --example spike -p stationary-elasticity`

use stationary_calculus::Stencil;
use stationary_elasticity::{Spring, Strain};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for strain in [Strain::Cauchy, Strain::Green] {
        let spring = Spring::new([0, 1], 1.0, 1.0, strain)?;
        println!("{strain:?}");
        for length in [1e-1, 1e-4, 1e-8, 0.0] {
            let ends = [[0.0, 0.0], [0.6 * length, 0.8 * length]];
            let [fx, fy] = spring.differential(&ends)[1];
            println!(
                "  ends {length:7e} m apart: energy {:.4} J, dV = ({fx:.4}, {fy:.4}) N",
                spring.energy(&ends)
            );
        }
    }
    println!("with Cauchy strain the force keeps its size and loses its direction");
    Ok(())
}
