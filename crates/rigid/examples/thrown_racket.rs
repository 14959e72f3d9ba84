//! A racket thrown with a spin about its middle axis turns over, again and again: when, in closed
//! form.
//!
//! `cargo run --example thrown_racket -p stationary-rigid`

use nalgebra::Vector3;
use stationary_rigid::{FreeTop, LieGroup, Rotation, problems::thrown_racket};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let racket = thrown_racket()?;
    println!("{:>22} {:>16}", "off the axis [rad/s]", "flips every [s]");
    for wobble in [1.0, 0.1, 0.01, 1e-3, 1e-6, 1e-9] {
        let spin = Vector3::new(wobble, 10.0, 0.0);
        let thrown = FreeTop::new(*racket.body(), Rotation::identity(), spin)?;
        match thrown.period() {
            Some(period) => println!("{wobble:22.0e} {:16.4}", 0.5 * period),
            None => println!("{wobble:22.0e} {:>16}", "never"),
        }
    }
    let thrown = FreeTop::new(*racket.body(), Rotation::identity(), Vector3::new(0.01, 10.0, 0.0))?;
    println!("\n{:>8} {:>28} {:>34}", "t [s]", "angular velocity [rad/s]", "quaternion");
    for tenth in 0..=20 {
        let t = 0.1 * f64::from(tenth);
        let w = thrown.angular_velocity(t)?;
        let q = thrown.orientation(t)?.quaternion();
        println!("{t:8.1} {:8.3} {:9.3} {:9.3} {q:8.4?}", w.x, w.y, w.z);
    }
    Ok(())
}
