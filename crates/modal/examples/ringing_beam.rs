//! A steel beam is struck at its tip: its tones, and where the tip is an hour later.
//!
//! `cargo run -p stationary-modal --example ringing_beam`

use std::f64::consts::TAU;

use stationary_calculus::Vector;
use stationary_elasticity::{Freedoms, Lame, Linear, LinearTetrahedron, Solid, lumped_mass};
use stationary_mesh::cuboid;
use stationary_modal::{Linearized, Motion, RigidMotions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = cuboid([1.0, 0.05, 0.05], [20, 2, 2])?;
    let places: Vec<[f64; 3]> = mesh.vertices().iter().map(|x| (*x).into()).collect();
    let freedoms = Freedoms::held_where(&places, |x, _| x[0] == 0.0)?; // clamped at one end
    let tip = freedoms.of(places.len() - 1)[2];
    let mass = lumped_mass(LinearTetrahedron, &mesh, [7800.0, 1.0], &freedoms)?;
    let steel = Linear::new(Lame::from_young_poisson(200e9, 0.3)?);
    let q = freedoms.gathered(&places)?;
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, steel, freedoms)?;
    let mut beam = Linearized::at(&mass, &solid, &q, 1e-3)?;
    let modes = beam.lowest(10, &RigidMotions::none())?;
    let (still, mut struck) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    struck[tip] = 1.0; // m/s
    let motion = Motion::new(&modes, beam.mass(), Vector(&still), Vector(&struck))?;
    let (mut d, mut v) = (Vector(still.clone()), Vector(still.clone()));
    for t in [0.0, 1e-3, 2e-3, 3600.0] {
        motion.at(t, d.view_mut(), v.view_mut())?;
        println!("after {t:8} s the tip is at {:+.3e} m", d.0[tip]);
    }
    for (i, omega) in modes.frequencies().enumerate() {
        let energy = motion.energy(i, 0.0)?;
        println!("tone {:2}: {:8.1} Hz, {energy:.2e} J", i + 1, omega / TAU);
    }
    Ok(())
}
