//! A material of one's own: write its energy once, and check it on a mesh.
//!
//! `cargo run --example own_material -p stationary-elasticity`

use stationary_calculus::{Number, Potential, check_potential};
use stationary_elasticity::{AutomaticMaterial, Density, Freedoms, LinearTetrahedron, Solid};
use stationary_mesh::cuboid;

/// Mooney and Rivlin's rubber with a penalty on volume:
/// `W = c1 (I1 - 3 - 2 log J) + c2 (I2 - 3 - 4 log J) + k/2 (J - 1)^2`.
#[derive(Clone, Copy)]
struct MooneyRivlin {
    c1: f64,
    c2: f64,
    bulk: f64,
}

impl Density<3, 3> for MooneyRivlin {
    fn density<N: Number>(&self, f: [[N; 3]; 3]) -> N {
        let dot = |a: [N; 3], b: [N; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = |a: [N; 3], b: [N; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let areas = [cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])];
        let lengths = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
        let surfaces = dot(areas[0], areas[0]) + dot(areas[1], areas[1]) + dot(areas[2], areas[2]);
        let volume = dot(f[0], areas[0]);
        let growth = volume - 1.0;
        (lengths - volume.ln() * 2.0 - 3.0) * self.c1
            + (surfaces - volume.ln() * 4.0 - 3.0) * self.c2
            + growth * growth * (0.5 * self.bulk)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = cuboid([1.0, 0.5, 0.5], [2, 1, 1])?;
    let rubber = AutomaticMaterial(MooneyRivlin { c1: 0.3e6, c2: 0.1e6, bulk: 5e6 });
    let freedoms = Freedoms::<3>::free(mesh.vertices().len())?;
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms)?;
    for stretch in [0.8, 0.9, 1.0, 1.1, 1.2] {
        let side = f64::powf(stretch, -0.5);
        let q: Vec<f64> =
            mesh.vertices().iter().flat_map(|x| [stretch * x.x, side * x.y, side * x.z]).collect();
        println!("stretch {stretch:4.1}   energy {:10.2} J", solid.energy(&q));
    }
    let q: Vec<f64> = mesh.vertices().iter().flat_map(|x| [1.1 * x.x, x.y, 0.9 * x.z]).collect();
    println!("{}", check_potential(&solid, &q)?);
    Ok(())
}
