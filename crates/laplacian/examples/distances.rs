//! How far it is around a stretched torus from two places, with what the distances are worth, and
//! what Delaunay edges do for it.
//!
//! `cargo run --example distances -p stationary-laplacian`

use nalgebra::Vector3;
use stationary_laplacian::{GeodesicDistance, LaplacianError};
use stationary_mesh::{IntrinsicSurface, torus};

fn main() -> Result<(), LaplacianError> {
    let torus = torus([2.0, 0.7], [60, 30])?;
    let mesh = torus.mapped(|x| Vector3::new(x.x, x.y, x.z + 1.5 * x.y))?;
    let mut surface = IntrinsicSurface::of(&mesh)?;
    report("edges of the mesh", &surface);
    let flips = surface.flip_to_delaunay()?;
    println!("{flips} edges flipped");
    report("Delaunay edges", &surface);
    Ok(())
}

fn report(name: &str, surface: &IntrinsicSurface) {
    let time = GeodesicDistance::advised_time(surface);
    let found = GeodesicDistance::new(surface, time).and_then(|mut heat| heat.from(&[0, 900]));
    match found {
        Err(error) => println!("{name}: {error}"),
        Ok(found) => {
            let farthest = found.distance.iter().copied().fold(0.0, f64::max);
            let estimate = found.estimate.iter().copied().fold(0.0, f64::max);
            println!(
                "{name}: the farthest point is {farthest:.3} m away, give or take {estimate:.3}"
            );
        }
    }
}
