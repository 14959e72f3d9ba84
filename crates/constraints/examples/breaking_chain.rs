//! A chain that is let go like a staircase: where and when it tears.
//!
//! `cargo run -p stationary-constraints --example breaking_chain`

use stationary_constraints::problems::{RodProblem, folded_chain};
use stationary_constraints::{
    Constraint, ConstraintError, Rattle, Redundancy, Rod, Rods, SparseDiagonal,
};

const LINKS: usize = 8;

fn main() -> Result<(), ConstraintError> {
    let RodProblem { system, rods, initial } = folded_chain(LINKS)?;
    // The same rods, each as strong as one and a half times the chain's weight.
    let strength = 1.5 * LINKS as f64;
    let weak = rods.rods().iter().map(|rod| Rod::with_strength(*rod, strength)).collect();
    let weak = Rods::new(LINKS, vec![[0.0, 0.0]], weak)?;
    let few = SparseDiagonal(Redundancy::Refuse);
    let mut rattle = Rattle::new(&system, weak, &initial, few)?;
    let mut state = initial.clone();
    println!("rods hold {strength} N; the chain weighs {LINKS} N");
    while state.t < 5.0 {
        if let (_, Some(broken)) = rattle.step_and_break(&mut state, 1e-3, few)? {
            let [i, j] = broken.rod.ends();
            println!(
                "t = {:.3} s: the rod between {i} and {j} breaks at {:.1} N; {} are left",
                broken.time,
                broken.tension,
                rattle.constraint().count()
            );
        }
    }
    Ok(())
}
