//! From a file to an inertia tensor, with whatever is wrong with the surface named on the way.
//!
//! `cargo run --example obj_to_inertia -p stationary-mesh -- FILE.obj`

use stationary_mesh::{ClosedSurface, MeshError, icosphere, read_obj};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = match std::env::args().nth(1) {
        Some(path) => read_obj(path)?.mesh,
        None => icosphere(0.1, 3)?,
    };
    let pieces = mesh.components().first_simplices.len();
    println!("{} vertices, {} triangles", mesh.vertices().len(), mesh.simplices().len());
    println!("{pieces} pieces, Euler characteristic {}", mesh.euler_characteristic());
    let surface = match ClosedSurface::new(mesh.clone()) {
        Err(error @ (MeshError::InsideOut(_) | MeshError::Inconsistent(_))) => {
            println!("{error}; turned");
            ClosedSurface::oriented(&mesh)?
        }
        surface => surface?,
    };
    let central = surface.moments().central().ok_or("the surface encloses nothing")?;
    println!("volume {:.6e} m^3, centre {:.6?} m", central.measure, central.about.as_slice());
    println!("inertia for a density of 1000 kg/m^3, in kg m^2:{:.4e}", central.inertia() * 1000.0);
    Ok(())
}
