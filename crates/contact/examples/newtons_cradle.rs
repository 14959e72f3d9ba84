//! Newton's cradle, and eight more balls that are hit by one, by each impact law.
//!
//! `cargo run --example newtons_cradle -p stationary-contact`

use stationary_calculus::Vector;
use stationary_contact::ImpactLaw;
use stationary_contact::problems::{newtons_cradle, nine_ball_break};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for moving in 1..=3 {
        let cradle = newtons_cradle(5, moving);
        println!("{moving} of 5 balls arrive at 1 m/s");
        for &law in ImpactLaw::ALL {
            let mut v = Vector(cradle.velocity.clone());
            let report = law.apply(&cradle.impact()?, v.view_mut())?;
            let (name, passes) = (law.facts().name, report.passes);
            println!("  {name:24} {:6.2?} after {passes} passes", v.0);
        }
    }
    let rack = nine_ball_break();
    println!("\na ball hits a rack of nine\n{:26} {:>10} {:>10}", "", "energy", "asymmetry");
    let before = rack.kinetic_energy(&rack.velocity);
    for &law in ImpactLaw::ALL {
        let mut v = Vector(rack.velocity.clone());
        law.apply(&rack.impact()?, v.view_mut())?;
        let change = rack.kinetic_energy(&v.0) / before - 1.0;
        println!("  {:24} {change:10.1e} {:10.1e}", law.facts().name, rack.asymmetry(&v.0));
    }
    Ok(())
}
