//! A plate that is warm at one side and cold at the other, and a spot that cools between them.
//!
//! `cargo run --example cooling_plate -p stationary-laplacian`

use stationary_laplacian::{
    Domain, Elements, Heat, HeatMethod, LaplacianError, harmonic, largest_eigenvalue,
};
use stationary_mesh::{Diagonals, rectangle};

fn main() -> Result<(), LaplacianError> {
    let mesh = rectangle([1.0, 0.5], [40, 20], Diagonals::Alternating)?;
    let sides = mesh.vertices().iter().enumerate().filter(|(_, x)| x.x == 0.0 || x.x == 1.0);
    let held: Vec<(usize, f64)> = sides.map(|(vertex, x)| (vertex, 20.0 * x.x)).collect();
    let domain = Domain::held(Elements::of(&mesh)?, &held)?;
    let rest = domain.on_freedoms(&harmonic(&domain)?)?;

    let alpha = 1e-4; // m^2/s, about that of copper
    let mass = domain.lumped()?;
    let border = 2.0 / (alpha * largest_eigenvalue(&mass, domain.dirichlet())?);
    println!("explicit steps must be shorter than {border:.2} s; these are 10 s");

    let mut heat = Heat::new(&mass, domain.dirichlet(), HeatMethod::ImplicitEuler, alpha, 10.0)?;
    let spot = |vertex: &usize| (mesh.vertices()[*vertex].x - 0.5).abs() < 0.1;
    let start = domain.free_vertices().iter().zip(&rest);
    let mut f: Vec<f64> =
        start.map(|(vertex, rest)| if spot(vertex) { 100.0 } else { *rest }).collect();
    for minute in 0..=10 {
        let above = f.iter().zip(&rest).map(|(f, rest)| f - rest).fold(0.0, f64::max);
        println!("{minute:>3} min: at most {above:7.3} degrees above the steady state");
        for _ in 0..6 {
            heat.step(&mut f)?;
        }
    }
    Ok(())
}
