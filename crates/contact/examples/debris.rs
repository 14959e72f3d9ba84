//! Tumbling debris: which pieces come within a metre of each other in a minute? "Never" is a proof.
//!
//! `cargo run --example debris -p stationary-contact`

use nalgebra::Vector3;
use stationary_contact::{Closeness, RigidPath, Shape, rigid_bodies_that_meet};
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, RigidMotion, Rotation};

const PIECES: usize = 60;
const MINUTE: f64 = 60.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut random = SplitMix64::new(3);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| size * random.symmetric());
    let mut pieces = Vec::new();
    for _ in 0..PIECES {
        let half = vector(1.0).map(|x| 0.5 + x.abs());
        let start =
            RigidMotion { translation: vector(200.0), rotation: Rotation::exp(vector(2.0)) };
        let (velocity, spin) = (vector(3.0), vector(0.5));
        let path = RigidPath::straight(start, velocity * MINUTE, spin * MINUTE)?;
        pieces.push((Shape::cuboid(half.into())?, path));
    }
    let movers: Vec<_> = pieces.iter().map(|(shape, path)| (shape, path)).collect();
    let close = Closeness { thickness: 1.0, tolerance: 1e-6 };
    let hits = rigid_bodies_that_meet(&movers, close)?;
    for ([a, b], hit) in &hits {
        let [x, y] = hit.points;
        let (when, apart) = (MINUTE * hit.time, (y - x).norm());
        println!("{a:2} and {b:2} are {apart:.6} m apart at {when:6.3} s");
    }
    let pairs = PIECES * (PIECES - 1) / 2;
    println!("{} of {pairs} pairs; the others stay farther apart", hits.len());
    Ok(())
}
