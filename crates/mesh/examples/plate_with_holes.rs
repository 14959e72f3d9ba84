//! A plate with a hole and an island in it: area, centre, polar moment, and a mistake's name.
//!
//! `cargo run --example plate_with_holes -p stationary-mesh`

use nalgebra::Vector2;
use stationary_mesh::{MeshError, Polygon};

fn square(corner: [f64; 2], side: f64) -> Vec<Vector2<f64>> {
    let offsets = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    offsets.map(|offset| Vector2::from(corner) + Vector2::from(offset) * side).to_vec()
}

fn main() -> Result<(), MeshError> {
    let outlines = vec![square([2.0, 2.0], 1.0), square([1.0, 1.0], 3.0), square([0.0, 0.0], 6.0)];
    let plate = Polygon::new(outlines)?;
    println!("depths of the outlines: {:?}", plate.depths());
    let moments = plate.moments();
    println!("area {} m^2", moments.measure);
    if let Some(central) = moments.central() {
        println!("centre {:.4?} m, tr C {:.4} m^4", central.about.as_slice(), central.polar());
    }
    for point in [[0.5, 0.5], [1.5, 1.5], [2.5, 2.5]] {
        println!("{point:?} is in the plate: {}", plate.contains(&point.into()));
    }

    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
    match Polygon::new(vec![bow.to_vec()]) {
        Ok(_) => println!("a bow tie is a plate"),
        Err(error) => println!("a bow tie: {error}"),
    }
    Ok(())
}
