//! A masonry arch is let go: what it takes to stand, and what every joint carries.
//!
//! `cargo run --example masonry_arch -p stationary-contact`

use stationary_contact::Arch;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{:>8} {:>22} {:>22}", "friction", "sunk after 0.4 s [m]", "Coulomb's law [m/s]");
    for friction in [0.0, 0.2, 0.3, 0.4, 0.6] {
        let arch = Arch { wedges: 11, radius: 1.0, thickness: 0.3, friction, gravity: 9.81 };
        let (mut world, mut state) = arch.built()?;
        let start = state.clone();
        let mut off = 0.0;
        for _ in 0..200 {
            off = world.step(&mut state, 2e-3)?.coulomb;
        }
        println!("{friction:8.1} {:22.1e} {off:22.1e}", arch.sunk(&start, &state));
        if friction < 0.6 {
            continue;
        }
        println!("\n{:>8} {:>8} {:>14} {:>14}", "stone", "on", "pushed [N]", "rubbed [N]");
        for touch in world.touches() {
            let [first, second] = touch.contact.id.colliders;
            let on = if second == 11 { "ground".into() } else { second.to_string() };
            let [pushed, rubbed] = [touch.normal, touch.friction.norm()].map(|j| j / 2e-3);
            println!("{first:8} {on:>8} {pushed:14.3} {rubbed:14.3}");
        }
    }
    Ok(())
}
