//! The implicit midpoint rule is stable at every step - until the stiff spring also swings.
//!
//! `cargo run --example where_it_breaks -p stationary-integrators`

use stationary_integrators::problems::{oscillator, spring_pendulum};
use stationary_integrators::{ImplicitMidpoint, Integrator};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let linear = oscillator(100.0)?;
    let swinging = spring_pendulum(1e4)?;
    println!("energy error after 200 steps, omega = 100 rad/s");
    println!("{:>8} {:>12} {:>12}", "h omega", "linear", "swinging");
    for h_omega in [1.0, 5.0, 10.0, 15.0, 20.0, 22.0, 30.0, 100.0] {
        let h = h_omega / 100.0;
        let mut method = ImplicitMidpoint::new(&linear.system)?;
        let mut state = linear.initial.clone();
        let mut worst = [0.0_f64; 2];
        let start = linear.energy(&state);
        for _ in 0..200 {
            method.step(&mut state, h)?;
            worst[0] = worst[0].max((linear.energy(&state) - start).abs() / start);
        }
        let mut method = ImplicitMidpoint::new(&swinging.system)?;
        let mut state = swinging.initial.clone();
        for _ in 0..200 {
            method.step(&mut state, h)?;
            worst[1] = worst[1].max(swinging.energy(&state).abs());
        }
        println!("{h_omega:8} {:12.1e} {:12.1e}", worst[0], worst[1]);
    }
    Ok(())
}
