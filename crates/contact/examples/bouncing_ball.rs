//! A ball falls from a metre and bounces: how high, for each choice of when the impulse is given.
//!
//! `cargo run --example bouncing_ball -p stationary-contact`

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{Balls, ImpactLaw, Impacting, Inequality, Wall, When};
use stationary_integrators::{State, UniformGravity};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.1;
const RESTITUTION: f64 = 0.8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let weight = UniformGravity { acceleration: [-GRAVITY], masses: vec![0.5] };
    let system = System::new(DiagonalMetric::new(vec![0.5])?, weight)?;
    let floor = Wall { normal: [1.0], offset: 0.0 };
    let gaps = Inequality(Balls::new(vec![RADIUS], vec![floor])?);
    println!("{:>10} {:>16} {:>22} {:>14}", "step [s]", "when", "first rebound [m]", "error [m]");
    for h in [1e-2, 1e-3, 1e-4] {
        for &when in When::ALL {
            let law = ImpactLaw::GeneralizedReflections;
            let mut impacting = Impacting::new(&system, &gaps, RESTITUTION, law, when)?;
            let mut state = State::new(vec![1.0 + RADIUS], Covector(vec![0.0]));
            let (mut impacts, mut top) = (0, 0.0_f64);
            while impacts < 2 && state.t < 5.0 {
                impacts += impacting.step(&mut state, h)?.impacts;
                let speed = state.p.0[0] / 0.5;
                let height = state.q[0] - RADIUS + speed * speed / (2.0 * GRAVITY);
                top = if impacts == 1 { top.max(height) } else { top };
            }
            let error = top - RESTITUTION * RESTITUTION;
            println!("{h:10.0e} {:>16} {top:22.12} {error:14.1e}", when.name());
        }
    }
    Ok(())
}
