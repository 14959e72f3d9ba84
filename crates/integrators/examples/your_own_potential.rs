//! A potential of your own: two wells, and a particle that may or may not cross the hill between.
//!
//! `cargo run --example your_own_potential -p stationary-integrators`

use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_integrators::{Horizon, ImplicitMidpoint, State, simulate};

/// V(q) = (q^2 - 1)^2 / 4: wells at -1 and 1, a hill of height 1/4 at 0.
struct TwoWells;

impl Potential for TwoWells {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        (q[0] * q[0] - 1.0).powi(2) / 4.0
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += q[0] * (q[0] * q[0] - 1.0);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[3.0 * q[0] * q[0] - 1.0]);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let system = System::new(DiagonalMetric::new([1.0])?, TwoWells)?;
    for speed in [0.70, 0.71] {
        let mut state = State::new([1.0], Covector([speed]));
        let mut midpoint = ImplicitMidpoint::new(&system)?;
        let mut crossings = 0;
        let mut last = 1.0;
        simulate(&mut midpoint, &mut state, Horizon::new(200.0, 0.05)?, |now| {
            let q = now.state.q[0];
            crossings += u32::from(q * last < 0.0);
            last = q;
            ControlFlow::Continue(())
        })?;
        let energy = system.energy(&state.q, state.p.view());
        println!("speed {speed}: energy {energy:.4}, the hill (0.25) crossed {crossings} times");
    }
    Ok(())
}
