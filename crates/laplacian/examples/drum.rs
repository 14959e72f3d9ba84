//! The tones of a drum: eigenvalues of a disc with its rim held, and how far the mesh is off.
//!
//! `cargo run --example drum -p stationary-laplacian`

use stationary_laplacian::problems::disc;
use stationary_laplacian::{LaplacianError, lowest_modes};

fn main() -> Result<(), LaplacianError> {
    let (coarse, fine) = (disc(12)?, disc(24)?);
    let tones = |problem: &stationary_laplacian::problems::Spectral<2, 3>| {
        lowest_modes(&problem.domain, &problem.domain.galerkin()?, 8)
    };
    let (coarse_tones, fine_tones) = (tones(&coarse)?, tones(&fine)?);
    println!("{:>12} {:>12} {:>12} {:>9}", "exact", "12 rings", "24 rings", "order");
    let values = coarse_tones.values().iter().zip(fine_tones.values());
    for ((coarse, fine), exact) in values.zip(&fine.spectrum) {
        let order = ((coarse - exact) / (fine - exact)).log2();
        println!("{exact:12.6} {coarse:12.6} {fine:12.6} {order:9.3}");
    }
    let ratio = (fine_tones.values()[1] / fine_tones.values()[0]).sqrt();
    println!("the second tone is {ratio:.4} times the first; a drum's is 1.5933");
    Ok(())
}
