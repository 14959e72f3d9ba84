//! A potential written by hand, checked in one line, and what the check says of a mistake in it.
//!
//! `cargo run -p stationary-calculus --example check_a_potential`

use nalgebra::{DMatrix, SVector};
use stationary_calculus::{
    Covector, DerivativeError, Potential, Sink, Vector, check_potential, differences, hat,
    hat_differential,
};

/// A bead on a spring in the plane: V = 1/2 k (|q| - L)^2, the spring tied to the origin.
struct Bead {
    stiffness: f64,
    rest_length: f64,
    /// The sign that somebody may get wrong: +1 is right.
    sign: f64,
}

impl Potential for Bead {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * self.stiffness * (q[0].hypot(q[1]) - self.rest_length).powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let l = q[0].hypot(q[1]);
        for (force, x) in dv.0.iter_mut().zip(q) {
            *force += self.stiffness * (l - self.rest_length) * x / l;
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let l = q[0].hypot(q[1]);
        let u = [q[0] / l, q[1] / l];
        let sideways = 1.0 - self.sign * self.rest_length / l;
        let entry = |i: usize, j: usize| {
            let (delta, uu) = (if i == j { 1.0 } else { 0.0 }, u[i] * u[j]);
            self.stiffness * (uu + sideways * (delta - uu))
        };
        hessian.add_symmetric(&[0, 1], &[entry(0, 0), entry(1, 0), entry(0, 1), entry(1, 1)]);
    }
}

fn main() -> Result<(), DerivativeError> {
    let bead = Bead { stiffness: 40.0, rest_length: 0.8, sign: 1.0 };
    println!("A bead on a spring, right:\n\n{}", check_potential(&bead, &[0.6, 0.9])?);

    let mistaken = Bead { sign: -1.0, ..bead };
    if let Err(error) = check_potential(&mistaken, &[0.6, 0.9]) {
        println!("The same with one sign wrong in its Hessian:\n\n{error}");
    }

    let q = [0.6, -1.1, 0.4];
    let df = DMatrix::from_column_slice(3, 3, hat_differential(&SVector::from(q)).as_slice());
    let steps: Vec<f64> = (1..16).map(|k| 10_f64.powi(-k)).collect();
    let f = |q: &[f64]| hat([q[0], q[1], q[2]]).to_vec();
    let figure = differences(f, &df, &q, Vector(&[0.3, 0.8, -0.5]), &steps)?;
    println!("Figure 2.1, the hat function q/|q|:\n\n{figure}");
    Ok(())
}
