//! A block of rubber pressed flat between two plates, in steps, and the force that it takes.
//!
//! `cargo run --example pressed_block -p stationary-elasticity`

use stationary_elasticity::{
    DeadLoad, Freedoms, Held, Lame, LinearTetrahedron, NeoHookean, Solid, Statics, lumped_mass,
};
use stationary_mesh::cuboid;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let block = cuboid([1.0, 1.0, 1.0], [4, 4, 4])?;
    let rubber = NeoHookean::new(Lame::<3>::from_young_poisson(1e6, 0.45)?)?;
    // Both plates hold the block's faces fast.
    let mut held = Vec::new();
    for (vertex, x) in block.vertices().iter().enumerate() {
        if x.z == 0.0 || x.z == 1.0 {
            held.extend((0..3).map(|component| Held { vertex, component, place: x[component] }));
        }
    }
    let freedoms = Freedoms::new(block.vertices().len(), &held)?;
    let metric = lumped_mass(LinearTetrahedron, &block, [1e3, 1.0], &freedoms)?;
    let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; block.vertices().len()])?;
    let mut solid = Solid::new(LinearTetrahedron, &block, 1.0, rubber, freedoms.clone())?;
    let nodes: Vec<[f64; 3]> = block.vertices().iter().map(|&x| x.into()).collect();
    let mut q = freedoms.gathered(&nodes)?;

    println!("{:>8} {:>12} {:>14} {:>10}", "height", "force [N]", "Newton steps", "inverted");
    for percent in [10, 20, 30, 40, 50] {
        let height = 1.0 - f64::from(percent) / 100.0;
        let place = |held: &Held| {
            if held.component == 2 && held.place > 0.0 { height } else { held.place }
        };
        let places: Vec<f64> = held.iter().map(place).collect();
        let rest = Statics::default().solve(&mut solid, &none, &metric, &places, &mut q)?;
        let on_top = held.iter().zip(&rest.reactions);
        let push: f64 =
            on_top.filter(|(h, _)| h.component == 2 && h.place > 0.0).map(|(_, force)| force).sum();
        let inverted = solid.inverted(&q)?.len();
        println!("{height:8.2} {:12.0} {:14} {inverted:10}", -push, rest.iterations());
    }
    Ok(())
}
