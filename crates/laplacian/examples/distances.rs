//! How far it is around a stretched torus from two places: by heat, with what that is off, and by
//! shortest paths.
//!
//! `cargo run --example distances -p stationary-laplacian`

use nalgebra::Vector3;
use stationary_laplacian::{GeodesicDistance, LaplacianError, ShortestPaths};
use stationary_mesh::{IntrinsicSurface, torus};

fn main() -> Result<(), LaplacianError> {
    let torus = torus([2.0, 0.7], [60, 30])?;
    let mesh = torus.mapped(|x| Vector3::new(x.x, x.y, x.z + 1.5 * x.y))?;
    let surface = IntrinsicSurface::of(&mesh)?;
    let sources = [0, 900];
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);

    let time = GeodesicDistance::advised_time(&surface);
    let heat = GeodesicDistance::new(&surface, time)?.from(&sources)?;
    let (far, off) = (largest(&heat.distance), largest(&heat.estimate));
    println!("by heat the farthest point is {far:.3} m away, give or take {off:.3}");

    let exact = ShortestPaths::new(&surface).from(&sources)?;
    println!("it is {:.6} m away, by {} windows", largest(&exact.distance), exact.windows);
    Ok(())
}
