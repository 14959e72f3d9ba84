//! A discrete Lagrangian of your own: a bead on a spinning hoop, by Simpson's rule.
//!
//! `cargo run --example discrete_hamilton -p stationary-integrators`

use stationary_calculus::{Covector, Number};
use stationary_integrators::{
    Action, DiscreteLagrangian, Facts, Integrator, State, VARIATIONAL, Variational,
};

/// A unit bead on a unit hoop that spins about its vertical axis at `spin` rad/s; g = 1.
struct Hoop {
    spin: f64,
}

impl Hoop {
    /// L(theta, theta'), theta from the lowest point: the spin acts like a second potential.
    fn lagrangian<R: Number>(&self, theta: R, rate: R) -> R {
        let around = theta.sin() * self.spin;
        (rate * rate + around * around) * 0.5 + theta.cos()
    }

    fn energy(&self, state: &State<[f64; 1]>) -> f64 {
        let (theta, p) = (state.q[0], state.p.0[0]);
        p * p - self.lagrangian(theta, p)
    }
}

/// The mean of L over a step along which the angle grows evenly.
impl DiscreteLagrangian<1> for Hoop {
    fn value<R: Number>(&self, [a]: [R; 1], [b]: [R; 1], h: f64) -> R {
        let rate = (b - a) / h;
        let [start, middle, end] = [a, (a + b) * 0.5, b].map(|q| self.lagrangian(q, rate));
        (start + middle * 4.0 + end) / 6.0
    }

    fn facts(&self) -> Facts {
        Facts { name: "hoop-by-simpson", order: 2, symmetric: true, ..VARIATIONAL }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let hoop = Hoop { spin: 2.0 };
    println!("spun this fast, the bead stays at {:.4} rad", (0.25_f64).acos());
    for h in [0.1, 0.05, 0.025] {
        let mut integrator = Variational::new(&hoop)?;
        let mut state = State::new([0.5], Covector([0.0]));
        let (start, mut path) = (hoop.energy(&state), vec![state.q]);
        let (mut least, mut most, mut off) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for _ in 0..20_000 {
            integrator.step(&mut state, h)?;
            (least, most) = (least.min(state.q[0]), most.max(state.q[0]));
            off = off.max((hoop.energy(&state) - start).abs());
            path.push(state.q);
        }
        let action = Action::new(&hoop, vec![h; 20_000])?;
        let slope = action.differential(&path)?.iter().map(|d| d.0[0].abs()).fold(0.0, f64::max);
        println!(
            "h = {h:5}: from {least:.4} to {most:.4} rad, energy within {off:.1e}, \
             differential of the action {slope:.0e}"
        );
    }
    Ok(())
}
