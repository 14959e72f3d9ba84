//! A chain of thirty links let go sideways, told by thirty angles: what two ways of moving it cost, and
//! keep.
//!
//! `cargo run --example hanging_chain -p stationary-rigid`

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, Tolerance, integrate,
};
use stationary_rigid::tree::{TreeBuilder, TreeField, TreeForces, TreeMotion, TreeVariational};
use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion, Rotation};

const LINKS: usize = 30;
const HALF: f64 = 0.5 / LINKS as f64;
const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Each link hangs by its top from the foot of the one before it.
    let at = |z| RigidMotion { translation: Vector3::z() * z, rotation: Rotation::identity() };
    let link = Body::solid_box(1.0 / LINKS as f64, [0.01, 0.015, HALF])?;
    let hinge = JointKind::Hinge { axis: Vector3::y() };
    let mut builder = TreeBuilder::default();
    let mut last = None;
    for _ in 0..LINKS {
        let foot = at(if last.is_none() { 0.0 } else { -HALF });
        last = Some(builder.hang(last, hinge, [foot, at(HALF)], link));
    }
    let tree = builder.build()?;

    // Straight, at a radian from hanging.
    let (mut q, v) = (tree.rest(), vec![0.0; tree.speeds()]);
    q[0] = 1.0;
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(&q, &v)?;
    let start = motion.potential_energy(&GRAVITY);

    let mut method = TreeVariational::new(tree.clone(), GRAVITY)?;
    let mut state = method.state(&q, &v)?;
    let mut iterations = 0;
    for _ in 0..500 {
        iterations += method.step(&mut state, 2e-3)?.hessians;
    }
    println!("variational, 500 steps, {iterations} Newton iterations");
    println!("  energy off by {:.1e} J", method.energy(&state)? - start);

    let field = TreeField::new(tree.clone(), TreeForces::weight(&tree, GRAVITY)?)?;
    let tolerance = Tolerance::new(1e-9, 1e-9)?;
    let begin = Moment::new(0.0, [q, v].concat());
    let mut method = DormandPrince853::new(field, tolerance.into(), begin)?;
    integrate(&mut method, 1.0, |_| ControlFlow::Continue(()))?;
    let (q, v) = method.moment().y.split_at(tree.coordinates());
    motion.place(q, v)?;
    let energy = motion.kinetic_energy() + motion.potential_energy(&GRAVITY);
    println!("adaptive to 1e-9, {} forward dynamics", method.work().evaluations);
    println!("  energy off by {:.1e} J", energy - start);
    println!("the last link is at {:.6?} m", motion.pose(LINKS - 1)?.translation.as_slice());
    Ok(())
}
