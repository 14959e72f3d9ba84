//! A scene's elastic body in ten lines: a bar of rubber, clamped, loaded and damped, written for
//! ParaView where it comes to rest.
//!
//! `cargo run --example rubber_bar -p stationary-elasticity > rubber_bar.vtk`

use stationary_calculus::{Curvature, Force, Metric, Potential};
use stationary_elasticity::{
    DeadLoad, Elements, Freedoms, Held, Lame, LinearTetrahedron, NeoHookean, Solid, Statics,
    StrainRate, lumped_mass,
};
use stationary_mesh::{VtkField, cuboid, write_vtk};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Any mesh will do: a generator's, or a surface from an OBJ file with LinearTriangle.
    let bar = cuboid([4.0, 1.0, 1.0], [16, 4, 4])?;
    let rubber = NeoHookean::new(Lame::<3>::from_young_poisson(1e6, 0.4)?)?;
    let clamped = bar.vertices().iter().enumerate().filter(|(_, x)| x.x == 0.0);
    let hold = |(vertex, x): (usize, &nalgebra::Vector3<f64>)| {
        [0, 1, 2].map(|component| Held { vertex, component, place: x[component] })
    };
    let freedoms = Freedoms::new(bar.count(), &clamped.flat_map(hold).collect::<Vec<_>>())?;
    let mass = lumped_mass(LinearTetrahedron, &bar, [1e3, 1.0], &freedoms)?;
    let weight = |_: &[f64; 3]| [0.0, 0.0, -9.81 * 1e3];
    let weight = DeadLoad::body(LinearTetrahedron, &bar, 1.0, &freedoms, weight)?;
    let body = Solid::new(LinearTetrahedron, &bar, 1.0, rubber, freedoms.clone())?;
    let mut body = body.with_curvature(Curvature::Semidefinite).in_parts(2);
    let damping = StrainRate::new(&body, Lame::from_young_poisson(2e3, 0.4)?)?;

    // These three are what integrators, modes and scenes take.
    fn system(_: &impl Metric, _: &impl Potential, _: &impl Force) {}
    system(&mass, &(&body, &weight), &damping);

    let mut q = freedoms.gathered(&bar.nodes())?;
    Statics::default().solve(&mut body, &weight, &mass, freedoms.places(), &mut q)?;
    let places = freedoms.positions(&q)?;
    let moved = places.iter().zip(bar.nodes());
    let moved: Vec<[f64; 3]> =
        moved.map(|(x, rest)| std::array::from_fn(|c| x[c] - rest[c])).collect();
    let fields = [VtkField::Vectors("displacement", &moved)];
    write_vtk(std::io::stdout().lock(), "a bar", &bar.nodes(), bar.simplices(), &fields)?;
    Ok(())
}
