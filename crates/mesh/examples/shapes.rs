//! What the generators make, how good the shapes are, and how fast they approach the true volumes.
//!
//! `cargo run --example shapes -p stationary-mesh`

use std::f64::consts::PI;

use stationary_mesh::{Mesh, MeshError, Quality, ball, cuboid, curved_ball, cylinder};

fn main() -> Result<(), MeshError> {
    println!(
        "{:>12} {:>9} {:>10} {:>12} {:>12}",
        "shape", "elements", "mean ratio", "dihedral", ""
    );
    describe("box", &cuboid([1.0; 3], [6, 6, 6])?);
    describe("cylinder", &cylinder(0.5, 2.0, 4, 12)?);
    describe("ball", &ball(1.0, 3)?);

    println!("\nvolume of a ball, relative error");
    println!("{:>9} {:>12} {:>12}", "elements", "straight", "curved");
    let error = |volume: f64| (volume / (4.0 / 3.0 * PI) - 1.0).abs();
    for levels in 0..4 {
        let (straight, curved) = (ball(1.0, levels)?, curved_ball(1.0, levels)?);
        let count = straight.simplices().len();
        println!(
            "{count:>9} {:12.2e} {:12.2e}",
            error(straight.measure()),
            error(curved.measure())
        );
    }
    Ok(())
}

fn describe(name: &str, mesh: &Mesh<3, 4>) {
    let worst = mesh.quality(Quality::MeanRatio).into_iter().fold(1.0, f64::min);
    let small = mesh.quality(Quality::SmallestAngle).into_iter().fold(PI, f64::min).to_degrees();
    let large = mesh.quality(Quality::LargestAngle).into_iter().fold(0.0, f64::max).to_degrees();
    let count = mesh.simplices().len();
    println!("{name:>12} {count:>9} {worst:>10.3} {small:>8.1} to {large:.1} degrees");
}
